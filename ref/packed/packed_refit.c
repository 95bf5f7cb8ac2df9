#include "ref/packed/packed_walk.h"
#include "ref/packed/refit.h"
#include "ref/store.h"

#include <stdlib.h>
#include <string.h>

/* An inner node whose children are being visited; children before `next` have their new boxes. */
struct open {
    struct wide node;
    struct box own; /* of these children */
    uint32_t ref, next;
};

/* A leaf's items. */
struct items {
    uint32_t first, count;
};

/* A refit in progress: one depth-first walk that reads every record once and writes it when
 * everything below it is known. Reads from `from` and writes to `to`, which has its own words. */
struct refit {
    const struct packed *from;
    struct packed to;
    const struct scene *scene;
    bool *seen;        /* of each reference: it was visited */
    struct open *open; /* stack, from the root down */
    size_t open_count, open_room;
    struct items *leaf; /* leaves for the storage to write */
    size_t leaf_count, leaf_room;
    uint32_t *prim;    /* room for the items of a leaf */
    enum status limit; /* STATUS_LIMIT: must be rebuilt, unless the walk finds a worse error */
    struct wide named; /* a leaf of these items: argument of packed_item */
    struct reason why;
    struct reason *reason;
};

static bool stores_vertices(const struct packed *packed)
{
    return !packed->layout->item && !tri_store_reads_scene(packed->store);
}

/* --- leaves ----------------------------------------------------------------------------------- */

static enum status add_triangle(struct refit *refit, uint32_t ref, uint32_t prim, struct box *box)
{
    const char *name = refit->from->layout->name;
    float v[3][3];
    bool finite = true;
    if (prim >= refit->scene->tri_count)
        return fail(refit->reason, STATUS_INPUT, "%s: %s names triangle %u of %u", name,
                    packed_name(refit->from, ref).text, prim, refit->scene->tri_count);
    scene_tri(refit->scene, prim, v);
    for (int c = 0; c < 3; c++) {
        for (int k = 0; k < 3; k++)
            finite = finite & float_is_finite(v[c][k]);
        box_add_point(box, v[c]);
    }
    if (!finite)
        return fail(refit->reason, STATUS_INPUT, "%s: triangle %u has a vertex that is not finite",
                    name, prim);
    return STATUS_OK;
}

static enum status leaf_bounds(struct refit *refit, uint32_t ref, struct items leaf,
                               struct box *box)
{
    const char *name = refit->from->layout->name;
    bool found = false;
    if (leaf.count > refit->scene->tri_count)
        return fail(refit->reason, STATUS_INPUT, "%s: %s: a leaf of %u items for %u triangles",
                    name, packed_name(refit->from, ref).text, leaf.count, refit->scene->tri_count);
    *box = box_empty();
    refit->named.item_first = leaf.first;
    for (uint32_t s = 0; s < leaf.count; s++) {
        uint32_t prim = packed_item(refit->from, &refit->named, s);
        if (prim == ABI_NO_PRIM)
            continue;
        enum status status = add_triangle(refit, ref, prim, box);
        if (status)
            return status;
        found = true;
    }
    if (!found)
        return fail(refit->reason, STATUS_INPUT, "%s: %s is a leaf without triangles", name,
                    packed_name(refit->from, ref).text);
    if (!stores_vertices(refit->from))
        return STATUS_OK;
    enum status status =
        array_reserve(&refit->leaf, &refit->leaf_room, refit->leaf_count + 1, sizeof *refit->leaf);
    if (!status)
        refit->leaf[refit->leaf_count++] = leaf;
    return status;
}

/* --- nodes ------------------------------------------------------------------------------------ */

static enum status no_tree(const struct refit *refit, uint32_t ref)
{
    return fail(refit->reason, STATUS_INPUT, "%s: %s: the words are not a tree",
                refit->from->layout->name, packed_name(refit->from, ref).text);
}

/* If a node cannot be written, the tree must be rebuilt, unless the walk finds that it is no
 * tree. */
static void write_node(struct refit *refit, uint32_t ref, const struct box *own,
                       const struct wide *node)
{
    if (refit->limit)
        return;
    refit->limit = refit->from->layout->rebound(&refit->to, ref, own, node, &refit->why);
    if (refit->limit)
        (void)fail(refit->reason, refit->limit, "rebuild: %s", refit->why.text);
}

/* Enters a node. A leaf with a record is finished at once, and its box is in *box; others are
 * opened. */
static enum status enter(struct refit *refit, uint32_t ref, struct box *box, bool *opened)
{
    const struct layout *layout = refit->from->layout;
    struct wide node;
    *opened = false;
    if (!packed_ref_valid(refit->from, ref) || refit->seen[ref])
        return no_tree(refit, ref);
    refit->seen[ref] = true;
    layout->load(refit->from, ref, &node);
    if (node.child_count == 0 && node.item_count > 0 && !layout_is_wide(layout)) {
        enum status status =
            leaf_bounds(refit, ref, (struct items){node.item_first, node.item_count}, box);
        if (!status)
            write_node(refit, ref, box, &node);
        return status;
    }
    if (node.child_count < (layout_is_wide(layout) ? 1 : 2))
        return no_tree(refit, ref);
    enum status status =
        array_reserve(&refit->open, &refit->open_room, refit->open_count + 1, sizeof *refit->open);
    if (status)
        return status;
    refit->open[refit->open_count++] = (struct open){node, box_empty(), ref, 0};
    *opened = true;
    return STATUS_OK;
}

static void give_box(struct open *open, const struct box *box)
{
    box_add_box(&open->own, box);
    open->node.box[open->next++] = *box;
}

/* Finishes the innermost node, whose children are all known. */
static void leave(struct refit *refit)
{
    const struct open *open = &refit->open[--refit->open_count];
    write_node(refit, open->ref, &open->own, &open->node);
    if (refit->open_count > 0)
        give_box(&refit->open[refit->open_count - 1], &open->own);
}

static enum status write_bounds(struct refit *refit)
{
    bool wide = layout_is_wide(refit->from->layout), opened;
    struct box box;
    enum status status = enter(refit, refit->from->root, &box, &opened);
    while (refit->open_count > 0 && !status) {
        struct open *open = &refit->open[refit->open_count - 1];
        uint32_t c = open->next;
        if (c == open->node.child_count) {
            leave(refit);
            continue;
        }
        opened = false;
        if (wide && open->node.leaf_count[c] > 0)
            status = leaf_bounds(refit, open->node.child[c],
                                 (struct items){open->node.leaf_first[c], open->node.leaf_count[c]},
                                 &box);
        else
            status = enter(refit, open->node.child[c], &box, &opened);
        if (!status && !opened)
            give_box(&refit->open[refit->open_count - 1], &box);
    }
    return status ? status : refit->limit;
}

/* --- vertices in the storage ------------------------------------------------------------------ */

static int by_place(const void *a, const void *b)
{
    const struct items *x = a, *y = b;
    return order_numbers(x->first, y->first);
}

/* Writes a leaf whose words extend to `end`. */
static enum status write_leaf(struct refit *refit, struct items leaf, uint32_t end)
{
    const struct tri_store *store = refit->to.store;
    uint32_t count = 0, room = end > leaf.first ? end - leaf.first : 0;
    uint64_t words;
    refit->named.item_first = leaf.first;
    for (uint32_t s = 0; s < leaf.count; s++) {
        uint32_t prim = packed_item(refit->from, &refit->named, s);
        if (prim != ABI_NO_PRIM)
            refit->prim[count++] = prim;
    }
    enum status status =
        store->measure(&refit->to, refit->scene, refit->prim, count, &words, &refit->why);
    if (status)
        return fail(refit->reason, status, "rebuild: %s", refit->why.text);
    if (words > room)
        return fail(refit->reason, STATUS_LIMIT,
                    "rebuild: storage %s: the leaf of triangle %u needs %llu words, it has %u",
                    store->name, refit->prim[0], (unsigned long long)words, room);
    store->write(&refit->to, refit->scene, refit->prim, count, refit->to.item + leaf.first);
    return STATUS_OK;
}

/* From the last to the first, so that the start of the following leaf is known. */
static enum status write_leaves(struct refit *refit)
{
    enum status status = STATUS_OK;
    uint32_t end = refit->to.item_count;
    if (refit->leaf)
        qsort(refit->leaf, refit->leaf_count, sizeof *refit->leaf, by_place);
    for (size_t i = refit->leaf_count; i-- > 0 && !status;) {
        status = write_leaf(refit, refit->leaf[i], end);
        if (i > 0 && refit->leaf[i - 1].first < refit->leaf[i].first && refit->leaf[i].first < end)
            end = refit->leaf[i].first;
    }
    return status;
}

/* --- the refit -------------------------------------------------------------------------------- */

static enum status may_refit(const struct packed *packed, const struct scene *scene,
                             struct reason *reason)
{
    const char *name = packed->layout->name;
    if (packed->tri_count != scene->tri_count)
        return fail(reason, STATUS_INPUT, "%s: the tree holds %u triangles, the scene has %u", name,
                    packed->tri_count, scene->tri_count);
    if (!packed->layout->rebound)
        return fail(reason, STATUS_LIMIT, "rebuild: layout %s is not refitted", name);
    if (packed->store->lossy)
        return fail(reason, STATUS_LIMIT, "rebuild: storage %s is of one scene's %s",
                    packed->store->name, packed->store->head ? "grid" : "bits");
    if (packed->split)
        return fail(reason, STATUS_LIMIT,
                    "rebuild: the tree is split, its boxes of parts of triangles cannot be "
                    "refitted");
    return STATUS_OK;
}

static enum status make(struct refit *refit)
{
    const struct packed *from = refit->from;
    bool vertices = stores_vertices(from);
    refit->seen = alloc_zeroed(from->ref_count, sizeof *refit->seen);
    refit->to.word = alloc_copy(from->word, from->word_count, sizeof *from->word);
    if (vertices) {
        refit->prim = alloc_zeroed(refit->scene->tri_count, sizeof *refit->prim);
        refit->to.item = alloc_copy(from->item, from->item_count, sizeof *from->item);
    }
    if (!refit->seen || !refit->to.word || (vertices && !(refit->prim && refit->to.item)))
        return STATUS_MEMORY;
    enum status status = write_bounds(refit);
    return status || !vertices ? status : write_leaves(refit);
}

enum status packed_refit(struct packed *packed, const struct scene *scene, struct reason *reason)
{
    enum status status = may_refit(packed, scene, reason);
    if (status || packed->node_count == 0)
        return status;
    struct refit refit = {.from = packed, .to = *packed, .scene = scene, .reason = reason};
    refit.to.word = refit.to.item = NULL;
    status = make(&refit);
    if (status == STATUS_MEMORY)
        (void)fail(reason, status, "%s: no memory to refit %u records", packed->layout->name,
                   packed->node_count);
    if (!status) {
        free(packed->word);
        packed->word = refit.to.word;
        refit.to.word = NULL;
        if (stores_vertices(packed)) {
            free(packed->item);
            packed->item = refit.to.item;
            refit.to.item = NULL;
        }
    }
    free(refit.seen);
    free(refit.open);
    free(refit.leaf);
    free(refit.prim);
    free(refit.to.word);
    free(refit.to.item);
    return status;
}
