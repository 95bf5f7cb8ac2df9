/* Packed trees of any words. Include after cmocka.h. */
#ifndef TESTS_ANY_WORDS_H
#define TESTS_ANY_WORDS_H

#include "ref/layout.h"
#include "ref/store.h"

/* Whatever the words hold, load drops references out of range, and item knows no slot outside. */
static inline void any_words_are_safe(const struct layout *layout, const struct bvh *bvh,
                                      const struct scene *scene)
{
    for (uint32_t fill = 0; fill < 64; fill++) {
        struct packed packed;
        assert_int_equal(packed_make(layout, bvh, scene, &packed, NULL), STATUS_OK);
        for (uint32_t i = 0; i < packed.word_count; i++)
            packed.word[i] = fill < 32 ? 1u << fill : ~(1u << (fill - 32));
        for (uint32_t ref = 0; ref < packed.ref_count; ref++) {
            struct wide node;
            layout->load(&packed, ref, &node);
            assert_true(node.child_count <= layout->width);
            for (uint32_t c = 0; c < node.child_count; c++)
                assert_true(packed_ref_valid(&packed, node.child[c]));
            for (uint32_t s = 0; s < node.item_count && s < 20; s++)
                (void)packed_item(&packed, &node, s);
            (void)layout->box(&packed, ref);
        }
        const struct wide leaf = {.item_first = UINT32_MAX};
        assert_int_equal(packed_item(&packed, &leaf, 0), ABI_NO_PRIM);
        packed_free(&packed);
    }
}

#endif
