/* What the parts of fuzz/feedback share. */
#ifndef FUZZ_FEEDBACK_INNER_H
#define FUZZ_FEEDBACK_INNER_H

#include "fuzz/feedback/feedback.h"

struct feedback_entry {
    struct fuzz_trial trial;
    uint64_t coverage[COVERAGE_WORDS];
    uint64_t chosen; /* how often */
    bool saved;
};

struct feedback {
    uint64_t map[COVERAGE_WORDS];  /* reached by any trial */
    uint64_t held[COVERAGE_WORDS]; /* by a kept one */
    uint64_t reached[COVERAGE_BITS];
    /* Each reached a bit that those before it had not, so that there is room for all. */
    struct feedback_entry entry[COVERAGE_BITS];
    size_t count, bytes, bytes_most;
};

/* What a trial takes in memory. */
size_t feedback_bytes(const struct fuzz_trial *trial);

#endif
