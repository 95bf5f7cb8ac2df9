/* Layout `half4`: the quad node with half float bounds of physics engines, after Jolt Physics
 * (AABBTree/NodeCodec/NodeCodecQuadTreeHalfFloat.h, version 5): 64 bytes for four children.
 *   words 0-11   min x, min y, min z, max x, max y, max z: two words each, four halves, child 0 in
 *                the low half of the first
 *   words 12-15  a word for each child: bits 28-31 its triangles, 0 for a node; bits 0-27 the item
 *                slot of the first, or the record; 0 (the root, which is no node's child) for none
 * Bounds are rounded outward, and are neither subnormal nor -0; those of a missing child are empty.
 *
 * Differences from Jolt: a node comes before all of its children, offsets count records and item
 * slots, not words of one stream, and the item array holds triangle numbers, while Jolt stores
 * vertices in 21 bits. As in Jolt, coordinates are at most 65504, leaves have up to 8 triangles,
 * and children are visited by distance. */
#include "ref/layouts/wide_nodes.h"

#include <string.h>

#define WORDS     16u
#define WIDTH     4u
#define LEAF_MOST 8u
#define NODE_COST 1.0f
#define OFFSETS   ((uint32_t)1 << 28)

static struct half half_at(const uint32_t *word, uint32_t plane, uint32_t s)
{
    return (struct half){(uint16_t)(word[2 * plane + s / 2] >> s % 2 * 16)};
}

static void put_half(struct half h, uint32_t plane, uint32_t s, uint32_t *word)
{
    word[2 * plane + s / 2] |= (uint32_t)h.bits << s % 2 * 16;
}

static void put_boxes(const struct box *const box[WIDTH], uint32_t *word)
{
    const struct box empty = {{HALF_MAX, HALF_MAX, HALF_MAX}, {-HALF_MAX, -HALF_MAX, -HALF_MAX}};
    memset(word, 0, 12 * sizeof *word);
    for (uint32_t s = 0; s < WIDTH; s++) {
        const struct box *bounds = box[s] ? box[s] : &empty;
        for (uint32_t k = 0; k < 3; k++) {
            put_half(half_bound_down(bounds->lo[k]), k, s, word);
            put_half(half_bound_up(bounds->hi[k]), 3 + k, s, word);
        }
    }
}

static void put_children(const struct wide_child *child, uint32_t count, uint32_t *word)
{
    for (uint32_t s = 0; s < count; s++)
        word[12 + s] = child[s].count << 28 | child[s].first;
}

static void decode(const struct packed *packed, uint32_t record, struct wide_slot *slot)
{
    const uint32_t *word = packed->word + (size_t)WORDS * record;
    for (uint32_t s = 0; s < WIDTH; s++) {
        slot[s].there = word[12 + s] != 0;
        slot[s].first = word[12 + s] & (OFFSETS - 1);
        slot[s].count = word[12 + s] >> 28;
        for (uint32_t k = 0; k < 3; k++) {
            slot[s].box.lo[k] = half_to_float(half_at(word, k, s));
            slot[s].box.hi[k] = half_to_float(half_at(word, 3 + k, s));
        }
    }
}

static const struct wide_form form = {
    .decode = decode,
    .node_cost = NODE_COST,
    .largest = HALF_MAX,
    .places = OFFSETS,
    .put_boxes = put_boxes,
    .put_children = put_children,
};

extern const struct layout layout_half4;
const struct layout layout_half4 = {
    .name = "half4",
    .summary = "64-byte nodes of 4 children, bounds in float16 rounded outward, index array",
    .node_bytes = 4 * WORDS,
    .width = WIDTH,
    .order = VISIT_NEAR,
    .family = &form,
    .pack = wide_form_pack,
    .leaf_most = LEAF_MOST,
    .pack_tree = wide_form_pack_tree,
    .load = wide_form_load,
    .box = wide_form_box,
    .rebound = wide_form_rebound,
};
