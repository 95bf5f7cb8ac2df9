/* Trees that are built in stages, each of which a device and C can compare: Morton codes, their
 * order, the links of the nodes, their boxes. No stage has a float operation: coordinates are
 * integers in a frame of the scene, areas are exact integers of 64 bits, and boxes are bits of
 * vertices. So every stage has one right result on any machine, whatever it rounds or flushes. */
#ifndef STAGED_H
#define STAGED_H

#include "ref/tree/bvh.h"

/* A link to a leaf: this, and the leaf's place in the order. */
#define STAGED_LEAF 0x80000000u

/* Most triangles: places and links are below 2^31. */
#define STAGED_MOST ((uint32_t)1 << 30)

enum staged_kind {
    STAGED_LBVH30, /* Karras 2012, codes of 10 bits an axis */
    STAGED_LBVH63, /* the same with 21 bits */
    STAGED_HPLOC,  /* H-PLOC (Benthin et al. 2024) along codes of 63 bits */
    STAGED_KINDS
};

/* A tree of `count` triangles, with count - 1 inner nodes, at most. Owns its arrays (see
 * staged_free); all are NULL if count is 0. */
struct staged {
    uint64_t *code;       /* per triangle of the scene */
    uint32_t *order;      /* the triangles by their codes; among equal codes by their numbers */
    uint32_t (*child)[2]; /* per inner node: links, the first has the earlier leaf */
    uint32_t (*box)[6];   /* bits of lo and hi, -0 as 0: of the inner nodes, then of the leaves in
                            order, count of them */
    uint32_t count;
    uint32_t root; /* a link */
};

/* Allocates the arrays for `count` triangles. Errors: STATUS_MEMORY; *out is then zero. */
enum status staged_alloc(uint32_t count, struct staged *out) MUST_USE;

void staged_free(struct staged *staged);

/* What of a build is timed. */
enum staged_part {
    STAGED_CODES, /* boxes of triangles, bounds of the scene, codes */
    STAGED_ORDER,
    STAGED_NODES, /* links and boxes */
    STAGED_PARTS
};

extern const char *const staged_part_names[STAGED_PARTS];

/* Builds all stages in C, by one thread. `scene` is checked. Writes the time of each part to ns,
 * which may be NULL. Errors: STATUS_LIMIT more than STAGED_MOST triangles; STATUS_MEMORY; *out is
 * then zero. */
enum status staged_build(enum staged_kind kind, const struct scene *scene, struct staged *out,
                         uint64_t ns[STAGED_PARTS], struct reason *reason) MUST_USE;

/* The first stage, and in it the first element, in which two trees of one scene differ. */
struct staged_difference {
    const char *stage; /* "codes", "order", "links" or "boxes"; NULL: none */
    uint32_t element;  /* a triangle, a place in the order or a node, as in struct staged */
    uint64_t count;    /* elements of that stage that differ */
    char text[160];    /* both values */
};

struct staged_difference staged_compare(const struct staged *mine, const struct staged *other);

/* Writes the canonical tree with leaves of up to `leaf` triangles (tree_collapse), with the boxes
 * of `staged`. A tree deeper than any builder may make it (GROW_DEPTH_MOST) is halved below the
 * depth where that begins. Safe on any content of links and order. Errors: STATUS_DEVICE the links
 * are not a tree of all triangles (the reason names the node and the rule); STATUS_MEMORY; *out is
 * then zero. */
enum status staged_write(const struct staged *staged, uint32_t leaf, struct bvh *out,
                         struct reason *reason) MUST_USE;

#endif
