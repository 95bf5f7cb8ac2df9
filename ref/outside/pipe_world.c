#include "ref/outside/pipe_world.h"

#include <stdlib.h>
#include <string.h>

#define HEAD_WORDS     4u /* of the filter and of a mesh */
#define GEOMETRY_WORDS 4u
#define INSTANCE_WORDS 16u

_Static_assert(sizeof(struct pipe_world_ray) == 40, "a ray of a request");
_Static_assert(sizeof(struct pipe_world_hit) == 32, "a hit of an answer");

/* --- requests --------------------------------------------------------------------------------- */

static size_t words_of(const struct world *world)
{
    size_t words = HEAD_WORDS + INSTANCE_WORDS * (size_t)world->instance_count;
    for (uint32_t i = 0; i < world->mesh_count; i++) {
        const struct world_mesh *mesh = &world->mesh[i];
        words += HEAD_WORDS + 3 * ((size_t)mesh->scene->vertex_count + mesh->scene->tri_count) +
                 GEOMETRY_WORDS * (size_t)mesh->geometry_count;
    }
    return words;
}

static void put(char **at, const void *bytes, size_t size)
{
    if (size > 0) /* an empty array may be NULL */
        memcpy(*at, bytes, size);
    *at += size;
}

static void put_mesh(char **at, const struct world_mesh *mesh)
{
    const struct scene *scene = mesh->scene;
    const uint32_t head[HEAD_WORDS] = {scene->vertex_count, scene->tri_count, mesh->geometry_count};
    put(at, head, sizeof head);
    put(at, scene->vertex, 3 * sizeof(float) * (size_t)scene->vertex_count);
    put(at, scene->index, 3 * sizeof(uint32_t) * (size_t)scene->tri_count);
    for (uint32_t i = 0; i < mesh->geometry_count; i++) {
        const uint32_t words[GEOMETRY_WORDS] = {mesh->geometry[i].count, mesh->geometry[i].opaque};
        put(at, words, sizeof words);
    }
}

char *pipe_world_words(const struct world *world, size_t *size)
{
    *size = sizeof(uint32_t) * words_of(world);
    char *words = alloc_zeroed(1, *size), *at = words;
    if (!words)
        return NULL;
    const uint32_t filter[HEAD_WORDS] = {(uint32_t)world->filter.kind, world->filter.seed,
                                         world->filter.share};
    put(&at, filter, sizeof filter);
    for (uint32_t i = 0; i < world->mesh_count; i++)
        put_mesh(&at, &world->mesh[i]);
    for (uint32_t i = 0; i < world->instance_count; i++) {
        const struct instance *one = &world->instance[i];
        const uint32_t head[] = {one->mesh, one->custom, one->mask, one->flags};
        put(&at, head, sizeof head);
        put(&at, one->m, sizeof one->m);
    }
    return words;
}

/* --- answers ---------------------------------------------------------------------------------- */

static enum status check_place(const struct world *world, const struct pipe_world_hit *answer,
                               struct reason *reason)
{
    if (answer->instance >= world->instance_count)
        return fail(reason, STATUS_INPUT, "names instance %u of %u", answer->instance,
                    world->instance_count);
    const uint32_t mesh = world->instance[answer->instance].mesh;
    if (mesh == WORLD_NO_MESH)
        return fail(reason, STATUS_INPUT, "names instance %u, which has no mesh", answer->instance);
    const struct world_mesh *of = &world->mesh[mesh];
    if (answer->geometry >= of->geometry_count)
        return fail(reason, STATUS_INPUT, "names geometry %u of %u of instance %u",
                    answer->geometry, of->geometry_count, answer->instance);
    if (answer->triangle >= of->geometry[answer->geometry].count)
        return fail(reason, STATUS_INPUT, "names triangle %u of %u of instance %u, geometry %u",
                    answer->triangle, of->geometry[answer->geometry].count, answer->instance,
                    answer->geometry);
    if (answer->side > 1)
        return fail(reason, STATUS_INPUT, "has side %u: 1 is the front, 0 the back", answer->side);
    if (answer->custom != PIPE_NO_CUSTOM && answer->custom > ABI_CUSTOM_MOST)
        return fail(reason, STATUS_INPUT, "has custom index %u, which is over %u (24 bits)",
                    answer->custom, ABI_CUSTOM_MOST);
    return STATUS_OK;
}

enum status pipe_world_take(const struct world *world, const struct pipe_world_hit *answer,
                            bool unnamed, struct hit *hit, uint32_t *tag, struct reason *reason)
{
    *hit = (struct hit){.prim = ABI_NO_PRIM};
    *tag = 0;
    if (answer->instance == ABI_NO_PRIM) {
        const uint32_t more[] = {answer->geometry, answer->triangle, answer->side, answer->custom};
        static const char *const names[] = {"geometry", "triangle", "side", "custom index"};
        for (size_t i = 0; i < ARRAY_COUNT(more); i++)
            if (more[i] != 0)
                return fail(reason, STATUS_INPUT, "is a miss of %s %u: a miss has 0 there",
                            names[i], more[i]);
        return STATUS_OK;
    }
    if (unnamed) {
        hit->prim = 0;
        return STATUS_OK;
    }
    enum status status = check_place(world, answer, reason);
    if (status)
        return status;
    const struct instance *instance = &world->instance[answer->instance];
    const struct geometry *geometry = &world->mesh[instance->mesh].geometry[answer->geometry];
    const uint32_t custom = answer->custom == PIPE_NO_CUSTOM ? instance->custom : answer->custom;
    *hit = (struct hit){answer->t, answer->u, answer->v,
                        world->first[answer->instance] + geometry->first + answer->triangle};
    *tag = custom | (answer->side ? ABI_TAG_FRONT : 0);
    return STATUS_OK;
}
