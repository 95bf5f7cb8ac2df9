/* Worlds to be judged, and an honest tracer of them, written from ref/world/object_ray.h and
 * ref/world/world.h: every triangle of every instance, each operation rounded as it is told. */
#ifndef TESTS_HONEST_WORLD_H
#define TESTS_HONEST_WORLD_H

#include "ref/judge/judge_world.h"
#include "ref/twin/twin_placed.h"
#include "tests/exact/legal.h"

/* A world with what is needed to trace and to judge it. */
struct judged_world {
    struct world world;
    struct twin_place *place; /* of each instance; zeros of those without a mesh */
    struct oracle *oracle;
    bool affine; /* rays go by o' = W o - W T, as in tracers that are not ours: it cancels */
};

#define WORLD_MOST_HITS 64

/* Draws a world of a closed mesh and a soup of triangles in some instances, whose transforms are of
 * kinds that keep rays in contract; masks, flags, custom indices and filter at random. */
void judged_world_make(uint64_t seed, struct judged_world *out);

/* The same of a world made elsewhere, which is taken; it has passed world_finish. */
void judged_world_of(struct world world, struct judged_world *out);
void judged_world_free(struct judged_world *w);

/* Aims a ray at a random placed triangle: its inside, an edge, a vertex or a point beside. */
struct ray judged_world_aim(const struct judged_world *w, struct rng *rng);

/* A random mode; often ray_mode_all. */
struct ray_mode judged_world_mode(struct rng *rng);

/* What is exactly hit. */
struct oracle_answer judged_world_truth(const struct judged_world *w, const struct ray *ray,
                                        struct ray_mode mode);

/* Traces one ray. */
void honest_world_trace(const struct judged_world *w, enum twin_formula formula,
                        struct legal *legal, const struct ray *ray, struct ray_mode mode,
                        enum query query, struct hit *hit, uint32_t *tag);

/* Every candidate that counts, by t, then by number; at most WORLD_MOST_HITS. Returns how many. */
size_t honest_world_list(const struct judged_world *w, enum twin_formula formula,
                         struct legal *legal, const struct ray *ray, struct ray_mode mode,
                         struct hit hit[WORLD_MOST_HITS], uint32_t tag[WORLD_MOST_HITS]);

#endif
