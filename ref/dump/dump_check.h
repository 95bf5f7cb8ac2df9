/* What is wrong with a tree, and what it costs, without a ray. */
#ifndef DUMP_CHECK_H
#define DUMP_CHECK_H

#include "ref/dump/tree_dump.h"

enum dump_rule {
    DUMP_CHILD,     /* a child's number is that of no node */
    DUMP_CYCLE,     /* a child is the node itself or above it */
    DUMP_SHARED,    /* a child that another node, or the same one before, has as well */
    DUMP_UNREACHED, /* a node that the root does not lead to */
    DUMP_RANGE,     /* a leaf's range leaves the list of triangles; the rest of it is left out */
    DUMP_TAKEN,     /* a leaf's range meets another's; the rest of it is left out */
    DUMP_TRIANGLE,  /* a triangle's number is that of none */
    DUMP_DOUBLED,   /* a triangle that was in a leaf before; if the tree splits, in the same leaf */
    DUMP_MISSING,   /* a triangle in no leaf */
    DUMP_NAN,       /* a bound that is no number */
    DUMP_SMALL,     /* a box that does not contain a triangle below it; without a scene, a leaf */
    DUMP_UNCOVERED, /* of a tree that splits: a part of a triangle is in no leaf's box */
    DUMP_RULES
};

/* "child", "cycle" .. */
extern const char *const dump_rule_names[DUMP_RULES];

#define DUMP_NONE UINT32_MAX

/* One fault; what a rule does not use is DUMP_NONE. */
struct dump_fault {
    enum dump_rule rule;
    uint32_t node;
    uint32_t child;     /* of child, cycle and shared; of small without a scene: the leaf */
    uint32_t triangle;  /* or of range and taken: the place in the list */
    bool instance;      /* `triangle` is an instance of a top level */
    unsigned side;      /* of nan and small: 0-2 least x y z, 3-5 most */
    float bound, needs; /* of small: where the box ends, and where the triangle does */
};

/* Triangles whose overlap is measured; of larger scenes about so many. */
#define DUMP_OVERLAP_MOST 50000u

#define DUMP_GAP_MOST (1u << 16)

/* What was found. Of counts of a tree with faults: what the root leads to, each node once. */
struct dump_report {
    uint64_t count[DUMP_RULES];
    struct dump_fault *fault; /* of each rule the first `most`, by rule, then as they were found */
    size_t fault_count;
    uint64_t faults;      /* all of them */
    uint32_t gap;         /* of uncovered: grown by so many floats on each side all boxes would do;
                     DUMP_NONE: by DUMP_GAP_MOST not; 0: nothing is uncovered */
    uint32_t small_boxes; /* boxes too small, on however many sides */
    uint32_t nodes, inner, leaves, empty_leaves;
    uint32_t depth; /* the root is 0 */
    uint32_t width; /* most children of a node */
    uint32_t largest_leaf;
    uint64_t stack;   /* most entries of a traversal that pushes all children but one */
    uint64_t items;   /* triangles of the leaves */
    uint32_t judged;  /* boxes whose exact bounds are known: none of a tree that splits */
    uint32_t loose;   /* of those, larger than need be on a side */
    double sah;       /* as tree_sah; NaN if bounds are not finite */
    double sah_tight; /* with the exact boxes; NaN if not known */
    double overlap;   /* as tree_overlap; NaN: no scene, or it would take too long */
};

/* Checks a dump, walking each child once, whatever it says. `scene` NULL: only what a tree alone
 * tells. Faults beyond the first `most` of a rule are counted. `overlap` false: is not measured.
 * Errors: STATUS_INPUT the dump is of another number of triangles; STATUS_MEMORY. On error *out is
 * zero. The caller frees out->fault. */
enum status dump_check(const struct tree_dump *dump, const struct scene *scene, size_t most,
                       bool overlap, struct dump_report *out, struct reason *reason) MUST_USE;

/* Floats from one to the other; neither is a NaN. */
uint32_t dump_steps(float from, float to);

/* The float so many further up, or down if `by` is negative; at most infinite. A NaN stays. */
float dump_step(float x, int32_t by);

/* Writes a fault as a line without its end: "node 7: ...". Returns `text`. */
#define DUMP_FAULT_TEXT 320
const char *dump_fault_text(const struct dump_fault *fault, char text[DUMP_FAULT_TEXT]);

#endif
