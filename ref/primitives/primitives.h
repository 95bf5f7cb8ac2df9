/* Tables of box tests, triangle tests and queries: names, ids, guarantees. */
#ifndef PRIMITIVES_H
#define PRIMITIVES_H

#include "ref/abi.h"
#include "ref/base/base.h"

enum query {
    QUERY_CLOSEST = ABI_QUERY_CLOSEST,
    QUERY_ANY = ABI_QUERY_ANY,
    QUERY_ALL = ABI_QUERY_ALL, /* every triangle that the ray hits */
    QUERY_COUNT,
};

struct box_test {
    const char *name;
    const char *summary;
    uint32_t id;     /* ABI_BOX_* */
    bool faithful;   /* as published, faults included */
    bool watertight; /* keeps a watertight triangle test watertight on a tree */
};

struct tri_test {
    const char *name;
    const char *summary;
    uint32_t id; /* ABI_TRI_* */
    bool faithful;
    bool open;       /* accepts tmin < t < tmax instead of tmin <= t <= tmax */
    bool watertight; /* no ray passes between two triangles that share an edge */
    bool core;       /* included in the hard cases by default */
};

/* A miss. */
static inline struct hit hit_none(void)
{
    return (struct hit){.prim = ABI_NO_PRIM};
}

/* NULL-terminated; the first is the default. */
extern const struct box_test *const box_tests[];
extern const struct tri_test *const tri_tests[];

const struct box_test *box_test_find(const char *name); /* or NULL */
const struct tri_test *tri_test_find(const char *name); /* or NULL */

/* Returns "closest", "any" or "all". */
const char *query_name(enum query query);
/* Returns false if `name` is none of them. */
bool query_find(const char *name, enum query *out);

/* True if results are guaranteed for this ray: all numbers finite, 0 <= tmin <= tmax (tmax may be
 * infinite), direction not zero, no non-zero component below 2^-60 of the largest, the largest in
 * [2^-40, 2^40], origin at most 2^40 away. Other rays are traced without a guarantee and counted as
 * out of contract. */
bool ray_in_contract(const struct ray *ray);

#endif
