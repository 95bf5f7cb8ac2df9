#include "ref/scene/quantise.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Least and largest coordinate of all vertices, also of those that no triangle uses. */
static void extents(const struct scene *scene, int k, double *least, double *most)
{
    *least = INFINITY;
    *most = -INFINITY;
    for (uint32_t i = 0; i < scene->vertex_count; i++) {
        double x = (double)scene->vertex[3 * (size_t)i + (size_t)k];
        *least = fmin(*least, x);
        *most = fmax(*most, x);
    }
    if (scene->vertex_count == 0)
        *least = *most = 0.0;
}

static enum status check_vertices(const struct scene *scene, struct reason *reason)
{
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++) {
        float x = scene->vertex[i];
        if (!float_is_finite(x))
            return fail(reason, STATUS_INPUT, "quantise: vertex %zu is not finite", i / 3);
        if (fabsf(x) > FLT_MAX / 2)
            return fail(reason, STATUS_LIMIT,
                        "quantise: vertex %zu: %a is above half of the largest float", i / 3,
                        (double)x);
    }
    return STATUS_OK;
}

/* Exact: x has 24 bits, and a step of at least 2^-24 of the largest |x| leaves at most 25 before
 * the point; if the sum is rounded, x is tiny and n is 0 either way. */
static double nearest(double x, double step)
{
    return floor(x / step + 0.5);
}

static double step_of(double least, double most, uint32_t bits, double number_most)
{
    const double codes = (double)((1u << bits) - 1);
    double step = (double)FLT_MIN;
    while (nearest(most, step) - nearest(least, step) > codes ||
           nearest(most, step) > number_most || nearest(least, step) < -number_most)
        step *= 2.0;
    return step;
}

/* Computes in integers: codes are below 2^21, products below 2^42. */
static bool is_flat(const struct scene *scene, const struct grid *grid, uint32_t prim)
{
    float v[3][3];
    int64_t a[3], b[3];
    scene_tri(scene, prim, v);
    for (int k = 0; k < 3; k++) {
        int64_t corner = grid_code(grid, k, v[0][k]);
        a[k] = (int64_t)grid_code(grid, k, v[1][k]) - corner;
        b[k] = (int64_t)grid_code(grid, k, v[2][k]) - corner;
    }
    for (int k = 0; k < 3; k++)
        if (a[k] * b[(k + 1) % 3] != a[(k + 1) % 3] * b[k])
            return false;
    return true;
}

/* Computes how far the vertices moved. A difference is exact: on a grid it is x itself, or a
 * multiple of 2^-25 step that is at most half a step; else the low bits of x. */
static void certify(const struct scene *scene, const struct scene *out, struct quantised *q)
{
    double farthest = 0.0;
    for (uint32_t i = 0; i < scene->vertex_count; i++) {
        double square = 0.0;
        for (int k = 0; k < 3; k++) {
            size_t at = 3 * (size_t)i + (size_t)k;
            double moved = fabs((double)out->vertex[at] - (double)scene->vertex[at]);
            q->moved[k] = fmax(q->moved[k], moved);
            square += moved * moved;
        }
        farthest = fmax(farthest, square);
    }
    /* The rounding errors of two sums, three squares and the root are below 2^-51 of it. */
    q->distance = sqrt(farthest) * (1.0 + 4.0 * DBL_EPSILON);
}

static void move_vertices(const struct scene *scene, struct scene *out, struct quantised *q)
{
    for (size_t at = 0; at < 3 * (size_t)scene->vertex_count; at++) {
        double step = (double)q->grid.step[at % 3];
        double to = nearest((double)scene->vertex[at], step) * step;
        out->vertex[at] = (float)to + 0.0f; /* no negative zero */
    }
    certify(scene, out, q);
}

static enum status copy_scene(const struct scene *scene, struct scene *out)
{
    enum status status = scene_make(scene->vertex_count, scene->tri_count, out);
    if (status)
        return status;
    const size_t vertices = scene->vertex_count, tris = scene->tri_count;
    if (tris)
        memcpy(out->index, scene->index, 3 * tris * sizeof *out->index);
    out->camera = scene->camera;
    out->has_camera = scene->has_camera;
    out->light_count = scene->light_count;
    out->material_count = scene->material_count;
    out->normal = alloc_copy(scene->normal, 3 * vertices, sizeof *out->normal);
    out->material_of = alloc_copy(scene->material_of, tris, sizeof *out->material_of);
    out->light = alloc_copy(scene->light, scene->light_count, sizeof *out->light);
    out->material = alloc_copy(scene->material, scene->material_count, sizeof *out->material);
    bool lost = (scene->normal && vertices && !out->normal) ||
                (scene->material_of && tris && !out->material_of) ||
                (scene->light_count && !out->light) || (scene->material_count && !out->material);
    return lost ? STATUS_MEMORY : STATUS_OK;
}

/* Steps and least numbers of a grid that holds the scene. */
static void make_grid(const struct scene *scene, bool even, struct grid *grid)
{
    double least[3], most[3], step[3];
    for (int k = 0; k < 3; k++) {
        extents(scene, k, &least[k], &most[k]);
        step[k] =
            step_of(least[k], most[k], grid->bits, even ? (double)EVEN_MOST : (double)GRID_MOST);
    }
    const double largest = fmax(step[0], fmax(step[1], step[2]));
    for (int k = 0; k < 3; k++) {
        step[k] = even ? largest : step[k];
        grid->step[k] = (float)step[k];
        grid->lo[k] = (int32_t)nearest(least[k], step[k]);
    }
}

static enum status quantise(const struct scene *scene, uint32_t bits, bool even, struct scene *out,
                            struct quantised *quantised, struct reason *reason)
{
    *out = (struct scene){0};
    *quantised = (struct quantised){.grid.bits = bits};
    if (bits < QUANTISE_BITS_LEAST || bits > QUANTISE_BITS_MOST)
        return fail(reason, STATUS_INPUT, "quantise: %u bits; %u to %u are possible", bits,
                    QUANTISE_BITS_LEAST, QUANTISE_BITS_MOST);
    enum status status = check_vertices(scene, reason);
    if (status)
        return status;
    if (copy_scene(scene, out)) {
        scene_free(out);
        return fail(reason, STATUS_MEMORY, "quantise: no memory for %u vertices",
                    scene->vertex_count);
    }
    make_grid(scene, even, &quantised->grid);
    move_vertices(scene, out, quantised);
    for (uint32_t i = 0; i < scene->tri_count; i++)
        quantised->flat += is_flat(out, &quantised->grid, i);
    return STATUS_OK;
}

enum status scene_quantise(const struct scene *scene, uint32_t bits, struct scene *out,
                           struct quantised *quantised, struct reason *reason)
{
    return quantise(scene, bits, false, out, quantised, reason);
}

enum status scene_quantise_even(const struct scene *scene, uint32_t bits, struct scene *out,
                                struct quantised *quantised, struct reason *reason)
{
    return quantise(scene, bits, true, out, quantised, reason);
}

/* --- truncation ------------------------------------------------------------------------------- */

/* Subnormals too: they have no implicit bit, but the same low ones. */
static float without_low_bits(float x, uint32_t bits)
{
    return float_from_bits(float_bits(x) >> bits << bits);
}

enum status scene_truncate(const struct scene *scene, uint32_t bits, struct scene *out,
                           struct quantised *quantised, struct reason *reason)
{
    *out = (struct scene){0};
    *quantised = (struct quantised){.grid.bits = bits};
    if (bits < 1 || bits > TRUNCATE_BITS_MOST)
        return fail(reason, STATUS_INPUT, "truncate: %u bits; 1 to %u are possible", bits,
                    TRUNCATE_BITS_MOST);
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++)
        if (!float_is_finite(scene->vertex[i]))
            return fail(reason, STATUS_INPUT, "truncate: vertex %zu is not finite", i / 3);
    if (copy_scene(scene, out)) {
        scene_free(out);
        return fail(reason, STATUS_MEMORY, "truncate: no memory for %u vertices",
                    scene->vertex_count);
    }
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++)
        out->vertex[i] = without_low_bits(scene->vertex[i], bits);
    certify(scene, out, quantised);
    return STATUS_OK;
}

const struct lossy lossy_truncated = {1, TRUNCATE_BITS_MOST, TRUNCATE_BITS_DEFAULT,
                                      "low bits dropped", scene_truncate};
const struct lossy lossy_quantised = {QUANTISE_BITS_LEAST, QUANTISE_BITS_MOST,
                                      QUANTISE_BITS_DEFAULT, "bits an axis", scene_quantise};
const struct lossy lossy_even = {QUANTISE_BITS_LEAST, QUANTISE_BITS_MOST, QUANTISE_BITS_DEFAULT,
                                 "bits an axis, with one step", scene_quantise_even};

/* The largest power of two that divides all coordinates; 1 if all are 0. */
static float step_of_axis(const struct scene *scene, int k)
{
    int least = INT32_MAX;
    for (uint32_t i = 0; i < scene->vertex_count; i++) {
        uint32_t bits = float_bits(scene->vertex[3 * (size_t)i + (size_t)k]) & 0x7FFFFFFFu;
        if (bits == 0)
            continue;
        int exponent = bits >> 23 ? (int)(bits >> 23) : 1;
        uint32_t fraction = bits >> 23 ? (bits & 0x7FFFFFu) | 0x800000u : bits;
        int lowest = exponent - 150 + __builtin_ctz(fraction);
        least = lowest < least ? lowest : least;
    }
    return least == INT32_MAX ? 1.0f : ldexpf(1.0f, least);
}

enum status grid_of_scene(const struct scene *scene, struct grid *out, struct reason *reason)
{
    *out = (struct grid){0};
    for (int k = 0; k < 3; k++) {
        double least, most;
        extents(scene, k, &least, &most);
        float step = step_of_axis(scene, k);
        double low = least / (double)step, high = most / (double)step;
        bool fits = step >= FLT_MIN && low >= -(double)GRID_MOST && high <= (double)GRID_MOST &&
                    high - low <= (double)((1u << QUANTISE_BITS_MOST) - 1);
        for (uint32_t i = 0; i < scene->vertex_count && fits; i++)
            fits = float_bits(scene->vertex[3 * (size_t)i + (size_t)k]) != float_bits(-0.0f);
        if (!fits)
            return fail(reason, STATUS_LIMIT,
                        "the scene's %c coordinates lie on no grid of at most %u bits", "xyz"[k],
                        QUANTISE_BITS_MOST);
        out->step[k] = step;
        out->lo[k] = (int32_t)low;
        while ((double)((1u << out->bits) - 1) < high - low)
            out->bits++;
    }
    return STATUS_OK;
}

static bool is_even(const struct scene *scene, float step)
{
    bool fits = step >= FLT_MIN && step <= EVEN_STEP_MOST;
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count && fits; i++) {
        float x = scene->vertex[i];
        fits = fabs((double)x / (double)step) <= (double)EVEN_MOST &&
               float_bits(x) != float_bits(-0.0f);
    }
    return fits;
}

enum status grid_even_of_scene(const struct scene *scene, struct grid *out, struct reason *reason)
{
    float step = INFINITY;
    for (int k = 0; k < 3; k++) {
        double least, most;
        extents(scene, k, &least, &most);
        if (least != 0.0 || most != 0.0)
            step = fminf(step, step_of_axis(scene, k));
    }
    step = step == INFINITY ? 1.0f : fminf(step, EVEN_STEP_MOST);
    *out = (struct grid){.step = {step, step, step}};
    if (!is_even(scene, step))
        return fail(reason, STATUS_LIMIT,
                    "the scene's coordinates lie on no grid of one step and numbers of 24 bits");
    return STATUS_OK;
}
