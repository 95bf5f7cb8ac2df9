/* The triangles of what is exported: of a scene, or placed ones of a world. */
#include "fuzz/export/export_inner.h"

#include "ref/world/placed.h"

#include <stdio.h>

uint32_t export_tri_count(const struct export_case *the)
{
    return the->world ? world_tri_count(the->world) : the->trial->scene.tri_count;
}

void export_tri(const struct export_case *the, uint32_t prim, float v[3][3])
{
    if (!the->world) {
        scene_tri(&the->trial->scene, prim, v);
        return;
    }
    const struct place place = world_place(the->world, prim);
    const struct instance *instance = &the->world->instance[place.instance];
    float own[3][3];
    scene_tri(world_scene(the->world, place.instance), place.prim, own);
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++) {
            double error;
            v[c][k] = (float)placed_about(instance->m[k], own[c], &error);
        }
}

void export_place(const struct export_case *the, uint32_t prim, char text[EXPORT_PLACE_MOST])
{
    if (!the->world) {
        snprintf(text, EXPORT_PLACE_MOST, "triangle %u", prim);
        return;
    }
    const struct place place = world_place(the->world, prim);
    snprintf(text, EXPORT_PLACE_MOST, "instance %u, geometry %u, triangle %u", place.instance,
             place.geometry, place.tri);
}
