#include "tests/hard/relations.h"

#include "ref/base/rng.h"
#include "tests/hard/parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Copies the scene; triangle i of the copy is order[i] of the original (NULL: i), its corner c the
 * original's corner[c]. */
static void copy_scene(const struct hard_part *from, const uint32_t *order, const int corner[3],
                       struct hard_part *out)
{
    for (uint32_t i = 0; i < from->scene.vertex_count; i++) {
        const float *p = from->scene.vertex + 3 * (size_t)i;
        part_vertex(out, p[0], p[1], p[2]);
    }
    for (uint32_t i = 0; i < from->scene.tri_count; i++) {
        const uint32_t *v = from->scene.index + 3 * (size_t)(order ? order[i] : i);
        part_tri(out, v[corner[0]], v[corner[1]], v[corner[2]]);
    }
}

/* Adds ray `like` of `from`, as it is now in `ray`. */
static void add_ray(struct hard_part *out, struct ray ray, size_t like, int shift, float add)
{
    want_like(part_ray(out, ray), HARD_ALL, like, shift, add);
}

static const int straight[3] = {0, 1, 2};

/* x -> sign * x[axis] for scene and rays. */
static bool turn(const struct hard_part *from, const int axis[3], const float sign[3],
                 struct hard_part *out)
{
    copy_scene(from, NULL, straight, out);
    for (uint32_t i = 0; i < out->scene.vertex_count && !out->failed; i++)
        for (int k = 0; k < 3; k++)
            out->scene.vertex[3 * (size_t)i + (size_t)k] =
                sign[k] * from->scene.vertex[3 * (size_t)i + (size_t)axis[k]];
    for (size_t i = 0; i < from->ray_count; i++) {
        struct ray ray = from->ray[i];
        for (int k = 0; k < 3; k++) {
            ray.org[k] = sign[k] * from->ray[i].org[axis[k]];
            ray.dir[k] = sign[k] * from->ray[i].dir[axis[k]];
        }
        add_ray(out, ray, i, 0, 0);
    }
    return true;
}

/* A mirrored product only changes its sign, so that every sum does: both tests keep their bits. */
static bool mirror(const struct hard_part *from, uint64_t seed, struct hard_part *out)
{
    float sign[3] = {1, 1, 1};
    out->like_bits = HARD_LIKE_MT | HARD_LIKE_WOOP;
    for (int k = 0; k < 3; k++)
        sign[k] = (seed % 7 + 1) >> k & 1 ? -1.0f : 1.0f;
    return turn(from, straight, sign, out);
}

/* mt adds x, y, z in this order, so that other axes round otherwise; woop names its axes itself. */
static bool permute_axes(const struct hard_part *from, uint64_t seed, struct hard_part *out)
{
    static const int axes[5][3] = {{1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
    out->like_bits = HARD_LIKE_WOOP;
    return turn(from, axes[seed % 5], (const float[3]){1, 1, 1}, out);
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
    out->prim_of = shuffled(from->scene.tri_count, seed);
    out->failed = !out->prim_of;
    if (out->failed)
        return false;
    out->like_bits = HARD_LIKE_MT | HARD_LIKE_WOOP;
    copy_scene(from, out->prim_of, straight, out);
    for (size_t i = 0; i < from->ray_count; i++)
        add_ray(out, from->ray[i], i, 0, 0);
    return true;
}

static bool permute_rays(const struct hard_part *from, uint64_t seed, struct hard_part *out)
{
    uint32_t *order = shuffled(from->ray_count, seed);
    out->failed = !order;
    out->like_bits = HARD_LIKE_MT | HARD_LIKE_WOOP;
    copy_scene(from, NULL, straight, out);
    for (size_t i = 0; order && i < from->ray_count; i++)
        add_ray(out, from->ray[order[i]], order[i], 0, 0);
    free(order);
    return !out->failed;
}

/* The other winding, and by turns another first corner: the sums round otherwise. */
static bool flip_winding(const struct hard_part *from, uint64_t seed, struct hard_part *out)
{
    static const int corner[3][3] = {{0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    copy_scene(from, NULL, corner[seed % 3], out);
    for (size_t i = 0; i < from->ray_count; i++)
        add_ray(out, from->ray[i], i, 0, 0);
    return true;
}

static bool scales_exactly(float x, int shift)
{
    float y = ldexpf(x, shift);
    return x == 0.0f || (isnormal(x) && isnormal(y) && fabsf(y) < 0x1p40f && fabsf(y) > 0x1p-60f);
}

/* Scene and origins times 2^k, k in -8..8: t too. The range grows with it. */
static bool scale_scene(const struct hard_part *from, uint64_t seed, struct hard_part *out)
{
    int shift = (int)(seed % 8) + 1;
    shift = seed / 8 % 2 ? -shift : shift;
    out->like_bits = HARD_LIKE_MT | HARD_LIKE_WOOP;
    copy_scene(from, NULL, straight, out);
    for (size_t i = 0; i < 3 * (size_t)from->scene.vertex_count && !out->failed; i++) {
        if (!scales_exactly(from->scene.vertex[i], shift))
            return false;
        out->scene.vertex[i] = ldexpf(from->scene.vertex[i], shift);
    }
    for (size_t i = 0; i < from->ray_count; i++) {
        struct ray ray = from->ray[i];
        for (int k = 0; k < 3; k++) {
            if (!scales_exactly(ray.org[k], shift))
                return false;
            ray.org[k] = ldexpf(ray.org[k], shift);
        }
        ray.tmin = ldexpf(ray.tmin, shift);
        ray.tmax = ldexpf(ray.tmax, shift);
        add_ray(out, ray, i, shift, 0);
    }
    return true;
}

/* Directions times 2^k, k in -30..30: t times 2^-k. */
static bool scale_direction(const struct hard_part *from, uint64_t seed, struct hard_part *out)
{
    int shift = (int)(seed % 61) - 30;
    out->like_bits = HARD_LIKE_MT | HARD_LIKE_WOOP;
    copy_scene(from, NULL, straight, out);
    for (size_t i = 0; i < from->ray_count; i++) {
        struct ray ray = from->ray[i];
        for (int k = 0; k < 3; k++) {
            if (!scales_exactly(ray.dir[k], shift))
                return false;
            ray.dir[k] = ldexpf(ray.dir[k], shift);
        }
        ray.tmin = ldexpf(ray.tmin, -shift);
        ray.tmax = ldexpf(ray.tmax, -shift);
        add_ray(out, ray, i, -shift, 0);
    }
    return true;
}

/* x + by is a float, and so is what was x before: nothing is rounded. */
static bool adds_exactly(float x, float by, float *sum)
{
    *sum = x + by;
    return (double)*sum == (double)x + (double)by && *sum - by == x;
}

/* Everything moved by a lattice vector: all differences stay, and with them every bit. */
static bool translate(const struct hard_part *from, uint64_t seed, struct hard_part *out)
{
    struct rng rng = rng_make(seed, 0x7A);
    float by[3];
    for (int k = 0; k < 3; k++)
        by[k] = (float)rng_below(&rng, 64) - 32.0f;
    out->like_bits = HARD_LIKE_MT | HARD_LIKE_WOOP;
    copy_scene(from, NULL, straight, out);
    for (size_t i = 0; i < 3 * (size_t)from->scene.vertex_count && !out->failed; i++)
        if (!adds_exactly(from->scene.vertex[i], by[i % 3], &out->scene.vertex[i]))
            return false;
    for (size_t i = 0; i < from->ray_count; i++) {
        struct ray ray = from->ray[i];
        for (int k = 0; k < 3; k++)
            if (!adds_exactly(ray.org[k], by[k], &ray.org[k]))
                return false;
        add_ray(out, ray, i, 0, 0);
    }
    return true;
}

/* The origin k directions farther back, k a power of two: t + k. Differences change, so the bits
 * may. A range that starts at 0 starts at k. */
static bool shift_origin(const struct hard_part *from, uint64_t seed, struct hard_part *out)
{
    float k = ldexpf(1.0f, (int)(seed % 4));
    copy_scene(from, NULL, straight, out);
    for (size_t i = 0; i < from->ray_count; i++) {
        struct ray ray = from->ray[i];
        for (int a = 0; a < 3; a++)
            if (!adds_exactly(ray.org[a], -k * ray.dir[a], &ray.org[a]))
                return false;
        ray.tmin += k;
        if (ray.tmax < RAY_TMAX && !adds_exactly(ray.tmax, k, &ray.tmax))
            return false;
        add_ray(out, ray, i, 0, -k);
    }
    return true;
}

static const struct relation table[] = {
    {"mirror", "some axes negated: same triangle, same bits", mirror},
    {"permute_axes", "axes renamed: same triangle; woop: same bits", permute_axes},
    {"permute_triangles", "triangles in another order: same bits", permute_triangles},
    {"permute_rays", "rays in another order: same bits", permute_rays},
    {"flip_winding", "corners in another order: same triangle", flip_winding},
    {"scale_scene", "scene and origins times 2^k: t times 2^k, same bits", scale_scene},
    {"scale_direction", "directions times 2^k: t times 2^-k, same bits", scale_direction},
    {"translate", "everything moved by whole numbers: same bits", translate},
    {"shift_origin", "origins k directions back: the same triangle at t + k", shift_origin},
};

const struct relation *const relations[] = {
    &table[0], &table[1], &table[2], &table[3], &table[4],
    &table[5], &table[6], &table[7], &table[8], NULL,
};

const struct relation *relation_find(const char *name)
{
    for (size_t i = 0; relations[i]; i++)
        if (strcmp(relations[i]->name, name) == 0)
            return relations[i];
    return NULL;
}
