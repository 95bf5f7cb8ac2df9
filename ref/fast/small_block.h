/* Leaf blocks of small trees (ref/fast/small_tree.h): up to 24 triangles over up to 16 vertices,
 * bit for bit. A block is whole words; its fields stand one after the other, lowest bits first.
 *
 *   word 0          bits 0, 8, 16 on: widths of the differences in x, y, z, 6 bits each; 22 on:
 *                   vertices less one, 4 bits; 26 on: triangles less one, 5 bits; bits 6, 7, 14,
 *                   15 and 31: width of the numbers' differences, where 31 stands for 32
 *   words 1 - 3     the least x, y, z as an ordered integer
 *   word 4          the least number of a triangle
 *   12 bits each    the triangles' corners: 4 bits for each of the three vertices
 *   a row each      x of the vertices, then y, then z: differences from the least
 *   a row           the triangles' numbers: differences from the least
 *
 * Floats are stored as integers in the same order, -0 below +0: see small_order. */
#ifndef SMALL_BLOCK_H
#define SMALL_BLOCK_H

#include "ref/fast/block_bits.h"
#include "ref/scene/scene.h"

#define SMALL_TRIS     24u
#define SMALL_VERTICES 16u
#define SMALL_HEAD     5u   /* words before the corners */
#define SMALL_CORNERS  12u  /* bits of a triangle's corners */
#define SMALL_ROW_MOST 481u /* bits of a row: wherever it begins in a word, 16 words hold it */
#define SMALL_WORDS                                                                                \
    (SMALL_HEAD + (SMALL_TRIS * SMALL_CORNERS + 3 * SMALL_ROW_MOST + 31) / 32 + SMALL_TRIS)

/* A kernel may read so many words beyond the last block. */
#define SMALL_BEYOND 16u

struct small_block {
    int32_t vertex[3][SMALL_VERTICES]; /* axis; ordered integers */
    uint32_t corner[SMALL_TRIS];       /* as it is stored */
    uint32_t prim[SMALL_TRIS];
    uint32_t vertex_count, tri_count;
    int32_t least[3];
    uint32_t least_prim;
    uint32_t width[3], prim_width;
};

/* Gathers `count` triangles and their distinct vertices. Vertices are equal if their bits are.
 * Returns false if there are more than SMALL_TRIS triangles, more than SMALL_VERTICES vertices, or
 * more than SMALL_ROW_MOST bits in a row. A single triangle always fits. */
bool small_block_make(const struct scene *scene, const uint32_t *prim, uint32_t count,
                      struct small_block *out);

/* Number of words that small_block_write writes. */
uint32_t small_block_words(const struct small_block *block);

/* Writes into words that are zero. */
void small_block_write(const struct small_block *block, uint32_t *out);

/* --- reading ---------------------------------------------------------------------------------- */

/* The order of floats as that of integers, and back: the function is its own inverse. */
static inline uint32_t small_order(uint32_t bits)
{
    return bits ^ (bits >> 31 ? 0x7FFFFFFFu : 0);
}

static inline uint32_t small_tris(uint32_t head)
{
    return (head >> 26 & 31u) + 1;
}

static inline uint32_t small_vertices(uint32_t head)
{
    return (head >> 22 & 15u) + 1;
}

static inline uint32_t small_width(uint32_t head, uint32_t k)
{
    return head >> 8 * k & 63u;
}

static inline uint32_t small_prim_width(uint32_t head)
{
    uint32_t code = (head >> 6 & 3u) | (head >> 12 & 12u) | (head >> 27 & 16u);
    return code + (code == 31);
}

/* The widths of the axes before axis k, summed; of all three for k = 3. */
static inline uint32_t small_before(uint32_t head, uint32_t k)
{
    return (uint32_t)((uint64_t)(head & 0x3F3F3Fu) * 0x01010100u >> 8 * k) & 0xFFu;
}

/* The first bit of the row of axis k, or for k = 3 of the numbers. */
static inline uint32_t small_row(uint32_t head, uint32_t k)
{
    return 32 * SMALL_HEAD + SMALL_CORNERS * small_tris(head) +
           small_vertices(head) * small_before(head, k);
}

/* Coordinate k of vertex i, as bits of a float. */
static inline uint32_t small_vertex(const uint32_t *block, uint32_t k, uint32_t i)
{
    uint32_t head = block[0], width = small_width(head, k);
    uint32_t more = block_bits(block, small_row(head, k) + width * i, width);
    return small_order(block[1 + k] + more);
}

/* The three corners of triangle i, 4 bits each. */
static inline uint32_t small_corner(const uint32_t *block, uint32_t i)
{
    return block_bits(block + SMALL_HEAD, SMALL_CORNERS * i, SMALL_CORNERS);
}

static inline uint32_t small_prim(const uint32_t *block, uint32_t i)
{
    uint32_t width = small_prim_width(block[0]);
    return block[4] + block_bits(block, small_row(block[0], 3) + width * i, width);
}

/* Triangle i as it is in the scene. */
static inline void small_tri(const uint32_t *block, uint32_t i, float v[3][3])
{
    uint32_t corner = small_corner(block, i);
    for (uint32_t c = 0; c < 3; c++)
        for (uint32_t k = 0; k < 3; k++)
            v[c][k] = float_from_bits(small_vertex(block, k, corner >> 4 * c & 15u));
}

#endif
