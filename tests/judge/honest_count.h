/* How many honest answers were judged and how many refused, as lines that tests/scripts/honest.sh
 * adds up. Include after cmocka.h. */
#ifndef TESTS_HONEST_COUNT_H
#define TESTS_HONEST_COUNT_H

#include <stdbool.h>
#include <stdint.h>
#include <time.h>

/* So many of those refused are shown. */
#define HONEST_SHOWN 3

struct honest_count {
    uint64_t evaluations, refused;
    clock_t begun;
};

static inline struct honest_count honest_begun(void)
{
    return (struct honest_count){.begun = clock()};
}

static inline void honest_counted(struct honest_count *count, bool refused)
{
    count->evaluations++;
    count->refused += refused;
}

/* Prints the line, and returns how many were refused. */
static inline uint64_t honest_ended(const struct honest_count *count, const char *formula)
{
    print_message("honest: %s: %llu %llu %.2f\n", formula, (unsigned long long)count->evaluations,
                  (unsigned long long)count->refused,
                  (double)(clock() - count->begun) / (double)CLOCKS_PER_SEC);
    return count->refused;
}

#endif
