/* JSON objects of named values, written as one line that the compiler checks:
 *   json_record("scene=%s triangles=%u ratio=%g", spec, count, ratio) */
#ifndef JSON_RECORD_H
#define JSON_RECORD_H

#include "ref/base/base.h"

#include <jansson.h>

/* Makes an object from NAME=CONVERSION words, separated by blanks, in their order. Conversions:
 *   %s         a text, not NULL; each byte of it that is not part of UTF-8 becomes U+FFFD
 *   %d %u %zu  integers; %zu is for size_t and uint64_t
 *   %g         a number; null if it is not finite, which JSON cannot represent
 *   %i         true or false
 *   %p         a json_t; ownership is taken
 * In a name %s is replaced by a text, too: "%s_ns=%g". A name has at most 255 bytes. Returns NULL
 * if out of memory, or if a json_t is NULL. */
json_t *json_record(const char *names, ...) PRINTF_LIKE(1, 2);

/* Returns a text value, as of %s, or null for NULL. */
json_t *json_text(const char *text);

/* Returns an integer, or null for 0, which stands for what is not known. */
json_t *json_known(uint64_t count);

/* Adds such values to an object. If the object is NULL, values of which it would take ownership are
 * freed. */
void json_add(json_t *object, const char *names, ...) PRINTF_LIKE(2, 3);

#endif
