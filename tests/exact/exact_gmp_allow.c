/* What bounds (tests/exact/exact_gmp_bounds.h) say of an answer: certain, possible, allowed. */
#include "ref/base/base.h"
#include "tests/exact/exact_gmp_known.h"

#include <math.h>

/* Sign that every evaluation has, or 0; `slack` more is allowed. */
static int sure_sign(const struct known *known, const mpq_t slack)
{
    mpq_t size, error;
    mpq_inits(size, error, NULL);
    mpq_abs(size, known->v);
    mpq_add(error, known->e, slack);
    int sign = mpq_cmp(size, error) > 0 ? mpq_sgn(known->v) : 0;
    mpq_clears(size, error, NULL);
    return sign;
}

/* Sign of known.v + side * known.e - x. */
static int end_against(const struct known *known, int side, double x)
{
    if (isinf(x))
        return x > 0 ? -1 : 1;
    mpq_t end, limit;
    mpq_inits(end, limit, NULL);
    mpq_set_d(limit, x);
    if (side > 0)
        mpq_add(end, known->v, known->e);
    else
        mpq_sub(end, known->v, known->e);
    int sign = mpq_cmp(end, limit);
    mpq_clears(end, limit, NULL);
    return sign;
}

/* |det| is surely above the threshold, or surely not. */
static void size_of_det(const struct gmp_bounds *bounds, bool *above, bool *below)
{
    mpq_t size, limit;
    mpq_inits(size, limit, NULL);
    mpq_set_d(limit, bounds->threshold);
    mpq_abs(size, bounds->det.v);
    mpq_sub(size, size, bounds->det.e);
    *above = mpq_cmp(size, limit) > 0;
    mpq_abs(size, bounds->det.v);
    mpq_add(size, size, bounds->det.e);
    *below = mpq_cmp(size, limit) <= 0;
    mpq_clears(size, limit, NULL);
}

bool gmp_bounds_certain(const struct gmp_bounds *bounds, const struct ray *ray)
{
    mpq_t none;
    int inside = 0;
    bool above, below;
    if (bounds->none || !bounds->divided)
        return false;
    mpq_init(none);
    for (int c = 0; c < 3; c++)
        inside += sure_sign(&bounds->edge[c], none);
    mpq_clear(none);
    size_of_det(bounds, &above, &below);
    return (inside == 3 || inside == -3) && above &&
           end_against(&bounds->t, -1, (double)ray->tmin) > 0 &&
           end_against(&bounds->t, 1, (double)ray->tmax) < 0;
}

bool gmp_bounds_possible(const struct gmp_bounds *bounds, const struct ray *ray)
{
    mpq_t none;
    bool above, below;
    if (bounds->none)
        return true;
    mpq_init(none);
    int det = bounds->det_alone ? 0 : sure_sign(&bounds->det, none);
    bool positive = det > 0, negative = det < 0;
    for (int c = 0; c < 3; c++) {
        int sign = sure_sign(&bounds->edge[c], bounds->band);
        positive |= sign > 0;
        negative |= sign < 0;
    }
    mpq_clear(none);
    size_of_det(bounds, &above, &below);
    if (below || (positive && negative))
        return false;
    return !bounds->divided || (end_against(&bounds->t, 1, (double)ray->tmin) >= 0 &&
                                end_against(&bounds->t, -1, (double)ray->tmax) <= 0);
}

bool gmp_bounds_allow(const struct known *known, float value)
{
    return float_is_finite(value) && end_against(known, 1, (double)value) >= 0 &&
           end_against(known, -1, (double)value) <= 0;
}
