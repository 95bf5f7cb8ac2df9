/* The Pareto front of size, speed and error, and its points worth using. */
#ifndef PARETO_H
#define PARETO_H

#include "ref/base/base.h"

/* A measured point: smaller size, higher speed and smaller error are better. Size and speed are
 * positive. */
struct pareto_point {
    double size, speed, error;
};

/* Sets on[i] if no other point is at least as good in all three and better in one. Points that are
 * not finite or not positive (error: below 0) are never on the front. Returns the number of points
 * on it. */
size_t pareto_front(const struct pareto_point *point, size_t count, bool *on);

#define PARETO_WORTH 3
enum { WORTH_FASTEST, WORTH_SMALLEST, WORTH_BALANCED };

/* Considers the front of the points without error. Chooses the fastest; the smallest; and, of the
 * rest, the one with the largest speed * speed / size, which values a doubling of speed like a
 * quarter of the bytes. `count` if there is none. */
void pareto_worth(const struct pareto_point *point, size_t count, size_t worth[PARETO_WORTH]);

#endif
