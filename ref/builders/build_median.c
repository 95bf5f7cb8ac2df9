/* The repaired twin of builder `rtrs`: splits at the middle of the longest axis of the exact
 * bounds. Only that axis decides (RTRS's F4), boxes are never cut (F5). If the middle separates
 * nothing, the triangles are halved instead (F19), so that no leaf exceeds the limit. eps is
 * ignored. */
#include "ref/build/grow.h"
#include "ref/build/top_down.h"

/* In double, where the sum of three floats cannot overflow. */
static void centroid(float v[3][3], float out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (float)(((double)v[0][k] + (double)v[1][k] + (double)v[2][k]) / 3);
}

/* The longest axis; the first of equals. */
static size_t longest_axis(const struct box *box)
{
    size_t axis = 0;
    double most = -1;
    for (size_t k = 0; k < 3; k++) {
        double extent = (double)box->hi[k] - (double)box->lo[k];
        if (extent > most) {
            axis = k;
            most = extent;
        }
    }
    return axis;
}

/* Makes -0 and 0 equal. */
static uint32_t key_of(float x)
{
    return order_key(x + 0.0f);
}

/* Returns the key of rank `rank` (0 is the smallest); reorders `key`. One pass per bit, from the
 * highest, so at most 32 passes for any input. */
static uint32_t select_key(uint32_t *key, uint32_t count, uint32_t rank)
{
    for (uint32_t bit = 0x80000000u; bit != 0 && count > 1; bit >>= 1) {
        uint32_t zeros = 0;
        for (uint32_t i = 0; i < count; i++) {
            uint32_t k = key[i];
            if (k & bit)
                continue;
            key[i] = key[zeros];
            key[zeros++] = k;
        }
        if (rank < zeros) {
            count = zeros;
        } else {
            key += zeros;
            count -= zeros;
            rank -= zeros;
        }
    }
    return key[0];
}

/* Moves the triangles with key < pivot, and the first `ties` of those with key == pivot, to the
 * front; both sides keep their order. Returns their number. */
static uint32_t partition(struct build *build, const struct build_node *node, size_t axis,
                          uint32_t pivot, uint32_t ties)
{
    uint32_t *prim = build->prim + node->first;
    uint32_t left = 0, right = 0;
    for (uint32_t i = 0; i < node->count; i++) {
        uint32_t key = key_of(build->centroid[3 * (size_t)prim[i] + axis]);
        bool front = key < pivot || (key == pivot && ties > 0);
        if (key == pivot && ties > 0)
            ties--;
        if (front)
            prim[left++] = prim[i];
        else
            build->spare[right++] = prim[i];
    }
    for (uint32_t i = 0; i < right; i++)
        prim[left + i] = build->spare[i];
    return left;
}

/* Puts the half with the smaller centroids in front; among equal ones the lower index comes
 * first. */
static uint32_t halve(struct build *build, const struct build_node *node, size_t axis)
{
    const uint32_t *prim = build->prim + node->first;
    uint32_t half = node->count / 2;
    for (uint32_t i = 0; i < node->count; i++)
        build->spare[i] = key_of(build->centroid[3 * (size_t)prim[i] + axis]);
    uint32_t pivot = select_key(build->spare, node->count, half);
    uint32_t below = 0;
    for (uint32_t i = 0; i < node->count; i++)
        below += key_of(build->centroid[3 * (size_t)prim[i] + axis]) < pivot;
    return partition(build, node, axis, pivot, half - below);
}

static enum status split(struct build *build, struct build_node *node, uint32_t *left,
                         struct reason *reason)
{
    (void)reason;
    *left = 0;
    if (node->count <= build->options->leaf)
        return STATUS_OK;
    size_t axis = longest_axis(&node->bounds);
    /* Halved first: the sum could overflow. */
    uint32_t middle = key_of(0.5f * node->bounds.lo[axis] + 0.5f * node->bounds.hi[axis]);
    uint32_t front = 0;
    for (uint32_t i = 0; i < node->count; i++) {
        uint32_t prim = build->prim[node->first + i];
        front += key_of(build->centroid[3 * (size_t)prim + axis]) <= middle;
    }
    uint32_t larger = front > node->count - front ? front : node->count - front;
    if (larger == node->count || node->depth + 1 + log2_ceil(larger) > GROW_DEPTH_MOST)
        *left = halve(build, node, axis);
    else
        *left = partition(build, node, axis, middle, UINT32_MAX);
    return STATUS_OK;
}

static enum status build_median_tree(const struct scene *scene, const struct build_options *options,
                                     struct bvh *out, struct reason *reason)
{
    static const struct build_rule rule = {centroid, split};
    return build_top_down(&rule, scene, options, out, reason);
}

extern const struct builder build_median;
const struct builder build_median = {
    .name = "median",
    .summary = "middle of the longest axis of exact bounds, halves if that separates nothing; "
               "depth at most 60; ignores eps",
    .build = build_median_tree,
    .takes = "presplit",
    .tri_bytes = 44,
};
