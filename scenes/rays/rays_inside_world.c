#include "scenes/rays/rays_inside_world.h"

#include "ref/world/bake.h"
#include "ref/world/object_ray.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BAKED_MOST (1u << 22)
#define ROUNDING   0x1p-19 /* of an origin in the space of a mesh, of |W| |o - T|: 32 u */

/* A mesh with what rays inside it are made of. */
struct closed_mesh {
    const struct scene *scene;
    struct topology topology;
    struct oracle *oracle;
};

static void mesh_free(struct closed_mesh *mesh)
{
    topology_free(&mesh->topology);
    oracle_free(mesh->oracle);
    *mesh = (struct closed_mesh){0};
}

/* Errors: STATUS_INPUT the mesh is open, with the first open edge. */
static enum status mesh_make(const struct scene *scene, struct closed_mesh *out,
                             struct reason *reason)
{
    *out = (struct closed_mesh){.scene = scene};
    enum status status = topology_make(scene, &out->topology, reason);
    if (status == STATUS_MEMORY)
        return fail(reason, status, "no memory for a mesh of %u triangles", scene->tri_count);
    if (!status)
        status = topology_is_closed(&out->topology, scene, reason);
    return status ? status : oracle_make(scene, &out->oracle, reason);
}

static bool is_active(const struct world *world, uint32_t i)
{
    const struct scene *scene = world_scene(world, i);
    return scene && scene->tri_count > 0 && world->instance[i].mask != 0;
}

void world_inside_masks(struct world *world)
{
    for (uint32_t i = 0; i < world->instance_count; i++)
        if (is_active(world, i))
            world->instance[i].mask = 1u << i % 8;
}

/* --- one instance ----------------------------------------------------------------------------- */

/* At most the distance of the point from every triangle: from its plane, or from its box. */
static double depth_of(const struct scene *scene, const double p[3])
{
    double least = INFINITY;
    for (uint32_t i = 0; i < scene->tri_count; i++) {
        float v[3][3];
        double box = 0, plane = 0, length = 0, a[3], b[3];
        scene_tri(scene, i, v);
        for (int k = 0; k < 3; k++) {
            const double lo = (double)fminf(v[0][k], fminf(v[1][k], v[2][k])) - p[k];
            const double hi = (double)fmaxf(v[0][k], fmaxf(v[1][k], v[2][k])) - p[k];
            box = fmax(box, fmax(lo, -hi));
            a[k] = (double)v[1][k] - (double)v[0][k];
            b[k] = (double)v[2][k] - (double)v[0][k];
        }
        for (int k = 0; k < 3; k++) {
            const int j = (k + 1) % 3, l = (k + 2) % 3;
            const double n = a[j] * b[l] - a[l] * b[j];
            plane += n * (p[k] - (double)v[0][k]);
            length += n * n;
        }
        plane = length > 0 ? fabs(plane) / sqrt(length) : 0;
        least = fmin(least, fmax(box, plane));
    }
    return least;
}

/* An origin in the space of the mesh, and in the world. */
struct placed_origin {
    float in_mesh[3], in_world[3];
    bool safe; /* whatever is rounded, it is inside */
};

struct origins {
    const struct instance *instance;
    const struct scene *scene;
    float w[9];
    struct placed_origin of[INSIDE_ORIGINS];
    size_t count;
};

static void place_point(const struct instance *at, const double p[3], double out[3])
{
    for (int k = 0; k < 3; k++) {
        const float *m = at->m[k];
        out[k] = (((double)m[0] * p[0] + (double)m[1] * p[1]) + (double)m[2] * p[2]) + (double)m[3];
    }
}

static struct placed_origin place_origin(const struct origins *origins, const float org[3])
{
    struct placed_origin out = {.safe = false};
    double p[3], placed[3], back[3], rounding = 0;
    memcpy(out.in_mesh, org, sizeof out.in_mesh);
    for (int k = 0; k < 3; k++)
        p[k] = (double)org[k];
    place_point(origins->instance, p, placed);
    for (int k = 0; k < 3; k++)
        out.in_world[k] = (float)placed[k];
    for (int k = 0; k < 3; k++) {
        double sum = 0, size = 0;
        for (int j = 0; j < 3; j++) {
            const double w = (double)origins->w[3 * k + j];
            const double x = (double)out.in_world[j] - (double)origins->instance->m[j][3];
            sum += w * x;
            size += fabs(w * x);
        }
        back[k] = sum;
        rounding = fmax(rounding, size * ROUNDING);
    }
    out.safe = depth_of(origins->scene, back) > rounding &&
               fabs(back[0] - p[0]) + fabs(back[1] - p[1]) + fabs(back[2] - p[2]) <
                   depth_of(origins->scene, p);
    return out;
}

/* The origin of a ray of the mesh, placed, or a safe one in its stead; NULL: there is none yet. */
static const struct placed_origin *origin_of(struct origins *origins, const float org[3])
{
    size_t i = 0;
    while (i < origins->count && memcmp(origins->of[i].in_mesh, org, 3 * sizeof *org) != 0)
        i++;
    if (i == origins->count && i < INSIDE_ORIGINS)
        origins->of[origins->count++] = place_origin(origins, org);
    for (size_t k = 0; k < origins->count; k++) {
        const struct placed_origin *one = &origins->of[(i + k) % origins->count];
        if (one->safe)
            return one;
    }
    return NULL;
}

/* Takes the rays of the mesh into the world: their targets are placed, and aimed at from where
 * float32 has the origins. */
static enum status place_rays(struct origins *origins, size_t count, struct ray *ray)
{
    const struct placed_origin *from = NULL;
    for (size_t i = 0; i < count && !from; i++) /* the first safe one stands in for those before */
        from = origin_of(origins, ray[i].org);
    for (size_t i = 0; i < count && from; i++) {
        double target[3], placed[3];
        for (int k = 0; k < 3; k++)
            target[k] = (double)ray[i].org[k] + (double)ray[i].dir[k];
        from = origin_of(origins, ray[i].org);
        place_point(origins->instance, target, placed);
        for (int k = 0; k < 3; k++) {
            ray[i].org[k] = from->in_world[k];
            ray[i].dir[k] = (float)(placed[k] - (double)from->in_world[k]);
        }
    }
    return from || count == 0 ? STATUS_OK : STATUS_INPUT;
}

static enum status inside_one(const struct world *world, uint32_t index,
                              const struct closed_mesh *mesh, uint64_t seed, size_t count,
                              struct ray *out, uint8_t *aim, size_t *origin_count,
                              struct reason *reason)
{
    struct inside one;
    struct origins origins = {.instance = &world->instance[index], .scene = mesh->scene};
    struct reason why = {""};
    enum status status = rays_inside_make(mesh->scene, &mesh->topology, mesh->oracle, seed, count,
                                          out, aim, &one, &why);
    if (!status)
        status = transform_inverse(origins.instance->m, origins.w, &why);
    if (status)
        return fail(reason, status, "instance %u: %s", index, why.text);
    if (place_rays(&origins, count, out))
        return fail(reason, STATUS_INPUT,
                    "instance %u: no point inside is so far from its surface that float32 keeps it "
                    "inside",
                    index);
    *origin_count += one.origins;
    return STATUS_OK;
}

/* --- a world ---------------------------------------------------------------------------------- */

/* Chooses active instances, spread evenly. Returns how many. */
static uint32_t choose(const struct world *world, uint32_t chosen[INSIDE_INSTANCES])
{
    uint32_t active = 0, count = 0, seen = 0;
    for (uint32_t i = 0; i < world->instance_count; i++)
        active += is_active(world, i);
    const uint32_t most = active < INSIDE_INSTANCES ? active : INSIDE_INSTANCES;
    for (uint32_t i = 0; i < world->instance_count && count < most; i++) {
        if (!is_active(world, i))
            continue;
        if ((uint64_t)seen * most / active == count)
            chosen[count++] = i;
        seen++;
    }
    return count;
}

/* All instances as one closed mesh. */
static enum status across_seams(const struct world *world, uint64_t seed, size_t count,
                                struct ray *out, uint8_t *aim, struct world_inside *inside,
                                struct reason *reason)
{
    struct scene baked;
    struct closed_mesh mesh = {0};
    struct inside one = {0};
    enum status status = world_bake(world, BAKED_MOST, &baked, reason);
    if (status)
        return status;
    status = mesh_make(&baked, &mesh, reason);
    if (!status)
        status = rays_inside_make(&baked, &mesh.topology, mesh.oracle, seed, count, out, aim, &one,
                                  reason);
    inside->seams = true;
    inside->origins = one.origins;
    mesh_free(&mesh);
    scene_free(&baked);
    return status;
}

/* Those of one bit of the mask, or all; every triangle counts. */
static struct ray_mode mode_of_instance(const struct world_inside *inside, uint32_t instance)
{
    return (struct ray_mode){inside->seams ? 0xFF : 1u << instance % 8, ABI_RAY_OPAQUE};
}

enum status world_rays_inside_make(const struct world *world, uint64_t seed, size_t count,
                                   struct ray *out, struct ray_mode *mode, uint8_t *aim,
                                   struct world_inside *inside, struct reason *reason)
{
    uint32_t chosen[INSIDE_INSTANCES], open = 0;
    struct reason why = {""}, seam = {""};
    *inside = (struct world_inside){.instances = choose(world, chosen)};
    if (inside->instances == 0)
        return fail(reason, STATUS_INPUT, "no instance is active");
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i < inside->instances && !status; i++) {
        const size_t from = count * i / inside->instances;
        const size_t to = count * (i + 1) / inside->instances;
        struct closed_mesh mesh;
        open = chosen[i];
        status = mesh_make(world_scene(world, open), &mesh, &why);
        if (!status)
            status = inside_one(world, open, &mesh, seed + i, to - from, out + from, aim + from,
                                &inside->origins, reason);
        else if (status == STATUS_INPUT)
            inside->seams = true;
        else
            status = fail(reason, status, "instance %u: %s", open, why.text);
        mesh_free(&mesh);
        for (size_t r = from; r < to; r++)
            mode[r] = mode_of_instance(inside, open);
    }
    if (!inside->seams)
        return status;
    status = across_seams(world, seed, count, out, aim, inside, &seam);
    for (size_t r = 0; r < count; r++)
        mode[r] = mode_of_instance(inside, 0);
    return status == STATUS_INPUT
               ? fail(reason, status, "instance %u: %.100s; all instances together: %.100s", open,
                      why.text, seam.text)
           : status ? fail(reason, status, "%s", seam.text)
                    : STATUS_OK;
}
