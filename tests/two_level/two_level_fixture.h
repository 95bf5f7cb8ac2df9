/* Worlds for the tests of two levels. Include after cmocka.h, or without it. */
#ifndef TWO_LEVEL_WORLD_FIXTURE_H
#define TWO_LEVEL_WORLD_FIXTURE_H

#include "ref/base/rng.h"
#include "ref/world/world.h"
#include "scenes/scenes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* How meshes are placed. */
enum world_kind {
    WORLD_SAME,     /* the identity */
    WORLD_MOVED,    /* by whole numbers */
    WORLD_MIRRORED, /* axes exchanged and mirrored, scaled by powers of two, moved */
    WORLD_TURNED,   /* turned, scaled, moved */
    WORLD_SHEARED,  /* any matrix of numbers of one size */
    WORLD_FAR,      /* turned, and a million times their size away */
    WORLD_FLAT,     /* turned, and a million times flatter along one axis than along others */
    WORLD_KINDS
};

static inline void fixture_abort(const char *what)
{
    fprintf(stderr, "%s\n", what);
    abort();
}

static inline void fixture_turn(struct rng *rng, float m[3][4])
{
    float q[4], length = 0;
    for (int i = 0; i < 4; i++) {
        q[i] = rng_range(rng, -1, 1);
        length += q[i] * q[i];
    }
    length = sqrtf(length);
    for (int i = 0; i < 4; i++)
        q[i] /= length;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        m[i][i] = 1 - 2 * (q[j] * q[j] + q[k] * q[k]);
        m[i][j] = 2 * (q[i] * q[j] - q[3] * q[k]);
        m[i][k] = 2 * (q[i] * q[k] + q[3] * q[j]);
    }
}

static inline void fixture_exchange(struct rng *rng, float m[3][4])
{
    int first = (int)rng_below(rng, 3), turn = 1 + (int)rng_below(rng, 2);
    for (int k = 0; k < 3; k++) {
        float size = ldexpf(1, (int)rng_below(rng, 5) - 2);
        m[k][(first + turn * k) % 3] = rng_below(rng, 2) ? size : -size;
    }
}

/* A transform of some kind, drawn from the seed; scenes are a few units large. */
static inline void fixture_transform(enum world_kind kind, uint64_t seed, float m[3][4])
{
    struct rng rng = rng_make(71, seed * 8 + kind);
    float scale = kind == WORLD_TURNED ? ldexpf(rng_range(&rng, 1, 2), (int)(seed % 3) - 1) : 1;
    for (int i = 0; i < 12; i++)
        m[i / 4][i % 4] = i % 5 == 0 ? 1.0f : 0.0f;
    if (kind == WORLD_MIRRORED) {
        for (int i = 0; i < 3; i++)
            m[i][i] = 0;
        fixture_exchange(&rng, m);
    } else if (kind == WORLD_SHEARED) {
        for (int i = 0; i < 9; i++)
            m[i / 3][i % 3] = rng_range(&rng, -1, 1);
    } else if (kind >= WORLD_TURNED) {
        fixture_turn(&rng, m);
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            m[i][j] *= kind == WORLD_FLAT && j == 1 ? 1e-6f : scale;
    for (int i = 0; i < 3 && kind != WORLD_SAME; i++) {
        float by = kind == WORLD_FAR ? rng_range(&rng, -1e6f, 1e6f) : rng_range(&rng, -6, 6);
        m[i][3] = kind < WORLD_TURNED ? rintf(by) : by;
    }
}

/* Makes room for a world of so many meshes and instances; the instances are of mesh 0, at the
 * identity, and rays meet them. */
static inline struct world fixture_room(uint32_t meshes, uint32_t instances)
{
    struct world world = {.mesh_count = meshes, .instance_count = instances};
    world.mesh = alloc_zeroed(meshes, sizeof *world.mesh);
    world.instance = alloc_zeroed(instances, sizeof *world.instance);
    if (!world.mesh || !world.instance)
        fixture_abort("no memory");
    for (uint32_t i = 0; i < instances; i++) {
        fixture_transform(WORLD_SAME, 0, world.instance[i].m);
        world.instance[i].mask = 0xFF;
        world.instance[i].custom = (i * 2654435761u) & ABI_CUSTOM_MOST;
    }
    return world;
}

/* Opens a scene as mesh `at`, with `geometries` geometries of about the same size, opaque and not
 * in turn, the first opaque. */
static inline void fixture_mesh(struct world *world, uint32_t at, const char *spec,
                                uint32_t geometries)
{
    struct reason reason = {""};
    struct world_mesh *mesh = &world->mesh[at];
    mesh->scene = alloc_zeroed(1, sizeof *mesh->scene);
    mesh->geometry = alloc_zeroed(geometries, sizeof *mesh->geometry);
    mesh->geometry_count = geometries;
    if (!mesh->scene || !mesh->geometry)
        fixture_abort("no memory");
    if (scene_open(spec, 1, mesh->scene, &reason))
        fixture_abort(reason.text);
    uint32_t next = 0, count = mesh->scene->tri_count;
    for (uint32_t g = 0; g < geometries; g++) {
        uint32_t end = (uint32_t)((uint64_t)count * (g + 1) / geometries);
        mesh->geometry[g] = (struct geometry){next, end - next, g % 2 == 0};
        next = end;
    }
}

static inline void fixture_finish(struct world *world)
{
    struct reason reason = {""};
    if (world_finish(world, &reason))
        fixture_abort(reason.text);
}

/* A world of one opaque mesh and `count` instances. */
static inline struct world fixture_world(const char *spec, enum world_kind kind, uint32_t count,
                                         uint64_t seed)
{
    struct world world = fixture_room(1, count);
    fixture_mesh(&world, 0, spec, 1);
    for (uint32_t i = 0; i < count; i++)
        fixture_transform(kind, seed * 1000 + i, world.instance[i].m);
    fixture_finish(&world);
    return world;
}

/* Instances of everything that the rules know, over one another: turned, mirrored and sheared, of
 * two meshes with geometries that are opaque and not, every legal set of flags, masks of one bit
 * and of all, custom indices of 24 bits. */
static inline struct world fixture_everything(void)
{
    struct world world = fixture_room(2, 24);
    fixture_mesh(&world, 0, "soup:n=60,size=0.6", 3);
    fixture_mesh(&world, 1, "sphere:n=3", 2);
    for (uint32_t i = 0; i < world.instance_count; i++) {
        struct instance *in = &world.instance[i];
        static const enum world_kind kinds[] = {WORLD_TURNED, WORLD_MIRRORED, WORLD_SHEARED};
        fixture_transform(kinds[i % 3], 40 + i, in->m);
        for (int k = 0; k < 3; k++)
            in->m[k][3] *= 0.4f;
        in->mesh = i % 4 == 3;
        in->flags = i % 12;
        in->mask = i % 5 < 3 ? 0xFF : 1u << i % 8;
        in->custom |= 0x10000;
    }
    world.filter = (struct filter_rule){FILTER_TRIANGLES, 5, 128};
    fixture_finish(&world);
    return world;
}

#endif
