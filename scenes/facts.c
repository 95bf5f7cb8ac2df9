#include "scenes/facts.h"

#include "ref/base/double3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Whether ab = cd, by both halves of each product. No product of differences of floats
 * underflows. */
static bool same_product(double a, double b, double c, double d)
{
    const double p = a * b, q = c * d;
    return p == q && fma(a, b, -p) == fma(c, d, -q);
}

/* Compares both products of each component of the cross product. */
static bool has_no_area(float v[3][3])
{
    double e[3], f[3];
    double3_sub(v[1], v[0], e);
    double3_sub(v[2], v[0], f);
    return same_product(e[1], f[2], e[2], f[1]) && same_product(e[2], f[0], e[0], f[2]) &&
           same_product(e[0], f[1], e[1], f[0]);
}

/* The corners of a triangle as bits, sorted. */
struct key {
    uint32_t corner[3][3];
};

static struct key make_key(float v[3][3])
{
    struct key key;
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            key.corner[c][k] = float_bits(v[c][k] + 0.0f); /* -0 + 0 is 0 */
    static const int pairs[3][2] = {{0, 1}, {1, 2}, {0, 1}};
    for (int i = 0; i < 3; i++) {
        uint32_t *a = key.corner[pairs[i][0]], *b = key.corner[pairs[i][1]], swap[3];
        if (memcmp(a, b, sizeof swap) <= 0)
            continue;
        memcpy(swap, a, sizeof swap);
        memcpy(a, b, sizeof swap);
        memcpy(b, swap, sizeof swap);
    }
    return key;
}

static int compare_keys(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(struct key));
}

enum status facts_make(const struct scene *scene, struct facts *out)
{
    *out = (struct facts){.bounds = scene_bounds(scene)};
    struct key *key = alloc_zeroed(scene->tri_count, sizeof *key);
    if (!key)
        return STATUS_MEMORY;
    for (uint32_t i = 0; i < scene->tri_count; i++) {
        float v[3][3];
        scene_tri(scene, i, v);
        out->zero_area += has_no_area(v);
        key[i] = make_key(v);
    }
    qsort(key, scene->tri_count, sizeof *key, compare_keys);
    for (uint32_t i = 1; i < scene->tri_count; i++)
        out->duplicate += compare_keys(&key[i - 1], &key[i]) == 0;
    free(key);
    for (int k = 0; k < 3 && scene->tri_count; k++) {
        out->extent = fmaxf(out->extent, out->bounds.hi[k] - out->bounds.lo[k]);
        out->largest =
            fmaxf(out->largest, fmaxf(fabsf(out->bounds.lo[k]), fabsf(out->bounds.hi[k])));
    }
    return STATUS_OK;
}
