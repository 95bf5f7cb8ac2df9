#include "scenes/world_steps.h"

#include <stdlib.h>
#include <string.h>

static void free_copy(struct world *world)
{
    for (uint32_t i = 0; i < world->mesh_count && world->mesh; i++)
        if (world->mesh[i].scene) {
            free(world->mesh[i].scene->vertex);
            free(world->mesh[i].scene);
        }
    free(world->mesh);
    free(world->instance);
    free(world->first);
    *world = (struct world){0};
}

/* A mesh with vertices of its own; on error what is made is left in it. */
static enum status copy_mesh(const struct world_mesh *from, struct world_mesh *out)
{
    const size_t floats = 3 * (size_t)from->scene->vertex_count;
    *out = *from;
    out->scene = malloc(sizeof *out->scene);
    if (!out->scene)
        return STATUS_MEMORY;
    *out->scene = *from->scene;
    out->scene->vertex = alloc_copy(from->scene->vertex, floats, sizeof *from->scene->vertex);
    return from->scene->vertex && !out->scene->vertex ? STATUS_MEMORY : STATUS_OK;
}

static enum status copy_moved(const struct world *from, const struct step *step, struct world *out,
                              struct reason *reason)
{
    *out = *from;
    out->borrows = true;
    out->mesh = alloc_zeroed(from->mesh_count, sizeof *out->mesh);
    out->instance = alloc_copy(from->instance, from->instance_count, sizeof *out->instance);
    out->first = NULL;
    enum status status =
        out->mesh && (out->instance || !from->instance) ? STATUS_OK : STATUS_MEMORY;
    for (uint32_t i = 0; i < from->mesh_count && !status; i++)
        status = copy_mesh(&from->mesh[i], &out->mesh[i]);
    if (status)
        (void)fail(reason, status, "no memory for the %u instances of a step",
                   from->instance_count);
    if (!status && step)
        status = world_motion_apply(step, out, reason);
    if (!status)
        status = world_finish(out, reason);
    if (status)
        free_copy(out);
    return status;
}

enum status steps_worlds(const struct world *first, const struct step *step, uint32_t count,
                         struct world out[LIFE_STEPS_MOST + 1], struct reason *reason)
{
    enum status status = copy_moved(first, NULL, &out[0], reason);
    uint32_t made = !status;
    for (; made <= count && !status; made += !status)
        status = copy_moved(&out[made - 1], &step[made - 1], &out[made], reason);
    for (uint32_t i = 0; i < made && status; i++)
        free_copy(&out[i]);
    return status;
}

void steps_worlds_free(struct world world[LIFE_STEPS_MOST + 1], uint32_t count)
{
    for (uint32_t i = 0; i <= count; i++)
        free_copy(&world[i]);
}
