/* Laws of every engine that traces worlds, for those whose arithmetic is not ours: worlds of plates
 * in which each ray has one right answer, far from every edge. Includes cmocka.h, whose macros must
 * come last. */
#ifndef TESTS_WORLD_LAWS_H
#define TESTS_WORLD_LAWS_H

#include "ref/engine.h"
#include "ref/world/world.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include <math.h>

/* An opened engine. */
struct laws {
    const struct engine *engine;
    void *self;
    bool unnamed; /* any-hit answers name no triangle */
};

#define LAWS_T    4.0f /* where rays meet their plate */
#define LAWS_TMAX 8.0f
#define LAWS_ROOM 8 /* of lists */
#define LAWS_GAP  64.0f

/* A ray onto a plate, and what must come of it. */
struct laws_shot {
    struct ray ray;
    struct ray_mode mode;
    uint32_t prim; /* ABI_NO_PRIM: nothing */
    uint32_t tag;
    float u, v;
};

/* Triangle k of the mesh is the half of a square of size 1 at x = 2 k; geometry g has sizes[g] of
 * them and is opaque if g is even. */
static inline void laws_mesh(struct world_mesh *out, const uint32_t *sizes, uint32_t geometries)
{
    static const float corner[3][2] = {{0, 0}, {1, 0}, {0, 1}};
    uint32_t count = 0;
    out->geometry = calloc(geometries, sizeof *out->geometry);
    out->scene = calloc(1, sizeof *out->scene);
    assert_true(out->geometry && out->scene);
    out->geometry_count = geometries;
    for (uint32_t g = 0; g < geometries; g++) {
        out->geometry[g] = (struct geometry){count, sizes[g], g % 2 == 0};
        count += sizes[g];
    }
    assert_int_equal(scene_make(3 * count, count, out->scene), STATUS_OK);
    for (uint32_t i = 0; i < 3 * count; i++) {
        out->scene->index[i] = i;
        out->scene->vertex[3 * i] = corner[i % 3][0] + 2.0f * (float)(i / 3);
        out->scene->vertex[3 * i + 1] = corner[i % 3][1];
        out->scene->vertex[3 * i + 2] = 0;
    }
}

/* Transforms whose numbers, inverses included, are exact: turned, mirrored, scaled, sheared. */
static const float laws_turns[6][3][3] = {
    {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},   {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
    {{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}},  {{0, 0, 2}, {0.5f, 0, 0}, {0, -1, 0}},
    {{1, 1, 0}, {0, 1, 0}, {0, -2, -1}}, {{0.25f, 0, 0}, {0, 0.25f, 0}, {0, 0, 0.25f}},
};

static inline void laws_place(struct instance *instance, uint32_t at)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            instance->m[i][j] = laws_turns[at % 6][i][j];
    instance->m[0][3] = LAWS_GAP * (float)(at % 5);
    instance->m[1][3] = LAWS_GAP * (float)(at / 5);
    instance->m[2][3] = -LAWS_GAP * (float)(at % 3);
    instance->mask = 0xFF;
}

static inline struct world laws_room(uint32_t meshes, uint32_t instances)
{
    struct world world = {.mesh_count = meshes, .instance_count = instances};
    world.mesh = calloc(meshes, sizeof *world.mesh);
    world.instance = calloc(instances, sizeof *world.instance);
    assert_true(world.mesh && world.instance);
    for (uint32_t i = 0; i < instances; i++)
        laws_place(&world.instance[i], i);
    return world;
}

static inline void laws_finish(struct world *world)
{
    struct reason reason = {""};
    if (world_finish(world, &reason))
        fail_msg("%s", reason.text);
}

/* A ray onto the plate at barycentrics u, v, from in front or behind; it is all that the ray meets
 * if the mode admits it. */
static inline struct laws_shot laws_aim(const struct world *world, uint32_t instance, uint32_t prim,
                                        float u, float v, bool front, struct ray_mode mode)
{
    const struct instance *at = &world->instance[instance];
    const float p[3] = {2.0f * (float)prim + u, v, 0};
    const float d[3] = {0, 0, front ? -1.0f : 1.0f};
    struct laws_shot shot = {.ray = {.tmax = LAWS_TMAX}, .mode = mode, .u = u, .v = v};
    for (int k = 0; k < 3; k++) {
        const float *m = at->m[k];
        shot.ray.dir[k] = m[0] * d[0] + m[1] * d[1] + m[2] * d[2];
        shot.ray.org[k] = m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + m[3];
        shot.ray.org[k] -= LAWS_T * shot.ray.dir[k];
    }
    const struct place place = world_place_in(world, instance, prim);
    bool stated = world->mesh[place.mesh].geometry[place.geometry].opaque;
    bool opaque = world_is_opaque(at, stated, mode), seen = world_is_front(at, front ? -1 : 1);
    shot.prim = ABI_NO_PRIM;
    if (world_meets(at, mode) && !world_culls(at, opaque, seen, mode) &&
        (opaque || filter_passes(&world->filter, &place, u, v))) {
        shot.prim = world->first[instance] + prim;
        shot.tag = at->custom | (seen ? ABI_TAG_FRONT : 0);
    }
    return shot;
}

static inline void laws_prepare(const struct laws *laws, const struct world *world,
                                enum query query)
{
    const struct world_job job = {
        .world = world, .box = box_tests[0], .tri = tri_tests[0], .query = query};
    struct reason reason = {""};
    if (laws->engine->worlds->prepare_world(laws->self, &job, &reason))
        fail_msg("%s: %s", laws->engine->name, reason.text);
}

static inline void laws_check(const struct laws *laws, const struct laws_shot *shot, size_t i,
                              enum query query, const struct hit *hit, uint32_t tag)
{
    bool any = query == QUERY_ANY || (query != QUERY_ALL && (shot->mode.flags & ABI_RAY_FIRST));
    if (shot->prim == ABI_NO_PRIM || (laws->unnamed && any)) {
        const uint32_t prim = shot->prim == ABI_NO_PRIM ? ABI_NO_PRIM : 0;
        const struct hit bare = {.prim = prim};
        if (memcmp(hit, &bare, sizeof bare) != 0 || tag != 0)
            fail_msg("%s %s shot %zu, mask %x flags %x: %u at %g, tag %x; not %u, 0",
                     laws->engine->name, query_name(query), i, shot->mode.mask, shot->mode.flags,
                     hit->prim, (double)hit->t, tag, prim);
        return;
    }
    if (hit->prim != shot->prim || tag != shot->tag || !(fabsf(hit->t - LAWS_T) < 1e-4f) ||
        !(fabsf(hit->u - shot->u) < 1e-3f && fabsf(hit->v - shot->v) < 1e-3f))
        fail_msg("%s %s shot %zu, mask %x flags %x: %u at %g, %g %g, tag %x; not %u at 4, %g %g, "
                 "tag %x",
                 laws->engine->name, query_name(query), i, shot->mode.mask, shot->mode.flags,
                 hit->prim, (double)hit->t, (double)hit->u, (double)hit->v, tag, shot->prim,
                 (double)shot->u, (double)shot->v, shot->tag);
}

/* Fires all shots with one query; returns how many must hit. */
static inline size_t laws_fire_query(const struct laws *laws, const struct world *world,
                                     const struct laws_shot *shot, size_t count, enum query query)
{
    const uint32_t room = query == QUERY_ALL ? LAWS_ROOM : 1;
    struct ray *ray = calloc(count, sizeof *ray);
    struct ray_mode *mode = calloc(count, sizeof *mode);
    struct hit *hit = calloc(count * room, sizeof *hit);
    uint32_t *tag = calloc(count * room, sizeof *tag), *found = calloc(count, sizeof *found);
    const struct world_tracer *worlds = laws->engine->worlds;
    struct trace_report report;
    struct reason reason = {""};
    size_t hits = 0;
    assert_true(ray && mode && hit && tag && found);
    for (size_t i = 0; i < count; i++) {
        ray[i] = shot[i].ray;
        mode[i] = shot[i].mode;
    }
    memset(hit, 0x5A, count * room * sizeof *hit);
    memset(tag, 0x5A, count * room * sizeof *tag);
    laws_prepare(laws, world, query);
    enum status status =
        query == QUERY_ALL
            ? worlds->trace_world_all(laws->self, ray, mode, count, room, hit, tag, found, &reason)
            : worlds->trace_world(laws->self, ray, mode, count, hit, tag, &report, &reason);
    if (status)
        fail_msg("%s: %s", laws->engine->name, reason.text);
    for (size_t i = 0; i < count; i++) {
        if (query == QUERY_ALL && found[i] != (shot[i].prim != ABI_NO_PRIM))
            fail_msg("%s shot %zu, mask %x flags %x: %u listed", laws->engine->name, i,
                     shot[i].mode.mask, shot[i].mode.flags, found[i]);
        if (query != QUERY_ALL || found[i])
            laws_check(laws, &shot[i], i, query, &hit[i * room], tag[i * room]);
        hits += shot[i].prim != ABI_NO_PRIM;
    }
    free(ray), free(mode), free(hit), free(tag), free(found);
    return hits;
}

static inline size_t laws_fire(const struct laws *laws, const struct world *world,
                               const struct laws_shot *shot, size_t count)
{
    size_t hits = 0;
    for (int query = QUERY_CLOSEST; query <= QUERY_ALL; query++)
        hits = laws_fire_query(laws, world, shot, count, (enum query)query);
    return hits;
}

/* --- the laws --------------------------------------------------------------------------------- */

#define LAWS_SHOTS 40000

/* Shots at everything. */
struct laws_shots {
    struct laws_shot shot[LAWS_SHOTS];
    size_t count;
};

static inline void laws_add(struct laws_shots *shots, struct laws_shot shot)
{
    assert_true(shots->count < LAWS_SHOTS);
    shots->shot[shots->count++] = shot;
}

/* Two meshes of several geometries, an empty one; instances that are not active between others;
 * small and large custom indices, some of them twice. */
static inline struct world laws_named_world(void)
{
    struct world world = laws_room(3, 23);
    laws_mesh(&world.mesh[0], (const uint32_t[]){3, 0, 2, 4}, 4);
    laws_mesh(&world.mesh[1], (const uint32_t[]){0}, 1);
    laws_mesh(&world.mesh[2], (const uint32_t[]){1, 2}, 2);
    for (uint32_t i = 0; i < 23; i++) {
        world.instance[i].custom = i % 3 == 0 ? ABI_CUSTOM_MOST - i / 6 : i * 0x10001u;
        world.instance[i].mesh = i % 2 ? 0 : 2;
        if (i % 7 == 2)
            world.instance[i].mesh = i == 9 ? 1 : WORLD_NO_MESH;
        world.instance[i].mask = i == 4 ? 0 : 1u << i % 8;
    }
    laws_finish(&world);
    return world;
}

static inline bool laws_is_active(const struct world *world, uint32_t instance)
{
    const struct scene *scene = world_scene(world, instance);
    return scene && scene->tri_count && world->instance[instance].mask;
}

/* Every placed triangle, from both sides, by its own number. */
static inline void laws_of_names(const struct laws *laws)
{
    static struct laws_shots shots;
    struct world world = laws_named_world();
    shots.count = 0;
    for (uint32_t i = 0; i < world.instance_count; i++)
        for (uint32_t k = 0; laws_is_active(&world, i) && k < world_scene(&world, i)->tri_count;
             k++)
            for (int side = 0; side < 2; side++)
                laws_add(&shots, laws_aim(&world, i, k, 0.25f, 0.125f, side, ray_mode_all()));
    assert_true(shots.count > 150);
    assert_int_equal(laws_fire(laws, &world, shots.shot, shots.count), shots.count);
    world_free(&world);
}

/* Each bit of a ray's mask, and pairs of them. */
static inline void laws_of_masks(const struct laws *laws)
{
    static struct laws_shots shots;
    struct world world = laws_named_world();
    shots.count = 0;
    for (uint32_t i = 0; i < world.instance_count; i++)
        for (uint32_t mask = 0; laws_is_active(&world, i) && mask < 256; mask += 1 + mask / 8)
            laws_add(&shots,
                     laws_aim(&world, i, 0, 0.25f, 0.25f, true, (struct ray_mode){mask, 0}));
    size_t hits = laws_fire(laws, &world, shots.shot, shots.count);
    assert_true(hits > shots.count / 8 && hits < shots.count);
    world_free(&world);
}

/* Every flag of geometries, instances and rays, in every combination that there may be. */
static inline void laws_of_flags(const struct laws *laws)
{
    static struct laws_shots shots;
    struct world world = laws_room(1, 12);
    laws_mesh(world.mesh, (const uint32_t[]){1, 1}, 2);
    for (uint32_t i = 0; i < 12; i++)
        world.instance[i].flags = i;
    for (int kind = FILTER_ALL; kind <= FILTER_NONE; kind++) {
        world.filter.kind = (enum filter_kind)kind;
        laws_finish(&world);
        shots.count = 0;
        for (uint32_t flags = 0; flags <= ABI_RAY_FLAGS; flags++) {
            const struct ray_mode mode = {0xFF, flags};
            for (uint32_t n = 0; ray_mode_check(mode, NULL) == STATUS_OK && n < 48; n++)
                laws_add(&shots, laws_aim(&world, n / 4, n % 2, 0.25f, 0.25f, n / 2 % 2, mode));
        }
        size_t hits = laws_fire(laws, &world, shots.shot, shots.count);
        assert_true(hits > shots.count / 8 && hits < shots.count * 3 / 4);
    }
    world_free(&world);
}

/* The filter decides by instance, geometry, triangle and cell, for every query. */
static inline void laws_of_filters(const struct laws *laws)
{
    static struct laws_shots shots;
    struct world world = laws_named_world();
    for (int kind = FILTER_TRIANGLES; kind <= FILTER_CELLS; kind++) {
        world.filter = (struct filter_rule){(enum filter_kind)kind, 77, 100};
        shots.count = 0;
        for (uint32_t i = 0; i < world.instance_count; i++)
            for (uint32_t k = 0; laws_is_active(&world, i) && k < world_scene(&world, i)->tri_count;
                 k++)
                for (uint32_t cell = 0; cell < 16; cell++) {
                    float u = 0.0625f + 0.25f * (float)(cell % 4);
                    float v = 0.0625f + 0.25f * (float)(cell / 4);
                    struct ray_mode mode = {0xFF, k % 2 ? ABI_RAY_NO_OPAQUE : 0};
                    mode.flags |= cell % 3 ? 0 : ABI_RAY_FIRST;
                    if (u + v < 0.9f)
                        laws_add(&shots, laws_aim(&world, i, k, u, v, cell % 2, mode));
                }
        size_t hits = laws_fire(laws, &world, shots.shot, shots.count);
        assert_true(hits > shots.count / 8 && hits < shots.count * 7 / 8);
    }
    world_free(&world);
}

#endif
