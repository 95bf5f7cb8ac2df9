/* Status codes, reasons, checked allocation. Every C file includes this. */
#ifndef BASE_H
#define BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define MUST_USE          __attribute__((warn_unused_result))
#define PRINTF_LIKE(a, b) __attribute__((format(printf, a, b)))
#define ARRAY_COUNT(a)    (sizeof(a) / sizeof((a)[0]))

/* Kinds of failure. Every function that can fail returns one. Its outputs come last and are zero on
 * error, so that freeing them is always safe. */
enum status {
    STATUS_OK,
    STATUS_MEMORY,      /* out of memory */
    STATUS_INPUT,       /* a file, flag or scene is wrong */
    STATUS_LIMIT,       /* a stated limit of a layout or engine is exceeded */
    STATUS_REFUSED,     /* an external engine rejects the job */
    STATUS_UNSUPPORTED, /* not available here: the caller skips and reports the reason */
    STATUS_DEVICE,      /* a device or driver failed, or did not finish its work */
    STATUS_INTERNAL,    /* two of our own methods contradict each other: our bug */
};

/* One line that explains a status other than STATUS_OK: what failed, where, which rule. */
struct reason {
    char text[320];
};

/* Returns a short English name of `status`; never NULL. */
const char *status_text(enum status status);

/* Writes a printf-formatted line to `reason` (NULL: nothing) and returns `status`, so that a
 * failing function ends with `return fail(...)`. A line that is too long is cut and ends in "...";
 * control bytes, which may come from a quoted file, are written as '?'. */
enum status fail(struct reason *reason, enum status status, const char *format, ...)
    PRINTF_LIKE(3, 4);

/* Returns `count` zeroed elements of `size` bytes, or NULL if out of memory (ref/base/memory.h) or
 * if the product overflows. A count of 0 returns a valid pointer to free(). */
void *alloc_zeroed(size_t count, size_t size) MUST_USE;

/* Returns a copy of `count` elements, which the caller frees; NULL if `from` is NULL or out of
 * memory. */
void *alloc_copy(const void *from, size_t count, size_t size) MUST_USE;

/* Grows an array of `size`-byte elements so that it can hold at least `need`; doubles `*capacity`.
 * `array` is the address of the pointer to its elements, of any type. On STATUS_MEMORY pointer and
 * capacity are unchanged. New elements are uninitialized. */
enum status array_reserve(void *array, size_t *capacity, size_t need, size_t size) MUST_USE;

/* Returns -1, 0 or 1 if a is less than, equal to or greater than b. NaN counts as equal to all. */
static inline int order_numbers(uint64_t a, uint64_t b)
{
    return (a > b) - (a < b);
}

static inline int order_doubles(double a, double b)
{
    return (a > b) - (a < b);
}

/* Sorts numbers in ascending order. */
void sort_doubles(double *value, size_t count);

/* Index of a quantile of `count` >= 1 sorted values by nearest rank: the smallest value that at
 * least so many thousandths (0 to 1000) of all do not exceed. */
size_t rank_of(size_t count, size_t thousandths);

/* Monotonic time in nanoseconds since an arbitrary start. */
uint64_t time_ns(void);

/* CPU time of the calling thread in nanoseconds. */
uint64_t core_time_ns(void);

/* Bit pattern of a float and back. */
static inline uint32_t float_bits(float x)
{
    union {
        float f;
        uint32_t u;
    } pun = {.f = x};
    return pun.u;
}

static inline float float_from_bits(uint32_t bits)
{
    union {
        uint32_t u;
        float f;
    } pun = {.u = bits};
    return pun.f;
}

/* True if neither NaN nor infinity; independent of -ffinite-math flags. */
static inline bool float_is_finite(float x)
{
    return (float_bits(x) & 0x7F800000u) != 0x7F800000u;
}

#endif
