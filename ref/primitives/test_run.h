/* Runs a box or triangle test by its id. */
#ifndef TEST_RUN_H
#define TEST_RUN_H

#include "ref/primitives/slab.h"
#include "ref/primitives/tri_baldwin_webber.h"

/* True if t lies in [tmin, tmax] of the ray, strictly inside for mt_rtrs. */
static inline bool tri_in_range(uint32_t id, const struct tri_ray *r, float t)
{
    if (id == ABI_TRI_MT_RTRS)
        return t > r->tmin && t < r->tmax;
    return t >= r->tmin && t <= r->tmax;
}

/* Runs the triangle test `id` (ABI_TRI_*) on one triangle: true if it hits and its t lies in [tmin,
 * tmax] of the ray (strictly inside for mt_rtrs). On false *out is undefined. */
static inline bool tri_test_run(uint32_t id, const struct tri_ray *r, float v[3][3],
                                struct hit *out)
{
    bool hit;
    if (id == ABI_TRI_WOOP)
        hit = tri_woop(r, v, out);
    else if (id == ABI_TRI_PLUECKER)
        hit = tri_pluecker(r, v, out);
    else if (id == ABI_TRI_BALDWIN_WEBBER)
        hit = tri_baldwin_webber(r, v, out);
    else
        hit = tri_moeller_trumbore(r, v, id == ABI_TRI_MT_RTRS ? TRI_RTRS_EPS : 0.0f, out);
    return hit && tri_in_range(id, r, out->t);
}

/* Runs the box test `id` (ABI_BOX_*); call slab_ray_place first. */
static inline bool box_test_run(uint32_t id, const struct slab_ray *r, const struct box *box,
                                float tbest, float *entry)
{
    if (id == ABI_BOX_WATERTIGHT)
        return slab_watertight(r, box, tbest, entry);
    if (id == ABI_BOX_ROBUST)
        return slab_robust(r, box, tbest, entry);
    return slab_rtrs(r, box, entry);
}

#endif
