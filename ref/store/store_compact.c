/* Storage `compact`: a leaf is a block of up to 8 triangles with up to 16 shared vertices, each
 * stored once, to the bit (ref/fast/block.h). The number of vertices is not stored: the largest
 * corner is the last vertex. */
#include "ref/fast/block.h"
#include "ref/layout.h"
#include "ref/store.h"

static enum status measure(const struct packed *packed, const struct scene *scene,
                           const uint32_t *prim, uint32_t count, uint64_t *words,
                           struct reason *reason)
{
    struct block block;
    if (count > BLOCK_TRIS)
        return fail(reason, STATUS_LIMIT,
                    "storage %s: a leaf holds at most %u triangles, this tree has one of %u; use "
                    "--leaf %u or less",
                    packed->store->name, BLOCK_TRIS, count, BLOCK_TRIS);
    if (!block_make(scene, prim, count, &block))
        return fail(reason, STATUS_LIMIT,
                    "storage %s: a leaf's triangles have at most %u vertices, those of triangle %u "
                    "and the %u beside it have more; use --leaf %u or less",
                    packed->store->name, BLOCK_VERTICES, prim[0], count - 1, BLOCK_VERTICES / 3);
    *words = block_words(&block);
    return STATUS_OK;
}

static void write(const struct packed *packed, const struct scene *scene, const uint32_t *prim,
                  uint32_t count, uint32_t *word)
{
    (void)packed;
    struct block block;
    if (!block_make(scene, prim, count, &block))
        return; /* measure() refused it */
    block_write(&block, word);
}

/* Returns the number of vertices of the block if its item `slot` is within the words; else 0. */
static uint32_t vertices_of(const struct packed *packed, uint32_t first, uint32_t slot)
{
    uint32_t most = 0;
    if (slot >= BLOCK_TRIS || first >= packed->item_count ||
        packed->item_count - first < BLOCK_CORNERS)
        return 0;
    for (uint32_t c = 0; c < BLOCK_CORNERS; c++)
        for (uint32_t left = packed->item[first + c]; left; left >>= 4)
            most = (left & 15u) > most ? left & 15u : most;
    uint32_t need = BLOCK_CORNERS + 3 * (most + 1) + slot + 1;
    return need <= packed->item_count - first ? most + 1 : 0;
}

static uint32_t item(const struct packed *packed, uint32_t first, uint32_t slot)
{
    uint32_t vertices = vertices_of(packed, first, slot);
    return vertices ? block_prim(packed->item + first, vertices, slot) : ABI_NO_PRIM;
}

static bool tri(const struct packed *packed, uint32_t first, uint32_t slot, float v[3][3])
{
    uint32_t vertices = vertices_of(packed, first, slot);
    for (int c = 0; c < 3 && vertices; c++)
        block_corner(packed->item + first, vertices, slot, c, v[c]);
    return vertices > 0;
}

extern const struct tri_store tri_store_compact;
const struct tri_store tri_store_compact = {
    .name = "compact",
    .summary = "leaves of up to 8 triangles that share up to 16 vertices, lossless",
    .id = ABI_STORE_COMPACT,
    .measure = measure,
    .write = write,
    .item = item,
    .tri = tri,
};
