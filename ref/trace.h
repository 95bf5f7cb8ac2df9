/* The reference traversal, over any layout. Plain on purpose: it is compared bit for bit with the
 * shader, which was written anew (shaders/trace.glsl). */
#ifndef TRACE_H
#define TRACE_H

#include "ref/layout.h"
#include "ref/primitives/primitives.h"

/* Work done, added up over rays. */
struct trace_counts {
    uint64_t boxes; /* box tests */
    uint64_t tris;  /* triangle tests */
};

/* Traces one ray through `packed`. Order of work, the same in the shader:
 *   test the root's box; then per node: a leaf tests its items in slot order, a later item wins
 *   only with a smaller t; an inner node tests its children's boxes in order, pushes the later
 *   one and goes on with the earlier one (layout->order).
 * A popped node is skipped if its entry distance is beyond the best t (not by the published box
 * test). QUERY_ANY stops at the first accepted triangle. scene   the packed tree's scene; borrowed
 *   counts  may be NULL; added to
 * Returns STATUS_OK; STATUS_LIMIT if the stack or the node budget is exhausted (a cyclic tree, or
 * packed.stack_need untrue): then *out is a miss and must not be believed. */
enum status trace_ray(const struct packed *packed, const struct scene *scene,
                      const struct box_test *box, const struct tri_test *tri, enum query query,
                      const struct ray *ray, struct hit *out, struct trace_counts *counts) MUST_USE;

/* Tests every triangle in index order; a later one wins only with a smaller t. */
void trace_brute(const struct scene *scene, const struct tri_test *tri, enum query query,
                 const struct ray *ray, struct hit *out);

#endif
