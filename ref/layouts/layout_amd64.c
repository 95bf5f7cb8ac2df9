/* Layouts `amd64`: the box nodes of AMD's ray accelerators, according to the documents of their
 * instruction set (RDNA 2 Shader ISA, image_bvh_intersect_ray) and the open sources of their
 * drivers (GPURT, Mesa's RADV). Records of 64 bytes: a node of four boxes in float16 takes one, a
 * node of four boxes in float32 two.
 *   words 0-3    a pointer for each child: bits 0-2 its type, bits 3-31 its place
 *                  types 0-3   a leaf of 1 to 4 items; place: the slot of the first
 *                  type 4      a float16 node; place: its record
 *                  type 5      a float32 node; place: its first record
 *                  all ones    no child
 *   words 4-15   float16: for each child min x, y, z, max x, y, z, the first in the low half
 *   words 4-27   float32: the same; words 28-31 are zero
 * As in GPURT's mixed mode, a node is in float16 if that inflates its boxes little, and the root is
 * in float32.
 *
 * Differences from the hardware: the decision uses the area of all boxes in the node; types 0-3
 * name a range of the item array, while on the hardware they name a triangle of a triangle node;
 * child boxes are sorted by distance in software.
 *
 * Box growth: the hardware grows boxes while it tests them, by a number of ulps in its descriptor
 * (at most 255) that compensates for the rounding of its test. Here the tests allow for their own
 * rounding (ref/primitives/slab.h), and the stored boxes are grown. The layouts amd64_g0 and
 * amd64_g1 round bounds to nearest, as a plain conversion does, then move them outward by n ulp of
 * the stored number: n = 0 loses hits and is not judged; from n = 1 on boxes are conservative,
 * since the neighbour of the nearest number lies beyond the exact bound. The others round outward.
 */
#include "ref/layouts/wide_nodes.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WORDS     16u
#define WIDTH     4u
#define LEAF_MOST 4u
#define NODE_COST 1.0f
#define POINTERS  ((uint32_t)1 << 29)
#define TYPE_16   4u
#define TYPE_32   5u
#define NO_CHILD  0xFFFFFFFFu

/* Parameters of one layout: a node is in float16 if that makes its boxes' area at most `inflate`
 * times as large. */
struct amd {
    float inflate;
    bool nearest;  /* round to nearest, not outward */
    uint32_t grow; /* then move outward by this many ulp */
};

/* --- bounds ----------------------------------------------------------------------------------- */

/* Moves the bits of a half or a float `ulps` steps outward; bit `sign` is the sign. */
static uint32_t step_outward(uint32_t bits, int sign, uint32_t ulps, bool up)
{
    uint32_t mask = ((uint32_t)1 << sign) - 1;
    int64_t magnitude = bits & mask;
    int64_t place = bits >> sign & 1 ? -magnitude : magnitude;
    place += up ? (int64_t)ulps : -(int64_t)ulps;
    return place < 0 ? (uint32_t)-place | (uint32_t)1 << sign : (uint32_t)place;
}

static struct half half_of(const struct amd *amd, float x, bool up)
{
    struct half h = amd->nearest ? half_nearest(x) : up ? half_up(x) : half_down(x);
    return (struct half){(uint16_t)step_outward(h.bits, 15, amd->grow, up)};
}

static float float_of(const struct amd *amd, float x, bool up)
{
    return float_from_bits(step_outward(float_bits(x), 31, amd->grow, up));
}

static bool half_is_finite(struct half h)
{
    return (h.bits & 0x7C00u) != 0x7C00u;
}

/* Computes the box as decoded. False if it is not finite. */
static bool stored_box(const struct amd *amd, bool f32, const struct box *box, struct box *out)
{
    bool finite = true;
    for (int k = 0; k < 3; k++) {
        struct half lo = half_of(amd, box->lo[k], false), hi = half_of(amd, box->hi[k], true);
        out->lo[k] = f32 ? float_of(amd, box->lo[k], false) : half_to_float(lo);
        out->hi[k] = f32 ? float_of(amd, box->hi[k], true) : half_to_float(hi);
        if (!f32)
            finite = finite && half_is_finite(lo) && half_is_finite(hi);
    }
    for (int k = 0; k < 3; k++)
        finite = finite && float_is_finite(out->lo[k]) && float_is_finite(out->hi[k]);
    return finite;
}

/* --- nodes ------------------------------------------------------------------------------------ */

struct amd64_packing {
    const struct amd *amd;
    const struct wide_tree *tree;
    uint32_t *pointer; /* per node: its first record and type */
    uint32_t records;
};

/* True if node `n` is stored in float32; *fits = false if it fits in neither format. */
static bool wants_f32(const struct amd64_packing *p, uint32_t n, bool *fits)
{
    const struct wide_node *node = &p->tree->node[n];
    bool fits16 = true, fits32 = true;
    double area16 = 0, area32 = 0;
    for (uint32_t c = 0; c < node->count; c++) {
        const struct box *exact = &p->tree->child[node->first + c].bounds;
        struct box stored;
        fits16 = stored_box(p->amd, false, exact, &stored) && fits16;
        area16 += box_half_area(&stored);
        fits32 = stored_box(p->amd, true, exact, &stored) && fits32;
        area32 += box_half_area(exact);
    }
    bool mixed = p->amd->inflate < INFINITY;
    bool f32 = n == 0 || (mixed && (!fits16 || area16 > (double)p->amd->inflate * area32));
    *fits = f32 ? fits32 : fits16;
    return f32;
}

/* Assigns records to nodes in the order of the tree. */
static enum status place_nodes(const char *name, struct amd64_packing *p, struct reason *reason)
{
    for (uint32_t n = 0; n < p->tree->node_count; n++) {
        bool fits;
        bool f32 = wants_f32(p, n, &fits);
        if (!fits)
            return fail(
                reason, STATUS_LIMIT,
                "%s: a bound as stored is at most %s in magnitude, one of node %u is larger; "
                "scale or move the scene, or use layout %s",
                name, f32 ? "FLT_MAX" : "65504", n, f32 ? "f32" : "amd64");
        if (p->records >= POINTERS - 1)
            return fail(reason, STATUS_LIMIT, "%s: holds at most 2^29 records", name);
        p->pointer[n] = p->records << 3 | (f32 ? TYPE_32 : TYPE_16);
        p->records += f32 ? 2 : 1;
    }
    return STATUS_OK;
}

static void pack_box(const struct amd *amd, bool f32, const struct box *box, uint32_t s,
                     uint32_t *word)
{
    for (uint32_t i = 0; i < 6; i++) {
        bool up = i >= 3;
        float x = up ? box->hi[i - 3] : box->lo[i];
        if (f32)
            word[4 + 6 * s + i] = float_bits(float_of(amd, x, up));
        else
            word[4 + 3 * s + i / 2] |= (uint32_t)half_of(amd, x, up).bits << i % 2 * 16;
    }
}

static void pack_node(const struct amd64_packing *p, uint32_t n, uint32_t *words)
{
    const struct wide_node *node = &p->tree->node[n];
    uint32_t *word = words + (size_t)WORDS * (p->pointer[n] >> 3);
    bool f32 = (p->pointer[n] & 7u) == TYPE_32;
    for (uint32_t s = 0; s < WIDTH; s++) {
        const struct wide_child *child = &p->tree->child[node->first + s];
        word[s] = NO_CHILD;
        if (s >= node->count)
            continue;
        word[s] = child->count ? child->first << 3 | (child->count - 1) : p->pointer[child->first];
        pack_box(p->amd, f32, &child->bounds, s, word);
    }
}

static enum status pack(const struct layout *self, const struct bvh *bvh, const struct scene *scene,
                        struct packed *out, struct reason *reason)
{
    struct wide_tree tree = {0};
    struct amd64_packing p = {.amd = self->family, .tree = &tree};
    enum status status = STATUS_OK;
    if (bvh->prim_count > POINTERS)
        status = fail(reason, STATUS_LIMIT, "%s: holds at most 2^29 items, this tree has %u",
                      self->name, bvh->prim_count);
    if (!status)
        status =
            wide_nodes_collapse(self, bvh, scene, LEAF_MOST, NODE_COST, FLT_MAX, &tree, reason);
    if (!status) {
        p.pointer = alloc_zeroed(tree.node_count, sizeof *p.pointer);
        status = p.pointer ? place_nodes(self->name, &p, reason)
                           : fail(reason, STATUS_MEMORY, "%s: no memory to place %u nodes",
                                  self->name, tree.node_count);
    }
    if (!status)
        status = layout_alloc(self->name, p.records, WORDS, 0, out, reason);
    if (!status) {
        out->ref_count = out->node_count * layout_refs(self);
        out->root = out->node_count; /* record 0, in float32 */
        status = wide_nodes_items(self, bvh->prim, scene, POINTERS, &tree, out, reason);
        for (uint32_t n = 0; n < tree.node_count && !status; n++)
            pack_node(&p, n, out->word);
    }
    free(p.pointer);
    wide_tree_free(&tree);
    return status;
}

/* --- references ------------------------------------------------------------------------------- */

/* Record r is reference r as a float16 node and node_count + r as a float32 node. Its slots are
 * references 2 node_count + 4 r + s, and 4 node_count more for float32. */
struct amd64_place {
    uint32_t record;
    uint32_t slot; /* WIDTH: the node itself */
    bool f32;
};

static struct amd64_place place_of(const struct packed *packed, uint32_t ref)
{
    uint32_t records = packed->node_count;
    if (ref < 2 * records)
        return (struct amd64_place){ref % records, WIDTH, ref >= records};
    ref -= 2 * records;
    return (struct amd64_place){ref / WIDTH % records, ref % WIDTH, ref >= WIDTH * records};
}

static void decode(const struct packed *packed, const struct amd64_place *place,
                   struct wide_slot *slot)
{
    const uint32_t *word = packed->word + (size_t)WORDS * place->record;
    bool cut = place->f32 && place->record + 1 >= packed->node_count;
    for (uint32_t s = 0; s < WIDTH; s++) {
        uint32_t type = word[s] & 7u, at = word[s] >> 3;
        slot[s].there = type <= TYPE_32 && !cut;
        slot[s].box = box_empty();
        slot[s].count = type < TYPE_16 ? type + 1 : 0;
        slot[s].first = type == TYPE_32 ? packed->node_count + at : at;
        if (type >= TYPE_16 && at >= packed->node_count)
            slot[s].there = false;
        for (uint32_t i = 0; i < 6 && !cut; i++) {
            uint32_t pair = word[4 + 3 * s + i / 2];
            struct half h = {(uint16_t)(pair >> i % 2 * 16)};
            float x = place->f32 ? float_from_bits(word[4 + 6 * s + i]) : half_to_float(h);
            (i < 3 ? slot[s].box.lo : slot[s].box.hi)[i % 3] = x;
        }
    }
}

static void load(const struct packed *packed, uint32_t ref, struct wide *out)
{
    struct wide_slot slot[WIDTH];
    struct amd64_place place = place_of(packed, ref);
    uint32_t records = packed->node_count;
    decode(packed, &place, slot);
    if (place.slot == WIDTH) {
        uint32_t slots = 2 * records + (place.f32 ? WIDTH * records : 0);
        wide_nodes_children(packed, slot, 2 * records, slots + WIDTH * place.record, out);
        return;
    }
    const struct wide_slot *one = &slot[place.slot];
    out->child_count = 0;
    out->item_first = one->there && one->count > 0 ? one->first : 0;
    out->item_count = one->there ? one->count : 0;
}

static struct box box(const struct packed *packed, uint32_t ref)
{
    struct wide_slot slot[WIDTH];
    struct amd64_place place = place_of(packed, ref);
    decode(packed, &place, slot);
    return place.slot == WIDTH ? wide_nodes_union(packed, slot) : slot[place.slot].box;
}

static enum status rebound(struct packed *packed, uint32_t ref, const struct box *own,
                           const struct wide *node, struct reason *reason)
{
    (void)own;
    const struct amd *amd = packed->layout->family;
    struct amd64_place place = place_of(packed, ref);
    uint32_t *word = packed->word + (size_t)WORDS * place.record;
    struct wide_slot slot[WIDTH];
    const struct box *box[WIDE_MAX];
    struct box stored;
    decode(packed, &place, slot);
    wide_nodes_boxes(packed, slot, 2 * packed->node_count, node, box);
    memset(word + 4, 0, 12 * sizeof *word); /* halves are put beside each other */
    for (uint32_t s = 0; s < WIDTH; s++) {
        if (!box[s])
            continue;
        if (!stored_box(amd, place.f32, box[s], &stored))
            return fail(reason, STATUS_LIMIT,
                        "%s: a bound as stored is at most %s in magnitude, one of record %u is "
                        "larger",
                        packed->layout->name, place.f32 ? "FLT_MAX" : "65504", place.record);
        pack_box(amd, place.f32, box[s], s, word);
    }
    return STATUS_OK;
}

#define MEMBER(member, text, lossy, most, to_nearest, ulps)                                        \
    {                                                                                              \
        .name = member, .summary = "64-byte nodes of 4 children as in AMD's hardware, " text,      \
        .node_bytes = 4 * WORDS, .width = WIDTH, .refs = 2 + 2 * WIDTH, .order = VISIT_NEAR,       \
        .faithful = lossy, .shader = "amd64",                                                      \
        .family = &(const struct amd){most, to_nearest, ulps}, .pack = pack, .load = load,         \
        .box = box, .rebound = rebound,                                                            \
    }
#define GROWN(n, lossy)                                                                            \
    MEMBER("amd64_g" #n, "float16 to the nearest, then " #n " ulp outward", lossy, INFINITY, true, \
           n)

extern const struct layout layouts_amd64[5];
const struct layout layouts_amd64[5] = {
    MEMBER("amd64", "float16, and float32 where that inflates over 1.25 times", false, 1.25f, false,
           0),
    MEMBER("amd64_f16", "float16 below the root", false, INFINITY, false, 0),
    MEMBER("amd64_f32", "float32", false, 0, false, 0),
    GROWN(0, true),
    GROWN(1, false),
};
