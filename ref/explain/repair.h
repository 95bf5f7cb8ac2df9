/* Causes of wrong answers, and the single repairs that find them: a wrong ray is traced again and
 * again, each time with one thing corrected; the one that makes the answer allowed is the cause. */
#ifndef EXPLAIN_REPAIR_H
#define EXPLAIN_REPAIR_H

#include "ref/base/base.h"

/* Causes, the most specific first: where several repairs help, the first is named. */
enum cause {
    CAUSE_NONE, /* the answer is allowed */
    /* What a leaf tests. */
    CAUSE_INDEX_TRUNCATED, /* a triangle's index has more bits than its field (F10) */
    CAUSE_SLOT_NOT_READ,   /* an item slot is not read in any leaf that uses it, or not counted */
    CAUSE_SENTINEL,        /* triangle 0 or a stored 0 taken for an empty slot */
    CAUSE_INDEX_SHIFTED,   /* the leaf tests the triangle before its own (F2) */
    CAUSE_WRONG_ITEM,      /* the leaf tests triangles that have nothing to do with its own */
    CAUSE_STORED_TRIANGLE, /* what is stored in place of vertices is not the scene's triangle */
    /* Boxes: the bytes against the tree. */
    CAUSE_HALF_OVERFLOW,          /* a stored bound is infinite or NaN */
    CAUSE_HALF_SUBNORMAL_FLUSHED, /* a bound below 2^-14 in magnitude reads as 0 */
    CAUSE_ROUNDED_INWARD,         /* inside the tree's bound by at most a float16 step */
    CAUSE_STORED_BOX,             /* inside by more: the bytes are not the tree's box */
    CAUSE_CUT_BOX,                /* the tree's own box does not contain its triangles (F5) */
    CAUSE_ORIENTED_BOX,           /* an oriented box does not contain what is below it */
    CAUSE_REFERENCE_TRUNCATED,    /* a record's index has more bits than its field (F9) */
    CAUSE_CHILD_REFERENCE,        /* a child reference leads elsewhere, or a node reads as a leaf */
    /* The box test. */
    CAUSE_PARALLEL_AXIS,         /* a direction component of 0 divides by zero */
    CAUSE_STRICT_COMPARISON,     /* < where <= is needed: flat boxes are lost */
    CAUSE_BOX_PADDING_TOO_SMALL, /* the far plane is not padded by all roundings */
    CAUSE_BOX_TEST,              /* something else of the box test */
    CAUSE_ORIENTED_TEST,         /* the test of the oriented boxes turns away what meets them */
    /* The triangle test. */
    CAUSE_DETERMINANT_THRESHOLD, /* |determinant| under an absolute threshold (F16) */
    CAUSE_TRIANGLE_TEST,         /* the formula's own error */
    /* The traversal. */
    CAUSE_STACK,          /* the stack was full */
    CAUSE_LOOP_CAP,       /* a loop ended early: the driver's cap, or the budget of visits */
    CAUSE_CULLED_BY_BEST, /* a box was skipped because of a nearer hit that is none */
    CAUSE_STALE_BEST,     /* a farther triangle replaced a nearer one (F13) */
    /* A layout reproduces a program that ends with an error in place of an answer. */
    CAUSE_LEAF_OVERFULL, /* more triangles in a leaf than its record has slots (F8) */
    CAUSE_ITEM_AS_NODE,  /* items of a leaf are taken for references to nodes (F6) */
    /* Bytes that are no tree: the rule that they break, if no cause above fits. */
    CAUSE_BOUND_TOO_SMALL,  /* a box does not contain what is below it */
    CAUSE_TRIANGLE_LOST,    /* a triangle is in no leaf */
    CAUSE_TRIANGLE_TWICE,   /* a triangle is named again */
    CAUSE_ITEM_RANGE,       /* a leaf has an index that is no triangle of the scene */
    CAUSE_STACK_NEED,       /* a path needs more stack than packed.stack_need */
    CAUSE_RECORD_MALFORMED, /* a record of a layout from outside is no node */
    CAUSE_PACK_RESULT,      /* its pack() did not do what it reports */
    CAUSE_DEVICE_BUILD,     /* a device built another tree than C, before it was packed */
    /* Outside the bytes. */
    CAUSE_DRIVER_ARITHMETIC, /* an operator of the engine is not what C has: shown by other rays, or
                                by an answer that its operators' bounds allow, but C's do not give
                              */
    CAUSE_SHADER,         /* operators exact, bytes right, C right on them: the engine's own code */
    CAUSE_NOT_REPEATABLE, /* the same ray, traced twice, got two answers */
    CAUSE_STALE, /* wrong after steps, right if the engine is opened and prepared anew: it kept
                    something of before */
    CAUSE_SCALE, /* right at another scale: a constant that does not scale, or underflow; of engines
                    whose tree and formula are unknown */
    CAUSE_OUTSIDE, /* something else of such an engine */
    CAUSE_WORLD,   /* something of such an engine in a world */
    CAUSE_UNEXPLAINED,
    CAUSE_COUNT
};

/* "rounded_inward", ... */
const char *cause_name(enum cause cause);
/* Returns false if no cause has that name. */
bool cause_find(const char *name, enum cause *out);
/* One line: what it means. */
const char *cause_text(enum cause cause);

/* One thing corrected in a replay. A set of them is a mask of 1u << repair. */
enum repair {
    REPAIR_ITEM_TRUNCATED, /* item slots of that fault hold the tree's triangle; so the next four */
    REPAIR_ITEM_SLOT,
    REPAIR_ITEM_SENTINEL,
    REPAIR_ITEM_SHIFTED,
    REPAIR_ITEM_OTHER,
    REPAIR_ITEM_STORED,   /* triangles are the scene's, whatever the storage holds of them */
    REPAIR_REF_TRUNCATED, /* nodes whose children need more bits: the tree's children */
    REPAIR_BOX_OVERFLOW,  /* bounds of that fault are the tree's; so the next three */
    REPAIR_BOX_FLUSHED,
    REPAIR_BOX_ROUNDED,
    REPAIR_BOX_STORED,
    REPAIR_BOX_CUT,       /* bounds that do not contain their triangles: exact */
    REPAIR_ORIENTED_BOX,  /* oriented boxes that do not contain what is below them: not tested */
    REPAIR_REF,           /* all other wrong children: the tree's */
    REPAIR_PARALLEL,      /* box test: an axis of direction 0 is decided by comparison */
    REPAIR_CLOSED,        /* box test: <= */
    REPAIR_PADDING,       /* box test: planes padded as the repaired tests have it */
    REPAIR_BOX_TEST,      /* box test: conservative, in double */
    REPAIR_ORIENTED_TEST, /* test of oriented boxes: conservative, in double */
    REPAIR_WATERTIGHT,    /* box test: watertight in place of this one */
    REPAIR_THRESHOLD,     /* triangle test: determinant not 0 */
    REPAIR_STACK,         /* as many entries as there are nodes */
    REPAIR_VISITS,        /* four times as many visits as nodes */
    REPAIR_CULLING,       /* the best hit so far culls no box */
    REPAIR_TRIANGLE,      /* triangle test: exact */
    REPAIR_COUNT
};

/* The cause that it proves if it helps. */
enum cause repair_cause(enum repair repair);
/* One line: what is corrected. */
const char *repair_text(enum repair repair);

/* A known defect, planted into a replay to find out whether it gives the answer of an engine whose
 * code is not accessible. */
enum defect {
    DEFECT_NONE,
    DEFECT_SLOT,        /* item slot `parameter` of a leaf is not tested */
    DEFECT_ZERO,        /* triangle 0 is an empty slot */
    DEFECT_SHIFT,       /* item k tests triangle k - 1 */
    DEFECT_NEAR_AGAIN,  /* the near child's reference is pushed for the far one */
    DEFECT_FAR_DROPPED, /* the stack holds `parameter` entries; what does not fit is lost */
    DEFECT_STACK_FULL,  /* the stack holds `parameter` entries; one more ends the walk unfinished */
    DEFECT_FLUSHED,     /* bounds below 2^-14 in magnitude read as 0 */
    DEFECT_STRICT,      /* box test: < */
    DEFECT_NOT_PADDED,  /* box test: planes padded by `parameter` u only, u = 2^-24 */
    DEFECT_NOT_BEHIND,  /* box test: what reaches behind the origin forgotten */
    DEFECT_SLAB_FUSED,  /* box test: fma(b, 1/d, -(o * 1/d)) */
    DEFECT_SLAB_SPLIT,  /* box test: b * 1/d - o * 1/d, each rounded */
    DEFECT_ORIENTED_TURNED,  /* oriented boxes: rows of the axes' numbers for columns */
    DEFECT_ORIENTED_SHIFTED, /* oriented boxes: each axis has the bounds of the next */
    DEFECT_EDGE_FUSED,       /* triangle test: products and sums contracted to fma */
    DEFECT_LAST_WINS,        /* within a leaf the last accepted triangle wins */
    DEFECT_LOOP,             /* the walk ends after `parameter` nodes */
    DEFECT_COUNT
};

enum cause defect_cause(enum defect defect);
const char *defect_text(enum defect defect);
/* Whether it has a parameter. */
bool defect_is_numbered(enum defect defect);

#endif
