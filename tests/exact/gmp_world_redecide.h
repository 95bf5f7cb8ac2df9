/* Decides an answer to a ray in a world that was judged WRONG once more, by rationals alone: what a
 * ray may meet by tests/exact/gmp_world.c; of an engine of ours whose bits are promised, what its
 * formula makes of each triangle by tests/exact/gmp_object_ray.c and exact_gmp_replay.c; of others,
 * what stays true however far their vertices may be off, by tests/exact/gmp_steady.c. Neither the
 * oracle nor the twins nor the judge have a part in it. */
#ifndef GMP_WORLD_REDECIDE_H
#define GMP_WORLD_REDECIDE_H

#include "ref/world/world.h"
#include "tests/exact/exact_gmp_redecide.h"

struct gmp_world_question {
    const struct world *world;
    const struct ray *ray; /* finite */
    struct ray_mode mode;  /* with ABI_RAY_FIRST nothing needs to be the nearest */
    const struct model *model;
    bool any; /* likewise; with model->any_unnamed a hit's triangle, numbers and tag are not looked
                 at */
    const struct hit *hit;
    uint32_t tag;
};

/* Costs some 100 ns per placed triangle, and up to 200 us more for each that is near the ray's
 * line. */
struct gmp_second gmp_world_redecide(const struct gmp_world_question *question);

#endif
