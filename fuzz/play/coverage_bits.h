/* How the map of fuzz/play/coverage.h is divided. For coverage*.c. */
#ifndef FUZZ_COVERAGE_BITS_H
#define FUZZ_COVERAGE_BITS_H

#include "fuzz/play/coverage.h"

/* Members beyond these share the last place. */
#define COVERAGE_BUILDERS  16u
#define COVERAGE_BOX_TESTS 3u
#define COVERAGE_TRI_TESTS 5u
#define COVERAGE_STORES    8u
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

enum coverage_world {
    COVERAGE_WORLD_PLACE, /* + of trial_world_place */
    COVERAGE_WORLD_MIRRORED = 5,
    COVERAGE_WORLD_NO_MESH,
    COVERAGE_WORLD_MASK_0,
    COVERAGE_WORLD_MASKED, /* a mask that is neither 0 nor 0xFF */
    COVERAGE_WORLD_EMPTY,
    COVERAGE_WORLD_FILTERED,                          /* a geometry is not opaque */
    COVERAGE_WORLD_CUSTOM,                            /* a custom index over 16 bits */
    COVERAGE_WORLD_FLAGS,                             /* + number of the flag's bit */
    COVERAGE_WORLD_FILTER = COVERAGE_WORLD_FLAGS + 4, /* + filter_kind, but for FILTER_ALL */
    COVERAGE_WORLD_COUNT = COVERAGE_WORLD_FILTER + 3, /* instances: 1, 2, 3 to 8, more */
    COVERAGE_WORLDS = COVERAGE_WORLD_COUNT + 4
};

/* Groups, in the order of their bits: id, number of bits, name, and the names of the bits, if they
 * are listed here. The others are named after members of tables and enumerations. */
#define COVERAGE_GROUPS(X)                                                                         \
    X(VERDICT, 2 * VERDICT_COUNT, "verdict", NULL)                /* query x verdict */            \
    X(WRONG, WRONG_COUNT, "wrong", NULL)                          /* kind */                       \
    X(BOTH, VERDICT_COUNT *(VERDICT_COUNT - 1) / 2, "both", NULL) /* unlike verdicts of one ray */ \
    X(DEPTH, 16, "depth", "0 1 2 3 4 5 6 7 8-9 10-11 12-15 16-19 20-23 24-31 32-47 48-")           \
    X(LEAF, 10, "leaf", "1 2 3 4 5 6 7 8 9-15 16-") /* items */                                    \
    X(MEMBERS, COVERAGE_BUILDERS *COVERAGE_BOX_TESTS *COVERAGE_TRI_TESTS, "members", NULL)         \
    X(SCALE, 12, "scale", /* largest coordinate */                                                 \
      "0 -2^-126 -2^-60 -2^-24 -2^-14 -2^0 -2^10 -2^15 -2^16 -2^24 -2^40 2^40-")                   \
    X(SHAPE, COVERAGE_SHAPES, "shape",                                                             \
      "empty single flat line point cut_box same_boxes mixed_scales")                              \
    X(COUNT, 8, "count", /* beside the 16-byte records' limits */                                  \
      "items_32767 items_32768 items_65535 items_65536 items_65537- "                              \
      "records_32767 records_32768 records_32769-")                                                \
    X(STACK, 10, "stack", "0 1 2 3-4 5-8 9-15 16-23 24-31 32-47 48-") /* entries needed */         \
    X(HALF, COVERAGE_HALVES, "half",                                  /* stored bounds */          \
      "infinite 65504 2^-14 subnormal zero minus_zero no_width one_step power_of_two")             \
    X(REFUSED, COVERAGE_LAYOUTS *COVERAGE_LIMITS, "refused", NULL)                                 \
    X(TRUTH, COVERAGE_TRUTHS, "truth", /* class of the exact answer, flags */                      \
      "miss inside edge vertex in_plane saw_plane refused by_integers on_tmin on_tmax close_next") \
    X(TIES, 5, "ties", "2 3 4 5-8 9-")                                                             \
    X(RAY, COVERAGE_RAYS, "ray",                                                                   \
      "out_of_contract one_axis parallel minus_zero subnormal zero nan infinite from_inside "      \
      "on_face endless point backward fast slow")                                                  \
    X(ERROR, 8, "error", "0 -2^-8 -2^-4 -2^-2 -0.5 -0.75 -1 1-") /* err/E */                       \
    X(DISPLACE, 7, "displacement", "-1 -4 -16 -64 -256 -1024 1024-")                               \
    X(STORE, COVERAGE_STORES, "store", NULL)                                                       \
    X(PAST, COVERAGE_PASTS, "tree", "optimized split refitted rebuilt") /* since it was built */   \
    X(PACKED, COVERAGE_FORMS, "layout", NULL)                                                      \
    X(WORLD, COVERAGE_WORLDS, "world",                                                             \
      "identity moved powers_of_two scaled turned mirrored no_mesh mask_0 masked empty_mesh "      \
      "filtered custom cull_disable flip_facing force_opaque force_no_opaque filter_none "         \
      "filter_triangles filter_cells instances_1 instances_2 instances_3-8 instances_9-")          \
    X(MODE, 10, "mode",                                                                            \
      "opaque no_opaque first skip_closest cull_back cull_front cull_opaque cull_no_opaque "       \
      "skip_triangles masked")

/* COVERAGE_VERDICT is the first bit of its group, and so on. */
#define COVERAGE_PLACE(name, bits, prefix, words)                                                  \
    COVERAGE_##name, COVERAGE_##name##_LAST = COVERAGE_##name + (int)(bits)-1,
enum coverage_place { COVERAGE_GROUPS(COVERAGE_PLACE) COVERAGE_KNOWN };
_Static_assert((uint32_t)COVERAGE_KNOWN <= COVERAGE_BITS, "the map is full");

/* Sets bit `n` of a group, of which `first` is the first bit. */
static inline void coverage_set(uint64_t map[COVERAGE_WORDS], enum coverage_place first, uint32_t n)
{
    uint32_t bit = (uint32_t)first + n;
    map[bit / 64] |= (uint64_t)1 << (bit % 64);
}

#endif
