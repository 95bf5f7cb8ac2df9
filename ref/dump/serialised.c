#include "ref/dump/serialised.h"

#include "ref/dump/dump_inner.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

bool dump_is_serialised(const char *bytes, size_t size)
{
    if (size < SERIAL_HANDLES)
        return false;
    const uint64_t all = serial_long(bytes + SERIAL_SIZE),
                   handles = serial_long(bytes + SERIAL_COUNT);
    return all >= SERIAL_HANDLES && all <= size && handles <= (all - SERIAL_HANDLES) / 8 &&
           serial_long(bytes + SERIAL_INNER) > 0;
}

enum status serial_fail(const char *name, uint64_t begin, struct reason *reason, const char *format,
                        ...)
{
    char rule[200];
    va_list args;
    va_start(args, format);
    vsnprintf(rule, sizeof rule, format, args);
    va_end(args);
    return fail(reason, STATUS_INPUT, "%s: structure at byte %llu: %s", name,
                (unsigned long long)begin, rule);
}

const char *serial_uuid_text(const char *at, char text[SERIAL_UUID_TEXT])
{
    size_t length = 0;
    while (length < SERIAL_UUID && isgraph((unsigned char)at[length]))
        length++;
    bool is_text = length > 2;
    for (size_t i = length; i < SERIAL_UUID; i++)
        is_text = is_text && at[i] == 0;
    for (size_t i = 0; i < SERIAL_UUID; i++)
        snprintf(text + 2 * i, 3, "%02x", (unsigned char)at[i]);
    if (is_text) {
        memcpy(text, at, length);
        text[length] = 0;
    }
    return text;
}

/* --- handles ---------------------------------------------------------------------------------- */

static int by_value(const void *a, const void *b)
{
    const struct serial_handle *x = a, *y = b;
    if (x->value != y->value)
        return x->value < y->value ? -1 : 1;
    return x->first < y->first ? -1 : x->first > y->first;
}

static int by_first(const void *a, const void *b)
{
    const struct serial_handle *x = a, *y = b;
    return x->first < y->first ? -1 : x->first > y->first;
}

uint32_t serial_handles(struct serial_handle *list, uint32_t count)
{
    uint32_t kept = 0;
    qsort(list, count, sizeof *list, by_value);
    for (uint32_t i = 0; i < count; i++)
        if (list[i].value != 0 && (kept == 0 || list[kept - 1].value != list[i].value))
            list[kept++] = list[i];
    qsort(list, kept, sizeof *list, by_first);
    for (uint32_t i = 0; i < kept; i++)
        list[i].below = i;
    qsort(list, kept, sizeof *list, by_value);
    return kept;
}

const struct serial_handle *serial_handle_find(const struct serial_handle *list, uint32_t count,
                                               uint64_t value)
{
    uint32_t low = 0, high = count;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (list[middle].value < value)
            low = middle + 1;
        else
            high = middle;
    }
    return low < count && list[low].value == value ? &list[low] : NULL;
}
