/* The reference traversal, over any layout. Plain on purpose: it is compared bit for bit with the
 * shader, which was written separately (shaders/trace.glsl). */
#ifndef TRACE_H
#define TRACE_H

#include "ref/engine.h"
#include "ref/layout.h"
#include "ref/primitives/primitives.h"

/* Work done, added up over rays. */
struct trace_counts {
    uint64_t boxes; /* box tests */
    uint64_t tris;  /* triangle tests */
};

/* Traces one ray through job->packed; all members of the job but a NULL parent are needed. Order of
 * work, the same in the shader:
 *   test the root's box; then per node: a leaf tests its items in slot order, a later item wins
 *   only with a smaller t; an inner node of a binary layout tests its children's boxes in order,
 *   pushes the later one and continues with the earlier one (layout->order); one of a wide layout
 *   tests all, pushes those hit so that the nearest is on top (the first child of equal ones), and
 *   pops.
 * A popped node is skipped if its entry distance is beyond the best t (not by the published box
 * test). QUERY_ANY stops at the first accepted triangle; for QUERY_ALL see trace_ray_all.
 *   counts  may be NULL; added to
 * With job->parent (packed_links of a binary layout's tree) the walk has no stack: a trail of one
 * bit a level tells on the way back whether the other child still waits; the links lead up (Laine
 * 2010, Restart Trail for Stackless BVH Traversal, restarts at the root instead). The hits and
 * their order are those of the walk with the stack. A box that would wait on the stack is tested
 * again when its turn comes, so there are more box tests.
 * Returns STATUS_OK; STATUS_LIMIT if the stack, the trail of ABI_STACK_MAX bits or the node budget
 * is exhausted (a cyclic tree, or packed.stack_need untrue): then *out is a miss and must not be
 * used. */
enum status trace_ray(const struct job *job, const struct ray *ray, struct hit *out,
                      struct trace_counts *counts) MUST_USE;

/* Traces `count` rays one after the other, to the same hits as trace_ray; nodes are decoded once
 * for all. flag[i] is ABI_FLAG_DONE, or ABI_FLAG_EXHAUSTED where trace_ray would return
 * STATUS_LIMIT. work[i], unless `work` is NULL, is the work for the ray: box tests in the upper 16
 * bits, triangle tests in the lower, at most 65535 each. Returns STATUS_OK; STATUS_LIMIT if there
 * is such a ray. */
enum status trace_rays(const struct job *job, const struct ray *ray, size_t count, struct hit *out,
                       uint32_t *flag, uint32_t *work) MUST_USE;

/* Finds every triangle that the ray hits, whatever job->query, in the order of work of trace_ray
 * with two differences: no hit shortens the ray, and none ends it. A triangle in several slots is
 * found several times, as in a split tree (ref/trace/all_hits.h removes repeats).
 *   out     the first `capacity` hits found; may be NULL if that is 0
 *   count   how many there are, over `capacity` too; 0 on error
 * Returns as trace_ray. */
enum status trace_ray_all(const struct job *job, const struct ray *ray, uint32_t capacity,
                          struct hit *out, uint32_t *count, struct trace_counts *counts) MUST_USE;

/* Tests every triangle in index order; a later one wins only with a smaller t. */
void trace_brute(const struct scene *scene, const struct tri_test *tri, enum query query,
                 const struct ray *ray, struct hit *out);

/* Finds every triangle that the ray hits, in index order; `out` and the result as trace_ray_all's
 * `out` and `count`. */
uint32_t trace_brute_all(const struct scene *scene, const struct tri_test *tri,
                         const struct ray *ray, uint32_t capacity, struct hit *out);

#endif
