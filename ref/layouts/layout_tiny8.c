/* Layout `tiny8` and its family: 64 bytes, one cache line, for eight children; bounds of 6 bits in
 * the frame of the node, as in cwbvh80 (ref/layouts/wide_nodes.h).
 *   words 0-2   the node's origin, float32
 *   word 3      bytes ex, ey, ez: exponents of the steps of its planes, plus 127; the last byte 0
 *   word 4      record of its first child that is a node; these records are adjacent
 *   word 5      item slot of its first leaf's first item; the leaves' items are adjacent
 *   word 6      four bits for each child: 0 none, 1 to 14 the items of a leaf, 15 a node
 *   words 7-14  for each child lo x, lo y, lo z, hi x, hi y, of 6 bits, and bits 0-1 of hi z
 *   word 15     bits 2-5 of hi z, four for each child
 * The layouts differ in leaf size: the cost of a node, in units of a triangle test, determines how
 * many nodes a smaller leaf may cost. Smaller leaves are faster, with more nodes. */
#include "ref/layouts/wide_nodes.h"

#include <string.h>

#define WORDS  16u
#define WIDTH  8u
#define PLANES 63u
#define INNER  15u

static void put_box(const struct node_axis axis[3], const struct box *box, uint32_t s,
                    uint32_t *word)
{
    uint32_t lo[3], hi[3];
    for (uint32_t k = 0; k < 3; k++) {
        lo[k] = node_axis_down(&axis[k], box->lo[k]);
        hi[k] = node_axis_up(&axis[k], box->hi[k]);
    }
    word[7 + s] = lo[0] | lo[1] << 6 | lo[2] << 12 | hi[0] << 18 | hi[1] << 24 | hi[2] << 30;
    word[15] |= hi[2] >> 2 << 4 * s;
}

/* Writes the frame, and the planes of all children. */
static void put_boxes(const struct box *const box[WIDTH], uint32_t *word)
{
    struct node_axis axis[3];
    struct box all = wide_nodes_frame(box);
    word[3] = word[15] = 0;
    for (uint32_t k = 0; k < 3; k++) {
        axis[k] = node_axis_make(all.lo[k], all.hi[k], PLANES);
        word[k] = float_bits(axis[k].origin);
        word[3] |= (uint32_t)(axis[k].exponent + 127) << 8 * k;
    }
    for (uint32_t s = 0; s < WIDTH; s++)
        if (box[s])
            put_box(axis, box[s], s, word);
}

static void put_children(const struct wide_child *child, uint32_t count, uint32_t *word)
{
    bool have_node = false, have_leaf = false;
    for (uint32_t s = 0; s < count; s++) {
        word[6] |= (child[s].count ? child[s].count : INNER) << 4 * s;
        bool *have = child[s].count ? &have_leaf : &have_node;
        if (!*have)
            word[child[s].count ? 5 : 4] = child[s].first;
        *have = true;
    }
}

static void decode(const struct packed *packed, uint32_t record, struct wide_slot *slot)
{
    const uint32_t *word = packed->word + (size_t)WORDS * record;
    uint32_t next_node = word[4], next_item = word[5];
    struct node_axis axis[3];
    for (uint32_t k = 0; k < 3; k++)
        axis[k] =
            (struct node_axis){float_from_bits(word[k]), (int)(word[3] >> 8 * k & 0xFFu) - 127};
    for (uint32_t s = 0; s < WIDTH; s++) {
        uint32_t kind = word[6] >> 4 * s & 15u;
        uint32_t planes = word[7 + s], top = word[15] >> 4 * s & 15u;
        slot[s].there = kind != 0;
        slot[s].first = kind == INNER ? next_node : next_item;
        slot[s].count = kind == INNER ? 0 : kind;
        next_node += kind == INNER;
        next_item += slot[s].count;
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t hi = k < 2 ? planes >> (18 + 6 * k) & PLANES : planes >> 30 | top << 2;
            slot[s].box.lo[k] = node_axis_plane(&axis[k], planes >> 6 * k & PLANES);
            slot[s].box.hi[k] = node_axis_plane(&axis[k], hi);
        }
    }
}

extern const struct layout layouts_tiny8[3];
const struct layout layouts_tiny8[3] = {
#define MEMBER(member, text, most, cost)                                                           \
    {                                                                                              \
        .name = member,                                                                            \
        .summary = "64-byte nodes of 8 children, bounds of 6 bits in the node's frame; " text,     \
        .node_bytes = 4 * WORDS, .width = WIDTH, .order = VISIT_NEAR, .shader = "tiny8",           \
        .family = &(const struct wide_form){.decode = decode,                                      \
                                            .node_cost = cost,                                     \
                                            .largest = NODE_AXIS_LARGEST,                          \
                                            .places = UINT32_MAX,                                  \
                                            .put_boxes = put_boxes,                                \
                                            .put_children = put_children},                         \
        .pack = wide_form_pack, .leaf_most = most, .pack_tree = wide_form_pack_tree,               \
        .load = wide_form_load, .box = wide_form_box, .rebound = wide_form_rebound,                \
        .item = wide_nodes_item,                                                                   \
    }
    MEMBER("tiny8", "leaves of up to 4", 4, 1.0f),
    MEMBER("tiny8_l8", "leaves of up to 8", 8, 4.0f),
    MEMBER("tiny8_l14", "leaves of up to 14", 14, 16.0f),
};
