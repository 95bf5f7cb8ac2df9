/* How the map of fuzz/play/coverage.h is divided. For coverage*.c. */
#ifndef FUZZ_COVERAGE_BITS_H
#define FUZZ_COVERAGE_BITS_H

#include "fuzz/play/coverage.h"

/* Members beyond these share the last place. */
#define COVERAGE_BUILDERS  8u
#define COVERAGE_BOX_TESTS 3u
#define COVERAGE_TRI_TESTS 5u
#define COVERAGE_STORES    6u
#define COVERAGE_LAYOUTS   6u  /* that refused; those of products */
#define COVERAGE_FORMS     72u /* layouts, of all */

enum coverage_limit {
    COVERAGE_LIMIT_LEAF,    /* a leaf of more than 8 items */
    COVERAGE_LIMIT_RECORDS, /* a child record over 32767 */
    COVERAGE_LIMIT_INDICES, /* a triangle over 65535 */
    COVERAGE_LIMIT_BOUNDS,  /* a bound over 65504 */
    COVERAGE_LIMIT_OTHER,
    COVERAGE_LIMITS
};

enum coverage_shape {
    COVERAGE_SHAPE_EMPTY,  /* no triangle */
    COVERAGE_SHAPE_SINGLE, /* the root is a leaf */
    COVERAGE_SHAPE_FLAT,   /* a box without thickness in one axis, two, three */
    COVERAGE_SHAPE_LINE,
    COVERAGE_SHAPE_POINT,
    COVERAGE_SHAPE_CUT,   /* a box that does not contain its child's: builder rtrs */
    COVERAGE_SHAPE_SAME,  /* two children of the same box */
    COVERAGE_SHAPE_MIXED, /* a child's box is smaller than its parent's by 2^20 */
    COVERAGE_SHAPES
};

enum coverage_half {
    COVERAGE_HALF_INFINITE,
    COVERAGE_HALF_LARGEST,
    COVERAGE_HALF_LEAST, /* 2^-14 */
    COVERAGE_HALF_SUBNORMAL,
    COVERAGE_HALF_ZERO,
    COVERAGE_HALF_MINUS_ZERO,
    COVERAGE_HALF_FLAT,  /* lower and upper bound are equal */
    COVERAGE_HALF_STEP,  /* one step apart */
    COVERAGE_HALF_POWER, /* a power of two, where steps change */
    COVERAGE_HALVES
};

enum coverage_past {
    COVERAGE_PAST_OPTIMIZED, /* subtrees were moved to better places */
    COVERAGE_PAST_SPLIT,     /* triangles are in several leaves */
    COVERAGE_PAST_REFITTED,
    COVERAGE_PAST_REBUILT,
    COVERAGE_PASTS
};

enum coverage_ray {
    COVERAGE_RAY_OUT,       /* out of contract */
    COVERAGE_RAY_ONE_AXIS,  /* two components are 0 */
    COVERAGE_RAY_PARALLEL,  /* one component is 0 */
    COVERAGE_RAY_MINUS,     /* a component is -0 */
    COVERAGE_RAY_SUBNORMAL, /* a component is subnormal */
    COVERAGE_RAY_ZERO,      /* all are 0 */
    COVERAGE_RAY_NAN,       /* NaN somewhere */
    COVERAGE_RAY_INFINITE,  /* infinity in origin or direction */
    COVERAGE_RAY_INSIDE,    /* starts in the root's box */
    COVERAGE_RAY_ON_FACE,   /* starts on one of its planes */
    COVERAGE_RAY_ENDLESS,   /* tmax is infinite */
    COVERAGE_RAY_POINT,     /* tmin == tmax */
    COVERAGE_RAY_BACKWARD,  /* tmin > tmax */
    COVERAGE_RAY_FAST,      /* largest component over 2^20 */
    COVERAGE_RAY_SLOW,      /* under 2^-20 */
    COVERAGE_RAYS
};

/* After the classes MISS to IN_PLANE of enum oracle_class. */
enum coverage_truth {
    COVERAGE_TRUTH_SAW_PLANE = ORACLE_IN_PLANE + 1,
    COVERAGE_TRUTH_REFUSED,
    COVERAGE_TRUTH_INTEGERS,   /* the double filter did not suffice */
    COVERAGE_TRUTH_ON_TMIN,    /* the nearest t may be tmin */
    COVERAGE_TRUTH_ON_TMAX,    /* or tmax */
    COVERAGE_TRUTH_CLOSE_NEXT, /* another t within 2^-20 of it */
    COVERAGE_TRUTHS
};

/* Groups, in the order of their bits: name, bits. */
#define COVERAGE_GROUPS(X)                                                                         \
    X(VERDICT, 2 * VERDICT_COUNT)                   /* query x verdict */                          \
    X(WRONG, WRONG_COUNT)                           /* kind */                                     \
    X(BOTH, VERDICT_COUNT *(VERDICT_COUNT - 1) / 2) /* unlike verdicts of one ray */               \
    X(DEPTH, 16)                                    /* of the tree */                              \
    X(LEAF, 10)                                     /* items of a leaf */                          \
    X(MEMBERS, COVERAGE_BUILDERS *COVERAGE_BOX_TESTS *COVERAGE_TRI_TESTS)                          \
    X(SCALE, 12) /* of the largest coordinate */                                                   \
    X(SHAPE, COVERAGE_SHAPES)                                                                      \
    X(COUNT, 8)              /* beside the 16-byte records' limits */                              \
    X(STACK, 10)             /* entries needed */                                                  \
    X(HALF, COVERAGE_HALVES) /* stored bounds */                                                   \
    X(REFUSED, COVERAGE_LAYOUTS *COVERAGE_LIMITS)                                                  \
    X(TRUTH, COVERAGE_TRUTHS) /* class of the exact answer, flags */                               \
    X(TIES, 5)                                                                                     \
    X(RAY, COVERAGE_RAYS)                                                                          \
    X(ERROR, 8) /* err/E */                                                                        \
    X(DISPLACE, 7)                                                                                 \
    X(STORE, COVERAGE_STORES)                                                                      \
    X(PAST, COVERAGE_PASTS) /* what the tree went through */                                       \
    X(PACKED, COVERAGE_FORMS)

/* COVERAGE_VERDICT is the first bit of its group, and so on. */
#define COVERAGE_PLACE(name, bits)                                                                 \
    COVERAGE_##name, COVERAGE_##name##_LAST = COVERAGE_##name + (int)(bits)-1,
enum coverage_place { COVERAGE_GROUPS(COVERAGE_PLACE) COVERAGE_KNOWN };
_Static_assert((uint32_t)COVERAGE_KNOWN <= COVERAGE_BITS, "the map is full");

static inline void coverage_set(uint64_t map[COVERAGE_WORDS], uint32_t bit)
{
    map[bit / 64] |= (uint64_t)1 << (bit % 64);
}

#endif
