/* Small worlds for tests: meshes of so many triangles, placed where a test puts them. */
#ifndef WORLD_FIXTURE_H
#define WORLD_FIXTURE_H

#include "ref/world/world.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

/* A mesh of `count` triangles beside each other, in one opaque geometry. */
static inline struct world_mesh fixture_mesh(uint32_t count)
{
    struct world_mesh mesh = {.geometry_count = 1};
    mesh.scene = calloc(1, sizeof *mesh.scene);
    mesh.geometry = calloc(1, sizeof *mesh.geometry);
    assert_non_null(mesh.scene);
    assert_non_null(mesh.geometry);
    assert_int_equal(scene_make(3 * count, count, mesh.scene), STATUS_OK);
    for (uint32_t i = 0; i < 3 * count; i++) {
        mesh.scene->index[i] = i;
        mesh.scene->vertex[3 * i] = (float)(i / 3) + (i % 3 == 1 ? 1.0f : 0.0f);
        mesh.scene->vertex[3 * i + 1] = i % 3 == 2 ? 1.0f : 0.0f;
    }
    mesh.geometry[0] = (struct geometry){.count = count, .opaque = true};
    return mesh;
}

/* A world with a mesh of each of these numbers of triangles, and `instances` at the identity that
 * take the meshes in turn. It has not passed world_finish. */
static inline struct world fixture_world(const uint32_t *tris, uint32_t meshes, uint32_t instances)
{
    struct world world = {.mesh_count = meshes, .instance_count = instances};
    world.mesh = calloc(meshes + 1, sizeof *world.mesh);
    world.instance = calloc(instances + 1, sizeof *world.instance);
    assert_non_null(world.mesh);
    assert_non_null(world.instance);
    for (uint32_t i = 0; i < meshes; i++)
        world.mesh[i] = fixture_mesh(tris[i]);
    for (uint32_t i = 0; i < instances; i++)
        world.instance[i] = (struct instance){
            .m = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}, .mesh = i % meshes, .mask = 0xFF};
    return world;
}

static inline void fixture_finish(struct world *world)
{
    struct reason reason = {""};
    if (world_finish(world, &reason))
        fail_msg("%s", reason.text);
}

#endif
