#include "bench/measure/touch.h"

#include "ref/trace/trace.h"
#include "ref/primitives/test_run.h"
#include "ref/store.h"

#include <stdlib.h>

#define NODES    TOUCH_NODES
#define ITEMS    TOUCH_ITEMS
#define INDICES  TOUCH_INDICES
#define VERTICES TOUCH_VERTICES

/* Addresses of arrays are so far apart that they cannot overlap. */
static uint64_t place(int array, uint64_t offset)
{
    return ((uint64_t)(array + 1) << 40) + offset;
}

static void note(const struct touch *touch, enum touch_array array, uint64_t offset, uint64_t bytes)
{
    if (touch->read)
        touch->read(touch->reader, array, offset, bytes);
    else
        cache_sim_read(touch->cache, place((int)array, offset), bytes);
}

/* The packed tree is the first member of the struct that watches it. */
static const struct touch *watcher(const struct packed *packed)
{
    return (const struct touch *)packed;
}

/* --- nodes ------------------------------------------------------------------------------------ */

/* A reference names a record or one of its slots. If a record can be read in two ways (amd64),
 * there are twice as many references, and the second way also reads the next record. */
uint32_t touch_record(const struct packed *packed, uint32_t ref, uint32_t *way)
{
    uint32_t records = packed->node_count, width = packed->layout->width;
    uint32_t refs = layout_refs(packed->layout), ways = refs > 1 ? refs / (1 + width) : 1;
    uint32_t record = ref;
    *way = 0;
    if (refs > 1 && ways > 0) {
        bool slot = ref >= ways * records;
        record = slot ? (ref - ways * records) / width : ref;
        *way = record / records;
    }
    return record % records;
}

static void read_record(const struct touch *touch, uint32_t ref)
{
    const struct layout *layout = touch->real->layout;
    uint32_t way, record = touch_record(touch->real, ref, &way);
    note(touch, NODES, (uint64_t)record * layout->node_bytes,
         (1 + way) * (uint64_t)layout->node_bytes);
}

/* A node has its own box: its parent's test reads it there. Where a layout from outside has its
 * boxes is not known. */
static bool boxes_are_own(const struct layout *layout)
{
    return !layout_is_wide(layout) && !layout->outside;
}

static void load(const struct packed *packed, uint32_t ref, struct wide *out)
{
    const struct touch *touch = watcher(packed);
    const struct layout *layout = touch->real->layout;
    read_record(touch, ref);
    layout->load(touch->real, ref, out);
    for (uint32_t c = 0; c < out->child_count && boxes_are_own(layout); c++)
        read_record(touch, out->child[c]);
}

static struct box box(const struct packed *packed, uint32_t ref)
{
    const struct touch *touch = watcher(packed);
    if (boxes_are_own(touch->real->layout))
        read_record(touch, ref);
    return touch->real->layout->box(touch->real, ref);
}

/* --- items ------------------------------------------------------------------------------------ */

static void read_vertices(const struct touch *touch, uint32_t prim)
{
    if (prim >= touch->scene->tri_count)
        return;
    if (touch->gathered) {
        note(touch, VERTICES, 36 * (uint64_t)prim, 36);
        return;
    }
    note(touch, INDICES, 12 * (uint64_t)prim, 12);
    for (int c = 0; c < 3; c++) {
        uint32_t vertex = touch->scene->index[3 * (size_t)prim + (size_t)c];
        note(touch, VERTICES, 12 * (uint64_t)vertex, 12);
    }
}

/* For layouts that have items without a storage: words of the item array, or 16 bits in the
 * nodes. */
static uint32_t layout_item(const struct packed *packed, uint32_t slot)
{
    const struct touch *touch = watcher(packed);
    uint32_t prim = touch->real->layout->item(touch->real, slot);
    if (touch->real->item)
        note(touch, ITEMS, 4 * (uint64_t)slot, 4);
    else
        note(touch, NODES, 2 * (uint64_t)slot, 2);
    read_vertices(touch, prim);
    return prim;
}

static int by_place(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return order_numbers(x, y);
}

/* Words from `first` to the next leaf. */
static uint64_t leaf_words(const struct touch *touch, uint32_t first)
{
    const uint32_t *at =
        bsearch(&first, touch->leaf, touch->leaf_count, sizeof *touch->leaf, by_place);
    if (!at)
        return 1;
    size_t next = (size_t)(at - touch->leaf) + 1;
    return (next < touch->leaf_count ? touch->leaf[next] : touch->real->item_count) - first;
}

static uint32_t store_item(const struct packed *packed, uint32_t first, uint32_t slot)
{
    const struct touch *touch = watcher(packed);
    const struct tri_store *store = touch->real->store;
    uint32_t prim = store->item(touch->real, first, slot);
    if (touch->leaf) {
        if (slot == 0)
            note(touch, ITEMS, 4 * (uint64_t)first, 4 * leaf_words(touch, first));
        return prim;
    }
    note(touch, ITEMS, 4 * ((uint64_t)first + slot), 4);
    read_vertices(touch, prim);
    return prim;
}

static bool store_tri(const struct packed *packed, uint32_t first, uint32_t slot, float v[3][3])
{
    const struct packed *real = watcher(packed)->real;
    return real->store->tri(real, first, slot, v);
}

static bool store_test(const struct packed *packed, uint32_t first, uint32_t slot, uint32_t tri_id,
                       const struct tri_ray *ray, struct hit *out)
{
    const struct packed *real = watcher(packed)->real;
    return real->store->test(real, first, slot, tri_id, ray, out);
}

/* --- the whole -------------------------------------------------------------------------------- */

/* Leaves that are reached from the root: a record that is read in two ways is a node in one of
 * them, and holds anything in the other. */
static enum status find_leaves(struct touch *touch, struct reason *reason)
{
    const struct packed *real = touch->real;
    uint32_t *wait = alloc_zeroed((size_t)real->ref_count + 1, sizeof *wait), waiting = 1;
    bool *seen = alloc_zeroed((size_t)real->ref_count + 1, sizeof *seen);
    touch->leaf = alloc_zeroed((size_t)real->ref_count + 1, sizeof *touch->leaf);
    bool all = wait && seen && touch->leaf;
    if (all) {
        wait[0] = real->root;
        seen[real->root] = true;
    }
    while (all && waiting > 0) {
        struct wide node;
        real->layout->load(real, wait[--waiting], &node);
        if (node.child_count == 0 && node.item_count > 0)
            touch->leaf[touch->leaf_count++] = node.item_first;
        for (uint32_t c = 0; c < node.child_count; c++)
            if (!seen[node.child[c]]) {
                seen[node.child[c]] = true;
                wait[waiting++] = node.child[c];
            }
    }
    free(wait);
    free(seen);
    if (!all)
        return fail(reason, STATUS_MEMORY, "no memory for %u leaves", real->ref_count);
    qsort(touch->leaf, touch->leaf_count, sizeof *touch->leaf, by_place);
    return STATUS_OK;
}

enum status touch_make(const struct packed *packed, const struct scene *scene, bool gathered,
                       struct cache_sim *cache, struct touch *out, struct reason *reason)
{
    *out = (struct touch){.packed = *packed,
                          .layout = *packed->layout,
                          .real = packed,
                          .scene = scene,
                          .cache = cache,
                          .gathered = gathered};
    out->layout.load = load;
    out->layout.box = box;
    out->packed.layout = &out->layout;
    if (packed->node_count == 0)
        return STATUS_OK;
    out->store = *packed->store;
    out->packed.store = &out->store;
    if (packed->layout->item) {
        out->layout.item = layout_item;
        return STATUS_OK;
    }
    out->store.id = UINT32_MAX; /* else the traversal reads items of `indexed` without item() */
    out->store.item = store_item;
    out->store.tri = out->store.tri ? store_tri : NULL;
    out->store.test = out->store.test ? store_test : NULL;
    return tri_store_reads_scene(packed->store) ? STATUS_OK : find_leaves(out, reason);
}

enum status touch_ray(struct touch *touch, const struct job *job, const struct ray *ray,
                      struct hit *hit)
{
    struct job own = *job;
    own.scene = touch->scene;
    own.packed = &touch->packed;
    return trace_ray(&own, ray, hit, NULL);
}

void touch_free(struct touch *touch)
{
    free(touch->leaf);
    touch->leaf = NULL;
}

struct fast_reader {
    const struct fast_tree *tree;
    struct cache_sim *cache;
};

static void read_fast(void *reader, const void *at, size_t bytes)
{
    const struct fast_reader *r = reader;
    const char *from = at, *block = (const char *)r->tree->block;
    const char *node = r->tree->small ? (const char *)r->tree->small : (const char *)r->tree->node;
    bool is_node = bytes == fast_node_bytes(r->tree) && from >= node &&
                   from < node + bytes * (size_t)r->tree->node_count;
    cache_sim_read(r->cache,
                   is_node ? place(NODES, (uint64_t)(from - node))
                           : place(ITEMS, (uint64_t)(from - block)),
                   bytes);
}

void touch_fast(const struct fast_tree *tree, const struct ray *ray, bool any,
                struct cache_sim *cache, struct hit *hit)
{
    struct fast_reader reader = {tree, cache};
    fast_watched(tree, ray, any, read_fast, &reader, hit);
}

static void read_kd(void *cache, enum kd_read array, ptrdiff_t number, size_t bytes)
{
    const int arrays[] = {[KD_READ_NODE] = NODES, [KD_READ_ITEM] = ITEMS, [KD_READ_TRI] = VERTICES};
    cache_sim_read(cache, place(arrays[array], (uint64_t)number * bytes), bytes);
}

void touch_kd(const struct kd_tree *tree, const struct ray *ray, struct cache_sim *cache,
              struct hit *hit)
{
    *hit = kd_watched(tree, ray, read_kd, cache);
}

static void read_dual(void *cache, uint32_t word, uint32_t words)
{
    cache_sim_read(cache, place(NODES, 4 * (uint64_t)word), 4 * (uint64_t)words);
}

void touch_dual(struct touch *touch, const struct dual_tree *tree, const struct job *job,
                const struct ray *ray, struct hit *hit)
{
    struct job own = *job;
    own.scene = touch->scene;
    own.packed = &touch->packed;
    *hit = dual_watched(tree, &own, ray, read_dual, touch->cache);
}
