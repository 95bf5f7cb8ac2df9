#include "ref/look/look_decoded.h"

#include "ref/packed/packed_unpack.h"
#include "ref/store.h"

/* Nodes that wait to be decoded. */
struct look_waiting {
    uint32_t ref, parent;
    struct box box;
};

struct look_decoding {
    const struct packed *packed;
    struct bvh bvh;
    struct look_waiting stack[ABI_STACK_MAX + 2];
    uint32_t depth;
    uint32_t node_most, prim_most, tri_count;
};

/* False if it has more than there can be. */
static bool add_items(struct look_decoding *d, const struct wide *wide, struct bvh_node *node)
{
    if (wide->item_count > (d->tri_count < 8 ? 8 : d->tri_count)) /* slots can be empty */
        return false;
    for (uint32_t i = 0; i < wide->item_count; i++) {
        uint32_t prim = packed_item(d->packed, wide, i);
        if (prim == ABI_NO_PRIM)
            continue;
        if (d->bvh.prim_count == d->prim_most || prim >= d->tri_count)
            return false;
        d->bvh.prim[d->bvh.prim_count++] = prim;
        node->item_count++;
    }
    return node->item_count > 0;
}

/* The next node in pre-order. */
static bool add_node(struct look_decoding *d)
{
    struct look_waiting now = d->stack[--d->depth];
    struct wide wide;
    uint32_t index = d->bvh.node_count;
    if (index == d->node_most || !packed_ref_valid(d->packed, now.ref))
        return false;
    struct bvh_node *node = &d->bvh.node[index];
    d->packed->layout->load(d->packed, now.ref, &wide);
    *node = (struct bvh_node){.bounds = now.box, .item_first = d->bvh.prim_count};
    d->bvh.node_count++;
    if (index > 0 && index != now.parent + 1)
        d->bvh.node[now.parent].snd = index;
    if (wide.child_count == 0)
        return add_items(d, &wide, node);
    if (wide.child_count != 2 || d->depth + 2 > ARRAY_COUNT(d->stack))
        return false;
    node->fst = index + 1;
    for (int c = 1; c >= 0; c--)
        d->stack[d->depth++] = (struct look_waiting){wide.child[c], index, wide.box[c]};
    return true;
}

enum status decoded_tree(const struct packed *packed, const struct scene *scene, struct bvh *out,
                         struct reason *reason)
{
    struct look_decoding d = {.packed = packed,
                              .bvh.tri_count = scene->tri_count,
                              .node_most = packed->node_count,
                              .prim_most = packed_prims_most(packed),
                              .tri_count = scene->tri_count};
    *out = (struct bvh){0};
    d.bvh.node = alloc_zeroed(d.node_most, sizeof *d.bvh.node);
    d.bvh.prim = alloc_zeroed(d.prim_most, sizeof *d.bvh.prim);
    if (!d.bvh.node || !d.bvh.prim) {
        bvh_free(&d.bvh);
        return fail(reason, STATUS_MEMORY, "no memory to decode %u records", packed->node_count);
    }
    if (packed->node_count > 0 && packed_ref_valid(packed, packed->root))
        d.stack[d.depth++] =
            (struct look_waiting){packed->root, 0, packed->layout->box(packed, packed->root)};
    bool sound = true;
    while (d.depth > 0 && sound)
        sound = add_node(&d);
    struct reason why = {""};
    enum status status = sound ? bvh_check_form(&d.bvh, scene, &why) : STATUS_INPUT;
    if (!status) {
        *out = d.bvh;
        return STATUS_OK;
    }
    bvh_free(&d.bvh);
    if (status == STATUS_MEMORY)
        return fail(reason, status, "%s", why.text);
    return fail(reason, STATUS_INPUT,
                "%s: the packed bytes do not decode to a tree of the scene%s%s",
                packed->layout->name, why.text[0] ? ": " : "", why.text);
}
