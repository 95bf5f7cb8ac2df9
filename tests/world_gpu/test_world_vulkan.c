/* Engine vulkan traces worlds to the bits of engine cpu. Where no device can be opened the tests
 * are skipped. */
#include "tests/world_gpu/vulkan_world_stand.h"

/* Two parts an instance, and a filter that reads the instance's number. */
static void parts_are_filtered_as_their_instances(void **state)
{
    (void)state;
    if (!on_gpu)
        skip();
    struct world world = bars_world(40, 2);
    world.mesh[0].geometry[0].opaque = false;
    world.filter = (struct filter_rule){FILTER_TRIANGLES, 3, 128};
    struct packed_world packed = braid_world(&world, "sah_sweep", "f32", 2);
    for (uint32_t i = 0; i < packed.entry_count - 40; i++)
        assert_int_equal(packed.instance[40 + i], i / 2);
    make_rays(&packed);
    const struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    assert_true(assert_same(&job, false) > RAYS / 8);
    assert_same_lists(job, CAPACITY);
    packed_world_free(&packed);
    world_free(&world);
}

/* Boxes of the top shrunk to points: whether a ray meets one depends on how much wider it is
 * tested, which depends on the largest coordinate of the origin, on each axis and side. */
static void parts_are_tested_as_wide_as_the_ray_is_far(void **state)
{
    (void)state;
    if (!on_gpu)
        skip();
    struct world world = bars_world(40, 2);
    struct packed_world packed = braid_world(&world, "sah_sweep", "f32", 2);
    struct node_f32 *node = (struct node_f32 *)packed.top.word;
    make_rays(&packed);
    for (uint32_t i = 0; i < packed.top.node_count; i++)
        for (int k = 0; k < 3; k++)
            node[i].lo[k] = node[i].hi[k] = (node[i].lo[k] + node[i].hi[k]) / 2;
    const struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    packed.share = 0;
    const uint32_t none = assert_same(&job, false);
    for (uint32_t i = 0; i < RAYS; i++)
        for (int k = 0; k < 3; k++) { /* far along one axis, or near the origin of the world */
            const float far = (float)(i % 16) * (i / 16 % 2 ? 1.0f : -1.0f);
            const float at = (int)(i % 3) == k ? far : rays[i].org[k] / 16;
            rays[i].org[k] = i / 32 % 2 ? at : at / 16;
            rays[i].dir[k] = ((int)(i % 3) == k ? 0 : rays[i].dir[k] / 4) - rays[i].org[k];
        }
    uint32_t most = none;
    for (uint32_t step = 1; step <= 8; step++) {
        packed.share = (float)step / 16;
        const uint32_t hits = assert_same(&job, false);
        most = hits > most ? hits : most;
    }
    assert_true(most > none);
    packed_world_free(&packed);
    world_free(&world);
}

/* A tree of one node is one. */
static void single_triangles_and_instances_are_met(void **state)
{
    (void)state;
    if (!on_gpu)
        skip();
    for (uint32_t count = 1; count <= 3; count++) {
        struct world world = fixture_world("soup:n=1,size=1", WORLD_TURNED, count, 3);
        struct packed_world packed = stand_world(&world, "f32");
        assert_int_equal(packed.bottom[0].node_count, 1);
        make_rays(&packed);
        const struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
        assert_true(assert_same(&job, false) > 0);
        packed_world_free(&packed);
        world_free(&world);
    }
}

/* An item that is the number of the entries, and one behind the last. The instances lie over one
 * another, and items of their mesh would be instances, too. */
static void what_is_out_of_range_is_no_instance(void **state)
{
    (void)state;
    if (!on_gpu)
        skip();
    struct world world = fixture_world("soup:n=3,size=1", WORLD_SAME, 8, 1);
    for (uint32_t kind = 0; kind < 2; kind++) {
        struct packed_world packed = stand_world(&world, "f32");
        struct node_f32 *node = (struct node_f32 *)packed.top.word;
        make_rays(&packed);
        for (uint32_t i = 0; i < packed.top.item_count && kind == 0; i += 2)
            packed.top.item[i] = packed.entry_count + i / 2 % 2;
        for (uint32_t i = 0; i < packed.top.node_count && kind == 1; i++)
            if (node[i].count > 0 && node[i].first + node[i].count == packed.top.item_count)
                node[i].count += 2;
        const struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
        assert_true(assert_same(&job, false) > 0);
        assert_same_lists(job, CAPACITY);
        packed_world_free(&packed);
    }
    world_free(&world);
}

static void every_test_and_query(void **state)
{
    (void)state;
    if (!on_gpu)
        skip();
    struct world world = mixed_world(FILTER_CELLS);
    struct packed_world packed = stand_world(&world, "f32");
    make_rays(&packed);
    for (size_t t = 0; tri_tests[t]; t++) {
        const struct world_job job = job_of_tests(&world, &packed, t % 3, t);
        assert_true(assert_same(&job, true) > RAYS / 8);
    }
    struct world_job job = stand_job(&world, &packed, QUERY_ANY);
    assert_true(assert_same(&job, false) > RAYS / 4);
    for (uint32_t capacity = 0; capacity <= CAPACITY; capacity++)
        assert_same_lists(job, capacity);
    packed_world_free(&packed);
    world_free(&world);
}

/* Wide nodes and their leaves, items of 16 bits in nodes. */
static void every_kind_of_layout(void **state)
{
    (void)state;
    static const char *const names[] = {"cwbvh80", "rf16", "bvh4_u8_node"};
    if (!on_gpu)
        skip();
    struct world world = mixed_world(FILTER_TRIANGLES);
    for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
        struct packed_world packed = stand_world(&world, names[i]);
        make_rays(&packed);
        const struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
        assert_true(assert_same(&job, true) > 0);
        packed_world_free(&packed);
    }
    world_free(&world);
}

static void worlds_without_anything(void **state)
{
    (void)state;
    if (!on_gpu)
        skip();
    struct world world = {0};
    fixture_finish(&world);
    struct packed_world packed = stand_world(&world, "f32");
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    assert_int_equal(assert_same(&job, false), 0);
    packed_world_free(&packed);
    world = fixture_world("soup:n=0", WORLD_SAME, 3, 1);
    packed = stand_world(&world, "cwbvh80");
    job = stand_job(&world, &packed, QUERY_CLOSEST);
    assert_int_equal(assert_same(&job, false), 0);
    packed_world_free(&packed);
    world_free(&world);
}

static void what_cannot_be_traced_is_refused(void **state)
{
    (void)state;
    if (!on_gpu)
        skip();
    struct world world = mixed_world(FILTER_ALL);
    struct world_trees trees = stand_trees(&world, "median", 2);
    struct packed_world packed = stand_packed(&world, &trees, "f32", "cwbvh80");
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    struct reason reason = {""};
    struct trace_report report;
    struct hit hit;
    uint32_t tag;
    assert_int_equal(vulkan->worlds->prepare_world(on_gpu, &job, &reason), STATUS_UNSUPPORTED);
    assert_non_null(strstr(reason.text, "the top is in f32 and mesh 0 in cwbvh80"));
    assert_int_equal(
        vulkan->worlds->trace_world(on_gpu, rays, NULL, 1, &hit, &tag, &report, &reason),
        STATUS_DEVICE);
    packed_world_free(&packed);
    /* A stack that is too short is noticed, and nothing beyond it is written. */
    packed = stand_packed(&world, &trees, "f32", "f32");
    make_rays(&packed);
    packed.stack_need = ABI_STACK_MAX + 1;
    assert_int_equal(vulkan->worlds->prepare_world(on_gpu, &job, &reason), STATUS_LIMIT);
    packed_world_free(&packed);
    world_trees_free(&trees);
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_are_filtered_as_their_instances),
        cmocka_unit_test(parts_are_tested_as_wide_as_the_ray_is_far),
        cmocka_unit_test(single_triangles_and_instances_are_met),
        cmocka_unit_test(what_is_out_of_range_is_no_instance),
        cmocka_unit_test(every_test_and_query),
        cmocka_unit_test(every_kind_of_layout),
        cmocka_unit_test(worlds_without_anything),
        cmocka_unit_test(what_cannot_be_traced_is_refused),
    };
    return cmocka_run_group_tests_name("world_vulkan", tests, open_engines, close_engines);
}
