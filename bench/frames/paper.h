/* The paper's Figure 8: bytes of a scene and of its trees, and what the paper omits. */
#ifndef PAPER_H
#define PAPER_H

#include "ref/tree/bvh.h"

/* Leaf sizes of the paper's two handlers, which it does not state: they give its bytes (F35). */
#define PAPER_LEAF_DIRECT 2u
#define PAPER_LEAF_RF     4u
#define PAPER_EPS         0.02f

/* Bytes of a tree's node. The last has its items in the nodes, the others in an array. */
#define PAPER_DIRECT_BYTES 48u /* as published, padded twice */
#define PAPER_PLAIN_BYTES  32u /* the same content without padding */
#define PAPER_RF_BYTES     16u /* of a record: an inner node is one, a leaf two */

/* A published line. */
struct paper_figure {
    const char *scene;
    uint32_t tri_count, vertex_count;
    uint64_t geometry, direct, rf; /* bytes */
    double direct_ms, rf_ms;       /* the performance table's averages */
};

enum { PAPER_DEFAULT, PAPER_TEAPOT, PAPER_FIGURES };
extern const struct paper_figure paper_figures[PAPER_FIGURES];

/* A tree by RTRS's builder, and its bytes by three layouts. */
struct paper_tree {
    uint32_t leaf; /* aimed at */
    struct bvh_stats stats;
    uint64_t direct, plain, rf; /* bytes of nodes; 0: the layout cannot hold the tree */
    uint64_t items;             /* bytes of the item array that `plain` needs */
};

/* Triangles as the paper counts them: 16 bytes each and 40, vertices left out. */
uint64_t paper_geometry(uint32_t tri_count);

/* All that a device is given: 16 bytes of each triangle and of a null triangle, 32 of a vertex. */
uint64_t paper_uploaded(uint32_t tri_count, uint32_t vertex_count);

/* Builds and packs. Errors: as the builder; STATUS_MEMORY. */
enum status paper_tree(const struct scene *scene, uint32_t leaf, struct paper_tree *out,
                       struct reason *reason) MUST_USE;

/* True if the three numbers are the published ones. */
bool paper_agrees(const struct paper_figure *figure, uint64_t geometry,
                  const struct paper_tree *direct, const struct paper_tree *rf);

#endif
