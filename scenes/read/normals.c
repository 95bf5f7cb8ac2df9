#include "scenes/read/normals.h"

#include "ref/base/double3.h"

#include <stdlib.h>

/* Adds the triangle's normal to the sums of its three corners, weighted by the angles. */
static void add_triangle(const struct scene *scene, uint32_t prim, double *sum)
{
    float v[3][3];
    scene_tri(scene, prim, v);
    double side[3][3], normal[3]; /* side[c] leads from corner c to the next; unit vectors */
    for (int c = 0; c < 3; c++) {
        double3_sub(v[(c + 1) % 3], v[c], side[c]);
        if (!double3_unit(side[c]))
            return;
    }
    double3_cross(side[0], side[1], normal);
    if (!double3_unit(normal))
        return;
    for (int c = 0; c < 3; c++) {
        double cosine = -double3_dot(side[c], side[(c + 2) % 3]);
        double angle = acos(fmin(fmax(cosine, -1), 1)); /* rounding may leave [-1, 1] */
        for (int k = 0; k < 3; k++)
            sum[3 * (size_t)scene->index[3 * (size_t)prim + (size_t)c] + (size_t)k] +=
                angle * normal[k];
    }
}

float *scene_normals(const struct scene *scene)
{
    return scene_normals_told(scene, NULL);
}

float *scene_normals_told(const struct scene *scene, uint8_t *none)
{
    size_t count = scene->vertex_count;
    double *sum = alloc_zeroed(3 * count, sizeof *sum);
    float *normal = alloc_zeroed(3 * count, sizeof *normal);
    if (!sum || !normal) {
        free(sum);
        free(normal);
        return NULL;
    }
    for (uint32_t i = 0; i < scene->tri_count; i++)
        add_triangle(scene, i, sum);
    for (size_t i = 0; i < count; i++) {
        bool has_none = !double3_unit(sum + 3 * i);
        if (none)
            none[i] = has_none;
        if (has_none) {
            sum[3 * i] = sum[3 * i + 2] = 0;
            sum[3 * i + 1] = 1;
        }
        for (size_t k = 3 * i; k < 3 * i + 3; k++)
            normal[k] = (float)sum[k];
    }
    free(sum);
    return normal;
}
