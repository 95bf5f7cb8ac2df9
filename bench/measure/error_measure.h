/* How far an engine's answers are from the exact truth: counted without any tolerance, measured in
 * units that do not change when scene and ray are scaled. No error is excused here; the judge
 * decides which errors a formula may make (ref/judge/judge.h). */
#ifndef ERROR_MEASURE_H
#define ERROR_MEASURE_H

#include "ref/oracle/oracle.h"

#define ERROR_UNIT 0x1p-24 /* u: half the distance of 1 to the next float32 */

/* An answer against the oracle's. */
enum error_kind {
    ERROR_RIGHT,   /* a triangle of the exact nearest set, or a true miss */
    ERROR_LOST,    /* the exact ray hits, the answer is a miss */
    ERROR_PHANTOM, /* the exact ray misses, the answer is a hit */
    ERROR_WRONG,   /* both hit; the triangle is not one of the exact nearest */
    ERROR_FREE,    /* a triangle whose plane the ray lies in and touches: either answer is right */
    ERROR_REFUSED, /* a ray that the oracle refuses (NaN, infinity, tmin > tmax): not counted */
    ERROR_KINDS
};

/* What one answer is off by; NAN where there is nothing to measure: a miss, a triangle of no area,
 * and for `forward` and `point` a triangle that the exact line of the ray does not meet (`forward`
 * also not far outside the range, where the oracle encloses t loosely). With u =
 * ERROR_UNIT, t^ the answer's t and M the largest |v - o| of a coordinate of the triangle:
 *   forward  |t^ - t| |d|max / (u M): how far along the ray, t exact
 *   plane    |N . (o + t^ d - v0)| / (|N| u M): how far the point is off the triangle's plane
 *   point    |o + t^ d - (v0 + u^ e1 + v^ e2)|max / (u M): how far it is from its barycentric point
 * All in double: their own error is below 1e-3 units for triangles whose angles are not below 1e-6.
 * An answer that is not finite measures INFINITY. */
struct error_one {
    enum error_kind kind;
    double forward, plane, point;
};

/* Measures the answer of one ray. `truth` is the oracle's answer for the same ray and scene. */
struct error_one error_measure(const struct oracle *oracle, const struct scene *scene,
                               const struct ray *ray, const struct oracle_answer *truth,
                               const struct hit *answer);

/* Nearest-rank quantiles of values: the smallest value that at least that part of all values does
 * not exceed. All NAN if there are none. */
struct quantiles {
    size_t count;
    double p50, p99, most;
};

/* Sorts `value` in place; NANs are left out and not counted. */
struct quantiles quantiles_of(double *value, size_t count);

/* All answers of one engine. */
struct error_sum {
    size_t rays, hits;        /* rays: without the refused */
    size_t kind[ERROR_KINDS]; /* sums up to rays and the refused */
    struct quantiles forward, plane, point;
};

/* Measures `count` answers on all threads. Errors: STATUS_MEMORY. */
enum status error_sum_make(const struct oracle *oracle, const struct scene *scene,
                           const struct ray *ray, const struct oracle_answer *truth,
                           const struct hit *answer, size_t count, struct error_sum *out,
                           struct reason *reason) MUST_USE;

/* Writes `events` of `count` as a rate per million, "12.3"; nothing of N as "<3/N" per million
 * (with 95 % confidence the rate is not above: the rule of three), "<45.8"; "-" if count is 0. */
void error_rate_text(size_t events, size_t count, char *text, size_t text_bytes);

#endif
