/* Finds numbers in JSON, for tests of what commands tell. Includes cmocka.h, whose macros must come
 * last. */
#ifndef TESTS_TOLD_H
#define TESTS_TOLD_H

#include <jansson.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The number at a path such as "axes.0.step.value". */
static inline double number_at(json_t *from, const char *path)
{
    char name[64];
    while (*path) {
        const size_t length = strcspn(path, ".");
        snprintf(name, sizeof name, "%.*s", (int)length, path);
        from = json_is_array(from) ? json_array_get(from, strtoul(name, NULL, 10))
                                   : json_object_get(from, name);
        path += length + (path[length] == '.');
    }
    if (!json_is_number(from))
        fail_msg("no number");
    return json_number_value(from);
}

#endif
