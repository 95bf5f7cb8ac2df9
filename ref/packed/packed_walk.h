/* The nodes of a packed tree as decoded by a traversal; safe on hostile data. */
#ifndef PACKED_WALK_H
#define PACKED_WALK_H

#include "ref/layout.h"

/* One node, reached for the first time. */
struct packed_visit {
    uint32_t ref;
    uint32_t parent; /* index of the parent's visit; the root's is 0 */
    uint32_t stack;  /* most stack entries in use when it is entered */
    struct box box;  /* as stored in its parent; for the root its own */
};

/* Owns `visit`; parents come before their children. */
struct packed_walk {
    struct packed_visit *visit;
    uint32_t visit_count;
    uint32_t stack_most; /* largest of all visits */
    uint32_t repeats;    /* references to nodes that were already reached: joins and cycles */
    uint32_t bad_refs;   /* children missing at inner nodes because their reference is out of
                            range */
    uint32_t repeat_ref; /* the first such node, if repeats > 0 */
    uint32_t bad_ref;    /* the first inner node that lacks a child, if bad_refs > 0 */
};

/* Name of a reference: "record 3"; for a leaf without a record "record 3, slot 1", or the number if
 * the layout has its own kind of references. */
struct packed_name {
    char text[40];
};

struct packed_name packed_name(const struct packed *packed, uint32_t ref);

/* Walks from packed->root, each node once; an empty tree gives no visit. Each child that an inner
 * node lacks (of two, of one in a wide layout) counts as a bad reference, as does a root out of
 * range. Errors: STATUS_MEMORY. On error *out is zero. Free with packed_walk_free. */
enum status packed_walk_make(const struct packed *packed, struct packed_walk *out) MUST_USE;

void packed_walk_free(struct packed_walk *walk);

/* Returns the parent of every reference, ref_count of them, for traversals without a stack;
 * ABI_NO_PRIM for the root and for references that are not reached. Caller frees *out, which is
 * NULL for an empty tree. Errors: STATUS_UNSUPPORTED a wide layout; STATUS_LIMIT the decoded words
 * are no tree (a faithful layout can wrap references), with the record; STATUS_MEMORY. */
enum status packed_links(const struct packed *packed, uint32_t **out,
                         struct reason *reason) MUST_USE;

#endif
