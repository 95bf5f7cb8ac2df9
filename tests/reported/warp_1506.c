/* NVIDIA/warp#1506: a refit from the leaves up asks whether the parent is a leaf, and of the root
 * it reads the node in front of the array. What stands there decides; here it says that the parent
 * is a leaf, so that a tree of one node keeps its old box. */
#define SPOIL_REFIT refit_parents
#include "tests/reported/reported_tracer.h"

static void refit_parents(struct reported_tree *tree)
{
    for (uint32_t at = tree->count; at-- > 0;) {
        struct reported_node *node = &tree->node[at];
        const bool parent_is_leaf =
            node->parent == NO_NODE ? !node->child : !tree->node[node->parent].child;
        if (node->child)
            join(node, &tree->node[node->child]);
        else if (!parent_is_leaf)
            box_of(tree, node->first, node->count, node);
    }
}
