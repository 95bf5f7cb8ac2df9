/* Storage `truncated`: the blocks of `compact` (ref/fast/block.h) without the low bits that are 0
 * in all coordinates of a leaf, as in clusters whose positions are truncated
 * (positionTruncateBitCount of VK_NV_cluster_acceleration_structure). The storage is lossless; only
 * scene_truncate (ref/scene/quantise.h) loses precision.
 *
 *   a leaf, from the lowest bit of its first word
 *     3, 4           triangles - 1, vertices - 1
 *     5              dropped: low bits that are not stored, 0 to 31
 *     5              bits of a triangle's number - 1
 *     12 a triangle  its corners, 4 bits each
 *     number each    the triangles' numbers
 *     32 - dropped   three times a vertex: the upper bits of x, y, z */
#include "ref/fast/block.h"
#include "ref/layout.h"
#include "ref/store/bits.h"
#include "ref/store.h"

#include <string.h>

#define CORNERS_AT   17u
#define CORNERS      12u /* bits of a triangle's corners */
#define DROPPED_MOST 31u

/* Bit positions in a leaf. */
struct upper_bits {
    uint32_t tris, vertices;
    uint32_t dropped, number, coordinate; /* the last two are widths */
    uint32_t number_at, vertex_at, end;
};

static void kept_find(struct upper_bits *k)
{
    k->coordinate = 32 - k->dropped;
    k->number_at = CORNERS_AT + CORNERS * k->tris;
    k->vertex_at = k->number_at + k->number * k->tris;
    k->end = k->vertex_at + 3 * k->coordinate * k->vertices;
}

static struct upper_bits kept_of(const struct block *block)
{
    struct upper_bits k = {.tris = block->tri_count, .vertices = block->vertex_count};
    uint32_t used = (uint32_t)1 << DROPPED_MOST, numbers = 1;
    for (uint32_t i = 0; i < block->vertex_count; i++)
        for (int axis = 0; axis < 3; axis++)
            used |= float_bits(block->vertex[i][axis]);
    for (uint32_t i = 0; i < block->tri_count; i++)
        numbers |= block->prim[i];
    while (!(used >> k.dropped & 1))
        k.dropped++;
    while (k.number < 32 && numbers >> k.number)
        k.number++;
    kept_find(&k);
    return k;
}

static enum status measure(const struct packed *packed, const struct scene *scene,
                           const uint32_t *prim, uint32_t count, uint64_t *words,
                           struct reason *reason)
{
    struct block block;
    if (!block_make(scene, prim, count, &block))
        return fail(reason, STATUS_LIMIT,
                    "storage %s: a leaf holds at most %u triangles and %u vertices, that of "
                    "triangle %u and the %u beside it has more; use --leaf %u or less",
                    packed->store->name, BLOCK_TRIS, BLOCK_VERTICES, prim[0], count - 1,
                    BLOCK_VERTICES / 3);
    *words = (kept_of(&block).end + 31) / 32;
    return STATUS_OK;
}

static void write(const struct packed *packed, const struct scene *scene, const uint32_t *prim,
                  uint32_t count, uint32_t *word)
{
    (void)packed;
    struct block block;
    if (!block_make(scene, prim, count, &block))
        return; /* measure() rejected it */
    const struct upper_bits k = kept_of(&block);
    memset(word, 0, (k.end + 31) / 32 * sizeof *word);
    bits_put(word, 0, 3, k.tris - 1);
    bits_put(word, 3, 4, k.vertices - 1);
    bits_put(word, 7, 5, k.dropped);
    bits_put(word, 12, 5, k.number - 1);
    for (uint32_t i = 0; i < k.tris; i++) {
        for (uint32_t c = 0; c < 3; c++)
            bits_put(word, CORNERS_AT + CORNERS * i + 4 * c, 4, block.corner[c] >> 4 * i & 15u);
        bits_put(word, k.number_at + k.number * i, k.number, block.prim[i]);
    }
    for (uint32_t i = 0; i < 3 * k.vertices; i++)
        bits_put(word, k.vertex_at + k.coordinate * i, k.coordinate,
                 float_bits(block.vertex[i / 3][i % 3]) >> k.dropped);
}

/* False if there is no such item, or part of its leaf is outside the words. */
static bool leaf_of(const struct packed *packed, uint32_t first, uint32_t slot,
                    struct upper_bits *k)
{
    if (first >= packed->item_count)
        return false;
    const uint32_t sizes = packed->item[first];
    *k = (struct upper_bits){.tris = (sizes & 7u) + 1,
                             .vertices = (sizes >> 3 & 15u) + 1,
                             .dropped = sizes >> 7 & 31u,
                             .number = (sizes >> 12 & 31u) + 1};
    kept_find(k);
    return slot < k->tris && (k->end + 31) / 32 <= packed->item_count - first;
}

static uint32_t item(const struct packed *packed, uint32_t first, uint32_t slot)
{
    struct upper_bits k;
    if (!leaf_of(packed, first, slot, &k))
        return ABI_NO_PRIM;
    return bits_get(packed->item + first, k.number_at + k.number * slot, k.number);
}

static bool tri(const struct packed *packed, uint32_t first, uint32_t slot, float v[3][3])
{
    struct upper_bits k;
    if (!leaf_of(packed, first, slot, &k))
        return false;
    const uint32_t *word = packed->item + first;
    for (uint32_t c = 0; c < 3; c++) {
        uint32_t vertex = bits_get(word, CORNERS_AT + CORNERS * slot + 4 * c, 4);
        uint32_t at = k.vertex_at + 3 * k.coordinate * (vertex < k.vertices ? vertex : 0);
        for (uint32_t axis = 0; axis < 3; axis++)
            v[c][axis] = float_from_bits(bits_get(word, at + k.coordinate * axis, k.coordinate)
                                         << k.dropped);
    }
    return true;
}

extern const struct tri_store tri_store_truncated;
const struct tri_store tri_store_truncated = {
    .name = "truncated",
    .summary = "leaves as in compact, without the low bits that are 0 in all coordinates of a leaf",
    .id = ABI_STORE_TRUNCATED,
    .lossy = &lossy_truncated,
    .measure = measure,
    .write = write,
    .item = item,
    .tri = tri,
};
