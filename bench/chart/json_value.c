#include "bench/chart/json_value.h"

#include <math.h>
#include <string.h>

const char *value_text(const json_t *object, const char *name)
{
    const char *text = json_string_value(json_object_get(object, name));
    return text ? text : "";
}

double value_number(const json_t *object, const char *name)
{
    const json_t *value = json_object_get(object, name);
    return json_is_number(value) ? json_number_value(value) : NAN;
}

size_t value_count(const json_t *object, const char *name)
{
    json_int_t value = json_integer_value(json_object_get(object, name));
    return value > 0 ? (size_t)value : 0;
}

bool value_bool(const json_t *object, const char *name)
{
    return json_is_true(json_object_get(object, name));
}

json_t *value_where(const json_t *array, const char *name, const char *text)
{
    json_t *out = json_array();
    for (size_t i = 0; i < json_array_size(array); i++)
        if (strcmp(value_text(json_array_get(array, i), name), text) == 0)
            (void)json_array_append(out, json_array_get(array, i));
    return out;
}

bool value_same(const json_t *a, const json_t *b, const char *name)
{
    return strcmp(value_text(a, name), value_text(b, name)) == 0;
}
