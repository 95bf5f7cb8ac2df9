#include "ref/tree/cover.h"

#include "ref/tree/cover_exact.h"

#include <stdlib.h>
#include <string.h>

#define PARTS_MOST 65536u

/* The uncovered parts of a triangle. */
struct parts {
    struct cover_part *part;
    size_t count, capacity;
};

struct check {
    const struct cover_tree *tree;
    const struct scene *scene;
    struct box *region; /* of each node */
    uint32_t *first;    /* per triangle: its leaves are leaf[first[prim] .. first[prim + 1] - 1] */
    uint32_t *leaf;
    struct parts left, rest;
    struct cover_faults *faults;
};

/* Returns the intersection of `a` and `b`. */
static struct box box_cut(const struct box *a, const struct box *b)
{
    struct box cut;
    for (int k = 0; k < 3; k++) {
        /* Written so that a NaN of either box is kept. */
        cut.lo[k] = a->lo[k] >= b->lo[k] || a->lo[k] != a->lo[k] ? a->lo[k] : b->lo[k];
        cut.hi[k] = a->hi[k] <= b->hi[k] || a->hi[k] != a->hi[k] ? a->hi[k] : b->hi[k];
    }
    return cut;
}

/* Returns the intersection of `part` and `box`. A side is open if it is an open side of the
 * part. */
static struct cover_part part_cut(const struct cover_part *part, const struct box *box)
{
    struct cover_part cut = {box_cut(&part->box, box), part->open};
    for (int k = 0; k < 3; k++) {
        if (part->box.lo[k] < cut.box.lo[k])
            cut.open &= ~COVER_OPEN_LO(k);
        if (part->box.hi[k] > cut.box.hi[k])
            cut.open &= ~COVER_OPEN_HI(k);
    }
    return cut;
}

/* Keeps a part if the triangle has a point in it. */
static enum status keep(float v[3][3], const struct cover_part *part, struct parts *to)
{
    if (!cover_meets(v, part))
        return STATUS_OK;
    enum status status = array_reserve(&to->part, &to->capacity, to->count + 1, sizeof *to->part);
    if (!status)
        to->part[to->count++] = *part;
    return status;
}

/* Keeps the remainder of `part` outside `box`, neither of them empty, cut off axis by axis. */
static enum status keep_outside(float v[3][3], struct cover_part part, const struct box *box,
                                struct parts *to)
{
    enum status status = STATUS_OK;
    for (int k = 0; k < 3 && !status; k++) {
        if (part.box.lo[k] < box->lo[k]) {
            struct cover_part below = part;
            below.box.hi[k] = box->lo[k];
            below.open |= COVER_OPEN_HI(k);
            status = keep(v, &below, to);
            part.box.lo[k] = box->lo[k];
            part.open &= ~COVER_OPEN_LO(k);
        }
        if (!status && part.box.hi[k] > box->hi[k]) {
            struct cover_part above = part;
            above.box.lo[k] = box->hi[k];
            above.open |= COVER_OPEN_LO(k);
            status = keep(v, &above, to);
            part.box.hi[k] = box->hi[k];
            part.open &= ~COVER_OPEN_HI(k);
        }
    }
    return status;
}

/* Subtracts `box` from the uncovered parts. */
static enum status cut_off(struct check *check, float v[3][3], const struct box *box)
{
    enum status status = STATUS_OK;
    check->rest.count = 0;
    for (size_t i = 0; i < check->left.count && !status; i++) {
        const struct cover_part *part = &check->left.part[i];
        const struct cover_part shared = part_cut(part, box);
        if (cover_part_empty(&shared))
            status = keep(v, part, &check->rest);
        else
            status = keep_outside(v, *part, box, &check->rest);
    }
    struct parts swap = check->left;
    check->left = check->rest;
    check->rest = swap;
    return status;
}

/* Finds the deepest node, on any path to a leaf of `prim`, whose region still has some of the
 * part. */
static uint32_t find_node(const struct check *check, uint32_t prim, float v[3][3],
                          const struct cover_part *part)
{
    uint32_t deepest = 0, most = 0;
    for (uint32_t k = check->first[prim]; k < check->first[prim + 1]; k++) {
        uint32_t depth = 0, node = 0;
        bool found = false;
        for (uint32_t i = check->leaf[k]; i != 0; i = check->tree->node[i].parent) {
            const struct cover_part shared = part_cut(part, &check->region[i]);
            if (!found && cover_meets(v, &shared)) {
                found = true;
                node = i;
            }
            depth += found;
        }
        if (depth > most) {
            most = depth;
            deepest = node;
        }
    }
    return deepest;
}

static enum status check_prim(struct check *check, uint32_t prim)
{
    float v[3][3];
    const struct cover_part whole = {.box = scene_tri_bounds(check->scene, prim)};
    uint32_t from = check->first[prim], to = check->first[prim + 1];
    for (uint32_t k = from; k < to; k++)
        if (box_contains_box(&check->region[check->leaf[k]], &whole.box))
            return STATUS_OK;
    if (from == to)
        return STATUS_OK;
    scene_tri(check->scene, prim, v);
    check->left.count = 0;
    enum status status = keep(v, &whole, &check->left);
    for (uint32_t k = from; k < to && !status && check->left.count; k++) {
        status = cut_off(check, v, &check->region[check->leaf[k]]);
        if (check->left.count > PARTS_MOST)
            break;
    }
    if (!status && check->left.count && check->faults->prims++ == 0) {
        check->faults->prim = prim;
        check->faults->node = find_node(check, prim, v, &check->left.part[0]);
    }
    return status;
}

/* Computes the regions, and lists the leaves of each triangle. */
static enum status list_leaves(struct check *check)
{
    const struct cover_tree *tree = check->tree;
    uint32_t tri_count = check->scene->tri_count;
    size_t items = 0;
    for (uint32_t i = 0; i < tree->node_count; i++) {
        const struct cover_node *node = &tree->node[i];
        check->region[i] = i > 0 ? box_cut(&check->region[node->parent], &node->box) : node->box;
        for (uint32_t k = 0; k < node->item_count; k++) {
            uint32_t prim = tree->item[node->item_first + k];
            if (prim < tri_count)
                check->first[prim + 1]++;
        }
        items += node->item_count;
    }
    for (uint32_t prim = 0; prim < tri_count; prim++)
        check->first[prim + 1] += check->first[prim];
    check->leaf = alloc_zeroed(items, sizeof *check->leaf);
    if (!check->leaf)
        return STATUS_MEMORY;
    const uint32_t total = check->first[tri_count];
    /* Each triangle's range is filled from its end, so that first[] has the starts again
     * afterwards. */
    for (uint32_t i = tree->node_count; i-- > 0;)
        for (uint32_t k = 0; k < tree->node[i].item_count; k++) {
            uint32_t prim = tree->item[tree->node[i].item_first + k];
            if (prim < tri_count)
                check->leaf[--check->first[prim + 1]] = i;
        }
    for (uint32_t prim = 0; prim < tri_count; prim++)
        check->first[prim] = check->first[prim + 1];
    check->first[tri_count] = total;
    return STATUS_OK;
}

enum status cover_check(const struct cover_tree *tree, const struct scene *scene,
                        struct cover_faults *out)
{
    struct check check = {.tree = tree, .scene = scene, .faults = out};
    *out = (struct cover_faults){0};
    check.region = alloc_zeroed(tree->node_count, sizeof *check.region);
    check.first = alloc_zeroed((size_t)scene->tri_count + 2, sizeof *check.first);
    enum status status = check.region && check.first ? STATUS_OK : STATUS_MEMORY;
    if (!status)
        status = list_leaves(&check);
    for (uint32_t prim = 0; prim < scene->tri_count && !status; prim++)
        status = check_prim(&check, prim);
    free(check.region);
    free(check.first);
    free(check.leaf);
    free(check.left.part);
    free(check.rest.part);
    if (status)
        *out = (struct cover_faults){0};
    return status;
}
