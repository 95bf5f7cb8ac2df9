/* JSON text from outside, before it is handed to jansson. */
#ifndef JSON_TEXT_H
#define JSON_TEXT_H

#include "ref/base.h"

/* Bytes of text that an object has at least, on average; files of ours have 40 and more. */
#define JSON_TEXT_OBJECT 8u

/* False where jansson would need far more memory than the text has bytes: it takes about 240 bytes
 * for an empty object, "{}," (85 times), where other values take at most 45 times their text. So a
 * text may have an object per JSON_TEXT_OBJECT bytes, and a few hundred. */
bool json_text_fits(const char *bytes, size_t size);

/* Why not, for reasons. */
#define JSON_TEXT_RULE "more objects than a text of its size may have, one in 8 bytes"

#endif
