/* Checks JSON text from outside before jansson parses it. */
#ifndef JSON_TEXT_H
#define JSON_TEXT_H

#include "ref/base/base.h"

/* Least bytes of text per object, on average; our own files have 32 and more. */
#define JSON_TEXT_OBJECT 16u

/* Returns false if jansson would need far more memory than the text has bytes. It takes about 256
 * bytes for an empty object, "{}," (85 times its text), and at most 56 times their text for other
 * values ("[],"). So a text may have one object per JSON_TEXT_OBJECT bytes, and a few hundred
 * more. */
bool json_text_fits(const char *bytes, size_t size);

/* The rule, for reasons. */
#define JSON_TEXT_RULE "more objects than a text of its size may have, one in 16 bytes"

#endif
