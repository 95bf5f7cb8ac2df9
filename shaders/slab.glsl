/* Ray against axis-aligned box: the operations of ref/primitives/slab.h in the same order. Bounds
 * are passed as the nearer and the farther plane, which are selected while loading. Every
 * comparison is true in the case that continues, so that a NaN is handled as in C even if the
 * driver inverts conditions. */
#ifndef SLAB_GLSL
#define SLAB_GLSL

#include "job.glsl"

#define SLAB_PARALLEL 8.67361737988403547e-19 /* 2^-60 */
#define SLAB_FAR 1.0000019073486328125 /* 1 + 2^-19 */
#define SLAB_NEAR 0.999996185302734375 /* 1 - 2^-18 */
#define SLAB_BEHIND 0.0000019073486328125 /* 2^-19 */
#define SLAB_RTRS_EPS 0.000002
#define SLAB_RTRS_INF 274877906944.0 /* 2^38 */

/* Values for a parallel axis, so that the test needs no special case: planes at a distance that no
 * range reaches do not narrow a range. AWAY * AWAY_PAD may overflow to infinity or not; both
 * work. */
#define SLAB_AWAY     3e38
#define SLAB_AWAY_PAD 4.0

struct slab_ray {
    vec3 o;
    vec3 d;
    vec3 inv;      /* 1 / d, 1 where parallel */
    vec3 o_near;   /* o or beside it (slab_ray_widen), AWAY where parallel */
    vec3 o_far;    /* likewise, -AWAY where parallel */
    vec3 pad;      /* SLAB_FAR, AWAY_PAD where parallel */
    vec3 at_most;  /* o where parallel, else infinity: at least the near plane of a box hit */
    vec3 at_least; /* o where parallel, else -infinity: at most the far plane of a box hit */
    uint main;     /* the largest axis of |d|, the first of equal ones */
    float behind;  /* watertight: SLAB_BEHIND of the scene's reach behind the origin */
    bvec3 swapped; /* the upper bound is met first */
    float tmin;
    float by; /* of slab_ray_widen, else 0 */
};

/* Componentwise pick. */
vec3 slab_select(bvec3 c, vec3 a, vec3 b)
{
    return vec3(pick(c.x, a.x, b.x), pick(c.y, a.y, b.y), pick(c.z, a.z, b.z));
}

/* Returns the bounds in the order in which the ray meets them. */
void slab_order(slab_ray r, vec3 lo, vec3 hi, out vec3 nearer, out vec3 farther)
{
    nearer = slab_select(r.swapped, hi, lo);
    farther = slab_select(r.swapped, lo, hi);
}

slab_ray slab_ray_make(vec3 o, vec3 d, float tmin)
{
    slab_ray r;
    bvec3 negative = lessThan(d, vec3(0.0));
    precise vec3 minus = -d;
    vec3 a = slab_select(negative, minus, d);
    float largest = 0.0;
    largest = pick(a.x > largest, a.x, largest);
    r.main = a.y > largest ? 1u : 0u;
    largest = pick(a.y > largest, a.y, largest);
    r.main = pick(a.z > largest, 2u, r.main);
    largest = pick(a.z > largest, a.z, largest);
    precise float least = SLAB_PARALLEL * largest;
    bvec3 crossing = bvec3(both(a.x > 0.0, a.x >= least), both(a.y > 0.0, a.y >= least),
                           both(a.z > 0.0, a.z >= least));
    precise vec3 inv = 1.0 / d;
    vec3 inf = vec3(uintBitsToFloat(0x7F800000u)); /* only compared, never computed with */
    r.o = o;
    r.d = d;
    r.inv = slab_select(crossing, inv, vec3(1.0));
    r.o_near = slab_select(crossing, o, vec3(SLAB_AWAY));
    r.o_far = slab_select(crossing, o, vec3(-SLAB_AWAY));
    r.pad = slab_select(crossing, vec3(SLAB_FAR), vec3(SLAB_AWAY_PAD));
    r.at_most = slab_select(crossing, inf, o);
    r.at_least = slab_select(crossing, uintBitsToFloat(floatBitsToUint(inf) | 0x80000000u), o);
    r.swapped = bvec3(both(negative.x, crossing.x), both(negative.y, crossing.y),
                      both(negative.z, crossing.z));
    if (BOX_TEST == ABI_BOX_RTRS) /* it orders the planes itself */
        r.swapped = bvec3(false);
    r.tmin = tmin;
    r.by = 0.0;
    r.behind = 0.0;
    return r;
}

/* As slab_ray_widen of ref/primitives/slab.h. On parallel axes the planes are compared with at_most
 * and at_least; on others these are infinite and stay so. */
void slab_ray_widen(inout slab_ray r, float by)
{
    if (by > 0.0) {
        r.by = by;
        precise vec3 more = r.o + by;
        precise vec3 less = r.o - by;
        bvec3 crossing = equal(r.pad, vec3(SLAB_FAR));
        r.at_most = slab_select(crossing, r.at_most, more);
        r.at_least = slab_select(crossing, r.at_least, less);
        r.o_near = slab_select(crossing, slab_select(r.swapped, less, more), r.o_near);
        r.o_far = slab_select(crossing, slab_select(r.swapped, more, less), r.o_far);
    }
}

/* Sets r.behind; `nearer` has the near planes of a box that contains every vertex. */
void slab_ray_place(inout slab_ray r, vec3 nearer)
{
    precise vec3 t = (nearer - r.o) * r.inv;
    float along = pick(r.main == 0u, t.x, pick(r.main == 1u, t.y, t.z));
    precise float reach = -along * SLAB_BEHIND;
    r.behind = along < 0.0 ? reach : 0.0;
}

bool slab_robust(slab_ray r, vec3 nearer, vec3 farther, float tbest, out float entry)
{
    precise vec3 a = (nearer - r.o_near) * r.inv;
    precise vec3 b = (farther - r.o_far) * r.inv;
    precise vec3 bp = b * r.pad;
    float tn = r.tmin, tf = tbest;
    tn = pick(a.x > tn, a.x, tn);
    tf = pick(bp.x < tf, bp.x, tf);
    tn = pick(a.y > tn, a.y, tn);
    tf = pick(bp.y < tf, bp.y, tf);
    tn = pick(a.z > tn, a.z, tn);
    tf = pick(bp.z < tf, bp.z, tf);
    entry = tn;
    bool inside = both(all(lessThanEqual(nearer, r.at_most)),
                       all(lessThanEqual(r.at_least, farther)));
    return both(inside, tn <= tf);
}

bool slab_watertight(slab_ray r, vec3 nearer, vec3 farther, float tbest, out float entry)
{
    precise vec3 a = (nearer - r.o_near) * r.inv;
    precise vec3 b = (farther - r.o_far) * r.inv;
    float tn = r.tmin, tf = tbest;
    tn = pick(a.x > tn, a.x, tn);
    tf = pick(b.x < tf, b.x, tf);
    tn = pick(a.y > tn, a.y, tn);
    tf = pick(b.y < tf, b.y, tf);
    tn = pick(a.z > tn, a.z, tn);
    tf = pick(b.z < tf, b.z, tf);
    precise float lowered = tn * SLAB_NEAR - r.behind;
    entry = lowered;
    bool inside = both(all(lessThanEqual(nearer, r.at_most)),
                       all(lessThanEqual(r.at_least, farther)));
    return both(inside, lowered <= tf);
}

bool slab_rtrs(slab_ray r, vec3 lo, vec3 hi, out float entry)
{
    precise vec3 t0 = (lo - SLAB_RTRS_EPS - r.o) / r.d;
    precise vec3 t1 = (hi + SLAB_RTRS_EPS - r.o) / r.d;
    float tn = pick(t0.x < t1.x, t0.x, t1.x);
    float tf = pick(t1.x < t0.x, t0.x, t1.x);
    for (int k = 1; k < 3; k++) {
        float lesser = pick(t0[k] < t1[k], t0[k], t1[k]);
        float greater = pick(t1[k] < t0[k], t0[k], t1[k]);
        float low = pick(lesser < -SLAB_RTRS_INF, lesser, -SLAB_RTRS_INF);
        float high = pick(greater > SLAB_RTRS_INF, greater, SLAB_RTRS_INF);
        tn = pick(low > tn, low, tn);
        tf = pick(high < tf, high, tf);
    }
    entry = tn;
    return tn < tf;
}

/* The box test of the pipeline. */
bool slab_test(slab_ray r, vec3 nearer, vec3 farther, float tbest, out float entry)
{
    bool hit;
    if (BOX_TEST == ABI_BOX_WATERTIGHT)
        hit = slab_watertight(r, nearer, farther, tbest, entry);
    else if (BOX_TEST == ABI_BOX_ROBUST)
        hit = slab_robust(r, nearer, farther, tbest, entry);
    else
        hit = slab_rtrs(r, nearer, farther, entry);
    return hit;
}

#endif
