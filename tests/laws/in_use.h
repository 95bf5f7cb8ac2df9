/* What is done again and again holds no more memory than before. In use is what malloc has given
 * and was not given back. Some cycle in a few holds no more than the one before; what is
 * forgotten in each cycle is more after every one. With AddressSanitizer, which has a malloc of
 * its own and looks for leaks itself, nothing is seen here. Define _GNU_SOURCE before; include
 * after cmocka.h. */
#ifndef TESTS_LAWS_IN_USE_H
#define TESTS_LAWS_IN_USE_H

#include <malloc.h>
#include <stdlib.h>
#include <unistd.h>

#define CYCLES 10

typedef void cycle_fn(const void *what);

static inline size_t in_use(void)
{
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
}

static inline void must_hold_no_more(const char *name, const char *how, cycle_fn *cycle,
                                     const void *what)
{
    size_t before, after = 0;
    for (int i = 0; i < CYCLES; i++) {
        before = in_use();
        cycle(what);
        after = in_use();
        if (i > 0 && after <= before)
            return;
    }
    fail_msg("%s: %s holds more after each of %d times, %zu bytes now", name, how, CYCLES, after);
}

/* What malloc keeps for a thread counts as in use, so nothing is kept. It is known only at the
 * start of a program, which starts again. */
static inline void keep_nothing(int argc, char **argv)
{
    if (argc == 1 && setenv("GLIBC_TUNABLES", "glibc.malloc.tcache_count=0", 1) == 0)
        (void)execv("/proc/self/exe", (char *[]){argv[0], (char[]){"again"}, NULL});
}

/* What is not given back is seen. */
static inline void what_is_forgotten_is_seen(void **state)
{
    static void *forgotten[CYCLES];
    int seen = 0;
    (void)state;
    for (int i = 0; i < CYCLES; i++) {
        const size_t before = in_use();
        forgotten[i] = malloc(24);
        seen += in_use() > before;
    }
    for (int i = 0; i < CYCLES; i++)
        free(forgotten[i]);
    if (in_use() == 0) /* a malloc of the sanitizer's */
        skip();
    assert_int_equal(seen, CYCLES);
}

#endif
