#include "ref/explain/outside.h"
#include "ref/primitives/test_run.h"

#include <float.h>

/* Unpadded slabs in which a direction component of 0 has the reciprocal `inverse`. */
static bool with_reciprocal(const struct ray *ray, const struct box *box, float inverse)
{
    float tn = ray->tmin, tf = ray->tmax;
    for (int k = 0; k < 3; k++) {
        float inv = ray->dir[k] == 0.0f ? inverse : 1.0f / ray->dir[k];
        float a = (box->lo[k] - ray->org[k]) * inv, b = (box->hi[k] - ray->org[k]) * inv;
        float near = inv < 0.0f ? b : a, far = inv < 0.0f ? a : b;
        tn = near > tn ? near : tn;
        tf = far < tf ? far : tf;
    }
    return tn <= tf;
}

static bool has_zero(const struct ray *ray)
{
    return ray->dir[0] == 0.0f || ray->dir[1] == 0.0f || ray->dir[2] == 0.0f;
}

size_t explain_outside(const struct scene *scene, const struct ray *ray, uint32_t prim,
                       struct outside_hint out[OUTSIDE_HINTS])
{
    struct box box = scene_tri_bounds(scene, prim);
    struct slab_ray slab = slab_ray_make(ray);
    struct slab_rule rule = slab_rule_of(ABI_BOX_ROBUST);
    size_t count = 0;
    float entry;
    rule.plain = false;
    if (has_zero(ray) && !with_reciprocal(ray, &box, 1e18f))
        out[count++] = (struct outside_hint){
            CAUSE_PARALLEL_AXIS,
            "a direction of 0 taken for 1e-18: a box that ends at the ray ends at t = 0"};
    if (has_zero(ray) && !with_reciprocal(ray, &box, FLT_MAX))
        out[count++] = (struct outside_hint){
            CAUSE_PARALLEL_AXIS,
            "1 / 0 taken for FLT_MAX: a box that ends at the ray ends at t = 0"};
    rule.far = 1.0f;
    if (!slab_by_rule(&rule, &slab, &box, ray->tmax, &entry))
        out[count++] = (struct outside_hint){CAUSE_BOX_PADDING_TOO_SMALL, "slabs without padding"};
    rule.far = 0x1.00002p0f;
    rule.form = SLAB_FORM_FUSED;
    if (!slab_by_rule(&rule, &slab, &box, ray->tmax, &entry))
        out[count++] = (struct outside_hint){CAUSE_BOX_TEST,
                                             "slabs as b / d - o / d, whose error is absolute"};
    return count;
}
