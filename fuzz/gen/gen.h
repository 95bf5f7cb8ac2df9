/* The generators of trials: stream `gen` is a pure function of campaign seed, index, options and
 * version, the same bytes on any machine, thread or shard, in any floating-point mode: only + - * /
 * of float32 are used, no function of libm. */
#ifndef FUZZ_GEN_H
#define FUZZ_GEN_H

#include "fuzz/play/trial.h"

/* Raised whenever other bytes are made of the same seed and index, of scenes or of worlds: by
 * another generator or edit, or by a builder or test that comes or goes. Version 8 has version 7's
 * trials, and gives some of them steps. */
#define GEN_VERSION 8u
/* Mixed into the seeds. Since version 5 only members have come, so that most trials are drawn as
 * before. */
#define GEN_SALT 5u

struct gen_options {
    uint32_t triangles_least, triangles_most; /* of an ordinary trial before its edits [16, 64];
                                                 rare ones are about limits and are larger, 1 in
                                                 2048, or of 0 to 15, 1 in 49 */
    uint32_t rays;                            /* of a trial [500] */
    bool faithful;                            /* members as published take part too */
    bool worlds; /* trials of worlds; triangles are those of all meshes together, and limits are not
                    looked for */
    bool steps;  /* every trial that can have steps has some, those of 1 scene in 64 as they are
                   without */
};

/* Makes a trial: a recipe, no edit or one to three, members, and rays of which 3 in 4 are aimed at
 * features. 1 <= triangles_least <= triangles_most. Errors: STATUS_MEMORY; STATUS_LIMIT more rays
 * or triangles than a trial may have. */
enum status gen_trial(uint64_t seed, uint64_t index, const struct gen_options *options,
                      struct fuzz_trial *out, struct reason *reason) MUST_USE;

/* One edit of a trial, for stream `mut`, that changes something: snap to a lattice, next float,
 * negate, swap axes, scale by 2^k, duplicate, permute, ... (fuzz/gen/mutate.c has the table, of a
 * world fuzz/gen/mutate_world.c another one). Notes its name in the recipe. Errors: STATUS_MEMORY;
 * the trial is then unchanged. */
struct rng;
enum status gen_mutate(struct rng *rng, struct fuzz_trial *trial, struct reason *reason) MUST_USE;

#endif
