/* A ray as text, as `raydiff explain --ray` takes it. */
#ifndef EXPLAIN_RAY_TEXT_H
#define EXPLAIN_RAY_TEXT_H

#include "ref/abi.h"
#include "ref/base/base.h"

#define RAY_TEXT_MOST 256

/* Reads "ox,oy,oz dx,dy,dz" or "ox,oy,oz dx,dy,dz tmin,tmax" (default 0 and `tmax`): decimal
 * ("-1.5e3"), hexadecimal with its exponent ("0x1.8p+1") or "inf", "-inf", "nan"; separated by
 * commas or blanks. Nothing is checked about the ray itself: one out of contract can be explained.
 * Errors: STATUS_INPUT with what is wrong, and where. */
enum status ray_text_read(const char *text, float tmax, struct ray *out,
                          struct reason *reason) MUST_USE;

/* Writes all eight numbers, in hexadecimal, so that ray_text_read gives the same bits back (of a
 * NaN: a NaN). Returns the length. */
size_t ray_text_write(const struct ray *ray, char text[RAY_TEXT_MOST]);

/* One number likewise, "0x1.8p+1". */
void float_text_write(float x, char text[32]);

/* Reads one number as above; the text needs a 0 or another byte that no number contains after it.
 * Returns the first byte after the number, or NULL if there is none or none that is a float32. */
const char *float_text_read(const char *text, float *out);

#endif
