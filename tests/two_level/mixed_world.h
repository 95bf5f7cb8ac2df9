/* A world with instances of all kinds, and the check of a packed one. Include after cmocka.h. */
#ifndef MIXED_WORLD_H
#define MIXED_WORLD_H

#include "ref/two_level/world_check.h"
#include "tests/two_level/two_level_fixture.h"

/* Two meshes, one of them in two geometries; instances of all kinds, some not active. */
static inline struct world mixed_world(uint32_t count)
{
    struct world world = fixture_room(3, count);
    fixture_mesh(&world, 0, "soup:n=25,size=0.5", 2);
    fixture_mesh(&world, 1, "soup:n=0", 1);
    fixture_mesh(&world, 2, "sphere:n=2", 1);
    for (uint32_t i = 0; i < count; i++) {
        struct instance *instance = &world.instance[i];
        enum world_kind kind = (enum world_kind)(i % WORLD_FAR);
        fixture_transform(kind, i, instance->m);
        instance->mesh = i % 7 == 3 ? 1 : i % 2 * 2;
        instance->mesh = i % 7 == 5 ? WORLD_NO_MESH : instance->mesh;
        instance->mask = i % 7 == 6 ? 0 : 1 + i % 255;
        instance->flags = i % 12;
    }
    fixture_finish(&world);
    return world;
}

static inline void assert_sound(const struct world *world, const struct packed_world *packed)
{
    struct world_faults faults = {.first = WORLD_STACK, .records = 1};
    const struct world_faults none = {0};
    struct reason reason = {""};
    if (world_pack_check(world, packed, &faults, &reason))
        fail_msg("%s", reason.text);
    assert_memory_equal(&faults, &none, sizeof none);
}

#endif
