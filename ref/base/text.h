/* Text that grows in a buffer of fixed size, and counted things. */
#ifndef TEXT_H
#define TEXT_H

#include "ref/base/base.h"

/* Appends to the text in `text`, cut to what fits. */
void text_append(char *text, size_t text_bytes, const char *format, ...) PRINTF_LIKE(3, 4);

/* Bytes of the character in UTF-8 that begins there (1 to 4, the shortest form of a Unicode scalar
 * value); 0 if none does, as at the end of the text. */
size_t utf8_bytes(const char *text);

/* True if all of the text is UTF-8. */
bool utf8_is_text(const char *text);

#define COUNTED_MOST 64u /* bytes, the end included */

/* Writes "1 triangle", "2 triangles", "0 vertices": the noun in its plural unless the count is 1,
 * cut to what fits. Nouns in -x, -s, -sh and -ch end in -es, those in -ex in -ices, and -leaf
 * becomes -leaves. Returns `text`. */
const char *counted_text(char text[COUNTED_MOST], uint64_t count, const char *noun);

/* The same as an argument of a call: the text lives as long as the block around it. */
#define COUNTED(count, noun) counted_text((char[COUNTED_MOST]){0}, (count), (noun))

#define BOUND_TEXT 32u /* bytes, the end included */

/* Writes a bound, at least 0, as "%.4g" does, but rounded up: the number that is read again is not
 * below it. Returns `text`. */
const char *bound_text(char text[BOUND_TEXT], double bound);

/* The same as an argument of a call. */
#define BOUND(bound) bound_text((char[BOUND_TEXT]){0}, (bound))

#endif
