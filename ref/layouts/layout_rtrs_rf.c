/* Layout `rtrs_rf`: RTRS's 16-byte records, as its code packs them and its shader reads them.
 *   record 0    bounds as halves rounded to nearest (F11), infinite from 65520 on (F12)
 *   inner tag   low half record of snd, high half record of fst, cut to 16 bits (F9): a record of
 *               fst from 32768 on sets bit 31, and the node reads as a leaf
 *   leaf tag    0x80000000; record 1 holds eight 16-bit items, cut (F10), unused 0, no count
 * The shader reads slots 0 to 5 (F7), skips 0, and reads item k as the scene's triangle k - 1 (F2):
 * the last triangle is never tested. Two faults occur while packing: the loop that turns node
 * indices into record indices also treats a leaf's record 1 as a node (F6), and RTRS panics on a
 * leaf of more than 8 items (F8). */
#include "ref/layouts/node_rf.h"

#include <stdlib.h>
#include <string.h>

#define SLOTS_READ 6u

/* The tag of a leaf's record 1 holds items 6 and 7. If its bit 31 is clear, the loop that numbers
 * records takes both for nodes; if one of them is beyond the nodes, it reads out of range. */
static bool item_beyond(const struct bvh *bvh, const struct bvh_node *leaf, uint32_t *item)
{
    uint32_t last[2] = {0, 0};
    for (uint32_t s = 6; s < leaf->item_count; s++)
        last[s - 6] = low_half(bvh->prim[leaf->item_first + s]);
    *item = last[0] > last[1] ? last[0] : last[1];
    return last[1] < NODE_RF_LEAF >> 16 && *item > bvh->node_count;
}

static enum layout_end end(const struct bvh *bvh, struct reason *reason)
{
    uint32_t item, leaves = 0;
    for (uint32_t i = 0; i < bvh->node_count; i++)
        if (bvh->node[i].item_count > NODE_RF_SLOTS) {
            (void)fail(reason, STATUS_LIMIT,
                       "rtrs_rf: RTRS panics (fault F8, docs/rtrs-faults.md): "
                       "%u items in a leaf of 8 slots",
                       bvh->node[i].item_count);
            return LAYOUT_END_LEAF;
        }
    for (uint32_t i = 0; i < bvh->node_count; i++) {
        if (bvh->node[i].item_count == 0)
            continue;
        leaves++;
        if (item_beyond(bvh, &bvh->node[i], &item)) {
            (void)fail(reason, STATUS_LIMIT,
                       "rtrs_rf: RTRS panics (fault F6, docs/rtrs-faults.md): "
                       "record %u holds item %u, taken for one of %u nodes",
                       i + leaves, item, bvh->node_count);
            return LAYOUT_END_ITEM;
        }
    }
    return LAYOUT_GOES_ON;
}

/* Writes the records of node `i` as they are before the fix-up, with node indices as children. */
static void pack_node(const struct bvh *bvh, uint32_t i, const uint32_t *before, uint32_t *word)
{
    (void)before;
    const struct bvh_node *node = &bvh->node[i];
    layout_pack_bounds(&node->bounds, half_nearest, half_nearest, word);
    if (node->item_count == 0) {
        word[3] = node->fst << 16 | low_half(node->snd);
        return;
    }
    word[3] = NODE_RF_LEAF;
    for (uint32_t s = 0; s < node->item_count; s++)
        word[NODE_RF_WORDS + s / 2] |= low_half(bvh->prim[node->item_first + s]) << (s % 2 * 16);
}

/* Adds to both halves of every tag without the leaf bit the number of leaves before that node, also
 * to the tag of a leaf's record 1. */
static void fix_up(const uint32_t *before, struct packed *out)
{
    for (uint32_t r = 0; r < out->node_count; r++) {
        uint32_t *tag = &out->word[NODE_RF_WORDS * (size_t)r + 3];
        if (*tag & NODE_RF_LEAF)
            continue;
        uint32_t low = low_half(*tag), high = high_half(*tag);
        *tag = low_half(low + before[low]) | low_half(high + before[high]) << 16;
    }
}

static enum status pack(const struct layout *self, const struct bvh *bvh, const struct scene *scene,
                        struct packed *out, struct reason *reason)
{
    (void)self;
    (void)scene;
    if (end(bvh, reason) != LAYOUT_GOES_ON)
        return STATUS_LIMIT;
    uint32_t *before = layout_leaves_before(bvh);
    if (!before)
        return fail(reason, STATUS_MEMORY, "rtrs_rf: no memory to number %u nodes",
                    bvh->node_count);
    enum status status = node_rf_pack("rtrs_rf", bvh, before, pack_node, out, reason);
    if (!status)
        fix_up(before, out);
    free(before);
    return status;
}

static void load(const struct packed *packed, uint32_t ref, struct wide *out)
{
    uint32_t tag = node_rf_tag(packed, ref);
    node_rf_load(packed, ref, SLOTS_READ, high_half(tag), low_half(tag), out);
}

/* Item 0 is the null triangle; items beyond the scene result from F9. */
static uint32_t item(const struct packed *packed, uint32_t slot)
{
    if (slot / 2 >= packed->word_count)
        return ABI_NO_PRIM;
    uint32_t word = packed->word[slot / 2];
    uint32_t stored = slot % 2 ? high_half(word) : low_half(word);
    return stored > 0 && stored <= packed->tri_count ? stored - 1 : ABI_NO_PRIM;
}

extern const struct layout layout_rtrs_rf;
const struct layout layout_rtrs_rf = {
    .name = "rtrs_rf",
    .summary = "RTRS's 16-byte records, six slots read, its triangle numbering included",
    .node_bytes = sizeof(struct node_rf),
    .width = 2,
    .order = VISIT_FST,
    .faithful = true,
    .pack = pack,
    .end = end,
    .load = load,
    .box = node_rf_box,
    .item = item,
};
