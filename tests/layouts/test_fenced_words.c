/* Readers of packed trees at the end of memory (tests/support/fence.h): of sound words and of any
 * others nothing behind them is read. */
#include "ref/packed/packed_check.h"
#include "ref/packed/packed_walk.h"
#include "ref/store.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "tests/support/built.h"
#include "tests/support/fence.h"

/* Every node and item that can be reached, and every reference, whether one can reach it or not. */
static void read_all(const struct packed *packed)
{
    struct packed_walk walk;
    assert_int_equal(packed_walk_make(packed, &walk), STATUS_OK);
    for (uint32_t i = 0; i < walk.visit_count; i++) {
        struct wide node;
        packed->layout->load(packed, walk.visit[i].ref, &node);
        for (uint32_t s = 0; s < node.item_count && s < 20 && node.child_count == 0; s++) {
            float v[3][3];
            (void)packed_item(packed, &node, s);
            if (packed->store->tri)
                (void)packed->store->tri(packed, node.item_first, s, v);
        }
    }
    packed_walk_free(&walk);
    for (uint32_t ref = 0; ref < packed->ref_count; ref++) {
        struct wide node;
        packed->layout->load(packed, ref, &node);
        (void)packed->layout->box(packed, ref);
    }
}

static void check(const struct packed *from, const struct scene *scene, struct rng *rng)
{
    struct fence word = fence_make(from->word, from->word_count);
    struct fence item = fence_make(from->item, from->item ? from->item_count : 0);
    struct packed packed = *from;
    packed.word = word.word;
    packed.item = from->item ? item.word : NULL;
    read_all(&packed);
    for (int round = 0; round < 30; round++) {
        uint32_t *at[3], was[3];
        for (int i = 0; i < 3; i++) {
            bool in_item = packed.item && rng_below(rng, 2);
            uint32_t count = in_item ? packed.item_count : packed.word_count;
            /* The last words above all. */
            uint32_t place = rng_below(rng, 2)
                                 ? rng_below(rng, count)
                                 : count - 1 - rng_below(rng, count < 24 ? count : 24);
            at[i] = (in_item ? packed.item : packed.word) + place;
            was[i] = *at[i];
            *at[i] = rng_below(rng, 2) ? *at[i] ^ 1u << rng_below(rng, 32) : (uint32_t)rng_u64(rng);
        }
        read_all(&packed);
        (void)!packed_check(&packed, scene, NULL, NULL);
        for (int i = 3; i-- > 0;)
            *at[i] = was[i];
    }
    fence_free(&word);
    fence_free(&item);
}

static void nothing_behind_the_words_is_read(void **state)
{
    (void)state;
    struct rng rng = rng_make(4, 4);
    uint32_t played = 0;
    for (uint32_t count = 1; count <= 40; count += 1 + count / 4) {
        struct scene scene = built_soup(count, count);
        const struct build_options options = {.leaf = 1 + count % 4, .eps = BUILD_EPS_DEFAULT};
        struct bvh bvh;
        assert_int_equal(bvh_build(builder_find("median"), &scene, &options, &bvh, NULL), 0);
        for (size_t l = 0; layouts_all[l]; l++)
            for (size_t s = 0; tri_stores[s]; s++) {
                struct packed packed;
                if (packed_make_stored(layouts_all[l], tri_stores[s], &bvh, &scene, &packed, NULL))
                    continue;
                check(&packed, &scene, &rng);
                packed_free(&packed);
                played++;
            }
        bvh_free(&bvh);
        scene_free(&scene);
    }
    assert_true(played > 1000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_behind_the_words_is_read),
    };
    return cmocka_run_group_tests_name("fenced_words", tests, NULL, NULL);
}
