/* What the files of fuzz/feedback/pair_coverage*.c share. */
#ifndef FEEDBACK_PAIR_COVERAGE_INNER_H
#define FEEDBACK_PAIR_COVERAGE_INNER_H

#include "fuzz/feedback/pair_coverage.h"

struct coverage_pair {
    uint64_t met;           /* trials */
    uint64_t drawn, missed; /* trials of this pair that were drawn; of them not met */
    bool possible;
};

/* What an engine that compiles plays next on a layout, and how often. */
struct program {
    uint16_t member[MEET_FACTORS]; /* of storage and tests */
    uint32_t left;
};

struct pair_coverage {
    struct pair_tables tables;
    struct coverage_pair
        *pair; /* of factors a < b: members i and j at place[a][b] + i * count[b] + j */
    struct program *program; /* of engine i and layout j: i * layouts + j */
    size_t pairs, place[MEET_FACTORS][MEET_FACTORS];
};

struct coverage_pair *pair_coverage_of_pair(const struct pair_coverage *m, enum pair_factor a,
                                            uint32_t i, enum pair_factor b, uint32_t j);
/* True if that engine meets members of the factor. */
bool pair_coverage_meets(const struct engine *engine, enum pair_factor factor);

#endif
