/* A world of one placed triangle before the judge. Include after cmocka.h and after the headers of
 * the judge. */
#ifndef TESTS_ONE_PLACED_H
#define TESTS_ONE_PLACED_H

#include "ref/judge/judge_inner.h"

#include <stdlib.h>
#include <string.h>

/* A world of one triangle. */
struct one_placed {
    struct world world;
    struct twin_place place;
    struct judge judge;
};

static inline void place(struct one_placed *out, float v[3][3], float m[3][4])
{
    struct world *world = &out->world;
    *world = (struct world){.mesh_count = 1, .instance_count = 1};
    world->mesh = calloc(1, sizeof *world->mesh);
    world->instance = calloc(1, sizeof *world->instance);
    assert_true(world->mesh && world->instance);
    world->mesh->geometry = calloc(1, sizeof(struct geometry));
    world->mesh->scene = calloc(1, sizeof(struct scene));
    assert_true(world->mesh->geometry && world->mesh->scene);
    assert_int_equal(scene_make(3, 1, world->mesh->scene), STATUS_OK);
    memcpy(world->mesh->scene->vertex, v, 9 * sizeof(float));
    for (uint32_t c = 0; c < 3; c++)
        world->mesh->scene->index[c] = c;
    world->mesh->geometry_count = 1;
    world->mesh->geometry[0] = (struct geometry){0, 1, true};
    world->instance->mask = 0xFF;
    memcpy(world->instance->m, m, sizeof world->instance->m);
    assert_int_equal(world_finish(world, NULL), STATUS_OK);
    assert_int_equal(twin_place_of(world->instance, &out->place, NULL), STATUS_OK);
    out->judge = (struct judge){.world = world, .place = &out->place, .displacement = 32};
}

#endif
