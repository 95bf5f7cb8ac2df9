/* Layout `rf16`: the reduced footprint repaired. struct node_rf records of 16 bytes in pre-order;
 * an inner node is one record, a leaf two; no item array.
 *   any first record   bounds[k]  half floats of axis k, lower bound in the low half; rounded
 *                                 outward, neither subnormal nor -0
 *   inner              tag        bits 0-15 record of snd, bits 16-30 record of fst, bit 31 clear
 *   leaf, record 0     tag        bit 31 set, bits 0-3 item count (1 to 8)
 *   leaf, record 1     items 0 to 7 as 16-bit triangle indices: bounds[0] low, bounds[0] high,
 *                      bounds[1], bounds[2], tag low, tag high; unused slots are 0
 * Child records are 15 bits because fst's field ends below bit 31, the leaf mark; snd has the same
 * limit so that one number describes the layout. Triangles can use all 16 bits: record 1 is
 * reached only through record 0, so its tag is never read as a tag, and the count in record 0 gives
 * the slots in use, so that triangle 0 needs no reserved value. */
#include "ref/layouts/node_rf.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_RECORD   32767u
#define MOST_TRIANGLE 65535u

/* Rejects leaves that are too large; the reason names the largest. */
static enum status check_leaves(const struct bvh *bvh, struct reason *reason)
{
    uint32_t largest = 0;
    for (uint32_t i = 0; i < bvh->node_count; i++)
        if (bvh->node[i].item_count > largest)
            largest = bvh->node[i].item_count;
    if (largest > NODE_RF_SLOTS)
        return fail(reason, STATUS_LIMIT,
                    "rf16: a leaf holds at most 8 items, this tree has one of %u; use --leaf 8 or "
                    "less, or --layout auto",
                    largest);
    return STATUS_OK;
}

/* Rejects a child record index that does not fit; the largest is the last node's. */
static enum status check_records(const struct bvh *bvh, const uint32_t *before,
                                 struct reason *reason)
{
    uint32_t last = bvh->node_count - 1;
    uint32_t largest = last + before[last];
    if (largest > MOST_RECORD)
        return fail(reason, STATUS_LIMIT,
                    "rf16: a child record index is at most 32767, this tree needs %u (%u leaves, "
                    "%u records); use a larger --leaf, or --layout auto",
                    largest, before[bvh->node_count], bvh->node_count + before[bvh->node_count]);
    return STATUS_OK;
}

/* The reason names the node: its kind ("tree node" or "record") and number. */
static enum status check_box(const struct box *box, const char *kind, uint32_t i,
                             struct reason *reason)
{
    for (int k = 0; k < 3; k++) {
        float lo = box->lo[k], hi = box->hi[k];
        float most = fmaxf(fabsf(lo), fabsf(hi));
        if (most > HALF_MAX)
            return fail(reason, STATUS_LIMIT,
                        "rf16: a bound is at most 65504 in magnitude, %s %u has %.9g; "
                        "scale or move the scene, or use layout f32",
                        kind, i, (double)(fabsf(lo) > HALF_MAX ? lo : hi));
    }
    return STATUS_OK;
}

static enum status check_bounds(const struct bvh *bvh, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i < bvh->node_count && !status; i++)
        status = check_box(&bvh->node[i].bounds, "tree node", i, reason);
    return status;
}

static enum status check_limits(const struct bvh *bvh, const struct scene *scene,
                                const uint32_t *before, struct reason *reason)
{
    enum status status = layout_check_finite("rf16", bvh, scene, reason);
    if (!status)
        status = check_leaves(bvh, reason);
    if (!status)
        status = check_records(bvh, before, reason);
    if (!status && bvh->tri_count - 1 > MOST_TRIANGLE)
        status = fail(reason, STATUS_LIMIT,
                      "rf16: a triangle index is at most 65535, the scene's last is %u; use "
                      "--layout auto",
                      bvh->tri_count - 1);
    if (!status)
        status = check_bounds(bvh, reason);
    return status;
}

/* Writes the records of node `i`. */
static void pack_node(const struct bvh *bvh, uint32_t i, const uint32_t *before, uint32_t *word)
{
    const struct bvh_node *node = &bvh->node[i];
    struct node_rf record[2] = {0};
    layout_pack_bounds(&node->bounds, half_bound_down, half_bound_up, record[0].bounds);
    if (node->item_count == 0) {
        record[0].tag = (node->snd + before[node->snd]) | (node->fst + before[node->fst]) << 16;
        memcpy(word, record, sizeof record[0]);
        return;
    }
    record[0].tag = NODE_RF_LEAF | node->item_count;
    uint32_t packed_items[4] = {0};
    for (uint32_t s = 0; s < node->item_count; s++)
        packed_items[s / 2] |= bvh->prim[node->item_first + s] << (s % 2 * 16);
    memcpy(&record[1], packed_items, sizeof record[1]);
    memcpy(word, record, sizeof record);
}

static enum status pack(const struct layout *self, const struct bvh *bvh, const struct scene *scene,
                        struct packed *out, struct reason *reason)
{
    (void)self;
    uint32_t *before = layout_leaves_before(bvh);
    if (!before)
        return fail(reason, STATUS_MEMORY, "rf16: no memory to number %u nodes", bvh->node_count);
    enum status status = check_limits(bvh, scene, before, reason);
    if (!status)
        status = node_rf_pack("rf16", bvh, before, pack_node, out, reason);
    free(before);
    return status;
}

static void load(const struct packed *packed, uint32_t ref, struct wide *out)
{
    uint32_t tag = node_rf_tag(packed, ref);
    node_rf_load(packed, ref, tag & 15u, high_half(tag), low_half(tag), out);
}

static uint32_t item(const struct packed *packed, uint32_t slot)
{
    if (slot / 2 >= packed->word_count)
        return ABI_NO_PRIM;
    uint32_t word = packed->word[slot / 2];
    uint32_t prim = slot % 2 ? high_half(word) : low_half(word);
    return prim;
}

static enum status rebound(struct packed *packed, uint32_t ref, const struct box *own,
                           const struct wide *node, struct reason *reason)
{
    (void)node;
    enum status status = check_box(own, "record", ref, reason);
    if (!status)
        layout_pack_bounds(own, half_bound_down, half_bound_up,
                           packed->word + NODE_RF_WORDS * (size_t)ref);
    return status;
}

extern const struct layout layout_rf16;
const struct layout layout_rf16 = {
    .name = "rf16",
    .summary = "16-byte records, bounds in float16 rounded outward, up to 8 items in a leaf",
    .node_bytes = sizeof(struct node_rf),
    .width = 2,
    .order = VISIT_NEAR,
    .pack = pack,
    .load = load,
    .box = node_rf_box,
    .rebound = rebound,
    .item = item,
};
