/* Parts of raydiff tree --aim that need no driver. */
#ifndef CMD_TREE_AIM_H
#define CMD_TREE_AIM_H

#include "cmd/tree/cmd_tree_dump.h"
#include "ref/base/rng.h"
#include "ref/world/world.h"

struct aiming {
    const struct tree_told *told;
    const struct dump_side *goal; /* of each ray */
    struct ray *ray;
    uint32_t count;
};

/* Draws a ray along an axis, in a plane beyond the bound of `goal`, that meets a triangle of the
 * instance there but for roundings. Each triangle of which a vertex is beyond the bound may be
 * drawn. Returns false if there is none. */
bool tree_aim_ray(const struct tree_dump *dump, const struct dump_side *goal, struct rng *rng,
                  struct ray *out);

/* Adds two points, as triangles, to the last geometry of each mesh, so that the mesh's box is
 * larger at each side by a quarter of its size and by 2^-10 of its greatest coordinate, as far as
 * float32 goes. A mesh without triangles stays as it is. Errors: STATUS_MEMORY; STATUS_LIMIT the
 * world then has too many triangles; it can then only be freed. */
enum status tree_aim_enlarge(struct world *world, struct reason *reason) MUST_USE;

/* Counts, from the instance that each ray hits exactly, by the driver, and by the driver in the
 * enlarged world: of the rays that exactly hit the instance aimed at those that the driver loses,
 * and of these those that it then finds, with the first of them. *out has been zeroed but for
 * `done` and `tries`. */
void tree_aim_count(const struct aiming *aiming, const uint32_t *exact, const uint32_t *driver,
                    const uint32_t *larger, struct tree_aimed *out);

#endif
