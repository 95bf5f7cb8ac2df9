/* Ray sets by name, count and seed. */
#ifndef RAYS_H
#define RAYS_H

#include "ref/abi.h"
#include "ref/scene/scene.h"

/* A ray set. `make` fills `count` rays; ray i depends on (scene, seed, count) only. Rays have
 * tmin 0 and tmax infinity (1e30f) unless the set's summary says otherwise. */
struct ray_set {
    const char *name;
    const char *summary;
    enum status (*make)(const struct scene *scene, uint64_t seed, size_t count, struct ray *out,
                        struct reason *reason);
    bool seedless; /* whatever the seed, the rays are the same */
};

#define RAY_TMAX 1e30f

/* NULL-terminated; the first is the default, a mix of all others in equal parts. */
extern const struct ray_set *const ray_sets[];

const struct ray_set *ray_set_find(const char *name); /* or NULL */

#endif
