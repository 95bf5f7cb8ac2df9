/* Exact text form of floats: every bit pattern has its own text, which reads back to it. */
#ifndef FLOAT_WORD_H
#define FLOAT_WORD_H

#include "ref/base/base.h"

#define FLOAT_WORD_MOST 20

/* Writes "0x1.8p+1", "-0x0p+0", "inf", "-inf", or the bits of a NaN, "nan:0x7fc00000"; the same in
 * every locale. Returns the length. */
size_t float_word_write(float x, char text[FLOAT_WORD_MOST]);

/* Reads one of these, or a decimal ("-1.5e3") as the nearest float. The text must end in a 0 or
 * another byte that cannot be part of a number. Returns the first byte after the number, or NULL
 * with the broken rule in *rule (static). A hexadecimal number must be exactly a float32; a decimal
 * must be within the range of float32. */
const char *float_word_read(const char *text, float *out, const char **rule);

#endif
