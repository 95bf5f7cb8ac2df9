#include "ref/layouts/grid.h"

#include "ref/layouts/wide_nodes.h"

#include <math.h>
#include <string.h>

#define SLOT_INNER 0x80u
#define SLOT_EMPTY 0xFFu
#define SLOT_ITEMS 5 /* first bit of a leaf's number of items */

/* Description of one layout of the family. */
struct layouts_grid {
    struct wide_form form; /* for decoding */
    const struct number_format *format;
    uint32_t frame; /* ABI_FRAME_* */
};

/* Words of a record before its codes, and words of the codes. */
#define HEAD_WORDS(width, frame) (2 + ((width) + 3) / 4 + ((frame) == ABI_FRAME_NODE ? 4 : 0))
#define CODE_WORDS(width, bits)  ((bits) == 10 ? 2 * (width) : (6 * (width) * (bits) + 31) / 32)

static uint32_t head_words(const struct layouts_grid *grid, uint32_t width)
{
    return HEAD_WORDS(width, grid->frame);
}

static const struct layouts_grid *grid_of(const struct layout *layout)
{
    return layout->family;
}

/* --- words ------------------------------------------------------------------------------------ */

/* Returns the position of code `index` of a record: word and bit. */
static uint32_t code_place(const struct number_format *format, uint32_t index, uint32_t *bit)
{
    if (format->bits == 10) {
        *bit = index % 3 * 10;
        return index / 3;
    }
    *bit = index * format->bits % 32;
    return index * format->bits / 32;
}

static void put_code(const struct number_format *format, uint32_t *codes, uint32_t index,
                     uint32_t code)
{
    uint32_t bit, word = code_place(format, index, &bit);
    codes[word] |= code << bit;
    if (bit + format->bits > 32)
        codes[word + 1] |= code >> (32 - bit);
}

static uint32_t get_code(const struct number_format *format, const uint32_t *codes, uint32_t index)
{
    uint32_t bit, word = code_place(format, index, &bit);
    uint64_t both = codes[word];
    if (bit + format->bits > 32)
        both |= (uint64_t)codes[word + 1] << 32;
    return (uint32_t)(both >> bit & (((uint64_t)1 << format->bits) - 1));
}

static void put_frame(const struct number_frame *frame, uint32_t word[4])
{
    for (int k = 0; k < 3; k++)
        word[k] = float_bits(frame->origin[k]);
    word[3] = frame->scale[0] | frame->scale[1] << 8 | frame->scale[2] << 16;
}

static struct number_frame get_frame(const uint32_t word[4])
{
    struct number_frame frame;
    for (int k = 0; k < 3; k++) {
        frame.origin[k] = float_from_bits(word[k]);
        frame.scale[k] = word[3] >> 8 * k & 255;
    }
    return frame;
}

static uint32_t words_of(const struct layout *layout)
{
    return layout->node_bytes / 4;
}

/* --- packing ---------------------------------------------------------------------------------- */

/* A tree being packed. */
struct packing {
    const struct layout *layout;
    const struct layouts_grid *grid;
    const struct bvh *bvh;
    const struct wide_tree *tree;
    struct number_frame frame;              /* of the scene, if used */
    const struct number_frame *scene_frame; /* &frame, or NULL if not used */
    uint32_t before;                        /* records before the root */
    uint32_t item_count;                    /* items written so far */
    struct packed *out;
};

static enum status refuse_bounds(const struct layout *layout, const struct box *box,
                                 struct reason *reason)
{
    const struct number_format *format = grid_of(layout)->format;
    float most = grid_of(layout)->frame == ABI_FRAME_WORLD ? format->number(format->last)
                                                           : ldexpf(1, NUMBER_FRAME_MOST);
    float worst = 0;
    for (int k = 0; k < 3; k++) {
        worst = box->lo[k] < -most ? box->lo[k] : worst;
        worst = box->hi[k] > most ? box->hi[k] : worst;
    }
    if (worst == 0)
        return fail(reason, STATUS_LIMIT,
                    "%s: a box, x %.9g to %.9g, y %.9g to %.9g, z %.9g to %.9g, lies beyond the "
                    "frame",
                    layout->name, (double)box->lo[0], (double)box->hi[0], (double)box->lo[1],
                    (double)box->hi[1], (double)box->lo[2], (double)box->hi[2]);
    return fail(reason, STATUS_LIMIT,
                "%s: a bound is at most %.9g in magnitude, the tree has %.9g; scale or move the "
                "scene, or use layout f32",
                layout->name, (double)most, (double)worst);
}

static enum status put_box(const struct layout *layout, const struct number_frame *frame,
                           const struct box *box, uint32_t slot, uint32_t *codes,
                           struct reason *reason)
{
    const struct number_format *format = grid_of(layout)->format;
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t lo, hi;
        if (!number_encode(format, frame, (int)k, box->lo[k], false, &lo) ||
            !number_encode(format, frame, (int)k, box->hi[k], true, &hi)) {
            enum status status = refuse_bounds(layout, box, reason);
            if (status)
                return status;
        }
        put_code(format, codes, 6 * slot + 2 * k, lo);
        put_code(format, codes, 6 * slot + 2 * k + 1, hi);
    }
    return STATUS_OK;
}

/* Writes the boxes of a record's slots, and its frame. scene_frame: the scene's frame, or NULL. */
static enum status put_boxes(const struct layout *layout, const struct box *const box[WIDE_MAX],
                             const struct number_frame *scene_frame, uint32_t *word,
                             struct reason *reason)
{
    uint32_t head = head_words(grid_of(layout), layout->width);
    uint32_t *codes = word + head;
    const struct number_frame *frame = scene_frame;
    struct number_frame own;
    enum status status = STATUS_OK;
    memset(codes, 0, (words_of(layout) - head) * sizeof *codes);
    if (grid_of(layout)->frame == ABI_FRAME_NODE) {
        struct box bounds = wide_nodes_frame(box);
        if (!number_frame_make(grid_of(layout)->format, &bounds, &own))
            return refuse_bounds(layout, &bounds, reason);
        put_frame(&own, codes - 4);
        frame = &own;
    }
    for (uint32_t slot = 0; slot < layout->width && !status; slot++)
        if (box[slot])
            status = put_box(layout, frame, box[slot], slot, codes, reason);
    return status;
}

/* Returns the byte of a slot; writes the items of a leaf. */
static uint32_t put_child(struct packing *p, const struct wide_child *child, uint32_t item_base,
                          uint32_t *inner)
{
    if (child->count == 0)
        return SLOT_INNER + (*inner)++;
    uint32_t first = p->item_count - item_base;
    memcpy(p->out->item + p->item_count, p->bvh->prim + child->first,
           child->count * sizeof *p->out->item);
    p->item_count += child->count;
    return (child->count - 1) << SLOT_ITEMS | first;
}

static enum status put_node(struct packing *p, uint32_t index, struct reason *reason)
{
    const struct wide_node *node = &p->tree->node[index];
    uint32_t *word = p->out->word + (size_t)(index + p->before) * words_of(p->layout);
    const struct box *box[WIDE_MAX];
    uint32_t inner = 0;
    wide_nodes_tree_boxes(p->tree, index, box);
    word[1] = p->item_count;
    for (uint32_t slot = 0; slot < p->layout->width; slot++) {
        uint32_t byte = SLOT_EMPTY;
        if (slot < node->count) {
            const struct wide_child *child = &p->tree->child[node->first + slot];
            if (child->count == 0 && inner == 0)
                word[0] = child->first + p->before;
            byte = put_child(p, child, word[1], &inner);
        }
        word[2 + slot / 4] |= byte << slot % 4 * 8;
    }
    return put_boxes(p->layout, box, p->scene_frame, word, reason);
}

static enum status put_tree(struct packing *p, struct reason *reason)
{
    uint64_t records = (uint64_t)p->tree->node_count + p->before;
    uint32_t width = p->layout->width;
    if (records * (1 + width) > UINT32_MAX)
        return fail(reason, STATUS_LIMIT,
                    "%s: %llu records are more than %u; use a wider layout, or layout f32",
                    p->layout->name, (unsigned long long)records, UINT32_MAX / (1 + width));
    enum status status = layout_alloc(p->layout->name, records, words_of(p->layout),
                                      p->bvh->prim_count, p->out, reason);
    if (status)
        return status;
    p->out->ref_count = p->out->node_count * (1 + width);
    p->out->root = p->before;
    if (p->grid->frame == ABI_FRAME_SCENE) {
        const struct box *box[WIDE_MAX];
        wide_nodes_tree_boxes(p->tree, 0, box);
        struct box bounds = wide_nodes_frame(box);
        if (!number_frame_make(p->grid->format, &bounds, &p->frame))
            return refuse_bounds(p->layout, &bounds, reason);
        put_frame(&p->frame, p->out->word);
        p->scene_frame = &p->frame;
    }
    for (uint32_t i = 0; i < p->tree->node_count && !status; i++)
        status = put_node(p, i, reason);
    return status;
}

static enum status pack(const struct layout *self, const struct bvh *bvh, const struct scene *scene,
                        struct packed *out, struct reason *reason)
{
    /* A test of a slot costs half as much as a test of a triangle. */
    const struct wide_rule rule = {
        .width = self->width, .leaf_most = GRID_LEAF_MOST, .node_cost = (float)self->width / 2};
    struct wide_tree tree = {0};
    enum status status = layout_check_finite(self->name, bvh, scene, reason);
    if (!status)
        status = wide_tree_make(bvh, scene, &rule, &tree, reason);
    if (!status) {
        struct packing p = {.layout = self,
                            .grid = grid_of(self),
                            .bvh = bvh,
                            .tree = &tree,
                            .before = grid_of(self)->frame == ABI_FRAME_SCENE ? 1 : 0,
                            .out = out};
        status = put_tree(&p, reason);
    }
    wide_tree_free(&tree);
    return status;
}

/* --- reading ---------------------------------------------------------------------------------- */

static void decode_box(const struct layouts_grid *grid, const struct number_frame *frame,
                       const uint32_t *codes, uint32_t slot, struct box *out)
{
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t lo = get_code(grid->format, codes, 6 * slot + 2 * k);
        uint32_t hi = get_code(grid->format, codes, 6 * slot + 2 * k + 1);
        out->lo[k] = number_decode(grid->format, frame, (int)k, lo);
        out->hi[k] = number_decode(grid->format, frame, (int)k, hi);
    }
}

static void decode(const struct packed *packed, uint32_t record, struct wide_slot *out)
{
    const struct layouts_grid *grid = grid_of(packed->layout);
    uint32_t width = packed->layout->width;
    const uint32_t *word = packed->word + (size_t)record * words_of(packed->layout);
    const uint32_t *codes = word + head_words(grid, width);
    struct number_frame frame = get_frame(grid->frame == ABI_FRAME_NODE ? codes - 4 : packed->word);
    for (uint32_t slot = 0; slot < width; slot++) {
        uint32_t byte = word[2 + slot / 4] >> slot % 4 * 8 & 255;
        struct wide_slot *s = &out[slot];
        *s = (struct wide_slot){.there = true};
        if (byte < SLOT_INNER) {
            s->first = word[1] + (byte & 31);
            s->count = (byte >> SLOT_ITEMS) + 1;
        } else {
            s->first = word[0] + (byte - SLOT_INNER);
            s->there = byte < SLOT_INNER + WIDE_MAX; /* wide_nodes.c: is there such a node? */
        }
        decode_box(grid, grid->frame == ABI_FRAME_WORLD ? NULL : &frame, codes, slot, &s->box);
    }
}

static enum status rebound(struct packed *packed, uint32_t ref, const struct box *own,
                           const struct wide *node, struct reason *reason)
{
    (void)own;
    const struct number_frame scene_frame = get_frame(packed->word);
    struct wide_slot slot[WIDE_MAX];
    const struct box *box[WIDE_MAX];
    decode(packed, ref, slot);
    wide_nodes_boxes(packed, slot, packed->node_count, node, box);
    return put_boxes(packed->layout, box,
                     grid_of(packed->layout)->frame == ABI_FRAME_SCENE ? &scene_frame : NULL,
                     packed->word + (size_t)ref * words_of(packed->layout), reason);
}

/* --- the members ------------------------------------------------------------------------------ */

#define CHILDREN_2 "2 children"
#define CHILDREN_4 "4 children"
#define CHILDREN_8 "8 children"
#define IN_world   ""
#define IN_scene   " in the scene's frame"
#define IN_node    " in each node's frame"
#define BITS_f32   32
#define BITS_f16   16
#define BITS_bf16  16
#define BITS_u8    8
#define BITS_u10   10
#define BITS_u12   12
#define BITS_u16   16
#define AS_f32     "float32"
#define AS_f16     "float16"
#define AS_bf16    "bfloat16"
#define AS_u8      "8-bit integers"
#define AS_u10     "10-bit integers"
#define AS_u12     "12-bit integers"
#define AS_u16     "16-bit integers"

#define MEMBER(children, format_, FORMAT, frame_, FRAME)                                           \
    extern const struct layout GRID_SYMBOL(children, format_, frame_);                             \
    const struct layout GRID_SYMBOL(children, format_, frame_) = {                                 \
        .name = "bvh" #children "_" #format_ "_" #frame_,                                          \
        .summary = CHILDREN_##children ", bounds as " AS_##format_ IN_##frame_,                    \
        .node_bytes =                                                                              \
            4 * (HEAD_WORDS(children, ABI_FRAME_##FRAME) + CODE_WORDS(children, BITS_##format_)),  \
        .width = children,                                                                         \
        .slots = true,                                                                             \
        .order = VISIT_NEAR,                                                                       \
        .shader = "grid" #children,                                                                \
        .family = &(                                                                               \
            const struct layouts_grid){{.decode = decode}, &number_##format_, ABI_FRAME_##FRAME},  \
        .constant = {ABI_NUMBER_##FORMAT, ABI_FRAME_##FRAME},                                      \
        .pack = pack,                                                                              \
        .load = wide_form_load,                                                                    \
        .box = wide_form_box,                                                                      \
        .rebound = rebound,                                                                        \
        .item = wide_nodes_item,                                                                   \
    };

GRID_MEMBERS(MEMBER)
