/* Layout `rtrs_rf_paper`: the 16-byte record as the paper's Listing 6 reads it. The paper does not
 * print the packing, so it is derived from the reading.
 *   record 0    bounds as halves rounded to nearest, as in RTRS's code
 *   inner tag   bits 0-14 record of fst, bits 16-30 record of snd, both cut to 15 bits
 *   leaf tag    0x80000000; record 1: items[0] and [1] in the tag, cut to 15 bits, then items[2] to
 *               [7] in the halves of bounds[0] to bounds[2], cut to 16 bits; unused 0
 * All eight slots are read, 0 means empty, item k names triangle k, so triangle 0 is lost. Figure 7
 * pushes fst, then snd, so snd is visited first. (RTRS's code has snd in the low half: with the
 * listing's names it visits its own fst first.) */
#include "ref/layouts/node_rf.h"

#include <stdlib.h>
#include <string.h>

#define BITS_15 0x7FFFu

/* Returns the position of slot `s` of a record among its eight 16-bit fields; the tag is the last
 * two. */
static uint32_t field_of(uint32_t s)
{
    return s < 2 ? s + 6 : s - 2;
}

static uint32_t mask_of(uint32_t s)
{
    return s < 2 ? BITS_15 : 0xFFFFu;
}

static void pack_node(const struct bvh *bvh, uint32_t i, const uint32_t *before, uint32_t *word)
{
    const struct bvh_node *node = &bvh->node[i];
    layout_pack_bounds(&node->bounds, half_nearest, half_nearest, word);
    if (node->item_count == 0) {
        word[3] = ((node->fst + before[node->fst]) & BITS_15) |
                  ((node->snd + before[node->snd]) & BITS_15) << 16;
        return;
    }
    word[3] = NODE_RF_LEAF;
    for (uint32_t s = 0; s < node->item_count; s++) {
        uint32_t stored = bvh->prim[node->item_first + s] & mask_of(s);
        word[NODE_RF_WORDS + field_of(s) / 2] |= stored << (field_of(s) % 2 * 16);
    }
}

static enum status pack(const struct layout *self, const struct bvh *bvh, const struct scene *scene,
                        struct packed *out, struct reason *reason)
{
    (void)self;
    (void)scene;
    for (uint32_t i = 0; i < bvh->node_count; i++)
        if (bvh->node[i].item_count > NODE_RF_SLOTS)
            return fail(reason, STATUS_LIMIT,
                        "rtrs_rf_paper: the paper's record has 8 slots, this tree has a leaf of %u "
                        "items; use --leaf 8 or less",
                        bvh->node[i].item_count);
    uint32_t *before = layout_leaves_before(bvh);
    if (!before)
        return fail(reason, STATUS_MEMORY, "rtrs_rf_paper: no memory to number %u nodes",
                    bvh->node_count);
    enum status status = node_rf_pack("rtrs_rf_paper", bvh, before, pack_node, out, reason);
    free(before);
    return status;
}

static void load(const struct packed *packed, uint32_t ref, struct wide *out)
{
    uint32_t tag = node_rf_tag(packed, ref);
    node_rf_load(packed, ref, NODE_RF_SLOTS, low_half(tag) & BITS_15, high_half(tag) & BITS_15,
                 out);
}

static uint32_t item(const struct packed *packed, uint32_t slot)
{
    uint32_t field = slot / NODE_RF_SLOTS * NODE_RF_SLOTS + field_of(slot % NODE_RF_SLOTS);
    if (field / 2 >= packed->word_count)
        return ABI_NO_PRIM;
    uint32_t word = packed->word[field / 2];
    uint32_t stored =
        (field % 2 ? high_half(word) : low_half(word)) & mask_of(slot % NODE_RF_SLOTS);
    return stored > 0 && stored < packed->tri_count ? stored : ABI_NO_PRIM;
}

extern const struct layout layout_rtrs_rf_paper;
const struct layout layout_rtrs_rf_paper = {
    .name = "rtrs_rf_paper",
    .summary = "the paper's 16-byte record: 15-bit children, eight slots, 0 means empty",
    .node_bytes = sizeof(struct node_rf),
    .width = 2,
    .order = VISIT_SND,
    .faithful = true,
    .pack = pack,
    .load = load,
    .box = node_rf_box,
    .item = item,
};
