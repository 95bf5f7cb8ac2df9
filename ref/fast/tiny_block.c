#include "ref/fast/tiny_block.h"

#include <stdlib.h>
#include <string.h>

enum status tiny_form_make(const struct scene *scene, struct tiny_form *out, struct reason *reason)
{
    out->prim_bits = scene->tri_count ? width_for(scene->tri_count - 1) : 0;
    return grid_of_scene(scene, &out->grid, reason);
}

/* --- making ----------------------------------------------------------------------------------- */

/* Returns the index of a vertex in the block. A new vertex is added. Returns TINY_VERTICES if the
 * block is full. */
static uint32_t vertex_place(struct tiny_block *block, const uint32_t code[3])
{
    uint32_t i = 0;
    for (; i < block->vertex_count; i++)
        if (block->vertex[0][i] == code[0] && block->vertex[1][i] == code[1] &&
            block->vertex[2][i] == code[2])
            return i;
    if (i == TINY_VERTICES)
        return i;
    for (int k = 0; k < 3; k++)
        block->vertex[k][i] = code[k];
    return block->vertex_count++;
}

static int ascending(const void *a, const void *b)
{
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* Adds a triangle's corners; false: its vertices do not fit. */
static bool add_corners(struct tiny_block *block, const struct tiny_form *form, float v[3][3],
                        uint32_t *corner)
{
    *corner = 0;
    for (int c = 0; c < 3; c++) {
        uint32_t code[3];
        for (int k = 0; k < 3; k++)
            code[k] = grid_code(&form->grid, k, v[c][k]);
        const uint32_t place = vertex_place(block, code);
        if (place == TINY_VERTICES)
            return false;
        *corner |= place << 5 * c;
    }
    return true;
}

/* Bits of all gaps with a parameter. */
static uint64_t gaps_bits(const struct tiny_block *block, uint32_t gap)
{
    uint64_t bits = 0;
    for (uint32_t i = 1; i < block->tri_count; i++)
        bits += ((block->prim[i] - block->prim[i - 1] - 1) >> gap) + 1 + gap;
    return bits;
}

static void measure(struct tiny_block *block)
{
    for (int k = 0; k < 3; k++) {
        uint32_t least = UINT32_MAX, most = 0;
        for (uint32_t i = 0; i < block->vertex_count; i++) {
            const uint32_t code = block->vertex[k][i];
            least = code < least ? code : least;
            most = code > most ? code : most;
        }
        block->least[k] = least;
        block->width[k] = width_for(most - least);
    }
    block->gap = 0;
    for (uint32_t gap = 1; gap < 32; gap++)
        if (gaps_bits(block, gap) < gaps_bits(block, block->gap))
            block->gap = gap;
}

bool tiny_block_make(const struct tiny_form *form, const struct scene *scene, const uint32_t *prim,
                     uint32_t count, struct tiny_block *out)
{
    out->vertex_count = 0;
    out->tri_count = count;
    if (count > TINY_TRIS)
        return false;
    memcpy(out->prim, prim, count * sizeof *prim);
    qsort(out->prim, count, sizeof *out->prim, ascending);
    for (uint32_t i = 0; i < count; i++) {
        float v[3][3];
        scene_tri(scene, out->prim[i], v);
        if (!add_corners(out, form, v, &out->corner[i]))
            return false;
    }
    measure(out);
    return true;
}

/* --- writing ---------------------------------------------------------------------------------- */

uint32_t tiny_block_words(const struct tiny_form *form, const struct tiny_block *block)
{
    const uint64_t bits =
        TINY_HEAD + TINY_CORNERS * block->tri_count + 3 * form->grid.bits + form->prim_bits +
        block->vertex_count * (block->width[0] + block->width[1] + block->width[2]) +
        gaps_bits(block, block->gap);
    return (uint32_t)((bits + 31) / 32);
}

static void put_gap(uint32_t *word, uint32_t *first, uint32_t gap, uint32_t parameter)
{
    for (uint32_t ones = gap >> parameter; ones > 0; ones--)
        block_add_bits(word, first, 1, 1);
    block_add_bits(word, first, 0, 1);
    block_add_bits(word, first, gap & ((1u << parameter) - 1), parameter);
}

void tiny_block_write(const struct tiny_form *form, const struct tiny_block *block, uint32_t *out)
{
    uint32_t at = TINY_HEAD;
    out[0] = (block->vertex_count - 1) | (block->tri_count - 1) << 5 | block->gap << 11 |
             block->width[0] << 16 | block->width[1] << 21 | block->width[2] << 26;
    for (uint32_t i = 0; i < block->tri_count; i++)
        block_add_bits(out, &at, block->corner[i], TINY_CORNERS);
    for (int k = 0; k < 3; k++)
        block_add_bits(out, &at, block->least[k], form->grid.bits);
    block_add_bits(out, &at, block->prim[0], form->prim_bits);
    for (int k = 0; k < 3; k++)
        for (uint32_t i = 0; i < block->vertex_count; i++)
            block_add_bits(out, &at, block->vertex[k][i] - block->least[k], block->width[k]);
    for (uint32_t i = 1; i < block->tri_count; i++)
        put_gap(out, &at, block->prim[i] - block->prim[i - 1] - 1, block->gap);
}

/* --- reading ---------------------------------------------------------------------------------- */

/* Ones from a bit on, up to a zero, which there is. */
static uint32_t ones_at(const uint32_t *word, uint32_t first)
{
    uint32_t count = 0;
    for (;; count += 32) {
        const uint32_t bits = ~block_bits(word, first + count, 32);
        if (bits)
            return count + (uint32_t)__builtin_ctz(bits);
    }
}

uint32_t tiny_prim(const struct tiny_form *form, const uint32_t *block, uint32_t i, uint32_t *end)
{
    const uint32_t head = block[0], gap = tiny_gap(head);
    uint32_t at = tiny_row(form, head, 3);
    uint32_t prim = block_bits(block, tiny_least_at(head) + 3 * form->grid.bits, form->prim_bits);
    for (; i > 0; i--) {
        const uint32_t ones = ones_at(block, at);
        at += ones + 1;
        prim += (ones << gap) + block_bits(block, at, gap) + 1;
        at += gap;
    }
    if (end)
        *end = at;
    return prim;
}

void tiny_tri(const struct tiny_form *form, const uint32_t *block, uint32_t i, float v[3][3])
{
    const uint32_t head = block[0], corner = tiny_corner(block, i);
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t row = tiny_row(form, head, k), width = tiny_width(head, k);
        for (uint32_t c = 0; c < 3; c++) {
            const uint32_t place = corner >> 5 * c & 31u;
            const uint32_t more = block_bits(block, row + width * place, width);
            v[c][k] = (float)(tiny_least(form, block, k) + (int32_t)more) * form->grid.step[k];
        }
    }
}
