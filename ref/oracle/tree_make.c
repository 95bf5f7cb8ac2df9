#include "ref/oracle/oracle_tree.h"

#include "ref/oracle/early.h"

#include <math.h>
#include <stdlib.h>

#define BINS 16
/* From this depth on nodes are halved by count: 2^32 triangles end 32 levels below. */
#define DEEP (TREE_DEPTH - 36)

struct oracle_build {
    struct oracle_part *part;
    struct tree *tree;
    uint32_t leaf; /* parts of one, at most */
};

struct oracle_split {
    int axis; /* -1: none */
    double origin, scale;
    int bin; /* bins up to this one go left */
};

/* No middle lies below the origin, which is the least of them. */
static int bin_of(const struct oracle_split *split, const struct oracle_part *part)
{
    double at = ((double)part->middle[split->axis] - split->origin) * split->scale;
    return at >= BINS ? BINS - 1 : (int)at;
}

/* Cheapest split of one axis; leaves *best alone if there is none cheaper than *cost. The least
 * middle is in the first bin and the largest in the last, so that neither side is empty. */
static void try_axis(const struct oracle_part *part, uint32_t count, struct oracle_split split,
                     double *cost, struct oracle_split *best)
{
    struct box box[BINS], below = box_empty(), above = box_empty();
    uint32_t size[BINS] = {0}, left = 0, right = 0;
    double below_cost[BINS];
    for (int b = 0; b < BINS; b++)
        box[b] = box_empty();
    for (uint32_t i = 0; i < count; i++) {
        int b = bin_of(&split, &part[i]);
        size[b]++;
        box_add_box(&box[b], &part[i].box);
    }
    for (int b = 0; b < BINS - 1; b++) {
        box_add_box(&below, &box[b]);
        left += size[b];
        below_cost[b] = left * box_half_area_or_none(&below);
    }
    for (int b = BINS - 2; b >= 0; b--) {
        box_add_box(&above, &box[b + 1]);
        right += size[b + 1];
        double both = below_cost[b] + right * box_half_area_or_none(&above);
        if (both < *cost) {
            *cost = both;
            *best = split;
            best->bin = b;
        }
    }
}

static struct oracle_split find_split(const struct oracle_part *part, uint32_t count)
{
    struct box middles = box_empty();
    struct oracle_split best = {.axis = -1};
    double cost = INFINITY;
    for (uint32_t i = 0; i < count; i++)
        box_add_point(&middles, part[i].middle);
    for (int k = 0; k < 3; k++) {
        double extent = (double)middles.hi[k] - (double)middles.lo[k];
        struct oracle_split split = {
            .axis = k, .origin = (double)middles.lo[k], .scale = BINS / extent};
        if (extent > 0)
            try_axis(part, count, split, &cost, &best);
    }
    return best;
}

/* Moves the left part to the front; returns its size. Halves the list if no split separates it. */
static uint32_t partition(struct oracle_part *part, uint32_t count, unsigned depth)
{
    struct oracle_split split = {.axis = -1};
    if (depth < DEEP)
        split = find_split(part, count);
    if (split.axis < 0)
        return count / 2;
    uint32_t left = 0;
    for (uint32_t i = 0; i < count; i++)
        if (bin_of(&split, &part[i]) <= split.bin) {
            struct oracle_part swap = part[i];
            part[i] = part[left];
            part[left++] = swap;
        }
    return left;
}

static void make_node(const struct oracle_build *build, uint32_t at, uint32_t first, uint32_t count,
                      unsigned depth);

/* Fills in one child of node `at`. */
static void make_child(const struct oracle_build *build, uint32_t at, int side, uint32_t first,
                       uint32_t count, unsigned depth)
{
    struct box box = box_empty();
    struct tree *tree = build->tree;
    for (uint32_t i = 0; i < count; i++)
        box_add_box(&box, &build->part[first + i].box);
    for (int k = 0; k < 3; k++) {
        tree->node[at].lo[k][side] = box.lo[k];
        tree->node[at].hi[k][side] = box.hi[k];
    }
    bool leaf = count <= build->leaf;
    tree->node[at].child[side] = leaf ? first : tree->node_count;
    tree->node[at].count[side] = leaf ? count : 0;
    if (!leaf)
        make_node(build, tree->node_count++, first, count, depth + 1);
}

static void make_node(const struct oracle_build *build, uint32_t at, uint32_t first, uint32_t count,
                      unsigned depth)
{
    uint32_t left = count <= build->leaf ? count : partition(build->part + first, count, depth);
    make_child(build, at, 0, first, left, depth);
    make_child(build, at, 1, first + left, count - left, depth);
}

enum status tree_make_parts(struct oracle_part *part, uint32_t count, uint32_t leaf,
                            struct tree *out, struct reason *reason)
{
    struct oracle_build build = {part, out, leaf};
    /* Inner nodes are one fewer than leaves, and each node but the root has two leaves or more
     * below it. */
    *out = (struct tree){.node = alloc_zeroed((size_t)count + 1, sizeof *out->node),
                         .order = alloc_zeroed(count, sizeof *out->order)};
    if (!out->node || !out->order) {
        tree_free(out);
        return fail(reason, STATUS_MEMORY, "oracle: no memory for a tree of %u boxes", count);
    }
    out->node_count = 1;
    make_node(&build, 0, 0, count, 1);
    for (uint32_t i = 0; i < count; i++)
        out->order[i] = part[i].prim;
    return STATUS_OK;
}

enum status tree_make(const struct scene *scene, struct tree *out, struct reason *reason)
{
    uint32_t count = scene->tri_count;
    struct oracle_part *part = alloc_zeroed(count, sizeof *part);
    *out = (struct tree){0};
    if (!part)
        return fail(reason, STATUS_MEMORY, "oracle: no memory for a tree of %u triangles", count);
    for (uint32_t i = 0; i < count; i++) {
        part[i].box = scene_tri_bounds(scene, i);
        part[i].prim = i;
        for (int k = 0; k < 3; k++)
            part[i].middle[k] = 0.5f * part[i].box.lo[k] + 0.5f * part[i].box.hi[k];
    }
    /* So few triangles are tested in less time than their tree is built in. */
    uint32_t leaf = count <= EARLY_MOST ? EARLY_MOST : TREE_LEAF;
    enum status status = tree_make_parts(part, count, leaf, out, reason);
    free(part);
    return status;
}

void tree_free(struct tree *tree)
{
    free(tree->node);
    free(tree->order);
    *tree = (struct tree){0};
}
