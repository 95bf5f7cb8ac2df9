#include "ref/explain/oriented.h"

#include "ref/packed/packed_walk.h"
#include "ref/primitives/slab.h"

#include <math.h>
#include <stdlib.h>

/* --- what is below ---------------------------------------------------------------------------- */

enum status explain_map_oriented(struct explain_tree *tree)
{
    const struct packed *packed = tree->packed;
    struct packed_walk walk;
    struct oblique_bounds *bounds = NULL;
    if (!packed->layout->oblique)
        return STATUS_OK;
    enum status status = packed_walk_make(packed, &walk);
    if (!status)
        status = packed_oblique_make(packed, tree->scene, &walk, &bounds);
    tree->oriented = alloc_zeroed(packed->ref_count, sizeof *tree->oriented);
    if (!tree->oriented)
        status = STATUS_MEMORY;
    for (uint32_t r = 0; !status && r < packed->ref_count; r++)
        tree->oriented[r] = (struct oblique_bounds){{1, 1, 1}, {0, 0, 0}}; /* empty */
    for (uint32_t v = 0; !status && v < walk.visit_count; v++)
        tree->oriented[walk.visit[v].ref] = bounds[v];
    free(bounds);
    packed_walk_free(&walk);
    return status;
}

bool oriented_needs(const struct explain_tree *tree, uint32_t ref, uint32_t child, float lo[3],
                    float hi[3])
{
    float axis[3][3];
    if (!tree->oriented || !packed_oblique_axes(tree->packed, ref, child, axis))
        return false;
    for (uint32_t j = 0; j < 3; j++) {
        lo[j] = tree->oriented[child].lo[j];
        hi[j] = tree->oriented[child].hi[j];
    }
    return lo[0] <= hi[0];
}

bool oriented_is_loose(const struct explain_tree *tree, uint32_t ref, uint32_t child)
{
    uint32_t axis;
    return tree->oriented &&
           !packed_oblique_holds(tree->packed, ref, child, &tree->oriented[child], &axis);
}

/* --- the test --------------------------------------------------------------------------------- */

static float along(const struct oriented_rule *rule, const struct oblique_box *box, uint32_t j,
                   const float of[3])
{
    const float(*a)[3] = box->axis;
    if (rule->turned)
        return (a[0][j] * of[0] + a[1][j] * of[1]) + a[2][j] * of[2];
    return (a[j][0] * of[0] + a[j][1] * of[1]) + a[j][2] * of[2];
}

bool oriented_by_rule(const struct oriented_rule *rule, const struct oblique_box *box,
                      const struct oblique_ray *ray, float tmax)
{
    float near = ray->least, far = tmax, slack = box->slack;
    for (uint32_t j = 0; j < 3; j++) {
        const uint32_t from = rule->shifted ? (j + 1) % 3 : j;
        const float org = along(rule, box, j, ray->org), dir = along(rule, box, j, ray->dir);
        const float beside = box->beside[j];
        const float lo = box->lo[from] - beside, hi = box->hi[from] + beside;
        if (dir == 0.0f && (org < lo || org > hi))
            return true;
        if (dir == 0.0f)
            continue;
        const float inv = 1.0f / dir, a = (lo - org) * inv, b = (hi - org) * inv;
        near = fmaxf(near, fminf(a, b));
        far = fminf(far, fmaxf(a, b));
    }
    return near - fabsf(near) * slack > far + fabsf(far) * slack;
}

static double along_exactly(const float axis[3], const float of[3])
{
    return (double)axis[0] * (double)of[0] + (double)axis[1] * (double)of[1] +
           (double)axis[2] * (double)of[2];
}

/* Both distances of the bounds, `by` farther apart. */
static void distances(const struct oblique_box *box, const struct oblique_ray *ray, uint32_t j,
                      double by, double *enter, double *leave)
{
    double org = along_exactly(box->axis[j], ray->org), dir = along_exactly(box->axis[j], ray->dir);
    double lo = (double)box->lo[j] - by, hi = (double)box->hi[j] + by;
    *enter = lo <= org && org <= hi ? -INFINITY : INFINITY;
    *leave = -*enter;
    if (dir == 0)
        return;
    *enter = fmin((lo - org) / dir, (hi - org) / dir);
    *leave = fmax((lo - org) / dir, (hi - org) / dir);
}

void oriented_axis_exact(const struct oblique_box *box, const struct oblique_ray *ray, uint32_t j,
                         double *enter, double *leave)
{
    distances(box, ray, j, 0, enter, leave);
}

/* What woop moves a triangle by, and more than all roundings here: as layout obb8 has it, but of
 * the box in place of the node. */
#define WIDER 0x1p-18

bool oriented_conservative(const struct oblique_box *box, const struct oblique_ray *ray, float tmax)
{
    double near = (double)ray->least, far = (double)tmax;
    for (uint32_t j = 0; j < 3; j++) {
        double enter, leave, size = fmax(fabs((double)box->lo[j]), fabs((double)box->hi[j]));
        double sum = 0;
        for (uint32_t k = 0; k < 3; k++) {
            size += fabs((double)box->axis[j][k]) * fabs((double)ray->org[k]);
            sum += fabs((double)box->axis[j][k]);
        }
        distances(box, ray, j, size * WIDER + sum * (double)ray->by, &enter, &leave);
        near = fmax(near, enter);
        far = fmin(far, leave);
    }
    return near - fabs(near) * WIDER > far + fabs(far) * WIDER;
}

struct oblique_ray oriented_ray(const struct ray *ray, const struct box *root)
{
    struct slab_ray slab = slab_ray_make(ray);
    slab_ray_place(&slab, root);
    return (struct oblique_ray){.org = {slab.o[0], slab.o[1], slab.o[2]},
                                .dir = {slab.d[0], slab.d[1], slab.d[2]},
                                .by = slab.by,
                                .least = slab.tmin * SLAB_NEAR - slab.behind};
}

bool oriented_misses(const struct explain_tree *tree, uint32_t repairs, enum defect defect,
                     uint32_t ref, uint32_t child, const struct oblique_ray *ray, float tmax)
{
    const struct packed *packed = tree->packed;
    const struct oriented_rule rule = {.turned = defect == DEFECT_ORIENTED_TURNED,
                                       .shifted = defect == DEFECT_ORIENTED_SHIFTED};
    struct oblique_box box;
    if (!packed->layout->oblique || !packed->layout->oblique(packed, ref, child, ray, &box))
        return packed->layout->misses(packed, ref, child, ray, tmax);
    if ((repairs >> REPAIR_ORIENTED_BOX & 1u) && oriented_is_loose(tree, ref, child))
        return false;
    if (repairs >> REPAIR_ORIENTED_TEST & 1u)
        return oriented_conservative(&box, ray, tmax);
    if (rule.turned || rule.shifted)
        return oriented_by_rule(&rule, &box, ray, tmax);
    return packed->layout->misses(packed, ref, child, ray, tmax);
}
