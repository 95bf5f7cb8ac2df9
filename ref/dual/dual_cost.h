/* Which planes a node of a dual-split tree has. The rules are our own: expected work by surface
 * areas, with the costs of the k-d tree. */
#ifndef DUAL_COST_H
#define DUAL_COST_H

#include "ref/scene/scene.h"

/* A step through a node of two planes, and the test of a triangle (ref/kd/kd_plane.h). */
#define DUAL_COST_STEP 15.0
#define DUAL_COST_TRI  20.0

/* A node: its own box, and what is expected to be done there and below once a ray is in it. */
struct dual_part {
    struct box box;
    double cost;
};

/* Two sides of a box and their new planes; the second may repeat the first. */
struct dual_carve {
    uint32_t side[2];
    float at[2];
};

/* The side of a box: k lower, 3 + k upper. */
static inline float *dual_side(struct box *box, uint32_t side)
{
    return side < 3 ? &box->lo[side] : &box->hi[side - 3];
}

/* The work of a node that is met in box `in`: cost * area. */
static inline double dual_work(const struct dual_part *part, const struct box *in)
{
    return part->cost * box_half_area_or_none(in);
}

/* Finds the two planes that cut most from `in`, whose sides may be outside of the part's box: first
 * the side that leaves the least area, then the one that does beside it. They are worth a step of
 * their own if that step, for all rays that meet `in`, costs less than the work that they save:
 *
 *   DUAL_COST_STEP * area(in) + cost * area(carved) < cost * area(in)
 *
 * True if so, or if something can be carved at all with `always`; then `in` is carved. */
bool dual_carve_find(const struct dual_part *part, bool always, struct box *in,
                     struct dual_carve *out);

/* How a node in box `in` splits: for each axis and order of the children, each child is taken to
 * cost its work in its implied box, or a step there and its work in its own box, whichever is less.
 * The first cheapest one. */
struct dual_split {
    uint32_t axis;
    bool swapped; /* the second child is the lower one */
};
struct dual_split dual_split_find(const struct dual_part *fst, const struct dual_part *snd,
                                  const struct box *in);

#endif
