/* Checks that the decoded form of a packed tree is a tree of the scene. */
#ifndef PACKED_CHECK_H
#define PACKED_CHECK_H

#include "ref/layout.h"

/* Kinds of faults of a packed tree. */
enum packed_rule {
    PACKED_SOUND,
    PACKED_REFERENCE, /* a child reference is out of range, or refers to a node already reached */
    PACKED_STACK,     /* a path needs more stack than stack_need */
    PACKED_ITEM,      /* an item slot beyond the scene, or a leaf with too many slots; a triangle
                         that is left out */
    PACKED_TWICE,     /* a triangle is named twice */
    PACKED_VERTICES,  /* stored vertices are not the scene's */
    PACKED_LOST,      /* a triangle is in no leaf */
    PACKED_BOUND,     /* a box does not contain everything below it */
    PACKED_RECORD,    /* plugin layout: a record is not a node */
    PACKED_RESULT,    /* plugin layout: the result of pack() is inconsistent */
    PACKED_DEVICE     /* before packing: the tree that a device built is not C's */
};

/* Result of packed_check. */
struct packed_faults {
    enum packed_rule first; /* rule of the described fault */
    uint32_t loose_boxes;   /* decoded boxes that do not contain the exact bounds below them; in a
                               split tree the triangles with a part in no leaf's box */
    uint32_t bad_refs;      /* child references out of range */
    uint32_t cycles;        /* nodes reached more than once */
    uint32_t lost_prims;    /* triangles that no leaf names */
    uint32_t double_prims;  /* repeated namings of a triangle; in a split tree only within one
                               leaf */
    uint32_t bad_prims;     /* item slots beyond the scene or of triangles left out, and leaves with
                               too many slots */
    uint32_t too_deep;      /* 1 if a path needs more stack than stack_need */
    uint32_t bad_tris;      /* items whose stored vertices differ from the scene's in any bit */
};

/* Walks the decoded tree and checks it against the scene; the same code for every layout. Returns
 * STATUS_OK if it finds no fault, else STATUS_INPUT with the first fault in `reason` (node, box,
 * bounds in hexadecimal floats); *faults (may be NULL) has all counts. STATUS_MEMORY leaves *faults
 * zero. */
enum status packed_check(const struct packed *packed, const struct scene *scene,
                         struct packed_faults *faults, struct reason *reason) MUST_USE;

/* The same for a tree that leaves out some triangles of the scene: those where `left_out` is true,
 * one entry per triangle. Not for split trees. */
enum status packed_check_without(const struct packed *packed, const struct scene *scene,
                                 const bool *left_out, struct packed_faults *faults,
                                 struct reason *reason) MUST_USE;

#endif
