/* The steps of ref/twin/twin_steps.h on vectors of LANES pairs. Expects LANES, KERNEL_TARGET and
 * VECTOR_BYTES of a vector of doubles. The float32 values are computed only where a formula
 * uses them; they are not among the results. */
#include "ref/twin/twin_lanes.h"

#include <stdint.h>
#include <string.h>

typedef double real __attribute__((vector_size(VECTOR_BYTES)));
typedef float single __attribute__((vector_size(VECTOR_BYTES / 2)));
typedef int64_t mask __attribute__((vector_size(VECTOR_BYTES)));

#define ALL(x)               ((real){0} + (x))
#define EACH(x)              ((single){0} + (x))
#define WIDEN(x)             __builtin_convertvector(x, real)
#define SIZE(x)              ((real)((mask)(x)&INT64_MAX))
#define LESS(a, b)           ((mask)((a) < (b)))
#define NOT_ABOVE(a, b)      ((mask)((a) <= (b)))
#define EQUAL(a, b)          ((mask)((a) == (b)))
#define NOT(m)               (~(m))
#define ANY(m)               any_lane(m)
#define SELECT(m, a, b)      ((real)(((mask)(a) & (m)) | ((mask)(b) & ~(m))))
#define SELECT_EACH(m, a, b) (a) /* not read */

KERNEL_TARGET static inline bool any_lane(mask m)
{
    int64_t any = 0;
    for (int i = 0; i < LANES; i++)
        any |= m[i];
    return any != 0;
}

#include "ref/twin/twin_steps.h"

STEP struct bounded load(const float *from)
{
    single v;
    memcpy(&v, from, sizeof v);
    return exact(v);
}

STEP void store(struct bounded value, struct twin_output *out, int which, int at)
{
    memcpy(&out->x[which][at], &value.x, sizeof value.x);
    memcpy(&out->e[which][at], &value.e, sizeof value.e);
}

FORMULA void evaluate_lanes(enum twin_formula formula, const struct rounding *rounding,
                            const struct twin_input *in, struct twin_output *out)
{
    const struct rules rules = rules_of(rounding);
    for (int at = 0; at < TWIN_LANES; at += LANES) {
        struct input lanes;
        for (int k = 0; k < 3; k++) {
            lanes.o[k] = load(&in->o[k][at]);
            lanes.d[k] = load(&in->d[k][at]);
            for (int c = 0; c < 3; c++)
                lanes.v[c][k] = load(&in->v[c][k][at]);
        }
        struct outcome outcome = evaluate(formula, &rules, &lanes);
        for (int c = 0; c < 3; c++)
            store(outcome.edge[c], out, TWIN_EDGE + c, at);
        store(outcome.det, out, TWIN_DET, at);
        store(outcome.t, out, TWIN_T, at);
        store(outcome.u, out, TWIN_U, at);
        store(outcome.v, out, TWIN_V, at);
        memcpy(&out->band[at], &outcome.band, sizeof outcome.band);
        memcpy(&out->t_running[at], &outcome.t_running, sizeof outcome.t_running);
    }
}
