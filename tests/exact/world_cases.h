/* Worlds that decide whether the oracle's arithmetic is exact: kinds of transforms, and small
 * worlds of them with rays that have to do with their triangles. For tests of the oracle. */
#ifndef TESTS_WORLD_CASES_H
#define TESTS_WORLD_CASES_H

#include "ref/base/rng.h"
#include "ref/oracle/oracle_world.h"

#define WORLD_TURNS 15

/* A kind of transform. */
struct world_turn {
    const char *name;
    void (*make)(struct rng *rng, float m[3][4]);
    bool whole; /* it takes small whole numbers to floats, so that rays can meet edges exactly */
};

extern const struct world_turn world_turns[WORLD_TURNS];

/* A transform of a kind whose determinant is not 0. */
void world_turn_draw(const struct world_turn *turn, struct rng *rng, float m[3][4]);

#define WORLD_RAYS 12

struct world_case {
    struct world world;
    struct oracle *oracle;
    struct ray ray[WORLD_RAYS];
    struct ray_mode mode[WORLD_RAYS];
};

/* A world of two meshes of a few triangles, with several geometries, in some instances of one kind
 * of transform and of others, among them two at one place, an inactive one and one at the identity;
 * masks, flags and filter at random. */
void world_case_make(const struct world_turn *turn, uint64_t seed, struct world_case *out);
void world_case_free(struct world_case *c);

/* Aims a ray at a placed triangle: at its inside, an edge or a vertex, or along its plane. */
void world_case_aim(const struct world *world, bool whole, struct rng *rng, struct ray *ray);

/* A random mode that ray_mode_check passes. */
struct ray_mode world_mode_draw(struct rng *rng);

#endif
