/* What cannot be refitted (ref/packed/refit.h): other scenes and words that are no tree are said,
 * and left as they are. */
#include "ref/packed/refit.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/tree/moved.h"
#include "ref/store.h"

#include <stdio.h>
#include <string.h>

static struct bvh build(const char *builder, const struct scene *scene, uint32_t leaf)
{
    struct build_options options = {.leaf = leaf, .eps = BUILD_EPS_DEFAULT};
    struct bvh bvh;
    struct reason reason = {""};
    if (bvh_build(builder_find(builder), scene, &options, &bvh, &reason))
        fail_msg("%s", reason.text);
    return bvh;
}

static void other_scenes_are_refused(void **state)
{
    (void)state;
    struct scene scene = built_soup(20, 2), fewer = built_soup(19, 2), more = built_soup(21, 2);
    struct bvh bvh = build("median", &scene, 2);
    struct packed packed, empty = {0};
    struct reason reason = {""};
    assert_int_equal(packed_make(layout_find("cwbvh80"), &bvh, &scene, &packed, NULL), STATUS_OK);
    struct snapshot before = snapshot(&packed);
    assert_int_equal(packed_refit(&packed, &fewer, &reason), STATUS_INPUT);
    assert_int_equal(bvh_refit(&bvh, &fewer, &reason), STATUS_INPUT);
    assert_int_equal(packed_refit(&packed, &more, &reason), STATUS_INPUT);
    assert_int_equal(bvh_refit(&bvh, &more, &reason), STATUS_INPUT);
    for (uint32_t i = 0; i < 9 * 20; i++) {
        float was = scene.vertex[i];
        scene.vertex[i] = i % 2 ? NAN : -INFINITY;
        assert_int_equal(packed_refit(&packed, &scene, &reason), STATUS_INPUT);
        assert_non_null(strstr(reason.text, "has a vertex that is not finite"));
        assert_true(same_as(&packed, &before));
        scene.vertex[i] = was;
    }
    struct scene none = {0};
    struct bvh nothing = {0};
    assert_int_equal(packed_make(layout_find("f32"), &nothing, &none, &empty, NULL), STATUS_OK);
    assert_int_equal(packed_refit(&empty, &none, &reason), STATUS_OK);
    drop(&before);
    packed_free(&packed);
    bvh_free(&bvh);
    scene_free(&scene);
    scene_free(&fewer);
    scene_free(&more);
}

/* Fails with exactly this text, and changes nothing. */
static void must_say(struct packed *packed, const struct scene *scene, enum status expected,
                     const char *format, ...) PRINTF_LIKE(4, 5);

static void must_say(struct packed *packed, const struct scene *scene, enum status expected,
                     const char *format, ...)
{
    struct snapshot before = snapshot(packed);
    struct reason reason = {""};
    char text[300];
    va_list args;
    va_start(args, format);
    (void)vsnprintf(text, sizeof text, format, args);
    va_end(args);
    assert_int_equal(packed_refit(packed, scene, &reason), expected);
    assert_string_equal(reason.text, text);
    assert_true(same_as(packed, &before));
    drop(&before);
}

static void refusals_give_numbers_of_the_scene(void **state)
{
    (void)state;
    struct scene scene = built_soup(20, 2), fewer = built_soup(17, 2);
    struct bvh bvh = build("median", &scene, 2);
    for (size_t l = 0; layouts_all[l]; l++) {
        const struct layout *layout = layouts_all[l];
        struct packed packed;
        struct reason reason = {""};
        if (layout->faithful)
            continue;
        assert_int_equal(packed_make(layout, &bvh, &scene, &packed, &reason), STATUS_OK);
        if (!layout->rebound) {
            must_say(&packed, &scene, STATUS_LIMIT, "rebuild: layout %s is not refitted",
                     layout->name);
            packed_free(&packed);
            continue;
        }
        must_say(&packed, &fewer, STATUS_INPUT, "%s: the tree holds 20 triangles, the scene has 17",
                 layout->name);
        for (uint32_t i = 0; i < 9 * 20; i += 7) {
            float was = scene.vertex[i];
            scene.vertex[i] = i % 2 ? NAN : -INFINITY;
            must_say(&packed, &scene, STATUS_INPUT,
                     "%s: triangle %u has a vertex that is not finite", layout->name, i / 9);
            scene.vertex[i] = was;
        }
        packed_free(&packed);
    }
    assert_int_equal(bvh_refit(&bvh, &fewer, NULL), STATUS_INPUT);
    struct reason reason = {""};
    assert_int_equal(bvh_refit(&bvh, &fewer, &reason), STATUS_INPUT);
    assert_string_equal(reason.text, "the tree holds 20 triangles, the scene has 17");
    bvh_free(&bvh);
    scene_free(&scene);
    scene_free(&fewer);
}

/* Each record of f32: word 3 is its second child or first item, word 7 its number of items. */
static void refusals_name_the_record(void **state)
{
    (void)state;
    struct scene scene = trees_grid(32);
    struct bvh bvh = build("median", &scene, 2);
    struct packed packed;
    assert_int_equal(packed_make(layout_find("f32"), &bvh, &scene, &packed, NULL), STATUS_OK);
    uint32_t leaves = 0;
    for (uint32_t n = 0; n < packed.node_count; n++) {
        uint32_t *second = &packed.word[8 * n + 3], *count = &packed.word[8 * n + 7];
        uint32_t was = *second, items = *count;
        leaves += items > 0;
        *second = packed.node_count + n;
        if (items == 0) { /* one child is dropped */
            must_say(&packed, &scene, STATUS_INPUT, "f32: record %u: the words are not a tree", n);
            *second = n;
            must_say(&packed, &scene, STATUS_INPUT, "f32: record %u: the words are not a tree", n);
        }
        *second = was;
        if (items > 0) {
            *count = 33 + n;
            must_say(&packed, &scene, STATUS_INPUT,
                     "f32: record %u: a leaf of %u items for 32 triangles", n, 33 + n);
            *count = items;
            *second = packed.item_count + 5; /* no items there */
            must_say(&packed, &scene, STATUS_INPUT, "f32: record %u is a leaf without triangles",
                     n);
            *second = was;
            packed.item[was + items - 1] = 32 + n;
            must_say(&packed, &scene, STATUS_INPUT, "f32: record %u names triangle %u of 32", n,
                     32 + n);
            packed.item[was + items - 1] = bvh.prim[was + items - 1];
        }
        *second = was;
        *count = items;
    }
    assert_int_equal(leaves, 16);
    assert_int_equal(packed_refit(&packed, &scene, NULL), STATUS_OK);
    packed_free(&packed);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* Corners that were one vertex of a compact leaf and are several now: three words each. */
static void refusals_count_the_words_of_a_leaf(void **state)
{
    (void)state;
    static const float one[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    for (uint32_t moved = 1; moved <= 6; moved++)
        for (uint32_t leaf = 0; leaf < 3; leaf++) { /* of four triangles, all on one another */
            struct scene copies = trees_copies(12, one), scene = trees_grid(12);
            struct bvh bvh;
            struct packed packed;
            for (uint32_t i = 0; i < 36; i++)
                for (uint32_t k = 0; k < 3; k++)
                    scene.vertex[3 * i + k] = copies.vertex[3 * (i % 3) + k];
            bvh = trees_make(&scene, 4, TREES_BALANCED);
            assert_int_equal(packed_make_stored(layout_find("f32"), tri_store_find("compact"), &bvh,
                                                &scene, &packed, NULL),
                             STATUS_OK);
            assert_int_equal(packed_refit(&packed, &scene, NULL), STATUS_OK);
            for (uint32_t i = 0; i < moved; i++)
                scene.vertex[36 * leaf + 3 * i + 2] = (float)(1 + i);
            uint32_t vertices = moved + 3; /* all four triangles had the same three */
            must_say(&packed, &scene, STATUS_LIMIT,
                     "rebuild: storage compact: the leaf of triangle %u needs %u words, it has %u",
                     4 * leaf, 3 + 3 * vertices + 4, 3 + 3 * 3 + 4);
            packed_free(&packed);
            bvh_free(&bvh);
            scene_free(&scene);
            scene_free(&copies);
        }
}

/* A node that is another's child, too, or its own, and one that is not there. */
/* Eight triangles on one another that move apart have more vertices than a leaf can hold, and are
 * beyond the scene's grid. */
static void refusals_of_a_storage_are_those_of_packing(void **state)
{
    (void)state;
    static const char *const store[] = {"compact", "quantised"};
    static const char *const text[] = {
        "rebuild: storage compact: a leaf's triangles have at most 16 vertices, those of triangle "
        "%u and the 7 beside it have more; use --leaf 5 or less",
        "rebuild: storage quantised is of one scene's grid"};
    for (uint32_t s = 0; s < ARRAY_COUNT(store); s++)
        for (uint32_t leaf = 0; leaf < 3; leaf++) {
            struct scene scene = trees_grid(24);
            struct packed packed;
            struct reason reason = {""};
            for (uint32_t i = 0; i < 216; i++)
                scene.vertex[i] = (i % 9 == 3 || i % 9 == 7) ? 64.0f : 0.0f;
            struct bvh bvh = trees_make(&scene, 8, TREES_BALANCED);
            if (packed_make_stored(layout_find("f32"), tri_store_find(store[s]), &bvh, &scene,
                                   &packed, &reason))
                fail_msg("%s", reason.text);
            for (uint32_t i = 0; i < 24; i++)
                scene.vertex[72 * leaf + 3 * i] = (float)(1 + i);
            if (s == 0)
                must_say(&packed, &scene, STATUS_LIMIT, text[0], 8 * leaf);
            else
                must_say(&packed, &scene, STATUS_LIMIT, "%s", text[1]);
            packed_free(&packed);
            bvh_free(&bvh);
            scene_free(&scene);
        }
}

static void what_is_no_tree_is_said(void **state)
{
    (void)state;
    struct scene scene = trees_grid(32);
    struct bvh bvh = build("median", &scene, 2);
    for (size_t i = 0; i < 3; i++) {
        struct packed packed;
        struct reason reason = {""};
        assert_int_equal(packed_make(layout_find("f32"), &bvh, &scene, &packed, NULL), STATUS_OK);
        struct wide root;
        packed.layout->load(&packed, packed.root, &root);
        if (i == 0) /* word 3 of a node's eight is its second child */
            packed.word[8 * root.child[1] + 3] = root.child[0];
        else
            packed.word[8 * packed.root + 3] = i == 1 ? packed.root : packed.node_count;
        struct snapshot before = snapshot(&packed);
        enum status status = packed_refit(&packed, &scene, &reason);
        if (status != STATUS_INPUT || !strstr(reason.text, "the words are not a tree"))
            fail_msg("%zu: status %d, %s", i, status, reason.text);
        assert_true(same_as(&packed, &before));
        drop(&before);
        packed_free(&packed);
    }
    bvh_free(&bvh);
    scene_free(&scene);
}

/* Wide nodes may have one child, but not none. */
static void a_node_without_children_is_no_tree(void **state)
{
    (void)state;
    struct scene scene = trees_grid(32);
    struct bvh bvh = build("median", &scene, 2);
    uint32_t refused = 0, wide = 0;
    for (size_t l = 0; layouts_all[l]; l++) {
        struct packed packed;
        struct reason reason = {""};
        struct wide root;
        if (!layout_is_wide(layouts_all[l]) || !layouts_all[l]->rebound)
            continue;
        wide++;
        assert_int_equal(packed_make(layouts_all[l], &bvh, &scene, &packed, NULL), STATUS_OK);
        memset(packed.word, 0, packed.word_count * sizeof *packed.word);
        packed.layout->load(&packed, packed.root, &root);
        enum status status = packed_refit(&packed, &scene, &reason);
        if (root.child_count == 0) {
            refused++;
            assert_int_equal(status, STATUS_INPUT);
            assert_non_null(strstr(reason.text, "the words are not a tree"));
        }
        packed_free(&packed);
    }
    printf("%u of %u wide layouts read zeros as a node without children\n", refused, wide);
    assert_true(refused > 0);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* Words that are no tree: said, or refitted to something; nothing outside is touched (sanitize). */
static void hostile_words_are_safe(void **state)
{
    (void)state;
    struct scene scene = built_soup(40, 4);
    struct bvh bvh = build("median", &scene, 3);
    struct rng rng = rng_make(3, 3);
    for (size_t l = 0; layouts_all[l]; l++)
        for (int round = 0; round < 60; round++) {
            const struct tri_store *store = tri_stores[round % 5];
            struct packed packed;
            if (packed_make_stored(layouts_all[l], store, &bvh, &scene, &packed, NULL))
                continue;
            for (uint32_t flips = 1 + rng_below(&rng, 3); flips > 0; flips--) {
                bool item = packed.item && rng_below(&rng, 2);
                uint32_t *word = item ? packed.item : packed.word;
                word[rng_below(&rng, item ? packed.item_count : packed.word_count)] ^=
                    1u << rng_below(&rng, 32);
            }
            (void)!packed_refit(&packed, &scene, NULL);
            packed_free(&packed);
        }
    bvh_free(&bvh);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(other_scenes_are_refused),
        cmocka_unit_test(refusals_give_numbers_of_the_scene),
        cmocka_unit_test(refusals_name_the_record),
        cmocka_unit_test(refusals_count_the_words_of_a_leaf),
        cmocka_unit_test(refusals_of_a_storage_are_those_of_packing),
        cmocka_unit_test(what_is_no_tree_is_said),
        cmocka_unit_test(a_node_without_children_is_no_tree),
        cmocka_unit_test(hostile_words_are_safe),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
