/* Worlds at their ends: nothing in them, instances that no ray meets, very many, equally near ones,
 * ranges, stacks that are too short. */
#include "ref/store.h"
#include "ref/trace/trace_world.h"
#include "ref/two_level/world_check.h"
#include "ref/world/placed.h"
#include "ref/world/object_ray.h"
#include "tests/two_level/two_level_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "tests/two_level/world_stand.h"
#include "tests/two_level/world_against_brute.h"

static void assert_misses(const struct world *world)
{
    struct packed_world packed = stand_world(world, "f32");
    struct world_job job = stand_job(world, &packed, QUERY_CLOSEST);
    struct instance_record *record = records(world);
    struct ray ray = {.org = {0.1f, 0.2f, 5}, .dir = {0, 0, -1}, .tmax = STAND_TMAX};
    struct tagged hit = stand_trace(&job, &ray, ray_mode_all());
    static struct tagged_list all;
    assert_int_equal(hit.hit.prim, ABI_NO_PRIM);
    assert_int_equal(hit.tag, 0);
    stand_all(&job, &ray, ray_mode_all(), &all);
    assert_int_equal(all.count, 0);
    trace_world_brute(world, record, job.tri, QUERY_ANY, &ray, ray_mode_all(), &hit.hit, &hit.tag);
    assert_int_equal(hit.hit.prim, ABI_NO_PRIM);
    assert_int_equal(packed.top.node_count, 0);
    free(record);
    packed_world_free(&packed);
}

static void nothing_is_met_where_nothing_is(void **state)
{
    (void)state;
    struct world world = {0};
    fixture_finish(&world);
    assert_misses(&world);
    world_free(&world);
    world = fixture_room(0, 3);
    for (uint32_t i = 0; i < 3; i++)
        world.instance[i].mesh = WORLD_NO_MESH;
    fixture_finish(&world);
    assert_misses(&world);
    world_free(&world);
    world = fixture_world("soup:n=0", WORLD_TURNED, 3, 1);
    assert_misses(&world);
    world_free(&world);
    world = fixture_world("sphere:n=2", WORLD_SAME, 3, 1);
    for (uint32_t i = 0; i < 3; i++)
        world.instance[i].mask = 0;
    assert_misses(&world);
    world_free(&world);
}

/* Every third instance has a mask of 0, none, or an empty mesh: the others keep their numbers. */
static void inactive_instances_keep_their_numbers(void **state)
{
    (void)state;
    struct world world = fixture_room(3, 40);
    fixture_mesh(&world, 0, "soup:n=20,size=0.5", 1);
    fixture_mesh(&world, 1, "soup:n=0", 1);
    fixture_mesh(&world, 2, "platonic:which=1", 2);
    for (uint32_t i = 0; i < 40; i++) {
        struct instance *instance = &world.instance[i];
        fixture_transform(WORLD_TURNED, 900 + i, instance->m);
        instance->mesh = i % 2 ? 2 : 0;
        if (i % 9 == 0)
            instance->mask = 0;
        else if (i % 9 == 3)
            instance->mesh = WORLD_NO_MESH;
        else if (i % 9 == 6)
            instance->mesh = 1;
    }
    fixture_finish(&world);
    assert_trees(&world, "median", "f32", "f32", 5, 200);
    assert_trees(&world, "sah_binned", "rf16", "cwbvh80", 6, 200);
    /* The hit lies in an instance that has its custom index. */
    struct packed_world packed = stand_world(&world, "f32");
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    uint32_t seen = 0;
    for (uint64_t i = 0; i < 200; i++) {
        struct ray ray = stand_aim(&packed, 7, i);
        struct tagged hit = stand_trace(&job, &ray, ray_mode_all());
        if (hit.hit.prim == ABI_NO_PRIM)
            continue;
        uint32_t instance = world_instance_of(&world, hit.hit.prim);
        assert_int_equal(hit.tag & ABI_TAG_CUSTOM, world.instance[instance].custom);
        assert_true(instance % 3 != 0);
        seen++;
    }
    assert_true(seen > 50);
    packed_world_free(&packed);
    world_free(&world);
}

static void many_small_instances(void **state)
{
    (void)state;
    struct world world = fixture_room(1, 100000);
    fixture_mesh(&world, 0, "platonic:which=1,radius=0.3", 1);
    for (uint32_t i = 0; i < 100000; i++) {
        fixture_transform(i % 2 ? WORLD_TURNED : WORLD_MIRRORED, i, world.instance[i].m);
        for (uint32_t k = 0; k < 3; k++) /* spread over a cube */
            world.instance[i].m[k][3] += 10 * (float)(i /
                                                      (k == 0   ? 1u
                                                       : k == 1 ? 46u
                                                                : 2116u) %
                                                      46);
    }
    fixture_finish(&world);
    assert_true(world_tri_count(&world) == 1200000);
    assert_trees(&world, "sah_binned", "cwbvh80", "f32", 8, 16);
    world_free(&world);
}

/* Two instances at one place tie exactly: the first found stays, and any-hit takes either. */
static void ties_of_instances(void **state)
{
    (void)state;
    struct world world = fixture_world("sphere:n=3", WORLD_SAME, 6, 1);
    assert_trees(&world, "median", "f32", "f32", 9, 64);
    struct packed_world packed = stand_world(&world, "f32");
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    struct ray ray = {.org = {0.1f, 0.2f, 5}, .dir = {0, 0, -1}, .tmax = STAND_TMAX};
    static struct tagged_list all;
    stand_all(&job, &ray, ray_mode_all(), &all);
    assert_int_equal(all.count, 12);
    for (uint32_t i = 1; i < 6; i++)
        assert_int_equal(all.entry[i].hit.prim - all.entry[i - 1].hit.prim, 72);
    packed_world_free(&packed);
    world_free(&world);
}

/* The range holds in the world and in every instance: t is that of the world's direction. */
static void ranges_are_those_of_the_world(void **state)
{
    (void)state;
    struct world world = fixture_room(1, 3);
    fixture_mesh(&world, 0, "sphere:n=4", 1);
    for (uint32_t i = 0; i < 3; i++) { /* at z = 0, 4, 8, of radius 1/4, 1, 2 */
        for (int k = 0; k < 3; k++)
            world.instance[i].m[k][k] = i == 0 ? 0.25f : (float)i;
        world.instance[i].m[2][3] = 4 * (float)i;
    }
    fixture_finish(&world);
    struct packed_world packed = stand_world(&world, "f32");
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    static const struct {
        float tmin, tmax, least, most;
        uint32_t instance;
    } expected[] = {
        {0, 100, 9.8f, 10.2f, 2},
        {10.5f, 100, 13.8f, 14.2f, 2},
        {14.5f, 100, 14.9f, 15.2f, 1},
        {15.5f, 100, 16.8f, 17.1f, 1},
        {17.2f, 100, 19.7f, 19.8f, 0},
        {19.9f, 100, 20.2f, 20.3f, 0},
        {0, 9.5f, 0, 0, 3},
        {20.6f, 100, 0, 0, 3},
        {14.3f, 14.8f, 0, 0, 3},
    };
    for (size_t i = 0; i < ARRAY_COUNT(expected); i++) {
        struct ray ray = {.org = {0.01f, 0.02f, 20},
                          .dir = {0, 0, -0.75f},
                          .tmin = expected[i].tmin / 0.75f,
                          .tmax = expected[i].tmax / 0.75f};
        struct tagged hit = stand_trace(&job, &ray, ray_mode_all());
        if (expected[i].instance == 3) {
            assert_int_equal(hit.hit.prim, ABI_NO_PRIM);
            continue;
        }
        float distance = hit.hit.t * 0.75f;
        assert_int_equal(world_instance_of(&world, hit.hit.prim), expected[i].instance);
        assert_true(distance >= expected[i].least && distance <= expected[i].most);
    }
    packed_world_free(&packed);
    world_free(&world);
}

/* What the trees claim is too little: the ray is given up, nothing is overwritten. */
static void short_stacks_are_noticed(void **state)
{
    (void)state;
    static const char *const layouts_of[] = {"f32", "cwbvh80"};
    for (size_t l = 0; l < 2; l++) {
        struct world world = fixture_world("soup:n=200,size=0.9", WORLD_TURNED, 60, 3);
        struct world_trees trees = stand_trees(&world, "median", 1);
        struct packed_world packed = stand_packed(&world, &trees, layouts_of[l], layouts_of[l]);
        struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
        uint32_t top = packed.top.stack_need, bottom = packed.bottom->stack_need, given_up[2] = {0};
        for (int which = 0; which < 2; which++) {
            packed.top.stack_need = which ? top : 1;
            packed.bottom->stack_need = which ? 1 : bottom;
            for (uint64_t i = 0; i < 64; i++) {
                struct ray ray = stand_aim(&packed, 3, i);
                struct tagged hit;
                static struct hit list[STAND_LIST];
                static uint32_t tag[STAND_LIST];
                uint32_t count = 7;
                enum status status =
                    trace_world_ray(&job, &ray, ray_mode_all(), &hit.hit, &hit.tag, NULL);
                assert_true(status == STATUS_OK || status == STATUS_LIMIT);
                if (status) {
                    given_up[which]++;
                    assert_int_equal(hit.hit.prim, ABI_NO_PRIM);
                    assert_int_equal(hit.tag, 0);
                }
                if (trace_world_ray_all(&job, &ray, ray_mode_all(), STAND_LIST, list, tag, &count,
                                        NULL))
                    assert_int_equal(count, 0);
            }
        }
        assert_true(given_up[0] > 0 && given_up[1] > 0);
        packed_world_free(&packed);
        world_trees_free(&trees);
        world_free(&world);
    }
}

/* Not a bit of a ray changes at the identity: neither the sign of a zero nor what a product with
 * infinity would spoil. */
static void the_identity_leaves_rays_alone(void **state)
{
    (void)state;
    struct world world = fixture_world("sphere:n=1", WORLD_SAME, 1, 1);
    struct instance_record *record = records(&world);
    const struct ray ray = {
        .org = {-0.0f, INFINITY, 0x1p-149f}, .tmin = -0.0f, .dir = {-0.0f, 1, -0.0f}, .tmax = 3};
    struct ray inside = transform_ray(record, &ray);
    assert_memory_equal(&inside, &ray, sizeof ray);
    assert_true(record->flags & ABI_INSTANCE_IDENTITY);
    free(record);
    world_free(&world);
}

/* The watertight box test allows for what a mesh has behind the ray: what the mesh has in its own
 * space, as if it was traced alone. */
static void the_extent_is_that_of_the_mesh(void **state)
{
    (void)state;
    struct world world = fixture_world("soup:n=200", WORLD_TURNED, 1, 5);
    struct scene *scene = world.mesh->scene;
    for (uint32_t c = 0; c < 3; c++)
        scene->vertex[3 * scene->index[c]] -= 1e6f;
    fixture_finish(&world);
    struct packed_world packed = stand_world(&world, "f32");
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    struct job alone = {.scene = scene, .packed = packed.bottom, .box = job.box, .tri = job.tri};
    uint64_t tests = 0;
    for (uint64_t i = 0; i < 64; i++) {
        const struct box unit = {{0, 0, 0}, {1, 1, 1}};
        struct box near = placed_box_bounds(world.instance->m, &unit);
        struct ray ray = stand_ray(&near, 3, i), inside = transform_ray(packed.record, &ray);
        struct trace_counts both = {0, 0}, one = {0, 0};
        struct tagged hit;
        struct hit expected;
        assert_int_equal(trace_world_ray(&job, &ray, ray_mode_all(), &hit.hit, &hit.tag, &both),
                         STATUS_OK);
        assert_int_equal(trace_ray(&alone, &inside, &expected, &one), STATUS_OK);
        assert_memory_equal(&hit.hit, &expected, sizeof expected);
        if (both.boxes > 2) /* it meets the top's box, and that of the instance */
            assert_int_equal(both.tris, one.tris);
        tests += both.tris;
    }
    assert_true(tests > 64);
    packed_world_free(&packed);
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_met_where_nothing_is),
        cmocka_unit_test(inactive_instances_keep_their_numbers),
        cmocka_unit_test(many_small_instances),
        cmocka_unit_test(ties_of_instances),
        cmocka_unit_test(ranges_are_those_of_the_world),
        cmocka_unit_test(short_stacks_are_noticed),
        cmocka_unit_test(the_identity_leaves_rays_alone),
        cmocka_unit_test(the_extent_is_that_of_the_mesh),
    };
    return cmocka_run_group_tests_name("world_corners", tests, NULL, NULL);
}
