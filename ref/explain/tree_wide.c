/* Nodes of a wide packed tree beside those of the binary tree that it was collapsed from: the same
 * triangles below. */
#include "ref/explain/tree.h"

#include "ref/packed/packed_walk.h"
#include "ref/store.h"

#include <stdlib.h>

/* Places in the binary tree's item array: those below a node of it follow each other. */
struct wide_range {
    uint32_t first, last, count; /* count 0: nothing */
};

static void range_add(struct wide_range *range, const struct wide_range *more)
{
    if (more->count == 0)
        return;
    if (range->count == 0 || more->first < range->first)
        range->first = more->first;
    if (range->count == 0 || more->last > range->last)
        range->last = more->last;
    range->count += more->count;
}

/* Where in the tree's items each triangle is: the last place, and of each place of a split tree the
 * one before it and its leaf. */
struct wide_places {
    uint32_t *last;   /* per triangle */
    uint32_t *before; /* per place, or EXPLAIN_NONE */
    uint32_t *leaf;   /* per place */
};

static bool make_places(const struct explain_tree *tree, struct wide_places *out)
{
    const struct bvh *bvh = tree->bvh;
    out->last = alloc_zeroed(tree->scene->tri_count, sizeof *out->last);
    out->before = alloc_zeroed(bvh->prim_count, sizeof *out->before);
    out->leaf = alloc_zeroed(bvh->prim_count, sizeof *out->leaf);
    if (!out->last || !out->before || !out->leaf)
        return false;
    for (uint32_t i = 0; i < tree->scene->tri_count; i++)
        out->last[i] = EXPLAIN_NONE;
    for (uint32_t i = 0; i < bvh->node_count; i++)
        for (uint32_t k = 0; k < bvh->node[i].item_count; k++) {
            uint32_t at = bvh->node[i].item_first + k, prim = bvh->prim[at];
            out->before[at] = out->last[prim];
            out->leaf[at] = i;
            out->last[prim] = at;
        }
    return true;
}

static void free_places(struct wide_places *places)
{
    free(places->last);
    free(places->before);
    free(places->leaf);
}

/* The place of a triangle that a leaf with this box refers to: the last whose own leaf has its
 * middle in the box, or the last of all. */
static uint32_t place_of(const struct explain_tree *tree, const struct wide_places *places,
                         uint32_t prim, const struct box *box)
{
    for (uint32_t at = places->last[prim]; at != EXPLAIN_NONE; at = places->before[at]) {
        const struct box *own = &tree->bvh->node[places->leaf[at]].bounds;
        bool within = true;
        for (int k = 0; k < 3; k++) {
            float middle = 0.5f * own->lo[k] + 0.5f * own->hi[k];
            within &= box->lo[k] <= middle && middle <= box->hi[k];
        }
        if (within)
            return at;
    }
    return places->last[prim];
}

/* The range below every visit of the packed tree, children after their parents. */
static void find_ranges(const struct explain_tree *tree, const struct packed_walk *walk,
                        const struct wide_places *places, struct wide_range *range)
{
    const struct packed *packed = tree->packed;
    for (uint32_t v = walk->visit_count; v-- > 0;) {
        struct wide wide;
        packed->layout->load(packed, walk->visit[v].ref, &wide);
        for (uint32_t s = 0; wide.child_count == 0 && s < wide.item_count; s++) {
            uint32_t prim = packed_item(packed, &wide, s);
            if (prim >= tree->scene->tri_count)
                continue;
            uint32_t place = place_of(tree, places, prim, &walk->visit[v].box);
            const struct wide_range one = {place, place, 1};
            range_add(&range[v], &one);
        }
        if (v > 0)
            range_add(&range[walk->visit[v].parent], &range[v]);
    }
}

/* The node of the binary tree with these items, from the root down, or EXPLAIN_NONE. `end` has the
 * place behind the last item of each node. */
static uint32_t node_of_range(const struct bvh *bvh, const uint32_t *end,
                              const struct wide_range *range)
{
    uint32_t node = 0, first = 0;
    if (range->count == 0 || range->last - range->first + 1 != range->count)
        return EXPLAIN_NONE;
    for (;;) {
        if (first == range->first && end[node] == range->last + 1)
            return node;
        if (bvh->node[node].item_count > 0)
            return EXPLAIN_NONE;
        if (range->first >= end[bvh->node[node].fst]) {
            first = end[bvh->node[node].fst];
            node = bvh->node[node].snd;
        } else {
            node = bvh->node[node].fst;
        }
    }
}

enum status explain_map_wide(struct explain_tree *tree)
{
    const struct bvh *bvh = tree->bvh;
    struct packed_walk walk;
    enum status status = packed_walk_make(tree->packed, &walk);
    struct wide_places places = {0};
    bool placed = make_places(tree, &places);
    uint32_t *end = alloc_zeroed(bvh->node_count, sizeof *end);
    struct wide_range *range = alloc_zeroed(walk.visit_count, sizeof *range);
    tree->box = alloc_zeroed(bvh->node_count, sizeof *tree->box);
    if (!status && (!placed || !end || !range || !tree->box))
        status = STATUS_MEMORY;
    if (!status) {
        find_ranges(tree, &walk, &places, range);
        for (uint32_t i = bvh->node_count; i-- > 0;) {
            const struct bvh_node *node = &bvh->node[i];
            end[i] = node->item_count ? node->item_first + node->item_count : end[node->snd];
        }
        for (uint32_t v = 0; v < walk.visit_count; v++) {
            uint32_t node = node_of_range(bvh, end, &range[v]);
            if (node == EXPLAIN_NONE)
                continue;
            tree->node[walk.visit[v].ref] = node;
            if (tree->record[node] != EXPLAIN_NONE)
                continue; /* the root's only child */
            tree->record[node] = walk.visit[v].ref;
            tree->box[node] = walk.visit[v].box;
        }
    }
    packed_walk_free(&walk);
    free_places(&places);
    free(end);
    free(range);
    return status;
}
