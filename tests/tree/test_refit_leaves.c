/* Leaves under refit: the fewest triangles, words that name none, leaves at one place, and what a
 * storage of vertices must not hide: a bound beyond the layout's numbers. */
#include "ref/packed/packed_walk.h"
#include "ref/packed/refit.h"
#include "ref/store.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

#include "tests/tree/moved.h"

static struct bvh build(const struct scene *scene, uint32_t leaf)
{
    struct build_options options = {.leaf = leaf, .eps = BUILD_EPS_DEFAULT};
    struct bvh bvh;
    struct reason reason = {""};
    if (bvh_build(builder_find("median"), scene, &options, &bvh, &reason))
        fail_msg("%s", reason.text);
    return bvh;
}

/* Whether the layout can be refitted and takes this tree in that storage. */
static bool takes(size_t layout, size_t store, const struct bvh *bvh, const struct scene *scene,
                  struct packed *packed)
{
    return layouts_all[layout]->rebound &&
           packed_make_stored(layouts_all[layout], tri_stores[store], bvh, scene, packed, NULL) ==
               0;
}

/* Also where a leaf has more slots than the scene has triangles. */
static void the_smallest_trees_stay_as_they_are(void **state)
{
    (void)state;
    uint32_t played = 0;
    for (uint32_t count = 1; count <= 9; count++)
        for (uint32_t leaf = 1; leaf <= 8; leaf++) {
            struct scene scene = built_soup(count, 7);
            struct bvh bvh = build(&scene, leaf);
            for (size_t l = 0; layouts_all[l]; l++)
                for (size_t s = 0; tri_stores[s]; s++) {
                    struct packed packed;
                    struct reason reason = {""};
                    if (tri_stores[s]->lossy || !takes(l, s, &bvh, &scene, &packed))
                        continue;
                    struct snapshot before = snapshot(&packed);
                    if (packed_refit(&packed, &scene, &reason))
                        fail_msg("%s", reason.text);
                    assert_true(same_as(&packed, &before));
                    drop(&before);
                    packed_free(&packed);
                    played++;
                }
            bvh_free(&bvh);
            scene_free(&scene);
        }
    assert_true(played > 72 * 50);
}

/* Every item of every leaf, by the name of the leaf: those of a wide node have no record. */
static void refusals_name_the_leaf(void **state)
{
    (void)state;
    struct scene scene = built_soup(60, 8);
    struct bvh bvh = build(&scene, 3);
    uint32_t wide_leaves = 0;
    for (size_t l = 0; layouts_all[l]; l++) {
        struct packed packed;
        struct packed_walk walk;
        if (layouts_all[l]->item || !takes(l, 0, &bvh, &scene, &packed))
            continue;
        assert_int_equal(packed_walk_make(&packed, &walk), STATUS_OK);
        for (uint32_t i = 0; i < walk.visit_count; i++) {
            struct wide leaf;
            packed.layout->load(&packed, walk.visit[i].ref, &leaf);
            for (uint32_t s = 0; s < leaf.item_count && leaf.child_count == 0; s++) {
                uint32_t *item = &packed.item[leaf.item_first + s], was = *item;
                struct reason reason = {""};
                char text[200];
                *item = 100 + i;
                snprintf(text, sizeof text, "%s: %s names triangle %u of 60", packed.layout->name,
                         packed_name(&packed, walk.visit[i].ref).text, 100 + i);
                assert_int_equal(packed_refit(&packed, &scene, &reason), STATUS_INPUT);
                assert_string_equal(reason.text, text);
                *item = was;
                wide_leaves += layout_is_wide(packed.layout);
            }
        }
        packed_walk_free(&walk);
        packed_free(&packed);
    }
    assert_true(wide_leaves > 60 * 5);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* A refit fails in every storage or in none, and then leaves the words alone. */
static void no_storage_hides_a_limit(void **state)
{
    (void)state;
    struct scene scene = built_soup(60, 8);
    struct bvh bvh = build(&scene, 3);
    uint32_t refused = 0, played = 0;
    for (int motion = EXPLODED; motion <= BEYOND_HALVES; motion++) {
        struct scene moved = moved_by(&scene, (enum motion)motion, 1);
        for (size_t l = 0; layouts_all[l]; l++) {
            enum status first = STATUS_OK;
            for (size_t s = 0; tri_stores[s]; s++) {
                struct packed packed;
                if (tri_stores[s]->lossy || !takes(l, s, &bvh, &scene, &packed))
                    continue;
                struct snapshot before = snapshot(&packed);
                enum status status = packed_refit(&packed, &moved, NULL);
                first = s ? first : status;
                assert_int_equal(status, first);
                if (status)
                    assert_true(same_as(&packed, &before));
                refused += status == STATUS_LIMIT;
                played++;
                drop(&before);
                packed_free(&packed);
            }
        }
        scene_free(&moved);
    }
    print_message("%u of %u refused\n", refused, played);
    assert_true(refused > 100 && played > 2 * refused);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* Words of which two leaves have the same vertices: each is written once more, to the same. */
static void leaves_may_be_at_one_place(void **state)
{
    (void)state;
    struct scene scene = trees_grid(32);
    struct bvh bvh = build(&scene, 2);
    struct packed packed;
    struct reason reason = {""};
    assert_int_equal(packed_make_stored(layout_find("f32"), tri_store_find("compact"), &bvh, &scene,
                                        &packed, NULL),
                     STATUS_OK);
    for (uint32_t a = 0; a < packed.node_count; a++)
        for (uint32_t b = 0; b < packed.node_count; b++) {
            /* Word 3 of a record of f32 is the leaf's first word, word 7 its number of items. */
            uint32_t *one = &packed.word[8 * a], *two = &packed.word[8 * b], was[8];
            if (one[7] == 0 || two[7] == 0)
                continue;
            memcpy(was, two, sizeof was);
            two[3] = one[3], two[7] = one[7];
            uint32_t *item = copied(packed.item, packed.item_count);
            if (packed_refit(&packed, &scene, &reason))
                fail_msg("%s", reason.text);
            one = &packed.word[8 * a], two = &packed.word[8 * b];
            assert_memory_equal(one, two, sizeof was);
            assert_memory_equal(item, packed.item, 4 * (size_t)packed.item_count);
            free(item);
            memcpy(two, was, sizeof was);
            assert_int_equal(packed_refit(&packed, &scene, NULL), STATUS_OK);
        }
    packed_free(&packed);
    bvh_free(&bvh);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_smallest_trees_stay_as_they_are),
        cmocka_unit_test(refusals_name_the_leaf),
        cmocka_unit_test(no_storage_hides_a_limit),
        cmocka_unit_test(leaves_may_be_at_one_place),
    };
    return cmocka_run_group_tests_name("refit_leaves", tests, NULL, NULL);
}
