/* Rays from inside the instances of a world: every one truly hits its own instance, however it is
 * placed. */
#include "ref/oracle/oracle_world.h"
#include "scenes/rays/rays_inside_world.h"
#include "scenes/worlds.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define RAYS 400

static struct ray ray[RAYS], again[RAYS];
static struct ray_mode mode[RAYS];
static uint8_t aim[RAYS];

static struct world open_world(const char *spec)
{
    struct world world;
    struct reason reason = {""};
    if (world_open(spec, 1, &world, &reason))
        fail_msg("%s", reason.text);
    return world;
}

static struct world_inside make(const struct world *world, const char *spec)
{
    struct world_inside inside;
    struct reason reason = {""};
    if (world_rays_inside_make(world, 1, RAYS, ray, mode, aim, &inside, &reason))
        fail_msg("%s: %s", spec, reason.text);
    return inside;
}

/* All rays truly hit; returns how many of them the instance that they start in. */
static size_t assert_all_hit(const struct world *world, const struct world_inside *inside,
                             const char *spec)
{
    static struct oracle_answer truth[RAYS];
    struct oracle *oracle;
    struct reason reason = {""};
    size_t own = 0;
    if (oracle_make_world(world, &oracle, &reason) ||
        oracle_closest_world(oracle, ORACLE_TREE, ORACLE_CLOSED, ray, mode, RAYS, 1, truth, NULL,
                             &reason))
        fail_msg("%s: %s", spec, reason.text);
    for (size_t i = 0; i < RAYS; i++) {
        if (truth[i].prim == ABI_NO_PRIM)
            fail_msg("%s: ray %zu truly misses", spec, i);
        assert_int_equal(aim[i] < LEAK_AIMS, 1);
        own += mode[i].mask & world->instance[world_instance_of(world, truth[i].prim)].mask &&
               inside->instances > 0;
    }
    oracle_free(oracle);
    return own;
}

static void rays_start_inside_instances(void **state)
{
    (void)state;
    static const char *const specs[] = {"placed-identity",
                                        "placed-turned",
                                        "placed-stretched",
                                        "placed-mirrored",
                                        "placed-far",
                                        "placed-thin",
                                        "placed-sheared",
                                        "placed-tiny",
                                        "nest",
                                        "wall",
                                        "crowd:n=200"};
    for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
        struct world world = open_world(specs[s]);
        const struct world_inside inside = make(&world, specs[s]);
        const uint32_t count = world.instance_count;
        uint32_t masks = 0;
        assert_false(inside.seams);
        assert_int_equal(inside.instances, count < INSIDE_INSTANCES ? count : INSIDE_INSTANCES);
        assert_true(inside.origins >= inside.instances);
        memcpy(again, ray, sizeof ray);
        make(&world, specs[s]);
        assert_memory_equal(again, ray, sizeof ray);
        world_inside_masks(&world);
        for (uint32_t i = 0; i < count; i++)
            assert_int_equal(world.instance[i].mask, 1u << i % 8);
        for (size_t i = 0; i < RAYS; i++) {
            assert_int_equal(mode[i].flags, ABI_RAY_OPAQUE);
            masks |= mode[i].mask;
        }
        assert_int_equal(__builtin_popcount(masks), count < 8 ? count : 8);
        assert_int_equal(assert_all_hit(&world, &inside, specs[s]), RAYS);
        world_free(&world);
    }
}

/* Six open walls are closed together: rays meet all of them. */
static void rays_cross_seams(void **state)
{
    (void)state;
    struct world world = open_world("room:n=2,offset=64");
    const struct world_inside inside = make(&world, "room");
    assert_true(inside.seams);
    assert_int_equal(inside.instances, 6);
    for (size_t i = 0; i < RAYS; i++)
        assert_int_equal(mode[i].mask, 0xFF);
    assert_all_hit(&world, &inside, "room");
    world_free(&world);
}

static void assert_refused(struct world *world, enum status wanted, const char *what)
{
    struct world_inside inside;
    struct reason reason = {""};
    assert_int_equal(world_rays_inside_make(world, 1, RAYS, ray, mode, aim, &inside, &reason),
                     wanted);
    if (!strstr(reason.text, what))
        fail_msg("'%s' has no '%s'", reason.text, what);
    world_free(world);
}

static void what_has_no_inside_is_refused(void **state)
{
    (void)state;
    struct world world = open_world("room");
    world.instance[3].mask = 0; /* a wall is left out */
    assert_refused(&world, STATUS_INPUT, "all instances together: no closed mesh");
    world = open_world("wall:n=2");
    for (uint32_t i = 0; i < world.instance_count; i++)
        world.instance[i].mask = 0;
    assert_refused(&world, STATUS_INPUT, "no instance is active");
    world = open_world("wall:n=2");
    for (uint32_t i = 0; i < world.instance_count; i++)
        world.instance[i].m[0][3] = 0x1p25f; /* float32 has steps of 4, the box a side of 1 */
    assert_refused(&world, STATUS_INPUT, "no point inside is so far");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_start_inside_instances),
        cmocka_unit_test(rays_cross_seams),
        cmocka_unit_test(what_has_no_inside_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
