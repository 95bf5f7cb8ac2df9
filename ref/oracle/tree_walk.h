/* Visits the leaves of a tree that a ray may meet, nearest entry first as far as a stack does that.
 * For the oracle's own files. */
#ifndef ORACLE_TREE_WALK_H
#define ORACLE_TREE_WALK_H

#include "ref/abi.h"
#include "ref/oracle/oracle_tree.h"

#include <math.h>

/* A child that waits: side at & 1 of node at >> 1. */
struct tree_entry {
    double near;
    uint32_t at;
};

struct tree_walk {
    const struct tree *tree;
    double o[3], inverse[3];
    double tmin;
    bool still[3];    /* the direction is 0 along this axis */
    bool backward[3]; /* it is negative */
    unsigned top;
    struct tree_entry stack[TREE_DEPTH + 2]; /* one to write on that may not be kept */
};

/* A run of triangles of tree.order, and a bound on |v - o| in every axis of each. */
struct tree_leaf {
    uint32_t first, count;
    double largest;
};

static inline double tree_max(double a, double b)
{
    return a > b ? a : b;
}

static inline double tree_min(double a, double b)
{
    return a < b ? a : b;
}

/* Entry and exit of both children along axis k. */
static inline void tree_slab(const struct tree_walk *walk, const struct tree_node *node, int k,
                             double near[2], double far[2])
{
    const float *in = walk->backward[k] ? node->hi[k] : node->lo[k];
    const float *out = walk->backward[k] ? node->lo[k] : node->hi[k];
    double o = walk->o[k], inverse = walk->inverse[k];
    for (int side = 0; side < 2; side++) {
        near[side] = tree_max(near[side], ((double)in[side] - o) * inverse);
        far[side] = tree_min(far[side], ((double)out[side] - o) * inverse);
    }
}

/* The same where the direction is 0: beside the slab, nothing is entered. */
static inline void tree_still(const struct tree_walk *walk, const struct tree_node *node, int k,
                              double near[2])
{
    for (int side = 0; side < 2; side++)
        if (walk->o[k] < (double)node->lo[k][side] || walk->o[k] > (double)node->hi[k][side])
            near[side] = INFINITY;
}

/* Pushes the children of a node that the ray enters no later than `reach`, the nearer one last.
 * Which of them it enters is hard to predict: no branches. */
static inline void tree_push(struct tree_walk *walk, uint32_t at, double reach, double near[2],
                             double far[2])
{
    unsigned enters[2];
    for (int side = 0; side < 2; side++) {
        near[side] -= fabs(near[side]) * TREE_PAD;
        far[side] += fabs(far[side]) * TREE_PAD;
        enters[side] = (unsigned)(near[side] <= far[side]) & (unsigned)(near[side] <= reach) &
                       (unsigned)(far[side] >= walk->tmin);
    }
    unsigned last = near[1] < near[0], first = 1 - last;
    walk->stack[walk->top] = (struct tree_entry){near[first], 2 * at + first};
    walk->top += enters[first];
    walk->stack[walk->top] = (struct tree_entry){near[last], 2 * at + last};
    walk->top += enters[last];
}

static inline void tree_visit(struct tree_walk *walk, uint32_t at, double reach)
{
    const struct tree_node *node = &walk->tree->node[at];
    double near[2] = {-INFINITY, -INFINITY}, far[2] = {INFINITY, INFINITY};
    for (int k = 0; k < 3; k++)
        if (walk->still[k])
            tree_still(walk, node, k, near);
        else
            tree_slab(walk, node, k, near, far);
    tree_push(walk, at, reach, near, far);
}

/* The direction is not 0 in every axis. */
static inline void tree_walk_start(struct tree_walk *walk, const struct tree *tree,
                                   const struct ray *ray)
{
    walk->tree = tree;
    walk->top = 0;
    walk->tmin = (double)ray->tmin;
    for (int k = 0; k < 3; k++) {
        walk->o[k] = (double)ray->org[k];
        walk->still[k] = ray->dir[k] == 0;
        walk->backward[k] = ray->dir[k] < 0;
        walk->inverse[k] = walk->still[k] ? 0 : 1 / (double)ray->dir[k];
    }
    tree_visit(walk, 0, (double)ray->tmax);
}

/* What lies on top of the stack. */
enum tree_step {
    TREE_END, /* nothing */
    TREE_IS_LEAF,
    TREE_IS_NODE,
};

/* Takes the next child that the ray may enter at t <= reach: a leaf, or a node to be visited. */
static inline enum tree_step tree_pop(struct tree_walk *walk, double reach, struct tree_leaf *leaf,
                                      uint32_t *inner)
{
    while (walk->top > 0) {
        struct tree_entry entry = walk->stack[--walk->top];
        if (entry.near > reach)
            continue;
        const struct tree_node *node = &walk->tree->node[entry.at >> 1];
        uint32_t side = entry.at & 1;
        if (node->count[side] == 0) {
            *inner = node->child[side];
            return TREE_IS_NODE;
        }
        leaf->first = node->child[side];
        leaf->count = node->count[side];
        leaf->largest = 0;
        for (int k = 0; k < 3; k++) {
            double below = walk->o[k] - (double)node->lo[k][side];
            double above = (double)node->hi[k][side] - walk->o[k];
            leaf->largest = tree_max(leaf->largest, tree_max(below, above));
        }
        return TREE_IS_LEAF;
    }
    return TREE_END;
}

/* The next leaf that the ray may enter at t <= reach, which may shrink from call to call; false if
 * there is none. */
static inline bool tree_walk_next(struct tree_walk *walk, double reach, struct tree_leaf *leaf)
{
    enum tree_step step;
    uint32_t inner;
    while ((step = tree_pop(walk, reach, leaf, &inner)) == TREE_IS_NODE)
        tree_visit(walk, inner, reach);
    return step == TREE_IS_LEAF;
}

#endif
