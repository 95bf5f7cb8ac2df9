/* The canonical wide tree of a tree in stages: one right result on any machine, as of the other
 * stages.
 *
 * A node of the wide tree stands for a subtree of more than `leaf_most` triangles (the root of the
 * whole also for fewer). It begins with that subtree's two halves as its slots. As long as it has
 * fewer than `width` slots, the slot of the largest area among those of more than `leaf_most`
 * triangles, the earlier one of equal ones, is opened: its two halves take its place, the first
 * before the second. Then a slot of at most `leaf_most` triangles is a leaf, any other a node.
 * Areas are those of H-PLOC: exact integers, of boxes in the frame of the scene. The root of a tree
 * of at most `leaf_most` triangles has one slot, a leaf of all.
 *
 * Nodes are numbered level by level, in a level by their parents, of one parent by their slots.
 * Items are laid in the order of the nodes and slots, within a leaf as the binary tree has them. */
#ifndef STAGED_WIDE_H
#define STAGED_WIDE_H

#include "ref/staged/staged.h"
#include "ref/tree/wide_tree.h"

/* A child. */
struct staged_child {
    uint32_t link;  /* of the subtree, in the binary tree */
    uint32_t first; /* a node, or the place of its first item */
    uint32_t count; /* items; 0: a node */
};

/* Owns its arrays (see staged_wide_free); all are NULL without triangles. */
struct staged_wide {
    struct wide_node *node; /* its children are adjacent, those of node 0 come first */
    struct staged_child *child;
    uint32_t *item; /* triangles */
    uint32_t node_count, child_count, item_count;
};

/* The most nodes of a wide tree of `count` triangles. A node of fewer than `width` children has
 * leaves alone, of more than leaf_most triangles: L of these, and I full ones, whose children are
 * I + L - 1 nodes and at most count - (leaf_most + 1) L leaves. So (width - 1) I is at most count -
 * 1 - leaf_most L. */
uint32_t staged_wide_nodes_most(uint32_t count, uint32_t width, uint32_t leaf_most);

/* Allocates arrays for these counts. Errors: STATUS_MEMORY; *out is then zero. */
enum status staged_wide_alloc(uint32_t nodes, uint32_t children, uint32_t items,
                              struct staged_wide *out) MUST_USE;

void staged_wide_free(struct staged_wide *wide);

/* Collapses a tree, whose links must be a tree. `width` is 2 to WIDE_TREE_MOST. Errors:
 * STATUS_MEMORY; *out is then zero. */
enum status staged_wide_make(const struct staged *staged, uint32_t width, uint32_t leaf_most,
                             struct staged_wide *out) MUST_USE;

/* The stage ("nodes", "children" or "items") and element in which two of them differ first. */
struct staged_difference staged_wide_compare(const struct staged_wide *mine,
                                             const struct staged_wide *other);

/* The wide tree with the boxes of the binary one, for a layout's pack_tree. Leaves are ranges of
 * wide->item. Errors: STATUS_MEMORY; *out is then zero. */
enum status staged_wide_tree(const struct staged_wide *wide, const struct staged *staged,
                             struct wide_tree *out) MUST_USE;

#endif
