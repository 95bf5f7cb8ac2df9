/* Leaf blocks of tiny trees (ref/fast/small_tree.h): up to 48 triangles over up to 32 vertices,
 * which lie on the grid of the scene. Nothing is lost that is on the grid; what a scene loses on
 * its way there is told by scene_quantise (ref/scene/quantise.h). A block is whole words; its
 * fields stand one after the other, lowest bits first.
 *
 *   5, 6, 5 bits    vertices less one, triangles less one, the parameter of the gaps
 *   5 bits each     widths of the differences in x, y, z; a bit that is 0
 *   15 bits each    the triangles' corners: 5 bits for each of the three vertices
 *   code each       the least x, y, z; struct tiny_form tells how wide a code is
 *   number          of the first triangle; likewise
 *   a row each      x of the vertices, then y, then z: differences from the least
 *   gaps            from each triangle's number to the next one, less one: Rice codes, a quotient
 *                   of so many ones and a zero, then the remainder. Numbers ascend.
 *
 * Rice codes: Rice 1979, "Some Practical Universal Noiseless Coding Techniques", section 3. */
#ifndef TINY_BLOCK_H
#define TINY_BLOCK_H

#include "ref/fast/block_bits.h"
#include "ref/fast/tiny_form.h"

#define TINY_TRIS     48u
#define TINY_VERTICES 32u
#define TINY_CORNERS  15u /* bits of a triangle's corners */
#define TINY_HEAD     32u /* bits before the corners */

/* More words than any block has: a gap with the largest parameter has 33 bits. */
#define TINY_WORDS                                                                                 \
    ((TINY_HEAD + TINY_TRIS * TINY_CORNERS + 4 * 32 + 3 * TINY_VERTICES * QUANTISE_BITS_MOST +     \
      TINY_TRIS * 33 + 31) /                                                                       \
     32)

/* A kernel may read so many words beyond the last block: rows of 32, wherever a row begins. */
#define TINY_BEYOND 32u

struct tiny_block {
    uint32_t vertex[3][TINY_VERTICES]; /* axis; codes on the grid */
    uint32_t corner[TINY_TRIS];        /* as it is stored */
    uint32_t prim[TINY_TRIS];          /* ascending */
    uint32_t vertex_count, tri_count;
    uint32_t least[3], width[3];
    uint32_t gap; /* the parameter */
};

/* Sets the form of a scene's blocks. Errors: as grid_of_scene. */
enum status tiny_form_make(const struct scene *scene, struct tiny_form *out,
                           struct reason *reason) MUST_USE;

/* Gathers `count` triangles of a scene on the form's grid, and their distinct vertices. Returns
 * false if there are more than TINY_TRIS triangles or TINY_VERTICES vertices. A single triangle
 * always fits. */
bool tiny_block_make(const struct tiny_form *form, const struct scene *scene, const uint32_t *prim,
                     uint32_t count, struct tiny_block *out);

/* Number of words that tiny_block_write writes. */
uint32_t tiny_block_words(const struct tiny_form *form, const struct tiny_block *block);

/* Writes into words that are zero. */
void tiny_block_write(const struct tiny_form *form, const struct tiny_block *block, uint32_t *out);

/* --- reading ---------------------------------------------------------------------------------- */

static inline uint32_t tiny_vertices(uint32_t head)
{
    return (head & 31u) + 1;
}

static inline uint32_t tiny_tris(uint32_t head)
{
    return (head >> 5 & 63u) + 1;
}

static inline uint32_t tiny_gap(uint32_t head)
{
    return head >> 11 & 31u;
}

static inline uint32_t tiny_width(uint32_t head, uint32_t k)
{
    return head >> (16 + 5 * k) & 31u;
}

/* The widths of the axes before axis k, summed; of all three for k = 3. */
static inline uint32_t tiny_before(uint32_t head, uint32_t k)
{
    uint32_t sum = 0;
    for (uint32_t i = 0; i < k; i++)
        sum += tiny_width(head, i);
    return sum;
}

/* The first bit of the least codes. */
static inline uint32_t tiny_least_at(uint32_t head)
{
    return TINY_HEAD + TINY_CORNERS * tiny_tris(head);
}

/* The first bit of the row of axis k, or for k = 3 of the gaps. */
static inline uint32_t tiny_row(const struct tiny_form *form, uint32_t head, uint32_t k)
{
    return tiny_least_at(head) + 3 * form->grid.bits + form->prim_bits +
           tiny_vertices(head) * tiny_before(head, k);
}

/* The least coordinate of axis k, in steps of the grid from 0 on. */
static inline int32_t tiny_least(const struct tiny_form *form, const uint32_t *block, uint32_t k)
{
    const uint32_t at = tiny_least_at(block[0]) + form->grid.bits * k;
    return form->grid.lo[k] + (int32_t)block_bits(block, at, form->grid.bits);
}

/* The three corners of triangle i, 5 bits each. */
static inline uint32_t tiny_corner(const uint32_t *block, uint32_t i)
{
    return block_bits(block, TINY_HEAD + TINY_CORNERS * i, TINY_CORNERS);
}

/* The number of triangle i. Reads all gaps before it.
 *   end   the first bit behind them; may be NULL */
uint32_t tiny_prim(const struct tiny_form *form, const uint32_t *block, uint32_t i, uint32_t *end);

/* Triangle i as it is in the scene. */
void tiny_tri(const struct tiny_form *form, const uint32_t *block, uint32_t i, float v[3][3]);

#endif
