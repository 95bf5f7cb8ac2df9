/* Judgements of many answers at once, each beside its exact truth. */
#ifndef LOOK_VERDICTS_H
#define LOOK_VERDICTS_H

#include "ref/judge/judge.h"

/* Decides `count` rays exactly and judges an engine's closest hits, on all threads. For a large
 * picture it is called part by part, so that the caller can report progress; both borrowed.
 *   out  judgements of `count` answers
 * Errors: STATUS_MEMORY. */
enum status verdicts_make(const struct oracle *oracle, const struct judge *judge,
                          const struct ray *ray, const struct hit *answer, size_t count,
                          struct judgement *out, struct reason *reason) MUST_USE;

/* How far a judged answer's t is from the exact one, in units of what this engine's arithmetic
 * may do, so that nothing above 1 is excusable: error over proven bound (0 where the bound is not
 * finite); of an unknown formula, for which none is proven, the displacement over
 * JUDGE_DISPLACEMENT_MOST, which is a stated limit. NAN for a miss (also for a lost hit, which the
 * verdict tells), where t is noise, and out of contract. */
double verdict_error(const struct judgement *judgement, const struct hit *answer, bool unknown);

#endif
