/* Axis-parallel rays. */
#include "scenes/rays/rays_stage.h"

#include <math.h>

/* A coordinate that often ties: of vertex `p` (mostly), of another vertex, of the middle of an
 * edge, of the border of the scene's box; or a random one in the box. */
static float coordinate(const struct stage *stage, struct rng *rng, const float p[3], int k)
{
    float v[3][3];
    stage_triangle(stage, rng, v);
    switch (rng_below(rng, 8)) {
    case 0:
        return stage->box.lo[k];
    case 1:
        return stage->box.hi[k];
    case 2:
        return v[0][k];
    case 3:
        return 0.5f * v[0][k] + 0.5f * v[1][k];
    case 4:
        return rng_range(rng, stage->box.lo[k], stage->box.hi[k]);
    default:
        return p[k];
    }
}

/* Start of the ray on its axis: before the scene (mostly), on its border, at vertex `p`, or
 * anywhere inside. */
static float start(const struct stage *stage, struct rng *rng, const float p[3], int k,
                   bool forward)
{
    float lo = stage->box.lo[k], hi = stage->box.hi[k];
    switch (rng_below(rng, 8)) {
    case 0:
        return forward ? lo : hi;
    case 1:
        return p[k];
    case 2:
        return rng_range(rng, lo, hi);
    default:
        return forward ? lo - 0.25f * stage->extent : hi + 0.25f * stage->extent;
    }
}

static void axis_ray(const struct stage *stage, struct rng *rng, size_t i, struct ray *out)
{
    float v[3][3], org[3], dir[3];
    int axis = (int)(i % 3);
    bool forward = rng_below(rng, 2);
    bool planar = rng_below(rng, 8) == 0; /* two nonzero components */
    stage_triangle(stage, rng, v);
    const float *p = v[rng_below(rng, 3)];
    float length = ldexpf(1.0f, (int)rng_below(rng, 7) - 3);
    for (int k = 0; k < 3; k++) {
        if (k == axis) {
            dir[k] = forward ? length : -length;
            org[k] = start(stage, rng, p, k, forward);
        } else {
            dir[k] = rng_below(rng, 2) ? -0.0f : 0.0f;
            org[k] = coordinate(stage, rng, p, k);
        }
    }
    if (planar) {
        int second = (axis + 1 + (int)rng_below(rng, 2)) % 3;
        dir[second] = rng_range(rng, -length, length);
    }
    stage_ray(org, dir, out);
}

const struct ray_set ray_set_axis = {
    .name = "axis",
    .summary = "along an axis, other components 0 or -0, through vertices, borders and planes",
    .one = axis_ray,
    .tag = STAGE_AXIS,
};
