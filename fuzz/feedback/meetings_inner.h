/* What the files of fuzz/feedback/meetings*.c share. */
#ifndef FUZZ_MEETINGS_INNER_H
#define FUZZ_MEETINGS_INNER_H

#include "fuzz/feedback/meetings.h"

struct pair {
    uint64_t met;           /* trials */
    uint64_t drawn, missed; /* trials of this pair that were drawn; of them not met */
    bool possible;
};

/* What an engine that compiles is asked next on a layout, so many times. */
struct program {
    uint16_t member[MEET_FACTORS]; /* of storage and tests */
    uint32_t left;
};

struct meetings {
    struct meeting_tables tables;
    struct pair *pair; /* of factors a < b: members i and j at place[a][b] + i * count[b] + j */
    struct program *program; /* of engine i and layout j: i * layouts + j */
    size_t pairs, place[MEET_FACTORS][MEET_FACTORS];
};

struct pair *meetings_pair(const struct meetings *m, enum meeting_factor a, uint32_t i,
                           enum meeting_factor b, uint32_t j);
/* True if that engine meets members of the factor. */
bool meetings_meets(const struct engine *engine, enum meeting_factor factor);

#endif
