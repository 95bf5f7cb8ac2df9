/* Reads members of JSON objects from files, which may contain anything. */
#ifndef JSON_VALUE_H
#define JSON_VALUE_H

#include "ref/base/base.h"

#include <jansson.h>

/* Return "", NAN, 0 or false if the member is missing or of another type. `object` may be NULL or
 * not an object. A count is a whole number of at least 0. */
const char *value_text(const json_t *object, const char *name);
double value_number(const json_t *object, const char *name);
size_t value_count(const json_t *object, const char *name);
bool value_bool(const json_t *object, const char *name);

/* Returns a new array of the objects whose text `name` equals `text`; NULL if out of memory. */
json_t *value_where(const json_t *array, const char *name, const char *text);

/* Returns whether two objects have the same text. */
bool value_same(const json_t *a, const json_t *b, const char *name);

#endif
