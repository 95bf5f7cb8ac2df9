/* Storage `quantised`: the blocks of `compact` (ref/fast/block.h) of a scene whose vertices lie on
 * a grid, packed in bits. The storage is lossless; only scene_quantise (ref/scene/quantise.h) loses
 * precision.
 *
 *   before the first leaf
 *     words 0 - 2    the grid's lo per axis
 *     word 3         exponents of its steps, as in a float: 8 bits an axis
 *     word 4         bits of a code (5), then of a triangle's number (5)
 *   a leaf, from the lowest bit of its first word
 *     3, 4           triangles - 1, vertices - 1
 *     5 an axis      width of a vertex code minus the least code
 *     code an axis   the least code of its vertices
 *     12 a triangle  its corners, 4 bits each
 *     number each    the triangles' numbers
 *     widths each    the vertices: x, y, z */
#include "ref/fast/block.h"
#include "ref/layout.h"
#include "ref/scene/quantise.h"
#include "ref/store/bits.h"
#include "ref/store.h"

#include <string.h>

#define HEAD     5u
#define SIZES    7u  /* bits of both counts, of triangles and vertices */
#define LEAST_AT 22u /* bits before the least codes */
#define CORNERS  12u /* bits of a triangle's corners */

static enum status head(const struct tri_store *self, const struct scene *scene, uint32_t *word,
                        struct reason *reason)
{
    struct grid grid;
    struct reason why = {""};
    if (scene->tri_count > INT32_MAX)
        return fail(reason, STATUS_LIMIT, "storage %s: %u triangles; %d are possible", self->name,
                    scene->tri_count, INT32_MAX);
    if (grid_of_scene(scene, &grid, &why))
        return fail(reason, STATUS_LIMIT, "storage %s: %.200s", self->name, why.text);
    memset(word, 0, HEAD * sizeof *word);
    for (int k = 0; k < 3; k++) {
        word[k] = (uint32_t)grid.lo[k];
        word[3] |= (float_bits(grid.step[k]) >> 23) << 8 * k;
    }
    word[4] = grid.bits | bits_of(scene->tri_count) << 5;
    return STATUS_OK;
}

/* Without its bits, which coding does not need. */
static struct grid grid_of(const uint32_t *word)
{
    struct grid grid = {.bits = 0};
    for (int k = 0; k < 3; k++) {
        grid.lo[k] = (int32_t)word[k];
        grid.step[k] = float_from_bits((word[3] >> 8 * k & 255u) << 23);
    }
    return grid;
}

/* A leaf in codes. */
struct codes {
    struct block block;
    uint32_t least[3];
    uint32_t width[3];
};

static bool codes_make(const struct packed *packed, const struct scene *scene, const uint32_t *prim,
                       uint32_t count, struct codes *out)
{
    struct grid grid = grid_of(packed->item);
    if (!block_make(scene, prim, count, &out->block))
        return false;
    for (int k = 0; k < 3; k++) {
        uint32_t most = 0;
        out->least[k] = UINT32_MAX;
        for (uint32_t i = 0; i < out->block.vertex_count; i++) {
            uint32_t code = grid_code(&grid, k, out->block.vertex[i][k]);
            out->least[k] = code < out->least[k] ? code : out->least[k];
            most = code > most ? code : most;
        }
        out->width[k] = bits_of(most - out->least[k]);
    }
    return true;
}

/* Bit positions in a leaf. */
struct places {
    uint32_t tris, vertices;
    uint32_t code, number; /* widths */
    uint32_t width[3], stride;
    uint32_t corner_at, number_at, vertex_at, end;
};

static void places_find(struct places *p, uint32_t widths)
{
    p->code = widths & 31u;
    p->number = widths >> 5 & 31u;
    p->stride = p->width[0] + p->width[1] + p->width[2];
    p->corner_at = LEAST_AT + 3 * p->code;
    p->number_at = p->corner_at + CORNERS * p->tris;
    p->vertex_at = p->number_at + p->number * p->tris;
    p->end = p->vertex_at + p->stride * p->vertices;
}

static struct places places_of(const struct codes *codes, const struct packed *packed)
{
    struct places p = {.tris = codes->block.tri_count, .vertices = codes->block.vertex_count};
    memcpy(p.width, codes->width, sizeof p.width);
    places_find(&p, packed->item[4]);
    return p;
}

static enum status measure(const struct packed *packed, const struct scene *scene,
                           const uint32_t *prim, uint32_t count, uint64_t *words,
                           struct reason *reason)
{
    struct codes codes;
    if (!codes_make(packed, scene, prim, count, &codes))
        return fail(reason, STATUS_LIMIT,
                    "storage %s: a leaf holds at most %u triangles and %u vertices, that of "
                    "triangle %u and the %u beside it has more; use --leaf %u or less",
                    packed->store->name, BLOCK_TRIS, BLOCK_VERTICES, prim[0], count - 1,
                    BLOCK_VERTICES / 3);
    *words = (places_of(&codes, packed).end + 31) / 32;
    return STATUS_OK;
}

static void write(const struct packed *packed, const struct scene *scene, const uint32_t *prim,
                  uint32_t count, uint32_t *word)
{
    struct codes codes;
    if (!codes_make(packed, scene, prim, count, &codes))
        return; /* measure() rejected it */
    struct grid grid = grid_of(packed->item);
    struct places p = places_of(&codes, packed);
    const struct block *block = &codes.block;
    memset(word, 0, (p.end + 31) / 32 * sizeof *word);
    bits_put(word, 0, 3, p.tris - 1);
    bits_put(word, 3, 4, p.vertices - 1);
    for (uint32_t k = 0; k < 3; k++) {
        bits_put(word, SIZES + 5 * k, 5, p.width[k]);
        bits_put(word, LEAST_AT + p.code * k, p.code, codes.least[k]);
    }
    for (uint32_t i = 0; i < p.tris; i++) {
        bits_put(word, p.number_at + p.number * i, p.number, block->prim[i]);
        for (uint32_t c = 0; c < 3; c++)
            bits_put(word, p.corner_at + CORNERS * i + 4 * c, 4, block->corner[c] >> 4 * i & 15u);
    }
    for (uint32_t i = 0; i < p.vertices; i++) {
        uint32_t at = p.vertex_at + p.stride * i;
        for (int k = 0; k < 3; at += p.width[k], k++)
            bits_put(word, at, p.width[k],
                     grid_code(&grid, k, block->vertex[i][k]) - codes.least[k]);
    }
}

/* False if there is no such item, or part of its leaf is outside the words. */
static bool leaf_of(const struct packed *packed, uint32_t first, uint32_t slot, struct places *p)
{
    if (packed->item_count < HEAD || first >= packed->item_count)
        return false;
    const uint32_t *word = packed->item + first;
    *p = (struct places){.tris = (word[0] & 7u) + 1, .vertices = (word[0] >> 3 & 15u) + 1};
    for (uint32_t k = 0; k < 3; k++)
        p->width[k] = word[0] >> (SIZES + 5 * k) & 31u;
    places_find(p, packed->item[4]);
    return slot < p->tris && (p->end + 31) / 32 <= packed->item_count - first;
}

static uint32_t item(const struct packed *packed, uint32_t first, uint32_t slot)
{
    struct places p;
    if (!leaf_of(packed, first, slot, &p))
        return ABI_NO_PRIM;
    return bits_get(packed->item + first, p.number_at + p.number * slot, p.number);
}

/* n has 25 bits with a sign, so floats represent it exactly, whatever the words are. */
static float decode(uint32_t n, uint32_t exponent)
{
    int32_t whole = (int32_t)((n & 0x1FFFFFFu) ^ 0x1000000u) - 0x1000000;
    return (float)whole * float_from_bits(exponent << 23);
}

static bool tri(const struct packed *packed, uint32_t first, uint32_t slot, float v[3][3])
{
    struct places p;
    if (!leaf_of(packed, first, slot, &p))
        return false;
    const uint32_t *word = packed->item + first;
    for (uint32_t c = 0; c < 3; c++) {
        uint32_t vertex = bits_get(word, p.corner_at + CORNERS * slot + 4 * c, 4);
        uint32_t at = p.vertex_at + p.stride * (vertex < p.vertices ? vertex : 0);
        for (uint32_t k = 0; k < 3; at += p.width[k], k++)
            v[c][k] = decode(packed->item[k] + bits_get(word, LEAST_AT + p.code * k, p.code) +
                                 bits_get(word, at, p.width[k]),
                             packed->item[3] >> 8 * k & 255u);
    }
    return true;
}

extern const struct tri_store tri_store_quantised;
const struct tri_store tri_store_quantised = {
    .name = "quantised",
    .summary = "leaves as in compact, of vertices on a grid of up to 21 bits an axis, in bits",
    .id = ABI_STORE_QUANTISED,
    .lossy = &lossy_quantised,
    .head_words = HEAD,
    .head = head,
    .measure = measure,
    .write = write,
    .item = item,
    .tri = tri,
};
