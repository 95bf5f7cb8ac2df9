/* What a triangle test in IEEE float32 must compute, bit for bit: every operation done on rationals
 * and rounded by the definition of round to nearest, ties to even. No float operation takes part,
 * so neither the compiler nor the processor can err in the same way as the engine that is replayed.
 */
#ifndef EXACT_GMP_REPLAY_H
#define EXACT_GMP_REPLAY_H

#include "ref/abi.h"
#include "ref/twin/model.h"

#include <gmp.h>

struct gmp_replay {
    bool accepted; /* by the triangle alone: t is not yet compared with the ray's range */
    float t, u, v; /* if accepted */
};

/* The float32 nearest to x, ties to even; above the largest by half a unit or more: infinity. */
float exact_gmp_round(const mpq_t x);

/* Replays one finite ray and triangle. False if it cannot say: the formula is not one of
 * ref/primitives/, the engine does not promise C's bits, or a value overflows or is divided
 * by zero on the way. */
bool exact_gmp_replay(const struct model *model, const struct ray *ray, float v[3][3],
                      struct gmp_replay *out);

/* Whether the replayed test accepts the triangle in the ray's range; `open` as in struct model. */
bool exact_gmp_replay_hits(const struct gmp_replay *replay, const struct ray *ray, bool open);

#endif
