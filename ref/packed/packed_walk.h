/* The nodes of a packed tree as a traversal decodes them, safe on hostile data. */
#ifndef PACKED_WALK_H
#define PACKED_WALK_H

#include "ref/layout.h"

/* One node, reached for the first time. */
struct packed_visit {
    uint32_t ref;
    uint32_t parent; /* index of the parent's visit; the root's is 0 */
    uint32_t stack;  /* stack entries that can be in use when it is entered */
    struct box box;  /* as its parent has it; the root's own */
};

/* Owns `visit`; parents come before their children. */
struct packed_walk {
    struct packed_visit *visit;
    uint32_t visit_count;
    uint32_t stack_most; /* of all visits */
    uint32_t repeats;    /* references to nodes that were already reached: joins and cycles */
    uint32_t bad_refs;   /* children missing at inner nodes: out of range, so not decoded */
    uint32_t repeat_ref; /* the first such node, if repeats > 0 */
    uint32_t bad_ref;    /* the first inner node that lacks a child, if bad_refs > 0 */
};

/* What a reference is called: "record 3"; of a leaf without a record "record 3, slot 1", or its
 * number if the layout has references of its own kind. */
struct packed_name {
    char text[40];
};

struct packed_name packed_name(const struct packed *packed, uint32_t ref);

/* Walks from packed->root, each node once; an empty tree gives no visit. An inner node of fewer
 * than two children (a wide one of none) counts as lacking the rest, a root out of range as a bad
 * reference. Errors: STATUS_MEMORY. On error *out is zero. Free with packed_walk_free. */
enum status packed_walk_make(const struct packed *packed, struct packed_walk *out) MUST_USE;

void packed_walk_free(struct packed_walk *walk);

/* The parent of every reference, ref_count of them, for traversals without a stack; ABI_NO_PRIM for
 * the root and for what is not reached. Caller frees *out, which is NULL for an empty tree.
 * Errors: STATUS_UNSUPPORTED a wide layout; STATUS_LIMIT what is decoded is no tree (a faithful
 * layout can wrap references), with the record; STATUS_MEMORY. */
enum status packed_links(const struct packed *packed, uint32_t **out,
                         struct reason *reason) MUST_USE;

#endif
