#include "ref/layouts/common.h"

#include <stdlib.h>

enum status layout_check_finite(const char *layout, const struct bvh *bvh,
                                const struct scene *scene, struct reason *reason)
{
    for (uint32_t i = 0; i < scene->tri_count; i++) {
        float v[3][3];
        scene_tri(scene, i, v);
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++)
                if (!float_is_finite(v[c][k]))
                    return fail(reason, STATUS_LIMIT,
                                "%s: triangle %u has a vertex that is not finite", layout, i);
    }
    for (uint32_t i = 0; i < bvh->node_count; i++)
        for (int k = 0; k < 3; k++)
            if (!float_is_finite(bvh->node[i].bounds.lo[k]) ||
                !float_is_finite(bvh->node[i].bounds.hi[k]))
                return fail(reason, STATUS_LIMIT, "%s: tree node %u has a bound that is not finite",
                            layout, i);
    return STATUS_OK;
}

enum status layout_alloc(const char *layout, uint64_t record_count, uint32_t record_words,
                         uint32_t item_count, struct packed *out, struct reason *reason)
{
    *out = (struct packed){.store = out->store};
    uint64_t words = record_count * record_words;
    if (words > UINT32_MAX)
        return fail(reason, STATUS_LIMIT,
                    "%s: needs %llu words, at most %u fit; use a larger --leaf", layout,
                    (unsigned long long)words, UINT32_MAX);
    uint32_t *word = alloc_zeroed(words, sizeof *word);
    uint32_t *item = item_count ? alloc_zeroed(item_count, sizeof *item) : NULL;
    if (!word || (item_count && !item)) {
        free(word);
        free(item);
        return fail(reason, STATUS_MEMORY, "%s: no memory for %llu bytes", layout,
                    4 * ((unsigned long long)words + item_count));
    }
    *out = (struct packed){.store = out->store,
                           .word = word,
                           .item = item,
                           .word_count = (uint32_t)words,
                           .item_count = item_count,
                           .node_count = (uint32_t)record_count,
                           .ref_count = (uint32_t)record_count};
    return STATUS_OK;
}

uint32_t *layout_leaves_before(const struct bvh *bvh)
{
    uint32_t *before = alloc_zeroed((size_t)bvh->node_count + 1, sizeof *before);
    if (!before)
        return NULL;
    for (uint32_t i = 0; i < bvh->node_count; i++)
        before[i + 1] = before[i] + (bvh->node[i].item_count > 0);
    return before;
}

void layout_pack_bounds(const struct box *box, struct half (*down)(float), struct half (*up)(float),
                        uint32_t word[3])
{
    for (int k = 0; k < 3; k++)
        word[k] = down(box->lo[k]).bits | (uint32_t)up(box->hi[k]).bits << 16;
}

struct box layout_unpack_bounds(const uint32_t word[3])
{
    struct box box;
    for (int k = 0; k < 3; k++) {
        box.lo[k] = half_to_float((struct half){(uint16_t)low_half(word[k])});
        box.hi[k] = half_to_float((struct half){(uint16_t)high_half(word[k])});
    }
    return box;
}

void layout_add_child(const struct packed *packed, uint32_t ref, struct wide *out)
{
    if (!packed_ref_valid(packed, ref))
        return;
    out->child[out->child_count] = ref;
    out->box[out->child_count++] = packed->layout->box(packed, ref);
}
