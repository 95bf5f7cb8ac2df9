#include "ref/fast/small_block.h"

#include <string.h>

/* Returns the index of a vertex in the block. A new vertex is added. Returns SMALL_VERTICES if the
 * block is full. */
static uint32_t vertex_place(struct small_block *block, const float v[3])
{
    int32_t own[3];
    uint32_t i = 0;
    for (int k = 0; k < 3; k++)
        own[k] = (int32_t)small_order(float_bits(v[k]));
    for (; i < block->vertex_count; i++)
        if (block->vertex[0][i] == own[0] && block->vertex[1][i] == own[1] &&
            block->vertex[2][i] == own[2])
            return i;
    if (i == SMALL_VERTICES)
        return i;
    for (int k = 0; k < 3; k++)
        block->vertex[k][i] = own[k];
    return block->vertex_count++;
}

/* Sets the least of a row and returns the width of its differences. */
static uint32_t measure(const int32_t *row, uint32_t count, int32_t *least)
{
    int32_t lo = row[0], hi = row[0];
    for (uint32_t i = 1; i < count; i++) {
        lo = row[i] < lo ? row[i] : lo;
        hi = row[i] > hi ? row[i] : hi;
    }
    *least = lo;
    return width_for((uint32_t)hi - (uint32_t)lo);
}

static void measure_prims(struct small_block *block)
{
    uint32_t lo = block->prim[0], hi = block->prim[0];
    for (uint32_t i = 1; i < block->tri_count; i++) {
        lo = block->prim[i] < lo ? block->prim[i] : lo;
        hi = block->prim[i] > hi ? block->prim[i] : hi;
    }
    block->least_prim = lo;
    block->prim_width = width_for(hi - lo);
    block->prim_width += block->prim_width == 31;
}

bool small_block_make(const struct scene *scene, const uint32_t *prim, uint32_t count,
                      struct small_block *out)
{
    out->vertex_count = 0;
    out->tri_count = count;
    if (count > SMALL_TRIS)
        return false;
    for (uint32_t i = 0; i < count; i++) {
        float v[3][3];
        scene_tri(scene, prim[i], v);
        out->prim[i] = prim[i];
        out->corner[i] = 0;
        for (int c = 0; c < 3; c++) {
            uint32_t place = vertex_place(out, v[c]);
            if (place == SMALL_VERTICES)
                return false;
            out->corner[i] |= place << 4 * c;
        }
    }
    for (int k = 0; k < 3; k++) {
        out->width[k] = measure(out->vertex[k], out->vertex_count, &out->least[k]);
        if (out->width[k] * out->vertex_count > SMALL_ROW_MOST)
            return false;
    }
    measure_prims(out);
    return true;
}

static uint32_t bits_of_block(const struct small_block *block)
{
    return 32 * SMALL_HEAD + block->tri_count * (SMALL_CORNERS + block->prim_width) +
           block->vertex_count * (block->width[0] + block->width[1] + block->width[2]);
}

uint32_t small_block_words(const struct small_block *block)
{
    return (bits_of_block(block) + 31) / 32;
}

void small_block_write(const struct small_block *block, uint32_t *out)
{
    uint32_t code = block->prim_width < 31 ? block->prim_width : 31, at = 32 * SMALL_HEAD;
    out[0] = block->width[0] | block->width[1] << 8 | block->width[2] << 16 |
             (block->vertex_count - 1) << 22 | (block->tri_count - 1) << 26 | (code & 3u) << 6 |
             (code & 12u) << 12 | (code & 16u) << 27;
    for (uint32_t k = 0; k < 3; k++)
        out[1 + k] = (uint32_t)block->least[k];
    out[4] = block->least_prim;
    for (uint32_t i = 0; i < block->tri_count; i++)
        block_add_bits(out, &at, block->corner[i], SMALL_CORNERS);
    for (uint32_t k = 0; k < 3; k++)
        for (uint32_t i = 0; i < block->vertex_count; i++)
            block_add_bits(out, &at, (uint32_t)block->vertex[k][i] - (uint32_t)block->least[k],
                           block->width[k]);
    for (uint32_t i = 0; i < block->tri_count; i++)
        block_add_bits(out, &at, block->prim[i] - block->least_prim, block->prim_width);
}
