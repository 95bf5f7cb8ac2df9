/* Trials of the worlds of scenes/worlds, small. */
#include "fuzz/gen/gen_world.h"

#include "scenes/worlds.h"

#include <stdlib.h>
#include <string.h>

/* Ranges of whole parameters, in their order; other ones stay what they are by themselves. */
static const struct {
    const char *begins; /* the names of the generators */
    uint32_t least[3], most[3];
} ranges[] = {{"placed-", {1, 1, 0}, {2, 5, 0}}, {"wall", {1, 0, 0}, {3, 1000, 0}},
              {"nest", {1, 2, 0}, {2, 8, 0}},    {"crowd", {1, 0, 0}, {12, 0, 0}},
              {"twins", {0, 0, 0}, {2, 0, 0}},   {"mixed", {1, 0, 128}, {12, 3, 128}}};

static void draw_values(struct rng *rng, const struct world_generator *generator,
                        double value[GENERATOR_PARAMS])
{
    for (uint32_t i = 0; i < GENERATOR_PARAMS && generator->param[i].name; i++)
        value[i] = generator->param[i].value;
    for (size_t r = 0; r < ARRAY_COUNT(ranges); r++) {
        if (strncmp(generator->name, ranges[r].begins, strlen(ranges[r].begins)) != 0)
            continue;
        for (uint32_t i = 0; i < 3; i++)
            if (ranges[r].most[i] > 0)
                value[i] =
                    ranges[r].least[i] + rng_below(rng, ranges[r].most[i] - ranges[r].least[i] + 1);
    }
}

/* The sum of all meshes. */
static void count_of(const struct world *world, uint32_t *vertices, uint32_t *triangles,
                     uint32_t *geometries)
{
    *vertices = *triangles = *geometries = 0;
    for (uint32_t i = 0; i < world->mesh_count; i++) {
        *vertices += world->mesh[i].scene->vertex_count;
        *triangles += world->mesh[i].scene->tri_count;
        *geometries += world->mesh[i].geometry_count;
    }
}

static void take_mesh(const struct world_mesh *mesh, uint32_t number, struct fuzz_trial *out,
                      uint32_t *vertices, uint32_t *triangles, uint32_t *geometries)
{
    const struct scene *from = mesh->scene;
    memcpy(out->scene.vertex + 3 * (size_t)*vertices, from->vertex,
           12 * (size_t)from->vertex_count);
    for (size_t i = 0; i < 3 * (size_t)from->tri_count; i++)
        out->scene.index[3 * (size_t)*triangles + i] = *vertices + from->index[i];
    for (uint32_t i = 0; i < mesh->geometry_count; i++)
        out->world.geometry[(*geometries)++] =
            (struct trial_geometry){number, mesh->geometry[i].count, mesh->geometry[i].opaque};
    *vertices += from->vertex_count;
    *triangles += from->tri_count;
}

static enum status take_world(const struct world *world, uint32_t rays, struct fuzz_trial *out,
                              struct reason *reason)
{
    uint32_t vertices, triangles, geometries;
    count_of(world, &vertices, &triangles, &geometries);
    enum status status = fuzz_trial_make(vertices, triangles, rays, out, reason);
    if (!status)
        status = trial_world_make(0, geometries, world->instance_count, rays, &out->world, reason);
    if (status) {
        fuzz_trial_free(out);
        return status;
    }
    vertices = triangles = geometries = 0;
    for (uint32_t i = 0; i < world->mesh_count; i++)
        take_mesh(&world->mesh[i], i, out, &vertices, &triangles, &geometries);
    memcpy(out->world.instance, world->instance, sizeof *world->instance * world->instance_count);
    out->world.filter = world->filter;
    return STATUS_OK;
}

/* One of the generators that campaigns draw. */
static const struct world_generator *draw_generator(struct rng *rng)
{
    uint32_t count = 0, at = 0;
    for (size_t i = 0; world_generators[i]; i++)
        count += !world_generators[i]->undrawn;
    for (uint32_t left = rng_below(rng, count) + 1; left > 0; at++)
        left -= !world_generators[at]->undrawn;
    return world_generators[at - 1];
}

enum status gen_world_of_scenes(struct rng *rng, uint32_t rays, struct fuzz_trial *out,
                                const char **name, struct reason *reason)
{
    double value[GENERATOR_PARAMS] = {0};
    struct world world;
    const struct world_generator *generator = draw_generator(rng);
    draw_values(rng, generator, value);
    uint64_t seed = rng_u64(rng);
    *name = generator->name;
    *out = (struct fuzz_trial){0};
    enum status status = world_generator_make(generator, value, seed, &world, reason);
    if (!status)
        status = take_world(&world, rays, out, reason);
    world_free(&world);
    return status;
}
