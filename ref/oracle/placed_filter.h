/* The double filter of ref/oracle/filter.h for a placed triangle, whose vertices M v + T are
 * rounded, too.
 *
 * T - o has one rounding; products of M and v none, since the numbers are float32; so A = M v +
 * (T - o) is a sum of terms with at most 3 each: two sums and the last. The edges are M (v2 - v1)
 * and its like, with 4: a difference, a product, two sums. w = d . (A x E), D = d . (E x E) and
 * T = A . (E x E) have then at most 3 + 4 + 4 and a product, a difference, a product and two sums:
 * 16; so |computed - exact| <= gamma_16 * perm, where perm is the same expression with every term
 * of every sum taken positive. perm is computed too, from sizes of A and E that are made in the
 * same order, and so is no less than (1 - 2^-53)^16 of its exact value, and the product with the
 * constant takes one more: 17 * 2^-53 covers that, since 16 (1 + 34 * 2^-53) < 17.
 * A and E are whole multiples of 2^-298 below 2^260, rounded or not; so all products lie in
 * 2^-894 .. 2^790 or are 0, and nothing overflows or underflows. */
#ifndef ORACLE_PLACED_FILTER_H
#define ORACLE_PLACED_FILTER_H

#include "ref/oracle/filter.h"
#include "ref/world/world.h"

#define PLACED_CUBIC (17 * 0x1p-53)

struct placed_filter {
    struct filter filter;
    double a_size[3][3], e_size[3][3]; /* of the terms of a and e, in sum */
};

/* As filter_edges and filter_plane. */
void placed_edges(const struct ray *ray, float v[3][3], const struct instance *at,
                  struct placed_filter *out);
void placed_plane(struct placed_filter *out);

/* Whether w, D and T are so far within the range of double that quotients of them, widened by any
 * bounds that prove their signs, neither overflow nor underflow. 0 is. */
bool placed_is_moderate(const struct placed_filter *placed);

#endif
