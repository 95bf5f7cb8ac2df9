/* A packed tree cut into treelets: connected parts of at most so many bytes. */
#ifndef SCENE_TREELETS_H
#define SCENE_TREELETS_H

#include "bench/measure/touch.h"

/* Bytes that a treelet reads: from `offset` of an array. */
struct treelet_run {
    uint64_t offset;
    uint32_t bytes; /* whole bursts of 64 bytes */
    uint32_t array; /* enum touch_array */
};

/* Owns its arrays: free with treelets_free. Parents have smaller numbers than their children, the
 * root's is 0. */
struct scene_treelets {
    uint32_t count;
    uint32_t *of;     /* of each reference of the packed tree; UINT32_MAX: not reached */
    uint32_t *parent; /* the reference above each one; of the root itself */
    uint32_t *root;   /* the reference of each treelet's root */
    uint64_t *bytes;  /* of each one: records, and what the triangles of its leaves are read as */
    /* Made by treelets_runs: of treelet i from first[i] to first[i + 1], ascending, each burst
     * once; empty before. */
    size_t *first;
    struct treelet_run *run;
    size_t run_count, run_capacity;
    uint32_t *order; /* all references, parents first */
    uint32_t order_count;
};

/* Cuts the packed tree that `touch` records into treelets of at most `most` bytes. A subtree that
 * fits is a treelet, unless its parent's fits as well. What is above these is cut from the root
 * down: a treelet takes the node with the largest surface of those below it that fits. A leaf
 * without a record belongs to its parent's. `touch`'s reads are lost. Errors: STATUS_INPUT a record
 * with the triangles of its leaves is larger than `most`; STATUS_LIMIT the nodes are no tree;
 * STATUS_MEMORY. */
enum status treelets_make(struct touch *touch, uint64_t most, struct scene_treelets *out,
                          struct reason *reason) MUST_USE;

/* Finds the bursts that each treelet reads, its children's boxes included where they lie in the
 * children. Errors: STATUS_MEMORY. */
enum status treelets_runs(struct scene_treelets *treelets, struct touch *touch,
                          struct reason *reason) MUST_USE;

void treelets_free(struct scene_treelets *treelets);

#endif
