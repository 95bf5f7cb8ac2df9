/* The hierarchy of Morton codes (Karras 2012, Maximizing parallelism in the construction of BVHs,
 * octrees, and k-d trees): a range of the sorted codes is cut where their highest differing bit
 * changes. The tree is the same as Karras's, but made from the top down, directly in pre-order,
 * each piece by one thread; this needs no parents, counters or second order. Equal codes are
 * distinguished by the triangle's number. */
#include "ref/build/grow.h"
#include "ref/build/morton.h"
#include "ref/build/room.h"

struct lbvh {
    const struct ref *ref;
    uint64_t *key;
    uint32_t index_mask;
    uint32_t leaf;
};

static uint32_t halve(void *user, const struct grow_range *range, struct grow_range child[2])
{
    (void)user;
    (void)child;
    return range->count / 2;
}

/* The keys differ, so neither side is empty: the highest differing bit is 0 in the first key, 1 in
 * the last. */
static uint32_t split(void *user, const struct grow_range *range, struct grow_range child[2],
                      uint32_t threads)
{
    const struct lbvh *l = user;
    const uint64_t *key = l->key + range->first;
    (void)child;
    (void)threads;
    if (range->count <= l->leaf)
        return 0;
    uint64_t bit = (uint64_t)1 << (63 - __builtin_clzll(key[0] ^ key[range->count - 1]));
    uint32_t lo = 0, hi = range->count - 1; /* key[lo] lacks the bit, key[hi] has it */
    while (hi - lo > 1) {
        uint32_t middle = lo + (hi - lo) / 2;
        bool above = (key[middle] & bit) != 0;
        hi = above ? middle : hi;
        lo = above ? lo : middle;
    }
    return hi;
}

static struct lane_box leaf(void *user, const struct grow_range *range, uint32_t *prim)
{
    const struct lbvh *l = user;
    struct lane_box box = lane_box_empty();
    for (uint32_t i = 0; i < range->count; i++) {
        const struct ref *ref = &l->ref[(uint32_t)l->key[range->first + i] & l->index_mask];
        prim[i] = ref_prim(ref);
        lane_box_add(&box, &ref->box);
    }
    return box;
}

static enum status start(void *user, struct ref *ref, uint32_t threads, struct grow_range *root)
{
    struct lbvh *l = user;
    uint32_t index_bits = 0;
    l->ref = ref;
    enum status status =
        morton_order(ref, root->count, &root->centres, threads, &l->key, &index_bits);
    l->index_mask = (uint32_t)(((uint64_t)1 << index_bits) - 1);
    return status;
}

static void end(void *user)
{
    room_free(((struct lbvh *)user)->key);
}

static enum status build(const struct scene *scene, const struct build_options *options,
                         struct bvh *out, struct reason *reason)
{
    static const struct grow_rule rule = {start, end, split, halve, leaf};
    struct lbvh l = {.leaf = options->leaf};
    return grow_build(&rule, &l, scene, options, out, reason);
}

extern const struct builder build_lbvh;
const struct builder build_lbvh = {
    .name = "lbvh",
    .summary = "the order of Morton codes, cut where their highest bits change; fast to build",
    .build = build,
    .takes = "presplit",
    .tri_bytes = 120,
};
