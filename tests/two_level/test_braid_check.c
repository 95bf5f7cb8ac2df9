/* The check of packed worlds finds whatever is changed in the parts of instances; other engines
 * take such worlds. */
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

#include "tests/two_level/braid_stand.h"
#include "tests/two_level/mixed_world.h"

static void assert_found(const struct world *world, const struct packed_world *packed,
                         enum world_rule rule)
{
    struct world_faults faults;
    struct reason reason = {""};
    assert_int_equal(world_pack_check(world, packed, &faults, &reason), STATUS_INPUT);
    if (faults.first != rule)
        fail_msg("rule %d, not %d: %s", faults.first, rule, reason.text);
    assert_true(reason.text[0] != 0);
    assert_int_equal(world_pack_check(world, packed, NULL, NULL), STATUS_INPUT);
}

static struct packed_world mixed_packed(const struct world *world)
{
    struct world_trees trees = braid_trees(world, "median", 2, 5);
    struct packed_world packed = stand_packed(world, &trees, "f32", "f32");
    assert_true(trees.parts.count > 30);
    world_trees_free(&trees);
    return packed;
}

static void every_bit_of_a_part_s_record_counts(void **state)
{
    (void)state;
    struct world world = mixed_world(20);
    struct packed_world packed = mixed_packed(&world);
    for (uint32_t at = 20; at < packed.entry_count; at += 3) {
        uint32_t *word = (uint32_t *)(void *)&packed.record[at];
        for (uint32_t i = 0; i < sizeof *packed.record / 4; i++)
            for (int bit = 0; bit < 32; bit++) {
                const uint32_t was = word[i];
                word[i] ^= 1u << bit;
                /* Another tree of the same mesh is a tree of the mesh, but not the part. */
                const uint32_t mesh = packed.record[at].mesh;
                const bool other = i == offsetof(struct instance_record, mesh) / 4 &&
                                   mesh >= packed.mesh_count && mesh < packed.tree_count &&
                                   packed.mesh[mesh] == packed.mesh[was];
                struct world_faults faults;
                assert_int_equal(world_pack_check(&world, &packed, &faults, NULL), STATUS_INPUT);
                assert_true((faults.first == WORLD_RECORD) == !other);
                word[i] = was;
            }
    }
    assert_sound(&world, &packed);
    packed_world_free(&packed);
    world_free(&world);
}

/* Boxes of parts are the least ones: one float inwards on any side is too small. */
static void boxes_of_parts_one_float_too_small_are_found(void **state)
{
    (void)state;
    struct world world = mixed_world(20);
    struct packed_world packed = mixed_packed(&world);
    for (uint32_t i = 20; i < packed.entry_count; i++)
        for (int k = 0; k < 6; k++) {
            struct box *box = &packed.box[i], was = *box;
            float *bound = k < 3 ? &box->lo[k] : &box->hi[k - 3];
            *bound = nextafterf(*bound, k < 3 ? INFINITY : -INFINITY);
            assert_found(&world, &packed, WORLD_BOX);
            *bound = k % 2 ? NAN : (k < 3 ? -INFINITY : INFINITY);
            assert_int_equal(world_pack_check(&world, &packed, NULL, NULL), STATUS_INPUT);
            *box = was;
        }
    packed_world_free(&packed);
    world_free(&world);
}

/* A tree of another part in place of one: triangles are in no part, or in two. */
static void parts_have_each_triangle_once(void **state)
{
    (void)state;
    struct world world = bars_world(2, 2);
    struct packed_world packed = braid_world(&world, "median", "f32", 12);
    struct world_faults faults;
    uint32_t twice = 0, none = 0;
    for (uint32_t at = 2; at < packed.entry_count; at++)
        for (uint32_t other = 2; other < packed.entry_count; other++) {
            const uint32_t was = packed.record[at].mesh;
            const struct box box = packed.box[at];
            if (packed.record[other].mesh == was)
                continue;
            packed.record[at].mesh = packed.record[other].mesh;
            packed.box[at] = packed.box[packed.instance[at]]; /* large enough for any part */
            assert_int_equal(world_pack_check(&world, &packed, &faults, NULL), STATUS_INPUT);
            assert_true(faults.parts > 0 && faults.boxes == 0 && faults.records == 0);
            twice += faults.parts > 1;
            none += faults.parts == 1;
            packed.record[at].mesh = was;
            packed.box[at] = box;
        }
    assert_true(twice > 0 && none > 0);
    packed_world_free(&packed);
    world_free(&world);
}

static void entries_and_trees_are_in_order(void **state)
{
    (void)state;
    struct world world = mixed_world(20);
    struct packed_world packed = mixed_packed(&world);
    for (uint32_t i = 0; i < packed.entry_count; i++) {
        const uint32_t was = packed.instance[i];
        packed.instance[i] = i < 20 ? (was + 1) % 20 : 3; /* 3 is not active */
        assert_found(&world, &packed, WORLD_NUMBERS);
        packed.instance[i] = 20;
        assert_found(&world, &packed, WORLD_NUMBERS);
        packed.instance[i] = was;
    }
    for (uint32_t i = 0; i < packed.tree_count; i++) {
        const uint32_t was = packed.mesh[i];
        packed.mesh[i] = i < 3 ? (was + 1) % 3 : 3;
        assert_found(&world, &packed, WORLD_NUMBERS);
        packed.mesh[i] = was;
    }
    const uint32_t entries = packed.entry_count, trees = packed.tree_count;
    packed.entry_count = 19;
    assert_found(&world, &packed, WORLD_NUMBERS);
    packed.entry_count = entries;
    packed.tree_count = 2;
    assert_found(&world, &packed, WORLD_NUMBERS);
    packed.tree_count = trees;
    assert_sound(&world, &packed);
    packed_world_free(&packed);
    world_free(&world);
}

/* The item of the top that names entry `from` names `to` instead. */
static uint32_t *item_of(const struct packed_world *packed, uint32_t entry)
{
    for (uint32_t i = 0; i < packed->top.item_count; i++)
        if (packed->top.item[i] == entry)
            return &packed->top.item[i];
    fail_msg("entry %u is in no leaf", entry);
    return NULL;
}

/* Not the opened instance beside its parts, and each of these. */
static void tops_name_parts_and_not_what_is_opened(void **state)
{
    (void)state;
    struct world world = mixed_world(20);
    struct packed_world packed = mixed_packed(&world);
    for (uint32_t i = 20; i < packed.entry_count; i++) {
        uint32_t *item = item_of(&packed, i);
        *item = packed.instance[i];
        assert_found(&world, &packed, WORLD_TOP);
        *item = i > 20 ? i - 1 : i + 1;
        assert_found(&world, &packed, WORLD_TOP);
        *item = i;
    }
    assert_sound(&world, &packed);
    packed_world_free(&packed);
    world_free(&world);
}

static void boxes_are_tested_wide_enough(void **state)
{
    (void)state;
    struct world world = mixed_world(20);
    struct packed_world packed = mixed_packed(&world);
    const float share = packed.share, reach = packed.reach;
    packed.share = nextafterf(share, 0);
    assert_found(&world, &packed, WORLD_WIDTH);
    packed.share = share;
    packed.reach = nextafterf(reach, 0);
    assert_found(&world, &packed, WORLD_WIDTH);
    packed.reach = NAN;
    assert_found(&world, &packed, WORLD_WIDTH);
    packed.reach = 2 * reach; /* wider than needed is no fault */
    assert_sound(&world, &packed);
    packed_world_free(&packed);
    world_free(&world);
}

/* Any bit of the trees of parts. */
static void trees_of_parts_are_checked(void **state)
{
    (void)state;
    struct world world = bars_world(3, 2);
    struct packed_world packed = braid_world(&world, "median", "f32", 6);
    uint32_t found = 0, looked = 0;
    assert_true(packed.tree_count > 8);
    for (uint32_t t = 1; t < packed.tree_count; t++) {
        struct packed *tree = &packed.bottom[t];
        for (uint32_t i = 0; i < tree->item_count; i++, looked++) {
            tree->item[i] ^= 1;
            found += world_pack_check(&world, &packed, NULL, NULL) != STATUS_OK;
            tree->item[i] ^= 1;
        }
        tree->stack_need += 100;
        assert_found(&world, &packed, WORLD_STACK);
        tree->stack_need -= 100;
    }
    assert_true(found == looked && looked > 30);
    packed_world_free(&packed);
    world_free(&world);
}

/* --- an engine with trees of its own ---------------------------------------------------------- */

#define FAST_RAYS 2000

/* Engine fast builds a top of whole instances: its hits are those of cpu. */
static void fast_takes_braided_worlds(void **state)
{
    (void)state;
    static struct ray ray[FAST_RAYS];
    static struct hit hit[2][FAST_RAYS];
    static uint32_t tag[2][FAST_RAYS];
    static const char *const names[] = {"fast", "cpu"};
    const struct engine_options options = {.threads = 1, .device = -1};
    struct world world = mixed_world(40);
    struct packed_world packed = mixed_packed(&world);
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    struct trace_report report;
    uint32_t hits = 0, differ = 0;
    job.tri = tri_test_find("woop");
    for (uint32_t i = 0; i < FAST_RAYS; i++)
        ray[i] = stand_aim(&packed, 77, i);
    for (int e = 0; e < 2; e++) {
        const struct engine *engine = engine_find(names[e]);
        struct reason reason = {""};
        void *self;
        if (engine_open(engine, &options, &self, &reason) ||
            engine->worlds->prepare_world(self, &job, &reason) ||
            engine->worlds->trace_world(self, ray, NULL, FAST_RAYS, hit[e], tag[e], &report,
                                        &reason))
            fail_msg("%s: %s", names[e], reason.text);
        engine->close(self);
    }
    for (uint32_t i = 0; i < FAST_RAYS; i++) {
        assert_int_equal(float_bits(hit[0][i].t), float_bits(hit[1][i].t));
        differ += hit[0][i].prim != hit[1][i].prim;
        hits += hit[0][i].prim != ABI_NO_PRIM;
    }
    assert_true(hits > FAST_RAYS / 8 && differ < hits / 50); /* ties */
    packed_world_free(&packed);
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_bit_of_a_part_s_record_counts),
        cmocka_unit_test(boxes_of_parts_one_float_too_small_are_found),
        cmocka_unit_test(parts_have_each_triangle_once),
        cmocka_unit_test(entries_and_trees_are_in_order),
        cmocka_unit_test(tops_name_parts_and_not_what_is_opened),
        cmocka_unit_test(boxes_are_tested_wide_enough),
        cmocka_unit_test(trees_of_parts_are_checked),
        cmocka_unit_test(fast_takes_braided_worlds),
    };
    return cmocka_run_group_tests_name("braid_check", tests, NULL, NULL);
}
