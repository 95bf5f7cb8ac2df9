#include "bench/measure/shadow_rays.h"

#include <math.h>

#define LIFTED 1e-4 /* of the scene's size */

static double find_light(const struct scene *scene, double light[3])
{
    struct box box = scene_bounds(scene);
    double size = 0;
    for (int k = 0; k < 3; k++) {
        double side = (double)box.hi[k] - (double)box.lo[k];
        size = side > size ? side : size;
    }
    for (int k = 0; k < 3; k++)
        light[k] = scene->light_count
                       ? (double)scene->light[0].pos[k]
                       : ((double)box.lo[k] + (double)box.hi[k]) / 2 + (k == 1 ? 2 : 0.7) * size;
    return size;
}

enum status shadow_rays_make(const struct scene *scene, const struct ray *ray,
                             const struct hit *hit, size_t count, struct ray *out,
                             struct reason *reason)
{
    double light[3], size = find_light(scene, light);
    size_t hits = 0;
    for (size_t i = 0; i < count; i++) {
        struct ray *to = &out[hits];
        double length = 0;
        if (hit[i].prim == ABI_NO_PRIM)
            continue;
        for (int k = 0; k < 3; k++)
            length += (double)ray[i].dir[k] * (double)ray[i].dir[k];
        double t = (double)hit[i].t - LIFTED * size / sqrt(length);
        *to = (struct ray){.tmax = 1};
        for (int k = 0; k < 3; k++) {
            to->org[k] = (float)((double)ray[i].org[k] + t * (double)ray[i].dir[k]);
            to->dir[k] = (float)(light[k] - (double)to->org[k]);
        }
        hits++;
    }
    if (hits == 0)
        return fail(reason, STATUS_INPUT, "no primary ray hits the scene");
    for (size_t i = hits; i < count; i++)
        out[i] = out[i - hits];
    return STATUS_OK;
}
