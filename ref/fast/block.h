/* Leaf blocks: up to 8 triangles over up to 16 vertices. Each vertex is stored once, bit for bit.
 *
 *   words 0 - 2      corner 0, 1, 2 of the triangles: triangle i's vertex in bits 4 i .. 4 i + 3
 *   then n words     x of the n vertices, then y of them, then z of them
 *   then m words     the triangles' numbers
 *
 * All corners of an absent triangle are vertex 0: its determinant is 0, so it is never hit. */
#ifndef BLOCK_H
#define BLOCK_H

#include "ref/scene/scene.h"

#define BLOCK_TRIS     8u
#define BLOCK_VERTICES 16u
#define BLOCK_CORNERS  3u /* words before the vertices */

struct block {
    float vertex[BLOCK_VERTICES][3];
    uint32_t corner[3];
    uint32_t prim[BLOCK_TRIS];
    uint32_t vertex_count;
    uint32_t tri_count;
};

/* Gathers `count` triangles and their distinct vertices. Vertices are equal if their bits are.
 * Returns false if there are more than BLOCK_TRIS triangles or BLOCK_VERTICES vertices. A single
 * triangle always fits. */
bool block_make(const struct scene *scene, const uint32_t *prim, uint32_t count, struct block *out);

/* Number of words that block_write writes. */
static inline uint32_t block_words(const struct block *block)
{
    return BLOCK_CORNERS + 3 * block->vertex_count + block->tri_count;
}

void block_write(const struct block *block, uint32_t *out);

/* Reads corner `c` of triangle `i` of a written block of `vertex_count` vertices; block_prim
 * returns the triangle's number. */
void block_corner(const uint32_t *word, uint32_t vertex_count, uint32_t i, int c, float out[3]);

static inline uint32_t block_prim(const uint32_t *word, uint32_t vertex_count, uint32_t i)
{
    return word[BLOCK_CORNERS + 3 * vertex_count + i];
}

#endif
