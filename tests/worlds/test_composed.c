/* Worlds composed of one member of each axis: each member is what its name says. */
#include "scenes/worlds/composed.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define RAYS 400

static uint32_t find(enum composed_axis axis, const char *name)
{
    struct reason reason = {""};
    uint32_t member;
    if (composed_find(axis, name, &member, &reason))
        fail_msg("%s", reason.text);
    return member;
}

/* The composition of plain members in 40 instances, but for one axis. */
static struct composition with(enum composed_axis axis, const char *name)
{
    struct composition of = {{0}};
    of.member[COMPOSED_COUNT] = find(COMPOSED_COUNT, "40");
    of.member[axis] = find(axis, name);
    return of;
}

static struct world make(enum composed_axis axis, const char *name)
{
    const struct composition of = with(axis, name);
    struct world world;
    struct reason reason = {""};
    if (composed_make(&of, 1, &world, &reason))
        fail_msg("%s", reason.text);
    return world;
}

static void axes_have_names(void **state)
{
    (void)state;
    static const uint32_t members[COMPOSED_AXES] = {9, 4, 6, 3, 4, 11, 4};
    for (int a = 0; a < COMPOSED_AXES; a++) {
        const enum composed_axis axis = (enum composed_axis)a;
        struct reason reason = {""};
        uint32_t member;
        assert_int_equal(composed_members(axis), members[a]);
        assert_null(composed_name(axis, members[a]));
        for (uint32_t i = 0; i < members[a]; i++) {
            assert_int_equal(find(axis, composed_name(axis, i)), i);
            assert_null(strpbrk(composed_name(axis, i), "./*?[ "));
        }
        assert_int_equal(composed_find(axis, "other", &member, &reason), STATUS_INPUT);
        assert_non_null(strstr(reason.text, "unknown "));
        assert_non_null(strstr(reason.text, composed_name(axis, members[a] - 1)));
    }
}

/* Every member makes a world, twice the same, whose first instance is active. */
static void every_member_makes_a_world(void **state)
{
    (void)state;
    for (int a = 0; a < COMPOSED_AXES; a++)
        for (uint32_t i = 0; i < composed_members((enum composed_axis)a); i++) {
            struct world one = make((enum composed_axis)a, composed_name((enum composed_axis)a, i));
            struct world two = make((enum composed_axis)a, composed_name((enum composed_axis)a, i));
            assert_int_equal(one.instance_count, two.instance_count);
            assert_memory_equal(one.instance, two.instance,
                                one.instance_count * sizeof *one.instance);
            assert_true(one.instance[0].mesh != WORLD_NO_MESH && one.instance[0].mask);
            world_free(&one);
            world_free(&two);
        }
}

static void counts_are_numbers_of_instances(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < composed_members(COMPOSED_COUNT); i++) {
        struct world world = make(COMPOSED_COUNT, composed_name(COMPOSED_COUNT, i));
        assert_int_equal(world.instance_count, atoi(composed_name(COMPOSED_COUNT, i)));
        world_free(&world);
    }
}

static void transforms_are_of_their_kind(void **state)
{
    (void)state;
    struct world world = make(COMPOSED_TRANSFORM, "identity");
    for (uint32_t i = 0; i < world.instance_count; i++)
        assert_true(instance_is_identity(&world.instance[i]));
    world_free(&world);
    world = make(COMPOSED_TRANSFORM, "mirrored");
    for (uint32_t i = 0; i < world.instance_count; i++)
        assert_int_equal(instance_det_sign(world.instance[i].m), -1);
    world_free(&world);
    world = make(COMPOSED_TRANSFORM, "far");
    for (uint32_t i = 0; i < world.instance_count; i++)
        assert_true(world.instance[i].m[0][3] > 1e6f || world.instance[i].m[0][3] < -1e6f);
    world_free(&world);
}

static void masks_are_of_their_kind(void **state)
{
    (void)state;
    for (uint32_t kind = 0; kind < composed_members(COMPOSED_MASKS); kind++) {
        const char *name = composed_name(COMPOSED_MASKS, kind);
        struct world world = make(COMPOSED_MASKS, name);
        uint32_t idle = 0, none = 0, single = 0, full = 0;
        for (uint32_t i = 0; i < world.instance_count; i++) {
            const uint32_t mask = world.instance[i].mask;
            idle += mask == 0;
            none += world.instance[i].mesh == WORLD_NO_MESH;
            single += mask && !(mask & (mask - 1));
            full += mask == 0xFF;
        }
        assert_int_equal(idle > 0 && none > 0, strcmp(name, "idle") == 0);
        assert_int_equal(single == world.instance_count, strcmp(name, "bits") == 0);
        assert_int_equal(full == world.instance_count, strcmp(name, "all") == 0);
        world_free(&world);
    }
}

static void flags_are_those_of_every_instance(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        uint32_t flags;
    } of[] = {{"none", 0},
              {"cull-disable", ABI_INSTANCE_CULL_DISABLE},
              {"flip", ABI_INSTANCE_FLIP_FACING},
              {"force-opaque", ABI_INSTANCE_FORCE_OPAQUE},
              {"force-no-opaque", ABI_INSTANCE_FORCE_NO_OPAQUE}};
    for (size_t k = 0; k < ARRAY_COUNT(of); k++) {
        struct world world = make(COMPOSED_FLAGS, of[k].name);
        for (uint32_t i = 0; i < world.instance_count; i++)
            assert_int_equal(world.instance[i].flags, of[k].flags);
        world_free(&world);
    }
    struct world world = make(COMPOSED_FLAGS, "drawn");
    uint32_t seen = 0;
    for (uint32_t i = 0; i < world.instance_count; i++)
        seen |= 1u << world.instance[i].flags;
    assert_true(__builtin_popcount(seen) >= 8);
    world_free(&world);
}

static void geometries_are_opaque_as_named(void **state)
{
    (void)state;
    static const char *const names[] = {"opaque", "not-opaque", "mixed"};
    for (size_t k = 0; k < ARRAY_COUNT(names); k++) {
        struct world world = make(COMPOSED_GEOMETRY, names[k]);
        for (uint32_t m = 0; m < world.mesh_count; m++) {
            uint32_t opaque = 0, empty = 0;
            const struct world_mesh *mesh = &world.mesh[m];
            for (uint32_t g = 0; g < mesh->geometry_count; g++) {
                opaque += mesh->geometry[g].opaque;
                empty += mesh->geometry[g].count == 0;
            }
            assert_int_equal(empty, 1);
            assert_int_equal(opaque, k == 0 ? 4 : k == 1 ? 0 : 2);
        }
        world_free(&world);
    }
    struct world world = make(COMPOSED_FILTER, "cells");
    assert_int_equal(world.filter.kind, FILTER_CELLS);
    world_free(&world);
}

/* Even rays meet all; odd ones have the flags, and of masks that are not `all` others than 0xFF. */
static void modes_are_those_of_every_second_ray(void **state)
{
    (void)state;
    static struct ray_mode mode[RAYS], same[RAYS];
    for (uint32_t k = 0; k < composed_members(COMPOSED_RAYS); k++)
        for (uint32_t masks = 0; masks < composed_members(COMPOSED_MASKS); masks++) {
            struct composition of = with(COMPOSED_RAYS, composed_name(COMPOSED_RAYS, k));
            uint32_t others = 0, flags = 0;
            struct reason reason;
            of.member[COMPOSED_MASKS] = masks;
            composed_modes(&of, 7, RAYS, mode);
            composed_modes(&of, 7, RAYS / 2, same);
            assert_memory_equal(mode, same, RAYS / 2 * sizeof *mode);
            for (size_t i = 0; i < RAYS; i++) {
                assert_int_equal(ray_mode_check(mode[i], &reason), STATUS_OK);
                if (i % 2 == 0)
                    assert_true(mode[i].mask == 0xFF && mode[i].flags == ABI_RAY_OPAQUE);
                else
                    flags |= mode[i].flags;
                others += mode[i].mask != 0xFF;
            }
            assert_int_equal(others > 0, masks != 0);
            if (k == find(COMPOSED_RAYS, "cull-back"))
                assert_int_equal(flags, ABI_RAY_CULL_BACK);
            if (k == find(COMPOSED_RAYS, "drawn"))
                assert_int_equal(flags, ABI_RAY_OPAQUE | ABI_RAY_NO_OPAQUE | ABI_RAY_FIRST |
                                            ABI_RAY_CULL_BACK | ABI_RAY_CULL_FRONT |
                                            ABI_RAY_CULL_OPAQUE | ABI_RAY_CULL_NO_OPAQUE);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(axes_have_names),
        cmocka_unit_test(every_member_makes_a_world),
        cmocka_unit_test(counts_are_numbers_of_instances),
        cmocka_unit_test(transforms_are_of_their_kind),
        cmocka_unit_test(masks_are_of_their_kind),
        cmocka_unit_test(flags_are_those_of_every_instance),
        cmocka_unit_test(geometries_are_opaque_as_named),
        cmocka_unit_test(modes_are_those_of_every_second_ray),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
