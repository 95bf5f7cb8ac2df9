/* Files as tinybvh and bvh v2 save them, written from their formats' descriptions
 * (ref/dump/dump_saved.c), of our trees. */
#ifndef TREES_SAVED_H
#define TREES_SAVED_H

#include "tests/trees/dump_fixture.h"

#define SAVED_OBJECT 288u /* bytes of tinybvh's object, as gcc lays it out for x86-64 */

struct saved {
    unsigned char bytes[1 << 17];
    size_t size;
};

static inline void saved_word(struct saved *saved, uint32_t word)
{
    assert_true(saved->size + 4 <= sizeof saved->bytes - 1);
    for (int i = 0; i < 4; i++)
        saved->bytes[saved->size++] = (unsigned char)(word >> 8 * i);
}

static inline void saved_set(struct saved *saved, size_t at, uint32_t word)
{
    const size_t size = saved->size;
    saved->size = at;
    saved_word(saved, word);
    saved->size = size;
}

static inline uint32_t saved_get(const struct saved *saved, size_t at)
{
    uint32_t word = 0;
    for (int i = 0; i < 4; i++)
        word |= (uint32_t)saved->bytes[at + (size_t)i] << 8 * i;
    return word;
}

/* Our nodes in the order of a file in which children are neighbours: of[i] is the node at place i,
 * first[i] where its children are. Places begin with 0, the root, then `next`. Returns their
 * number. */
static inline uint32_t saved_order(const struct bvh *bvh, uint32_t next, uint32_t *of,
                                   uint32_t *first)
{
    of[0] = 0;
    for (uint32_t i = 0; i < next; i++) {
        const struct bvh_node *node = &bvh->node[of[i]];
        if ((i > 0 && of[i] == 0) || node->item_count)
            continue;
        first[i] = next;
        of[next++] = node->fst;
        of[next++] = node->snd;
    }
    return next;
}

#define SAVED_NODES 2048u

/* Nodes: box, first and count in 8 words; node 1 is left out. Places of the words of node i:
 * saved_tiny_node. */
static inline size_t saved_tiny_node(uint32_t i)
{
    return 8 + SAVED_OBJECT + 32 * (size_t)i;
}

static inline void saved_tinybvh(const struct bvh *bvh, bool splits, struct saved *out)
{
    static uint32_t of[SAVED_NODES], first[SAVED_NODES];
    memset(of, 0, sizeof of);
    const uint32_t nodes = saved_order(bvh, 2, of, first);
    out->size = 0;
    saved_word(out, 166 | 1u << 24);
    saved_word(out, bvh->tri_count);
    for (uint32_t i = 0; i < SAVED_OBJECT / 4; i++)
        saved_word(out, 0xABABABAB); /* pointers and what is not read */
    out->bytes[8 + 1] = !splits;
    out->bytes[8 + 2] = 0;
    saved_set(out, 8 + 32, 1);
    saved_set(out, 8 + 40, nodes);
    saved_set(out, 8 + 44, bvh->tri_count);
    saved_set(out, 8 + 48, bvh->prim_count);
    for (uint32_t i = 0; i < nodes; i++) {
        const struct bvh_node *node = &bvh->node[of[i]];
        for (int k = 0; k < 3; k++)
            saved_word(out, i == 1 ? 0xCDCDCDCD : float_bits(node->bounds.lo[k]));
        saved_word(out, i == 1 ? 0xCDCDCDCD : node->item_count ? node->item_first : first[i]);
        for (int k = 0; k < 3; k++)
            saved_word(out, i == 1 ? 0xCDCDCDCD : float_bits(node->bounds.hi[k]));
        saved_word(out, i == 1 ? 0 : node->item_count);
    }
    for (uint32_t i = 0; i < bvh->prim_count; i++)
        saved_word(out, bvh->prim[i]);
    out->bytes[out->size] = 0;
}

/* Nodes: bounds axis by axis, then first * 16 + count. */
static inline size_t saved_bvh2_node(uint32_t i)
{
    return 8 + 28 * (size_t)i;
}

static inline void saved_bvh2(const struct bvh *bvh, struct saved *out)
{
    static uint32_t of[SAVED_NODES], first[SAVED_NODES];
    const uint32_t nodes = saved_order(bvh, 1, of, first);
    out->size = 0;
    saved_word(out, nodes);
    saved_word(out, bvh->prim_count);
    for (uint32_t i = 0; i < nodes; i++) {
        const struct bvh_node *node = &bvh->node[of[i]];
        for (int k = 0; k < 3; k++) {
            saved_word(out, float_bits(node->bounds.lo[k]));
            saved_word(out, float_bits(node->bounds.hi[k]));
        }
        saved_word(out, 16 * (node->item_count ? node->item_first : first[i]) + node->item_count);
    }
    for (uint32_t i = 0; i < bvh->prim_count; i++)
        saved_word(out, bvh->prim[i]);
    out->bytes[out->size] = 0;
}

#endif
