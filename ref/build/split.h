/* Finds the cheapest division of a node of builder sbvh: of its parts by their centres, or of
 * space. */
#ifndef SPLIT_H
#define SPLIT_H

#include "ref/build/clip.h"
#include "ref/scene/scene.h"

#define SPLIT_SWEPT 32u /* up to this many parts every position is tried, beyond it bins */

/* Input of both searches. */
struct split_node {
    const struct scene *scene;
    const struct part *part;
    uint32_t count;
    struct box box; /* of all parts */
};

/* A division. axis < 0: none. The cost is the sum of area times parts, relative to the node's area.
 * By centre: parts with centre below `at` come first, and the first `ties` of those at it. In
 * space: `at` is the plane. */
struct split {
    int axis;
    float at;
    uint32_t ties;
    double cost;
    struct box side[2];
    uint32_t count[2];
};

/* Twice the centre of a part's box, rounded; the key of splits by centre. Computed from halves of
 * floats, so that no sum overflows. */
static inline float split_centre(const struct part *part, int axis)
{
    return 0.5f * part->box.lo[axis] + 0.5f * part->box.hi[axis];
}

/* Finds the cheapest split by centre: among all positions, or between bins. */
void split_by_centre(const struct split_node *node, struct split *out);

/* Finds the cheapest plane between bins that adds at most `most` parts (Stich, Friedrich, Dietrich
 * 2009, section 4.1: parts are chopped at every plane between bins). */
void split_in_space(const struct split_node *node, uint32_t most, struct split *out);

#endif
