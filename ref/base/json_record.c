#include "ref/base/json_record.h"
#include "ref/base/invariant.h"
#include "ref/base/text.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NAME_MOST 256

_Static_assert(sizeof(size_t) == sizeof(uint64_t), "%zu takes both");

/* A text value; each byte that is not part of UTF-8 becomes U+FFFD, so that no name of a file or
 * of a tracer takes away what is told of it. */
static json_t *text_value(const char *text)
{
    if (!text || utf8_is_text(text))
        return json_string(text);
    char *told = malloc(3 * strlen(text) + 1), *end = told;
    if (!told)
        return NULL;
    while (*text) {
        const size_t bytes = utf8_bytes(text);
        memcpy(end, bytes ? text : "\xEF\xBF\xBD", bytes ? bytes : 3);
        end += bytes ? bytes : 3;
        text += bytes ? bytes : 1;
    }
    *end = '\0';
    json_t *value = json_string(told);
    free(told);
    return value;
}

/* Makes the next value from `list`, of the conversion at `at`. */
static json_t *next_value(const char *at, va_list *list)
{
    double number;
    switch (at[1]) {
    case 's':
        return text_value(va_arg(*list, const char *));
    case 'd':
        return json_integer(va_arg(*list, int));
    case 'u':
        return json_integer(va_arg(*list, unsigned));
    case 'z':
        return json_integer((json_int_t)va_arg(*list, size_t));
    case 'g':
        number = va_arg(*list, double);
        return isfinite(number) ? json_real(number) : json_null();
    case 'i':
        return json_boolean(va_arg(*list, int));
    default:
        invariant(at[1] == 'p');
        return va_arg(*list, void *);
    }
}

/* Copies the name that begins at `name`, with each %s replaced by the next text. Returns a pointer
 * to its conversion. */
static const char *next_name(const char *name, char key[NAME_MOST], va_list *list)
{
    size_t used = 0;
    for (; *name != '='; name++) {
        if (*name == '%') {
            const char *text = va_arg(*list, const char *);
            used += (size_t)snprintf(key + used, NAME_MOST - used, "%s", text);
            name++;
        } else {
            key[used++] = *name;
        }
        invariant(used < NAME_MOST);
    }
    key[used] = '\0';
    return name + 1;
}

/* Returns true if all were added. */
static bool add(json_t *object, const char *names, va_list *list)
{
    bool all = object != NULL;
    while (*names) {
        char key[NAME_MOST];
        const char *conversion = next_name(names, key, list);
        /* json_object_set_new takes ownership of the value, also on failure. */
        all = json_object_set_new(object, key, next_value(conversion, list)) == 0 && all;
        names = conversion + strcspn(conversion, " ");
        names += strspn(names, " ");
    }
    return all;
}

json_t *json_text(const char *text)
{
    return text ? text_value(text) : json_null();
}

json_t *json_known(uint64_t count)
{
    return count ? json_integer((json_int_t)count) : json_null();
}

json_t *json_record(const char *names, ...)
{
    json_t *out = json_object();
    va_list list;
    va_start(list, names);
    bool all = add(out, names, &list);
    va_end(list);
    if (all)
        return out;
    json_decref(out);
    return NULL;
}

void json_add(json_t *object, const char *names, ...)
{
    va_list list;
    va_start(list, names);
    (void)add(object, names, &list);
    va_end(list);
}
