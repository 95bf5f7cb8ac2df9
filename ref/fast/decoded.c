#include "ref/fast/decoded.h"

#include "ref/packed/packed_unpack.h"
#include "ref/store.h"

#include <stdlib.h>

#define DEPTH_MOST 4096

struct decoding {
    const struct packed *packed;
    const struct scene *scene;
    struct bvh *bvh;
    size_t node_capacity;
    uint32_t prims_most;
};

/* The children first .. first + count - 1 of a node. */
struct some {
    const struct wide *of;
    uint32_t first, count;
};

static enum status decode_children(struct decoding *d, const struct some *some, uint32_t depth);

static enum status add_node(struct decoding *d, uint32_t *index)
{
    enum status status = array_reserve(&d->bvh->node, &d->node_capacity,
                                       (size_t)d->bvh->node_count + 1, sizeof *d->bvh->node);
    if (!status) {
        *index = d->bvh->node_count++;
        d->bvh->node[*index] = (struct bvh_node){.item_first = d->bvh->prim_count};
    }
    return status;
}

/* Appends the triangles of a leaf that the scene has, and counts them. */
static enum status add_items(struct decoding *d, const struct wide *leaf, uint32_t *count)
{
    *count = 0;
    for (uint32_t i = 0; i < leaf->item_count; i++) {
        uint32_t prim = packed_item(d->packed, leaf, i);
        if (prim >= d->scene->tri_count)
            continue;
        if (d->bvh->prim_count == d->prims_most)
            return STATUS_UNSUPPORTED;
        d->bvh->prim[d->bvh->prim_count++] = prim;
        (*count)++;
    }
    return STATUS_OK;
}

/* Appends the subtree of a node. Appends nothing if it has no triangles. */
static enum status decode_node(struct decoding *d, uint32_t ref, const struct box *box,
                               uint32_t depth)
{
    struct wide *wide = malloc(sizeof *wide);
    uint32_t index = 0, count = 0;
    if (!wide)
        return STATUS_MEMORY;
    d->packed->layout->load(d->packed, ref, wide);
    enum status status = STATUS_OK;
    if (wide->child_count > 0) {
        struct some all = {wide, 0, wide->child_count};
        status = decode_children(d, &all, depth + 1);
    } else if (wide->item_count > 0) {
        status = add_node(d, &index);
        if (!status)
            status = add_items(d, wide, &count);
        d->bvh->node_count -= !status && count == 0;
        if (!status && count > 0) {
            d->bvh->node[index].bounds = *box;
            d->bvh->node[index].item_count = count;
        }
    }
    free(wide);
    return status;
}

/* Appends the subtree of some children of a node. */
static enum status decode_children(struct decoding *d, const struct some *some, uint32_t depth)
{
    if (depth > DEPTH_MOST)
        return STATUS_UNSUPPORTED;
    if (some->count == 1)
        return decode_node(d, some->of->child[some->first], &some->of->box[some->first], depth);
    const uint32_t half = some->count / 2;
    struct some part[2] = {{some->of, some->first, half},
                           {some->of, some->first + half, some->count - half}};
    uint32_t index = 0;
    enum status status = add_node(d, &index);
    if (!status)
        status = decode_children(d, &part[0], depth + 1);
    uint32_t snd = d->bvh->node_count;
    if (!status)
        status = decode_children(d, &part[1], depth + 1);
    if (status)
        return status;
    struct bvh *bvh = d->bvh;
    if (snd > index + 1 && bvh->node_count > snd) {
        struct bvh_node *node = &bvh->node[index];
        *node = (struct bvh_node){
            .bounds = box_empty(), .fst = index + 1, .snd = snd, .item_first = node->item_first};
        for (uint32_t i = 0; i < some->count; i++)
            box_add_box(&node->bounds, &some->of->box[some->first + i]);
        return STATUS_OK;
    }
    /* One half is empty: the other one replaces this node. */
    for (uint32_t i = index; i + 1 < bvh->node_count; i++) {
        bvh->node[i] = bvh->node[i + 1];
        bvh->node[i].fst -= bvh->node[i].fst > 0;
        bvh->node[i].snd -= bvh->node[i].snd > 0;
    }
    bvh->node_count--;
    return STATUS_OK;
}

enum status fast_decode(const struct packed *packed, const struct scene *scene, struct bvh *out,
                        struct reason *reason)
{
    *out = (struct bvh){.tri_count = scene->tri_count};
    struct decoding d = {
        .packed = packed, .scene = scene, .bvh = out, .prims_most = packed_prims_most(packed)};
    struct box root = packed->layout->box(packed, packed->root);
    out->prim = alloc_zeroed(d.prims_most, sizeof *out->prim);
    enum status status = out->prim ? decode_node(&d, packed->root, &root, 0) : STATUS_MEMORY;
    if (!status && out->node_count == 0)
        status = STATUS_UNSUPPORTED;
    if (!status)
        return STATUS_OK;
    bvh_free(out);
    return status == STATUS_MEMORY
               ? fail(reason, status, "fast: no memory to decode a tree of %u records",
                      packed->node_count)
               : fail(reason, status, "fast: this packed tree cannot be converted");
}
