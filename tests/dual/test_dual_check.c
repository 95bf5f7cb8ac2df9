/* What dual_check must find, and may be given. */
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

static enum status checked(const struct dual_stand *s)
{
    return dual_check(&s->tree, &s->packed, &s->scene, NULL);
}

/* Planes lie on the boxes of leaves: one step inward cuts a box, one outward none. */
static void must_miss_no_step(struct dual_stand *s, const struct dual_seen *seen)
{
    for (int i = 0; i < 2; i++) {
        uint32_t *word = &s->tree.word[seen->at + 1 + (uint32_t)i], was = *word;
        bool lower = seen->side[i] < 3;
        *word = float_bits(nextafterf(seen->plane[i], lower ? INFINITY : -INFINITY));
        assert_int_equal(checked(s), STATUS_INPUT);
        *word = float_bits(nextafterf(seen->plane[i], lower ? -INFINITY : INFINITY));
        assert_int_equal(checked(s), STATUS_OK);
        *word = was;
    }
}

static void must_miss_no_bit(struct dual_stand *s, uint32_t at, uint32_t first_bit)
{
    for (uint32_t bit = first_bit; bit < 32; bit++) {
        s->tree.word[at] ^= 1u << bit;
        assert_int_equal(checked(s), STATUS_INPUT);
        s->tree.word[at] ^= 1u << bit;
    }
}

static void no_wrong_word_is_missed(void **state)
{
    (void)state;
    for (size_t i = 0; i < 2; i++) {
        struct dual_stand s = {.what = i ? "needles" : "sphere"};
        struct scene scene;
        uint32_t at = 0, kinds[3] = {0};
        assert_int_equal(scene_open(i ? "needles:n=60" : "sphere:n=4", 1, &scene, NULL), STATUS_OK);
        dual_stand_of(&s, scene, "median", DUAL_BY_COST);
        assert_int_equal(checked(&s), STATUS_OK);
        while (at < s.tree.word_count) {
            const struct dual_seen seen = dual_look(&s.tree, at);
            kinds[seen.kind]++;
            at += seen.kind == DUAL_IS_LEAF ? 2 : 3;
            if (seen.kind == DUAL_IS_LEAF) {
                must_miss_no_bit(&s, seen.at, 3);
                must_miss_no_bit(&s, seen.at + 1, 0);
                continue;
            }
            must_miss_no_step(&s, &seen);
            if (seen.kind == DUAL_IS_SPLIT)
                must_miss_no_bit(&s, seen.at, 2);
        }
        assert_true(kinds[0] > 5 && kinds[1] > 2 && kinds[2] > 5);
        for (s.tree.word_count--; s.tree.word_count > 0; s.tree.word_count--)
            assert_int_equal(checked(&s), STATUS_INPUT);
        assert_int_equal(checked(&s), STATUS_INPUT);
        dual_stand_free(&s);
    }
}

/* Copies of a triangle: a leaf is in every other one's box, so that only its name tells it. */
static void leaves_are_there_once(void **state)
{
    static const float v[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 2}};
    (void)state;
    struct dual_stand s = {.what = "copies", .scene = trees_copies(16, v)};
    uint32_t *leaf[16], leaves = 0;
    s.bvh = trees_make(&s.scene, 2, TREES_BALANCED);
    dual_stand_pack(&s, DUAL_BY_COST);
    for (uint32_t at = 0; at < s.tree.word_count;) {
        const struct dual_seen seen = dual_look(&s.tree, at);
        at += seen.kind == DUAL_IS_LEAF ? 2 : 3;
        if (seen.kind == DUAL_IS_LEAF)
            leaf[leaves++] = &s.tree.word[seen.at + 1];
    }
    assert_int_equal(leaves, 8);
    for (uint32_t i = 0; i < leaves; i++)
        for (uint32_t j = 0; j < leaves; j++) {
            uint32_t was = *leaf[i];
            *leaf[i] = *leaf[j];
            assert_int_equal(checked(&s), i == j ? STATUS_OK : STATUS_INPUT);
            *leaf[i] = was;
        }
    dual_stand_free(&s);
}

static void any_words_are_checked(void **state)
{
    (void)state;
    struct dual_stand s = {.what = "words"};
    struct rng rng = rng_make(4, 4);
    struct scene scene;
    assert_int_equal(scene_open("sphere:n=4", 1, &scene, NULL), STATUS_OK);
    dual_stand_of(&s, scene, "median", DUAL_ALL);
    for (uint32_t n = 0; n < 100000; n++) {
        uint32_t word[40];
        struct dual_tree tree = s.tree;
        tree.word = word;
        tree.word_count = 1 + rng_below(&rng, ARRAY_COUNT(word));
        for (uint32_t i = 0; i < tree.word_count; i++) {
            static const uint32_t head[] = {3, 7, 0, 1, 2};
            word[i] = rng_below(&rng, 2) ? head[rng_below(&rng, 5)] : (uint32_t)rng_u64(&rng);
            word[i] |= rng_below(&rng, 40) << 2 & (rng_below(&rng, 2) ? 0xFFu : 0);
        }
        assert_int_equal(
            checked(&(struct dual_stand){.tree = tree, .packed = s.packed, .scene = s.scene}),
            STATUS_INPUT);
    }
    dual_stand_free(&s);
}

/* What a tree counts is counted again: no number of it may be any other. */
static void no_wrong_count_is_missed(void **state)
{
    (void)state;
    for (size_t i = 0; i < DUAL_SCENES; i++) {
        struct dual_stand s;
        memset(&s, 0, sizeof s);
        dual_stand_make(&s, i, i % 2 ? DUAL_ALL : DUAL_BY_COST);
        uint32_t *const count[] = {&s.tree.split_count, &s.tree.carve_count, &s.tree.leaf_count,
                                   &s.tree.depth};
        assert_int_equal(checked(&s), STATUS_OK);
        for (size_t k = 0; k < ARRAY_COUNT(count); k++) {
            const uint32_t was = *count[k];
            *count[k] = was - 1;
            assert_int_equal(checked(&s), STATUS_INPUT);
            *count[k] = was ^ 1u << 20;
            assert_int_equal(checked(&s), STATUS_INPUT);
            *count[k] = was;
        }
        dual_stand_free(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_wrong_word_is_missed),
        cmocka_unit_test(no_wrong_count_is_missed),
        cmocka_unit_test(leaves_are_there_once),
        cmocka_unit_test(any_words_are_checked),
    };
    return cmocka_run_group_tests_name("dual_check", tests, NULL, NULL);
}
