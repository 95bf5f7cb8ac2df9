#include "ref/layouts/wide_nodes.h"
#include "ref/store.h"

#include <float.h>
#include <math.h>

#define EXPONENT_LEAST (-100)
#define ORIGIN_BITS    23 /* 2^23 steps: with 4096 more still an integer that float32 has */

/* The reason names the node: its kind ("tree node", "record" or "a child of node") and number. */
static enum status check_within(const struct layout *self, const struct box *box, const char *kind,
                                uint32_t node, float largest, struct reason *reason)
{
    for (int k = 0; k < 3; k++) {
        float lo = box->lo[k], hi = box->hi[k];
        if (fabsf(lo) > largest || fabsf(hi) > largest)
            return fail(reason, STATUS_LIMIT,
                        "%s: a bound is at most %.9g in magnitude, %s %u has %.9g; "
                        "scale or move the scene, or use layout f32",
                        self->name, (double)largest, kind, node,
                        (double)(fabsf(lo) > largest ? lo : hi));
    }
    return STATUS_OK;
}

enum status wide_nodes_collapse(const struct layout *self, const struct bvh *bvh,
                                const struct scene *scene, uint32_t leaf_most, float node_cost,
                                float largest, struct wide_tree *out, struct reason *reason)
{
    *out = (struct wide_tree){0};
    enum status status = layout_check_finite(self->name, bvh, scene, reason);
    for (uint32_t i = 0; i < bvh->node_count && !status; i++)
        status = check_within(self, &bvh->node[i].bounds, "tree node", i, largest, reason);
    const struct wide_rule rule = {
        .width = self->width, .leaf_most = leaf_most, .node_cost = node_cost};
    return status ? status : wide_tree_make(bvh, scene, &rule, out, reason);
}

enum status wide_nodes_items(const struct layout *self, const uint32_t *item,
                             const struct scene *scene, uint32_t places, struct wide_tree *tree,
                             struct packed *out, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (uint32_t n = 0; n < tree->node_count; n++)
        for (uint32_t c = 0; c < tree->node[n].count && !status; c++) {
            struct wide_child *child = &tree->child[tree->node[n].first + c];
            if (child->count == 0)
                continue;
            status =
                store_put(scene, item + child->first, child->count, out, &child->first, reason);
            if (!status && child->first >= places)
                status = fail(reason, STATUS_LIMIT, "%s: items lie at places below %u, not %u",
                              self->name, places, child->first);
        }
    return status;
}

/* True if a slot is a child of its node. */
static bool is_child(const struct wide_slot *slot, uint32_t inner_refs)
{
    return slot->there && (slot->count > 0 || slot->first < inner_refs);
}

void wide_nodes_boxes(const struct packed *packed, const struct wide_slot *slot,
                      uint32_t inner_refs, const struct wide *node, const struct box *box[WIDE_MAX])
{
    uint32_t next = 0;
    for (uint32_t s = 0; s < WIDE_MAX; s++) {
        bool child =
            s < packed->layout->width && next < node->child_count && is_child(&slot[s], inner_refs);
        box[s] = child ? &node->box[next++] : NULL;
    }
}

void wide_nodes_tree_boxes(const struct wide_tree *tree, uint32_t n,
                           const struct box *box[WIDE_MAX])
{
    const struct wide_node *node = &tree->node[n];
    for (uint32_t s = 0; s < WIDE_MAX; s++)
        box[s] = s < node->count ? &tree->child[node->first + s].bounds : NULL;
}

struct box wide_nodes_frame(const struct box *const box[WIDE_MAX])
{
    struct box all = box_empty();
    for (uint32_t s = 0; s < WIDE_MAX; s++)
        if (box[s])
            box_add_box(&all, box[s]);
    return all;
}

void wide_nodes_children(const struct packed *packed, const struct wide_slot *slot,
                         uint32_t inner_refs, uint32_t slot_ref, struct wide *out)
{
    out->child_count = out->item_first = out->item_count = 0;
    for (uint32_t s = 0; s < packed->layout->width; s++) {
        if (!is_child(&slot[s], inner_refs))
            continue;
        out->child[out->child_count] = slot[s].count == 0 ? slot[s].first : slot_ref + s;
        out->leaf_first[out->child_count] = slot[s].first;
        out->leaf_count[out->child_count] = slot[s].count;
        out->box[out->child_count++] = slot[s].box;
    }
}

struct box wide_nodes_union(const struct packed *packed, const struct wide_slot *slot)
{
    struct box all = box_empty();
    for (uint32_t s = 0; s < packed->layout->width; s++)
        if (slot[s].there)
            box_add_box(&all, &slot[s].box);
    return all;
}

uint32_t wide_nodes_item(const struct packed *packed, uint32_t slot)
{
    return slot < packed->item_count ? packed->item[slot] : ABI_NO_PRIM;
}

/* --- forms ------------------------------------------------------------------------------------ */

static const struct wide_form *form_of(const struct layout *layout)
{
    return layout->family;
}

static uint32_t *record_of(const struct layout *layout, const struct packed *packed,
                           uint32_t record)
{
    return packed->word + (size_t)record * (layout->node_bytes / 4);
}

static void pack_nodes(const struct layout *self, const struct wide_tree *tree, struct packed *out)
{
    const struct wide_form *form = form_of(self);
    for (uint32_t n = 0; n < tree->node_count; n++) {
        uint32_t *word = record_of(self, out, n);
        const struct box *box[WIDE_MAX];
        wide_nodes_tree_boxes(tree, n, box);
        form->put_boxes(box, word);
        form->put_children(&tree->child[tree->node[n].first], tree->node[n].count, word);
    }
}

static enum status check_places(const struct layout *self, uint32_t items, struct reason *reason)
{
    if (items > form_of(self)->places) /* there are fewer nodes than items */
        return fail(reason, STATUS_LIMIT, "%s: holds at most %u items, this tree has %u",
                    self->name, form_of(self)->places, items);
    return STATUS_OK;
}

/* Writes a tree whose bounds and number of items have been checked. */
static enum status write_tree(const struct layout *self, struct wide_tree *tree,
                              const uint32_t *item, const struct scene *scene, struct packed *out,
                              struct reason *reason)
{
    enum status status =
        layout_alloc(self->name, tree->node_count, self->node_bytes / 4, 0, out, reason);
    if (!status) {
        out->ref_count = out->node_count * layout_refs(self);
        status = wide_nodes_items(self, item, scene, form_of(self)->places, tree, out, reason);
    }
    if (!status)
        pack_nodes(self, tree, out);
    return status;
}

enum status wide_form_pack_tree(const struct layout *self, struct wide_tree *tree,
                                const uint32_t *item, uint32_t item_count,
                                const struct scene *scene, struct packed *out,
                                struct reason *reason)
{
    enum status status = check_places(self, item_count, reason);
    for (uint32_t n = 0; n < tree->node_count && !status; n++)
        for (uint32_t c = 0; c < tree->node[n].count && !status; c++)
            status = check_within(self, &tree->child[tree->node[n].first + c].bounds,
                                  "a child of node", n, form_of(self)->largest, reason);
    return status ? status : write_tree(self, tree, item, scene, out, reason);
}

enum status wide_form_pack(const struct layout *self, const struct bvh *bvh,
                           const struct scene *scene, struct packed *out, struct reason *reason)
{
    const struct wide_form *form = form_of(self);
    struct wide_tree tree = {0};
    enum status status = check_places(self, bvh->prim_count, reason);
    if (!status)
        status = wide_nodes_collapse(self, bvh, scene, self->leaf_most, form->node_cost,
                                     form->largest, &tree, reason);
    if (!status)
        status = write_tree(self, &tree, bvh->prim, scene, out, reason);
    wide_tree_free(&tree);
    return status;
}

void wide_form_load(const struct packed *packed, uint32_t ref, struct wide *out)
{
    wide_decode *decode = form_of(packed->layout)->decode;
    struct wide_slot slot[WIDE_MAX];
    uint32_t width = packed->layout->width, records = packed->node_count;
    if (ref < records) {
        decode(packed, ref, slot);
        wide_nodes_children(packed, slot, records, records + width * ref, out);
        return;
    }
    uint32_t at = ref - records;
    decode(packed, at / width, slot);
    const struct wide_slot *one = &slot[at % width];
    out->child_count = 0;
    out->item_first = one->there ? one->first : 0;
    out->item_count = one->there ? one->count : 0;
}

struct box wide_form_box(const struct packed *packed, uint32_t ref)
{
    wide_decode *decode = form_of(packed->layout)->decode;
    struct wide_slot slot[WIDE_MAX];
    uint32_t width = packed->layout->width, records = packed->node_count;
    if (ref < records) {
        decode(packed, ref, slot);
        return wide_nodes_union(packed, slot);
    }
    decode(packed, (ref - records) / width, slot);
    return slot[(ref - records) % width].box;
}

enum status wide_form_rebound(struct packed *packed, uint32_t ref, const struct box *own,
                              const struct wide *node, struct reason *reason)
{
    (void)own;
    const struct wide_form *form = form_of(packed->layout);
    const struct box *box[WIDE_MAX];
    struct wide_slot slot[WIDE_MAX];
    enum status status = STATUS_OK;
    form->decode(packed, ref, slot);
    wide_nodes_boxes(packed, slot, packed->node_count, node, box);
    for (uint32_t c = 0; c < node->child_count && !status; c++)
        status = check_within(packed->layout, &node->box[c], "record", ref, form->largest, reason);
    if (!status)
        form->put_boxes(box, record_of(packed->layout, packed, ref));
    return status;
}

/* --- frames ----------------------------------------------------------------------------------- */

/* 2^exponent. ldexp, which accepts any exponent, would take most of the time of decoding a node. */
static float step_of(int exponent)
{
    return exponent < FLT_MIN_EXP - 1 || exponent >= FLT_MAX_EXP
               ? ldexpf(1, exponent)
               : float_from_bits((uint32_t)(exponent + FLT_MAX_EXP - 1) << (FLT_MANT_DIG - 1));
}

/* Distance of x from the origin in steps. The axis was made here, so nothing overflows. */
static double steps_to(const struct node_axis *axis, float x)
{
    return ((double)x - (double)axis->origin) * (double)step_of(-axis->exponent);
}

float node_axis_plane(const struct node_axis *axis, uint32_t q)
{
    return axis->origin + (float)q * step_of(axis->exponent);
}

/* The loops correct an error in double of about one step when x and the origin are far apart. */
uint32_t node_axis_down(const struct node_axis *axis, float x)
{
    double steps = floor(steps_to(axis, x));
    uint32_t q = (uint32_t)steps;
    while (q > 0 && node_axis_plane(axis, q) > x)
        q--;
    return q;
}

uint32_t node_axis_up(const struct node_axis *axis, float x)
{
    double steps = ceil(steps_to(axis, x));
    uint32_t q = (uint32_t)steps;
    while (node_axis_plane(axis, q) < x)
        q++;
    return q;
}

struct node_axis node_axis_make(float lo, float hi, uint32_t most)
{
    int extent, place, exponent = EXPONENT_LEAST;
    float largest = fmaxf(fabsf(lo), fabsf(hi));
    (void)frexp(((double)hi - (double)lo) / most, &extent); /* below 2^extent */
    (void)frexpf(largest, &place);                          /* below 2^place */
    if (hi > lo && extent - 1 > exponent)
        exponent = extent - 1;
    if (largest > 0 && place - ORIGIN_BITS - 1 > exponent)
        exponent = place - ORIGIN_BITS - 1;
    for (;; exponent++) {
        double steps = floor(ldexp((double)lo, -exponent));
        if (fabs(steps) > ldexp(1, ORIGIN_BITS))
            continue;
        /* + 0: no negative zero */
        struct node_axis axis = {(float)ldexp(steps, exponent) + 0.0f, exponent};
        if (ldexp((double)hi - (double)axis.origin, -exponent) <= most &&
            node_axis_up(&axis, hi) <= most)
            return axis;
    }
}
