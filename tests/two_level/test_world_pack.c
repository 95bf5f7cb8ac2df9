/* Packed worlds: every builder and layout passes the check, what does not fit is refused with the
 * number, and the check finds whatever is changed. */
#include "ref/store.h"
#include "ref/trace/trace_world.h"
#include "ref/two_level/world_check.h"
#include "tests/two_level/two_level_fixture.h"

#include <float.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "tests/two_level/world_stand.h"

/* Two meshes, one of them in two geometries; instances of all kinds, some not active. */
static struct world mixed_world(uint32_t count)
{
    struct world world = fixture_room(3, count);
    fixture_mesh(&world, 0, "soup:n=25,size=0.5", 2);
    fixture_mesh(&world, 1, "soup:n=0", 1);
    fixture_mesh(&world, 2, "sphere:n=2", 1);
    for (uint32_t i = 0; i < count; i++) {
        struct instance *instance = &world.instance[i];
        enum world_kind kind = (enum world_kind)(i % WORLD_FAR);
        fixture_transform(kind, i, instance->m);
        instance->mesh = i % 7 == 3 ? 1 : i % 2 * 2;
        instance->mesh = i % 7 == 5 ? WORLD_NO_MESH : instance->mesh;
        instance->mask = i % 7 == 6 ? 0 : 1 + i % 255;
        instance->flags = i % 12;
    }
    fixture_finish(&world);
    return world;
}

static void assert_sound(const struct world *world, const struct packed_world *packed)
{
    struct world_faults faults = {.first = WORLD_STACK, .records = 1};
    const struct world_faults none = {0};
    struct reason reason = {""};
    if (world_pack_check(world, packed, &faults, &reason))
        fail_msg("%s", reason.text);
    assert_memory_equal(&faults, &none, sizeof none);
}

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

/* A builder that splits does not split the boxes of instances, though it splits triangles. */
static void tops_are_not_split(void **state)
{
    (void)state;
    struct world world = fixture_room(1, 200);
    fixture_mesh(&world, 0, "needles:n=50", 1);
    for (uint32_t i = 0; i < 200; i++)
        fixture_transform(WORLD_TURNED, i, world.instance[i].m);
    fixture_finish(&world);
    struct world_build build = stand_build("sbvh", 1);
    struct world_trees trees;
    struct scene scene;
    struct bvh bvh;
    build.top_options.split_budget = build.bottom_options.split_budget = 4;
    build.top_options.split_alpha = build.bottom_options.split_alpha = -1;
    assert_int_equal(world_trees_make(&world, &build, &trees, NULL), STATUS_OK);
    assert_true(bvh_is_split(&trees.bottom[0]));
    assert_int_equal(trees.top.prim_count, 200);
    /* The same items as a scene are split. */
    assert_int_equal(world_items_make(&world, trees.box, &scene, NULL), STATUS_OK);
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

/* --- the check -------------------------------------------------------------------------------- */

static void assert_found(const struct world *world, const struct packed_world *packed,
                         enum world_rule rule)
{
    struct world_faults faults;
    struct reason reason = {""};
    assert_int_equal(world_pack_check(world, packed, &faults, &reason), STATUS_INPUT);
    assert_int_equal(faults.first, rule);
    assert_true(reason.text[0] != 0);
    assert_int_equal(world_pack_check(world, packed, NULL, NULL), STATUS_INPUT);
}

static void every_bit_of_a_record_counts(void **state)
{
    (void)state;
    struct world world = mixed_world(16);
    struct packed_world packed = stand_world(&world, "f32");
    uint32_t *word = (uint32_t *)(void *)packed.record;
    for (uint32_t i = 0; i < 16 * sizeof *packed.record / 4; i++)
        for (int bit = 0; bit < 32; bit++) {
            word[i] ^= 1u << bit;
            assert_found(&world, &packed, WORLD_RECORD);
            word[i] ^= 1u << bit;
        }
    struct instance_record first = packed.record[0];
    packed.record[0] = packed.record[2];
    packed.record[2] = first;
    struct world_faults faults;
    assert_int_equal(world_pack_check(&world, &packed, &faults, NULL), STATUS_INPUT);
    assert_int_equal(faults.records, 2);
    packed.record[2] = packed.record[0];
    packed.record[0] = first;
    packed.record[1].custom_mask ^= 0x1000000; /* of several the first is described */
    packed.record[5].t[0] += 1;
    assert_int_equal(world_pack_check(&world, &packed, &faults, NULL), STATUS_INPUT);
    assert_int_equal(faults.records, 2);
    assert_int_equal(faults.part, RECORD_MASK);
    packed_world_free(&packed);
    world_free(&world);
}

/* Boxes are the least ones: one float inwards on any side is too small. */
static void boxes_one_float_too_small_are_found(void **state)
{
    (void)state;
    struct world world = mixed_world(16);
    struct packed_world packed = stand_world(&world, "f32");
    for (uint32_t i = 0; i < 16; i++)
        for (int k = 0; k < 6; k++) {
            struct box *box = &packed.box[i], was = *box;
            float *bound = k < 3 ? &box->lo[k] : &box->hi[k - 3];
            *bound = nextafterf(*bound, k < 3 ? INFINITY : -INFINITY);
            assert_found(&world, &packed, WORLD_BOX);
            *bound = k % 2 ? NAN : (k < 3 ? -INFINITY : INFINITY);
            assert_found(&world, &packed, WORLD_BOX);
            *box = was;
        }
    packed_world_free(&packed);
    world_free(&world);
}

/* A box that grows stays right, but not the top above it. */
static void the_top_contains_the_boxes(void **state)
{
    (void)state;
    struct world world = mixed_world(16);
    struct packed_world packed = stand_world(&world, "f32");
    packed.box[0].hi[1] += 1000;
    assert_found(&world, &packed, WORLD_TOP);
    packed.box[0].hi[1] -= 1000;
    packed.box[0].hi[1] = FLT_MAX;
    assert_found(&world, &packed, WORLD_TOP);
    packed_world_free(&packed);
    world_free(&world);
}

/* Items named twice, not at all, beyond the world, or of instances that no ray meets. */
static void tops_name_active_instances_once(void **state)
{
    (void)state;
    struct world world = mixed_world(16);
    struct packed_world packed = stand_world(&world, "f32");
    for (uint32_t i = 0; i < packed.top.item_count; i++) {
        uint32_t was = packed.top.item[i];
        for (uint32_t other = 0; other < 18; other++) {
            packed.top.item[i] = other;
            if (other != was)
                assert_found(&world, &packed, WORLD_TOP);
        }
        packed.top.item[i] = was;
    }
    packed.top.split = true;
    assert_found(&world, &packed, WORLD_TOP);
    packed.top.split = false;
    packed.top.stack_need--;
    assert_found(&world, &packed, WORLD_TOP);
    packed_world_free(&packed);
    world_free(&world);
}

/* A top that names what it should, and an instance besides that no ray meets. */
static void tops_leave_out_what_no_ray_meets(void **state)
{
    (void)state;
    struct world world = fixture_world("sphere:n=1", WORLD_MOVED, 9, 4);
    struct packed_world all = stand_world(&world, "f32");
    world.instance[4].mask = 0;
    struct packed_world some = stand_world(&world, "f32");
    struct packed top = some.top;
    some.top = all.top;
    some.stack_need = ABI_STACK_MAX;
    struct reason reason = {""};
    assert_found(&world, &some, WORLD_TOP);
    assert_int_equal(world_pack_check(&world, &some, NULL, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "names triangle 4, which is left out"));
    some.top = top;
    assert_sound(&world, &some);
    packed_world_free(&all);
    packed_world_free(&some);
    world_free(&world);
}

static void bottoms_are_trees_of_their_meshes(void **state)
{
    (void)state;
    struct world world = mixed_world(16);
    struct packed_world packed = stand_world(&world, "f32");
    struct packed first = packed.bottom[0];
    packed.bottom[0] = packed.bottom[2];
    packed.bottom[2] = first;
    assert_found(&world, &packed, WORLD_BOTTOM);
    packed.bottom[2] = packed.bottom[0];
    packed.bottom[0] = first;
    for (uint32_t i = 0; i < packed.bottom[2].item_count; i++) {
        uint32_t was = packed.bottom[2].item[i];
        packed.bottom[2].item[i] = (was + 1) % 32;
        assert_found(&world, &packed, WORLD_BOTTOM);
        packed.bottom[2].item[i] = was;
    }
    uint32_t nodes = packed.bottom[1].node_count;
    assert_int_equal(nodes, 0);
    assert_sound(&world, &packed);
    packed_world_free(&packed);
    world_free(&world);
}

static void numbers_and_stacks(void **state)
{
    (void)state;
    struct world world = mixed_world(16);
    struct packed_world packed = stand_world(&world, "f32");
    packed.instance_count--;
    assert_found(&world, &packed, WORLD_NUMBERS);
    packed.instance_count++;
    packed.mesh_count--;
    assert_found(&world, &packed, WORLD_NUMBERS);
    packed.mesh_count++;
    packed.stack_need--;
    assert_found(&world, &packed, WORLD_STACK);
    packed.stack_need = ABI_STACK_MAX + 1;
    assert_found(&world, &packed, WORLD_STACK);
    packed.stack_need = ABI_STACK_MAX;
    assert_sound(&world, &packed);
    packed_world_free(&packed);
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
        cmocka_unit_test(every_bit_of_a_record_counts),
        cmocka_unit_test(boxes_one_float_too_small_are_found),
        cmocka_unit_test(the_top_contains_the_boxes),
        cmocka_unit_test(tops_name_active_instances_once),
        cmocka_unit_test(tops_leave_out_what_no_ray_meets),
        cmocka_unit_test(bottoms_are_trees_of_their_meshes),
        cmocka_unit_test(numbers_and_stacks),
    };
    return cmocka_run_group_tests_name("world_pack", tests, NULL, NULL);
}
