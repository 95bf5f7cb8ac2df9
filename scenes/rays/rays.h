/* Ray sets by name, count and seed. */
#ifndef RAYS_H
#define RAYS_H

#include "ref/abi.h"
#include "ref/scene/scene.h"

struct rng;
struct stage; /* scenes/rays/rays_stage.h */

/* A ray set, made by ray_set_make. */
struct ray_set {
    const char *name;
    const char *summary;
    /* Makes ray i from its own random numbers; NULL: see `all`. `tag` is an enum stage_tag. */
    void (*one)(const struct stage *stage, struct rng *rng, size_t i, struct ray *out);
    unsigned tag;
    /* Makes all rays. Set only if `one` is NULL. */
    enum status (*all)(const struct scene *scene, uint64_t seed, size_t count, struct ray *out,
                       struct reason *reason);
    bool seedless; /* the rays do not depend on the seed */
};

#define RAY_TMAX 1e30f

/* NULL-terminated. The first is the default: a mix of all others in equal parts. */
extern const struct ray_set *const ray_sets[];

const struct ray_set *ray_set_find(const char *name); /* or NULL */

/* Makes `count` rays. Ray i depends on scene, seed and count only. Rays have tmin 0 and tmax
 * RAY_TMAX (1e30f) unless the set's summary states otherwise. Errors: STATUS_INPUT no camera ray
 * hits the scene (bounce), a camera that is not finite or too far away; STATUS_MEMORY. */
enum status ray_set_make(const struct ray_set *set, const struct scene *scene, uint64_t seed,
                         size_t count, struct ray *out, struct reason *reason) MUST_USE;

/* The same with *out allocated. The caller frees *out, also after an error. */
enum status ray_set_new(const struct ray_set *set, const struct scene *scene, uint64_t seed,
                        size_t count, struct ray **out, struct reason *reason) MUST_USE;

#endif
