/* Layout `rtrs_direct`: RTRS's 48-byte node, as its shader reads it. RTRS reorders its triangles
 * after uploading them (F3), behind a null triangle at index 0 (F2). So the leaf of items s .. s +
 * c - 1 tests the scene's triangles s - 1 .. s + c - 2, not the tree's; slot 0 is the null
 * triangle, and the last triangle is never tested. Therefore there is no item array. */
#include "ref/layouts/common.h"

#include <string.h>

#define WORDS (sizeof(struct node_rtrs_direct) / 4)

static struct node_rtrs_direct node_at(const struct packed *packed, uint32_t ref)
{
    struct node_rtrs_direct node;
    memcpy(&node, packed->word + (size_t)ref * WORDS, sizeof node);
    return node;
}

static enum status pack(const struct layout *self, const struct bvh *bvh, const struct scene *scene,
                        struct packed *out, struct reason *reason)
{
    (void)self;
    (void)scene;
    enum status status = layout_alloc("rtrs_direct", bvh->node_count, WORDS, 0, out, reason);
    for (uint32_t i = 0; i < bvh->node_count && !status; i++) {
        const struct bvh_node *from = &bvh->node[i];
        struct node_rtrs_direct node = {.fst = from->fst,
                                        .snd = from->snd,
                                        .item_first = from->item_first,
                                        .item_count = from->item_count};
        memcpy(node.lo, from->bounds.lo, sizeof node.lo);
        memcpy(node.hi, from->bounds.hi, sizeof node.hi);
        memcpy(out->word + (size_t)i * WORDS, &node, sizeof node);
    }
    return status;
}

static void load(const struct packed *packed, uint32_t ref, struct wide *out)
{
    struct node_rtrs_direct node = node_at(packed, ref);
    out->child_count = 0;
    out->item_first = node.item_first;
    out->item_count = node.item_count;
    if (node.item_count > 0)
        return;
    layout_add_child(packed, node.fst, out);
    layout_add_child(packed, node.snd, out);
}

static struct box box(const struct packed *packed, uint32_t ref)
{
    struct node_rtrs_direct node = node_at(packed, ref);
    struct box box;
    memcpy(box.lo, node.lo, sizeof box.lo);
    memcpy(box.hi, node.hi, sizeof box.hi);
    return box;
}

static uint32_t item(const struct packed *packed, uint32_t slot)
{
    return slot > 0 && slot <= packed->tri_count ? slot - 1 : ABI_NO_PRIM;
}

extern const struct layout layout_rtrs_direct;
const struct layout layout_rtrs_direct = {
    .name = "rtrs_direct",
    .summary = "RTRS's 48-byte nodes, its triangle numbering included",
    .node_bytes = sizeof(struct node_rtrs_direct),
    .width = 2,
    .order = VISIT_SND,
    .faithful = true,
    .pack = pack,
    .load = load,
    .box = box,
    .item = item,
};
