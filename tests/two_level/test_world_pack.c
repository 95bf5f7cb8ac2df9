/* Packed worlds: every builder and layout passes the check, what does not fit is refused with the
 * number. */
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

#include "tests/two_level/mixed_world.h"
#include "tests/two_level/world_stand.h"

static void every_builder_and_layout(void **state)
{
    (void)state;
    struct world world = mixed_world(50);
    uint32_t count = 0;
    for (size_t b = 0; builders_all[b]; b++) {
        if (builders_all[b]->faithful) /* its boxes are cut */
            continue;
        for (uint32_t passes = 0; passes < 2; passes++) {
            struct world_build build = stand_build(builders_all[b]->name, 3);
            struct world_trees trees;
            build.top_options.passes = build.bottom_options.passes = passes;
            assert_int_equal(world_trees_make(&world, &build, &trees, NULL), STATUS_OK);
            for (size_t i = 0; layouts_all[i]; i++) {
                struct packed_world packed;
                struct reason reason = {""};
                if (layouts_all[i]->faithful)
                    continue;
                if (packed_world_make(&world, &trees, layouts_all[i], layouts_all[i], tri_stores[0],
                                      &packed, &reason))
                    fail_msg("%s: %s", layouts_all[i]->name, reason.text);
                assert_sound(&world, &packed);
                assert_false(packed.top.split);
                assert_int_equal(packed.split, packed.bottom[0].split || packed.bottom[2].split);
                packed_world_free(&packed);
                count++;
            }
            world_trees_free(&trees);
        }
    }
    assert_true(count > 500);
    world_free(&world);
}

/* The published builder builds tops, too, whose boxes can be cut. */
static void the_published_builder_builds_tops(void **state)
{
    (void)state;
    struct world world = mixed_world(50);
    struct world_trees trees = stand_trees(&world, "rtrs", 4);
    uint32_t active = 0;
    for (uint32_t i = 0; i < 50; i++)
        active += world_is_active(&world, i);
    assert_int_equal(trees.top.prim_count, active);
    world_trees_free(&trees);
    world_free(&world);
}

/* A builder that splits, or takes parts, does not do so with the boxes of instances, though it does
 * with triangles. */
static void top_is_not_split(const char *builder)
{
    struct world world = fixture_room(1, 200);
    fixture_mesh(&world, 0, "needles:n=50", 1);
    for (uint32_t i = 0; i < 200; i++)
        fixture_transform(WORLD_TURNED, i, world.instance[i].m);
    fixture_finish(&world);
    struct world_build build = stand_build(builder, 1);
    struct world_trees trees;
    struct scene scene;
    struct bvh bvh;
    build.top_options.split_budget = build.bottom_options.split_budget = 4;
    build.top_options.split_alpha = build.bottom_options.split_alpha = -1;
    build.top_options.presplit = build.bottom_options.presplit = 4;
    assert_int_equal(world_trees_make(&world, &build, &trees, NULL), STATUS_OK);
    assert_true(bvh_is_split(&trees.bottom[0]));
    assert_int_equal(trees.top.prim_count, 200);
    /* The same items as a scene are split. */
    assert_int_equal(world_items_make(&world, &trees.parts, trees.box, &scene, NULL), STATUS_OK);
    assert_int_equal(bvh_build(build.top, &scene, &build.top_options, &bvh, NULL), STATUS_OK);
    assert_true(bvh_is_split(&bvh));
    struct packed_world packed = stand_packed(&world, &trees, "f32", "f32");
    assert_true(packed.split);
    bvh_free(&bvh);
    scene_free(&scene);
    packed_world_free(&packed);
    world_trees_free(&trees);
    world_free(&world);
}

static void tops_are_not_split(void **state)
{
    (void)state;
    top_is_not_split("sbvh");
    top_is_not_split("sah_sweep");
    top_is_not_split("ploc");
}

/* --- limits ----------------------------------------------------------------------------------- */

static void assert_refused(const struct world *world, const struct world_trees *trees,
                           const char *top, const char *bottom, const char *expected)
{
    struct packed_world packed;
    const struct packed_world zero = {0};
    struct reason reason = {""};
    assert_int_equal(packed_world_make(world, trees, layout_find(top), layout_find(bottom),
                                       tri_stores[0], &packed, &reason),
                     STATUS_LIMIT);
    if (!strstr(reason.text, expected))
        fail_msg("%s", reason.text);
    assert_memory_equal(&packed, &zero, sizeof zero);
}

static void limits_are_refused_with_their_number(void **state)
{
    (void)state;
    struct world world = fixture_world("platonic:which=0", WORLD_MOVED, 70000, 1);
    struct world_trees trees = stand_trees(&world, "median", 8);
    assert_refused(
        &world, &trees, "rf16", "f32",
        "top level, whose triangles are instances: rf16: a child record index is at most "
        "32767, this tree needs 37752");
    world_trees_free(&trees);
    world_free(&world);
    world = fixture_world("sphere:n=60", WORLD_FAR, 3, 1);
    trees = stand_trees(&world, "median", 1);
    assert_refused(&world, &trees, "f32", "rf16", "mesh 0: rf16: a child record index is at most");
    assert_refused(&world, &trees, "rf16", "f32", "top level, whose triangles are instances: rf16");
    world_trees_free(&trees);
    world.instance[1].m[0][0] = 0x1p-140f;
    world.instance[1].m[1][0] = world.instance[1].m[2][0] = 0;
    fixture_finish(&world);
    trees = stand_trees(&world, "median", 1);
    assert_refused(&world, &trees, "f32", "f32", "instance 1: row 0, column 0 of the transform's");
    world_trees_free(&trees);
    world_free(&world);
    struct world many = {.instance_count = WORLD_INSTANCES_MOST + 1};
    struct world_build build = stand_build("median", 1);
    struct reason reason = {""};
    assert_int_equal(world_trees_make(&many, &build, &trees, &reason), STATUS_LIMIT);
    assert_non_null(strstr(reason.text, "1073741825"));
}

/* Trees as deep as stacks allow, one above the other, are too deep together. */
static void stacks_of_both_levels_are_added(void **state)
{
    (void)state;
    struct world world = fixture_room(1, 40);
    fixture_mesh(&world, 0, "sphere:n=2", 1);
    for (uint32_t i = 0; i < 40; i++)
        fixture_transform(WORLD_MOVED, i, world.instance[i].m);
    fixture_finish(&world);
    struct world_trees trees = stand_trees(&world, "median", 1);
    struct packed_world packed = stand_packed(&world, &trees, "f32", "f32");
    assert_int_equal(packed.stack_need, packed.top.stack_need + packed.bottom->stack_need);
    assert_true(packed.top.stack_need >= 6 && packed.bottom->stack_need >= 5);
    assert_int_equal(packed_world_stack_most(&packed), ABI_STACK_MAX);
    packed_world_free(&packed);
    /* A chain: every inner node has a leaf and the rest. */
    struct bvh *top = &trees.top;
    for (uint32_t i = 0; i < 39; i++) {
        top->node[2 * i] = (struct bvh_node){
            .bounds = top->node[0].bounds, .fst = 2 * i + 1, .snd = 2 * i + 2, .item_first = i};
        top->node[2 * i + 1] =
            (struct bvh_node){.bounds = trees.box[top->prim[i]], .item_first = i, .item_count = 1};
    }
    top->node[78] =
        (struct bvh_node){.bounds = trees.box[top->prim[39]], .item_first = 39, .item_count = 1};
    packed = stand_packed(&world, &trees, "f32", "f32");
    assert_int_equal(packed.top.stack_need, 39);
    packed_world_free(&packed);
    struct bvh *bottom = &trees.bottom[0];
    for (uint32_t i = 0; i < 31; i++) {
        bottom->node[2 * i] = (struct bvh_node){
            .bounds = bottom->node[0].bounds, .fst = 2 * i + 1, .snd = 2 * i + 2, .item_first = i};
        bottom->node[2 * i + 1] =
            (struct bvh_node){.bounds = bottom->node[0].bounds, .item_first = i, .item_count = 1};
    }
    bottom->node[62] =
        (struct bvh_node){.bounds = bottom->node[0].bounds, .item_first = 31, .item_count = 1};
    assert_refused(&world, &trees, "f32", "f32",
                   "the traversal stack holds 64 entries, the top level needs 39 and mesh 0 31");
    /* A wide layout's stack holds both. */
    packed = stand_packed(&world, &trees, "cwbvh80", "f32");
    assert_int_equal(packed_world_stack_most(&packed), ABI_STACK_WIDE);
    packed_world_free(&packed);
    world_trees_free(&trees);
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_builder_and_layout),
        cmocka_unit_test(the_published_builder_builds_tops),
        cmocka_unit_test(tops_are_not_split),
        cmocka_unit_test(limits_are_refused_with_their_number),
        cmocka_unit_test(stacks_of_both_levels_are_added),
    };
    return cmocka_run_group_tests_name("world_pack", tests, NULL, NULL);
}
