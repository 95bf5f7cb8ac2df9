/* Visits the leaves of a mesh's tree that a ray in its space may meet, where the ray is known to a
 * bound alone. For the oracle's own files.
 *
 * The exact ray o' + t d' has |o' - o| <= o_err and |d' - d| <= d_err. At t >= 0 it lies, along an
 * axis, between (o - o_err) + t (d - d_err) and (o + o_err) + t (d + d_err). So if it is in a slab
 * [lo, hi],
 *   t (d - d_err) <= hi - (o - o_err)  and  t (d + d_err) >= lo - (o + o_err):
 * two conditions linear in t, of numbers that are doubles (SIGHT_PAD covers their sums' roundings).
 * Each bounds t from below or from above, as its factor's sign says, or says nothing of t if that
 * is 0. A negative t is a positive one of the ray with the opposite direction.
 * As in ref/oracle/oracle_tree.h, the computed bounds, with three roundings, are off by less than
 * 2^-51 of themselves, which TREE_PAD covers, as long as nothing over- or underflows. Numbers of W
 * are multiples of 2^-743, so o, d and their errors of 2^-950, and all are below 2^850; the
 * inverse of a factor is below 2^950. A product below 2^-1022 is off by at most 2^-1074:
 * PLACED_PAD, which is also more than what a t is off by that an enclosure takes for 0
 * (FRACTION_LEAST). One that overflows bounds t from below by more than PLACED_FAR, which is taken
 * instead, or from above by a negative number. */
#ifndef ORACLE_PLACED_WALK_H
#define ORACLE_PLACED_WALK_H

#include "ref/oracle/placing.h"
#include "ref/oracle/tree_walk.h"

#include <float.h>

#define PLACED_PAD 0x1p-998
#define PLACED_FAR 0x1p1000

/* The sense in which the ray runs along an axis. */
enum placed_way {
    PLACED_FORWARD,  /* it enters at lo and leaves at hi */
    PLACED_BACKWARD, /* the other way round */
    PLACED_LEVEL,    /* either, or neither: nothing bounds t from above */
};

/* One condition: t speed <= bound - from, or >=. */
struct placed_side {
    double from, inverse; /* of the speed; 0 if that is */
};

/* Of one axis: the sides of lo and hi, or backward of hi and lo. */
struct placed_axis {
    struct placed_side in, out;
    enum placed_way way;
};

struct placed_walk {
    struct tree_walk walk;
    struct placed_axis axis[3];
};

static inline void placed_slab(const struct placed_axis *axis, const struct tree_node *node, int k,
                               double near[2], double far[2])
{
    const float *in = axis->way == PLACED_BACKWARD ? node->hi[k] : node->lo[k];
    const float *out = axis->way == PLACED_BACKWARD ? node->lo[k] : node->hi[k];
    const struct placed_side enter = axis->in, leave = axis->out;
    for (int side = 0; side < 2; side++) {
        near[side] = tree_max(near[side], ((double)in[side] - enter.from) * enter.inverse);
        far[side] = tree_min(far[side], ((double)out[side] - leave.from) * leave.inverse);
    }
}

/* Where the ray may run either way, both conditions bound t from below; or bar the node, if the ray
 * does not move to where it could fulfil them. */
static inline void placed_level(const struct placed_axis *axis, const struct tree_node *node, int k,
                                double near[2], double far[2])
{
    for (int side = 0; side < 2; side++) {
        double lo = (double)node->lo[k][side] - axis->in.from;
        double hi = (double)node->hi[k][side] - axis->out.from;
        if ((axis->in.inverse == 0 && lo > 0) || (axis->out.inverse == 0 && hi < 0))
            far[side] = -DBL_MAX;
        near[side] = tree_max(near[side], lo * axis->in.inverse);
        near[side] = tree_max(near[side], hi * axis->out.inverse);
    }
}

static inline void placed_visit(struct placed_walk *walk, uint32_t at, double reach)
{
    const struct tree_node *node = &walk->walk.tree->node[at];
    double near[2] = {0, 0}, far[2] = {INFINITY, INFINITY};
    for (int k = 0; k < 3; k++)
        if (walk->axis[k].way == PLACED_LEVEL)
            placed_level(&walk->axis[k], node, k, near, far);
        else
            placed_slab(&walk->axis[k], node, k, near, far);
    for (int side = 0; side < 2; side++) {
        near[side] = tree_min(near[side], PLACED_FAR) - PLACED_PAD;
        far[side] += PLACED_PAD;
        if (node->lo[0][side] > node->hi[0][side]) /* of errors that large, it might be entered */
            far[side] = -DBL_MAX;
    }
    tree_push(&walk->walk, at, reach, near, far);
}

/* For t from `tmin` >= 0 to `reach`, of the ray or, if `back`, of the one with the opposite
 * direction. */
static inline void placed_walk_start(struct placed_walk *walk, const struct tree *tree,
                                     const struct sight *sight, bool back, double tmin,
                                     double reach)
{
    walk->walk.tree = tree;
    walk->walk.top = 0;
    walk->walk.tmin = tmin;
    for (int k = 0; k < 3; k++) {
        struct placed_axis *axis = &walk->axis[k];
        double d = back ? -sight->d[k] : sight->d[k];
        double lo_speed = d + sight->d_err[k], hi_speed = d - sight->d_err[k];
        struct placed_side lo = {sight->o[k] + sight->o_err[k], lo_speed == 0 ? 0 : 1 / lo_speed};
        struct placed_side hi = {sight->o[k] - sight->o_err[k], hi_speed == 0 ? 0 : 1 / hi_speed};
        walk->walk.o[k] = sight->o[k];
        axis->way = hi_speed > 0 ? PLACED_FORWARD : lo_speed < 0 ? PLACED_BACKWARD : PLACED_LEVEL;
        axis->in = axis->way == PLACED_BACKWARD ? hi : lo;
        axis->out = axis->way == PLACED_BACKWARD ? lo : hi;
    }
    placed_visit(walk, 0, reach);
}

/* As tree_walk_next. */
static inline bool placed_walk_next(struct placed_walk *walk, double reach, struct tree_leaf *leaf)
{
    enum tree_step step;
    uint32_t inner;
    while ((step = tree_pop(&walk->walk, reach, leaf, &inner)) == TREE_IS_NODE)
        placed_visit(walk, inner, reach);
    return step == TREE_IS_LEAF;
}

#endif
