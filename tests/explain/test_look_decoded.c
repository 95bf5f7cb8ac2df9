/* A tree that is only there packed: decoded it is the tree it was made from, or refused. */
#include "ref/look/look_decoded.h"
#include "ref/base/rng.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/faults.h"
#include "tests/support/trace_fixture.h"

static void a_packed_tree_decodes_to_the_tree_it_was_made_from(void **state)
{
    (void)state;
    static const char *const specs[] = {"soup:n=300", "terrain:k=4", "platonic"};
    for (size_t i = 0; i < ARRAY_COUNT(specs); i++)
        for (size_t l = 0; l < ARRAY_COUNT(repaired); l++) {
            struct scene scene = generated(specs[i]);
            struct subject s = subject_make(&scene, "median", 3, SEED_EPS, repaired[l]);
            struct bvh bvh;
            assert_int_equal(decoded_tree(&s.packed, &scene, &bvh, NULL), STATUS_OK);
            assert_int_equal(bvh.node_count, s.bvh.node_count);
            assert_memory_equal(bvh.prim, s.bvh.prim, scene.tri_count * sizeof *bvh.prim);
            for (uint32_t n = 0; n < bvh.node_count; n++) {
                const struct bvh_node *a = &bvh.node[n], *b = &s.bvh.node[n];
                assert_int_equal(a->fst, b->fst);
                assert_int_equal(a->snd, b->snd);
                assert_int_equal(a->item_count, b->item_count);
                assert_int_equal(a->item_first, b->item_first);
                assert_true(box_contains_box(&a->bounds, &b->bounds));
                assert_true(l > 0 || box_contains_box(&b->bounds, &a->bounds)); /* f32: the same */
            }
            bvh_free(&bvh);
            subject_free(&s);
            scene_free(&scene);
        }
}

static void what_decodes_to_no_tree_is_refused(void **state)
{
    (void)state;
    struct rng rng = rng_make(23, 0);
    struct scene scene = trees_grid(40);
    size_t refused = 0;
    for (size_t l = 0; layouts[l]; l++)
        for (int round = 0; round < 300; round++) {
            struct subject s =
                subject_of(&scene, trees_make(&scene, 4, TREES_BALANCED), layouts[l]->name);
            for (uint32_t i = 0; i < s.packed.word_count; i++)
                if (rng_below(&rng, 8) == 0)
                    s.packed.word[i] = (uint32_t)rng_u64(&rng) & (round % 2 ? 0x803F003F : ~0u);
            struct bvh bvh;
            struct reason reason = {""};
            if (decoded_tree(&s.packed, &scene, &bvh, &reason)) {
                refused++;
                assert_null(bvh.node);
                assert_non_null(strstr(reason.text, "do not decode to a tree"));
            } else {
                assert_int_equal(bvh_check_form(&bvh, &scene, NULL), STATUS_OK);
            }
            bvh_free(&bvh);
            subject_free(&s);
        }
    assert_true(refused > 900);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_packed_tree_decodes_to_the_tree_it_was_made_from),
        cmocka_unit_test(what_decodes_to_no_tree_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
