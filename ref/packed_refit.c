#include "ref/mutant.h"
#include "ref/packed_walk.h"
#include "ref/refit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A refit at work: everything is read from `from` and written to `to`, which has words of its own.
 */
struct refit {
    const struct packed *from;
    struct packed to;
    const struct scene *scene;
    struct packed_walk walk;
    struct box *exact;   /* of each visit */
    bool *leaf;          /* likewise */
    uint32_t *first;     /* of each leaf that the storage is to write, sorted */
    uint32_t leaf_count; /* of them */
    uint32_t *prim;      /* room for those of a leaf */
    struct reason *reason;
};

/* Slots that a leaf can have: as many as triangles, or, of a fixed size, 8. */
static uint32_t slots_most(const struct refit *refit)
{
    return refit->scene->tri_count < 8 ? 8 : refit->scene->tri_count;
}

static bool stores_vertices(const struct packed *packed)
{
    return !packed->layout->item && !tri_store_reads_scene(packed->store);
}

/* --- what is there ---------------------------------------------------------------------------- */

static enum status leaf_bounds(struct refit *refit, uint32_t i, const struct wide *leaf)
{
    const char *name = refit->from->layout->name;
    uint32_t ref = refit->walk.visit[i].ref, found = 0;
    if (leaf->item_count > slots_most(refit))
        return fail(refit->reason, STATUS_INPUT,
                    "%s: record %u: a leaf of %u items for %u triangles", name, ref,
                    leaf->item_count, refit->scene->tri_count);
    for (uint32_t s = 0; s < leaf->item_count; s++) {
        uint32_t prim = packed_item(refit->from, leaf, s);
        float v[3][3];
        if (prim == ABI_NO_PRIM)
            continue;
        if (prim >= refit->scene->tri_count)
            return fail(refit->reason, STATUS_INPUT, "%s: record %u names triangle %u of %u", name,
                        ref, prim, refit->scene->tri_count);
        scene_tri(refit->scene, prim, v);
        for (int c = 0; c < 3; c++) {
            for (int k = 0; k < 3; k++)
                if (!float_is_finite(v[c][k]))
                    return fail(refit->reason, STATUS_INPUT,
                                "%s: triangle %u has a vertex that is not finite", name, prim);
            box_add_point(&refit->exact[i], v[c]);
        }
        found++;
    }
#if MUTANT == MUTANT_REFIT_ULP
    refit->exact[i].hi[0] = nextafterf(refit->exact[i].hi[0], refit->exact[i].lo[0]);
#endif
    if (found == 0)
        return fail(refit->reason, STATUS_INPUT, "%s: record %u is a leaf without triangles", name,
                    ref);
    return STATUS_OK;
}

/* From the last visit to the first, so that children are before their parent. */
static enum status find_bounds(struct refit *refit)
{
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i < refit->walk.visit_count; i++)
        refit->exact[i] = box_empty();
    for (uint32_t i = refit->walk.visit_count; i-- > 0 && !status;) {
        struct wide node;
        refit->from->layout->load(refit->from, refit->walk.visit[i].ref, &node);
        refit->leaf[i] = node.child_count == 0;
        if (refit->leaf[i]) {
            status = leaf_bounds(refit, i, &node);
            if (stores_vertices(refit->from))
                refit->first[refit->leaf_count++] = node.item_first;
        }
        if (i > 0)
            box_add_box(&refit->exact[refit->walk.visit[i].parent], &refit->exact[i]);
    }
    return status;
}

/* --- what is written -------------------------------------------------------------------------- */

/* A walk has the children of a node one after the other, those of the last node last. */
static enum status write_bounds(struct refit *refit)
{
    const struct layout *layout = refit->from->layout;
    uint32_t end = refit->walk.visit_count;
    enum status status = STATUS_OK;
    for (uint32_t i = refit->walk.visit_count; i-- > 0 && !status;) {
        struct wide node;
        struct reason why = {""};
        if (refit->leaf[i] && layout_is_wide(layout))
            continue;
        layout->load(refit->from, refit->walk.visit[i].ref, &node);
        end -= node.child_count;
        for (uint32_t c = 0; c < node.child_count; c++)
            node.box[c] = refit->exact[end + c];
#if MUTANT == MUTANT_REFIT_LEVEL
        if (i > 0 && refit->walk.visit[i].parent == 0)
            continue;
#endif
        status =
            layout->rebound(&refit->to, refit->walk.visit[i].ref, &refit->exact[i], &node, &why);
        if (status)
            (void)fail(refit->reason, status, "rebuild: %s", why.text);
    }
    return status;
}

static int by_number(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* Words up to where the next leaf begins. */
static uint32_t room_at(const struct refit *refit, uint32_t first)
{
    uint32_t low = 0, high = refit->leaf_count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (refit->first[middle] <= first)
            low = middle + 1;
        else
            high = middle;
    }
    uint32_t end = refit->to.item_count;
    if (low < refit->leaf_count && refit->first[low] < end)
        end = refit->first[low];
    return end > first ? end - first : 0;
}

static enum status write_leaf(struct refit *refit, const struct wide *leaf)
{
    const struct tri_store *store = refit->to.store;
    uint32_t count = 0;
    uint64_t words;
    struct reason why = {""};
    for (uint32_t s = 0; s < leaf->item_count; s++) {
        uint32_t prim = packed_item(refit->from, leaf, s);
        if (prim != ABI_NO_PRIM)
            refit->prim[count++] = prim;
    }
    enum status status = store->measure(&refit->to, refit->scene, refit->prim, count, &words, &why);
    if (status)
        return fail(refit->reason, status, "rebuild: %s", why.text);
    if (words > room_at(refit, leaf->item_first))
        return fail(refit->reason, STATUS_LIMIT,
                    "rebuild: storage %s: the leaf of triangle %u needs %llu words, it has %u",
                    store->name, refit->prim[0], (unsigned long long)words,
                    room_at(refit, leaf->item_first));
#if MUTANT != MUTANT_REFIT_VERTICES_OLD
    store->write(&refit->to, refit->scene, refit->prim, count, refit->to.item + leaf->item_first);
#endif
    return STATUS_OK;
}

/* Of a storage that has vertices. */
static enum status write_leaves(struct refit *refit)
{
    enum status status = STATUS_OK;
    qsort(refit->first, refit->leaf_count, sizeof *refit->first, by_number);
    for (uint32_t i = 0; i < refit->walk.visit_count && !status; i++) {
        struct wide node;
        if (!refit->leaf[i])
            continue;
        refit->from->layout->load(refit->from, refit->walk.visit[i].ref, &node);
        status = write_leaf(refit, &node);
    }
    return status;
}

/* --- all of it -------------------------------------------------------------------------------- */

static enum status may_refit(const struct packed *packed, const struct scene *scene,
                             struct reason *reason)
{
    const char *name = packed->layout->name;
    if (packed->tri_count != scene->tri_count)
        return fail(reason, STATUS_INPUT, "%s: the tree holds %u triangles, the scene has %u", name,
                    packed->tri_count, scene->tri_count);
    if (!packed->layout->rebound)
        return fail(reason, STATUS_LIMIT, "rebuild: layout %s is not refitted", name);
    if (packed->store->head)
        return fail(reason, STATUS_LIMIT, "rebuild: storage %s is of one scene's grid",
                    packed->store->name);
    if (packed->split)
        return fail(reason, STATUS_LIMIT,
                    "rebuild: the tree is split, its boxes of parts of triangles cannot be "
                    "refitted");
    return STATUS_OK;
}

/* A copy of `count` words; NULL without memory. */
static uint32_t *copy_of(const uint32_t *word, uint32_t count)
{
    uint32_t *copy = alloc_zeroed(count, sizeof *copy);
    if (copy && count > 0)
        memcpy(copy, word, count * sizeof *copy);
    return copy;
}

static enum status make(struct refit *refit)
{
    const struct packed *from = refit->from;
    bool vertices = stores_vertices(from);
    if (packed_walk_make(from, &refit->walk))
        return STATUS_MEMORY;
    if (refit->walk.repeats > 0 || refit->walk.bad_refs > 0)
        return fail(refit->reason, STATUS_INPUT, "%s: record %u: the words are no tree",
                    from->layout->name,
                    refit->walk.repeats > 0 ? refit->walk.repeat_ref : refit->walk.bad_ref);
    refit->exact = alloc_zeroed(refit->walk.visit_count, sizeof *refit->exact);
    refit->leaf = alloc_zeroed(refit->walk.visit_count, sizeof *refit->leaf);
    refit->first = alloc_zeroed(vertices ? refit->walk.visit_count : 0, sizeof *refit->first);
    refit->prim = alloc_zeroed(vertices ? slots_most(refit) : 0, sizeof *refit->prim);
    refit->to.word = copy_of(from->word, from->word_count);
    refit->to.item = copy_of(vertices ? from->item : NULL, vertices ? from->item_count : 0);
    if (!refit->exact || !refit->leaf || !refit->first || !refit->prim || !refit->to.word ||
        !refit->to.item)
        return STATUS_MEMORY;
    enum status status = find_bounds(refit);
    if (!status)
        status = write_bounds(refit);
    if (!status && vertices)
        status = write_leaves(refit);
    return status;
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
#if MUTANT == MUTANT_REFIT_HALF
    if (!status || (status == STATUS_LIMIT && refit.to.word)) {
#else
    if (!status) {
#endif
        free(packed->word);
        packed->word = refit.to.word;
        refit.to.word = NULL;
        if (stores_vertices(packed)) {
            free(packed->item);
            packed->item = refit.to.item;
            refit.to.item = NULL;
        }
    }
    packed_walk_free(&refit.walk);
    free(refit.exact);
    free(refit.leaf);
    free(refit.first);
    free(refit.prim);
    free(refit.to.word);
    free(refit.to.item);
    return status;
}
