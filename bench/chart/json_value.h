/* Members of JSON objects that came from a file and may be anything. */
#ifndef JSON_VALUE_H
#define JSON_VALUE_H

#include "ref/base/base.h"

#include <jansson.h>

/* "", NAN, 0 or false where the member is missing or of another type; `object` may be NULL or no
 * object. A count is a whole number from 0 on. */
const char *value_text(const json_t *object, const char *name);
double value_number(const json_t *object, const char *name);
size_t value_count(const json_t *object, const char *name);
bool value_bool(const json_t *object, const char *name);

/* The objects of an array whose text `name` is `text`, in a new array; NULL without memory. */
json_t *value_where(const json_t *array, const char *name, const char *text);

/* Whether the texts of two objects are the same. */
bool value_same(const json_t *a, const json_t *b, const char *name);

#endif
