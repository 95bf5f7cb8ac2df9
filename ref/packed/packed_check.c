#include "ref/tree/cover.h"
#include "ref/packed/packed_oblique.h"
#include "ref/packed/packed_unpack.h"
#include "ref/packed/packed_walk.h"
#include "ref/packed/packed_check.h"
#include "ref/store.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A check in progress; `exact` contains the bounds of the triangles below each visit. */
struct packed_check {
    const struct packed *packed;
    const struct scene *scene;
    const bool *left_out; /* triangles that no leaf may name, or NULL */
    struct packed_walk walk;
    struct packed_faults faults;
    struct box *exact;
    uint32_t *seen; /* per triangle: 0, or 1 plus the last visit that named it */
    struct reason *reason;
    enum status status; /* STATUS_INPUT once a fault is reported */
};

#define NO_VISIT UINT32_MAX

/* Reports a fault. The first is described in the reason: layout, node of the visit, text. */
static void report(struct packed_check *check, enum packed_rule rule, uint32_t visit,
                   const char *format, ...) PRINTF_LIKE(4, 5);

static void report(struct packed_check *check, enum packed_rule rule, uint32_t visit,
                   const char *format, ...)
{
    struct packed_name node = {""};
    struct reason text;
    va_list args;
    if (check->status)
        return;
    check->faults.first = rule;
    va_start(args, format);
    vsnprintf(text.text, sizeof text.text, format, args);
    va_end(args);
    if (visit != NO_VISIT)
        node = packed_name(check->packed, check->walk.visit[visit].ref);
    check->status = fail(check->reason, STATUS_INPUT, "%s: %s%s%s", check->packed->layout->name,
                         node.text, visit != NO_VISIT ? ": " : "", text.text);
}

static void check_walk(struct packed_check *check)
{
    const struct packed_walk *walk = &check->walk;
    check->faults.bad_refs = walk->bad_refs;
    check->faults.cycles = walk->repeats;
    check->faults.too_deep = walk->stack_most > check->packed->stack_need;
    if (walk->bad_refs > 0)
        report(check, PACKED_REFERENCE, NO_VISIT,
               "%s: a child reference lies outside the %u records",
               packed_name(check->packed, walk->bad_ref).text, check->packed->node_count);
    if (walk->repeats > 0)
        report(check, PACKED_REFERENCE, NO_VISIT, "%s is reached more than once",
               packed_name(check->packed, walk->repeat_ref).text);
    if (check->faults.too_deep)
        report(check, PACKED_STACK, NO_VISIT,
               "a path needs %u stack entries, the packed tree says %u", walk->stack_most,
               check->packed->stack_need);
}

/* Checks that the leaves of a split tree cover every part of every triangle. Decoded items are
 * copied: leaves that share items must not name more than the tree has bytes for. */
static enum status check_cover(struct packed_check *check)
{
    const struct packed *packed = check->packed;
    uint32_t visits = check->walk.visit_count, most = packed_prims_most(packed), items = 0;
    struct cover_faults faults = {0};
    struct cover_node *node = alloc_zeroed(visits, sizeof *node);
    uint32_t *item = alloc_zeroed(most, sizeof *item);
    bool fits = true;
    for (uint32_t i = 0; i < visits && node && item && fits; i++) {
        const struct packed_visit *visit = &check->walk.visit[i];
        struct wide wide;
        packed->layout->load(packed, visit->ref, &wide);
        node[i] = (struct cover_node){visit->box, visit->parent, items, 0};
        if (wide.child_count > 0)
            continue;
        fits = wide.item_count <= most - items;
        for (uint32_t s = 0; s < wide.item_count && fits; s++)
            item[items++] = packed_item(packed, &wide, s);
        node[i].item_count = items - node[i].item_first;
    }
    const struct cover_tree tree = {node, item, visits};
    enum status status = node && item ? STATUS_OK : STATUS_MEMORY;
    if (!status && fits)
        status = cover_check(&tree, check->scene, &faults);
    free(node);
    free(item);
    check->faults.bad_prims += !fits;
    check->faults.loose_boxes = faults.prims;
    if (!fits)
        report(check, PACKED_ITEM, NO_VISIT, "the leaves name more than %u triangles", most);
    if (faults.prims)
        report(check, PACKED_BOUND, faults.node,
               "a part of triangle %u is in no leaf's box below; %u triangles have such parts",
               faults.prim, faults.prims);
    return status;
}

/* Checks that vertices in the storage are those of the scene. */
static void check_stored(struct packed_check *check, uint32_t i, const struct wide *leaf,
                         uint32_t s, uint32_t prim)
{
    const struct packed *packed = check->packed;
    float stored[3][3], own[3][3];
    if (!packed->store->tri)
        return;
    scene_tri(check->scene, prim, own);
    if (packed->store->tri(packed, leaf->item_first, s, stored) &&
        memcmp(stored, own, sizeof own) == 0)
        return;
    check->faults.bad_tris++;
    report(check, PACKED_VERTICES, i, "storage %s has triangle %u with other vertices",
           packed->store->name, prim);
}

/* Marks the triangle of one item slot and adds it to the bounds of visit `i`. */
static void check_item(struct packed_check *check, uint32_t i, const struct wide *leaf, uint32_t s)
{
    const struct packed *packed = check->packed;
    const uint32_t slot = leaf->item_first + s, prim = packed_item(packed, leaf, s);
    if (prim == ABI_NO_PRIM)
        return;
    if (prim >= check->scene->tri_count) {
        check->faults.bad_prims++;
        report(check, PACKED_ITEM, i, "item slot %u names triangle %u of %u", slot, prim,
               check->scene->tri_count);
        return;
    }
    if (check->left_out && check->left_out[prim]) {
        check->faults.bad_prims++;
        report(check, PACKED_ITEM, i, "item slot %u names triangle %u, which is left out", slot,
               prim);
        return;
    }
    if (check->seen[prim] && (!packed->split || check->seen[prim] == i + 1)) {
        check->faults.double_prims++;
        report(check, PACKED_TWICE, i, "item slot %u names triangle %u a second time", slot, prim);
    }
    check->seen[prim] = i + 1;
    check_stored(check, i, leaf, s, prim);
    struct box one = scene_tri_bounds(check->scene, prim);
    box_add_box(&check->exact[i], &one);
}

/* Returns the number of slots of a leaf to check: hostile words can claim 2^32 - 1. Leaves of fixed
 * size can have up to 8 slots for fewer triangles. */
static uint32_t leaf_slots(struct packed_check *check, uint32_t i, const struct wide *node)
{
    uint32_t most = check->scene->tri_count < 8 ? 8 : check->scene->tri_count;
    if (node->item_count <= most)
        return node->item_count;
    check->faults.bad_prims++;
    report(check, PACKED_ITEM, i, "a leaf of %u items for %u triangles", node->item_count,
           check->scene->tri_count);
    return 0;
}

static void check_items(struct packed_check *check)
{
    for (uint32_t i = 0; i < check->walk.visit_count; i++) {
        struct wide node;
        check->packed->layout->load(check->packed, check->walk.visit[i].ref, &node);
        check->exact[i] = box_empty();
        if (node.child_count > 0)
            continue;
        uint32_t slots = leaf_slots(check, i, &node);
        for (uint32_t s = 0; s < slots; s++)
            check_item(check, i, &node, s);
    }
    for (uint32_t prim = 0; prim < check->scene->tri_count; prim++) {
        if (check->seen[prim] || (check->left_out && check->left_out[prim]))
            continue;
        check->faults.lost_prims++;
        report(check, PACKED_LOST, NO_VISIT, "triangle %u is in no leaf", prim);
    }
}

/* From the last visit to the first, so that a node's bounds are complete before its parent's. */
static void check_boxes(struct packed_check *check)
{
    for (uint32_t i = check->walk.visit_count; i-- > 0;) {
        const struct packed_visit *visit = &check->walk.visit[i];
        const struct box *exact = &check->exact[i];
        for (int k = 0; k < 3; k++) {
            /* Written so that a NaN counts as loose. */
            if (visit->box.lo[k] <= exact->lo[k] && exact->hi[k] <= visit->box.hi[k])
                continue;
            check->faults.loose_boxes++;
            report(check, PACKED_BOUND, i, "%c bounds [%a, %a] do not contain [%a, %a] below",
                   "xyz"[k], (double)visit -> box.lo[k], (double)visit->box.hi[k],
                   (double)exact->lo[k], (double)exact->hi[k]);
            break;
        }
        if (i > 0)
            box_add_box(&check->exact[visit->parent], exact);
    }
}

/* Checks that oriented boxes contain what is below them, where the layout has such boxes. */
static enum status check_oblique(struct packed_check *check)
{
    const struct packed *packed = check->packed;
    struct oblique_bounds *bounds;
    uint32_t axis;
    enum status status = packed_oblique_make(packed, check->scene, &check->walk, &bounds);
    for (uint32_t i = check->walk.visit_count; i-- > 1 && bounds;) {
        const struct packed_visit *visit = &check->walk.visit[i];
        const uint32_t above = check->walk.visit[visit->parent].ref, ref = visit->ref;
        if (packed_oblique_holds(packed, above, ref, &bounds[i], &axis))
            continue;
        check->faults.loose_boxes++;
        report(check, PACKED_BOUND, i, "its oriented box does not contain [%a, %a] along axis %u",
               (double)bounds[i].lo[axis], (double)bounds[i].hi[axis], axis);
    }
    free(bounds);
    return status;
}

enum status packed_check(const struct packed *packed, const struct scene *scene,
                         struct packed_faults *faults, struct reason *reason)
{
    return packed_check_without(packed, scene, NULL, faults, reason);
}

enum status packed_check_without(const struct packed *packed, const struct scene *scene,
                                 const bool *left_out, struct packed_faults *faults,
                                 struct reason *reason)
{
    struct packed_check check = {
        .packed = packed, .scene = scene, .left_out = left_out, .reason = reason};
    if (faults)
        *faults = (struct packed_faults){0};
    enum status status = packed_walk_make(packed, &check.walk);
    check.exact = alloc_zeroed(check.walk.visit_count, sizeof *check.exact);
    check.seen = alloc_zeroed(scene->tri_count, sizeof *check.seen);
    if (!status && check.exact && check.seen) {
        check_walk(&check);
        check_items(&check);
        if (packed->split)
            status = check_cover(&check);
        else
            check_boxes(&check);
        if (!status)
            status = check_oblique(&check);
    } else {
        status = STATUS_MEMORY;
    }
    if (!status) {
        status = check.status;
        if (faults)
            *faults = check.faults;
    } else {
        status = fail(reason, STATUS_MEMORY, "no memory to check %u records", packed->node_count);
    }
    packed_walk_free(&check.walk);
    free(check.exact);
    free(check.seen);
    return status;
}
