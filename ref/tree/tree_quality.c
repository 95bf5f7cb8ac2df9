#include "ref/tree/tree_quality.h"

static uint32_t items_of(const struct bvh_node *node)
{
    return node->item_count;
}

double tree_sah(const struct bvh *bvh)
{
    double sum = 0, root = bvh->node_count ? box_half_area(&bvh->node[0].bounds) : 0;
    for (uint32_t i = 0; i < bvh->node_count; i++) {
        const struct bvh_node *node = &bvh->node[i];
        double cost = node->item_count ? QUALITY_TRIANGLE * items_of(node) : QUALITY_NODE;
        sum += cost * box_half_area(&node->bounds);
    }
    return root > 0 ? sum / root : 0;
}

enum status tree_quality(const struct bvh *bvh, const struct scene *scene, struct tree_quality *out,
                         struct reason *reason)
{
    *out = (struct tree_quality){.sah = tree_sah(bvh)};
    enum status status = bvh_count(bvh, scene, &out->stats, reason);
    if (out->stats.leaf_count)
        out->leaf_fill = (double)bvh->prim_count / out->stats.leaf_count;
    return status;
}
