/* The oracle's own tree: two children per node, boxes that are the exact bounds of float32
 * vertices, tested in double. It shares nothing with the builders, layouts and box tests that
 * are judged. For the oracle's own files.
 *
 * Why it loses nothing. With e = 2^-53 and 1/d, b - o and their product each rounded once, a
 * plane's computed distance t^ is t (1 + h), |h| <= 3.01 e < 2^-51; over- and underflow are out of
 * reach of float32 inputs. Let the ray be inside the box at t*, exactly. Every entry distance t <=
 * t*, so t^ <= t* + 2^-51 |t*|: if t^ > t*, then t^ - t <= 2^-51 |t| gives it directly for t of
 * t*'s sign, and t, t* of different signs put t^ on t's side of 0. Then t^ - TREE_PAD |t^| <= t*
 * with TREE_PAD = 2^-49, which is monotone in t^ and may so be applied to the largest entry alone;
 * exits mirror this. An axis with d = 0 is compared, not divided. So the padded interval contains
 * t*, and a node is turned away only if no point of it is on the ray at a t in [tmin, reach]. */
#ifndef ORACLE_TREE_H
#define ORACLE_TREE_H

#include "ref/scene/scene.h"

#define TREE_PAD 0x1p-49

#define TREE_LEAF  4u  /* triangles of a leaf, at most, unless the tree gets too deep */
#define TREE_DEPTH 96u /* levels, at most */

/* Two children side by side. count 0: child[i] is a node; else a leaf, the triangles child[i] ..
 * child[i] + count[i] - 1 of the order. */
struct tree_node {
    float lo[3][2];
    float hi[3][2];
    uint32_t child[2];
    uint32_t count[2];
};

/* node[0] is the root; its second child may be an empty leaf (lo > hi, count 0, child 0). */
struct tree {
    struct tree_node *node;
    uint32_t node_count;
    uint32_t *order; /* triangles, those of a leaf in a row */
};

/* What a tree is built over. */
struct oracle_part {
    struct box box; /* its bounds may be infinite */
    float
        middle[3]; /* finite, about the middle of the box: it only decides which side it goes to */
    uint32_t prim; /* what `order` names it by */
};

/* Builds a tree over `count` boxes, with at most `leaf` of them in a leaf: surface area heuristic
 * in bins. Reorders the parts. Errors: STATUS_MEMORY. */
enum status tree_make_parts(struct oracle_part *part, uint32_t count, uint32_t leaf,
                            struct tree *out, struct reason *reason) MUST_USE;

/* Builds the tree over the triangles of a scene. Errors: STATUS_MEMORY. */
enum status tree_make(const struct scene *scene, struct tree *out, struct reason *reason) MUST_USE;
void tree_free(struct tree *tree);

#endif
