/* The paper's Figure 8: bytes of a scene and of its trees, including what the paper omits. */
#ifndef PAPER_H
#define PAPER_H

#include "ref/tree/bvh.h"

/* Leaf sizes of the paper's two handlers. The paper does not state them; these give its bytes
 * (F35). */
#define PAPER_LEAF_DIRECT 2u
#define PAPER_LEAF_RF     4u
#define PAPER_EPS         0.02f

/* Bytes of a tree's node. The RF layout has its items in the nodes, the others in an array. */
#define PAPER_DIRECT_BYTES 48u /* as published, padded twice */
#define PAPER_PLAIN_BYTES  32u /* the same content without padding */
#define PAPER_RF_BYTES     16u /* per record: an inner node is one, a leaf two */

/* A published row. */
struct paper_figure {
    const char *scene;
    uint32_t tri_count, vertex_count;
    uint64_t geometry, direct, rf; /* bytes */
    double direct_ms, rf_ms;       /* averages from the performance table */
};

enum { PAPER_DEFAULT, PAPER_TEAPOT, PAPER_FIGURES };
extern const struct paper_figure paper_figures[PAPER_FIGURES];

/* A tree made by RTRS's builder, and its bytes in three layouts. */
struct paper_tree {
    uint32_t leaf; /* target leaf size */
    struct bvh_stats stats;
    uint64_t direct, plain, rf; /* bytes of nodes; 0: the layout cannot hold the tree */
    uint64_t items;             /* bytes of the item array that `plain` needs */
};

/* Bytes of the triangles as the paper counts them: 16 each plus 40, without vertices. */
uint64_t paper_geometry(uint32_t tri_count);

/* Bytes sent to a device: 16 per triangle and for a null triangle, 32 per vertex. */
uint64_t paper_uploaded(uint32_t tri_count, uint32_t vertex_count);

/* Builds the tree and packs it. Errors: those of the builder; STATUS_MEMORY. */
enum status paper_tree(const struct scene *scene, uint32_t leaf, struct paper_tree *out,
                       struct reason *reason) MUST_USE;

/* True if the three numbers equal the published ones. */
bool paper_agrees(const struct paper_figure *figure, uint64_t geometry,
                  const struct paper_tree *direct, const struct paper_tree *rf);

#endif
