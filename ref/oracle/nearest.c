#include "ref/oracle/nearest.h"

#include <math.h>

void nearest_start(struct nearest *nearest)
{
    nearest->count = 0;
    nearest->next = INFINITY;
    nearest->plane_lo = INFINITY;
}

static void start_set(struct nearest *nearest, const struct decided *hit)
{
    nearest->rep.prim = nearest->prim = hit->prim;
    nearest->rep.at = hit->at;
    nearest->rep.pair = hit->pair;
    nearest->rep.have_exact = hit->have_exact;
    if (hit->have_exact) /* large and rare */
        nearest->rep.exact = hit->exact;
    nearest->count = 1;
    nearest->prim_lo = nearest->least_lo = hit->pair.t_lo;
    nearest->prim_hi = hit->pair.t_hi;
    nearest->margin = hit->pair.margin;
    nearest->class = hit->pair.class;
    nearest->exact = !hit->pair.by_filter;
}

static void join_set(struct nearest *nearest, const struct decided *hit)
{
    nearest->count++;
    nearest->exact = true; /* two were compared */
    nearest->least_lo = fmin(nearest->least_lo, hit->pair.t_lo);
    nearest->margin = fmin(nearest->margin, hit->pair.margin);
    if (hit->prim < nearest->prim) {
        nearest->prim = hit->prim;
        nearest->prim_lo = hit->pair.t_lo;
        nearest->prim_hi = hit->pair.t_hi;
        nearest->class = hit->pair.class;
    }
}

void nearest_add(struct nearest *nearest, const struct ray *ray, enum oracle_ends ends,
                 struct decided *pair)
{
    if (!oracle_in_range(&pair->pair, ends))
        return;
    if (pair->pair.class == ORACLE_IN_PLANE)
        nearest->plane_lo = fmin(nearest->plane_lo, pair->pair.t_lo);
    if (!oracle_is_hit(&pair->pair))
        return;
    int sign = nearest->count ? pair_order(ray, pair, &nearest->rep) : -1;
    if (sign > 0) {
        nearest->next = fmin(nearest->next, pair->pair.t_lo);
    } else if (sign == 0) {
        join_set(nearest, pair);
    } else {
        if (nearest->count)
            nearest->next = fmin(nearest->next, nearest->least_lo);
        start_set(nearest, pair);
    }
}

/* Let x be the hit that gave next: t_x <= next * (1 + 2^-39), since its enclosure is at most 2^-40
 * wide. A triangle with t > next * (1 + 2^-38) is behind x and so not of the set, and its own t_lo
 * is at least t * (1 - 2^-40) > next, so it does not lower next. (For negative t read the factors
 * the other way round.) The same holds of the start of an interval in a plane. */
double nearest_reach(const struct nearest *nearest)
{
    return nearest->next + fabs(nearest->next) * 0x1p-38;
}

void nearest_finish(const struct nearest *nearest, struct oracle_answer *out)
{
    *out = (struct oracle_answer){
        .prim = ABI_NO_PRIM, .t_lo = INFINITY, .t_hi = INFINITY, .t_next = INFINITY};
    if (nearest->count) {
        out->prim = nearest->prim;
        out->tie_count = nearest->count;
        out->t_lo = nearest->prim_lo;
        out->t_hi = nearest->prim_hi;
        out->t_next = nearest->next;
        out->margin = (float)nearest->margin;
        out->class = (uint8_t)nearest->class;
        out->flags = nearest->exact ? ORACLE_SAW_EXACT : 0;
    }
    if (nearest->plane_lo <= out->t_hi && nearest->plane_lo < INFINITY)
        out->flags |= ORACLE_SAW_IN_PLANE;
}
