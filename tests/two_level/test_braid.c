/* Re-braiding: what is opened and what stays whole, and that nothing is hit otherwise. */
#include "ref/store.h"
#include "ref/trace/trace_world.h"
#include "ref/tree/subtree.h"
#include "ref/two_level/world_check.h"
#include "ref/world/placed.h"
#include "tests/two_level/two_level_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "tests/two_level/braid_stand.h"
#include "tests/two_level/mixed_world.h"

/* The box of the triangles below a node, placed. */
static struct box box_of(const struct world *world, const struct world_trees *trees,
                         struct world_part part)
{
    const struct instance *instance = &world->instance[part.instance];
    const struct bvh *bvh = &trees->bottom[instance->mesh];
    const struct subtree_range range = subtree_range(bvh, part.node);
    struct box box = box_empty();
    for (uint32_t i = range.first; i < range.end; i++) {
        float v[3][3];
        scene_tri(world->mesh[instance->mesh].scene, bvh->prim[i], v);
        const struct box one = placed_tri_bounds(instance->m, v);
        box_add_box(&box, &one);
    }
    return box;
}

/* A record of 64 bytes for each instance and each part, the words of the trees and of their
 * items. */
static uint64_t bytes_by_hand(const struct packed_world *packed)
{
    uint64_t bytes = 64 * (uint64_t)packed->entry_count;
    bytes += 4 * (uint64_t)(packed->top.word_count + packed->top.item_count);
    for (uint32_t i = 0; i < packed->tree_count; i++)
        bytes += 4 * (uint64_t)(packed->bottom[i].word_count + packed->bottom[i].item_count);
    return bytes;
}

static void every_builder_and_layout_is_sound(void **state)
{
    (void)state;
    struct world world = mixed_world(40);
    uint32_t count = 0;
    for (size_t b = 0; builders_all[b]; b++) {
        if (builders_all[b]->faithful) /* its boxes are cut */
            continue;
        struct world_trees trees = braid_trees(&world, builders_all[b]->name, 2, 6);
        assert_true(trees.parts.count > 40);
        for (size_t i = 0; layouts_all[i]; i++) {
            struct packed_world packed;
            struct reason reason = {""};
            if (layouts_all[i]->faithful)
                continue;
            if (packed_world_make(&world, &trees, layouts_all[i], layouts_all[i], tri_stores[i % 2],
                                  &packed, &reason) &&
                packed_world_make(&world, &trees, layouts_all[i], layouts_all[i], tri_stores[0],
                                  &packed, &reason))
                fail_msg("%s: %s", layouts_all[i]->name, reason.text);
            assert_sound(&world, &packed);
            assert_int_equal(packed.entry_count, 40 + trees.parts.count);
            assert_int_equal(packed_world_bytes(&packed), bytes_by_hand(&packed));
            packed_world_free(&packed);
            count++;
        }
        world_trees_free(&trees);
    }
    assert_true(count > 200);
    world_free(&world);
}

/* Boxes of parts are made as those of instances are: from corners they are larger, and sound. */
static void boxes_of_corners_are_sound(void **state)
{
    (void)state;
    struct world world = mixed_world(40);
    struct world_build build = stand_build("sah_sweep", 2);
    struct world_trees trees;
    build.braid = 6;
    build.boxes = WORLD_BOXES_OF_CORNERS;
    assert_int_equal(world_trees_make(&world, &build, &trees, NULL), STATUS_OK);
    uint32_t larger = 0;
    for (uint32_t i = 0; i < trees.parts.count; i++) {
        const struct world_part part = trees.parts.part[i];
        const struct box least = box_of(&world, &trees, part), *box = &trees.box[40 + i];
        assert_true(box_contains_box(box, &least));
        larger += memcmp(box, &least, sizeof least) != 0;
    }
    assert_true(trees.parts.count > 40 && larger > 10);
    struct packed_world packed = stand_packed(&world, &trees, "f32", "f32");
    packed_world_free(&packed);
    world_trees_free(&trees);
    world_free(&world);
}

/* --- hits ------------------------------------------------------------------------------------- */

/* The same t, and the same triangle unless there are several at that t. */
static void assert_alike(const struct tagged *a, const struct tagged *b)
{
    assert_int_equal(a->hit.prim == ABI_NO_PRIM, b->hit.prim == ABI_NO_PRIM);
    assert_int_equal(float_bits(a->hit.t), float_bits(b->hit.t));
}

static void assert_same_hits(const struct world *world, const struct packed_world *whole,
                             const struct packed_world *braided, bool watertight)
{
    static struct tagged_list of_whole, of_braided;
    uint32_t hits = 0, ties = 0;
    struct world_job a = stand_job(world, whole, QUERY_CLOSEST);
    a.box = box_test_find(watertight ? "watertight" : "robust");
    a.tri = tri_test_find(watertight ? "woop" : "mt");
    struct world_job b = a;
    b.packed = braided;
    for (uint64_t i = 0; i < STAND_RAYS; i++) {
        const struct ray ray = stand_aim(whole, 5, i);
        const struct ray_mode mode = i % 3 ? ray_mode_all() : (struct ray_mode){i & 0xFF, 0};
        const struct tagged left = stand_trace(&a, &ray, mode);
        const struct tagged right = stand_trace(&b, &ray, mode);
        assert_alike(&left, &right);
        ties += left.hit.prim != right.hit.prim;
        hits += left.hit.prim != ABI_NO_PRIM;
        stand_all(&a, &ray, mode, &of_whole);
        stand_all(&b, &ray, mode, &of_braided);
        assert_int_equal(of_whole.count, of_braided.count);
        assert_memory_equal(of_whole.entry, of_braided.entry,
                            of_whole.count * sizeof *of_whole.entry);
        struct world_job any = b;
        any.query = QUERY_ANY;
        assert_int_equal(stand_trace(&any, &ray, mode).hit.prim == ABI_NO_PRIM,
                         left.hit.prim == ABI_NO_PRIM);
    }
    assert_true(hits > STAND_RAYS / 8);
    assert_true(ties < hits / 16);
}

static void hits_are_the_same_in_every_layout(void **state)
{
    (void)state;
    static const char *const names[] = {"median", "sah_sweep", "sbvh"};
    struct world world = fixture_everything();
    for (size_t b = 0; b < ARRAY_COUNT(names); b++) {
        struct world_trees whole = braid_trees(&world, names[b], 1 + (uint32_t)b, 0);
        struct world_trees braided = braid_trees(&world, names[b], 1 + (uint32_t)b, 9);
        assert_true(braided.parts.count > 48);
        for (size_t i = 0; layouts_all[i]; i++) {
            if (layouts_all[i]->faithful)
                continue;
            const char *layout = layouts_all[i]->name;
            struct packed_world a = stand_packed(&world, &whole, layout, layout);
            struct packed_world c = stand_packed(&world, &braided, layout, layout);
            assert_same_hits(&world, &a, &c, i % 2);
            packed_world_free(&a);
            packed_world_free(&c);
        }
        world_trees_free(&whole);
        world_trees_free(&braided);
    }
    world_free(&world);
}

/* --- what is opened --------------------------------------------------------------------------- */

static void without_a_budget_nothing_changes(void **state)
{
    (void)state;
    struct world world = mixed_world(30);
    for (uint32_t braid = 0; braid < 2; braid++) {
        struct world_trees trees = stand_trees(&world, "median", 2);
        struct world_trees same = braid_trees(&world, "median", 2, braid);
        assert_int_equal(same.parts.count, 0);
        assert_true(same.parts.share == 0 && same.parts.reach == 0);
        assert_int_equal(trees.top.prim_count, same.top.prim_count);
        assert_memory_equal(trees.top.prim, same.top.prim, trees.top.prim_count * sizeof(uint32_t));
        assert_memory_equal(trees.box, same.box, 30 * sizeof *same.box);
        world_trees_free(&trees);
        world_trees_free(&same);
    }
    world_free(&world);
}

static void the_budget_is_spent_and_not_overrun(void **state)
{
    (void)state;
    struct world world = mixed_world(40);
    const uint32_t active = braid_active(&world);
    assert_true(active > 10 && active < 30);
    uint32_t most = 0, before = active;
    for (uint32_t i = 0; i < 40; i++)
        most += world_is_active(&world, i) ? world_scene(&world, i)->tri_count : 0;
    for (uint32_t braid = 0; braid <= BRAID_MOST; braid++) {
        struct world_trees trees = braid_trees(&world, "median", 1, braid);
        const uint32_t entries = braid_entries(&trees);
        if (braid <= 20)
            assert_int_equal(entries, active * (braid ? braid : 1));
        assert_true(entries <= most && entries >= before);
        before = entries;
        world_trees_free(&trees);
    }
    assert_true(before < BRAID_MOST * active); /* leaves cannot be opened */
    world_free(&world);
}

/* What opening is worth, -INFINITY for a leaf. */
static double gain_of(const struct world *world, const struct world_trees *trees,
                      struct world_part part)
{
    const struct bvh_node *node = &trees->bottom[0].node[part.node];
    if (node->item_count > 0)
        return -INFINITY;
    const struct box box = box_of(world, trees, part);
    const struct box child[] = {
        box_of(world, trees, (struct world_part){part.instance, node->fst}),
        box_of(world, trees, (struct world_part){part.instance, node->snd})};
    return braid_gain(&box, child);
}

#define ENTRIES_MOST 256

/* The greedy choice, by looking at every entry each time. Returns how many entries there are. */
static uint32_t open_by_hand(const struct world *world, const struct world_trees *trees,
                             uint32_t most, struct world_part *entry)
{
    double gain[ENTRIES_MOST];
    uint32_t count = world->instance_count;
    for (uint32_t i = 0; i < count; i++) {
        entry[i] = (struct world_part){i, 0};
        gain[i] = gain_of(world, trees, entry[i]);
    }
    while (count < most) {
        uint32_t best = 0;
        for (uint32_t i = 1; i < count; i++)
            best = gain[i] > gain[best] ? i : best;
        const struct bvh_node *node = &trees->bottom[0].node[entry[best].node];
        entry[count] = (struct world_part){entry[best].instance, node->snd};
        entry[best].node = node->fst;
        gain[best] = gain_of(world, trees, entry[best]);
        gain[count] = gain_of(world, trees, entry[count]);
        count++;
    }
    return count;
}

static void the_largest_gain_is_opened_next(void **state)
{
    (void)state;
    struct world_part entry[ENTRIES_MOST];
    struct world world = bars_world(12, 4);
    for (uint32_t braid = 2; braid <= 20; braid += 3) {
        struct world_trees trees = braid_trees(&world, "sah_sweep", 1, braid);
        const uint32_t count = open_by_hand(&world, &trees, 12 * braid, entry);
        uint32_t parts = 0;
        for (uint32_t i = 0; i < count; i++) {
            bool found = entry[i].node == 0;
            for (uint32_t k = 0; k < trees.parts.count && entry[i].node > 0; k++)
                found = found || memcmp(&trees.parts.part[k], &entry[i], sizeof *entry) == 0;
            assert_true(found);
            parts += entry[i].node > 0;
        }
        assert_int_equal(trees.parts.count, parts);
        for (uint32_t k = 1; k < parts; k++) {
            const struct world_part *a = &trees.parts.part[k - 1], *b = a + 1;
            assert_true(a->instance < b->instance ||
                        (a->instance == b->instance && a->node < b->node));
        }
        for (uint32_t k = 0; k < parts; k++) {
            const struct box box = box_of(&world, &trees, trees.parts.part[k]);
            assert_memory_equal(&box, &trees.box[12 + k], sizeof box);
        }
        world_trees_free(&trees);
    }
    world_free(&world);
}

static uint32_t parts_of(const struct world_trees *trees, uint32_t instance)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < trees->parts.count; i++)
        count += trees->parts.part[i].instance == instance;
    return count;
}

/* Instance 0 and some others may be opened; each other one has its own reason not to be. */
static void what_has_no_bound_stays_whole(void **state)
{
    (void)state;
    struct world world = fixture_room(2, 8);
    tiled_box(&world, 0, 3);
    fixture_mesh(&world, 1, "soup:n=1", 1);
    world.instance[1].mesh = 1;             /* one leaf */
    world.instance[2].mask = 0;             /* not active */
    world.instance[3].mesh = WORLD_NO_MESH; /* likewise */
    for (int k = 0; k < 3; k++)
        world.instance[4].m[k][k] = 0x1p-50f; /* so small that products would be lost */
    for (int k = 0; k < 3; k++)               /* thin: kappa of a million */
        for (int j = 0; j < 3; j++)
            world.instance[5].m[k][j] = (k == j ? 1e-6f : 0) + 0.25f;
    world.instance[6].m[0][3] = 1e6f; /* its boxes would have to be wider than it is */
    world.instance[7].m[0][3] = 2.5f;
    fixture_finish(&world);
    struct world_trees trees = braid_trees(&world, "median", 1, 64);
    for (uint32_t i = 0; i < 8; i++)
        assert_int_equal(parts_of(&trees, i) > 0, i == 0 || i == 7);
    /* What stays whole does not widen the boxes of others. */
    assert_true(trees.parts.share < 0x1.1p-18f && trees.parts.reach < 4);
    world_trees_free(&trees);
    world_free(&world);
}

static void meshes_of_split_trees_stay_whole(void **state)
{
    (void)state;
    struct world world = fixture_room(2, 20);
    fixture_mesh(&world, 0, "needles:n=50", 1);
    tiled_box(&world, 1, 3);
    for (uint32_t i = 0; i < 20; i++) {
        fixture_transform(WORLD_TURNED, i, world.instance[i].m);
        world.instance[i].mesh = i % 2;
    }
    fixture_finish(&world);
    struct world_build build = stand_build("sbvh", 1);
    build.braid = BRAID_MOST;
    build.bottom_options.split_budget = 4;
    build.bottom_options.split_alpha = -1;
    struct world_trees trees;
    assert_int_equal(world_trees_make(&world, &build, &trees, NULL), STATUS_OK);
    assert_true(bvh_is_split(&trees.bottom[0]) && !bvh_is_split(&trees.bottom[1]));
    for (uint32_t i = 0; i < 20; i++)
        assert_int_equal(parts_of(&trees, i) > 0, i % 2);
    struct packed_world packed = stand_packed(&world, &trees, "f32", "f32");
    packed_world_free(&packed);
    world_trees_free(&trees);
    world_free(&world);
}

/* --- what it is for --------------------------------------------------------------------------- */

static uint64_t boxes_tested(const struct world *world, const struct packed_world *packed,
                             const struct packed_world *aim, uint64_t *tris)
{
    const struct world_job job = stand_job(world, packed, QUERY_CLOSEST);
    struct trace_counts counts = {0};
    for (uint64_t i = 0; i < 2000; i++) {
        const struct ray ray = stand_aim(aim, 8, i);
        struct hit hit;
        uint32_t tag;
        assert_int_equal(trace_world_ray(&job, &ray, ray_mode_all(), &hit, &tag, &counts),
                         STATUS_OK);
    }
    *tris = counts.tris;
    return counts.boxes;
}

static void bars_across_each_other_cost_less(void **state)
{
    (void)state;
    struct world world = bars_world(60, 8);
    struct packed_world whole = braid_world(&world, "sah_sweep", "f32", 0);
    uint64_t tris, first_tris, boxes, first = boxes_tested(&world, &whole, &whole, &first_tris);
    uint64_t least = first;
    print_message("entries per instance, box tests and triangle tests per ray: 1 %.1f %.2f",
                  (double)first / 2000, (double)first_tris / 2000);
    for (uint32_t braid = 2; braid <= 16; braid *= 2) {
        struct packed_world packed = braid_world(&world, "sah_sweep", "f32", braid);
        boxes = boxes_tested(&world, &packed, &whole, &tris);
        print_message("; %u %.1f %.2f", braid, (double)boxes / 2000, (double)tris / 2000);
        assert_true(boxes < first && tris <= first_tris);
        least = boxes < least ? boxes : least;
        packed_world_free(&packed);
    }
    print_message("\n");
    assert_true(1.9 * (double)least < (double)first);
    packed_world_free(&whole);
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_builder_and_layout_is_sound),
        cmocka_unit_test(boxes_of_corners_are_sound),
        cmocka_unit_test(hits_are_the_same_in_every_layout),
        cmocka_unit_test(without_a_budget_nothing_changes),
        cmocka_unit_test(the_budget_is_spent_and_not_overrun),
        cmocka_unit_test(the_largest_gain_is_opened_next),
        cmocka_unit_test(what_has_no_bound_stays_whole),
        cmocka_unit_test(meshes_of_split_trees_stay_whole),
        cmocka_unit_test(bars_across_each_other_cost_less),
    };
    return cmocka_run_group_tests_name("braid", tests, NULL, NULL);
}
