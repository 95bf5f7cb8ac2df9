#include "bench/chart/pareto.h"

#include <math.h>

static bool counts(const struct pareto_point *p)
{
    return isfinite(p->size) && p->size > 0 && isfinite(p->speed) && p->speed > 0 &&
           isfinite(p->error) && p->error >= 0;
}

/* At least as good in everything and better in one. */
static bool beats(const struct pareto_point *a, const struct pareto_point *b)
{
    return a->size <= b->size && a->speed >= b->speed && a->error <= b->error &&
           (a->size < b->size || a->speed > b->speed || a->error < b->error);
}

size_t pareto_front(const struct pareto_point *point, size_t count, bool *on)
{
    size_t found = 0;
    for (size_t i = 0; i < count; i++) {
        on[i] = counts(&point[i]);
        for (size_t k = 0; k < count && on[i]; k++)
            on[i] = !(counts(&point[k]) && beats(&point[k], &point[i]));
        found += on[i];
    }
    return found;
}

static double merit(const struct pareto_point *p, int what)
{
    if (what == WORTH_FASTEST)
        return p->speed;
    return what == WORTH_SMALLEST ? 1 / p->size : p->speed * p->speed / p->size;
}

/* True if the point has no error and no other such point beats it. */
static bool is_worth(const struct pareto_point *point, size_t count, size_t i)
{
    bool on = counts(&point[i]) && point[i].error <= 0;
    for (size_t k = 0; k < count && on; k++)
        on = !(counts(&point[k]) && point[k].error <= 0 && beats(&point[k], &point[i]));
    return on;
}

void pareto_worth(const struct pareto_point *point, size_t count, size_t worth[PARETO_WORTH])
{
    for (int what = 0; what < PARETO_WORTH; what++) {
        worth[what] = count;
        for (size_t i = 0; i < count; i++) {
            bool taken = false;
            for (int k = 0; k < what; k++)
                taken = taken || worth[k] == i;
            if (taken || !is_worth(point, count, i))
                continue;
            if (worth[what] == count || merit(&point[i], what) > merit(&point[worth[what]], what))
                worth[what] = i;
        }
    }
}
