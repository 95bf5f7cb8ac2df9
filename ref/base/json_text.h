/* JSON text from outside, before it is handed to jansson. */
#ifndef JSON_TEXT_H
#define JSON_TEXT_H

#include "ref/base/base.h"

/* Bytes of text that an object has at least, on average; files of ours have 32 and more. */
#define JSON_TEXT_OBJECT 16u

/* False where jansson would need far more memory than the text has bytes: it takes about 256 bytes
 * for an empty object, "{}," (85 times), and at most 56 times their text for other values ("[],").
 * So a text may have an object per JSON_TEXT_OBJECT bytes, and a few hundred. */
bool json_text_fits(const char *bytes, size_t size);

/* Why not, for reasons. */
#define JSON_TEXT_RULE "more objects than a text of its size may have, one in 16 bytes"

#endif
