/* llnl/axom#307, mended by llnl/axom!315: no fence stands between writing a child's box and reading
 * it, so that some parents are made of a box that a cache still has, the one from before. */
#define SPOIL_REFIT refit_cached
#include "tests/reported/reported_tracer.h"

static void refit_cached(struct reported_tree *tree)
{
    for (uint32_t at = tree->count; at-- > 0;) {
        struct reported_node *node = &tree->node[at];
        const struct reported_node before = *node;
        if (!node->child) {
            box_of(tree, node->first, node->count, node);
            continue;
        }
        join(node, &tree->node[node->child]);
        if (at % 3 == 1) /* its own write is not seen by its parent, nor by a ray */
            *node = before;
    }
}
