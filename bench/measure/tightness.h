/* How tight the bounds of t are: the smallest error that the judge rejects, beside the errors that
 * a formula really makes, of the same rays and triangles. */
#ifndef TIGHTNESS_H
#define TIGHTNESS_H

#include "ref/judge/judge.h"
#include "ref/base/rng.h"

/* A ray and a triangle that it hits inside, beyond rounding. */
struct tightness_pair {
    struct ray ray;
    uint32_t prim;
    double t; /* exact, to 2^-40 of itself */
};

/* Draws one: from around the scene, whose bounds are `bounds`, at a random point inside a random
 * triangle. False if that ray hits no inside; then the next draw may. The scene has triangles. */
bool tightness_draw(const struct oracle *oracle, const struct scene *scene,
                    const struct box *bounds, struct rng *rng, struct tightness_pair *out);

/* Errors of t in ulp of the exact t. */
struct tightness_one {
    double real;     /* of the formula computed with every operation rounded to nearest */
    double rejected; /* the smallest that the judge rejects, before or behind; INFINITY: none is */
    bool alarm;      /* the judge rejects what the formula computed and surely accepts, or exact t,
                        u and v, each rounded to nearest */
};

/* Measures a pair of `scene`. `judge` is one of any-hits, of the same scene and model, whose
 * formula is known. Of a determinant below the threshold of mt_rtrs no error counts as rejected. */
struct tightness_one tightness_measure(const struct judge *judge, const struct scene *scene,
                                       const struct model *model,
                                       const struct tightness_pair *pair);

/* Pairs of a group, whose smallest rejected errors are alike; the last group has more. */
#define TIGHTNESS_GROUP 1000u

/* Of many pairs; quantiles as in error_measure.h. */
struct tightness {
    size_t count, alarms;
    size_t unbounded; /* of them no error is rejected */
    double real_p50, real_p999, real_most;
    double rejected_p50, rejected_p999;
    double medians; /* rejected_p50 / real_p50 */
    double times;   /* rejected_p50 / real_p999 */
    /* The pairs are sorted by their rejected error and cut into groups; of each the median rejected
     * error over the 99.9th percentile of the real ones: the median and the largest of all
     * groups. Left out are pairs of which no error is rejected. */
    double group_p50, group_most;
};

/* Sums up `count` pairs, 1 or more, which are sorted. Errors: STATUS_MEMORY. */
enum status tightness_sum(struct tightness_one *one, size_t count, struct tightness *out,
                          struct reason *reason) MUST_USE;

#endif
