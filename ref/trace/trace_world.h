/* The reference traversal of a world: two levels of trees. */
#ifndef TRACE_WORLD_H
#define TRACE_WORLD_H

#include "ref/trace/trace.h"
#include "ref/world/world.h"

/* Traces one ray through job->packed; all members of the job are needed. Order of work, the same in
 * the shader:
 *   The top is traversed as trace_ray traverses a tree, with the ray as it is; the watertight box
 *   test takes the box of its root for the extent of the world. Items of its leaves are instances,
 *   in slot order, or parts of instances (ref/two_level/braid.h), which are traversed as instances
 *   are. If there are parts the boxes of the top are tested as if they were wider by braid_width()
 *   (slab_ray_widen). An instance that world_meets() refuses is skipped. For others the ray is
 *   transformed (transform_ray) and traverses the tree of the mesh as trace_ray does, with the same
 *   box test, from the test of its root's box on; the watertight test takes that box for the
 *   extent. The best hit, its t and so the end of the range are carried from instance to instance.
 *
 *   A triangle that passes the triangle test in range, and is nearer than the best hit, is a
 *   candidate: at equal t the first found stays. A candidate becomes the best hit if it is neither
 *   culled (world_culls) nor, if it is not opaque (world_is_opaque), passed over by the filter
 *   (filter_passes); otherwise it changes nothing.
 *
 *   Facing is the sign of candidate_side (ref/world/candidate.h) of the transformed direction; 0
 *   and NaN, which arise only by rounding, count as positive.
 * The ray ends at the first hit of QUERY_ANY, and so it does of QUERY_CLOSEST with ABI_RAY_FIRST.
 *   out     prim is the number of the placed triangle
 *   tag     custom index of its instance, ABI_TAG_FRONT if the front is seen; 0 for a miss
 *   counts  may be NULL; added to
 * An exact hit lies in the exact box of its instance. So instances that are entered at one place
 * need boxes that contain their placed triangles exactly, and no more allowance than that of the
 * box test: an error of the transform moves the ray in the space of the mesh, where the bottom's
 * boxes are tested with the moved ray.
 * Returns STATUS_OK; STATUS_LIMIT as trace_ray, of either level: then *out is a miss, *tag 0. */
enum status trace_world_ray(const struct world_job *job, const struct ray *ray,
                            struct ray_mode mode, struct hit *out, uint32_t *tag,
                            struct trace_counts *counts) MUST_USE;

/* Finds every candidate that counts, whatever job->query and ABI_RAY_FIRST, in the order of work of
 * trace_world_ray; no hit shortens the ray, and none ends it.
 *   out, tag  the first `capacity` hits found and their tags; may be NULL if that is 0
 *   count     how many there are, over `capacity` too; 0 on error
 * Returns as trace_world_ray. */
enum status trace_world_ray_all(const struct world_job *job, const struct ray *ray,
                                struct ray_mode mode, uint32_t capacity, struct hit *out,
                                uint32_t *tag, uint32_t *count,
                                struct trace_counts *counts) MUST_USE;

/* Tests every triangle of every instance that the ray may meet, in order, and no box. `record` has
 * the records of all instances (world_records_make). */
void trace_world_brute(const struct world *world, const struct instance_record *record,
                       const struct tri_test *tri, enum query query, const struct ray *ray,
                       struct ray_mode mode, struct hit *out, uint32_t *tag);

/* Finds every candidate that counts, in that order; `out`, `tag` and the result as those of
 * trace_world_ray_all and its `count`. */
uint32_t trace_world_brute_all(const struct world *world, const struct instance_record *record,
                               const struct tri_test *tri, const struct ray *ray,
                               struct ray_mode mode, uint32_t capacity, struct hit *out,
                               uint32_t *tag);

#endif
