/* Triangle storage: the layout writes nodes, the storage writes the items of their leaves. What a
 * leaf keeps of its items is `first`, a number that only the storage understands, and how many
 * there are; a layout whose items lie in its nodes has no storage but `indexed`. */
#ifndef STORE_H
#define STORE_H

#include "ref/layout.h"

struct tri_ray;

struct tri_store {
    const char *name;
    const char *summary;
    uint32_t id;    /* ABI_STORE_* */
    uint32_t tests; /* a bit 1 << ABI_TRI_* for each triangle test that it can answer; 0: any */
    /* What comes before the first leaf: `head_words` words, at packed->item. Errors: STATUS_LIMIT,
     * with the rule. NULL: nothing. */
    uint32_t head_words;
    enum status (*head)(const struct tri_store *self, const struct scene *scene, uint32_t *word,
                        struct reason *reason);
    /* Number of words for `count` items of one leaf, at least 1; packed->item has the head. Errors:
     * STATUS_LIMIT, with the rule. */
    enum status (*measure)(const struct packed *packed, const struct scene *scene,
                           const uint32_t *prim, uint32_t count, uint64_t *words,
                           struct reason *reason);
    /* Of storages of rows (ref/store/rows.h): puts nine floats in place of the vertices and returns
     * what the upper two bits keep. NULL: the vertices, and 0. */
    uint32_t (*row)(float v[3][3]);
    /* Writes `count` items to `word`. */
    void (*write)(const struct packed *packed, const struct scene *scene, const uint32_t *prim,
                  uint32_t count, uint32_t *word);
    /* The triangle of item `slot` of the leaf with that `first`, or ABI_NO_PRIM. Like the next two
     * never reads outside the words, whatever `first`, the leaf's first word, and `slot` are. */
    uint32_t (*item)(const struct packed *packed, uint32_t first, uint32_t slot);
    /* Its vertices; false if there are none. NULL: they are the scene's, by the triangle. */
    bool (*tri)(const struct packed *packed, uint32_t first, uint32_t slot, float v[3][3]);
    /* As tri_test_run, of what is stored in place of vertices; false also if there is nothing.
     * NULL: by the vertices. */
    bool (*test)(const struct packed *packed, uint32_t first, uint32_t slot, uint32_t tri_id,
                 const struct tri_ray *ray, struct hit *out);
};

/* NULL-terminated; the first, `indexed`, is the default. */
extern const struct tri_store *const tri_stores[];

/* True if the scene's own vertices are read. */
static inline bool tri_store_reads_scene(const struct tri_store *store)
{
    return !store->tri && !store->test;
}

/* True if the storage supports the triangle test `id` (ABI_TRI_*). Engines refuse others by
 * tri_store_check: trace_ray must not be called with them. */
static inline bool tri_store_answers(const struct tri_store *store, uint32_t id)
{
    return store->tests == 0 || store->tests >> id & 1;
}

/* STATUS_UNSUPPORTED and the reason if the storage of a packed tree does not support the test; else
 * STATUS_OK. `test` is its name, for the reason. */
enum status tri_store_check(const struct tri_store *store, uint32_t id, const char *test,
                            struct reason *reason) MUST_USE;

/* Returns the storage of that name, or NULL. */
const struct tri_store *tri_store_find(const char *name);

/* Triangle of item `slot` (below item_count) of a leaf, or ABI_NO_PRIM if there is none. */
static inline uint32_t packed_item(const struct packed *packed, const struct wide *leaf,
                                   uint32_t slot)
{
    return packed->layout->item ? packed->layout->item(packed, leaf->item_first + slot)
                                : packed->store->item(packed, leaf->item_first, slot);
}

/* For a layout's pack(), whose out->store packed_make has set: appends `count` items, at least 1,
 * as one leaf. *first is what the node is to keep as its first item. Leaves that are put one after
 * the other lie one after the other; a layout that keeps distances between them needs
 * ABI_STORE_INDEXED, where they are numbers of items, and refuses other storages. *first is below
 * out->item_count, and grows: a layout that has fewer than 32 bits for it says STATUS_LIMIT where
 * they are not enough. Errors: STATUS_LIMIT of the storage, or 2^32 words or more; STATUS_MEMORY.
 */
enum status store_put(const struct scene *scene, const uint32_t *prim, uint32_t count,
                      struct packed *out, uint32_t *first, struct reason *reason) MUST_USE;

#endif
