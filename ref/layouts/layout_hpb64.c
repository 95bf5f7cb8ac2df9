/* Layout `hpb64`: the high precision box node of AMD's open ray tracing library (GPUOpen-Drivers,
 * gpurt, src/shaders/HighPrecisionBoxNode.hlsl): 64 bytes for four children, 18 bits a bound.
 *   bits 0-28    base of the children, see below
 *   bits 29-40   types of the children, three bits each
 *   bits 41-55   flags of boxes, see below
 *   bits 56-79   bytes cx, cy, cz: the exponent plus 127 that all bounds along an axis share
 *   bits 80-511  for each child lo x, lo y, lo z, hi x, hi y, hi z: bits 0-16 the number of units,
 *                bit 17 the sign
 * A unit is 2^(c - 143), so that 17 bits hold every bound. Units are cut off toward zero when a
 * bound is written. When one is read, a bound whose cut made the box smaller (a positive upper or a
 * negative lower one) becomes the last float32 below the next unit, which is as far as the bound
 * can have been; the others stay. The box of a missing child is turned inside out.
 *
 * Differences from the library: there, children lie beside each other as nodes, from the base on,
 * and each box has flags. Here leaves are ranges of the item array, so there are two bases, of 22
 * bits each, in the bits of base and flags: the record of the first child that is a node, then the
 * item slot of the first leaf. Types: 4 a node, 2 no child (as there); 0, 1, 3, 5 leaves of 1 to 4
 * items. An upper bound of 0 is written as negative, and so stays 0. The shared exponent is at
 * least 43, so that no plane is subnormal: the library's decoder doubles what it reads there, and a
 * box may come out too small. What a device does with its flags is not modelled. */
#include "ref/layouts/wide_nodes.h"

#define WORDS        16u
#define WIDTH        4u
#define LEAF_MOST    4u
#define NODE_COST    1.0f
#define BASE_BITS    22u
#define BASES        ((uint32_t)1 << BASE_BITS)
#define CODE_BITS    18u
#define SIGN         ((uint32_t)1 << (CODE_BITS - 1))
#define UNITS        (SIGN - 1)
#define LARGEST      0x1p126f
#define COMMON_LEAST 43u
#define TYPE_NODE    4u
#define TYPE_NONE    2u

/* --- bits ------------------------------------------------------------------------------------- */

static uint32_t bits_at(const uint32_t *word, uint32_t at, uint32_t count)
{
    uint64_t two = word[at / 32];
    if (at % 32 + count > 32)
        two |= (uint64_t)word[at / 32 + 1] << 32;
    return (uint32_t)(two >> at % 32) & (((uint32_t)1 << count) - 1);
}

static void put_bits(uint32_t *word, uint32_t at, uint32_t count, uint32_t value)
{
    for (uint32_t i = 0; i < count; i++) {
        uint32_t bit = (uint32_t)1 << (at + i) % 32;
        word[(at + i) / 32] &= ~bit;
        word[(at + i) / 32] |= value >> i & 1 ? bit : 0;
    }
}

/* Where bound i of a child lies: lo x, y, z, hi x, y, z. */
static uint32_t code_at(uint32_t s, uint32_t i)
{
    return 80 + CODE_BITS * (6 * s + i);
}

static uint32_t type_at(uint32_t s)
{
    return 29 + 3 * s;
}

/* Items of a type. */
static uint32_t items_of(uint32_t type)
{
    return 0x403021u >> 4 * type & 15u;
}

/* --- bounds ----------------------------------------------------------------------------------- */

static uint32_t exponent_of(float x)
{
    return float_bits(x) >> 23 & 0xFFu;
}

static uint32_t common_of(float lo, float hi)
{
    uint32_t common = COMMON_LEAST;
    if (exponent_of(lo) > common)
        common = exponent_of(lo);
    return exponent_of(hi) > common ? exponent_of(hi) : common;
}

static uint32_t code_of(float x, uint32_t common, bool up)
{
    uint32_t exponent = exponent_of(x), fraction = float_bits(x) & 0x7FFFFFu;
    uint32_t shift = common - exponent + 7; /* a subnormal has no unit */
    uint32_t units = exponent > 0 && shift < 24 ? (fraction | 0x800000u) >> shift : 0;
    return units | (x < 0 || (up && x == 0) ? SIGN : 0);
}

/* A unit of any byte, not subnormal. */
static float unit_of(uint32_t common)
{
    return float_from_bits((common > 16 ? common - 16 : 1) << 23);
}

static float plane_of(uint32_t code, float unit, bool up)
{
    bool negative = (code & SIGN) != 0;
    uint32_t outward = up != negative;
    uint32_t bits = float_bits((float)((code & UNITS) + outward) * unit) - outward;
    return float_from_bits(bits | (bits && negative ? 0x80000000u : 0));
}

static void put_boxes(const struct box *const box[WIDE_MAX], uint32_t *word)
{
    struct box all = wide_nodes_frame(box);
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t common = common_of(all.lo[k], all.hi[k]);
        put_bits(word, 56 + 8 * k, 8, common);
        for (uint32_t s = 0; s < WIDTH; s++) {
            uint32_t lo = box[s] ? code_of(box[s]->lo[k], common, false) : UNITS;
            uint32_t hi = box[s] ? code_of(box[s]->hi[k], common, true) : SIGN | UNITS;
            put_bits(word, code_at(s, k), CODE_BITS, lo);
            put_bits(word, code_at(s, 3 + k), CODE_BITS, hi);
        }
    }
}

/* --- children --------------------------------------------------------------------------------- */

static void put_children(const struct wide_child *child, uint32_t count, uint32_t *word)
{
    static const uint32_t leaf_type[LEAF_MOST + 1] = {TYPE_NODE, 0, 1, 3, 5};
    uint32_t node = 0, item = 0;
    for (uint32_t s = WIDTH; s-- > 0;) { /* the first ones last */
        put_bits(word, type_at(s), 3, s < count ? leaf_type[child[s].count] : TYPE_NONE);
        if (s < count)
            *(child[s].count ? &item : &node) = child[s].first;
    }
    put_bits(word, 0, BASE_BITS, node);
    put_bits(word, BASE_BITS, 7, item & 127u);
    put_bits(word, 41, 15, item >> 7);
}

static void decode(const struct packed *packed, uint32_t record, struct wide_slot *slot)
{
    const uint32_t *word = packed->word + (size_t)WORDS * record;
    uint32_t node = bits_at(word, 0, BASE_BITS);
    uint32_t item = bits_at(word, BASE_BITS, 7) | bits_at(word, 41, 15) << 7;
    for (uint32_t s = 0; s < WIDTH; s++) {
        uint32_t type = bits_at(word, type_at(s), 3);
        bool inner = type == TYPE_NODE;
        slot[s].count = items_of(type);
        slot[s].there = inner || slot[s].count > 0;
        slot[s].first = inner ? node++ : item;
        item += slot[s].count;
        for (uint32_t k = 0; k < 3; k++) {
            float unit = unit_of(bits_at(word, 56 + 8 * k, 8));
            uint32_t lo = bits_at(word, code_at(s, k), CODE_BITS);
            uint32_t hi = bits_at(word, code_at(s, 3 + k), CODE_BITS);
            slot[s].box.lo[k] = plane_of(lo, unit, false);
            slot[s].box.hi[k] = plane_of(hi, unit, true);
        }
    }
}

static const struct wide_form form = {
    .decode = decode,
    .node_cost = NODE_COST,
    .largest = LARGEST,
    .places = BASES,
    .put_boxes = put_boxes,
    .put_children = put_children,
};

extern const struct layout layout_hpb64;
const struct layout layout_hpb64 = {
    .name = "hpb64",
    .summary = "64-byte nodes of 4 children as in AMD's library, bounds of 18 bits with a common "
               "exponent",
    .node_bytes = 4 * WORDS,
    .width = WIDTH,
    .order = VISIT_NEAR,
    .family = &form,
    .pack = wide_form_pack,
    .leaf_most = LEAF_MOST,
    .load = wide_form_load,
    .box = wide_form_box,
    .rebound = wide_form_rebound,
    .item = wide_nodes_item,
};
