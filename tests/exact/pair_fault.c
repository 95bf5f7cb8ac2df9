#include "tests/exact/pair_fault.h"

#include "ref/integers/fraction.h"

#include <float.h>
#include <math.h>

/* Of a t that few doubles are near to, an enclosure is as wide as this. */
static bool is_extreme(double lo, double hi)
{
    double least = fmin(fabs(lo), fabs(hi)), most = fmax(fabs(lo), fabs(hi));
    return (least == 0 && most == FRACTION_LEAST) || (least == FRACTION_MOST && isinf(most));
}

/* lo <= a <= hi, the filter's ends apart from a, and the enclosure is narrow. */
static bool encloses(const mpq_t a, const struct oracle_pair *pair, bool narrow)
{
    double lo = pair->t_lo, hi = pair->t_hi;
    int least = pair->by_filter ? 1 : 0;
    return exact_gmp_compare(a, lo) >= least && exact_gmp_compare(a, hi) <= -least &&
           (!narrow || is_extreme(lo, hi) || hi - lo <= 0x1p-40 * fmin(fabs(lo), fabs(hi)));
}

static double least_weight(const struct gmp_pair *pair)
{
    const mpq_t *least = &pair->weight[0];
    for (int c = 1; c < 3; c++)
        if (mpq_cmp(pair->weight[c], *least) < 0)
            least = &pair->weight[c];
    return mpq_get_d(*least);
}

/* What is wrong with the numbers of what is no hit: it has no t, and its margin is below 0, exact
 * unless the filter sufficed. */
static const char *miss_fault(const struct oracle_pair *got, const struct gmp_pair *want)
{
    double margin = want->point ? least_weight(want) : -INFINITY;
    if (got->t_lo != -INFINITY || got->t_hi != INFINITY)
        return "t of a miss";
    if (!(got->margin < 0) || (!want->point && got->margin != -INFINITY))
        return "margin of a miss";
    if (want->point && !got->by_filter &&
        fabs(got->margin - margin) > 1e-9 * fabs(margin) + DBL_MIN)
        return "exact margin of a miss";
    return NULL;
}

const char *pair_fault(const struct ray *ray, const struct oracle_pair *got,
                       const struct gmp_pair *want)
{
    bool hit =
        want->class == ORACLE_INSIDE || want->class == ORACLE_EDGE || want->class == ORACLE_VERTEX;
    if (got->class != want->class)
        return "class";
    if ((hit || want->class == ORACLE_IN_PLANE) && got->range != want->range)
        return "range";
    if ((got->det != 0) != want->point && want->class != ORACLE_ZERO_AREA)
        return "sign of the determinant";
    for (int c = 0; want->point && c < 3; c++)
        if (got->edge[c] * got->det != want->side[c])
            return "sign of an edge";
    if (want->class == ORACLE_MISS || want->class == ORACLE_ZERO_AREA)
        return miss_fault(got, want);
    if (hit && !encloses(want->t, got, want->range == ORACLE_WITHIN))
        return "enclosure";
    if (hit) {
        double margin = least_weight(want);
        if (fabs(got->margin - margin) >
            1e-9 * margin + DBL_MIN + (got->by_filter ? 0x1p-18 * margin : 0))
            return "margin";
    }
    if (want->class == ORACLE_IN_PLANE) { /* the overlap, cut by the range if it meets it */
        bool within = want->range == ORACLE_WITHIN;
        double tmin = (double)ray->tmin, tmax = (double)ray->tmax;
        bool low_cut = within && exact_gmp_compare(want->t, tmin) < 0;
        bool high_cut = within && exact_gmp_compare(want->t_out, tmax) > 0;
        if (got->margin != 0)
            return "margin in the plane";
        if (low_cut ? got->t_lo != tmin : exact_gmp_compare(want->t, got->t_lo) < 0)
            return "start in the plane";
        if (high_cut ? got->t_hi != tmax : exact_gmp_compare(want->t_out, got->t_hi) > 0)
            return "end in the plane";
    }
    return NULL;
}

const char *answer_fault(const struct oracle_answer *got, const struct gmp_nearest *want,
                         const struct gmp_pair *pair)
{
    if (got->prim != want->prim || got->tie_count != want->count)
        return "nearest set";
    if (want->count == 0)
        return got->class == ORACLE_MISS && got->t_next == INFINITY ? NULL : "a miss";
    if (got->class != pair->class)
        return "class";
    if (exact_gmp_compare(want->t, got->t_lo) < 0 || exact_gmp_compare(want->t, got->t_hi) > 0)
        return "enclosure";
    if ((got->t_next < INFINITY) != want->has_next)
        return "whether there is a next hit";
    if (want->has_next &&
        (exact_gmp_compare(want->next, got->t_next) < 0 ||
         exact_gmp_compare(want->next, got->t_next + fabs(got->t_next) * 0x1p-38 + 0x1p-990) > 0))
        return "next hit";
    return NULL;
}

bool answer_is_exact(const struct oracle *oracle, const struct ray *ray,
                     const struct oracle_answer *answer)
{
    struct oracle_pair pair;
    if (answer->tie_count != 1)
        return answer->tie_count > 1;
    oracle_pair(oracle, ray, answer->prim, &pair);
    return !pair.by_filter;
}

bool answer_same(const struct oracle_answer *a, const struct oracle_answer *b)
{
    return a->prim == b->prim && a->tie_count == b->tie_count && a->t_lo == b->t_lo &&
           a->t_hi == b->t_hi && a->t_next == b->t_next && a->margin == b->margin &&
           a->class == b->class && a->flags == b->flags;
}
