/* Common part of the top-down builders: the loop over nodes, and the pre-order form of the
 * result. */
#ifndef TOP_DOWN_H
#define TOP_DOWN_H

#include "ref/tree/bvh.h"

/* Scratch data of one build. */
struct build {
    const struct scene *scene;
    const struct build_options *options;
    uint32_t count;      /* of items: triangles, or parts of them (ref/build/presplit.h) */
    struct box *tri_box; /* of each item */
    float *centroid;     /* 3 per item; the builder defines a triangle's, a part has its box's
                            centre */
    uint32_t *prim;      /* the items; those of a node are one range */
    uint32_t *spare;     /* as long as prim, scratch for split */
};

/* A node to be split: items prim[first .. first + count - 1]. */
struct build_node {
    struct box bounds;
    uint32_t first, count;
    uint32_t depth; /* root: 0 */
};

/* The decisions of a builder. */
struct build_rule {
    void (*centroid)(float v[3][3], float out[3]);
    /* Orders the node's range so that the first child's items come first, and sets *left to
     * their number; 0 makes the node a leaf. node->bounds are tight at first; their value on return
     * becomes the node's box. */
    enum status (*split)(struct build *build, struct build_node *node, uint32_t *left,
                         struct reason *reason);
};

/* Builds the tree of a checked scene. Children get the exact bounds of their items before they are
 * split. Errors: STATUS_INPUT leaf is 0; STATUS_LIMIT more than 2^31 items; STATUS_MEMORY;
 * errors of split. On error *out is zero. */
enum status build_top_down(const struct build_rule *rule, const struct scene *scene,
                           const struct build_options *options, struct bvh *out,
                           struct reason *reason) MUST_USE;

#endif
