/* Layout `gfx12`: the box node of AMD's RDNA 4, according to the open sources of Mesa's RADV
 * (src/amd/vulkan/bvh: README.md, bvh.h, encode_gfx12.comp): 128 bytes for eight children.
 *   word 0       record of the first child that is a node
 *   word 1       item slot of the first leaf's first item
 *   word 2       unused
 *   words 3-5    the node's origin, float32
 *   word 6       bytes ex, ey, ez: the extent along each axis is 2^(e - 127); bits 28-31: number of
 *                children minus 1
 *   word 7       index of an oriented frame; always 0x7F, none
 *   words 8-31   three words for each child, each with two codes in bits 0-11 and 12-23:
 *                lo x, lo y; lo z, hi x; hi y, hi z
 *                bits 24-31 of the second: mask of rays, always 0xFF
 *                bits 24-27 of the third: 0 a leaf, 5 a node; bits 28-31: how far the next child of
 *                that kind lies from it: 1 behind a node, the number of its items behind a leaf
 * A step is extent / 4096. The lower plane of code q lies at origin + q steps, the upper plane at
 * origin + (q + 1) steps, so a box is never empty.
 *
 * Differences from RADV: bases count records and items, and a leaf is a range of the item array,
 * while RADV's leaf is a node of compressed triangles. Children keep the tree's order. What the
 * device does besides is not modelled: nodes of instances and their four children, pairs of
 * triangles, oriented frames, culling by flags and masks, and the arithmetic of its box test.
 *
 * Two members. In `gfx12` the origin is a multiple of the step and the extent large enough that
 * every plane is exactly a float32 (ref/layouts/wide_nodes.h); codes are searched among the
 * planes, so every child is contained. `gfx12_mesa` replays the encoder as published: the origin is
 * the node's lower corner, and differences from it are rounded to float32 before a code is made of
 * them. A bound whose difference is not exact may come to lie inside, by half an ulp of the
 * difference at most: a node from -2^24 to 1 ends at 0. So it is counted, not judged. What the
 * published conversion makes of 0 / 0 is left open by GLSL; here it is 0, as in AMD's instruction
 * set. An extent of 0 has a step of 0. Corners and extents so small that they or their steps are
 * subnormal are refused. */
#include "ref/layouts/wide_nodes.h"

#include <math.h>

#define WORDS     32u
#define WIDTH     8u
#define LEAF_MOST 8u
#define CODES     4096u
#define NODE_COST 1.0f
#define TYPE_NODE 5u
#define NO_FRAME  0x7Fu
#define CODE_BITS 12

/* --- codes ------------------------------------------------------------------------------------ */

static void put_bits(uint32_t *word, uint32_t at, uint32_t bits, uint32_t value)
{
    uint32_t mask = ((uint32_t)1 << bits) - 1;
    *word = (*word & ~(mask << at)) | value << at;
}

/* Code i of a child: lo x, y, z, hi x, y, z. */
static void put_code(uint32_t *word, uint32_t s, uint32_t i, uint32_t code)
{
    put_bits(&word[8 + 3 * s + i / 2], i % 2 * CODE_BITS, CODE_BITS, code);
}

static uint32_t code_of(const uint32_t *word, uint32_t s, uint32_t i)
{
    return word[8 + 3 * s + i / 2] >> i % 2 * CODE_BITS & (CODES - 1);
}

/* Returns the step of an exponent; below 2^-126 it is 0. */
static float step_of(uint32_t exponent)
{
    return exponent > CODE_BITS ? float_from_bits((exponent - CODE_BITS) << 23) : 0;
}

static void put_frame(uint32_t *word, uint32_t k, float origin, uint32_t exponent)
{
    word[3 + k] = float_bits(origin);
    put_bits(&word[6], 8 * k, 8, exponent);
}

/* --- boxes ------------------------------------------------------------------------------------ */

static void put_boxes(const struct box *const box[WIDTH], uint32_t *word)
{
    struct box all = wide_nodes_frame(box);
    for (uint32_t k = 0; k < 3; k++) {
        struct node_axis axis = node_axis_make(all.lo[k], all.hi[k], CODES);
        put_frame(word, k, axis.origin, (uint32_t)(axis.exponent + CODE_BITS + 127));
        for (uint32_t s = 0; s < WIDTH; s++) {
            if (!box[s])
                continue;
            uint32_t lo = node_axis_down(&axis, box[s]->lo[k]);
            uint32_t hi = node_axis_up(&axis, box[s]->hi[k]);
            put_code(word, s, k, lo < CODES ? lo : CODES - 1);
            put_code(word, s, 3 + k, hi > 0 ? hi - 1 : 0);
        }
    }
}

static void put_children(const struct wide_child *child, uint32_t count, uint32_t *word)
{
    bool items = false, nodes = false;
    word[6] |= (count - 1) << 28;
    word[7] = NO_FRAME;
    for (uint32_t s = 0; s < WIDTH; s++) {
        uint32_t *three = word + 8 + 3 * s;
        if (s >= count) { /* a box from 1 to 0 */
            three[0] = UINT32_MAX;
            three[1] = CODES - 1;
            three[2] = 0;
            continue;
        }
        bool leaf = child[s].count > 0, *any = leaf ? &items : &nodes;
        if (!*any)
            word[leaf ? 1 : 0] = child[s].first;
        *any = true;
        three[1] |= 0xFFu << 24;
        three[2] |= leaf ? child[s].count << 28 : 1u << 28 | TYPE_NODE << 24;
    }
}

static void decode(const struct packed *packed, uint32_t record, struct wide_slot *slot)
{
    const uint32_t *word = packed->word + (size_t)WORDS * record;
    uint32_t count = (word[6] >> 28) + 1, node = word[0], item = word[1];
    for (uint32_t s = 0; s < WIDTH; s++) {
        uint32_t last = word[8 + 3 * s + 2], size = last >> 28;
        bool inner = (last >> 24 & 15u) == TYPE_NODE;
        slot[s].there = s < count && size > 0;
        slot[s].first = inner ? node : item;
        slot[s].count = inner ? 0 : size;
        *(inner ? &node : &item) += size;
        for (uint32_t k = 0; k < 3; k++) {
            float origin = float_from_bits(word[3 + k]), step = step_of(word[6] >> 8 * k & 0xFFu);
            slot[s].box.lo[k] = origin + (float)code_of(word, s, k) * step;
            slot[s].box.hi[k] = origin + (float)(code_of(word, s, 3 + k) + 1) * step;
        }
    }
}

/* --- as published ----------------------------------------------------------------------------- */

/* A number that is not negative as an integer; NaN is 0. */
static uint32_t whole(float x)
{
    return x >= 1 ? (uint32_t)x : 0;
}

static uint32_t least(uint32_t code)
{
    return code < CODES - 1 ? code : CODES - 1;
}

static void mesa_put_boxes(const struct box *const box[WIDTH], uint32_t *word)
{
    struct box all = wide_nodes_frame(box);
    for (uint32_t k = 0; k < 3; k++) {
        float origin = all.lo[k];
        uint32_t exponent = (float_bits(all.hi[k] - origin) + 0x7FFFFFu) >> 23;
        float extent = float_from_bits(exponent << 23);
        put_frame(word, k, origin, exponent);
        for (uint32_t s = 0; s < WIDTH; s++) {
            if (!box[s])
                continue;
            float lo = floorf((box[s]->lo[k] - origin) / extent * (float)CODES);
            float hi = ceilf((box[s]->hi[k] - origin) / extent * (float)CODES);
            put_code(word, s, k, least(whole(lo)));
            put_code(word, s, 3 + k, least(whole(hi) - 1));
        }
    }
}

static bool is_subnormal(uint32_t bits)
{
    return (bits & 0x7F800000u) == 0 && (bits & 0x007FFFFFu) != 0;
}

static enum status mesa_check(const struct packed *packed, uint32_t record, struct reason *reason)
{
    const uint32_t *word = packed->word + (size_t)WORDS * record;
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t exponent = word[6] >> 8 * k & 0xFFu;
        if (is_subnormal(word[3 + k]) || (exponent > 0 && exponent <= CODE_BITS))
            return fail(reason, STATUS_LIMIT,
                        "gfx12_mesa: the corner or the step of record %u is subnormal; scale the "
                        "scene, or use layout gfx12",
                        record);
    }
    return STATUS_OK;
}

static enum status mesa_pack(const struct layout *self, const struct bvh *bvh,
                             const struct scene *scene, struct packed *out, struct reason *reason)
{
    enum status status = wide_form_pack(self, bvh, scene, out, reason);
    for (uint32_t r = 0; !status && r < out->node_count; r++)
        status = mesa_check(out, r, reason);
    return status;
}

static enum status mesa_rebound(struct packed *packed, uint32_t ref, const struct box *own,
                                const struct wide *node, struct reason *reason)
{
    enum status status = wide_form_rebound(packed, ref, own, node, reason);
    return status ? status : mesa_check(packed, ref, reason);
}

/* --- members ---------------------------------------------------------------------------------- */

#define FORM(boxes)                                                                                \
    {                                                                                              \
        .decode = decode, .node_cost = NODE_COST, .largest = NODE_AXIS_LARGEST,                    \
        .places = UINT32_MAX, .put_boxes = boxes, .put_children = put_children,                    \
    }

static const struct wide_form form = FORM(put_boxes), mesa_form = FORM(mesa_put_boxes);

#define MEMBER(member, text, lossy, its_form, its_pack, its_rebound)                               \
    {                                                                                              \
        .name = member, .summary = "128-byte nodes of 8 children as in AMD's RDNA 4, " text,       \
        .node_bytes = 4 * WORDS, .width = WIDTH, .order = VISIT_NEAR, .faithful = lossy,           \
        .shader = "gfx12", .family = &(its_form), .pack = its_pack, .leaf_most = LEAF_MOST,        \
        .load = wide_form_load, .box = wide_form_box, .rebound = its_rebound,                      \
        .item = wide_nodes_item,                                                                   \
    }

extern const struct layout layouts_gfx12[2];
const struct layout layouts_gfx12[2] = {
    MEMBER("gfx12", "bounds of 12 bits in the node's frame", false, form, wide_form_pack,
           wide_form_rebound),
    MEMBER("gfx12_mesa", "bounds of 12 bits rounded as Mesa does", true, mesa_form, mesa_pack,
           mesa_rebound),
};
