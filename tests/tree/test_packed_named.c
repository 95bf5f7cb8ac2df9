/* Laws of packed_check in every layout: its counts and the first fault that its text describes,
 * node, slot and numbers, are those that a walk of its own finds here. */
#include "tests/tree/packed_fixture.h"

#include "ref/packed/packed_walk.h"
#include "ref/store.h"
#include "scenes/scenes.h"

#include <stdio.h>

#define NODES_MOST 600u

/* A node in the order of a walk by levels, with all that names it. */
struct named_node {
    uint32_t ref, parent; /* parent: its index here */
    uint32_t child;       /* which of its parent's children */
    struct box box, exact;
    struct wide wide;
};

struct named_tree {
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    struct named_node node[NODES_MOST];
    uint32_t count;
};

static void tree_drop(struct named_tree *t)
{
    packed_free(&t->packed);
    bvh_free(&t->bvh);
    scene_free(&t->scene);
}

static void tree_make(struct named_tree *t, bool split, uint64_t seed)
{
    struct build_options options = {.leaf = split ? 8 : 3,
                                    .eps = BUILD_EPS_DEFAULT,
                                    .split_budget = split ? 3 : 0,
                                    .split_alpha = -1};
    struct reason reason = {""};
    for (bool made = false; !made; seed += 1000) {
        if (scene_open(split ? "needles:n=58" : "soup:n=40", seed, &t->scene, &reason) ||
            bvh_build(builder_find(split ? "sbvh" : "median"), &t->scene, &options, &t->bvh,
                      &reason))
            fail_msg("%s", reason.text);
        uint32_t full = 0;
        for (uint32_t i = 0; i < t->bvh.node_count; i++)
            full += t->bvh.node[i].item_count > 1;
        made = bvh_is_split(&t->bvh) == split && full > 1;
        if (!made)
            tree_drop(t);
    }
}

static void tree_pack(struct named_tree *t, const struct layout *layout)
{
    struct reason reason = {""};
    if (packed_make(layout, &t->bvh, &t->scene, &t->packed, &reason))
        fail_msg("%s", reason.text);
    t->count = 1;
    t->node[0] =
        (struct named_node){.ref = t->packed.root, .box = layout->box(&t->packed, t->packed.root)};
    for (uint32_t i = 0; i < t->count; i++) {
        struct named_node *node = &t->node[i];
        layout->load(&t->packed, node->ref, &node->wide);
        for (uint32_t c = 0; c < node->wide.child_count; c++) {
            assert_true(t->count < NODES_MOST);
            t->node[t->count++] = (struct named_node){
                .ref = node->wide.child[c], .parent = i, .child = c, .box = node->wide.box[c]};
        }
    }
}

static enum status check(const struct named_tree *t, struct packed_faults *faults,
                         struct reason *reason)
{
    reason->text[0] = 0;
    return packed_check(&t->packed, &t->scene, faults, reason);
}

/* --- names ------------------------------------------------------------------------------------ */

static bool is_leaf(const struct named_node *node)
{
    return node->wide.child_count == 0;
}

/* "record R", "record R, slot S" for leaves without a record, "reference N" in amd64. */
static void name_must_be(const struct named_tree *t, const struct named_node *node,
                         const char *text)
{
    const struct layout *layout = t->packed.layout;
    const struct named_node *parent = &t->node[node->parent];
    char record[60];
    unsigned slot = 0, at;
    int end = 0;
    bool own = strncmp(layout->name, "amd64", 5) == 0 && node->ref >= t->packed.node_count;
    (void)snprintf(record, sizeof record, own ? "reference %u" : "record %u", node->ref);
    if (own || !layout_is_wide(layout) || !is_leaf(node)) {
        assert_string_equal(text, record);
        return;
    }
    assert_true(sscanf(text, "record %u, slot %u%n", &at, &slot, &end) == 2 && !text[end]);
    assert_true(at == parent->ref && slot < layout->width && slot >= node->child);
    if (parent->wide.child_count == layout->width)
        assert_int_equal(slot, node->child);
}

/* "LAYOUT: NAME: RULE", NULL: without a name. */
static void text_must_be(const struct named_tree *t, const struct reason *reason,
                         const struct named_node *node, const char *rule)
{
    size_t length = strlen(t->packed.layout->name);
    const char *text = reason->text + length + 2;
    char name[64] = "";
    assert_memory_equal(reason->text, t->packed.layout->name, length);
    assert_memory_equal(reason->text + length, ": ", 2);
    if (node) {
        const char *end = strstr(text, ": ");
        assert_true(end && end < text + sizeof name);
        memcpy(name, text, (size_t)(end - text));
        name_must_be(t, node, name);
        text = end + 2;
    }
    assert_string_equal(text, rule);
}

/* --- laws ------------------------------------------------------------------------------------- */

static void names_tell_all_nodes_apart(void **state)
{
    (void)state;
    static struct named_tree t;
    uint32_t named = 0;
    for (size_t l = 0; layouts_all[l]; l++) {
        struct packed_name name[NODES_MOST];
        tree_make(&t, false, l);
        tree_pack(&t, layouts_all[l]);
        for (uint32_t i = 0; i < t.count; i++) {
            name[i] = packed_name(&t.packed, t.node[i].ref);
            name_must_be(&t, &t.node[i], name[i].text);
            for (uint32_t k = 0; k < i; k++)
                named += strcmp(name[i].text, name[k].text) == 0 && t.node[i].ref != t.node[k].ref;
        }
        assert_int_equal(named, 0);
        tree_drop(&t);
    }
}

/* Triangles named again, below `tris` of them: the first in the order of the walk is described. */
static void items_must_be_counted(const struct named_tree *t, uint32_t tris)
{
    struct packed_faults want = {0}, got;
    struct reason reason;
    const struct named_node *at = NULL;
    struct scene fewer = t->scene;
    uint32_t seen[60] = {0};
    char rule[100] = "";
    fewer.tri_count = tris;
    for (uint32_t i = 0; i < t->count; i++)
        for (uint32_t s = 0; s < t->node[i].wide.item_count && is_leaf(&t->node[i]); s++) {
            uint32_t prim = packed_item(&t->packed, &t->node[i].wide, s);
            bool bad = prim >= tris;
            bool twice = !bad && seen[prim] && (!t->packed.split || seen[prim] == i + 1);
            want.bad_prims += bad;
            want.double_prims += twice;
            if ((bad || twice) && !at) {
                at = &t->node[i];
                want.first = bad ? PACKED_ITEM : PACKED_TWICE;
                (void)snprintf(rule, sizeof rule,
                               bad ? "item slot %u names triangle %u of %u"
                                   : "item slot %u names triangle %u a second time",
                               at->wide.item_first + s, prim, tris);
            }
            if (!bad)
                seen[prim] = i + 1;
        }
    for (uint32_t prim = 0; prim < tris; prim++) {
        if (!seen[prim] && !want.first) {
            want.first = PACKED_LOST;
            (void)snprintf(rule, sizeof rule, "triangle %u is in no leaf", prim);
        }
        want.lost_prims += !seen[prim];
    }
    enum status status = packed_check(&t->packed, &fewer, &got, &reason);
    assert_true(status == STATUS_INPUT || (!status && !want.first));
    if (want.first) /* else a part of a triangle may be missing */
        assert_int_equal(got.first, want.first);
    assert_int_equal(got.bad_prims, want.bad_prims);
    assert_int_equal(got.double_prims, want.double_prims);
    assert_int_equal(got.lost_prims, want.lost_prims);
    if (want.first)
        text_must_be(t, &reason, at, rule);
}

/* Writes an item: into the storage, or in rf16 into half a word of its node. */
static void put_item(struct packed *packed, uint32_t slot, uint32_t prim)
{
    uint32_t shift = slot % 2 * 16, *word = packed->item ? &packed->item[slot] : NULL;
    if (word) {
        *word = prim;
        return;
    }
    assert_string_equal(packed->layout->name, "rf16");
    word = &packed->word[slot / 2];
    *word = (*word & ~(0xFFFFu << shift)) | prim << shift;
}

/* A random leaf of two items or more, but not `other`; NULL: there is none. */
static const struct named_node *full_leaf(const struct named_tree *t, struct rng *rng,
                                          const struct named_node *other)
{
    uint32_t at = rng_below(rng, t->count);
    for (uint32_t i = 0; i < t->count; i++, at = (at + 1) % t->count)
        if (is_leaf(&t->node[at]) && t->node[at].wide.item_count > 1 && &t->node[at] != other)
            return &t->node[at];
    return NULL;
}

/* Writes the triangle of one slot into another: of the same leaf, or of any other. */
static void name_again(struct named_tree *t, struct rng *rng, bool same_leaf)
{
    const struct named_node *from = full_leaf(t, rng, NULL);
    const struct named_node *to = same_leaf ? from : full_leaf(t, rng, from);
    if (!from || !to)
        return;
    uint32_t s = rng_below(rng, from->wide.item_count), d;
    do
        d = rng_below(rng, to->wide.item_count);
    while (same_leaf && d == s);
    put_item(&t->packed, to->wide.item_first + d, packed_item(&t->packed, &from->wide, s));
}

static void triangles_named_again_are_counted(void **state)
{
    (void)state;
    static struct named_tree t;
    struct rng rng = rng_make(17, 0);
    uint32_t twice[2] = {0, 0};
    for (size_t l = 0; layouts_all[l]; l++)
        for (uint32_t round = 0; round < 12 && !layouts_all[l]->faithful; round++) {
            struct packed_faults faults;
            struct reason reason;
            bool split = round % 2;
            tree_make(&t, split, 100 * l + round);
            tree_pack(&t, layouts_all[l]);
            for (uint32_t i = 0; i <= round % 3; i++)
                name_again(&t, &rng, round % 4 < 2 || i > 0);
            assert_int_equal(t.packed.split, split);
            items_must_be_counted(&t, round < 8 ? t.scene.tri_count : 37);
            (void)check(&t, &faults, &reason);
            twice[split] += faults.double_prims > 0;
            tree_drop(&t);
        }
    assert_true(twice[0] > 100 && twice[1] > 100);
}

/* Boxes against a scene in which a triangle has moved: the last in the order of the walk is
 * described, with its axis and bounds. */
static void boxes_must_be_counted(struct named_tree *t)
{
    struct packed_faults got;
    struct reason reason;
    uint32_t loose = 0;
    int of = 0;
    const struct named_node *at = NULL;
    char rule[200] = "";
    for (uint32_t i = t->count; i-- > 0;) {
        struct named_node *node = &t->node[i];
        int axis = 3;
        node->exact = box_empty();
        for (uint32_t k = i + 1; k < t->count; k++)
            if (t->node[k].parent == i)
                box_add_box(&node->exact, &t->node[k].exact);
        for (uint32_t s = 0; s < node->wide.item_count && is_leaf(node); s++) {
            uint32_t prim = packed_item(&t->packed, &node->wide, s);
            struct box one = scene_tri_bounds(&t->scene, prim);
            box_add_box(&node->exact, &one);
        }
        for (int k = 2; k >= 0; k--)
            if (node->exact.lo[k] < node->box.lo[k] || node->exact.hi[k] > node->box.hi[k])
                axis = k;
        loose += axis < 3;
        if (axis < 3 && !at) {
            at = node;
            of = axis;
        }
    }
    assert_non_null(at);
    (void)snprintf(rule, sizeof rule, "%c bounds [%a, %a] do not contain [%a, %a] below", "xyz"[of],
                   (double)at -> box.lo[of], (double)at->box.hi[of], (double)at->exact.lo[of],
                   (double)at->exact.hi[of]);
    assert_int_equal(check(t, &got, &reason), STATUS_INPUT);
    assert_int_equal(got.first, PACKED_BOUND);
    /* Oriented boxes are counted, too (tests/layouts/test_explain_oriented.c). */
    const bool oriented = strstr(reason.text, "its oriented box does not contain") != NULL;
    assert_true(oriented ? got.loose_boxes > loose : got.loose_boxes >= loose);
    assert_true(got.loose_boxes == loose || t->packed.layout->oblique);
    if (!oriented)
        text_must_be(t, &reason, at, rule);
}

static void loose_boxes_are_counted(void **state)
{
    (void)state;
    static struct named_tree t;
    struct rng rng = rng_make(18, 0);
    for (size_t l = 0; layouts_all[l]; l++)
        for (uint32_t round = 0; round < 8 && !layouts_all[l]->faithful; round++) {
            tree_make(&t, false, 100 * l + round);
            tree_pack(&t, layouts_all[l]);
            for (uint32_t i = 0; i <= round % 3; i++) {
                uint32_t k = rng_below(&rng, 9 * t.scene.tri_count);
                t.scene.vertex[k] += round % 2 ? 300 : -300;
            }
            boxes_must_be_counted(&t);
            tree_drop(&t);
        }
}

/* Parts of triangles in no leaf of a split tree: the text's number is the count. */
static void lost_parts_are_counted(void **state)
{
    (void)state;
    static struct named_tree t;
    for (size_t l = 0; layouts_all[l]; l++)
        for (uint32_t moved = 1; moved < 4 && !layouts_all[l]->faithful; moved++) {
            struct packed_faults got;
            struct reason reason;
            unsigned prim, parts;
            int end = 0;
            tree_make(&t, true, 100 * l + moved);
            tree_pack(&t, layouts_all[l]);
            for (uint32_t i = 0; i < moved; i++) /* wholly outside */
                for (uint32_t k = 0; k < 9; k++)
                    t.scene.vertex[9 * (7 * i + 3) + k] += 1e4f;
            assert_int_equal(check(&t, &got, &reason), STATUS_INPUT);
            const char *text = strstr(reason.text, "a part of ");
            assert_non_null(text);
            assert_int_equal(sscanf(text,
                                    "a part of triangle %u is in no leaf's box below; %u triangles "
                                    "have such parts%n",
                                    &prim, &parts, &end),
                             2);
            assert_true(text[end] == 0 && prim % 7 == 3 && prim / 7 < moved);
            assert_true(parts == moved && got.loose_boxes >= moved);
            assert_true(got.loose_boxes == moved || layouts_all[l]->oblique);
            assert_int_equal(got.first, PACKED_BOUND);
            tree_drop(&t);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_tell_all_nodes_apart),
        cmocka_unit_test(triangles_named_again_are_counted),
        cmocka_unit_test(loose_boxes_are_counted),
        cmocka_unit_test(lost_parts_are_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
