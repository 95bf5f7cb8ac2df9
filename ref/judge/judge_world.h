/* The judge of worlds (ref/world/world.h). judge_make takes an oracle of a world, too; then hits
 * name placed triangles, and what a ray may meet is exact: which instances, by masks; which
 * triangles, by opacity, facing and the filter. Nothing about the numbers excuses an answer that
 * this rules out.
 *
 * A formula of ours is judged by the twins of placed triangles (ref/twin/twin_placed.h): its engine
 * takes rays along as ref/world/object_ray.h has it. Other engines have transforms of their own and
 * are judged as unknown formulas, whatever their model says: by displacement in the world. */
#ifndef JUDGE_WORLD_H
#define JUDGE_WORLD_H

#include "ref/judge/judge_all.h"
#include "ref/oracle/oracle_world.h"

/* Judges one answer; safe from several threads at once.
 *   judge   made of an oracle of a world
 *   mode    what the ray may meet; has passed ray_mode_check. With ABI_RAY_FIRST a closest hit is
 *           judged like any hit
 *   truth   oracle_closest_world of the same ray and mode with ORACLE_CLOSED
 *   tag     what was answered beside the hit (ref/abi.h)
 * Before all else, whatever the ray: WRONG_PHANTOM, no such triangle; WRONG_MASKED; WRONG_OPACITY;
 * WRONG_INSTANCE, a custom index that is not the instance's, or a tag of a miss that is not 0;
 * WRONG_CULLED and WRONG_FACING, where the side that is seen is the same in every evaluation;
 * WRONG_OPACITY, the filter passes no u and v that rounding can come to.
 * Then as judge_answer, but that VERDICT_BOUNDARY is also the class of a triangle that counts or
 * does not by rounding, and VERDICT_OUT_OF_CONTRACT that of an instance in whose space the ray is
 * out of contract, or which is ill-conditioned (out->ill_conditioned). WRONG_INSTANCE stands in
 * place of another kind if the same triangle of another instance is what was hit.
 * Errors: STATUS_MEMORY (*out is then VERDICT_OUT_OF_CONTRACT: not judged). */
enum status judge_world_answer(const struct judge *judge, const struct ray *ray,
                               struct ray_mode mode, const struct oracle_answer *truth,
                               const struct hit *answer, uint32_t tag, struct judgement *out);

/* Judges the list of one ray as judge_list does; tag[i] belongs to hit[i]. ABI_RAY_FIRST changes
 * nothing. Errors: STATUS_MEMORY (VERDICT_OUT_OF_CONTRACT then). */
enum status judge_world_list(const struct judge *judge, const struct ray *ray, struct ray_mode mode,
                             const struct hit *hit, const uint32_t *tag, size_t count,
                             struct list_judgement *out);

#endif
