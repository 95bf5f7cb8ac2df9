/* How far an engine's answers are from the exact truth. Wrong answers are counted without any
 * tolerance; errors are measured in units that do not change when scene and ray are scaled. No
 * error is excused here: the judge decides which errors a formula may make (ref/judge/judge.h). */
#ifndef ERROR_MEASURE_H
#define ERROR_MEASURE_H

#include "ref/oracle/oracle.h"

#define ERROR_UNIT 0x1p-24 /* u: half the distance from 1 to the next float32 */

/* The kinds of answers, compared with the oracle's. */
enum error_kind {
    ERROR_RIGHT,   /* a triangle of the exact nearest set, or a true miss */
    ERROR_LOST,    /* the exact ray hits, the answer is a miss */
    ERROR_PHANTOM, /* the exact ray misses, the answer is a hit */
    ERROR_WRONG,   /* both hit; the triangle is not one of the exact nearest */
    ERROR_FREE,    /* the ray touches the triangle within its plane: either answer is right */
    ERROR_REFUSED, /* the oracle refuses the ray (NaN, infinity, tmin > tmax): not counted */
    ERROR_KINDS
};

/* The errors of one answer. NAN if there is nothing to measure: a miss, a triangle of no area, and
 * for `forward` and `point` a triangle that the exact line of the ray does not meet (`forward` also
 * far outside the range, where the oracle's bounds on t are loose). With u = ERROR_UNIT, t^ the
 * answer's t and M the largest |v - o| of a coordinate of the triangle:
 *   forward  |t^ - t| |d|max / (u M): error along the ray, with exact t
 *   plane    |N . (o + t^ d - v0)| / (|N| u M): distance of the point from the triangle's plane
 *   point    |o + t^ d - (v0 + u^ e1 + v^ e2)|max / (u M): distance from its barycentric point
 * Computed in double, with an error below 1e-3 units for triangles whose angles are not below 1e-6.
 * An answer that is not finite measures INFINITY. */
struct error_one {
    enum error_kind kind;
    double forward, plane, point;
};

/* Measures the answer of one ray. `truth` is the oracle's answer for the same ray and scene. */
struct error_one error_measure(const struct oracle *oracle, const struct scene *scene,
                               const struct ray *ray, const struct oracle_answer *truth,
                               const struct hit *answer);

/* Nearest-rank quantiles: the smallest value that at least this part of all values does not exceed.
 * All NAN if there are no values. */
struct quantiles {
    size_t count;
    double p50, p99, most;
};

/* Sorts `value` in place. NANs are dropped and not counted. */
struct quantiles quantiles_of(double *value, size_t count);

/* Errors of all answers of one engine. */
struct error_sum {
    size_t rays, hits;        /* rays: without refused ones */
    size_t kind[ERROR_KINDS]; /* adds up to rays plus refused ones */
    struct quantiles forward, plane, point;
};

/* Measures `count` answers on all threads. Errors: STATUS_MEMORY. */
enum status error_sum_make(const struct oracle *oracle, const struct scene *scene,
                           const struct ray *ray, const struct oracle_answer *truth,
                           const struct hit *answer, size_t count, struct error_sum *out,
                           struct reason *reason) MUST_USE;

/* Writes `events` of `count` as a rate per million, such as "12.3". Without events it writes the
 * rate 3/N as an upper limit, such as "<45.8" (the rule of three: with 95 % confidence the rate is
 * not above it). Writes "-" if count is 0. */
void error_rate_text(size_t events, size_t count, char *text, size_t text_bytes);

#endif
