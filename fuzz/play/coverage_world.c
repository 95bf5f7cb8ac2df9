/* The states of a trial's world. */
#include "fuzz/play/coverage_bits.h"

#define WORLD(n) coverage_set(map, COVERAGE_WORLD, (uint32_t)(n))

static void add_instance(uint64_t map[COVERAGE_WORDS], const struct trial_world *world,
                         const struct instance *instance)
{
    uint32_t first = 0, count = 0;
    WORLD(COVERAGE_WORLD_PLACE + trial_world_place(instance));
    if (instance_det_sign(instance->m) < 0)
        WORLD(COVERAGE_WORLD_MIRRORED);
    if (instance->mesh == WORLD_NO_MESH)
        WORLD(COVERAGE_WORLD_NO_MESH);
    else if (trial_world_mesh(world, instance->mesh, &first, &count), count == 0)
        WORLD(COVERAGE_WORLD_EMPTY);
    if (instance->mask != 0xFF)
        WORLD(instance->mask ? COVERAGE_WORLD_MASKED : COVERAGE_WORLD_MASK_0);
    if (instance->custom > 0xFFFF)
        WORLD(COVERAGE_WORLD_CUSTOM);
    for (uint32_t bit = 0; bit < 4; bit++)
        if (instance->flags >> bit & 1)
            WORLD(COVERAGE_WORLD_FLAGS + bit);
}

void coverage_add_world(uint64_t map[COVERAGE_WORDS], const struct trial_world *world,
                        uint32_t rays)
{
    uint32_t n = world->instance_count;
    for (uint32_t i = 0; i < n; i++)
        add_instance(map, world, &world->instance[i]);
    for (uint32_t i = 0; i < world->geometry_count; i++)
        if (!world->geometry[i].opaque)
            WORLD(COVERAGE_WORLD_FILTERED);
    if (world->filter.kind != FILTER_ALL)
        WORLD(COVERAGE_WORLD_FILTER + (uint32_t)world->filter.kind - 1);
    if (n > 0)
        WORLD(COVERAGE_WORLD_COUNT + (n == 1 ? 0u : n == 2 ? 1u : n <= 8 ? 2u : 3u));
    for (uint32_t i = 0; i < rays; i++) {
        for (uint32_t bit = 0; bit < 9; bit++)
            if (world->mode[i].flags >> bit & 1)
                coverage_set(map, COVERAGE_MODE, bit);
        if (world->mode[i].mask != 0xFF)
            coverage_set(map, COVERAGE_MODE, 9);
    }
}
