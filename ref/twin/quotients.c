#include "ref/twin/quotients.h"

#include <math.h>

/* Of bounds that are computed in double. */
#define OUTWARD (1.0 + 0x1p-40)
/* Divisors that are tried one by one; if there may be more only the bounds count. */
#define DIVISORS_MOST 4096.0
/* Divisions that are not correctly rounded are promised between them (ref/twin/twin_steps.h). */
#define LEAST_DIVISOR 0x1p-125
#define MOST_DIVISOR  0x1p125
/* Divisors, all positive, that bounds leave possible. */
struct left {
    double lo, hi;
};

/* Keeps those with slope * divisor <= bound. */
static void keep(struct left *left, double slope, double bound)
{
    if (slope > 0.0)
        left->hi = fmin(left->hi, bound / slope * OUTWARD);
    else if (slope < 0.0)
        left->lo = fmax(left->lo, bound / slope / OUTWARD);
    else if (bound < 0.0)
        left->hi = -INFINITY;
}

static double lowest(const struct quotients *s, const struct quotients_part *part)
{
    return part->lo - s->share * fabs(part->lo) - s->tiny;
}

static double highest(const struct quotients *s, const struct quotients_part *part)
{
    return part->hi + s->share * fabs(part->hi) + s->tiny;
}

static void bound(const struct quotients *s, struct left *left)
{
    for (int i = 0; i < s->parts; i++) {
        const struct quotients_part *part = &s->part[i];
        keep(left, lowest(s, part), part->number.hi);
        keep(left, -highest(s, part), -part->number.lo);
    }
    keep(left, lowest(s, &s->part[0]) - s->mean_hi, s->pad);
    keep(left, s->mean_lo - highest(s, &s->part[0]), s->pad);
}

/* True if there is such a numerator. */
static bool part_fits(const struct quotients *s, const struct quotients_part *part, double divisor)
{
    double lo = lowest(s, part) * divisor, hi = highest(s, part) * divisor;
    const struct scatter *n = &part->number;
    lo -= fabs(lo) * 0x1p-40;
    hi += fabs(hi) * 0x1p-40;
    for (int i = 0; i < n->count; i++)
        if (n->value[i] >= lo && n->value[i] <= hi)
            return true;
    if (n->count)
        return false;
    lo = fmax(lo, n->lo);
    hi = fmin(hi, n->hi);
    return lo <= hi && (!isfinite(hi) || ldexp(floor(ldexp(hi, -n->grid)), n->grid) >= lo);
}

static bool divisor_fits(const struct quotients *s, double divisor)
{
    struct left left = {0.0, INFINITY};
    bound(s, &left);
    if (!(divisor >= left.lo && divisor <= left.hi))
        return false;
    for (int i = 0; i < s->parts; i++)
        if (!part_fits(s, &s->part[i], divisor))
            return false;
    return true;
}

bool quotients_fit(const struct quotients *given, bool negative)
{
    struct quotients s = *given;
    if (negative) {
        s.divisor = scatter_negate(&s.divisor);
        for (int i = 0; i < s.parts; i++)
            s.part[i].number = scatter_negate(&s.part[i].number);
    }
    const struct scatter *d = &s.divisor;
    if (s.estimated && d->hi > 0.0 && (scatter_least(d) < LEAST_DIVISOR || d->hi > MOST_DIVISOR))
        return true;
    for (int i = 0; i < d->count; i++)
        if (d->value[i] > s.above && divisor_fits(&s, d->value[i]))
            return true;
    if (d->count)
        return false;
    struct left left = {fmax(d->lo, ldexp(1.0, d->grid)), d->hi};
    left.lo = fmax(left.lo, s.above);
    bound(&s, &left);
    double from = ceil(ldexp(left.lo, -d->grid)), to = floor(ldexp(left.hi, -d->grid));
    if (!(left.lo <= left.hi) || from > to)
        return false;
    if (!(to - from <= DIVISORS_MOST))
        return true;
    for (double n = from; n <= to; n++)
        if (divisor_fits(&s, ldexp(n, d->grid)))
            return true;
    return false;
}

bool quotients_fit_either(const struct quotients *given)
{
    return quotients_fit(given, false) || quotients_fit(given, true);
}
