/* The Pareto front of size, speed and error, and which of its points are worth using. */
#ifndef PARETO_H
#define PARETO_H

#include "ref/base/base.h"

/* Something measured: less size, more speed, less error is better. Size and speed are positive. */
struct pareto_point {
    double size, speed, error;
};

/* on[i] is true if no other point is at least as good in all three and better in one; points that
 * are not finite or not positive (error: below 0) are never on it. Returns how many are. */
size_t pareto_front(const struct pareto_point *point, size_t count, bool *on);

#define PARETO_WORTH 3
enum { WORTH_FASTEST, WORTH_SMALLEST, WORTH_BALANCED };

/* Of the points of no error that are on the front of those: the fastest; the smallest; and the one
 * of most speed * speed / size of the rest, a doubling of speed being worth four times the bytes.
 * `count` where there is none. */
void pareto_worth(const struct pareto_point *point, size_t count, size_t worth[PARETO_WORTH]);

#endif
