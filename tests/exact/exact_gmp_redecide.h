/* Decides an answer that was judged WRONG once more: exact hits by tests/exact/exact_gmp.c, what
 * the formula makes of a triangle by tests/exact/exact_gmp_replay.c where its bits are promised,
 * else by the error bounds of tests/exact/exact_gmp_bounds.c. Neither the oracle nor the twins have
 * a part in it. */
#ifndef EXACT_GMP_REDECIDE_H
#define EXACT_GMP_REDECIDE_H

#include "ref/twin/model.h"
#include "ref/scene/scene.h"
#include "tests/exact/exact_gmp.h"

enum gmp_opinion {
    GMP_CONFIRMED,  /* no evaluation of the formula could give this answer */
    GMP_OPEN,       /* neither is proven; always so for a formula that is not known */
    GMP_OVERTURNED, /* the answer is the exact one, rounded; or what the formula must give */
};

/* "confirmed", "open", "overturned". */
const char *gmp_opinion_name(enum gmp_opinion opinion);

/* Which proof was found. */
enum gmp_proof {
    GMP_PROOF_NONE,
    GMP_PROOF_NO_TRIANGLE, /* names a triangle that the scene does not have */
    GMP_PROOF_NOT_FINITE,  /* t is not a number although no value can overflow */
    GMP_PROOF_PHANTOM,     /* the triangle's signs or range cannot be accepted */
    GMP_PROOF_DISTANCE,    /* t is off by more than its bound */
    GMP_PROOF_BARYCENTRIC, /* u or v is */
    GMP_PROOF_NEARER,      /* a triangle that must be accepted lies nearer than both bounds */
    GMP_PROOF_MISSED,      /* a miss, but this triangle must be accepted */
    GMP_PROOF_MASKED,      /* worlds: of an instance that the ray does not meet */
    GMP_PROOF_OPACITY,     /* worlds: culled as opaque or not, or passed over by the filter */
    GMP_PROOF_CULLED,      /* worlds: of a side that is culled */
    GMP_PROOF_FACING,      /* worlds: the other side is seen */
    GMP_PROOF_TAG,         /* worlds: another custom index, or a miss that has a tag */
    GMP_PROOF_RIGHT,       /* overturned */
    GMP_PROOF_EXCUSED,     /* overturned: the formula rejects every triangle that is hit */
};

struct gmp_second {
    enum gmp_opinion opinion;
    enum gmp_proof proof;
    uint32_t prim; /* the triangle of the proof, or ABI_NO_PRIM */
};

/* Redecides one answer of an engine to a finite ray.
 *   any    the query was any-hit: nothing needs to be the nearest; with model->any_unnamed an
 *          answer's triangle, t, u and v are not looked at
 * Costs up to some 50 us per triangle near the ray's line. */
struct gmp_second exact_gmp_redecide(const struct scene *scene, const struct ray *ray,
                                     const struct model *model, bool any, const struct hit *answer);

#endif
