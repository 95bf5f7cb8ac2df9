#include "bench/traffic/scene_treelets.h"

#include <stdlib.h>
#include <string.h>

#define BURST 64u

/* A treelet in the making. */
struct treelet_cut {
    struct touch *touch;
    struct scene_treelets *out;
    uint64_t most;
    uint32_t *own;   /* bytes of each reference */
    uint64_t *below; /* of it and all below it */
    struct treelet_front {
        double area;
        uint32_t ref;
    } * front; /* a heap, the largest first */
    size_t front_count, front_capacity;
    size_t root_capacity;
};

/* --- what a node reads ------------------------------------------------------------------------ */

static void add_bytes(void *reader, enum touch_array array, uint64_t offset, uint64_t bytes)
{
    uint64_t *sum = reader;
    (void)array;
    (void)offset;
    *sum += bytes;
}

static void ignore(void *reader, enum touch_array array, uint64_t offset, uint64_t bytes)
{
    (void)reader;
    (void)array;
    (void)offset;
    (void)bytes;
}

/* Reads the items of a leaf with the recording tree. */
static void read_items(const struct touch *touch, const struct wide *leaf)
{
    for (uint32_t i = 0; i < leaf->item_count; i++)
        (void)packed_item(&touch->packed, leaf, i);
}

static void load_real(const struct touch *touch, uint32_t ref, struct wide *node)
{
    touch->real->layout->load(touch->real, ref, node);
}

/* True if the reference has a record, which is not its parent's. */
static bool has_record(const struct touch *touch, uint32_t ref, uint32_t parent)
{
    uint32_t way;
    return ref == parent ||
           touch_record(touch->real, ref, &way) != touch_record(touch->real, parent, &way);
}

static uint32_t bytes_of(struct touch *touch, uint32_t ref, uint32_t parent)
{
    struct wide node;
    uint64_t sum = 0;
    uint32_t way;
    load_real(touch, ref, &node);
    touch->read = add_bytes;
    touch->reader = &sum;
    if (node.child_count == 0)
        read_items(touch, &node);
    touch->read = ignore;
    (void)touch_record(touch->real, ref, &way);
    if (has_record(touch, ref, parent))
        sum += (1 + way) * (uint64_t)touch->real->layout->node_bytes;
    return sum > UINT32_MAX ? UINT32_MAX : (uint32_t)sum;
}

/* --- order ------------------------------------------------------------------------------------ */

/* Lists all references, parents first. */
static enum status list_all(struct treelet_cut *cut, struct reason *reason)
{
    struct scene_treelets *out = cut->out;
    const struct packed *packed = cut->touch->real;
    memset(out->of, 0xFF, packed->ref_count * sizeof *out->of);
    out->order[0] = packed->root;
    out->parent[packed->root] = packed->root;
    out->of[packed->root] = 0;
    out->order_count = 1;
    for (uint32_t at = 0; at < out->order_count; at++) {
        uint32_t ref = out->order[at];
        struct wide node;
        load_real(cut->touch, ref, &node);
        for (uint32_t c = 0; c < node.child_count; c++) {
            uint32_t child = node.child[c];
            if (out->of[child] != UINT32_MAX)
                return fail(reason, STATUS_LIMIT, "layout %s: node %u is reached twice: no tree",
                            packed->layout->name, child);
            out->of[child] = 0;
            out->parent[child] = ref;
            out->order[out->order_count++] = child;
        }
    }
    return STATUS_OK;
}

/* Adds up bytes. A reference without a record counts as its parent's. */
static enum status weigh(struct treelet_cut *cut, struct reason *reason)
{
    struct scene_treelets *out = cut->out;
    for (uint32_t at = 0; at < out->order_count; at++) {
        uint32_t ref = out->order[at];
        cut->own[ref] = bytes_of(cut->touch, ref, out->parent[ref]);
    }
    for (uint32_t at = out->order_count; at-- > 0;) {
        uint32_t ref = out->order[at], parent = out->parent[ref];
        cut->below[ref] += cut->own[ref];
        if (ref == parent)
            continue;
        if (has_record(cut->touch, ref, parent))
            cut->below[parent] += cut->below[ref];
        else
            cut->own[parent] += cut->own[ref];
    }
    uint32_t largest = 0;
    for (uint32_t at = 0; at < out->order_count; at++)
        largest = cut->own[out->order[at]] > largest ? cut->own[out->order[at]] : largest;
    if (largest > cut->most)
        return fail(reason, STATUS_INPUT,
                    "treelets of %llu bytes: a node of layout %s with its triangles has %u",
                    (unsigned long long)cut->most, cut->touch->real->layout->name, largest);
    return STATUS_OK;
}

/* --- cutting ---------------------------------------------------------------------------------- */

static double area_of(const struct box *box)
{
    double d[3];
    for (int k = 0; k < 3; k++)
        d[k] = (double)box->hi[k] - (double)box->lo[k];
    return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
}

static enum status front_put(struct treelet_cut *cut, uint32_t ref, double area)
{
    if (array_reserve(&cut->front, &cut->front_capacity, cut->front_count + 1, sizeof *cut->front))
        return STATUS_MEMORY;
    size_t at = cut->front_count++;
    for (; at > 0 && cut->front[(at - 1) / 2].area < area; at = (at - 1) / 2)
        cut->front[at] = cut->front[(at - 1) / 2];
    cut->front[at] = (struct treelet_front){area, ref};
    return STATUS_OK;
}

static uint32_t front_take(struct treelet_cut *cut)
{
    uint32_t ref = cut->front[0].ref;
    struct treelet_front last = cut->front[--cut->front_count];
    size_t at = 0, child;
    while ((child = 2 * at + 1) < cut->front_count) {
        if (child + 1 < cut->front_count && cut->front[child + 1].area > cut->front[child].area)
            child++;
        if (!(cut->front[child].area > last.area))
            break;
        cut->front[at] = cut->front[child];
        at = child;
    }
    cut->front[at] = last;
    return ref;
}

static enum status add_root(struct treelet_cut *cut, uint32_t ref)
{
    struct scene_treelets *out = cut->out;
    if (array_reserve(&out->root, &cut->root_capacity, (size_t)out->count + 1, sizeof *out->root))
        return STATUS_MEMORY;
    out->root[out->count++] = ref;
    return STATUS_OK;
}

/* Puts a node into a treelet, and its children into the front, or with it without a record. */
static enum status take_node(struct treelet_cut *cut, uint32_t ref, uint32_t treelet)
{
    struct wide node;
    enum status status = STATUS_OK;
    cut->out->of[ref] = treelet;
    load_real(cut->touch, ref, &node);
    for (uint32_t c = 0; c < node.child_count && !status; c++) {
        if (has_record(cut->touch, node.child[c], ref))
            status = front_put(cut, node.child[c], area_of(&node.box[c]));
        else
            cut->out->of[node.child[c]] = treelet;
    }
    return status;
}

/* Fills the treelet of one root; nodes that are left over become roots. */
static enum status fill(struct treelet_cut *cut, uint32_t treelet)
{
    uint32_t root = cut->out->root[treelet];
    bool all = cut->below[root] <= cut->most, full = false;
    uint64_t bytes = cut->own[root];
    enum status status = take_node(cut, root, treelet);
    while (cut->front_count > 0 && !status) {
        uint32_t ref = front_take(cut);
        bool fits =
            all || (!full && cut->below[ref] > cut->most && bytes + cut->own[ref] <= cut->most);
        if (fits) {
            bytes += cut->own[ref];
            status = take_node(cut, ref, treelet);
        } else {
            full = full || cut->below[ref] > cut->most;
            status = add_root(cut, ref);
        }
    }
    return status;
}

static enum status cut_all(struct treelet_cut *cut, struct reason *reason)
{
    struct scene_treelets *out = cut->out;
    enum status status = add_root(cut, cut->touch->real->root);
    for (uint32_t treelet = 0; treelet < out->count && !status; treelet++)
        status = fill(cut, treelet);
    out->bytes = alloc_zeroed(out->count, sizeof *out->bytes);
    if (status || !out->bytes)
        return fail(reason, STATUS_MEMORY, "no memory for treelets");
    for (uint32_t at = 0; at < out->order_count; at++) {
        uint32_t ref = out->order[at];
        if (has_record(cut->touch, ref, out->parent[ref]))
            out->bytes[out->of[ref]] += cut->own[ref];
    }
    return STATUS_OK;
}

enum status treelets_make(struct touch *touch, uint64_t most, struct scene_treelets *out,
                          struct reason *reason)
{
    size_t refs = touch->real->ref_count;
    *out = (struct scene_treelets){0};
    struct treelet_cut cut = {.touch = touch,
                              .out = out,
                              .most = most,
                              .own = alloc_zeroed(refs, sizeof *cut.own),
                              .below = alloc_zeroed(refs, sizeof *cut.below)};
    out->of = alloc_zeroed(refs, sizeof *out->of);
    out->parent = alloc_zeroed(refs, sizeof *out->parent);
    out->order = alloc_zeroed(refs, sizeof *out->order);
    enum status status = STATUS_OK;
    if (!cut.own || !cut.below || !out->of || !out->parent || !out->order)
        status = fail(reason, STATUS_MEMORY, "no memory for treelets of %zu nodes", refs);
    if (!status)
        status = list_all(&cut, reason);
    if (!status)
        status = weigh(&cut, reason);
    if (!status)
        status = cut_all(&cut, reason);
    free(cut.own);
    free(cut.below);
    free(cut.front);
    if (status)
        treelets_free(out);
    return status;
}

/* --- runs ------------------------------------------------------------------------------------- */

/* Bursts of one treelet: array in the upper bits, number below. */
struct treelet_bursts {
    uint64_t *at;
    size_t count, capacity;
    bool failed;
};

static void add_bursts(void *reader, enum touch_array array, uint64_t offset, uint64_t bytes)
{
    struct treelet_bursts *b = reader;
    for (uint64_t burst = offset / BURST; bytes && burst <= (offset + bytes - 1) / BURST; burst++) {
        if (array_reserve(&b->at, &b->capacity, b->count + 1, sizeof *b->at)) {
            b->failed = true;
            return;
        }
        b->at[b->count++] = (uint64_t)array << 56 | burst;
    }
}

static int by_number(const void *a, const void *b)
{
    return order_numbers(*(const uint64_t *)a, *(const uint64_t *)b);
}

/* Adds the sorted bursts as runs. */
static enum status add_runs(struct scene_treelets *treelets, struct treelet_bursts *b)
{
    if (b->count > 1)
        qsort(b->at, b->count, sizeof *b->at, by_number);
    for (size_t i = 0; i < b->count; i++) {
        if (i > 0 && b->at[i] == b->at[i - 1])
            continue;
        if (i > 0 && b->at[i] == b->at[i - 1] + 1) {
            treelets->run[treelets->run_count - 1].bytes += BURST;
            continue;
        }
        if (array_reserve(&treelets->run, &treelets->run_capacity, treelets->run_count + 1,
                          sizeof *treelets->run))
            return STATUS_MEMORY;
        treelets->run[treelets->run_count++] =
            (struct treelet_run){.offset = (b->at[i] & (((uint64_t)1 << 56) - 1)) * BURST,
                                 .bytes = BURST,
                                 .array = (uint32_t)(b->at[i] >> 56)};
    }
    return STATUS_OK;
}

/* Lists references by treelet; *from gets count + 1 places. */
static enum status by_treelet(const struct scene_treelets *treelets, uint32_t **list, size_t **from)
{
    *list = alloc_zeroed(treelets->order_count, sizeof **list);
    *from = alloc_zeroed((size_t)treelets->count + 2, sizeof **from);
    if (!*list || !*from)
        return STATUS_MEMORY;
    for (uint32_t at = 0; at < treelets->order_count; at++)
        (*from)[treelets->of[treelets->order[at]] + 2]++;
    for (uint32_t i = 2; i < treelets->count + 2; i++)
        (*from)[i] += (*from)[i - 1];
    for (uint32_t at = 0; at < treelets->order_count; at++) {
        uint32_t ref = treelets->order[at];
        (*list)[(*from)[treelets->of[ref] + 1]++] = ref;
    }
    return STATUS_OK;
}

enum status treelets_runs(struct scene_treelets *treelets, struct touch *touch,
                          struct reason *reason)
{
    struct treelet_bursts bursts = {.at = NULL};
    uint32_t *list;
    size_t *from;
    enum status status = by_treelet(treelets, &list, &from);
    treelets->first = alloc_zeroed((size_t)treelets->count + 1, sizeof *treelets->first);
    status = treelets->first ? status : STATUS_MEMORY;
    touch_read_fn *read = touch->read;
    void *reader = touch->reader;
    touch->read = add_bursts;
    touch->reader = &bursts;
    for (uint32_t i = 0; i < treelets->count && !status; i++) {
        bursts.count = 0;
        for (size_t at = from[i]; at < from[i + 1]; at++) {
            struct wide node;
            touch->packed.layout->load(&touch->packed, list[at], &node);
            if (i == 0 && list[at] == touch->real->root)
                (void)touch->packed.layout->box(&touch->packed, list[at]);
            if (node.child_count == 0)
                read_items(touch, &node);
        }
        status = bursts.failed ? STATUS_MEMORY : add_runs(treelets, &bursts);
        treelets->first[i + 1] = treelets->run_count;
    }
    touch->read = read;
    touch->reader = reader;
    free(bursts.at);
    free(list);
    free(from);
    return status ? fail(reason, status, "no memory for what %u treelets read", treelets->count)
                  : STATUS_OK;
}

void treelets_free(struct scene_treelets *treelets)
{
    free(treelets->of);
    free(treelets->parent);
    free(treelets->root);
    free(treelets->bytes);
    free(treelets->first);
    free(treelets->run);
    free(treelets->order);
    *treelets = (struct scene_treelets){0};
}
