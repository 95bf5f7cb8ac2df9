/* Top-down by the surface area heuristic, with spatial splits (Stich, Friedrich, Dietrich 2009,
 * Spatial Splits in Bounding Volume Hierarchies): if the children of the best object split overlap,
 * planes are tried, too, which cut triangles into parts. Ours: parts are cut from the triangle
 * itself with outward rounding (clip.h), so that ref/tree/cover.h finds nothing lost. And the
 * additional parts are limited by a budget, which children divide by the area of their parts, so
 * that subtrees are built independently of each other, by any number of threads. */
#include "ref/build/grow.h"
#include "ref/build/room.h"
#include "ref/build/split.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#define COST_NODE  1.0
#define TASK_LEAST 4096u /* least parts of a subtree that becomes a task */

/* A node. Its subtree uses places first .. first + count + budget - 1 in the arrays of parts, and 2
 * (count + budget) - 1 nodes from `base` on. */
struct range {
    uint32_t first, count, budget, base, depth;
    bool turned; /* its parts are in part[1] */
};

struct made {
    struct box box;
    uint32_t child[2];     /* 0: a leaf */
    uint32_t first, count; /* places in prim */
};

struct sbvh {
    const struct scene *scene;
    struct part *part[2];
    struct made *made;
    uint32_t *prim;
    uint32_t leaf;
    double least_overlap; /* least overlap of the children, as half of its area, at which planes are
                             tried */
};

static const struct part *parts_of(const struct sbvh *s, const struct range *range)
{
    return s->part[range->turned] + range->first;
}

/* The children's parts while they are collected in the other array: the first child's from the
 * front of the range, the second child's from the back. */
struct filling {
    struct part *place;
    uint32_t size, count[2];
    struct box side[2];
    double weight[2];
};

static void put(struct filling *f, int side, const struct part *part)
{
    uint32_t at = f->count[side]++;
    f->place[side ? f->size - 1 - at : at] = *part;
    f->weight[side] += box_half_area_or_none(&part->box);
}

/* Moves the second child's parts to their place and divides the remaining budget. */
static void finish(const struct range *range, struct filling *f, struct range child[2])
{
    uint32_t both = f->count[0] + f->count[1], left = range->count + range->budget - both;
    double sum = f->weight[0] + f->weight[1];
    double share = sum > 0 ? f->weight[0] / sum : 0.5;
    uint32_t first = (uint32_t)((double)left * share);
    child[0] = (struct range){.first = range->first,
                              .count = f->count[0],
                              .budget = first < left ? first : left,
                              .base = range->base + 1,
                              .depth = range->depth + 1,
                              .turned = !range->turned};
    child[1] = child[0];
    child[1].count = f->count[1];
    child[1].budget = left - child[0].budget;
    child[1].first += child[0].count + child[0].budget;
    child[1].base += 2 * (child[0].count + child[0].budget) - 1;
    memmove(f->place + (child[1].first - range->first), f->place + (f->size - f->count[1]),
            f->count[1] * sizeof *f->place);
}

static struct filling fill(const struct sbvh *s, const struct range *range)
{
    return (struct filling){.place = s->part[!range->turned] + range->first,
                            .size = range->count + range->budget,
                            .side = {box_empty(), box_empty()}};
}

static void divide_by_centre(const struct sbvh *s, const struct range *range,
                             const struct split *split, struct range child[2])
{
    struct filling f = fill(s, range);
    const struct part *part = parts_of(s, range);
    uint32_t ties = split->ties;
    for (uint32_t i = 0; i < range->count; i++) {
        float centre = split_centre(&part[i], split->axis);
        bool tie = centre == split->at && ties > 0;
        ties -= tie;
        put(&f, !(centre < split->at || tie), &part[i]);
    }
    finish(range, &f, child);
}

/* Divides in two halves by order, if no split separates or the tree would be too deep. The
 * remaining budget is dropped, so that the halves' places are halves, too. */
static void halve(const struct sbvh *s, const struct range *range, struct range child[2])
{
    struct range poor = *range;
    poor.budget = 0;
    struct filling f = fill(s, &poor);
    const struct part *part = parts_of(s, range);
    for (uint32_t i = 0; i < range->count; i++)
        put(&f, i >= range->count / 2, &part[i]);
    finish(&poor, &f, child);
}

/* Returns the cost of a side if a box is added to it. */
static double cost_with(const struct filling *f, int side, const struct box *box, uint32_t count)
{
    struct box all = f->side[side];
    box_add_box(&all, box);
    return box_half_area_or_none(&all) * (double)count;
}

/* Puts a part that the plane cuts on one side whole, or on both in pieces, whichever costs least
 * (section 4.4); `count` is the number of parts of each side according to the search. */
static void put_cut(const struct sbvh *s, const struct part *part, const struct split *split,
                    struct filling *f, uint32_t count[2])
{
    struct part piece[2];
    float v[3][3];
    scene_tri(s->scene, part->prim, v);
    int sides = part_cut(v, part, split->axis, split->at, piece);
    if (sides == 3) {
        double both =
            cost_with(f, 0, &piece[0].box, count[0]) + cost_with(f, 1, &piece[1].box, count[1]);
        double first = cost_with(f, 0, &part->box, count[0]) +
                       box_half_area_or_none(&f->side[1]) * (double)(count[1] - 1);
        double second = box_half_area_or_none(&f->side[0]) * (double)(count[0] - 1) +
                        cost_with(f, 1, &part->box, count[1]);
        if (first < both && first <= second)
            sides = 4;
        else if (second < both)
            sides = 5;
    }
    for (int side = 0; side < 2; side++) {
        bool whole = sides == 4 + side, here = whole || (sides < 4 && (sides >> side & 1));
        const struct part *put_this = whole ? part : &piece[side];
        if (!here) {
            count[side]--;
            continue;
        }
        put(f, side, put_this);
        box_add_box(&f->side[side], &put_this->box);
    }
}

/* False if a side would be empty. */
static bool divide_in_space(const struct sbvh *s, const struct range *range,
                            const struct split *split, struct range child[2])
{
    struct filling f = fill(s, range);
    const struct part *part = parts_of(s, range);
    uint32_t count[2] = {split->count[0], split->count[1]};
    f.side[0] = split->side[0];
    f.side[1] = split->side[1];
    for (uint32_t i = 0; i < range->count; i++)
        if (part[i].box.hi[split->axis] <= split->at && part[i].box.lo[split->axis] < split->at)
            put(&f, 0, &part[i]);
        else if (part[i].box.lo[split->axis] >= split->at)
            put(&f, 1, &part[i]);
        else
            put_cut(s, &part[i], split, &f, count);
    if (f.count[0] == 0 || f.count[1] == 0)
        return false;
    finish(range, &f, child);
    return true;
}

static bool too_deep(const struct range child[2])
{
    uint32_t larger = 0;
    for (int side = 0; side < 2; side++)
        if (child[side].count + child[side].budget > larger)
            larger = child[side].count + child[side].budget;
    return child[0].depth + log2_ceil(larger) > GROW_DEPTH_MOST;
}

/* Divides a node; false for a leaf. */
static bool divide(const struct sbvh *s, const struct range *range, const struct box *box,
                   struct range child[2])
{
    const struct split_node node = {s->scene, parts_of(s, range), range->count, *box};
    struct split centre, space = {.axis = -1};
    if (range->count == 1)
        return false;
    split_by_centre(&node, &centre);
    if (range->budget > 0 && range->count > 1) {
        struct box overlap = *box;
        for (int k = 0; k < 3 && centre.axis >= 0; k++) {
            overlap.lo[k] = fmaxf(centre.side[0].lo[k], centre.side[1].lo[k]);
            overlap.hi[k] = fminf(centre.side[0].hi[k], centre.side[1].hi[k]);
        }
        if (box_half_area_or_none(&overlap) > s->least_overlap)
            split_in_space(&node, range->budget, &space);
    }
    bool in_space = space.axis >= 0 && (centre.axis < 0 || space.cost < centre.cost);
    double cost = in_space ? space.cost : centre.axis >= 0 ? centre.cost : INFINITY;
    double area = box_half_area_or_none(box) > 0 ? 1 : 0;
    if (range->count <= s->leaf && !(cost < area * ((double)range->count - COST_NODE)))
        return false;
    if (in_space && divide_in_space(s, range, &space, child) && !too_deep(child))
        return true;
    if (centre.axis >= 0)
        divide_by_centre(s, range, &centre, child);
    if (centre.axis < 0 || too_deep(child))
        halve(s, range, child);
    return true;
}

/* Makes the subtree of a range. */
static void grow(const struct sbvh *s, const struct range *range)
{
    const struct part *part = parts_of(s, range);
    struct made *made = &s->made[range->base];
    struct range child[2];
    *made = (struct made){.box = box_empty(), .first = range->first, .count = range->count};
    for (uint32_t i = 0; i < range->count; i++)
        box_add_box(&made->box, &part[i].box);
    if (!divide(s, range, &made->box, child)) {
        for (uint32_t i = 0; i < range->count; i++)
            s->prim[range->first + i] = part[i].prim;
        return;
    }
    made->count = 0;
    for (int side = 0; side < 2; side++)
        made->child[side] = child[side].base;
#pragma omp task if (child[0].count > TASK_LEAST) default(none) shared(s) firstprivate(child)
    grow(s, &child[0]);
    grow(s, &child[1]);
#pragma omp taskwait
}

/* Writes the nodes in pre-order. Errors: STATUS_MEMORY. */
static enum status write_out(const struct sbvh *s, uint32_t most, struct bvh *out)
{
    struct waiting {
        uint32_t made, parent;
    } stack[GROW_DEPTH_MOST + 2];
    uint32_t nodes = 0, prims = 0, depth = 0;
    struct bvh_node *node = room_make(2 * (size_t)most, sizeof *node);
    uint32_t *prim = room_make(most, sizeof *prim);
    if (!node || !prim) {
        room_free(node);
        room_free(prim);
        return STATUS_MEMORY;
    }
    stack[depth++] = (struct waiting){0, 0};
    while (depth > 0) {
        struct waiting now = stack[--depth];
        const struct made *from = &s->made[now.made];
        uint32_t at = nodes++;
        node[at] = (struct bvh_node){from->box, 0, 0, prims, from->count};
        for (int k = 0; k < 3; k++) { /* no -0 */
            node[at].bounds.lo[k] += 0.0f;
            node[at].bounds.hi[k] += 0.0f;
        }
        if (at > 0 && at != now.parent + 1)
            node[now.parent].snd = at;
        for (uint32_t i = 0; i < from->count; i++)
            prim[prims++] = s->prim[from->first + i];
        if (from->count > 0)
            continue;
        node[at].fst = at + 1;
        stack[depth++] = (struct waiting){from->child[1], at};
        stack[depth++] = (struct waiting){from->child[0], at};
    }
    *out = (struct bvh){node, prim, nodes, prims, s->scene->tri_count};
    return STATUS_OK;
}

static enum status make(struct sbvh *s, const struct range *root, uint32_t threads, struct bvh *out)
{
    uint32_t most = root->count + root->budget;
    struct box all = box_empty();
    for (int i = 0; i < 2; i++)
        s->part[i] = room_make(most, sizeof *s->part[i]);
    s->made = room_make(2 * (size_t)most, sizeof *s->made);
    s->prim = room_make(most, sizeof *s->prim);
    if (!s->part[0] || !s->part[1] || !s->made || !s->prim)
        return STATUS_MEMORY;
    for (uint32_t i = 0; i < root->count; i++) {
        s->part[0][i] = (struct part){scene_tri_bounds(s->scene, i), i};
        box_add_box(&all, &s->part[0][i].box);
    }
    s->least_overlap *= box_half_area_or_none(&all);
#pragma omp parallel num_threads(threads)
#pragma omp single
    grow(s, root);
    return write_out(s, most, out);
}

static enum status build(const struct scene *scene, const struct build_options *options,
                         struct bvh *out, struct reason *reason)
{
    *out = (struct bvh){0};
    enum status status = build_check(scene, options, reason);
    if (status || scene->tri_count == 0)
        return status;
    double share = options->split_budget == 0 ? (double)BUILD_SPLIT_BUDGET_DEFAULT
                                              : (double)options->split_budget;
    double alpha = options->split_alpha == 0 ? (double)BUILD_SPLIT_ALPHA_DEFAULT
                                             : (double)options->split_alpha;
    share = share > 0 ? fmin(share, (double)BUILD_SPLIT_BUDGET_MOST) : 0;
    double budget = share * (double)scene->tri_count;
    if (budget + (double)scene->tri_count > (double)((uint32_t)1 << 31))
        return fail(reason, STATUS_LIMIT,
                    "a tree holds at most 2^31 items, %u triangles and %.0f more are asked for; "
                    "use a smaller --split-budget",
                    scene->tri_count, budget);
    struct sbvh s = {.scene = scene, .leaf = options->leaf, .least_overlap = fmax(alpha, 0)};
    struct range root = {.count = scene->tri_count, .budget = (uint32_t)budget};
    status = make(&s, &root, build_threads(options, scene->tri_count), out);
    for (int i = 0; i < 2; i++)
        room_free(s.part[i]);
    room_free(s.made);
    room_free(s.prim);
    if (status)
        (void)fail(reason, status, "no memory to build a tree of %u triangles and at most %u parts",
                   scene->tri_count, root.budget);
    return status;
}

extern const struct builder build_sbvh;
const struct builder build_sbvh = {
    .name = "sbvh",
    .summary = "surface area heuristic with spatial splits: parts of a triangle in several leaves, "
               "at most --split-budget more than triangles",
    .build = build,
    .takes = "split-budget split-alpha",
    .tri_bytes = 230,
};
