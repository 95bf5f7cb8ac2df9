/* The instances of a world as the oracle walks them: a tree over their boxes, and each one's
 * inverse in double. For the oracle's own files. */
#ifndef ORACLE_PLACING_H
#define ORACLE_PLACING_H

#include "ref/oracle/oracle_tree.h"
#include "ref/oracle/pair.h"
#include "ref/world/world.h"

/* W, the inverse of M: each number is at most 6 * 2^-53 of itself from the exact one. */
struct inverse {
    double w[3][3];
    int8_t det_sign; /* of det M */
    bool identity;   /* instance_is_identity: there is no W */
};

struct placing {
    const struct world *world;
    struct oracle **mesh;    /* one a mesh */
    struct inverse *inverse; /* one an instance */
    struct tree top;         /* over the instances that are active and not empty: `order` has their
                                numbers */
};

void placing_free(struct placing *placing); /* NULL is fine */

/* Where triangle `prim` of the world is, which belongs to `instance`. */
struct located placing_locate(const struct placing *placing, uint32_t instance, uint32_t prim);

/* Inverts M by integers. M is finite, det M not 0. Its numbers are 0 or in 2^-690 .. 2^710. */
void placing_invert(const float m[3][4], struct inverse *out);

/* Widening of a world box: its sums of three products and a number have three roundings, and so
 * has the size that this is a share of; the widening itself is rounded twice. */
#define PLACING_PAD (6 * 0x1p-53)

/* A box of floats, perhaps infinite ones, that surely contains M v + T of every v in `box`, which
 * is not empty. */
struct box placing_bounds(const float m[3][4], const struct box *box);

/* A ray in the space of a mesh, o' = W (o - T) and d' = W d, known to the errors. */
struct sight {
    double o[3], d[3];
    double o_err[3], d_err[3];
};

/* Share of the sizes, sum |W| |x|, that bounds the errors of o' and d'. With e = 2^-53: W is off by
 * 6 e, x = o - T by e, a product and two sums by 3 e; so o' is off by 10.1 e of the exact sizes,
 * which the computed ones miss by as much, relatively. One more e is left for what rounds o' +
 * o_err and its like, which is at most the size of o', and all is rounded up. Nothing overflows or
 * underflows: W is in 2^-690 .. 2^710 and x in 2^-149 .. 2^129. */
#define SIGHT_PAD (14 * 0x1p-53)

/* The ray in the space of the mesh of an instance that is not at the identity. */
void sight_make(const struct inverse *inverse, const struct instance *instance,
                const struct ray *ray, struct sight *out);

#endif
