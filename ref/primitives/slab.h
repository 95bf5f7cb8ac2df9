/* Ray against axis-aligned box, f32. Static inline because they are the inner loop. The shader has
 * the same operations in the same order, written separately (shaders/slab.glsl). */
#ifndef SLAB_H
#define SLAB_H

#include "ref/abi.h"
#include "ref/scene/scene.h"

/* A non-zero direction component below this fraction of the largest one is treated as parallel and
 * is out of contract; see ray_in_contract. */
#define SLAB_PARALLEL 0x1p-60f

/* Far plane factor of the robust test, 1 + 2^-19: more than every rounding that Vulkan's default
 * precision allows in (b - o) * (1 / d) twice; numerics of the proof in docs/traversal.md. */
#define SLAB_FAR 0x1.00002p0f

/* Allowance of the watertight test on the near plane: a factor, and a fraction of the scene's
 * extent behind the origin. See slab_watertight. */
#define SLAB_NEAR   (1.0f - 0x1p-18f)
#define SLAB_BEHIND 0x1p-19f

/* Half width by which the published test widens a box, and its value for infinity, 2^38. */
#define SLAB_RTRS_EPS 0.000002f
#define SLAB_RTRS_INF 0x1p38f

/* Ray data for the box tests, computed once per ray. */
struct slab_ray {
    float o[3];
    float near[3]; /* where the plane that is met first is measured from, and the other one: o, */
    float far[3];  /* or beside it, see slab_ray_widen */
    float d[3];
    float inv[3]; /* 1 / d, 0 where parallel */
    bool parallel[3];
    int main;     /* the largest axis of |d|, the first of equal ones: the axis of woop's shear */
    float behind; /* for slab_watertight: SLAB_BEHIND times the scene's extent behind the origin */
    float tmin;
    float by; /* of slab_ray_widen, else 0 */
};

static inline struct slab_ray slab_ray_make(const struct ray *ray)
{
    struct slab_ray r = {.tmin = ray->tmin};
    float largest = 0.0f;
    for (int k = 0; k < 3; k++) {
        float a = ray->dir[k] < 0.0f ? -ray->dir[k] : ray->dir[k];
        r.main = a > largest ? k : r.main;
        largest = a > largest ? a : largest;
    }
    float least = SLAB_PARALLEL * largest;
    for (int k = 0; k < 3; k++) {
        float a = ray->dir[k] < 0.0f ? -ray->dir[k] : ray->dir[k];
        r.o[k] = r.near[k] = r.far[k] = ray->org[k];
        r.d[k] = ray->dir[k];
        r.parallel[k] = !(a > 0.0f) || a < least; /* NaN is parallel, and lies in no box */
        r.inv[k] = r.parallel[k] ? 0.0f : 1.0f / ray->dir[k];
    }
    return r;
}

/* From now on slab_robust and slab_watertight take every box for `by` wider on all sides, at least:
 * the planes are measured from points `by` beside the origin, so that a box costs no more. What an
 * axis lacks by rounding is at most 2^-24 (|o| + by), 2^-23 of it where Vulkan rounds freely. 0
 * changes nothing, bit for bit. slab_rtrs stays as published. */
static inline void slab_ray_widen(struct slab_ray *r, float by)
{
    r->by = by > 0.0f ? by : 0.0f;
    for (int k = 0; k < 3 && by > 0.0f; k++) {
        bool down = r->d[k] < 0.0f && !r->parallel[k]; /* the upper plane is met first */
        float more = r->o[k] + by, less = r->o[k] - by;
        r->near[k] = down ? less : more;
        r->far[k] = down ? more : less;
    }
}

/* Conservative slab test: true if the exact ray meets the box at a t in [tmin, tbest], for IEEE
 * arithmetic and for every Vulkan rounding. *entry is the computed entry distance, >= tmin.
 * Parallel axes are decided by comparison, so no NaN or infinity is involved. */
static inline bool slab_robust(const struct slab_ray *r, const struct box *box, float tbest,
                               float *entry)
{
    float tn = r->tmin, tf = tbest;
    bool ok = true;
    for (int k = 0; k < 3; k++) {
        if (r->parallel[k]) {
            ok = ok && box->lo[k] <= r->near[k] && r->far[k] <= box->hi[k];
        } else {
            float a = ((r->d[k] < 0.0f ? box->hi[k] : box->lo[k]) - r->near[k]) * r->inv[k];
            float b = ((r->d[k] < 0.0f ? box->lo[k] : box->hi[k]) - r->far[k]) * r->inv[k];
            float bp = b * SLAB_FAR;
            tn = a > tn ? a : tn;
            tf = bp < tf ? bp : tf;
        }
    }
    *entry = tn;
    return ok && tn <= tf; /* flat boxes have tn == tf */
}

/* Sets r->behind from the scene's extent behind the ray's origin, in t along its main axis;
 * `bounds` contains every vertex. Call it once, before slab_watertight. */
static inline void slab_ray_place(struct slab_ray *r, const struct box *bounds)
{
    int k = r->main;
    float near = r->d[k] < 0.0f ? bounds->hi[k] : bounds->lo[k];
    float t = (near - r->o[k]) * r->inv[k];
    r->behind = t < 0.0f ? -t * SLAB_BEHIND : 0.0f;
}

/* The robust test for woop. It is also true if woop accepts a triangle in the box only because its
 * own rounding moved the triangle onto the ray. Woop is watertight over all triangles, but the
 * triangle that it accepts need not be one that the exact ray hits. If a triangle extends behind
 * the origin, the error does not shrink with the distance of the hit, so no factor covers it. The
 * best hit ends the range exactly, so the whole allowance is on the near side: otherwise the best
 * hit would cull boxes with less allowance. Proof in docs/numerics.md.
 * *entry can be below tmin, even negative. */
static inline bool slab_watertight(const struct slab_ray *r, const struct box *box, float tbest,
                                   float *entry)
{
    float tn = r->tmin, tf = tbest;
    bool ok = true;
    for (int k = 0; k < 3; k++) {
        if (r->parallel[k]) {
            ok = ok && box->lo[k] <= r->near[k] && r->far[k] <= box->hi[k];
        } else {
            float a = ((r->d[k] < 0.0f ? box->hi[k] : box->lo[k]) - r->near[k]) * r->inv[k];
            float b = ((r->d[k] < 0.0f ? box->lo[k] : box->hi[k]) - r->far[k]) * r->inv[k];
            tn = a > tn ? a : tn;
            tf = b < tf ? b : tf;
        }
    }
    *entry = tn * SLAB_NEAR - r->behind;
    return ok && *entry <= tf;
}

/* The published test: widens by an absolute 2e-6, divides, and ignores y and z because its two
 * infinities are swapped (F1); `<` loses boxes flat in x (F14). It does not use the t range: *entry
 * is the entry distance in x. Kept bit for bit. */
static inline bool slab_rtrs(const struct slab_ray *r, const struct box *box, float *entry)
{
    float t0[3], t1[3];
    for (int k = 0; k < 3; k++) {
        t0[k] = (box->lo[k] - SLAB_RTRS_EPS - r->o[k]) / r->d[k];
        t1[k] = (box->hi[k] + SLAB_RTRS_EPS - r->o[k]) / r->d[k];
    }
    float tn = t0[0] < t1[0] ? t0[0] : t1[0];
    float tf = t1[0] < t0[0] ? t0[0] : t1[0];
    for (int k = 1; k < 3; k++) {
        float lesser = t0[k] < t1[k] ? t0[k] : t1[k];
        float greater = t1[k] < t0[k] ? t0[k] : t1[k];
        float low = lesser < -SLAB_RTRS_INF ? lesser : -SLAB_RTRS_INF;
        float high = greater > SLAB_RTRS_INF ? greater : SLAB_RTRS_INF;
        tn = low > tn ? low : tn;
        tf = high < tf ? high : tf;
    }
    *entry = tn;
    return tn < tf;
}

#endif
