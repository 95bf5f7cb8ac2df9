/* A tree whose nodes can be moved: each has its parent's index and keeps its number. */
#ifndef SPOTS_H
#define SPOTS_H

#include "ref/base/base.h"
#include "ref/build/lanes.h"
#include "ref/tree/bvh.h"

struct spot {
    struct lane_box box; /* scaled so that areas neither overflow nor vanish */
    uint32_t parent;
    uint32_t child[2]; /* LINKS_NONE twice: a leaf */
    float area;        /* half of the box's area */
};

/* Node 0 is and remains the root. */
struct spots {
    struct spot *spot;
    uint32_t count;
};

/* Makes the nodes of a well-formed tree, with the same numbers. Errors: STATUS_MEMORY; then *out is
 * zero. */
enum status spots_make(const struct bvh *bvh, struct spots *out) MUST_USE;

void spots_free(struct spots *spots);

/* Finds the best place of a node: the node whose sibling it would become. *gain is the decrease of
 * the sum of the inner nodes' areas, above 0. LINKS_NONE if there is no better place. Does not
 * change the tree. */
uint32_t spots_seek(const struct spots *spots, uint32_t node, float *gain);

/* Makes a node the sibling of `target`, if that lowers the sum of the inner nodes' areas of the
 * current tree. Returns the decrease, 0 if there is none or the move is impossible. */
double spots_move(struct spots *spots, uint32_t node, uint32_t target);

/* Writes the tree in pre-order, with the leaves of that of which the nodes were made; inner boxes
 * are those of the children. At most 60 deep: see links_write. Errors: STATUS_MEMORY; then *out is
 * zero. */
enum status spots_write(const struct spots *spots, const struct bvh *bvh, struct bvh *out) MUST_USE;

#endif
