/* Worlds whose instances are opened, and boxes of tiles, whose seams lie along axes. Include after
 * cmocka.h. */
#ifndef TWO_LEVEL_BRAID_STAND_H
#define TWO_LEVEL_BRAID_STAND_H

#include "ref/two_level/world_check.h"
#include "tests/two_level/two_level_fixture.h"

#include <string.h>

#include "tests/two_level/world_stand.h"

static inline struct world_trees braid_trees(const struct world *world, const char *builder,
                                             uint32_t leaf, uint32_t braid)
{
    struct world_trees trees;
    struct reason reason = {""};
    struct world_build build = stand_build(builder, leaf);
    build.braid = braid;
    if (world_trees_make(world, &build, &trees, &reason))
        fail_msg("%s", reason.text);
    return trees;
}

static inline struct packed_world braid_world(const struct world *world, const char *builder,
                                              const char *layout, uint32_t braid)
{
    struct world_trees trees = braid_trees(world, builder, 1, braid);
    struct packed_world packed = stand_packed(world, &trees, layout, layout);
    world_trees_free(&trees);
    return packed;
}

static inline uint32_t braid_active(const struct world *world)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < world->instance_count; i++)
        count += world_is_active(world, i);
    return count;
}

/* Entries that the top has. */
static inline uint32_t braid_entries(const struct world_trees *trees)
{
    return trees->top.prim_count;
}

/* --- boxes of tiles --------------------------------------------------------------------------- */

/* Corner `corner` of tile i, j of a face of the box from -1 to 1, of n * n tiles. */
static inline void tile_corner(uint32_t n, uint32_t face, uint32_t i, uint32_t j, uint32_t corner,
                               float out[3])
{
    const uint32_t axis = face / 2, at[] = {i + (corner & 1), j + (corner >> 1)};
    out[axis] = face % 2 ? 1.0f : -1.0f;
    for (uint32_t k = 0; k < 2; k++)
        out[(axis + 1 + k) % 3] = (float)(2 * (int)at[k] - (int)n) / (float)n;
}

/* Makes mesh `at` a closed box of 12 n n triangles, each with vertices of its own. */
static inline void tiled_box(struct world *world, uint32_t at, uint32_t n)
{
    struct world_mesh *mesh = &world->mesh[at];
    mesh->scene = alloc_zeroed(1, sizeof *mesh->scene);
    mesh->geometry = alloc_zeroed(1, sizeof *mesh->geometry);
    if (!mesh->scene || !mesh->geometry || scene_make(36 * n * n, 12 * n * n, mesh->scene))
        fixture_abort("no memory");
    uint32_t vertex = 0;
    for (uint32_t tile = 0; tile < 6 * n * n; tile++) {
        static const uint32_t corner[2][6] = {{0, 2, 3, 0, 3, 1}, {0, 1, 3, 0, 3, 2}};
        const uint32_t face = tile / (n * n), i = tile / n % n, j = tile % n;
        for (uint32_t c = 0; c < 6; c++, vertex++) {
            mesh->scene->index[vertex] = vertex;
            tile_corner(n, face, i, j, corner[face % 2][c], mesh->scene->vertex + 3 * vertex);
        }
    }
    mesh->geometry_count = 1;
    mesh->geometry[0] = (struct geometry){0, mesh->scene->tri_count, true};
}

/* Bars across each other: boxes, 20 times as long as they are wide, that are turned. */
static inline struct world bars_world(uint32_t count, uint32_t n)
{
    struct world world = fixture_room(1, count);
    struct rng rng = rng_make(17, 0);
    tiled_box(&world, 0, n);
    for (uint32_t i = 0; i < world.mesh[0].scene->vertex_count; i++)
        world.mesh[0].scene->vertex[3 * i] *= 20;
    for (uint32_t i = 0; i < count; i++) {
        fixture_turn(&rng, world.instance[i].m);
        for (int r = 0; r < 3; r++)
            world.instance[i].m[r][3] = rng_range(&rng, -8, 8);
    }
    fixture_finish(&world);
    return world;
}

#endif
