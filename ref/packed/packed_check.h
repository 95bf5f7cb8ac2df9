/* Is a packed tree, decoded, the tree of a scene? */
#ifndef PACKED_CHECK_H
#define PACKED_CHECK_H

#include "ref/layout.h"

/* What the bytes of a packed tree can be at fault with. */
enum packed_rule {
    PACKED_SOUND,
    PACKED_REFERENCE, /* a child reference is out of range, or leads to what was reached before */
    PACKED_STACK,     /* a path needs more stack than stack_need */
    PACKED_ITEM,      /* an item slot beyond the scene, or a leaf of more slots than it needs */
    PACKED_TWICE,     /* a triangle is named again */
    PACKED_VERTICES,  /* stored vertices are not the scene's */
    PACKED_LOST,      /* a triangle is in no leaf */
    PACKED_BOUND,     /* a box does not contain what is below it */
    PACKED_RECORD,    /* of a layout from outside: a record is no node */
    PACKED_RESULT     /* likewise: pack() contradicts its result */
};

/* What packed_check found. */
struct packed_faults {
    enum packed_rule first; /* of the fault that is described */
    uint32_t loose_boxes;   /* decoded boxes that do not contain the exact bounds below them; of a
                               split tree triangles of which a part is in no leaf's box */
    uint32_t bad_refs;      /* child references out of range */
    uint32_t cycles;        /* nodes reached more than once */
    uint32_t lost_prims;    /* triangles that no leaf names */
    uint32_t double_prims;  /* times that a triangle is named again; of a split tree in one leaf */
    uint32_t bad_prims;     /* item slots beyond the scene, leaves of more slots than it needs */
    uint32_t too_deep;      /* 1 if a path needs more stack than stack_need */
    uint32_t bad_tris;      /* items whose stored vertices are not the scene's, to the bit */
};

/* Walks the decoded tree and checks it against the scene; written once for every layout.
 * Returns STATUS_OK if nothing was found, STATUS_INPUT with the first fault in `reason` (node, box,
 * bounds in hexadecimal floats) otherwise; *faults (may be NULL) has all counts.
 * STATUS_MEMORY leaves *faults zero. */
enum status packed_check(const struct packed *packed, const struct scene *scene,
                         struct packed_faults *faults, struct reason *reason) MUST_USE;

#endif
