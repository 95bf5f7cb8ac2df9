/* shinjiogaki/bvh#3: threads go up from the leaves, and the first of two to come to a parent goes
 * on in place of the second: some boxes are made while one child has its old box. */
#define SPOIL_REFIT refit_early
#include "tests/reported/reported_tracer.h"

static void refit_early(struct reported_tree *tree)
{
    for (uint32_t at = 0; at < tree->count; at++) {
        struct reported_node *node = &tree->node[at];
        if (node->child)
            continue;
        box_of(tree, node->first, node->count, node);
        for (uint32_t from = at, up = node->parent; up != NO_NODE; up = tree->node[up].parent) {
            const bool second = from > tree->node[up].child;
            if (second) /* the parent is done, by the thread that came first */
                break;
            join(&tree->node[up], &tree->node[tree->node[up].child]);
            from = up;
        }
    }
}
