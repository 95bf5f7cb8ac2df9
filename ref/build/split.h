/* The cheapest ways to divide a node of builder sbvh: its parts by their centres, or space. */
#ifndef SPLIT_H
#define SPLIT_H

#include "ref/build/clip.h"
#include "ref/scene/scene.h"

#define SPLIT_SWEPT 32u /* up to so many parts every place is tried, beyond it bins */

/* What both searches look at. */
struct split_node {
    const struct scene *scene;
    const struct part *part;
    uint32_t count;
    struct box box; /* of all parts */
};

/* A way to divide. axis < 0: there is none. Costs are areas times parts, added up, in units of the
 * node's area. By centre: parts with centre below `at`, and of those at it the first `ties`, come
 * first. In space: `at` is the plane. */
struct split {
    int axis;
    float at;
    uint32_t ties;
    double cost;
    struct box side[2];
    uint32_t count[2];
};

/* Twice the centre of a part's box, rounded; what splits by centre go by. Halves of floats, so that
 * no sum overflows. */
static inline float split_centre(const struct part *part, int axis)
{
    return 0.5f * part->box.lo[axis] + 0.5f * part->box.hi[axis];
}

/* The cheapest by centre: of all places, or between bins. */
void split_by_centre(const struct split_node *node, struct split *out);

/* The cheapest plane of those between bins that makes at most `most` parts more (Stich, Friedrich,
 * Dietrich 2009, section 4.1: parts are chopped at every plane between bins). */
void split_in_space(const struct split_node *node, uint32_t most, struct split *out);

#endif
