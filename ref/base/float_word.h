/* Floats as text, to the bit: every bit pattern has a text of its own, and it reads back. */
#ifndef FLOAT_WORD_H
#define FLOAT_WORD_H

#include "ref/base/base.h"

#define FLOAT_WORD_MOST 20

/* Writes "0x1.8p+1", "-0x0p+0", "inf", "-inf", or of a NaN its bits, "nan:0x7fc00000"; the same in
 * every locale. Returns the length. */
size_t float_word_write(float x, char text[FLOAT_WORD_MOST]);

/* Reads one of these, or a decimal ("-1.5e3") as the nearest float, and stops before the first byte
 * that does not belong to it. The text needs a 0 or another byte that no number contains after it.
 * Returns that byte, or NULL with *rule: what is wrong (static). A hexadecimal number must be a
 * float32 exactly, a decimal must lie within its range. */
const char *float_word_read(const char *text, float *out, const char **rule);

#endif
