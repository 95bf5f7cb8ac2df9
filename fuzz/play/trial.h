/* A fuzz trial: everything that decides a test, by value: a scene or a world, how its tree is
 * built, stored and moved, the tests, the query, the rays and what they may meet. Which layouts and
 * engines play it is the campaign's choice. */
#ifndef FUZZ_TRIAL_H
#define FUZZ_TRIAL_H

#include "fuzz/play/trial_world.h"
#include "ref/tree/bvh.h"
#include "ref/primitives/primitives.h"
#include "ref/store.h"
#include "scenes/life_steps.h"

#define FUZZ_TRIANGLES_MOST 131072u /* of a trial; generated ones are far smaller */
#define FUZZ_RAYS_MOST      65536u
#define FUZZ_PASSES_MOST    16u   /* of optimization */
#define FUZZ_MOVE_MOST      64.0f /* extents of the scene */
#define FUZZ_PRESPLIT_MOST  4.0f  /* parts made before the build, of the triangles */

/* Where a trial comes from. */
struct fuzz_origin {
    uint64_t seed, index; /* of the campaign, and in its stream */
    uint32_t version;     /* GEN_VERSION of the generators; 0: from a file */
    bool mutated;         /* stream `mut`: not a function of seed and index, stored whole */
    char recipe[200];     /* what was made, for people */
};

/* Owns scene, world and rays (fuzz_trial_free). */
struct fuzz_trial {
    struct fuzz_origin origin;
    struct scene scene; /* of a world: its meshes, one after the other */
    struct trial_world world;
    struct ray *ray;
    uint32_t ray_count;
    const struct builder *builder;
    struct build_options build;
    const struct box_test *box;
    const struct tri_test *tri;
    enum query query; /* closest or any */
    const struct tri_store *store;
    /* The scene is what is traced; the tree is built of it at rest, that is scene_move of it with
     * these, and then refitted (fuzz/play/trial_tree.h). 0: it never moved, as no world does. */
    float move;
    uint64_t move_seed;
    /* Or the tree, and what engines make of it, lives through these steps. The scene is again what
     * is traced, after the last of them; before step i it is what motion i makes of the scene after
     * that step (fuzz/play/trial_life.h); so is the world, of which motions of vertices move those
     * of all meshes together. Not with `move`. */
    struct step step[LIFE_STEPS_MOST];
    uint32_t step_count;
};

/* A trial of a scene, of default members, with room for that many vertices, triangles and rays, all
 * zero. Errors: STATUS_LIMIT over the most; STATUS_MEMORY. *out is zero on error. */
enum status fuzz_trial_make(uint32_t vertices, uint32_t triangles, uint32_t rays,
                            struct fuzz_trial *out, struct reason *reason) MUST_USE;

/* A deep copy. Errors: STATUS_MEMORY. */
enum status fuzz_trial_copy(const struct fuzz_trial *trial, struct fuzz_trial *out,
                            struct reason *reason) MUST_USE;

void fuzz_trial_free(struct fuzz_trial *trial); /* a zero one is fine */

/* A hash of all that decides the test, origin left out: equal trials have equal hashes on any
 * machine. 64 bits, FNV-1a over the bits in a fixed order. */
uint64_t fuzz_trial_hash(const struct fuzz_trial *trial);

/* The rays from number `first` on, with what they may meet: a trial that borrows all it has. */
struct fuzz_trial fuzz_trial_rays_from(const struct fuzz_trial *trial, uint32_t first,
                                       uint32_t count);

/* How much there is to read: what the shrinker reduces. Compared in this order. */
struct fuzz_trial_size {
    uint32_t steps;
    uint32_t instances; /* 0 of a scene */
    uint32_t triangles, rays, vertices;
    uint32_t places; /* trial_world_places */
    uint64_t bits; /* of all numbers: 0 for 0, a tmax of infinity and the defaults of members, else
                      significant ones and those of the exponent; 1 for a vertex out of order */
    uint64_t hash; /* fuzz_trial_hash: so that of two different trials one is the smaller */
};

struct fuzz_trial_size fuzz_trial_size(const struct fuzz_trial *trial);
/* Below 0: a is smaller; 0: the same trial; above 0: b is. */
int fuzz_trial_size_compare(const struct fuzz_trial_size *a, const struct fuzz_trial_size *b);

/* Rejects what no reader may let through: indices out of range, vertices that are not finite, no
 * builder, test or storage, a storage that the triangle test cannot read, parts for a builder that
 * takes none, what trial_world_check rejects, a world that moves, steps of what moves, limits. Rays
 * may hold any bits.
 * Errors: STATUS_INPUT, STATUS_LIMIT; STATUS_MEMORY of a world. */
enum status fuzz_trial_check(const struct fuzz_trial *trial, struct reason *reason) MUST_USE;

#endif
