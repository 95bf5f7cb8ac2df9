/* Triangle storage: the layout writes nodes, the storage writes the items of their leaves. A leaf
 * stores `first`, a number that only the storage interprets, and its number of items. A layout that
 * stores items in nodes supports only the storage `indexed`. */
#ifndef STORE_H
#define STORE_H

#include "ref/layout.h"
#include "ref/scene/quantise.h"

struct tri_ray;

struct tri_store {
    const char *name;
    const char *summary;
    uint32_t id;    /* ABI_STORE_* */
    uint32_t tests; /* a bit 1 << ABI_TRI_* for each supported triangle test; 0: all */
    /* Of lossy storages: makes a scene one that is stored without loss. NULL: every scene is. */
    const struct lossy *lossy;
    /* Writes the `head_words` words before the first leaf, at packed->item. Errors: STATUS_LIMIT,
     * with the rule. NULL: there are none. */
    uint32_t head_words;
    enum status (*head)(const struct tri_store *self, const struct scene *scene, uint32_t *word,
                        struct reason *reason);
    /* Number of words for `count` items of one leaf, at least 1; packed->item already has the head.
     * Errors: STATUS_LIMIT, with the rule; *words is undefined then. */
    enum status (*measure)(const struct packed *packed, const struct scene *scene,
                           const uint32_t *prim, uint32_t count, uint64_t *words,
                           struct reason *reason);
    /* For storages of rows (ref/store/rows.h): replaces the vertices by nine floats and returns the
     * value of the upper two bits. NULL: the vertices, and 0. */
    uint32_t (*row)(float v[3][3]);
    /* Writes `count` items to `word`. */
    void (*write)(const struct packed *packed, const struct scene *scene, const uint32_t *prim,
                  uint32_t count, uint32_t *word);
    /* Returns the triangle of item `slot` of the leaf with that `first`, or ABI_NO_PRIM. Like the
     * next two functions it never reads outside the words, whatever `first` (the leaf's first word)
     * and `slot` are. */
    uint32_t (*item)(const struct packed *packed, uint32_t first, uint32_t slot);
    /* Reads its vertices; false if there are none. NULL: they are read from the scene. */
    bool (*tri)(const struct packed *packed, uint32_t first, uint32_t slot, float v[3][3]);
    /* As tri_test_run, with the data stored instead of vertices; false also if there is none. NULL:
     * tests the vertices. */
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

/* True if the storage supports the triangle test `id` (ABI_TRI_*). Engines reject other tests with
 * tri_store_check: trace_ray must not be called with them. */
static inline bool tri_store_answers(const struct tri_store *store, uint32_t id)
{
    return store->tests == 0 || store->tests >> id & 1;
}

/* Returns STATUS_UNSUPPORTED and the reason if the storage of a packed tree does not support the
 * test; else STATUS_OK. `test` is the test's name, for the reason. */
enum status tri_store_check(const struct tri_store *store, uint32_t id, const char *test,
                            struct reason *reason) MUST_USE;

/* Returns the storage of that name, or NULL. */
const struct tri_store *tri_store_find(const char *name);

/* Returns the triangle of item `slot` (below item_count) of a leaf, or ABI_NO_PRIM if there is
 * none. */
static inline uint32_t packed_item(const struct packed *packed, const struct wide *leaf,
                                   uint32_t slot)
{
    return packed->layout->item ? packed->layout->item(packed, leaf->item_first + slot)
                                : packed->store->item(packed, leaf->item_first, slot);
}

/* For a layout's pack(), after packed_make has set out->store: appends `count` items, at least 1,
 * as one leaf. *first is the value that the node stores as its first item. Successive leaves are
 * adjacent. A layout that stores distances between leaves needs ABI_STORE_INDEXED, where they are
 * numbers of items, and rejects other storages. *first increases and is below out->item_count; a
 * layout with fewer than 32 bits for it returns STATUS_LIMIT if they do not suffice. Errors:
 * STATUS_LIMIT of the storage, or 2^32 words or more; STATUS_MEMORY. */
enum status store_put(const struct scene *scene, const uint32_t *prim, uint32_t count,
                      struct packed *out, uint32_t *first, struct reason *reason) MUST_USE;

#endif
