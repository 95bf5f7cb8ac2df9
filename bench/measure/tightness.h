/* How tight the bounds of t are: the smallest error that the judge rejects, compared with the
 * errors that a formula really makes, for the same rays and triangles. */
#ifndef TIGHTNESS_H
#define TIGHTNESS_H

#include "ref/judge/judge.h"
#include "ref/base/rng.h"

/* A ray and a triangle that it hits inside, clear of rounding. */
struct tightness_pair {
    struct ray ray;
    uint32_t prim;
    double t; /* exact, to 2^-40 of itself */
};

/* Draws a pair: a ray from around the scene with bounds `bounds` to a random point in a random
 * triangle. False if that ray does not hit the interior; draw again then. The scene must have
 * triangles. */
bool tightness_draw(const struct oracle *oracle, const struct scene *scene,
                    const struct box *bounds, struct rng *rng, struct tightness_pair *out);

/* Errors of t in ulp of the exact t. */
struct tightness_one {
    double real;     /* error of the formula, with every operation rounded to nearest */
    double rejected; /* smallest error the judge rejects, to either side; INFINITY: none */
    /* The judge rejects what the formula computed and surely accepts, or exact t, u and v, each
     * rounded to nearest. */
    bool alarm;
};

/* Measures a pair of `scene`. `judge` must be for any-hits and the same scene and model, and the
 * formula must be known. For a determinant below the threshold of mt_rtrs no error counts as
 * rejected. */
struct tightness_one tightness_measure(const struct judge *judge, const struct scene *scene,
                                       const struct model *model,
                                       const struct tightness_pair *pair);

/* Pairs per group; a group has similar rejected errors, and the last one may be larger. */
#define TIGHTNESS_GROUP 1000u

/* Summary of many pairs, with quantiles as in error_measure.h. */
struct tightness {
    size_t count, alarms;
    size_t unbounded; /* pairs for which no error is rejected */
    double real_p50, real_p999, real_most;
    double rejected_p50, rejected_p999;
    double medians; /* rejected_p50 / real_p50 */
    double times;   /* rejected_p50 / real_p999 */
    /* The pairs are sorted by their rejected error and divided into groups. For each group the
     * median rejected error is divided by the 99.9th percentile of the real errors. These are the
     * median and the largest over all groups. Pairs for which no error is rejected are left out. */
    double group_p50, group_most;
};

/* Summarises `count` >= 1 pairs, which are sorted in place. Errors: STATUS_MEMORY. */
enum status tightness_sum(struct tightness_one *one, size_t count, struct tightness *out,
                          struct reason *reason) MUST_USE;

#endif
