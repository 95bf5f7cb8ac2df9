/* Edits of the whole scene's coordinates. */
#include "fuzz/gen/mutate_inner.h"

#include "ref/base/half.h"

float largest_of(const struct scene *scene)
{
    uint32_t most = 0; /* the order of the bits is that of the sizes */
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++) {
        uint32_t size = float_bits(scene->vertex[i]) & 0x7FFFFFFFu;
        most = size > most ? size : most;
    }
    return float_from_bits(most);
}

static int exponent_of(float x)
{
    return (int)(float_bits(x) >> 23 & 0xFFu) - 127;
}

/* The nearest multiple of 2^-k of the scene's size: exact zeros, ties, shared corners. */
enum status edit_snap(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    float largest = largest_of(&trial->scene);
    int exponent = exponent_of(largest) - 1 - (int)rng_below(rng, 12);
    float quantum = power_of_two(exponent < -126 ? -126 : exponent);
    for (size_t i = 0; i < 3 * (size_t)trial->scene.vertex_count; i++) {
        float steps = trial->scene.vertex[i] / quantum;
        int32_t whole = (int32_t)(steps < 0 ? steps - 0.5f : steps + 0.5f);
        put_finite(&trial->scene.vertex[i], (float)whole * quantum, changed);
    }
    return STATUS_OK;
}

/* By 2^k, within 2^-40 to 2^38. */
enum status edit_scale(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    int exponent = exponent_of(largest_of(&trial->scene));
    int k = (int)rng_below(rng, 33) - 16;
    bool with_rays = rng_below(rng, 2);
    if (exponent + k > 38 || exponent + k < -40)
        k = -k;
    float scale = power_of_two(k);
    for (size_t i = 0; i < 3 * (size_t)trial->scene.vertex_count; i++)
        put_finite(&trial->scene.vertex[i], trial->scene.vertex[i] * scale, changed);
    for (uint32_t i = 0; with_rays && i < trial->ray_count; i++)
        for (int c = 0; c < 3; c++) {
            put(&trial->ray[i].org[c], trial->ray[i].org[c] * scale, changed);
            put(&trial->ray[i].dir[c], trial->ray[i].dir[c] * scale, changed);
        }
    return STATUS_OK;
}

/* Along one axis by a power of two near the scene's size. */
enum status edit_move(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    uint32_t axis = rng_below(rng, 3);
    int exponent = exponent_of(largest_of(&trial->scene)) + (int)rng_below(rng, 12) - 3;
    bool with_rays = rng_below(rng, 2);
    float by = power_of_two(exponent < -126 ? -126 : exponent > 38 ? 38 : exponent);
    if (rng_below(rng, 2))
        by = -by;
    for (uint32_t i = 0; i < trial->scene.vertex_count; i++) {
        float *x = &trial->scene.vertex[3 * (size_t)i + axis];
        put_finite(x, *x + by, changed);
    }
    for (uint32_t i = 0; with_rays && i < trial->ray_count; i++)
        put(&trial->ray[i].org[axis], trial->ray[i].org[axis] + by, changed);
    return STATUS_OK;
}

/* One axis mirrored. */
enum status edit_negate(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    uint32_t axis = rng_below(rng, 3);
    bool with_rays = rng_below(rng, 2);
    for (uint32_t i = 0; i < trial->scene.vertex_count; i++) {
        float *x = &trial->scene.vertex[3 * (size_t)i + axis];
        put(x, -*x, changed);
    }
    for (uint32_t i = 0; with_rays && i < trial->ray_count; i++) {
        put(&trial->ray[i].org[axis], -trial->ray[i].org[axis], changed);
        put(&trial->ray[i].dir[axis], -trial->ray[i].dir[axis], changed);
    }
    return STATUS_OK;
}

static void swap_pair(float p[3], uint32_t a, uint32_t b, bool *changed)
{
    float kept = p[a];
    put(&p[a], p[b], changed);
    put(&p[b], kept, changed);
}

enum status edit_swap_axes(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    uint32_t a = rng_below(rng, 3), b = (a + 1) % 3;
    bool with_rays = rng_below(rng, 2);
    for (uint32_t i = 0; i < trial->scene.vertex_count; i++)
        swap_pair(trial->scene.vertex + 3 * (size_t)i, a, b, changed);
    for (uint32_t i = 0; with_rays && i < trial->ray_count; i++) {
        swap_pair(trial->ray[i].org, a, b, changed);
        swap_pair(trial->ray[i].dir, a, b, changed);
    }
    return STATUS_OK;
}

/* All on one plane: boxes without thickness. */
enum status edit_flatten(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    const float *vertex = some_vertex(rng, &trial->scene);
    uint32_t axis = rng_below(rng, 3);
    float at = vertex ? vertex[axis] : 0;
    for (uint32_t i = 0; i < trial->scene.vertex_count; i++)
        put(&trial->scene.vertex[3 * (size_t)i + axis], at, changed);
    return STATUS_OK;
}

/* Each coordinate on its nearest float16 or, by turns, half a step from it. */
enum status edit_halves(struct rng *rng, struct fuzz_trial *trial, bool *changed)
{
    bool between = rng_below(rng, 2);
    for (size_t i = 0; i < 3 * (size_t)trial->scene.vertex_count; i++) {
        float *x = &trial->scene.vertex[i];
        float lo = half_to_float(half_down(*x)), hi = half_to_float(half_up(*x));
        put_finite(x, between ? 0.5f * lo + 0.5f * hi : half_to_float(half_nearest(*x)), changed);
    }
    return STATUS_OK;
}
