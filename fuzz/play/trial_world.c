#include "fuzz/play/trial_world.h"

#include "fuzz/play/trial_weight.h"

#include <stdlib.h>
#include <string.h>

static const struct instance plain_instance = {.m = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
                                               .mask = 0xFF};

enum status trial_world_make(uint32_t triangles, uint32_t geometries, uint32_t instances,
                             uint32_t rays, struct trial_world *out, struct reason *reason)
{
    *out = (struct trial_world){0};
    if (geometries > FUZZ_GEOMETRIES_MOST || instances > FUZZ_INSTANCES_MOST)
        return fail(reason, STATUS_LIMIT, "a trial has at most %u geometries and %u instances",
                    FUZZ_GEOMETRIES_MOST, FUZZ_INSTANCES_MOST);
    *out = (struct trial_world){.is = true,
                                .geometry = alloc_zeroed(geometries, sizeof *out->geometry),
                                .instance = alloc_zeroed(instances, sizeof *out->instance),
                                .mode = alloc_zeroed(rays, sizeof *out->mode),
                                .geometry_count = geometries,
                                .instance_count = instances,
                                .filter = {.kind = FILTER_ALL, .share = 128}};
    if (!out->geometry || !out->instance || !out->mode) {
        trial_world_free(out);
        return fail(reason, STATUS_MEMORY, "no memory for a world of %u instances", instances);
    }
    for (uint32_t i = 0; i < geometries; i++)
        out->geometry[i] = (struct trial_geometry){0, i == 0 ? triangles : 0, true};
    for (uint32_t i = 0; i < instances; i++)
        out->instance[i] = plain_instance;
    for (uint32_t i = 0; i < rays; i++)
        out->mode[i] = ray_mode_all();
    return STATUS_OK;
}

static void copy_array(void *to, const void *from, size_t bytes)
{
    if (bytes > 0)
        memcpy(to, from, bytes);
}

enum status trial_world_copy(const struct trial_world *world, uint32_t rays,
                             struct trial_world *out, struct reason *reason)
{
    *out = (struct trial_world){0};
    if (!world->is)
        return STATUS_OK;
    enum status status =
        trial_world_make(0, world->geometry_count, world->instance_count, rays, out, reason);
    if (status)
        return status;
    copy_array(out->geometry, world->geometry, sizeof *out->geometry * world->geometry_count);
    copy_array(out->instance, world->instance, sizeof *out->instance * world->instance_count);
    copy_array(out->mode, world->mode, sizeof *out->mode * rays);
    out->filter = world->filter;
    return STATUS_OK;
}

void trial_world_free(struct trial_world *world)
{
    free(world->geometry);
    free(world->instance);
    free(world->mode);
    *world = (struct trial_world){0};
}

void trial_world_mesh(const struct trial_world *world, uint32_t mesh, uint32_t *first,
                      uint32_t *count)
{
    *first = *count = 0;
    for (uint32_t i = 0; i < world->geometry_count; i++)
        if (world->geometry[i].mesh < mesh)
            *first += world->geometry[i].count;
        else if (world->geometry[i].mesh == mesh)
            *count += world->geometry[i].count;
}

/* --- hash and size ---------------------------------------------------------------------------- */

uint64_t trial_world_hash(const struct trial_world *world, uint32_t rays, uint64_t hash)
{
    hash = trial_mix_u32(trial_mix_u32(hash, world->geometry_count), world->instance_count);
    for (uint32_t i = 0; i < world->geometry_count; i++) {
        const struct trial_geometry *one = &world->geometry[i];
        hash = trial_mix_u32(trial_mix_u32(hash, one->mesh), one->count);
        hash = trial_mix_u32(hash, one->opaque);
    }
    for (uint32_t i = 0; i < world->instance_count; i++) {
        const struct instance *one = &world->instance[i];
        for (int k = 0; k < 12; k++)
            hash = trial_mix_float(hash, one->m[k / 4][k % 4]);
        hash = trial_mix_u32(trial_mix_u32(hash, one->mesh), one->custom);
        hash = trial_mix_u32(trial_mix_u32(hash, one->mask), one->flags);
    }
    for (uint32_t i = 0; i < rays; i++)
        hash = trial_mix_u32(trial_mix_u32(hash, world->mode[i].mask), world->mode[i].flags);
    hash = trial_mix_u32(hash, (uint32_t)world->filter.kind);
    return trial_mix_u32(trial_mix_u32(hash, world->filter.seed), world->filter.share);
}

static bool is_power_of_two(float x)
{
    uint32_t bits = float_bits(x) & 0x7FFFFFFFu, fraction = bits & 0x7FFFFFu;
    return bits > 0x7FFFFFu ? fraction == 0 : bits && (bits & (bits - 1)) == 0;
}

uint32_t trial_world_place(const struct instance *instance)
{
    bool diagonal = true, powers = true, ones = true;
    if (instance_is_identity(instance))
        return 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++) {
            float x = instance->m[i][j];
            if (j == 3)
                continue;
            if (i == j)
                ones = ones && x == 1, powers = powers && is_power_of_two(x);
            else
                diagonal = diagonal && x == 0;
        }
    return !diagonal ? 4 : ones ? 1 : powers ? 2 : 3;
}

uint32_t trial_world_places(const struct trial_world *world)
{
    uint32_t sum = 0;
    for (uint32_t i = 0; i < world->instance_count; i++)
        sum += trial_world_place(&world->instance[i]);
    return sum;
}

/* Bits that are set, as long as they are needed. */
static uint64_t ones_of(uint32_t bits)
{
    uint64_t count = 0;
    for (; bits; bits &= bits - 1)
        count++;
    return count;
}

/* The length of a whole number in binary. */
static uint64_t length_of(uint32_t x)
{
    uint64_t length = 0;
    for (; x; x >>= 1)
        length++;
    return length;
}

static uint64_t instance_weight(const struct instance *instance)
{
    uint64_t weight = 2 * ones_of(instance->flags) + length_of(instance->custom);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++) {
            float x = instance->m[i][j];
            weight += i == j ? (x == 1 ? 0 : 1 + trial_float_weight(x)) : trial_float_weight(x);
        }
    weight += instance->mesh == WORLD_NO_MESH ? 1 : instance->mesh;
    return weight + (instance->mask == 0xFF ? 0 : 1 + ones_of(instance->mask));
}

uint64_t trial_world_weight(const struct trial_world *world, uint32_t rays)
{
    uint64_t weight = 0;
    if (!world->is)
        return 0;
    for (uint32_t i = 0; i < world->instance_count; i++)
        weight += instance_weight(&world->instance[i]);
    for (uint32_t i = 0; i < world->geometry_count; i++)
        weight += 1 + 2 * (uint64_t)!world->geometry[i].opaque + 2 * world->geometry[i].mesh;
    for (uint32_t i = 0; i < rays; i++) {
        const struct ray_mode *mode = &world->mode[i];
        weight += 2 * ones_of(mode->flags) + (mode->mask == 0xFF ? 0 : 1 + ones_of(mode->mask));
    }
    if (world->filter.kind != FILTER_ALL)
        weight += 2 + (uint64_t)world->filter.kind;
    weight += world->filter.share == 128 ? 0 : 1 + length_of(world->filter.share);
    return weight + length_of(world->filter.seed);
}

const char *trial_filter_name(enum filter_kind kind)
{
    static const char *const name[] = {[FILTER_ALL] = "all",
                                       [FILTER_NONE] = "none",
                                       [FILTER_TRIANGLES] = "triangles",
                                       [FILTER_CELLS] = "cells"};
    return kind < ARRAY_COUNT(name) ? name[kind] : NULL;
}
