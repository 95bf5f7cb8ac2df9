/* The check of packed worlds finds whatever is changed in them. */
#include "ref/store.h"
#include "ref/trace/trace_world.h"
#include "ref/two_level/world_check.h"
#include "tests/two_level/two_level_fixture.h"

#include <float.h>
#include <float.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "tests/two_level/mixed_world.h"
#include "tests/two_level/world_stand.h"

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
        cmocka_unit_test(every_bit_of_a_record_counts),
        cmocka_unit_test(boxes_one_float_too_small_are_found),
        cmocka_unit_test(the_top_contains_the_boxes),
        cmocka_unit_test(tops_name_active_instances_once),
        cmocka_unit_test(tops_leave_out_what_no_ray_meets),
        cmocka_unit_test(bottoms_are_trees_of_their_meshes),
        cmocka_unit_test(numbers_and_stacks),
    };
    return cmocka_run_group_tests_name("world_check", tests, NULL, NULL);
}
