/* Storage `dgf1`: a leaf is a block of AMD's dense geometry format, version 1
 * (VK_AMDX_dense_geometry_format): vertices on a signed grid of 24 bits with one exponent, each as
 * an anchor of its block and an offset of up to 16 bits, and a generalised triangle strip. The
 * storage is lossless; only scene_quantise_even (ref/scene/quantise.h) loses precision.
 *
 *   before the first leaf
 *     word 0        the exponent of the scene's step, as in a float
 *   a leaf, bits of each word from the lowest
 *     word 0        8 magic number 6, 2 index bits - 3, 6 vertices - 1, 6 triangles - 1,
 *                   10 geometry: 1, opaque
 *     word 1        8 exponent, 24 anchor x
 *     word 2        4 width of x - 1, 4 width of y - 1, 24 anchor y
 *     word 3        4 width of z - 1, 3 and 1 zero, 24 anchor z
 *     word 4        29 zero, 1 user data is there: 1
 *     word 5        user data: 5 words of the block - 1, 5 bits of a triangle's number - 1
 *     front         offsets x, y, z of each vertex, which take a multiple of 4 bits, then zeros up
 *                   to a whole byte
 *     reuse         indices of vertices that were met before
 *     from the end  2 each: controls of the triangles but the first; then downward 1 each: whether
 *                   an index, but the first three, is the first of its vertex
 *   behind the block, in whole words
 *     number + 2 a triangle: the scene's number, and which vertex of the strip is its first
 *
 * Differences from the format. Blocks there have 128 bytes; here the unused words between the reuse
 * buffer and the end are left out. Triangles keep their order and their first vertex, which the
 * format may change, so that answers have the bits of other storages. Their numbers do not follow
 * each other, and are written behind the block. */
#include "ref/layout.h"
#include "ref/store/bits.h"
#include "ref/store/dense_strip.h"
#include "ref/store.h"

#include <string.h>

#define MAGIC       6u
#define WIDTH_MOST  16u
#define FRONT_AT    192u /* bits before the vertices */
#define FRONT_MOST  768u
#define REUSE_MOST  192u
#define WORDS_MOST  32u
#define ALWAYS_FITS 5u /* triangles without a common vertex */

/* --- places ----------------------------------------------------------------------------------- */

/* Sizes of a block, and bit positions in it. */
struct dense {
    uint32_t tris, vertices;
    uint32_t index, number; /* bits of an index and of a triangle's number */
    uint32_t width[3], stride;
    uint32_t reuse_at, end; /* of the block */
};

static void dense_find(struct dense *d, uint32_t words)
{
    d->stride = d->width[0] + d->width[1] + d->width[2];
    d->reuse_at = FRONT_AT + (d->vertices * d->stride + 7) / 8 * 8;
    d->end = 32 * words;
}

static uint32_t leaf_words(const struct dense *d)
{
    return d->end / 32 + (d->tris * (d->number + 2) + 31) / 32;
}

/* Where triangle i >= 1 has its control, and index j >= 3 its bit. */
static uint32_t control_at(const struct dense *d, uint32_t i)
{
    return d->end - 2 * i;
}

static uint32_t first_at(const struct dense *d, uint32_t j)
{
    return d->end - 2 * (d->tris - 1) - (j - 2);
}

/* --- writing ---------------------------------------------------------------------------------- */

/* Computes the sizes; false if the strip does not fit in a block. */
static bool dense_of(const struct dense_strip *s, const uint32_t *prim, struct dense *d,
                     int32_t anchor[3])
{
    uint32_t numbers = 1;
    *d = (struct dense){.tris = s->tris, .vertices = s->vertices};
    for (int k = 0; k < 3; k++) {
        int32_t most = anchor[k] = s->vertex[0][k];
        for (uint32_t v = 1; v < s->vertices; v++) {
            anchor[k] = s->vertex[v][k] < anchor[k] ? s->vertex[v][k] : anchor[k];
            most = s->vertex[v][k] > most ? s->vertex[v][k] : most;
        }
        d->width[k] = bits_of((uint32_t)(most - anchor[k]) | 1);
        if (d->width[k] > WIDTH_MOST)
            return false;
    }
    for (int k = 2; (d->width[0] + d->width[1] + d->width[2]) % 4 != 0;) {
        if (d->width[k] == WIDTH_MOST)
            k--;
        else
            d->width[k]++;
    }
    for (uint32_t i = 0; i < s->tris; i++)
        numbers |= prim[i];
    while (d->number < 32 && numbers >> d->number)
        d->number++;
    d->index = bits_of(s->largest) > 3 ? bits_of(s->largest) : 3;
    dense_find(d, 0);
    const uint32_t reuse = s->reused * d->index;
    const uint32_t bits = d->reuse_at + reuse + s->indices - 3 + 2 * (s->tris - 1);
    dense_find(d, (bits + 31) / 32);
    return d->reuse_at - FRONT_AT <= FRONT_MOST && reuse <= REUSE_MOST && d->end <= 32 * WORDS_MOST;
}

static enum status measure(const struct packed *packed, const struct scene *scene,
                           const uint32_t *prim, uint32_t count, uint64_t *words,
                           struct reason *reason)
{
    struct dense_strip s;
    struct dense d;
    int32_t anchor[3];
    const double step = (double)float_from_bits(packed->item[0] << 23);
    if (!dense_strip_make(scene, step, prim, count, &s) || !dense_of(&s, prim, &d, anchor))
        return fail(reason, STATUS_LIMIT,
                    "storage %s: the leaf of triangle %u and the %u beside it does not fit in a "
                    "block of 128 bytes and %u steps; use --leaf %u or less, or a coarser grid",
                    packed->store->name, prim[0], count - 1, 1u << WIDTH_MOST, ALWAYS_FITS);
    *words = leaf_words(&d);
    return STATUS_OK;
}

static void write_header(const struct dense *d, const int32_t anchor[3], uint32_t exponent,
                         uint32_t *word)
{
    word[0] = MAGIC | (d->index - 3) << 8 | (d->vertices - 1) << 10 | (d->tris - 1) << 16 |
              (uint32_t)1 << 22;
    word[1] = exponent | (uint32_t)anchor[0] << 8;
    word[2] = (d->width[0] - 1) | (d->width[1] - 1) << 4 | (uint32_t)anchor[1] << 8;
    word[3] = (d->width[2] - 1) | (uint32_t)anchor[2] << 8;
    word[4] = (uint32_t)1 << 29;
    word[5] = (d->end / 32 - 1) | (d->number - 1) << 5;
}

static void write(const struct packed *packed, const struct scene *scene, const uint32_t *prim,
                  uint32_t count, uint32_t *word)
{
    struct dense_strip s;
    struct dense d;
    int32_t anchor[3];
    const double step = (double)float_from_bits(packed->item[0] << 23);
    if (!dense_strip_make(scene, step, prim, count, &s) || !dense_of(&s, prim, &d, anchor))
        return; /* measure() rejected it */
    memset(word, 0, leaf_words(&d) * sizeof *word);
    write_header(&d, anchor, packed->item[0], word);
    for (uint32_t v = 0, at = FRONT_AT; v < s.vertices; v++)
        for (int k = 0; k < 3; at += d.width[k], k++)
            bits_put(word, at, d.width[k], (uint32_t)(s.vertex[v][k] - anchor[k]));
    for (uint32_t i = 0; i < s.reused; i++)
        bits_put(word, d.reuse_at + d.index * i, d.index, s.reuse[i]);
    for (uint32_t j = 3; j < s.indices; j++)
        bits_put(word, first_at(&d, j), 1, s.first[j]);
    for (uint32_t i = 1; i < s.tris; i++)
        bits_put(word, control_at(&d, i), 2, s.control[i]);
    for (uint32_t i = 0; i < s.tris; i++) {
        bits_put(word, d.end + (d.number + 2) * i, d.number, prim[i]);
        bits_put(word, d.end + (d.number + 2) * i + d.number, 2, s.turn[i]);
    }
}

static enum status head(const struct tri_store *self, const struct scene *scene, uint32_t *word,
                        struct reason *reason)
{
    struct grid grid;
    struct reason why = {""};
    if (grid_even_of_scene(scene, &grid, &why))
        return fail(reason, STATUS_LIMIT, "storage %s: %.200s", self->name, why.text);
    word[0] = float_bits(grid.step[0]) >> 23;
    return STATUS_OK;
}

/* --- reading ---------------------------------------------------------------------------------- */

/* False if there is no such item, or part of its leaf is outside the words. */
static bool leaf_of(const struct packed *packed, uint32_t first, uint32_t slot, struct dense *d)
{
    if (first >= packed->item_count || packed->item_count - first < FRONT_AT / 32)
        return false;
    const uint32_t *word = packed->item + first;
    *d = (struct dense){
        .tris = (word[0] >> 16 & 63u) + 1,
        .vertices = (word[0] >> 10 & 63u) + 1,
        .index = (word[0] >> 8 & 3u) + 3,
        .number = (word[5] >> 5 & 31u) + 1,
        .width = {(word[2] & 15u) + 1, (word[2] >> 4 & 15u) + 1, (word[3] & 15u) + 1}};
    dense_find(d, (word[5] & 31u) + 1);
    return slot < d->tris && d->reuse_at + 2 * (d->tris - 1) <= d->end &&
           leaf_words(d) <= packed->item_count - first;
}

static uint32_t item(const struct packed *packed, uint32_t first, uint32_t slot)
{
    struct dense d;
    if (!leaf_of(packed, first, slot, &d))
        return ABI_NO_PRIM;
    return bits_get(packed->item + first, d.end + (d.number + 2) * slot, d.number);
}

/* Finds the places of a triangle's three indices. */
static void find_indices(const struct dense *d, const uint32_t *word, uint32_t slot,
                         uint32_t out[3])
{
    uint32_t one[3] = {0, 1, 2}, two[3] = {0}, now[3], before = CONTROL_RESTART, next = 3;
    for (uint32_t i = 1; i <= slot; i++) {
        uint32_t control = bits_get(word, control_at(d, i), 2);
        if (control == CONTROL_RESTART) {
            now[0] = next++;
            now[1] = next++;
        } else {
            dense_edge((enum control)control, (enum control)before, one, two, now);
        }
        now[2] = next++;
        memcpy(two, one, sizeof two);
        memcpy(one, now, sizeof one);
        before = control;
    }
    memcpy(out, one, sizeof one);
}

/* Returns the vertex of index j. Bits that the block does not have are 0. */
static uint32_t vertex_of(const struct dense *d, const uint32_t *word, uint32_t j)
{
    uint32_t firsts = j < 3 ? j : 3;
    bool is_first = j < 3;
    for (uint32_t i = 3; i <= j; i++) {
        uint32_t at = first_at(d, i);
        is_first = at < d->end && bits_get(word, at, 1);
        firsts += i < j && is_first;
    }
    uint32_t at = d->reuse_at + d->index * (j - firsts), v = firsts;
    if (!is_first)
        v = at + d->index <= d->end ? bits_get(word, at, d->index) : 0;
    return v < d->vertices ? v : 0;
}

/* The anchor is in the upper 24 bits of a word. The sum has 25 bits, so floats represent it. */
static float decode(uint32_t anchor, uint32_t offset, uint32_t exponent)
{
    int32_t whole = (int32_t)((anchor >> 8) ^ 0x800000u) - 0x800000 + (int32_t)offset;
    return (float)whole * float_from_bits(exponent << 23);
}

static bool tri(const struct packed *packed, uint32_t first, uint32_t slot, float v[3][3])
{
    struct dense d;
    uint32_t index[3];
    if (!leaf_of(packed, first, slot, &d))
        return false;
    const uint32_t *word = packed->item + first;
    const uint32_t turn = bits_get(word, d.end + (d.number + 2) * slot + d.number, 2);
    find_indices(&d, word, slot, index);
    for (uint32_t c = 0; c < 3; c++) {
        uint32_t at = FRONT_AT + d.stride * vertex_of(&d, word, index[c]);
        for (uint32_t k = 0; k < 3; at += d.width[k], k++)
            v[(c + turn) % 3][k] =
                decode(word[1 + k], bits_get(word, at, d.width[k]), word[1] & 255u);
    }
    return true;
}

extern const struct tri_store tri_store_dgf1;
const struct tri_store tri_store_dgf1 = {
    .name = "dgf1",
    .summary = "AMD's dense geometry format: blocks of strips, of vertices on a grid of one step",
    .id = ABI_STORE_DGF1,
    .lossy = &lossy_even,
    .head_words = 1,
    .head = head,
    .measure = measure,
    .write = write,
    .item = item,
    .tri = tri,
};
