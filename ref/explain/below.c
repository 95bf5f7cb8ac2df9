/* What leaves name below a reference of a packed tree. */
#include "ref/explain/tree.h"

#include "ref/store.h"

/* What is looked for below a reference. The words may hold a cycle: at most `left` nodes are looked
 * at, DEPTH_MOST below each other. */
struct look_below {
    const struct explain_tree *tree;
    uint32_t prim, left;
    bool found;
    struct box all;
};

#define DEPTH_MOST 128u

static void look_at(struct look_below *below, uint32_t ref, uint32_t depth)
{
    const struct packed *packed = below->tree->packed;
    struct wide wide;
    if (below->left == 0 || depth == DEPTH_MOST)
        return;
    below->left--;
    packed->layout->load(packed, ref, &wide);
    for (uint32_t slot = 0; wide.child_count == 0 && slot < wide.item_count; slot++) {
        uint32_t prim = packed_item(packed, &wide, slot);
        if (prim >= below->tree->scene->tri_count)
            continue;
        struct box one = scene_tri_bounds(below->tree->scene, prim);
        box_add_box(&below->all, &one);
        below->found |= prim == below->prim;
    }
    for (uint32_t c = 0; c < wide.child_count; c++)
        look_at(below, wide.child[c], depth + 1);
}

bool explain_names(const struct explain_tree *tree, uint32_t ref, uint32_t prim, struct box *bounds)
{
    struct look_below below = {tree, prim, tree->packed->ref_count, false, box_empty()};
    look_at(&below, ref, 0);
    if (bounds)
        *bounds = below.all;
    return below.found;
}
