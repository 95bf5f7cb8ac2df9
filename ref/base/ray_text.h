/* Rays as text, as in `raydiff explain --ray`. */
#ifndef EXPLAIN_RAY_TEXT_H
#define EXPLAIN_RAY_TEXT_H

#include "ref/abi.h"
#include "ref/base/base.h"

#define RAY_TEXT_MOST 256

/* Reads "ox,oy,oz dx,dy,dz" or "ox,oy,oz dx,dy,dz tmin,tmax" (default 0 and `tmax`). Numbers are
 * decimal ("-1.5e3"), hexadecimal with an exponent ("0x1.8p+1") or "inf", "-inf", "nan", separated
 * by commas or blanks. The ray itself is not checked: a ray out of contract can be explained, too.
 * Errors: STATUS_INPUT with the rule and the place. */
enum status ray_text_read(const char *text, float tmax, struct ray *out,
                          struct reason *reason) MUST_USE;

/* Writes all eight numbers in hexadecimal, so that ray_text_read returns the same bits (for a NaN:
 * some NaN). Returns the length. */
size_t ray_text_write(const struct ray *ray, char text[RAY_TEXT_MOST]);

/* Writes one number in the same way, "0x1.8p+1". */
void float_text_write(float x, char text[32]);

/* Reads one number as above. The text must end in a 0 or another byte that cannot be part of a
 * number. Returns the first byte after the number, or NULL if there is no float32. */
const char *float_text_read(const char *text, float *out);

#endif
