/* The states that a trial reached: a fixed map of bits, set from the tree, the packed bytes, the
 * truth and the judgements. A trial that sets a bit which no earlier one set is worth keeping. A
 * map is a pure function of a trial and the answers to it. */
#ifndef FUZZ_COVERAGE_H
#define FUZZ_COVERAGE_H

#include "fuzz/play/trial.h"
#include "ref/judge/judge.h"
#include "ref/layout.h"

#define COVERAGE_BITS  640u
#define COVERAGE_WORDS (COVERAGE_BITS / 64)

/* The tree: depth, size of leaves, which members and storage, whether optimized, how large the
 * scene is, boxes without thickness, how near the numbers of items, records and indices are to the
 * 16-byte layouts' limits. */
void coverage_add_tree(uint64_t map[COVERAGE_WORDS], const struct fuzz_trial *trial,
                       const struct bvh *bvh);

/* The packed bytes: which layout, whether of a split tree, how much stack they need, and, in
 * layouts of 16-byte records, what the stored halves are: infinite, the largest, 2^-14, subnormal,
 * zero, negative zero, exact, rounded. Looks at no more than 4096 nodes. */
void coverage_add_packed(uint64_t map[COVERAGE_WORDS], const struct packed *packed);

/* A packed tree was refitted to vertices that moved, or built anew. */
void coverage_add_motion(uint64_t map[COVERAGE_WORDS], bool rebuilt);

/* A layout refused the tree: which layout, and by which of its limits. */
void coverage_add_refusal(uint64_t map[COVERAGE_WORDS], const struct layout *layout,
                          const struct fuzz_trial *trial, const struct bvh *bvh);

/* A world: how far its transforms are from the identity, instances that are not active, masks,
 * flags, filters, and the rays' masks and flags. */
void coverage_add_world(uint64_t map[COVERAGE_WORDS], const struct trial_world *world,
                        uint32_t rays);

/* A ray and its exact truth; `root` is the root's box. */
void coverage_add_truth(uint64_t map[COVERAGE_WORDS], const struct ray *ray, const struct box *root,
                        const struct oracle_answer *truth);

/* An engine's answer: the verdict of that query, what kind of wrong, err/E and displacement in
 * powers of two. */
void coverage_add_answer(uint64_t map[COVERAGE_WORDS], enum query query,
                         const struct judgement *judgement);

/* The verdicts of all contestants on one ray, as a mask of 1u << verdict: each pair of different
 * verdicts is a bit. */
void coverage_add_verdicts(uint64_t map[COVERAGE_WORDS], uint32_t mask);

/* Adds `from` to `into`; returns how many bits are new. */
uint32_t coverage_merge(uint64_t into[COVERAGE_WORDS], const uint64_t from[COVERAGE_WORDS]);

/* Bits set. */
uint32_t coverage_count(const uint64_t map[COVERAGE_WORDS]);

/* The number of bits that have a meaning; the others are never set. */
uint32_t coverage_known(void);

/* How many of them a trial of a world, or one of a scene, can have. */
uint32_t coverage_reachable(bool world);

#define COVERAGE_NAME_MOST 64

/* "verdict.closest.tie", "refused.rf16.records", ...; false, and "", for a bit without meaning. */
bool coverage_name(uint32_t bit, char name[COVERAGE_NAME_MOST]);

#endif
