#include "ref/build/split.h"

#include "ref/build/refs.h"

#include <math.h>
#include <stdlib.h>

#define BINS        64u /* by centre */
#define SPACE_BINS  16u /* in space, at most; with few parts SPACE_LEAST and one per part */
#define SPACE_LEAST 2u

/* --- by centre -------------------------------------------------------------------------------- */

/* A part's centre and its index, in one number that sorts. */
static uint64_t sort_key(const struct part *part, int axis, uint32_t place)
{
    return (uint64_t)order_key(split_centre(part, axis) + 0.0f) << 32 | place;
}

static int by_key(const void *left, const void *right)
{
    uint64_t a = *(const uint64_t *)left, b = *(const uint64_t *)right;
    return order_numbers(a, b);
}

static void sweep_axis(const struct split_node *node, int axis, double unit, struct split *best)
{
    uint64_t key[SPLIT_SWEPT];
    double right[SPLIT_SWEPT];
    struct box box = box_empty(), other[SPLIT_SWEPT];
    for (uint32_t i = 0; i < node->count; i++)
        key[i] = sort_key(&node->part[i], axis, i);
    qsort(key, node->count, sizeof *key, by_key);
    for (uint32_t i = node->count; i-- > 1;) {
        box_add_box(&box, &node->part[(uint32_t)key[i]].box);
        other[i] = box;
        right[i] = box_half_area_or_none(&box) * (double)(node->count - i);
    }
    box = box_empty();
    uint32_t ties = 0;
    for (uint32_t i = 1; i < node->count; i++) {
        const struct part *last = &node->part[(uint32_t)key[i - 1]];
        box_add_box(&box, &last->box);
        ties = i > 1 && key[i - 1] >> 32 == key[i - 2] >> 32 ? ties + 1 : 1;
        double cost = (box_half_area_or_none(&box) * (double)i + right[i]) * unit;
        if (best->axis < 0 || cost < best->cost)
            *best = (struct split){.axis = axis,
                                   .at = split_centre(last, axis),
                                   .ties = ties,
                                   .cost = cost,
                                   .side = {box, other[i]},
                                   .count = {i, node->count - i}};
    }
}

struct bin {
    struct box box;
    uint32_t in, out; /* parts that begin and end here; equal if binned by centre */
};

/* Finds the cheapest split before a bin; sets cost and sides, but not `at`. Returns the bin, 0 for
 * none. */
static uint32_t sweep_bins(const struct bin *bin, uint32_t bins, uint32_t most, double unit,
                           struct split *out)
{
    struct box right[SPACE_BINS > BINS ? SPACE_BINS : BINS], box = box_empty();
    uint32_t after[ARRAY_COUNT(right)], before = 0, best = 0;
    for (uint32_t i = bins, n = 0; i-- > 1;) {
        box_add_box(&box, &bin[i].box);
        right[i] = box;
        after[i] = n += bin[i].out;
    }
    box = box_empty();
    for (uint32_t i = 1; i < bins; i++) {
        box_add_box(&box, &bin[i - 1].box);
        before += bin[i - 1].in;
        if (before == 0 || after[i] == 0 || before + after[i] > most)
            continue;
        double cost = (box_half_area_or_none(&box) * (double)before +
                       box_half_area_or_none(&right[i]) * (double)after[i]) *
                      unit;
        if (best == 0 || cost < out->cost) {
            best = i;
            out->cost = cost;
            out->side[0] = box;
            out->side[1] = right[i];
            out->count[0] = before;
            out->count[1] = after[i];
        }
    }
    return best;
}

static void bin_axis(const struct split_node *node, int axis, double unit, struct split *best)
{
    float lo = INFINITY, hi = -INFINITY;
    float first[BINS]; /* least centre of each bin */
    struct bin bin[BINS];
    for (uint32_t i = 0; i < node->count; i++) {
        float centre = split_centre(&node->part[i], axis);
        lo = centre < lo ? centre : lo;
        hi = centre > hi ? centre : hi;
    }
    double scale = (double)BINS / ((double)hi - (double)lo);
    if (!(hi > lo))
        return;
    for (uint32_t b = 0; b < BINS; b++) {
        bin[b] = (struct bin){.box = box_empty()};
        first[b] = INFINITY;
    }
    for (uint32_t i = 0; i < node->count; i++) {
        float centre = split_centre(&node->part[i], axis);
        double place = ((double)centre - (double)lo) * scale;
        uint32_t b = place < (double)(BINS - 1) ? (uint32_t)place : BINS - 1;
        bin[b].in++;
        bin[b].out++;
        first[b] = centre < first[b] ? centre : first[b];
        box_add_box(&bin[b].box, &node->part[i].box);
    }
    struct split split = {.axis = axis};
    uint32_t b = sweep_bins(bin, BINS, node->count, unit, &split);
    if (b == 0 || (best->axis >= 0 && !(split.cost < best->cost)))
        return;
    while (bin[b].in == 0) /* the split is before the next bin that is not empty */
        b++;
    split.at = first[b];
    *best = split;
}

void split_by_centre(const struct split_node *node, struct split *out)
{
    double area = box_half_area_or_none(&node->box), unit = area > 0 ? 1 / area : 0;
    *out = (struct split){.axis = -1};
    for (int k = 0; k < 3; k++)
        if (node->count <= SPLIT_SWEPT)
            sweep_axis(node, k, unit, out);
        else
            bin_axis(node, k, unit, out);
}

/* --- in space --------------------------------------------------------------------------------- */

/* An edge of a triangle along an axis. */
struct edge {
    double from[3], slope[3]; /* lower end, and change per unit of the axis */
    float lo, hi;             /* interval on the axis */
};

static void make_edges(float v[3][3], int axis, struct edge edge[3])
{
    for (int c = 0; c < 3; c++) {
        const float *a = v[c], *b = v[(c + 1) % 3];
        const float *p = a[axis] < b[axis] ? a : b, *q = a[axis] < b[axis] ? b : a;
        double length = (double)q[axis] - (double)p[axis];
        edge[c].lo = p[axis];
        edge[c].hi = q[axis];
        for (int k = 0; k < 3; k++) {
            edge[c].from[k] = (double)p[k];
            edge[c].slope[k] = length > 0 ? ((double)q[k] - (double)p[k]) / length : 0;
        }
    }
}

/* Bounds of a triangle's intersection with a plane. Not rounded outward, since only costs depend on
 * it. */
static struct box cross_section(const struct edge edge[3], int axis, float at)
{
    struct box box = box_empty();
    for (int c = 0; c < 3; c++) {
        float point[3];
        if (!(edge[c].lo < at && at < edge[c].hi))
            continue;
        for (int k = 0; k < 3; k++)
            point[k] =
                (float)(edge[c].from[k] + edge[c].slope[k] * ((double)at - edge[c].from[axis]));
        box_add_point(&box, point);
    }
    return box;
}

/* Cuts `box` down to its intersection with `other`. */
static void cut_down(struct box *box, const struct box *other)
{
    for (int k = 0; k < 3; k++) {
        box->lo[k] = other->lo[k] > box->lo[k] ? other->lo[k] : box->lo[k];
        box->hi[k] = other->hi[k] < box->hi[k] ? other->hi[k] : box->hi[k];
    }
}

/* Makes planes plane[0] .. plane[bins]; the first and the last are the node's sides. Returns the
 * number of bins, fewer than `asked` if floats are too coarse. */
static uint32_t make_planes(float lo, float hi, uint32_t asked, float plane[SPACE_BINS + 1])
{
    uint32_t bins = 0;
    plane[0] = lo;
    for (uint32_t i = 1; i < asked; i++) {
        float at = (float)((double)lo + ((double)hi - (double)lo) * (double)i / (double)asked);
        if (at > plane[bins] && at < hi)
            plane[++bins] = at;
    }
    plane[++bins] = hi;
    return bins;
}

/* Adds a part to all bins that it overlaps: from the last bin whose lower plane is not above the
 * part to the first whose upper plane is not below it. */
static void chop(const struct split_node *node, const struct part *part, int axis,
                 const float *plane, uint32_t bins, struct bin *bin)
{
    float v[3][3], lo = part->box.lo[axis], hi = part->box.hi[axis];
    uint32_t from = 0, behind = bins;
    while (behind - from > 1) {
        uint32_t middle = (from + behind) / 2;
        *(plane[middle] <= lo ? &from : &behind) = middle;
    }
    uint32_t to = from;
    while (to + 1 < bins && plane[to + 1] < hi)
        to++;
    bin[from].in++;
    bin[to].out++;
    if (from == to) {
        box_add_box(&bin[from].box, &part->box);
        return;
    }
    struct edge edge[3];
    scene_tri(node->scene, part->prim, v);
    make_edges(v, axis, edge);
    struct box below = cross_section(edge, axis, plane[from]);
    for (uint32_t b = from; b <= to; b++) {
        struct box above = cross_section(edge, axis, plane[b + 1]), piece = below;
        box_add_box(&piece, &above);
        for (int c = 0; c < 3; c++)
            if (plane[b] <= v[c][axis] && v[c][axis] <= plane[b + 1])
                box_add_point(&piece, v[c]);
        cut_down(&piece, &part->box);
        if (!clip_is_empty(&piece))
            box_add_box(&bin[b].box, &piece);
        below = above;
    }
}

void split_in_space(const struct split_node *node, uint32_t most, struct split *out)
{
    double area = box_half_area_or_none(&node->box), unit = area > 0 ? 1 / area : 0;
    uint32_t asked =
        SPACE_LEAST + node->count < SPACE_BINS ? SPACE_LEAST + node->count : SPACE_BINS;
    *out = (struct split){.axis = -1};
    for (int k = 0; k < 3; k++) {
        float plane[SPACE_BINS + 1];
        struct bin bin[SPACE_BINS];
        uint32_t bins = node->box.lo[k] < node->box.hi[k]
                            ? make_planes(node->box.lo[k], node->box.hi[k], asked, plane)
                            : 0;
        for (uint32_t b = 0; b < bins; b++)
            bin[b] = (struct bin){.box = box_empty()};
        for (uint32_t i = 0; i < node->count && bins > 1; i++)
            chop(node, &node->part[i], k, plane, bins, bin);
        struct split split = {.axis = k};
        uint32_t b = bins > 1 ? sweep_bins(bin, bins, node->count + most, unit, &split) : 0;
        if (b == 0 || (out->axis >= 0 && !(split.cost < out->cost)))
            continue;
        split.at = plane[b];
        *out = split;
    }
}
