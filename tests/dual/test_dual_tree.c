/* Dual-split trees keep what the binary tree had: every leaf once, and every box, exactly. */
#include "ref/dual/dual.h"
#include "scenes/scenes.h"

#include <math.h>
#include <stdio.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#include "tests/dual/dual_fixture.h"

/* --- the law of boxes ------------------------------------------------------------------------- */

struct dual_laws {
    const struct dual_stand *stand;
    uint32_t *leaf_of; /* by first item: the node of the binary tree, which is 0 once it was seen */
    bool exact;        /* implied boxes are the nodes' own */
    uint32_t splits, carves, leaves, deepest, next;
};

static void must_hold(const struct dual_laws *laws, const struct box *implied,
                      const struct box *own)
{
    for (uint32_t side = 0; side < 6; side++) {
        float outer = dual_bound(implied, side), inner = dual_bound(own, side);
        if (side < 3 ? outer > inner : outer < inner)
            fail_msg("%s: a box ends at %a, implied is %a", laws->stand->what, (double)inner,
                     (double)outer);
        if (laws->exact && outer != inner)
            fail_msg("%s: a carved box ends at %a, not at %a", laws->stand->what, (double)outer,
                     (double)inner);
    }
}

static struct box one_leaf(struct dual_laws *laws, const struct dual_seen *seen, uint32_t depth)
{
    const struct bvh *bvh = &laws->stand->bvh;
    assert_true(seen->first < bvh->prim_count);
    const uint32_t number = laws->leaf_of[seen->first];
    laws->leaf_of[seen->first] = UINT32_MAX;
    assert_true(number < bvh->node_count); /* it is there, and once */
    assert_int_equal(seen->count, bvh->node[number].item_count);
    laws->leaves++;
    laws->deepest = depth > laws->deepest ? depth : laws->deepest;
    laws->next = seen->next;
    return bvh->node[number].bounds;
}

/* Walks a node in its implied box; returns the box of all leaves below. */
static struct box all_below(struct dual_laws *laws, uint32_t at, struct box in, uint32_t depth)
{
    struct box own = box_empty(), upper;
    struct dual_seen seen = dual_look(&laws->stand->tree, at);
    uint32_t row = 0;
    assert_int_equal(at, laws->next);
    for (; seen.kind == DUAL_IS_CARVE; row++) {
        for (int i = 0; i < 2; i++) {
            float was = dual_bound(&in, seen.side[i]);
            bool repeats = i == 1 && seen.side[1] == seen.side[0];
            assert_true(repeats || (seen.side[i] < 3 ? seen.plane[i] > was : seen.plane[i] < was));
            assert_true(!repeats || seen.plane[0] == seen.plane[1]);
            in = dual_cut(in, seen.side[i], seen.plane[i]);
        }
        laws->carves++;
        seen = dual_look(&laws->stand->tree, seen.next);
    }
    assert_in_range(row, 0, 3);
    if (seen.kind == DUAL_IS_LEAF) {
        own = one_leaf(laws, &seen, depth);
        must_hold(laws, &in, &own);
        return own;
    }
    laws->splits++;
    laws->next = seen.at + 3;
    own = all_below(laws, seen.at + 3, dual_cut(in, seen.side[0], seen.plane[0]), depth + 1);
    assert_true(dual_bound(&own, seen.side[0]) == seen.plane[0]);
    upper = all_below(laws, seen.next, dual_cut(in, seen.side[1], seen.plane[1]), depth + 1);
    assert_true(dual_bound(&upper, seen.side[1]) == seen.plane[1]);
    box_add_box(&own, &upper);
    must_hold(laws, &in, &own);
    return own;
}

static void must_keep_laws(const struct dual_stand *s, enum dual_carving carving)
{
    const struct dual_tree *tree = &s->tree;
    struct dual_laws laws = {.stand = s,
                             .exact = carving == DUAL_ALL,
                             .leaf_of = calloc(s->bvh.prim_count, sizeof *laws.leaf_of)};
    struct dual_tree again;
    struct reason reason = {""};
    assert_non_null(laws.leaf_of);
    for (uint32_t i = 0; i < s->bvh.prim_count; i++)
        laws.leaf_of[i] = UINT32_MAX;
    for (uint32_t i = 0; i < s->bvh.node_count; i++)
        if (s->bvh.node[i].item_count > 0)
            laws.leaf_of[s->bvh.node[i].item_first] = i;
    all_below(&laws, 0, tree->box, 0);
    for (uint32_t i = 0; i < s->bvh.prim_count; i++)
        assert_int_equal(laws.leaf_of[i], UINT32_MAX);
    assert_int_equal(laws.next, tree->word_count);
    assert_int_equal(2 * laws.leaves - 1, s->bvh.node_count);
    assert_int_equal(tree->split_count, laws.leaves - 1);
    assert_int_equal(tree->leaf_count, laws.leaves);
    assert_int_equal(tree->carve_count, laws.carves);
    assert_int_equal(tree->depth, laws.deepest);
    assert_int_equal(dual_node_bytes(tree),
                     12 * (uint64_t)(laws.splits + laws.carves) + 8 * (uint64_t)laws.leaves);
    if (dual_check(tree, &s->packed, &s->scene, &reason))
        fail_msg("%s: %s", s->what, reason.text);
    assert_int_equal(dual_make(&s->packed, carving, &again, NULL), STATUS_OK);
    assert_int_equal(again.word_count, tree->word_count);
    assert_memory_equal(again.word, tree->word, dual_node_bytes(tree));
    dual_free(&again);
    free(laws.leaf_of);
}

static void trees_keep_their_laws(void **state)
{
    (void)state;
    for (size_t i = 0; i < DUAL_SCENES; i++)
        for (int carving = DUAL_BY_COST; carving <= DUAL_ALL; carving++) {
            struct dual_stand s = {.what = NULL};
            dual_stand_make(&s, i, (enum dual_carving)carving);
            must_keep_laws(&s, (enum dual_carving)carving);
            print_message("%-16s %5u leaves, %5u carvings, depth %2u, %5.1f bytes a triangle\n",
                          s.what, s.tree.leaf_count, s.tree.carve_count, s.tree.depth,
                          (double)dual_node_bytes(&s.tree) / s.scene.tri_count);
            dual_stand_free(&s);
        }
}

/* The trees of every builder, of split ones the leaves' boxes as well. */
static void every_builder_has_one(void **state)
{
    (void)state;
    uint32_t split = 0;
    for (size_t b = 0; builders_all[b]; b++) {
        struct dual_stand s = {.what = builders_all[b]->name};
        struct scene scene;
        if (builders_all[b]->faithful || builders_all[b]->compare) /* as published; a device's */
            continue;
        assert_int_equal(scene_open("needles:n=200", 3, &scene, NULL), STATUS_OK);
        dual_stand_of(&s, scene, builders_all[b]->name, DUAL_BY_COST);
        must_keep_laws(&s, DUAL_BY_COST);
        split += s.packed.split;
        dual_stand_free(&s);
    }
    assert_true(split > 0);
}

/* --- what is refused -------------------------------------------------------------------------- */

static void what_is_no_binary_tree_is_refused(void **state)
{
    (void)state;
    struct dual_stand s = {.what = "sphere"};
    struct scene scene;
    struct packed wide;
    struct dual_tree tree;
    struct reason reason = {""};
    assert_int_equal(scene_open("sphere:n=4", 1, &scene, NULL), STATUS_OK);
    dual_stand_of(&s, scene, "median", DUAL_BY_COST);
    assert_int_equal(packed_make(layout_find("cwbvh80"), &s.bvh, &s.scene, &wide, NULL), STATUS_OK);
    assert_int_equal(dual_make(&wide, DUAL_BY_COST, &tree, &reason), STATUS_UNSUPPORTED);
    assert_string_equal(reason.text, "cwbvh80: a dual-split tree needs a binary layout");
    uint32_t *snd = &s.packed.word[3], was = *snd; /* of the root: its second child */
    *snd = 0;
    assert_int_equal(dual_make(&s.packed, DUAL_BY_COST, &tree, &reason), STATUS_LIMIT);
    assert_string_equal(reason.text,
                        "f32: record 0 is reached more than once: a dual-split tree is made of a "
                        "tree");
    *snd = s.packed.node_count;
    assert_int_equal(dual_make(&s.packed, DUAL_BY_COST, &tree, &reason), STATUS_LIMIT);
    assert_string_equal(reason.text,
                        "f32: record 0 lacks a child: a dual-split tree is made of a tree");
    assert_true(!tree.word && tree.word_count == 0);
    *snd = was;
    packed_free(&wide);
    dual_stand_free(&s);
}

/* The root's box is taken to be smaller than its children: they are in it all the same. */
static void boxes_hold_what_is_below(void **state)
{
    (void)state;
    struct dual_stand s = {.what = "small root"};
    struct dual_tree tree;
    struct scene scene;
    assert_int_equal(scene_open("sphere:n=4", 1, &scene, NULL), STATUS_OK);
    dual_stand_of(&s, scene, "median", DUAL_BY_COST);
    const struct box whole = s.tree.box;
    for (uint32_t side = 0; side < 6; side++) { /* struct node_f32: lo, first, hi, count */
        uint32_t *word = &s.packed.word[side < 3 ? side : side + 1], was = *word;
        *word = float_bits(0.0f);
        assert_int_equal(dual_make(&s.packed, DUAL_BY_COST, &tree, NULL), STATUS_OK);
        assert_memory_equal(&tree.box, &whole, sizeof whole);
        assert_int_equal(dual_check(&tree, &s.packed, &s.scene, NULL), STATUS_OK);
        dual_free(&tree);
        *word = was;
    }
    dual_stand_free(&s);
}

static void published_layouts_are_refused(void **state)
{
    (void)state;
    const struct engine *engine = engine_find("dual_split");
    const struct engine_options options = {.threads = 1, .device = -1};
    struct dual_stand s = {.what = "sphere"};
    struct packed packed;
    struct scene scene;
    struct reason reason = {""};
    void *self;
    assert_int_equal(scene_open("sphere:n=4", 1, &scene, NULL), STATUS_OK);
    dual_stand_of(&s, scene, "median", DUAL_BY_COST);
    assert_int_equal(packed_make(layout_find("rtrs_rf"), &s.bvh, &s.scene, &packed, NULL),
                     STATUS_OK);
    const struct job job = {.scene = &s.scene, .packed = &packed, .tri = tri_test_find("woop")};
    assert_int_equal(engine_open(engine, &options, &self, NULL), STATUS_OK);
    assert_int_equal(engine->prepare(self, &job, &reason), STATUS_UNSUPPORTED);
    assert_string_equal(reason.text, "dual_split has no layout that loses hits, as rtrs_rf");
    for (size_t i = 0; layouts_all[i]; i++)
        assert_int_equal(engine_takes(engine, layouts_all[i]),
                         !layouts_all[i]->faithful && !layout_is_wide(layouts_all[i]));
    engine->close(self);
    packed_free(&packed);
    dual_stand_free(&s);
}

/* A tree of one level more than there may be, which no layout of the program packs. */
static void deeper_trees_are_refused(void **state)
{
    (void)state;
    struct dual_stand s = {.what = "deep"};
    struct dual_tree tree;
    struct reason reason = {""};
    dual_stand_make(&s, DUAL_SCENES - 1, DUAL_BY_COST);
    struct packed *packed = &s.packed;
    uint32_t last = packed->node_count - 1, leaf = last - 1;
    uint32_t *word = realloc(packed->word, 32 * (size_t)(packed->node_count + 2));
    assert_non_null(word);
    packed->word = word;
    memcpy(word + 8 * (size_t)(last + 1), word + 8 * (size_t)leaf, 64);
    word[8 * (size_t)last + 3] = last + 2; /* the last leaf has two children now */
    word[8 * (size_t)last + 7] = 0;
    packed->node_count += 2;
    packed->ref_count += 2;
    packed->word_count += 16;
    assert_int_equal(dual_make(packed, DUAL_BY_COST, &tree, &reason), STATUS_LIMIT);
    assert_non_null(strstr(reason.text, "a dual-split tree has at most 64 levels"));
    assert_null(tree.word);
    dual_stand_free(&s);
}

static void nothing_has_no_words(void **state)
{
    (void)state;
    const struct packed none = {.layout = layout_find("f32")};
    const struct scene empty = {0};
    struct dual_tree tree;
    assert_int_equal(dual_make(&none, DUAL_BY_COST, &tree, NULL), STATUS_OK);
    assert_true(!tree.word && tree.word_count == 0);
    assert_int_equal(dual_check(&tree, &none, &empty, NULL), STATUS_OK);
    dual_free(&tree);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trees_keep_their_laws),
        cmocka_unit_test(every_builder_has_one),
        cmocka_unit_test(what_is_no_binary_tree_is_refused),
        cmocka_unit_test(boxes_hold_what_is_below),
        cmocka_unit_test(published_layouts_are_refused),
        cmocka_unit_test(deeper_trees_are_refused),
        cmocka_unit_test(nothing_has_no_words),
    };
    return cmocka_run_group_tests_name("dual_tree", tests, NULL, NULL);
}
