/* Tables of box tests, triangle tests and queries: names, ids and range conventions. */
#ifndef PRIMITIVES_H
#define PRIMITIVES_H

#include "ref/primitives/slab.h"
#include "ref/primitives/tri_baldwin_webber.h"

enum query {
    QUERY_CLOSEST = ABI_QUERY_CLOSEST,
    QUERY_ANY = ABI_QUERY_ANY,
    QUERY_ALL = ABI_QUERY_ALL, /* every triangle that the ray hits */
    QUERY_COUNT,
};

struct box_test {
    const char *name;
    const char *summary;
    uint32_t id;     /* ABI_BOX_* */
    bool faithful;   /* as published, faults included */
    bool watertight; /* a watertight triangle test stays so on a tree */
};

struct tri_test {
    const char *name;
    const char *summary;
    uint32_t id; /* ABI_TRI_* */
    bool faithful;
    bool open;       /* accepts tmin < t < tmax instead of tmin <= t <= tmax */
    bool watertight; /* no ray passes between two triangles that share an edge */
    bool core;       /* plays the hard cases unasked */
};

/* NULL-terminated; the first is the default. */
extern const struct box_test *const box_tests[];
extern const struct tri_test *const tri_tests[];

const struct box_test *box_test_find(const char *name); /* or NULL */
const struct tri_test *tri_test_find(const char *name); /* or NULL */

/* "closest", "any" or "all". */
const char *query_name(enum query query);
/* Returns false if `name` is none of them. */
bool query_find(const char *name, enum query *out);

/* True iff t lies in [tmin, tmax] of the ray, strictly inside for mt_rtrs. */
static inline bool tri_in_range(uint32_t id, const struct tri_ray *r, float t)
{
    if (id == ABI_TRI_MT_RTRS)
        return t > r->tmin && t < r->tmax;
    return t >= r->tmin && t <= r->tmax;
}

/* Runs the triangle test `id` (ABI_TRI_*) on one triangle: true iff it hits and its t lies in
 * [tmin, tmax] of the ray (strictly inside for mt_rtrs). On false *out is undefined. */
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

/* Runs the box test `id` (ABI_BOX_*); slab_ray_place has been called. */
static inline bool box_test_run(uint32_t id, const struct slab_ray *r, const struct box *box,
                                float tbest, float *entry)
{
    if (id == ABI_BOX_WATERTIGHT)
        return slab_watertight(r, box, tbest, entry);
    if (id == ABI_BOX_ROBUST)
        return slab_robust(r, box, tbest, entry);
    return slab_rtrs(r, box, entry);
}

/* True if the library answers for this ray: all numbers finite, 0 <= tmin <= tmax (tmax may be
 * infinite), direction not zero, no non-zero component below 2^-60 of the largest, the largest
 * in [2^-40, 2^40], origin at most 2^40 away. Other rays are traced without a promise and counted
 * as out of contract. */
bool ray_in_contract(const struct ray *ray);

#endif
