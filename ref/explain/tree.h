/* A packed tree beside the canonical tree that it was made from: every record, item and bound can
 * be compared with its correct value, and read with one kind of fault corrected. */
#ifndef EXPLAIN_TREE_H
#define EXPLAIN_TREE_H

#include "ref/explain/repair.h"
#include "ref/layout.h"
#include "ref/packed/packed_oblique.h"

#define EXPLAIN_NONE  0xFFFFFFFFu
#define EXPLAIN_SLOTS 64u /* slots of a leaf that are counted one by one */

/* Owns its arrays (explain_tree_free); scene, bvh and packed are borrowed. */
struct explain_tree {
    const struct scene *scene;
    const struct bvh *bvh;
    const struct packed *packed;
    struct box *exact; /* per tree node: the bounds of its triangles; of a split tree its own box */
    uint32_t *record;  /* per tree node: its record (a reference), or EXPLAIN_NONE */
    uint32_t *node;    /* per reference: its tree node, or EXPLAIN_NONE */
    struct box *box;   /* wide layouts: per tree node that has a record, the box that is tested */
    struct oblique_bounds *oriented; /* per reference, or NULL: ref/explain/oriented.h */
    uint32_t *parent;                /* per tree node; the root's is EXPLAIN_NONE */
    uint32_t *leaf;  /* per triangle: its leaf (of a split tree one of them), a tree node, or
                          EXPLAIN_NONE */
    bool shifted;    /* most items are the tree's less one */
    bool zero_twice; /* several slots name triangle 0: some of them are empty */
    /* Per slot: leaves that use it for a triangle, and those of them that read nothing there. */
    uint32_t slot_used[EXPLAIN_SLOTS], slot_lost[EXPLAIN_SLOTS];
};

/* Compares `packed`, which may be broken, with the tree it was made from, which has passed
 * bvh_check_form. Records are assumed to be numbered in pre-order, one a node or two a leaf, as all
 * binary layouts do; where neither fits most nodes, by walking both trees together. Of wide layouts
 * a node is the tree node with the same triangles below: what the collapse left out has no record,
 * and part of a leaf no tree node. Errors: STATUS_MEMORY. On error *out is zero. */
enum status explain_tree_make(const struct scene *scene, const struct bvh *bvh,
                              const struct packed *packed, struct explain_tree *out,
                              struct reason *reason) MUST_USE;

void explain_tree_free(struct explain_tree *tree);

/* For explain_tree_make: fills record, node and box of a wide layout, where record and node have
 * been set to EXPLAIN_NONE. Errors: STATUS_MEMORY. */
enum status explain_map_wide(struct explain_tree *tree) MUST_USE;

/* What is wrong with one item slot of a leaf. */
enum item_fault { ITEM_OK, ITEM_NOT_READ, ITEM_SENTINEL, ITEM_TRUNCATED, ITEM_SHIFTED, ITEM_OTHER };

/* Judges slot `slot` (below the leaf's item_count in the tree) of tree node `leaf`; *stored is the
 * triangle that the packed tree tests there, or ABI_NO_PRIM. A record that does not decode as a
 * leaf, or that is not known, has no wrong items: its reference is at fault. */
enum item_fault explain_item_fault(const struct explain_tree *tree, uint32_t leaf, uint32_t slot,
                                   uint32_t *stored);

/* What is wrong with one stored bound. */
enum bound_fault {
    BOUND_OK,       /* not inside what the tree needs */
    BOUND_OVERFLOW, /* infinite or NaN, and inside */
    BOUND_FLUSHED,  /* 0 where the tree's is a subnormal half, nearer to another than to 0 */
    BOUND_ROUNDED,  /* inside by at most one float16 step */
    BOUND_STORED,   /* inside by more */
    BOUND_CUT,      /* the tree's own bound is inside its triangles' */
};

/* Judges a bound: `decoded` from the bytes, `canonical` from the tree, `exact` of the triangles. */
enum bound_fault explain_bound_fault(float decoded, float canonical, float exact, bool upper);

/* What is wrong with the children of a tree node, as the packed tree has them. */
enum ref_fault { REF_OK, REF_TRUNCATED, REF_OTHER };

enum ref_fault explain_ref_fault(const struct explain_tree *tree, uint32_t node);

/* One node as a replay reads it. */
struct explain_node {
    struct wide wide;
    uint32_t node;    /* tree node of the record, or EXPLAIN_NONE */
    uint32_t repairs; /* that were made */
};

/* Decodes record `ref`, which must be valid, with the `repairs` (a mask) that concern bytes. */
void explain_load(const struct explain_tree *tree, uint32_t repairs, uint32_t ref,
                  struct explain_node *out);

/* Triangle of item slot `slot` (below wide.item_count) of a loaded leaf, repaired; or ABI_NO_PRIM.
 */
uint32_t explain_item(const struct explain_tree *tree, const struct explain_node *leaf,
                      uint32_t slot);

/* True if a leaf at or below the reference names the triangle. *bounds, unless NULL, are of all
 * triangles there. */
bool explain_names(const struct explain_tree *tree, uint32_t ref, uint32_t prim,
                   struct box *bounds);

/* The box of record `ref`, repaired. */
struct box explain_box(const struct explain_tree *tree, uint32_t repairs, uint32_t ref);

#endif
