#define _POSIX_C_SOURCE 200809L
#include "ref/base/base.h"

#include "ref/base/memory.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

const char *status_text(enum status status)
{
    switch (status) {
    case STATUS_OK:
        return "ok";
    case STATUS_MEMORY:
        return "out of memory";
    case STATUS_INPUT:
        return "bad input";
    case STATUS_LIMIT:
        return "over a limit";
    case STATUS_REFUSED:
        return "refused by the engine";
    case STATUS_UNSUPPORTED:
        return "not available";
    case STATUS_DEVICE:
        return "device failed";
    case STATUS_INTERNAL:
        return "internal contradiction";
    }
    return "unknown status";
}

enum status fail(struct reason *reason, enum status status, const char *format, ...)
{
    if (!reason)
        return status;
    va_list args;
    va_start(args, format);
    int length = vsnprintf(reason->text, sizeof reason->text, format, args);
    va_end(args);
    if (length >= (int)sizeof reason->text)
        memcpy(reason->text + sizeof reason->text - 4, "...", 4);
    for (char *at = reason->text; *at; at++)
        if ((unsigned char)*at < 0x20 || *at == 0x7F)
            *at = '?';
    return status;
}

void *alloc_zeroed(size_t count, size_t size)
{
    if (size && count > SIZE_MAX / size)
        return NULL;
    return memory_fits(count * size) ? calloc(count ? count : 1, size ? size : 1) : NULL;
}

void *alloc_copy(const void *from, size_t count, size_t size)
{
    void *to = from ? alloc_zeroed(count, size) : NULL;
    if (to)
        memcpy(to, from, count * size);
    return to;
}

enum status array_reserve(void *array, size_t *capacity, size_t need, size_t size)
{
    void *elements; /* object pointers have one representation (POSIX) */
    if (need <= *capacity)
        return STATUS_OK;
    size_t grown = *capacity ? *capacity : 16;
    while (grown < need) {
        if (grown > SIZE_MAX / 2)
            return STATUS_MEMORY;
        grown *= 2;
    }
    if (grown > SIZE_MAX / size || !memory_fits((grown - *capacity) * size))
        return STATUS_MEMORY;
    memcpy(&elements, array, sizeof elements);
    elements = realloc(elements, grown * size);
    if (!elements)
        return STATUS_MEMORY;
    memcpy(array, &elements, sizeof elements);
    *capacity = grown;
    return STATUS_OK;
}

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return order_doubles(x, y);
}

void sort_doubles(double *value, size_t count)
{
    qsort(value, count, sizeof *value, by_value);
}

size_t rank_of(size_t count, size_t thousandths)
{
    size_t rank = (count * thousandths + 999) / 1000;
    return rank > 0 ? rank - 1 : 0;
}

static uint64_t ns_of(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

uint64_t time_ns(void)
{
    return ns_of(CLOCK_MONOTONIC);
}

uint64_t core_time_ns(void)
{
    return ns_of(CLOCK_THREAD_CPUTIME_ID);
}
