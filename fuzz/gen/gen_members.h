/* Random builders and tests: members as published only if `faithful`; one in four is a member that
 * the products of tests leave out. */
#ifndef FUZZ_GEN_MEMBERS_H
#define FUZZ_GEN_MEMBERS_H

#include "fuzz/play/trial.h"
#include "ref/base/rng.h"

const struct builder *gen_builder(struct rng *rng, bool faithful);
const struct box_test *gen_box_test(struct rng *rng, bool faithful);
const struct tri_test *gen_tri_test(struct rng *rng, bool faithful);

/* 1 to 8, most often 4; with `faithful` rarely up to 16, which 16-byte layouts refuse. */
uint32_t gen_leaf(struct rng *rng, bool faithful);

/* The published builder's threshold: its default, 0, or a power of two down to 2^-30. */
float gen_eps(struct rng *rng);

/* Extents of the scene that vertices move by after the tree was built: 2^-10, as from one picture
 * of an animation to the next, to 2. */
float gen_move(struct rng *rng);

/* The share of parts that are cut from triangles before the build of a trial: none, or 1/16 to 2 if
 * the builder takes them. Drawn apart from the rest, which is as it was before there were parts. */
float gen_presplit(uint64_t seed, uint64_t index, const struct builder *builder);

/* Gives 1 trial in 64 of 512 triangles at most 1 to 4 steps, or `every` one. Drawn apart, too. */
void gen_steps(uint64_t seed, uint64_t index, bool every, struct fuzz_trial *trial);

#endif
