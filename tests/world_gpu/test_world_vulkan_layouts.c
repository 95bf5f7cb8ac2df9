/* Engine vulkan traces worlds to the bits of engine cpu in every layout, with every test and
 * storage. Most of the time goes into the driver's compiler, so a pipeline has as many cases as it
 * can. Where no device can be opened the tests are skipped. */
#include "tests/world_gpu/vulkan_world_stand.h"

/* One kind of layout with one shader; of those that share a file the last. */
static bool ends_family(size_t i)
{
    return !layouts_all[i + 1] ||
           strcmp(layout_shader(layouts_all[i]), layout_shader(layouts_all[i + 1])) != 0;
}

/* The world with whole instances and with parts of them. */
struct both_worlds {
    struct world world;
    struct packed_world whole, parts;
};

/* Both with one stack, so that one pipeline traces both. */
static struct both_worlds both_worlds(size_t i)
{
    struct both_worlds b = {.world = mixed_world((enum filter_kind)((i + 2) % 4))};
    struct world_build build = stand_build("sah_sweep", 1 + (uint32_t)i % 3);
    struct world_trees whole = stand_trees(&b.world, "median", 3), parts;
    const struct layout *layout = layouts_all[i];
    struct reason reason = {""};
    build.braid = 3 + (uint32_t)i % 5;
    if (world_trees_make(&b.world, &build, &parts, &reason) ||
        packed_world_make(&b.world, &whole, layout, layout, tri_stores[0], &b.whole, &reason) ||
        packed_world_make(&b.world, &parts, layout, layout, tri_stores[0], &b.parts, &reason))
        fail_msg("%s: %s", layout->name, reason.text);
    assert_true(b.parts.entry_count > 50 && b.parts.share > 0);
    if (b.whole.stack_need < b.parts.stack_need)
        b.whole.stack_need = b.parts.stack_need;
    b.parts.stack_need = b.whole.stack_need;
    world_trees_free(&whole);
    world_trees_free(&parts);
    return b;
}

/* Of some tops with parts of instances, too: the shader reads their records, trees and instances,
 * and tests its boxes as wide. */
static void every_layout_has_the_bits_of_cpu(void **state)
{
    (void)state;
    if (!on_gpu)
        skip();
    uint32_t count = 0, families = 0;
    for (size_t i = 0; layouts_all[i]; i++) {
        struct both_worlds b = both_worlds(i);
        const struct packed_world *packed[] = {&b.whole, &b.parts};
        for (size_t k = 0; k < (i % 5 ? 1 : 2); k++) {
            const struct world_job job = stand_job(&b.world, packed[k], QUERY_CLOSEST);
            make_rays(packed[k]);
            assert_true(assert_same(&job, true) > (layouts_all[i]->faithful ? 0 : RAYS / 8));
        }
        if (ends_family(i))
            assert_same_lists(stand_job(&b.world, &b.parts, QUERY_ALL), CAPACITY);
        families += ends_family(i);
        count++;
        packed_world_free(&b.whole);
        packed_world_free(&b.parts);
        world_free(&b.world);
    }
    assert_true(count > 50 && families == 15);
}

static void every_pair_of_tests(void **state)
{
    (void)state;
    if (!on_gpu)
        skip();
    struct world world = mixed_world(FILTER_CELLS);
    struct packed_world packed = stand_world(&world, "f32");
    make_rays(&packed);
    for (size_t b = 0; box_tests[b]; b++)
        for (size_t t = 0; tri_tests[t]; t++) {
            const struct world_job job = job_of_tests(&world, &packed, b, t);
            assert_true(assert_same(&job, true) > RAYS / 8);
        }
    packed_world_free(&packed);
    world_free(&world);
}

static void every_storage_of_meshes(void **state)
{
    (void)state;
    if (!on_gpu)
        skip();
    struct world world = fixture_room(1, 12);
    fixture_mesh(&world, 0, "grid:n=5", 3);
    for (uint32_t i = 0; i < 12; i++)
        fixture_transform(WORLD_TURNED, 30 + i, world.instance[i].m);
    fixture_finish(&world);
    struct world_trees trees = stand_trees(&world, "median", 3);
    uint32_t count = 0;
    for (size_t s = 0; tri_stores[s]; s++) {
        struct packed_world packed;
        struct reason reason = {""};
        const char *layout = s % 2 ? "half4" : "f32";
        if (packed_world_make(&world, &trees, layout_find(layout), layout_find(layout),
                              tri_stores[s], &packed, &reason))
            continue;
        struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
        for (size_t t = 0; !tri_store_answers(tri_stores[s], job.tri->id); t++)
            job.tri = tri_tests[t];
        make_rays(&packed);
        assert_true(assert_same(&job, false) > RAYS / 8);
        count++;
        packed_world_free(&packed);
    }
    assert_true(count >= 5);
    world_trees_free(&trees);
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_layout_has_the_bits_of_cpu),
        cmocka_unit_test(every_pair_of_tests),
        cmocka_unit_test(every_storage_of_meshes),
    };
    return cmocka_run_group_tests_name("world_vulkan_layouts", tests, open_engines, close_engines);
}
