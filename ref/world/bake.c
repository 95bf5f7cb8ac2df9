#include "ref/world/bake.h"

/* True if rays can meet the instance. */
static bool is_active(const struct world *world, uint32_t i)
{
    return world_scene(world, i) && world->instance[i].mask != 0;
}

/* Triangles and vertices of the instances first, first + step, ... that are active. */
static void count_of(const struct world *world, uint32_t step, uint64_t *tris, uint64_t *vertices)
{
    *tris = *vertices = 0;
    for (uint64_t i = 0; i < world->instance_count; i += step) {
        if (!is_active(world, (uint32_t)i))
            continue;
        *tris += world_scene(world, (uint32_t)i)->tri_count;
        *vertices += world_scene(world, (uint32_t)i)->vertex_count;
    }
}

static enum status bake_instance(const struct world *world, uint32_t i, float *vertex,
                                 struct reason *reason)
{
    const struct instance *instance = &world->instance[i];
    const struct scene *scene = world_scene(world, i);
    for (uint32_t v = 0; v < scene->vertex_count; v++) {
        const float *p = scene->vertex + 3 * (size_t)v;
        for (int k = 0; k < 3; k++) {
            const float *m = instance->m[k];
            double at = (double)m[0] * (double)p[0] + (double)m[1] * (double)p[1] +
                        (double)m[2] * (double)p[2] + (double)m[3];
            vertex[3 * (size_t)v + (size_t)k] = (float)at;
            if (!float_is_finite((float)at))
                return fail(reason, STATUS_LIMIT,
                            "instance %u: its vertex %u is placed beyond float32", i, v);
        }
    }
    return STATUS_OK;
}

uint32_t world_bake_step(const struct world *world, uint32_t most)
{
    uint64_t tris, vertices;
    uint32_t step = 1;
    count_of(world, step, &tris, &vertices);
    for (; tris > most && step < world->instance_count; count_of(world, step, &tris, &vertices))
        step = (uint32_t)(tris / most) < 2 ? step + 1 : step * (uint32_t)(tris / most);
    return step;
}

enum status world_bake(const struct world *world, uint32_t most, struct scene *out,
                       struct reason *reason)
{
    uint64_t tris, vertices;
    const uint32_t step = world_bake_step(world, most);
    *out = (struct scene){0};
    count_of(world, step, &tris, &vertices);
    if (vertices > UINT32_MAX - 1)
        return fail(reason, STATUS_LIMIT, "the world has %llu placed vertices, over 2^32 - 2",
                    (unsigned long long)vertices);
    enum status status = scene_make((uint32_t)vertices, (uint32_t)tris, out);
    if (status)
        return fail(reason, status, "no memory for %llu placed triangles",
                    (unsigned long long)tris);
    uint32_t vertex = 0, tri = 0;
    for (uint64_t i = 0; i < world->instance_count && !status; i += step) {
        if (!is_active(world, (uint32_t)i))
            continue;
        const struct scene *scene = world_scene(world, (uint32_t)i);
        status = bake_instance(world, (uint32_t)i, out->vertex + 3 * (size_t)vertex, reason);
        for (size_t c = 0; c < 3 * (size_t)scene->tri_count; c++)
            out->index[3 * (size_t)tri + c] = vertex + scene->index[c];
        vertex += scene->vertex_count;
        tri += scene->tri_count;
    }
    if (status)
        scene_free(out);
    return status;
}
