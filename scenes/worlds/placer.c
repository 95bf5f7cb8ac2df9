#include "scenes/worlds/placer.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

enum status placer_start(struct placer *placer, uint32_t meshes, uint32_t instances,
                         struct reason *reason)
{
    if (instances > PLACER_INSTANCES_MOST)
        return fail(reason, STATUS_LIMIT, "%u instances, but generators make at most %u", instances,
                    PLACER_INSTANCES_MOST);
    placer->world->mesh = alloc_zeroed(meshes, sizeof *placer->world->mesh);
    placer->world->instance = alloc_zeroed(instances, sizeof *placer->world->instance);
    placer->mesh_room = meshes;
    placer->instance_room = instances;
    if (!placer->world->mesh || !placer->world->instance)
        return fail(reason, STATUS_MEMORY, "no memory for %u instances", instances);
    return STATUS_OK;
}

enum status placer_mesh(struct placer *placer, struct scene *scene, struct reason *reason)
{
    assert(placer->world->mesh_count < placer->mesh_room);
    struct world_mesh *mesh = &placer->world->mesh[placer->world->mesh_count++];
    mesh->scene = alloc_copy(scene, 1, sizeof *scene);
    mesh->geometry = alloc_zeroed(1, sizeof *mesh->geometry);
    mesh->geometry_count = 1;
    if (mesh->geometry)
        *mesh->geometry = (struct geometry){.count = scene->tri_count, .opaque = true};
    if (!mesh->scene)
        scene_free(scene);
    *scene = (struct scene){0};
    return mesh->scene && mesh->geometry ? STATUS_OK
                                         : fail(reason, STATUS_MEMORY, "no memory for a mesh");
}

enum status placer_generated(struct placer *placer, const char *generator, const double *value,
                             uint64_t seed, struct reason *reason)
{
    struct scene scene;
    enum status status = generator_make(generator_find(generator), value, seed, &scene, reason);
    return status ? status : placer_mesh(placer, &scene, reason);
}

enum status placer_box(struct placer *placer, struct reason *reason)
{
    /* Corner c has the bits of c as its x, y, z. */
    static const uint32_t index[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                       2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    struct scene scene;
    if (scene_make(8, 12, &scene))
        return fail(reason, STATUS_MEMORY, "no memory for a box");
    for (uint32_t c = 0; c < 8; c++)
        for (uint32_t k = 0; k < 3; k++)
            scene.vertex[3 * c + k] = (float)(c >> k & 1);
    memcpy(scene.index, index, sizeof index);
    return placer_mesh(placer, &scene, reason);
}

struct instance *placer_add(struct placer *placer, uint32_t mesh, const struct linear *m,
                            const double t[3])
{
    assert(placer->world->instance_count < placer->instance_room);
    struct instance *instance = &placer->world->instance[placer->world->instance_count++];
    *instance = (struct instance){.mesh = mesh, .mask = 0xFF};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            instance->m[i][j] = (float)m->m[i][j];
        instance->m[i][3] = (float)t[i];
    }
    return instance;
}

double placer_power(int k)
{
    return (double)float_from_bits((uint32_t)(127 + k) << 23);
}

struct linear linear_diagonal(double x, double y, double z)
{
    return (struct linear){{{x, 0, 0}, {0, y, 0}, {0, 0, z}}};
}

struct linear linear_multiply(const struct linear *a, const struct linear *b)
{
    struct linear out;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out.m[i][j] =
                (a->m[i][0] * b->m[0][j] + a->m[i][1] * b->m[1][j]) + a->m[i][2] * b->m[2][j];
    return out;
}

struct linear placer_rotation(struct placer *placer)
{
    double q[4], length2 = 0;
    for (int k = 0; k < 4; k++)
        q[k] = (double)rng_range(&placer->rng, -1, 1);
    q[3] += q[3] < 0 ? -0.25 : 0.25; /* never 0 as a whole */
    for (int k = 0; k < 4; k++)
        length2 += q[k] * q[k];
    const double twice = 2 / length2;
    struct linear out;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out.m[i][i] = 1 - twice * (q[j] * q[j] + q[k] * q[k]);
        out.m[i][j] = twice * (q[i] * q[j] - q[k] * q[3]);
        out.m[i][k] = twice * (q[i] * q[k] + q[j] * q[3]);
    }
    return out;
}
