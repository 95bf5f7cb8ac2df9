/* Decimal text to floats and back, the same in every locale. */
#ifndef DECIMAL_H
#define DECIMAL_H

#include "ref/base/base.h"

/* Reads a decimal, [+-]digits[.digits][e[+-]digits] with at least one digit before the exponent (so
 * no hexadecimal, no "inf", no "nan"). The text must end in a 0 or another byte that cannot be part
 * of a number. *out is the nearest float, ties to even; infinite if beyond FLT_MAX; "-0" keeps its
 * sign. Returns the first byte after the number, or NULL (and *out 0) if there is none. */
const char *decimal_read_float(const char *text, float *out);

/* The same for a double. */
const char *decimal_read_double(const char *text, double *out);

#define DECIMAL_TEXT 24

/* Writes the shortest decimal that decimal_read_float reads back as the same bits, and the nearest
 * to `x` among the shortest, always with a point or an exponent: 0.0, -3.5, 6.6320736e-9, 1e20.
 * Exponents are used below 1e-6 and from 1e13 on. `x` must be finite. Returns the length; the text
 * ends with a 0. Source: the form in which Rust's JSON writer prints an f32, so that files compare
 * byte for byte. */
size_t decimal_write_float(float x, char text[DECIMAL_TEXT]);

#define DECIMAL_WITHIN_MOST 32

/* Writes the shortest decimal that lies in [lo, hi], near its middle. If this is no interval (hi <
 * lo, or an end is not finite), writes `lo` in full. So an enclosure of 1/4 is "0.25", whatever its
 * width. */
void decimal_within(double lo, double hi, char text[DECIMAL_WITHIN_MOST]);

#endif
