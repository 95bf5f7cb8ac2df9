#include "tests/hard/world_parts.h"

#include "scenes/scenes.h"

#include <assert.h>
#include <stdlib.h>

struct hard_part *part_world(struct hard_made *made, uint32_t meshes, uint32_t instances,
                             const char *label)
{
    static const double one[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    struct hard_part *part = part_add(made, "%s", label);
    struct world *world = &part->world;
    part->is_world = true;
    world->mesh = alloc_zeroed(meshes, sizeof *world->mesh);
    world->instance = alloc_zeroed(instances, sizeof *world->instance);
    if (!world->mesh || !world->instance) {
        part->failed = true;
        return part;
    }
    world->mesh_count = meshes;
    world->instance_count = instances;
    for (uint32_t i = 0; i < instances; i++) {
        world->instance[i] = (struct instance){.mask = 0xFF, .custom = 0xC0DE00 + i};
        place_linear(&world->instance[i], one);
    }
    return part;
}

struct instance *part_instance(struct hard_part *part, uint32_t i)
{
    static struct instance none;
    return part->failed ? &none : &part->world.instance[i];
}

/* Room for the geometries and the scene of a mesh; false without memory. */
static bool make_mesh(struct hard_part *part, uint32_t mesh, uint32_t geometries)
{
    if (part->failed)
        return false;
    struct world_mesh *out = &part->world.mesh[mesh];
    out->geometry = alloc_zeroed(geometries, sizeof *out->geometry);
    out->scene = alloc_zeroed(1, sizeof *out->scene);
    out->geometry_count = out->geometry ? geometries : 0;
    part->failed = !out->geometry || !out->scene;
    return !part->failed;
}

void mesh_plates(struct hard_part *part, uint32_t mesh, uint32_t geometries, const uint32_t *sizes)
{
    static const float corner[3][2] = {{0, 0}, {1, 0}, {0, 1}};
    uint32_t count = 0;
    if (!make_mesh(part, mesh, geometries))
        return;
    struct world_mesh *out = &part->world.mesh[mesh];
    for (uint32_t g = 0; g < geometries; g++) {
        out->geometry[g] = (struct geometry){count, sizes[g], g % 2 == 0};
        count += sizes[g];
    }
    if (scene_make(3 * count, count, out->scene)) {
        part->failed = true;
        return;
    }
    for (uint32_t i = 0; i < 3 * count; i++) {
        out->scene->index[i] = i;
        out->scene->vertex[3 * i] = corner[i % 3][0] + 2.0f * (float)(i / 3);
        out->scene->vertex[3 * i + 1] = corner[i % 3][1];
        out->scene->vertex[3 * i + 2] = 0;
    }
}

void mesh_open(struct hard_part *part, uint32_t mesh, const char *spec)
{
    if (!make_mesh(part, mesh, 1))
        return;
    struct world_mesh *out = &part->world.mesh[mesh];
    part->failed = scene_open(spec, 1, out->scene, NULL) != STATUS_OK;
    out->geometry[0] = (struct geometry){0, out->scene->tri_count, true};
}

void mesh_cube(struct hard_part *part, uint32_t mesh)
{
    if (!make_mesh(part, mesh, 1))
        return;
    struct world_mesh *out = &part->world.mesh[mesh];
    out->geometry[0] = (struct geometry){0, 12, true};
    if (scene_make(8, 12, out->scene)) {
        part->failed = true;
        return;
    }
    for (uint32_t i = 0; i < 24; i++)
        out->scene->vertex[i] = (float)(i / 3 >> i % 3 & 1);
    for (uint32_t face = 0; face < 6; face++) { /* 2 axis + side; corners a, b, c, d around it */
        const uint32_t axis = face / 2, side = face % 2;
        const uint32_t i = 1u << (axis + 1) % 3, j = 1u << (axis + 2) % 3, a = side << axis;
        const uint32_t turn[2][6] = {{a, a + i + j, a + i, a, a + j, a + i + j},
                                     {a, a + i, a + i + j, a, a + i + j, a + j}};
        for (uint32_t k = 0; k < 6; k++)
            out->scene->index[6 * face + k] = turn[side][k];
    }
}

/* --- placing ---------------------------------------------------------------------------------- */

void place_linear(struct instance *instance, const double m[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            instance->m[i][j] = (float)m[i][j];
}

void place_at(struct instance *instance, float x, float y, float z)
{
    const float t[3] = {x, y, z};
    for (int i = 0; i < 3; i++)
        instance->m[i][3] = t[i];
}

void rotation_of(const int q[4], double size, double m[3][3])
{
    double length2 = 0;
    for (int k = 0; k < 4; k++)
        length2 += (double)(q[k] * q[k]);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double same = (double)(q[3] * q[3] + q[i] * q[i] - q[j] * q[j] - q[k] * q[k]);
        m[i][i] = size * same / length2;
        m[i][j] = size * (double)(2 * (q[i] * q[j] - q[k] * q[3])) / length2;
        m[i][k] = size * (double)(2 * (q[i] * q[k] + q[j] * q[3])) / length2;
    }
}

void rotation_draw(struct rng *rng, double size, double m[3][3])
{
    int q[4];
    for (int k = 0; k < 4; k++)
        q[k] = (int)rng_below(rng, 19) - 9;
    q[3] += q[3] < 0 ? -1 : 1; /* never 0 as a whole */
    rotation_of(q, size, m);
}

void placed_point(const struct instance *instance, const double p[3], double out[3])
{
    for (int i = 0; i < 3; i++) {
        const float *m = instance->m[i];
        out[i] = (((double)m[0] * p[0] + (double)m[1] * p[1]) + (double)m[2] * p[2]) + (double)m[3];
    }
}

uint32_t placed_number(const struct hard_part *part, uint32_t instance, uint32_t prim)
{
    for (uint32_t i = 0; i < instance; i++)
        if (part->world.instance[i].mesh != WORLD_NO_MESH)
            prim += part->world.mesh[part->world.instance[i].mesh].scene->tri_count;
    return prim;
}

/* --- rays ------------------------------------------------------------------------------------- */

void world_ray(struct hard_part *part, struct ray ray, struct ray_mode mode)
{
    void *modes = part->mode;
    part_ray(part, ray);
    if (!part->failed &&
        array_reserve(&modes, &part->mode_room, part->ray_count, sizeof *part->mode))
        part->failed = true;
    part->mode = modes;
    if (!part->failed)
        part->mode[part->ray_count - 1] = mode;
}

struct ray ray_to(const float from[3], const double to[3])
{
    float dir[3];
    for (int k = 0; k < 3; k++)
        dir[k] = (float)(to[k] - (double)from[k]);
    return ray_of(from[0], from[1], from[2], dir[0], dir[1], dir[2]);
}

void world_shot(struct hard_part *part, uint32_t instance, uint32_t prim, bool above, float slant,
                struct ray_mode mode)
{
    const struct instance *at = part_instance(part, instance);
    const float p[3] = {2.0f * (float)prim + 0.25f, 0.25f, 0};
    const float d[3] = {slant, 0, above ? -1.0f : 1.0f};
    struct ray ray = ray_of(0, 0, 0, 0, 0, 0);
    for (int k = 0; k < 3; k++) {
        const float *m = at->m[k];
        ray.dir[k] = m[0] * d[0] + m[1] * d[1] + m[2] * d[2];
        ray.org[k] = (m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + m[3]) - 4 * ray.dir[k];
    }
    world_ray(part, ray, mode);
}

void want_seen(struct hard_part *part, uint32_t instance, uint32_t prim, bool front)
{
    if (part->failed)
        return;
    want_id(part, HARD_ALL, placed_number(part, instance, prim));
    want(part, HARD_ALL, WANT_HIT | WANT_TAG);
    if (!part->failed)
        part->want[part->ray_count - 1].tag =
            part->world.instance[instance].custom | (front ? ABI_TAG_FRONT : 0);
}
