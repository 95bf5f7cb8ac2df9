/* Ray against triangle: the operations of ref/primitives/tri.h in the same order. Every comparison
 * is true in the case that continues, so that every NaN is a miss. */
#ifndef TRI_GLSL
#define TRI_GLSL

#include "slab.glsl"

#define TRI_RTRS_EPS 1e-7

struct tri_ray {
    vec3 o;
    vec3 d;
    float tmin;
    float tmax;
    uvec3 axis;    /* woop: kx, ky, kz */
    vec3 shear;    /* woop */
};

float tri_pick(vec3 v, uint axis)
{
    return pick(axis == 0u, v.x, pick(axis == 1u, v.y, v.z));
}

tri_ray tri_ray_make(vec3 o, vec3 d, float tmin, float tmax)
{
    tri_ray r;
    r.o = o;
    r.d = d;
    r.tmin = tmin;
    r.tmax = tmax;
    precise vec3 minus = -d;
    vec3 a = slab_select(lessThan(d, vec3(0.0)), minus, d);
    uint kz = a.y > a.x ? 1u : 0u;
    kz = pick(a.z > tri_pick(a, kz), 2u, kz);
    uint kx = pick(kz == 2u, 0u, kz + 1u);
    uint ky = pick(kx == 2u, 0u, kx + 1u);
    float dz = tri_pick(d, kz);
    r.axis = uvec3(pick(dz < 0.0, ky, kx), pick(dz < 0.0, kx, ky), kz);
    precise vec3 shear = vec3(tri_pick(d, r.axis.x), tri_pick(d, r.axis.y), 1.0) / dz;
    r.shear = shear;
    return r;
}

/* The dot product in a fixed order; that of the built-in one is not specified. */
float tri_sum(vec3 a, vec3 b)
{
    precise float sum = (a.x * b.x + a.y * b.y) + a.z * b.z;
    return sum;
}

vec3 tri_cross(vec3 a, vec3 b)
{
    precise vec3 c = a.yzx * b.zxy - a.zxy * b.yzx;
    return c;
}

bool tri_moeller_trumbore_edges(tri_ray r, vec3 v0, vec3 e1, vec3 e2, float eps, out vec3 tuv)
{
    precise vec3 s = r.o - v0;
    vec3 p = tri_cross(r.d, e2);
    vec3 q = tri_cross(s, e1);
    float det = tri_sum(e1, p);
    float u = tri_sum(s, p);
    float w = tri_sum(r.d, q);
    float t = tri_sum(e2, q);
    precise float size = pick(det < 0.0, -det, det);
    precise float us = pick(det < 0.0, -u, u);
    precise float ws = pick(det < 0.0, -w, w);
    precise float sum = us + ws;
    precise vec3 quotient = vec3(t, u, w) / det;
    tuv = quotient;
    return both(size > eps, both(us >= 0.0, us <= size), both(ws >= 0.0, sum <= size));
}

bool tri_moeller_trumbore(tri_ray r, vec3 v0, vec3 v1, vec3 v2, float eps, out vec3 tuv)
{
    precise vec3 e1 = v1 - v0;
    precise vec3 e2 = v2 - v0;
    return tri_moeller_trumbore_edges(r, v0, e1, e2, eps, tuv);
}

bool tri_woop(tri_ray r, vec3 v0, vec3 v1, vec3 v2, out vec3 tuv)
{
    precise vec3 a = v0 - r.o;
    precise vec3 b = v1 - r.o;
    precise vec3 c = v2 - r.o;
    vec3 along = vec3(tri_pick(a, r.axis.z), tri_pick(b, r.axis.z), tri_pick(c, r.axis.z));
    vec3 ax = vec3(tri_pick(a, r.axis.x), tri_pick(b, r.axis.x), tri_pick(c, r.axis.x));
    vec3 ay = vec3(tri_pick(a, r.axis.y), tri_pick(b, r.axis.y), tri_pick(c, r.axis.y));
    precise vec3 x = ax - r.shear.x * along;
    precise vec3 y = ay - r.shear.y * along;
    precise vec3 z = r.shear.z * along;
    /* w0 = x2 y1 - y2 x1, and cyclically w1 and w2. */
    precise vec3 w = x.zxy * y.yzx - y.zxy * x.yzx;
    bool negative = any(lessThan(w, vec3(0.0)));
    bool positive = any(greaterThan(w, vec3(0.0)));
    precise float det = (w.x + w.y) + w.z;
    float t = tri_sum(w, z);
    precise vec3 quotient = vec3(t, w.y, w.z) / det;
    tuv = quotient;
    return both(!both(negative, positive), any(bvec2(det > 0.0, det < 0.0)));
}

#include "tri_pluecker.glsl"
#include "tri_baldwin_webber.glsl"

/* Returns true if t is in the range of test `id`. */
bool tri_in_range(uint id, tri_ray r, float t)
{
    bool open = both(t > r.tmin, t < r.tmax), closed = both(t >= r.tmin, t <= r.tmax);
    return id == ABI_TRI_MT_RTRS ? open : closed;
}

/* Runs test `id` (ABI_TRI_*) and checks its range; tuv is undefined if false. */
bool tri_test_run(uint id, tri_ray r, vec3 v0, vec3 v1, vec3 v2, out vec3 tuv)
{
    bool hit;
    if (id == ABI_TRI_WOOP)
        hit = tri_woop(r, v0, v1, v2, tuv);
    else if (id == ABI_TRI_PLUECKER)
        hit = tri_pluecker(r, v0, v1, v2, tuv);
    else if (id == ABI_TRI_BALDWIN_WEBBER)
        hit = tri_baldwin_webber(r, v0, v1, v2, tuv);
    else
        hit = tri_moeller_trumbore(r, v0, v1, v2, id == ABI_TRI_MT_RTRS ? TRI_RTRS_EPS : 0.0, tuv);
    return both(hit, tri_in_range(id, r, tuv.x));
}

#endif
