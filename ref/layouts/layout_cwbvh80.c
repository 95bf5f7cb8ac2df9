/* Layout `cwbvh80`: the compressed wide node of Ylitie, Karras, Laine 2017, "Efficient Incoherent
 * Ray Traversal on GPUs Through Compressed Wide BVHs", section 3: 80 bytes for eight children.
 *   words 0-2    the node's origin, float32
 *   word 3       bytes ex, ey, ez: exponents of the steps of its planes, plus 127; imask: bit s if
 *                child s is a node
 *   word 4       record of its first child that is a node; these records are adjacent
 *   word 5       item slot of its first leaf's first item; the leaves' items are adjacent
 *   words 6-7    a byte for each child: 0 none; node: 001 and 24 + s; leaf: the number of its items
 *                in unary (001, 011, 111) and, in the lower five bits, where they begin
 *   words 8-19   lo x, lo y, lo z, hi x, hi y, hi z: two words each, a byte for each child; plane q
 *                lies at origin + q * 2^e
 * Differences from the paper: children keep the tree's order and are visited by the distance of
 * their boxes, while the paper assigns slots by octants and visits them in the order of the ray's
 * octant. The item array holds triangle numbers, while the paper stores vertices. A step is always
 * large enough that every plane is exactly a float32 (ref/layouts/wide_nodes.h), so far from the
 * origin boxes are a little larger. Its limits are kept: 3 items in a leaf, 24 in a node. */
#include "ref/layouts/wide_nodes.h"

#include <string.h>

#define WORDS     20u
#define WIDTH     8u
#define LEAF_MOST 3u
#define PLANES    255u
#define NODE_COST 1.0f

static uint32_t byte_of(const uint32_t *word, uint32_t at)
{
    return word[at / 4] >> at % 4 * 8 & 0xFFu;
}

static void put_byte(uint32_t *word, uint32_t at, uint32_t value)
{
    word[at / 4] &= ~(0xFFu << at % 4 * 8);
    word[at / 4] |= value << at % 4 * 8;
}

static void put_planes(const struct node_axis *axis, uint32_t k, uint32_t s,
                       const struct box *bounds, uint32_t *word)
{
    uint32_t lo = node_axis_down(axis, bounds->lo[k]), hi = node_axis_up(axis, bounds->hi[k]);
    put_byte(word + 8, WIDTH * k + s, lo);
    put_byte(word + 14, WIDTH * k + s, hi);
}

/* Writes the frame, and the planes of all children. */
static void put_boxes(const struct box *const box[WIDTH], uint32_t *word)
{
    struct node_axis axis[3];
    struct box all = wide_nodes_frame(box);
    for (uint32_t k = 0; k < 3; k++) {
        axis[k] = node_axis_make(all.lo[k], all.hi[k], PLANES);
        word[k] = float_bits(axis[k].origin);
        put_byte(word + 3, k, (uint32_t)(axis[k].exponent + 127));
    }
    for (uint32_t s = 0; s < WIDTH; s++)
        for (uint32_t k = 0; k < 3 && box[s]; k++)
            put_planes(&axis[k], k, s, box[s], word);
}

static void put_children(const struct wide_child *child, uint32_t count, uint32_t *word)
{
    uint32_t items = 0, nodes = 0;
    for (uint32_t s = 0; s < count; s++) {
        if (child[s].count == 0) {
            word[3] |= 1u << (24 + s);
            put_byte(word + 6, s, 1u << 5 | (24 + s));
            if (nodes++ == 0)
                word[4] = child[s].first;
            continue;
        }
        if (items == 0)
            word[5] = child[s].first;
        put_byte(word + 6, s, ((1u << child[s].count) - 1) << 5 | items);
        items += child[s].count;
    }
}

static void decode(const struct packed *packed, uint32_t record, struct wide_slot *slot)
{
    const uint32_t *word = packed->word + (size_t)WORDS * record;
    uint32_t inner = byte_of(word + 3, 3);
    struct node_axis axis[3];
    for (uint32_t k = 0; k < 3; k++)
        axis[k] = (struct node_axis){float_from_bits(word[k]), (int)byte_of(word + 3, k) - 127};
    for (uint32_t s = 0, nodes = 0; s < WIDTH; s++) {
        uint32_t meta = byte_of(word + 6, s);
        slot[s].there = meta != 0;
        if (inner >> s & 1) {
            slot[s].first = word[4] + nodes++;
            slot[s].count = 0;
        } else {
            slot[s].first = word[5] + (meta & 31u);
            slot[s].count = (meta >> 5 & 1) + (meta >> 6 & 1) + (meta >> 7 & 1);
        }
        for (uint32_t k = 0; k < 3; k++) {
            slot[s].box.lo[k] = node_axis_plane(&axis[k], byte_of(word + 8, WIDTH * k + s));
            slot[s].box.hi[k] = node_axis_plane(&axis[k], byte_of(word + 14, WIDTH * k + s));
        }
    }
}

static const struct wide_form form = {
    .decode = decode,
    .node_cost = NODE_COST,
    .largest = NODE_AXIS_LARGEST,
    .places = UINT32_MAX,
    .put_boxes = put_boxes,
    .put_children = put_children,
};

extern const struct layout layout_cwbvh80;
const struct layout layout_cwbvh80 = {
    .name = "cwbvh80",
    .summary = "80-byte nodes of 8 children, bounds of 8 bits in the node's frame, index array",
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
    .item = wide_nodes_item,
};
