#include "tests/hard/relations.h"

#include "ref/base/rng.h"
#include "tests/hard/parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What a relation does to the scene and its rays. */
struct change {
    unsigned like_bits;
    const uint32_t *tri, *ray; /* triangle or ray i was tri[i], ray[i] before; NULL: i */
    int corner[3];             /* corner c of a triangle was corner[c] */
    int axis[3];               /* axis k was axis[k] */
    float sign[3];             /* of coordinates and directions */
    int scale, stretch;        /* coordinates times 2^scale, directions times 2^stretch */
    float by[3];               /* added to coordinates */
    float back;                /* origins so many directions farther back */
};

static const struct change nothing = {.like_bits = HARD_LIKE_MT | HARD_LIKE_WOOP,
                                      .corner = {0, 1, 2},
                                      .axis = {0, 1, 2},
                                      .sign = {1, 1, 1}};

static bool scales_exactly(float x, int shift)
{
    float y = ldexpf(x, shift);
    return x == 0.0f || (isnormal(x) && isnormal(y) && fabsf(y) < 0x1p40f && fabsf(y) > 0x1p-60f);
}

/* x + by is a float, and so is what was x before: nothing is rounded. */
static bool adds_exactly(float x, float by, float *sum)
{
    *sum = x + by;
    return (double)*sum == (double)x + (double)by && *sum - by == x;
}

/* Axis k of a place or a direction; false if it would be rounded. */
static bool change_axis(const struct change *change, int k, const float from[3], int shift,
                        float by, float *out)
{
    float x = change->sign[k] * from[change->axis[k]];
    *out = ldexpf(x, shift);
    return (shift == 0 || scales_exactly(x, shift)) && (by == 0 || adds_exactly(*out, by, out));
}

static bool change_ray(const struct change *change, const struct ray *from, struct ray *out)
{
    int shift = change->scale - change->stretch;
    *out = *from;
    for (int k = 0; k < 3; k++) {
        if (!change_axis(change, k, from->dir, change->stretch, 0, &out->dir[k]))
            return false;
        float by = change->by[k] - change->back * out->dir[k];
        if (!change_axis(change, k, from->org, change->scale, by, &out->org[k]))
            return false;
    }
    out->tmin = ldexpf(from->tmin, shift) + change->back;
    out->tmax = ldexpf(from->tmax, shift);
    return change->back == 0 || out->tmax >= RAY_TMAX ||
           adds_exactly(out->tmax, change->back, &out->tmax);
}

static bool change_all(const struct hard_part *from, const struct change *change,
                       struct hard_part *out)
{
    out->like_bits = change->like_bits;
    for (uint32_t i = 0; i < from->scene.vertex_count; i++) {
        float p[3];
        for (int k = 0; k < 3; k++)
            if (!change_axis(change, k, from->scene.vertex + 3 * (size_t)i, change->scale,
                             change->by[k], &p[k]))
                return false;
        part_vertex(out, p[0], p[1], p[2]);
    }
    for (uint32_t i = 0; i < from->scene.tri_count; i++) {
        const uint32_t *v = from->scene.index + 3 * (size_t)(change->tri ? change->tri[i] : i);
        part_tri(out, v[change->corner[0]], v[change->corner[1]], v[change->corner[2]]);
    }
    for (uint32_t i = 0; i < from->ray_count; i++) {
        uint32_t like = change->ray ? change->ray[i] : i;
        struct ray ray;
        if (!change_ray(change, &from->ray[like], &ray))
            return false;
        part_ray(out, ray);
        want_like(out, HARD_ALL, like, change->scale - change->stretch, 0 - change->back);
    }
    return true;
}

/* A mirrored product only changes its sign, so that every sum does: both tests keep their bits. */
static bool mirror(const struct hard_part *from, uint64_t seed, struct hard_part *out)
{
    struct change change = nothing;
    for (int k = 0; k < 3; k++)
        change.sign[k] = (seed % 7 + 1) >> k & 1 ? -1.0f : 1.0f;
    return change_all(from, &change, out);
}

/* mt adds x, y, z in this order, so that other axes round otherwise; woop names its axes itself. */
static bool permute_axes(const struct hard_part *from, uint64_t seed, struct hard_part *out)
{
    static const int axes[5][3] = {{1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
    struct change change = nothing;
    change.like_bits = HARD_LIKE_WOOP;
    memcpy(change.axis, axes[seed % 5], sizeof change.axis);
    return change_all(from, &change, out);
}

static uint32_t *shuffled(size_t count, uint64_t seed)
{
    uint32_t *order = alloc_zeroed(count, sizeof *order);
    struct rng rng = rng_make(seed, 0x5EED);
    for (size_t i = 0; order && i < count; i++) {
        size_t j = rng_below(&rng, (uint32_t)i + 1);
        order[i] = order[j];
        order[j] = (uint32_t)i;
    }
    return order;
}

static bool permute_triangles(const struct hard_part *from, uint64_t seed, struct hard_part *out)
{
    struct change change = nothing;
    change.tri = out->prim_of = shuffled(from->scene.tri_count, seed);
    out->failed = !out->prim_of;
    return !out->failed && change_all(from, &change, out);
}

static bool permute_rays(const struct hard_part *from, uint64_t seed, struct hard_part *out)
{
    struct change change = nothing;
    uint32_t *order = shuffled(from->ray_count, seed);
    change.ray = order;
    out->failed = !order;
    bool exact = order && change_all(from, &change, out);
    free(order);
    return exact;
}

/* The other winding, and by turns another first corner: the sums round otherwise. */
static bool flip_winding(const struct hard_part *from, uint64_t seed, struct hard_part *out)
{
    static const int corner[3][3] = {{0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    struct change change = nothing;
    change.like_bits = 0;
    memcpy(change.corner, corner[seed % 3], sizeof change.corner);
    return change_all(from, &change, out);
}

/* Scene and origins times 2^k, k in -8..8: t too. The range grows with it. */
static bool scale_scene(const struct hard_part *from, uint64_t seed, struct hard_part *out)
{
    struct change change = nothing;
    int shift = (int)(seed % 8) + 1;
    change.scale = seed / 8 % 2 ? -shift : shift;
    return change_all(from, &change, out);
}

/* Directions times 2^k, k in -30..30: t times 2^-k. */
static bool scale_direction(const struct hard_part *from, uint64_t seed, struct hard_part *out)
{
    struct change change = nothing;
    change.stretch = (int)(seed % 61) - 30;
    return change_all(from, &change, out);
}

/* Everything moved by a lattice vector: all differences stay, and with them every bit. */
static bool translate(const struct hard_part *from, uint64_t seed, struct hard_part *out)
{
    struct change change = nothing;
    struct rng rng = rng_make(seed, 0x7A);
    for (int k = 0; k < 3; k++)
        change.by[k] = whole(&rng, 64) - 32;
    return change_all(from, &change, out);
}

/* The origin k directions farther back, k a power of two: t + k. Differences change, so the bits
 * may. A range that starts at 0 starts at k. */
static bool shift_origin(const struct hard_part *from, uint64_t seed, struct hard_part *out)
{
    struct change change = nothing;
    change.like_bits = 0;
    change.back = ldexpf(1.0f, (int)(seed % 4));
    return change_all(from, &change, out);
}

const struct relation relations[] = {
    {"mirror", "some axes negated: same triangle, same bits", mirror},
    {"permute_axes", "axes renamed: same triangle; woop: same bits", permute_axes},
    {"permute_triangles", "triangles in another order: same bits", permute_triangles},
    {"permute_rays", "rays in another order: same bits", permute_rays},
    {"flip_winding", "corners in another order: same triangle", flip_winding},
    {"scale_scene", "scene and origins times 2^k: t times 2^k, same bits", scale_scene},
    {"scale_direction", "directions times 2^k: t times 2^-k, same bits", scale_direction},
    {"translate", "everything moved by whole numbers: same bits", translate},
    {"shift_origin", "origins k directions back: the same triangle at t + k", shift_origin},
    {0},
};

const struct relation *relation_find(const char *name)
{
    for (const struct relation *relation = relations; relation->name; relation++)
        if (strcmp(relation->name, name) == 0)
            return relation;
    return NULL;
}
