#include "tests/exact/oracle_cases.h"

#include <math.h>

float random_bits(struct rng *rng)
{
    float x;
    do
        x = float_from_bits((uint32_t)rng_u64(rng));
    while (!float_is_finite(x));
    return x;
}

static float small_int(struct rng *rng, int most)
{
    return (float)((int)rng_below(rng, (uint32_t)(2 * most + 1)) - most);
}

/* Ranges: all, from 0 on, one that often ends on a lattice t, or backward. */
static void set_range(struct rng *rng, struct ray *ray)
{
    static const float ends[] = {-2, -1, -0.5f, 0, 0.5f, 1, 2, 4};
    switch (rng_below(rng, 4)) {
    case 0:
        ray->tmin = -0x1p127f;
        ray->tmax = INFINITY;
        break;
    case 1:
        ray->tmin = 0;
        ray->tmax = 0x1.fffffep127f;
        break;
    default:
        ray->tmin = ends[rng_below(rng, 4)];
        ray->tmax = ends[4 + rng_below(rng, 4)];
        if (rng_below(rng, 8) == 0)
            ray->tmax = ray->tmin;
    }
}

static void aim_at(struct ray *ray, const float target[3])
{
    for (int k = 0; k < 3; k++)
        ray->dir[k] = target[k] - ray->org[k];
}

/* A point of the triangle: inside, or on an edge or vertex as `feature` says (0, 1, 2). */
static void point_of(struct rng *rng, float v[3][3], int feature, float out[3])
{
    float a = rng_float(rng), b = rng_float(rng) * (1 - a);
    float weight[3] = {a, b, 1 - a - b};
    int first = (int)rng_below(rng, 3);
    if (feature == 1) {
        weight[first] = 0;
        weight[(first + 1) % 3] = rng_below(rng, 2) ? 0.5f : a;
        weight[(first + 2) % 3] = 1 - weight[(first + 1) % 3];
    } else if (feature == 2) {
        weight[first] = 1;
        weight[(first + 1) % 3] = weight[(first + 2) % 3] = 0;
    }
    for (int k = 0; k < 3; k++)
        out[k] = weight[0] * v[0][k] + weight[1] * v[1][k] + weight[2] * v[2][k];
}

static void make_cube(struct rng *rng, uint64_t seed, struct ray *ray, float v[3][3])
{
    (void)seed;
    for (int k = 0; k < 3; k++) {
        ray->org[k] = rng_range(rng, -1, 1);
        ray->dir[k] = rng_range(rng, -1, 1);
        for (int c = 0; c < 3; c++)
            v[c][k] = rng_range(rng, -1, 1);
    }
    set_range(rng, ray);
}

static void make_around(struct rng *rng, float offset, float size, struct ray *ray, float v[3][3])
{
    for (int k = 0; k < 3; k++) {
        float base = offset + rng_range(rng, -1, 1);
        ray->org[k] = offset + rng_range(rng, -3, 3);
        for (int c = 0; c < 3; c++)
            v[c][k] = base + size * rng_range(rng, -1, 1);
    }
    set_range(rng, ray);
}

static void make_small(struct rng *rng, uint64_t seed, struct ray *ray, float v[3][3])
{
    float target[3];
    (void)seed;
    make_around(rng, 0, 1e-3f, ray, v);
    point_of(rng, v, 0, target);
    aim_at(ray, target);
}

static void make_lattice(struct rng *rng, uint64_t seed, struct ray *ray, float v[3][3])
{
    float target[3];
    (void)seed;
    for (int k = 0; k < 3; k++) {
        ray->org[k] = small_int(rng, 4);
        target[k] = small_int(rng, 4);
        for (int c = 0; c < 3; c++)
            v[c][k] = small_int(rng, 4);
    }
    aim_at(ray, target);
    set_range(rng, ray);
}

static void make_feature(struct rng *rng, uint64_t seed, struct ray *ray, float v[3][3])
{
    float target[3];
    (void)seed;
    make_around(rng, 0, 0.5f, ray, v);
    point_of(rng, v, 1 + (int)rng_below(rng, 2), target);
    aim_at(ray, target);
}

/* Through a vertex or an edge's middle without rounding: all numbers are multiples of 2^-10. */
static void make_exact_feature(struct rng *rng, uint64_t seed, struct ray *ray, float v[3][3])
{
    int a = (int)rng_below(rng, 3), b = (int)rng_below(rng, 3);
    float stretch = (float)(1 + rng_below(rng, 7));
    (void)seed;
    for (int k = 0; k < 3; k++) {
        ray->org[k] = small_int(rng, 1000) * 0x1p-9f;
        for (int c = 0; c < 3; c++)
            v[c][k] = small_int(rng, 1000) * 0x1p-9f;
        ray->dir[k] = stretch * (0.5f * v[a][k] + 0.5f * v[b][k] - ray->org[k]);
    }
    set_range(rng, ray);
}

/* Everything in one plane p + a x + b y with small whole x, y. */
static void make_in_plane(struct rng *rng, uint64_t seed, struct ray *ray, float v[3][3])
{
    float x[3], y[3], p[3];
    float at[5][2];
    (void)seed;
    for (int i = 0; i < 5; i++) {
        at[i][0] = small_int(rng, 3);
        at[i][1] = small_int(rng, 3);
    }
    for (int k = 0; k < 3; k++) {
        x[k] = small_int(rng, 9);
        y[k] = small_int(rng, 9);
        p[k] = small_int(rng, 100);
        ray->org[k] = p[k] + at[0][0] * x[k] + at[0][1] * y[k];
        ray->dir[k] = at[1][0] * x[k] + at[1][1] * y[k];
        for (int c = 0; c < 3; c++)
            v[c][k] = p[k] + at[2 + c][0] * x[k] + at[2 + c][1] * y[k];
    }
    set_range(rng, ray);
}

static void make_near_plane(struct rng *rng, uint64_t seed, struct ray *ray, float v[3][3])
{
    make_in_plane(rng, seed, ray, v);
    float *moved = rng_below(rng, 2) ? v[rng_below(rng, 3)] : ray->dir;
    for (int k = 0; k < 3; k++)
        if (rng_below(rng, 2))
            moved[k] = nextafterf(moved[k], rng_below(rng, 2) ? 1e3f : -1e3f);
}

static void make_needle(struct rng *rng, uint64_t seed, struct ray *ray, float v[3][3])
{
    float target[3];
    (void)seed;
    make_around(rng, 0, 1, ray, v);
    for (int k = 0; k < 3; k++)
        v[2][k] = 0.5f * v[0][k] + 0.5f * v[1][k] + 1e-6f * rng_range(rng, -1, 1);
    point_of(rng, v, (int)rng_below(rng, 3), target);
    aim_at(ray, target);
    if (rng_below(rng, 4) == 0) /* along the long axis */
        for (int k = 0; k < 3; k++)
            ray->dir[k] = v[1][k] - v[0][k];
}

static void make_no_area(struct rng *rng, uint64_t seed, struct ray *ray, float v[3][3])
{
    bool lattice = rng_below(rng, 2);
    (void)seed;
    if (lattice)
        make_lattice(rng, seed, ray, v);
    else
        make_feature(rng, seed, ray, v);
    int kind = (int)rng_below(rng, 3);
    for (int k = 0; k < 3; k++) {
        if (kind == 0)
            v[1][k] = v[0][k];
        else if (kind == 1)
            v[1][k] = v[2][k] = v[0][k];
        else
            v[2][k] = 2 * v[1][k] - v[0][k]; /* collinear on the lattice, nearly so elsewhere */
    }
}

/* Many triangles of a batch share a plane, an edge or all of themselves. */
static void make_ties(struct rng *rng, uint64_t seed, struct ray *ray, float v[3][3])
{
    struct rng start = rng_make(seed, 99), shared = {rng_u64(&start)};
    float corner[4][3];
    for (int k = 0; k < 3; k++) {
        float x = small_int(&shared, 50), y = small_int(&shared, 50), p = small_int(&shared, 50);
        for (int i = 0; i < 4; i++)
            corner[i][k] = (p + (float)(i & 1) * x + (float)(i >> 1) * y) * 0x1.000002p-3f;
        ray->org[k] = small_int(&shared, 200) * 0x1.4p-3f;
    }
    int skip = (int)rng_below(rng, 4), turn = (int)rng_below(rng, 3), n = 0;
    for (int i = 0; i < 4; i++)
        if (i != skip) {
            for (int k = 0; k < 3; k++)
                v[(n + turn) % 3][k] = corner[i][k];
            n++;
        }
    float target[3];
    point_of(rng, v, (int)rng_below(rng, 3), target);
    aim_at(ray, target);
    ray->tmin = 0;
    ray->tmax = INFINITY;
}

static float random_exponent(struct rng *rng, int most)
{
    float m = rng_scaled(rng, 1, 2, -most, (uint32_t)(2 * most + 1));
    return rng_below(rng, 2) ? m : -m;
}

static void make_exponents(struct rng *rng, uint64_t seed, struct ray *ray, float v[3][3])
{
    (void)seed;
    for (int k = 0; k < 3; k++) {
        ray->org[k] = random_exponent(rng, 60);
        ray->dir[k] = random_exponent(rng, 60);
        for (int c = 0; c < 3; c++)
            v[c][k] = random_exponent(rng, 60);
    }
    set_range(rng, ray);
}

static void make_offset(struct rng *rng, uint64_t seed, struct ray *ray, float v[3][3])
{
    float target[3];
    (void)seed;
    make_around(rng, 1e6f, rng_below(rng, 2) ? 1 : 8, ray, v);
    point_of(rng, v, (int)rng_below(rng, 3), target);
    aim_at(ray, target);
}

/* Every finite float; half of the time the ray comes from 0 straight at a vertex, or starts on
 * one, or the triangle lies around a coordinate axis, so that something is hit. */
static void make_bits(struct rng *rng, uint64_t seed, struct ray *ray, float v[3][3])
{
    (void)seed;
    for (int k = 0; k < 3; k++) {
        ray->org[k] = random_bits(rng);
        ray->dir[k] = random_bits(rng);
        for (int c = 0; c < 3; c++)
            v[c][k] = random_bits(rng);
    }
    int kind = (int)rng_below(rng, 6), c = (int)rng_below(rng, 3);
    for (int k = 0; k < 3 && kind < 3; k++) {
        if (kind == 0) {
            ray->org[k] = 0;
            ray->dir[k] = v[c][k];
        } else if (kind == 1) {
            ray->org[k] = v[c][k];
        } else {
            v[1][k] = k == 1 ? v[1][k] : -v[0][k];
            ray->org[k] = k == 2 ? ray->org[k] : 0;
            ray->dir[k] = k == 2 ? ray->dir[k] : 0;
        }
    }
    ray->tmin = random_bits(rng);
    ray->tmax = random_bits(rng);
    if (ray->tmin > ray->tmax) {
        float swap = ray->tmin;
        ray->tmin = ray->tmax;
        ray->tmax = swap;
    }
    if (rng_below(rng, 2))
        set_range(rng, ray);
}

static void make_denormal(struct rng *rng, uint64_t seed, struct ray *ray, float v[3][3])
{
    if (rng_below(rng, 2))
        make_lattice(rng, seed, ray, v);
    else
        make_feature(rng, seed, ray, v);
    bool slow = rng_below(rng, 2);
    for (int k = 0; k < 3; k++) {
        ray->org[k] *= 0x1p-140f;
        if (slow)
            ray->dir[k] *= 0x1p-140f;
        for (int c = 0; c < 3; c++)
            v[c][k] *= 0x1p-140f;
    }
}

/* Small whole numbers times one of three far apart powers of two: exact zeros that leave
 * __int128. */
static void make_spread(struct rng *rng, uint64_t seed, struct ray *ray, float v[3][3])
{
    static const float scale[] = {0x1p-50f, 1, 0x1p50f};
    (void)seed;
    for (int k = 0; k < 3; k++) {
        float own = scale[rng_below(rng, 3)]; /* an axis often has one scale */
        ray->org[k] = small_int(rng, 2) * own;
        ray->dir[k] = small_int(rng, 2) * own;
        for (int c = 0; c < 3; c++)
            v[c][k] = small_int(rng, 2) * (rng_below(rng, 4) ? own : scale[rng_below(rng, 3)]);
    }
    set_range(rng, ray);
}

const struct oracle_case oracle_cases[ORACLE_CASES] = {
    {"cube", make_cube},
    {"small", make_small},
    {"lattice", make_lattice},
    {"feature", make_feature},
    {"exact_feature", make_exact_feature},
    {"in_plane", make_in_plane},
    {"near_plane", make_near_plane},
    {"needle", make_needle},
    {"no_area", make_no_area},
    {"ties", make_ties},
    {"exponents", make_exponents},
    {"offset", make_offset},
    {"bits", make_bits},
    {"denormal", make_denormal},
    {"spread", make_spread},
};
