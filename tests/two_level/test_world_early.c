/* Rays that end at their first hit, and what the nearest one saves. */
#include "ref/store.h"
#include "ref/trace/trace_world.h"
#include "ref/two_level/world_check.h"
#include "tests/two_level/two_level_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "tests/two_level/world_stand.h"

/* The first candidate of a ray is passed over, the second ends it. */
static void a_ray_ends_at_the_first_that_counts(void **state)
{
    (void)state;
    struct world world = fixture_room(1, 2);
    fixture_mesh(&world, 0, "sphere:n=4", 1);
    world.mesh->geometry->opaque = false;
    world.instance[1].m[2][3] = -10;
    world.instance[1].flags = ABI_INSTANCE_FORCE_OPAQUE;
    world.filter.kind = FILTER_NONE;
    fixture_finish(&world);
    struct packed_world packed = stand_world(&world, "f32");
    struct world_job job = stand_job(&world, &packed, QUERY_ANY);
    struct ray ray = {.org = {0.1f, 0.2f, 5}, .dir = {0, 0, -1}, .tmax = STAND_TMAX};
    for (int q = 0; q < 2; q++) {
        job.query = q ? QUERY_ANY : QUERY_CLOSEST;
        struct tagged hit = stand_trace(&job, &ray, (struct ray_mode){0xFF, ABI_RAY_FIRST});
        assert_int_equal(world_instance_of(&world, hit.hit.prim), 1);
        hit = stand_trace(&job, &ray, (struct ray_mode){0xFF, ABI_RAY_FIRST | ABI_RAY_NO_OPAQUE});
        assert_int_equal(hit.hit.prim, ABI_NO_PRIM);
        hit = stand_trace(&job, &ray, (struct ray_mode){0xFF, ABI_RAY_OPAQUE});
        assert_int_equal(world_instance_of(&world, hit.hit.prim), 0);
    }
    packed_world_free(&packed);
    world_free(&world);
}

/* It really ends: a ray through a row of instances meets one of them. */
static void first_hits_save_work(void **state)
{
    (void)state;
    struct world world = fixture_world("sphere:n=4", WORLD_SAME, 64, 1);
    for (uint32_t i = 0; i < 64; i++)
        world.instance[i].m[2][3] = -4 * (float)i;
    fixture_finish(&world);
    struct packed_world packed = stand_world(&world, "f32");
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    struct ray ray = {.org = {0.1f, 0.2f, -500}, .dir = {0, 0, 1}, .tmax = STAND_TMAX};
    struct trace_counts one = {0, 0}, every = {0, 0};
    struct tagged hit;
    static struct hit hits[STAND_LIST];
    static uint32_t tags[STAND_LIST];
    uint32_t count;
    assert_int_equal(trace_world_ray(&job, &ray, (struct ray_mode){0xFF, ABI_RAY_FIRST}, &hit.hit,
                                     &hit.tag, &one),
                     STATUS_OK);
    assert_int_equal(trace_world_ray_all(&job, &ray, (struct ray_mode){0xFF, ABI_RAY_FIRST},
                                         STAND_LIST, hits, tags, &count, &every),
                     STATUS_OK);
    assert_int_equal(count, 128);
    assert_true(one.tris * 20 < every.tris && one.boxes * 8 < every.boxes);
    /* The nearest hit ends the range for the instances behind it. */
    struct trace_counts nearest = {0, 0};
    assert_int_equal(trace_world_ray(&job, &ray, ray_mode_all(), &hit.hit, &hit.tag, &nearest),
                     STATUS_OK);
    assert_int_equal(world_instance_of(&world, hit.hit.prim), 63);
    assert_true(nearest.tris * 10 < every.tris);
    /* Where all are at one place the nearest hit takes all of them, the first one. */
    for (uint32_t i = 0; i < 64; i++)
        world.instance[i].m[2][3] = 0;
    packed_world_free(&packed);
    fixture_finish(&world);
    packed = stand_world(&world, "f32");
    one = nearest = (struct trace_counts){0, 0};
    for (uint32_t flags = 0; flags <= ABI_RAY_FIRST; flags += ABI_RAY_FIRST)
        assert_int_equal(trace_world_ray(&job, &ray, (struct ray_mode){0xFF, flags}, &hit.hit,
                                         &hit.tag, flags ? &one : &nearest),
                         STATUS_OK);
    assert_true(one.tris * 30 < nearest.tris);
    packed_world_free(&packed);
    world_free(&world);
}

/* A hit in one instance ends the range in the next one: of a sphere around it nothing is tested. */
static void hits_end_the_range(void **state)
{
    (void)state;
    struct world world = fixture_room(1, 2);
    fixture_mesh(&world, 0, "sphere:n=8", 1);
    world.instance[0].m[2][3] = 3;
    for (int k = 0; k < 3; k++)
        world.instance[1].m[k][k] = 10;
    world.instance[0].mask = 1;
    world.instance[1].mask = 2;
    fixture_finish(&world);
    struct packed_world packed = stand_world(&world, "f32"); /* both in one leaf */
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    struct ray ray = {.org = {0.1f, 0.2f, 5}, .dir = {0, 0, -1}, .tmax = STAND_TMAX};
    struct trace_counts one = {0, 0}, both = {0, 0}, other = {0, 0};
    struct tagged hit;
    assert_int_equal(packed.top.node_count, 1);
    assert_int_equal(packed.top.item[0], 0);
    assert_int_equal(trace_world_ray(&job, &ray, (struct ray_mode){1, 0}, &hit.hit, &hit.tag, &one),
                     STATUS_OK);
    assert_true(hit.hit.t < 1.1f);
    assert_int_equal(trace_world_ray(&job, &ray, ray_mode_all(), &hit.hit, &hit.tag, &both),
                     STATUS_OK);
    assert_true(hit.hit.t < 1.1f);
    assert_int_equal(
        trace_world_ray(&job, &ray, (struct ray_mode){2, 0}, &hit.hit, &hit.tag, &other),
        STATUS_OK);
    assert_true(hit.hit.t > 14);
    assert_true(one.tris > 0 && other.tris > 0);
    assert_int_equal(both.tris, one.tris);
    packed_world_free(&packed);
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ray_ends_at_the_first_that_counts),
        cmocka_unit_test(first_hits_save_work),
        cmocka_unit_test(hits_end_the_range),
    };
    return cmocka_run_group_tests_name("world_early", tests, NULL, NULL);
}
