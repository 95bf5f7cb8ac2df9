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

static void every_test_and_query(void **state)
{
    (void)state;
    if (!on_gpu)
        skip();
    struct world world = mixed_world(FILTER_CELLS);
    struct packed_world packed = stand_world(&world, "f32");
    make_rays(&packed);
    for (size_t t = 0; tri_tests[t]; t++) {
        const struct world_job job = {.world = &world,
                                      .packed = &packed,
                                      .box = box_tests[t % 3],
                                      .tri = tri_tests[t],
                                      .query = t % 2 ? QUERY_ANY : QUERY_CLOSEST};
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
        cmocka_unit_test(every_test_and_query),
        cmocka_unit_test(every_kind_of_layout),
        cmocka_unit_test(worlds_without_anything),
        cmocka_unit_test(what_cannot_be_traced_is_refused),
    };
    return cmocka_run_group_tests_name("world_vulkan", tests, open_engines, close_engines);
}
