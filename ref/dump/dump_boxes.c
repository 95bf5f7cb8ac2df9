/* Boxes of a dump against the triangles below them. Bounds and vertices are floats, so what is said
 * of them is exact. */
#include "ref/dump/dump_walk.h"
#include "ref/tree/cover.h"
#include "ref/tree/tree_quality.h"

#include <math.h>
#include <stdlib.h>

/* The exact bounds of what is below a node, and which triangle reaches so far; without a scene,
 * which leaf. */
struct dump_reach {
    struct box box;
    uint32_t owner[6];
};

static struct dump_reach reach_none(void)
{
    struct dump_reach none = {.box = box_empty()};
    for (int side = 0; side < 6; side++)
        none.owner[side] = DUMP_NONE;
    return none;
}

/* A bound that is no number reaches nowhere. */
static void reach_add(struct dump_reach *reach, const struct box *box, const uint32_t owner[6])
{
    for (int k = 0; k < 3; k++) {
        if (owner[k] != DUMP_NONE &&
            (reach->owner[k] == DUMP_NONE || box->lo[k] < reach->box.lo[k]) && !isnan(box->lo[k])) {
            reach->box.lo[k] = box->lo[k];
            reach->owner[k] = owner[k];
        }
        if (owner[3 + k] != DUMP_NONE &&
            (reach->owner[3 + k] == DUMP_NONE || box->hi[k] > reach->box.hi[k]) &&
            !isnan(box->hi[k])) {
            reach->box.hi[k] = box->hi[k];
            reach->owner[3 + k] = owner[3 + k];
        }
    }
}

static void reach_one(struct dump_reach *reach, const struct box *box, uint32_t owner)
{
    const uint32_t all[6] = {owner, owner, owner, owner, owner, owner};
    reach_add(reach, box, all);
}

/* What a leaf itself reaches. */
static void reach_leaf(const struct dump_walk *walk, const struct scene *scene, uint32_t place,
                       struct dump_reach *reach)
{
    const uint32_t node = walk->order[place];
    if (!scene && walk->dump->node[node].count > 0)
        reach_one(reach, &walk->dump->node[node].box, node);
    for (uint32_t i = walk->first[place]; scene && i < walk->end[place]; i++) {
        const struct box box = scene_tri_bounds(scene, walk->prim[i]);
        reach_one(reach, &box, walk->prim[i]);
    }
}

static float bound_of(const struct box *box, unsigned side)
{
    return side < 3 ? box->lo[side] : box->hi[side - 3];
}

/* Compares each side. Returns whether one is larger than need be. */
static bool compare(const struct dump_walk *walk, uint32_t node, const struct dump_reach *reach,
                    bool scene, struct dump_notes *notes)
{
    const struct box *box = &walk->dump->node[node].box;
    bool small = false, loose = false;
    for (unsigned side = 0; side < 6; side++) {
        const float bound = bound_of(box, side), needs = bound_of(&reach->box, side);
        if (reach->owner[side] == DUMP_NONE || isnan(bound))
            continue;
        loose = loose || (side < 3 ? bound < needs : bound > needs);
        if (side < 3 ? bound <= needs : bound >= needs)
            continue;
        small = true;
        dump_note(notes, &(struct dump_fault){.rule = DUMP_SMALL,
                                              .node = node,
                                              .child = scene ? DUMP_NONE : reach->owner[side],
                                              .triangle = scene ? reach->owner[side] : DUMP_NONE,
                                              .side = side,
                                              .bound = bound,
                                              .needs = needs});
    }
    notes->report->small_boxes += small;
    return loose;
}

/* Notes the first bound of a node that is no number. */
static void note_nan(const struct dump_walk *walk, uint32_t node, struct dump_notes *notes)
{
    for (unsigned side = 0; side < 6; side++)
        if (isnan(bound_of(&walk->dump->node[node].box, side))) {
            dump_note(notes, &(struct dump_fault){.rule = DUMP_NAN,
                                                  .node = node,
                                                  .child = DUMP_NONE,
                                                  .triangle = DUMP_NONE,
                                                  .side = side});
            return;
        }
}

/* The cost of a node's box, relative to the root's. */
static double cost_of(const struct dump_node *node, const struct box *box)
{
    return (node->leaf ? QUALITY_TRIANGLE * node->count : QUALITY_NODE) *
           box_half_area_or_none(box);
}

/* Compares in the order of the nodes' numbers; sums the cost of exact boxes. */
static void compare_all(const struct dump_walk *walk, const struct dump_reach *reach, bool scene,
                        struct dump_notes *notes)
{
    const double root = box_half_area_or_none(&reach[0].box);
    double sum = 0;
    for (uint32_t node = 0; node < walk->dump->node_count; node++) {
        const struct dump_node *of = &walk->dump->node[node];
        if (walk->depth[node] == DUMP_NONE || reach[node].owner[0] == DUMP_NONE)
            continue;
        if (scene || !of->leaf) {
            notes->report->judged++;
            notes->report->loose += compare(walk, node, &reach[node], scene, notes);
        }
        sum += cost_of(of, &reach[node].box);
    }
    notes->report->sah_tight = root > 0 ? sum / root : 0;
}

static enum status check_exact(const struct dump_walk *walk, const struct scene *scene,
                               struct dump_notes *notes)
{
    struct dump_reach *reach = alloc_zeroed(walk->dump->node_count, sizeof *reach);
    if (!reach)
        return STATUS_MEMORY;
    for (size_t i = 0; i < walk->dump->node_count; i++)
        reach[i] = reach_none();
    for (uint32_t place = walk->count; place-- > 0;) {
        const uint32_t node = walk->order[place], up = walk->parent[node];
        if (walk->dump->node[node].leaf)
            reach_leaf(walk, scene, place, &reach[node]);
        if (up != DUMP_NONE)
            reach_add(&reach[up], &reach[node].box, reach[node].owner);
    }
    compare_all(walk, reach, scene != NULL, notes);
    free(reach);
    return STATUS_OK;
}

/* A tree that splits, as cover_check takes it. */
struct dump_cover {
    const struct dump_walk *walk;
    const struct scene *scene;
    struct cover_node *node;
};

/* Checks the tree with its boxes grown by so many floats on each side. */
static enum status cover_grown(const struct dump_cover *cover, uint32_t by,
                               struct cover_faults *found)
{
    const struct dump_walk *walk = cover->walk;
    for (uint32_t i = 0; i < walk->count; i++)
        for (int k = 0; k < 3; k++) {
            const struct box *box = &walk->dump->node[walk->order[i]].box;
            cover->node[i].box.lo[k] = dump_step(box->lo[k], -(int32_t)by);
            cover->node[i].box.hi[k] = dump_step(box->hi[k], (int32_t)by);
        }
    return cover_check(&(struct cover_tree){cover->node, walk->prim, walk->count}, cover->scene,
                       found);
}

/* The least growth that covers all; without growth it does not. */
static enum status find_gap(const struct dump_cover *cover, uint32_t *out)
{
    struct cover_faults found;
    uint32_t bad = 0, good = DUMP_GAP_MOST;
    enum status status = cover_grown(cover, good, &found);
    if (status || found.prims) {
        *out = DUMP_NONE;
        return status;
    }
    while (!status && bad + 1 < good) {
        const uint32_t middle = bad + (good - bad) / 2;
        status = cover_grown(cover, middle, &found);
        *(found.prims ? &bad : &good) = middle;
    }
    *out = good;
    return status;
}

/* The boxes of its leaves must cover each triangle together. */
static enum status find_uncovered(const struct dump_cover *cover, struct dump_notes *notes)
{
    struct cover_faults found = {0};
    enum status status = cover_grown(cover, 0, &found);
    if (status || found.prims == 0)
        return status;
    dump_note(notes, &(struct dump_fault){.rule = DUMP_UNCOVERED,
                                          .node = cover->walk->order[found.node],
                                          .child = DUMP_NONE,
                                          .triangle = found.prim});
    notes->report->count[DUMP_UNCOVERED] = found.prims;
    notes->report->faults += found.prims - 1;
    return find_gap(cover, &notes->report->gap);
}

static enum status check_cover(const struct dump_walk *walk, const struct scene *scene,
                               struct dump_notes *notes)
{
    uint32_t *place = alloc_zeroed(walk->dump->node_count, sizeof *place);
    struct cover_node *node = alloc_zeroed(walk->count, sizeof *node);
    enum status status = place && node ? STATUS_OK : STATUS_MEMORY;
    for (uint32_t i = 0; i < walk->count && !status; i++) {
        const uint32_t of = walk->order[i], up = walk->parent[of];
        const bool leaf = walk->dump->node[of].leaf;
        place[of] = i;
        node[i] = (struct cover_node){.parent = up == DUMP_NONE ? 0 : place[up],
                                      .item_first = walk->first[i],
                                      .item_count = leaf ? walk->end[i] - walk->first[i] : 0};
    }
    if (!status)
        status = find_uncovered(&(struct dump_cover){walk, scene, node}, notes);
    free(place);
    free(node);
    return status;
}

enum status dump_boxes(const struct dump_walk *walk, const struct scene *scene,
                       struct dump_notes *notes)
{
    for (uint32_t node = 0; node < walk->dump->node_count; node++)
        if (walk->depth[node] != DUMP_NONE)
            note_nan(walk, node, notes);
    if (!walk->dump->splits)
        return check_exact(walk, scene, notes);
    return scene ? check_cover(walk, scene, notes) : STATUS_OK;
}
