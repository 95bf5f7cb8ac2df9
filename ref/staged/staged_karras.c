/* The hierarchy of Karras 2012 (Maximizing parallelism in the construction of BVHs, octrees, and
 * k-d trees) with his numbers of nodes: a node has the number of the end of its range that is next
 * to its sibling, the root 0. Here it is made from the top down. */
#include "ref/staged/staged_inner.h"

/* Returns the link of a range's node, whose number is given. The depth is at most the bits of a
 * code and of a place. */
static uint32_t make(struct staged *staged, uint32_t first, uint32_t last, uint32_t number)
{
    if (first == last)
        return STAGED_LEAF | first;
    uint32_t cut = stage_cut(staged, first, last);
    uint32_t a = make(staged, first, cut, cut), b = make(staged, cut + 1, last, cut + 1);
    staged->child[number][0] = a;
    staged->child[number][1] = b;
    staged_box_join(staged_box(staged, a), staged_box(staged, b), staged->box[number]);
    return number;
}

void stage_karras(struct staged *staged)
{
    staged->root = make(staged, 0, staged->count - 1, 0);
}
