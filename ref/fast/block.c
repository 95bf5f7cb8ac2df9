#include "ref/fast/block.h"

#include <string.h>

/* Returns the index of vertex `v` in the block. A new vertex is added. Returns BLOCK_VERTICES if
 * the block is full. */
static uint32_t vertex_place(struct block *block, const float v[3])
{
    for (uint32_t i = 0; i < block->vertex_count; i++)
        if (memcmp(block->vertex[i], v, sizeof block->vertex[i]) == 0)
            return i;
    if (block->vertex_count == BLOCK_VERTICES)
        return BLOCK_VERTICES;
    memcpy(block->vertex[block->vertex_count], v, sizeof block->vertex[0]);
    return block->vertex_count++;
}

bool block_make(const struct scene *scene, const uint32_t *prim, uint32_t count, struct block *out)
{
    *out = (struct block){.tri_count = count};
    if (count > BLOCK_TRIS)
        return false;
    for (uint32_t i = 0; i < count; i++) {
        float v[3][3];
        scene_tri(scene, prim[i], v);
        out->prim[i] = prim[i];
        for (int c = 0; c < 3; c++) {
            uint32_t place = vertex_place(out, v[c]);
            if (place == BLOCK_VERTICES)
                return false;
            out->corner[c] |= place << 4 * i;
        }
    }
    return true;
}

void block_write(const struct block *block, uint32_t *out)
{
    memcpy(out, block->corner, sizeof block->corner);
    out += BLOCK_CORNERS;
    for (int k = 0; k < 3; k++)
        for (uint32_t i = 0; i < block->vertex_count; i++)
            *out++ = float_bits(block->vertex[i][k]);
    memcpy(out, block->prim, block->tri_count * sizeof *out);
}

void block_corner(const uint32_t *word, uint32_t vertex_count, uint32_t i, int c, float out[3])
{
    uint32_t at = word[c] >> 4 * i & 15u;
    for (uint32_t k = 0; k < 3; k++)
        out[k] = float_from_bits(word[BLOCK_CORNERS + k * vertex_count + at]);
}
