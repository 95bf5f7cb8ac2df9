#include "ref/tree/subtree.h"

#include <stdlib.h>

/* Nodes are in pre-order: the last of a subtree is reached by its second children. */
struct subtree_range subtree_range(const struct bvh *bvh, uint32_t node)
{
    uint32_t last = node;
    while (bvh->node[last].item_count == 0)
        last = bvh->node[last].snd;
    const struct bvh_node *leaf = &bvh->node[last];
    return (struct subtree_range){bvh->node[node].item_first, leaf->item_first + leaf->item_count,
                                  last};
}

enum status subtree_make(const struct bvh *bvh, uint32_t node, struct bvh *out)
{
    const struct subtree_range range = subtree_range(bvh, node);
    *out = (struct bvh){.node_count = range.last - node + 1,
                        .prim_count = range.end - range.first,
                        .tri_count = bvh->tri_count};
    out->node = alloc_copy(bvh->node + node, out->node_count, sizeof *out->node);
    out->prim = alloc_copy(bvh->prim + range.first, out->prim_count, sizeof *out->prim);
    if (!out->node || !out->prim) {
        bvh_free(out);
        return STATUS_MEMORY;
    }
    for (uint32_t i = 0; i < out->node_count; i++) {
        struct bvh_node *at = &out->node[i];
        at->item_first -= range.first;
        if (at->item_count == 0) {
            at->fst -= node;
            at->snd -= node;
        }
    }
    return STATUS_OK;
}
