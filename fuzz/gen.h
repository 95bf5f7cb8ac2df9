/* The generators of trials: stream `gen` is a pure function of campaign seed, index and version,
 * the same bytes on any machine, thread or shard. */
#ifndef FUZZ_GEN_H
#define FUZZ_GEN_H

#include "fuzz/trial.h"

/* Raised whenever a generator makes other bytes of the same seed and index. */
#define GEN_VERSION 1u

struct gen_options {
    uint32_t triangles_least, triangles_most; /* of an ordinary trial [16, 64]; the ones about
                                                 limits are larger and rare */
    uint32_t rays;                            /* of a trial [500] */
    bool faithful;                            /* members as published take part too */
};

/* Errors: STATUS_MEMORY. */
enum status gen_trial(uint64_t seed, uint64_t index, const struct gen_options *options,
                      struct fuzz_trial *out, struct reason *reason) MUST_USE;

/* One edit of a trial, for stream `mut`: snap to a lattice, next float, negate, swap axes, scale by
 * 2^k, duplicate, permute, ... Errors: STATUS_MEMORY; the trial is then unchanged. */
struct rng;
enum status gen_mutate(struct rng *rng, struct fuzz_trial *trial, struct reason *reason) MUST_USE;

#endif
