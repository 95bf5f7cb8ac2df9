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

/* A node that is another's child, too, or its own, and one that is not there. */
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
        cmocka_unit_test(what_is_no_tree_is_said),
        cmocka_unit_test(hostile_words_are_safe),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
