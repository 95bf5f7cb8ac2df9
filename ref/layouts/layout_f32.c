/* Layout `f32`: struct node_f32 in pre-order, 32 bytes, and the tree's item array prim. The
 * baseline: any leaf size, bounds unchanged. */
#include "ref/layouts/common.h"
#include "ref/store.h"

#include <string.h>

#define WORDS (sizeof(struct node_f32) / 4)

static struct node_f32 node_at(const struct packed *packed, uint32_t ref)
{
    struct node_f32 node;
    memcpy(&node, packed->word + (size_t)ref * WORDS, sizeof node);
    return node;
}

static enum status pack(const struct layout *self, const struct bvh *bvh, const struct scene *scene,
                        struct packed *out, struct reason *reason)
{
    (void)self;
    enum status status = layout_check_finite("f32", bvh, scene, reason);
    if (!status)
        status = layout_alloc("f32", bvh->node_count, WORDS, 0, out, reason);
    for (uint32_t i = 0; i < bvh->node_count && !status; i++) {
        const struct bvh_node *from = &bvh->node[i];
        struct node_f32 node = {.first = from->snd, .count = from->item_count};
        if (from->item_count > 0)
            status = store_put(scene, bvh->prim + from->item_first, from->item_count, out,
                               &node.first, reason);
        memcpy(node.lo, from->bounds.lo, sizeof node.lo);
        memcpy(node.hi, from->bounds.hi, sizeof node.hi);
        memcpy(out->word + (size_t)i * WORDS, &node, sizeof node);
    }
    return status;
}

static void load(const struct packed *packed, uint32_t ref, struct wide *out)
{
    struct node_f32 node = node_at(packed, ref);
    out->child_count = 0;
    out->item_first = node.first;
    out->item_count = node.count;
    if (node.count > 0)
        return;
    layout_add_child(packed, ref + 1, out);
    layout_add_child(packed, node.first, out);
}

static struct box box(const struct packed *packed, uint32_t ref)
{
    struct node_f32 node = node_at(packed, ref);
    struct box box;
    memcpy(box.lo, node.lo, sizeof box.lo);
    memcpy(box.hi, node.hi, sizeof box.hi);
    return box;
}

static enum status rebound(struct packed *packed, uint32_t ref, const struct box *own,
                           const struct wide *node, struct reason *reason)
{
    (void)node, (void)reason;
    struct node_f32 to = node_at(packed, ref);
    memcpy(to.lo, own->lo, sizeof to.lo);
    memcpy(to.hi, own->hi, sizeof to.hi);
    memcpy(packed->word + (size_t)ref * WORDS, &to, sizeof to);
    return STATUS_OK;
}

extern const struct layout layout_f32;
const struct layout layout_f32 = {
    .name = "f32",
    .summary = "32-byte nodes, bounds in float32, index array; the baseline",
    .node_bytes = sizeof(struct node_f32),
    .width = 2,
    .order = VISIT_NEAR,
    .pack = pack,
    .load = load,
    .box = box,
    .rebound = rebound,
};
