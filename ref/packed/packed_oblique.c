#include "ref/packed/packed_oblique.h"

#include "ref/store.h"

#include <math.h>
#include <stdlib.h>

/* a + b = sum + *rest, without an error. */
static double two_sum(double a, double b, double *rest)
{
    double sum = a + b, part = sum - a;
    *rest = (a - (sum - part)) + (b - part);
    return sum;
}

/* The product of an axis of small whole numbers and a point, as a sum of three doubles of which the
 * first is nearest to it. */
static double place_of(const float axis[3], const float point[3], double rest[2])
{
    double x = (double)axis[0] * (double)point[0], y = (double)axis[1] * (double)point[1];
    double sum = two_sum(x, y, &rest[0]);
    return two_sum(sum, (double)axis[2] * (double)point[2], &rest[1]);
}

/* The sign of f less the sum. */
static int compare(float f, double place, const double rest[2])
{
    double low, lower, high = two_sum(rest[0], rest[1], &low);
    double apart = two_sum((double)f - place, -high, &lower); /* the difference is exact */
    double left = apart + (lower - low);
    return (left > 0) - (left < 0);
}

static void extend(struct oblique_bounds *bounds, const float axis[3][3], const float point[3])
{
    for (uint32_t j = 0; j < 3; j++) {
        double rest[2];
        double place = place_of(axis[j], point, rest);
        float near = (float)place;
        int side = compare(near, place, rest);
        float down = side > 0 ? nextafterf(near, -INFINITY) : near;
        float up = side < 0 ? nextafterf(near, INFINITY) : near;
        bounds->lo[j] = fminf(bounds->lo[j], down);
        bounds->hi[j] = fmaxf(bounds->hi[j], up);
    }
}

/* A test's numbers, of any ray. */
static bool box_of(const struct packed *packed, uint32_t ref, uint32_t child,
                   struct oblique_box *out)
{
    const struct oblique_ray none = {.dir = {1, 0, 0}};
    return packed->layout->oblique && packed->layout->oblique(packed, ref, child, &none, out);
}

bool packed_oblique_axes(const struct packed *packed, uint32_t ref, uint32_t child,
                         float axis[3][3])
{
    struct oblique_box box;
    if (!box_of(packed, ref, child, &box))
        return false;
    for (uint32_t i = 0; i < 9; i++)
        axis[i / 3][i % 3] = box.axis[i / 3][i % 3];
    return true;
}

bool packed_oblique_holds(const struct packed *packed, uint32_t ref, uint32_t child,
                          const struct oblique_bounds *bounds, uint32_t *axis)
{
    struct oblique_box box;
    *axis = 0;
    if (!(bounds->lo[0] <= bounds->hi[0]) || !box_of(packed, ref, child, &box))
        return true;
    for (; *axis < 3; ++*axis) /* written so that a NaN does not hold anything */
        if (!(box.lo[*axis] <= bounds->lo[*axis] && bounds->hi[*axis] <= box.hi[*axis]))
            return false;
    return true;
}

/* Extends the bounds of all visits from `v` to the root by a triangle. */
static void add_triangle(const struct packed *packed, const struct scene *scene,
                         const struct packed_walk *walk, uint32_t v, uint32_t prim,
                         struct oblique_bounds *bounds)
{
    float vertex[3][3], axis[3][3];
    scene_tri(scene, prim, vertex);
    for (; v > 0; v = walk->visit[v].parent) {
        const uint32_t above = walk->visit[walk->visit[v].parent].ref;
        if (!packed_oblique_axes(packed, above, walk->visit[v].ref, axis))
            continue;
        for (uint32_t c = 0; c < 3; c++)
            extend(&bounds[v], (const float(*)[3])axis, vertex[c]);
    }
}

enum status packed_oblique_make(const struct packed *packed, const struct scene *scene,
                                const struct packed_walk *walk, struct oblique_bounds **out)
{
    *out = NULL;
    if (!packed->layout->oblique)
        return STATUS_OK;
    *out = alloc_zeroed(walk->visit_count, sizeof **out);
    if (!*out)
        return STATUS_MEMORY;
    for (uint32_t v = 0; v < walk->visit_count; v++)
        for (uint32_t j = 0; j < 3; j++) {
            (*out)[v].lo[j] = INFINITY;
            (*out)[v].hi[j] = -INFINITY;
        }
    for (uint32_t v = 0; v < walk->visit_count; v++) {
        struct wide wide;
        packed->layout->load(packed, walk->visit[v].ref, &wide);
        for (uint32_t s = 0; wide.child_count == 0 && s < wide.item_count; s++) {
            uint32_t prim = packed_item(packed, &wide, s);
            if (prim < scene->tri_count)
                add_triangle(packed, scene, walk, v, prim, *out);
        }
    }
    return STATUS_OK;
}
