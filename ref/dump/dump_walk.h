/* The part of a dump that its root leads to, as a tree. For dump_check.c. */
#ifndef DUMP_WALK_H
#define DUMP_WALK_H

#include "ref/dump/dump_check.h"

/* Nodes in the order of a walk, parents before children. What was wrong is left out: `child` has
 * DUMP_NONE for each child that is no node or was met before. */
struct dump_walk {
    const struct tree_dump *dump;
    uint32_t *order;  /* nodes by place in the walk */
    uint32_t *parent; /* of a node, DUMP_NONE of the root */
    uint32_t *child;  /* as dump->child */
    uint32_t *depth;  /* of a node; DUMP_NONE if nothing leads to it */
    uint32_t count;   /* nodes that were reached */
    /* Triangles in the order of the walk, and by place in the walk which of them are below a
     * node. */
    uint32_t *prim, *first, *end;
    uint32_t prim_count;
    uint32_t tri_count;
};

/* Notes a fault. */
struct dump_notes {
    struct dump_report *report;
    size_t most, capacity;
    enum status status; /* of its memory */
};
void dump_note(struct dump_notes *notes, const struct dump_fault *fault);

/* Walks the nodes, then the leaves. Errors: STATUS_MEMORY; free it also then. */
enum status dump_walk_make(const struct tree_dump *dump, const struct scene *scene,
                           struct dump_notes *notes, struct dump_walk *out) MUST_USE;
void dump_walk_free(struct dump_walk *walk);

/* Boxes against triangles. Errors: STATUS_MEMORY. */
enum status dump_boxes(const struct dump_walk *walk, const struct scene *scene,
                       struct dump_notes *notes) MUST_USE;

#endif
