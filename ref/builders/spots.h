/* A tree whose nodes can be moved: each has its parent's index and keeps its number. */
#ifndef SPOTS_H
#define SPOTS_H

#include "ref/base/base.h"
#include "ref/build/lanes.h"
#include "ref/tree/bvh.h"

struct spot {
    struct lane_box box; /* in units in which areas neither overflow nor vanish */
    uint32_t parent;
    uint32_t child[2]; /* LINKS_NONE twice: a leaf */
    float area;        /* half of it */
};

/* Node 0 is the root, and stays it. */
struct spots {
    struct spot *spot;
    uint32_t count;
};

/* The nodes of a well-formed tree, numbered as there. Errors: STATUS_MEMORY; *out is zero then. */
enum status spots_make(const struct bvh *bvh, struct spots *out) MUST_USE;

void spots_free(struct spots *spots);

/* The place where a node costs least: the node whose sibling it would become; *gain is by how much
 * the sum of the inner nodes' areas would fall, above 0. LINKS_NONE if there is no better one. Only
 * reads. */
uint32_t spots_seek(const struct spots *spots, uint32_t node, float *gain);

/* Makes a node the sibling of `target`, if that lowers the sum of the inner nodes' areas as the
 * tree is now; returns by how much, 0 if it does not or cannot be. */
double spots_move(struct spots *spots, uint32_t node, uint32_t target);

#endif
