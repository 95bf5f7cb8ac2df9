#include "ref/build/grow.h"

#include "ref/build/presplit.h"
#include "ref/build/room.h"

#include <stdlib.h>

/* All threads together split ranges with more items than the total / PIECES. */
#define PIECES      128u
#define PIECE_LEAST 2048u

/* A node of the top of the tree, in pre-order, or a piece below the top. */
struct grow_part {
    struct grow_range range;
    struct lane_box bounds;
    uint32_t snd;   /* second child; 0: a piece */
    uint32_t nodes; /* of a piece: its number of nodes */
    uint32_t at;    /* index in the finished tree */
};

struct grower {
    const struct grow_rule *rule;
    void *user;
    uint32_t *prim;
    struct bvh_node *node; /* nodes of the pieces; those of a piece whose first item is i begin at 2
                              i */
    struct grow_part *part;
    size_t part_count, part_capacity;
    uint32_t threads;
};

uint32_t log2_ceil(uint32_t n)
{
    return n < 2 ? 0 : 32 - (uint32_t)__builtin_clz(n - 1);
}

enum status build_check(const struct scene *scene, const struct build_options *options,
                        struct reason *reason)
{
    if (options->leaf == 0)
        return fail(reason, STATUS_INPUT, "the leaf size is 0, must be at least 1");
    if (scene->tri_count > (uint32_t)1 << 31)
        return fail(reason, STATUS_LIMIT, "a tree holds at most 2^31 triangles, the scene has %u",
                    scene->tri_count);
    return STATUS_OK;
}

/* Splits by the rule, or into halves if the rule's split could become too deep. False for a
 * leaf. */
static bool divide(const struct grower *g, const struct grow_range *range,
                   struct grow_range child[2], uint32_t threads)
{
    uint32_t left = range->count > 1 ? g->rule->split(g->user, range, child, threads) : 0;
    if (left == 0)
        return false;
    uint32_t larger = left > range->count - left ? left : range->count - left;
    if (range->depth + 1 + log2_ceil(larger) > GROW_DEPTH_MOST)
        left = g->rule->halve(g->user, range, child);
    child[0].first = range->first;
    child[0].count = left;
    child[1].first = range->first + left;
    child[1].count = range->count - left;
    child[0].depth = child[1].depth = range->depth + 1;
    return true;
}

/* Appends the subtree of a range to node[*count ..], in pre-order, with indices relative to
 * `node`. */
static struct lane_box piece_grow(const struct grower *g, const struct grow_range *range,
                                  struct bvh_node *node, uint32_t *count)
{
    struct grow_range child[2];
    uint32_t mine = (*count)++;
    struct bvh_node *out = &node[mine];
    if (!divide(g, range, child, 1)) {
        struct lane_box bounds = g->rule->leaf(g->user, range, g->prim + range->first);
        *out = (struct bvh_node){lane_box_store(&bounds), 0, 0, range->first, range->count};
        return bounds;
    }
    struct lane_box bounds = piece_grow(g, &child[0], node, count);
    uint32_t snd = *count;
    struct lane_box other = piece_grow(g, &child[1], node, count);
    lane_box_add(&bounds, &other);
    *out = (struct bvh_node){lane_box_store(&bounds), mine + 1, snd, range->first, 0};
    return bounds;
}

static enum status part_add(struct grower *g, const struct grow_range *range)
{
    enum status status =
        array_reserve(&g->part, &g->part_capacity, g->part_count + 1, sizeof *g->part);
    if (!status)
        g->part[g->part_count++] = (struct grow_part){.range = *range};
    return status;
}

/* Splits a range into parts of at most `most` items; a larger range that is not split is a part,
 * too. */
static enum status top_grow(struct grower *g, const struct grow_range *range, uint32_t most)
{
    struct grow_range child[2];
    size_t mine = g->part_count;
    enum status status = part_add(g, range);
    if (status || range->count <= most || !divide(g, range, child, g->threads))
        return status;
    status = top_grow(g, &child[0], most);
    g->part[mine].snd = (uint32_t)g->part_count;
    return status ? status : top_grow(g, &child[1], most);
}

/* Counts the nodes, and computes the bounds of the top. */
static uint32_t top_finish(struct grower *g)
{
    uint32_t count = 0;
    for (size_t i = 0; i < g->part_count; i++) {
        struct grow_part *part = &g->part[i];
        part->at = count;
        count += part->snd ? 1 : part->nodes;
    }
    for (size_t i = g->part_count; i-- > 0;) {
        struct grow_part *part = &g->part[i];
        if (!part->snd)
            continue;
        part->bounds = g->part[i + 1].bounds;
        lane_box_add(&part->bounds, &g->part[part->snd].bounds);
    }
    return count;
}

static void part_move(const struct grower *g, size_t i, struct bvh_node *out)
{
    const struct grow_part *part = &g->part[i];
    const struct bvh_node *from = g->node + 2 * (size_t)part->range.first;
    if (part->snd) {
        out[part->at] = (struct bvh_node){lane_box_store(&part->bounds), part->at + 1,
                                          g->part[part->snd].at, part->range.first, 0};
        return;
    }
    for (uint32_t n = 0; n < part->nodes; n++) {
        struct bvh_node node = from[n];
        uint32_t shift = node.item_count ? 0 : part->at;
        node.fst += shift;
        node.snd += shift;
        out[part->at + n] = node;
    }
}

static enum status grow_all(struct grower *g, const struct grow_range *root, struct bvh *out)
{
    uint32_t most = root->count / PIECES;
    enum status status = top_grow(g, root, most > PIECE_LEAST ? most : PIECE_LEAST);
    if (status)
        return status;
#pragma omp parallel for schedule(dynamic, 1) num_threads(g->threads) if (g->threads > 1)
    for (size_t i = 0; i < g->part_count; i++) {
        struct grow_part *part = &g->part[i];
        if (!part->snd)
            part->bounds =
                piece_grow(g, &part->range, g->node + 2 * (size_t)part->range.first, &part->nodes);
    }
    uint32_t count = top_finish(g);
    struct bvh_node *node = room_make(count, sizeof *node);
    if (!node)
        return STATUS_MEMORY;
#pragma omp parallel for schedule(dynamic, 1) num_threads(g->threads) if (g->threads > 1)
    for (size_t i = 0; i < g->part_count; i++)
        part_move(g, i, node);
    *out = (struct bvh){.node = node,
                        .prim = g->prim,
                        .node_count = count,
                        .prim_count = root->count,
                        .tri_count = root->count};
    return STATUS_OK;
}

static enum status grow_tree(const struct grow_rule *rule, void *user,
                             const struct grow_range *root, uint32_t threads, struct bvh *out)
{
    *out = (struct bvh){0};
    struct grower g = {.rule = rule, .user = user, .threads = threads};
    g.prim = room_make(root->count, sizeof *g.prim);
    g.node = room_make(2 * (size_t)root->count, sizeof *g.node);
    enum status status = g.prim && g.node ? grow_all(&g, root, out) : STATUS_MEMORY;
    if (status)
        room_free(g.prim);
    room_free(g.node);
    free(g.part);
    return status;
}

enum status grow_build(const struct grow_rule *rule, void *user, const struct scene *scene,
                       const struct build_options *options, struct bvh *out, struct reason *reason)
{
    *out = (struct bvh){0};
    enum status status = build_check(scene, options, reason);
    if (status || scene->tri_count == 0)
        return status;
    uint32_t threads = build_threads(options, scene->tri_count);
    struct refs refs;
    status = refs_make(scene, options, threads, &refs, reason);
    if (status == STATUS_LIMIT)
        return status;
    if (!status) {
        struct grow_range root = {.count = refs.count, .centres = refs.centres};
        status = rule->start(user, refs.ref, threads, &root);
        if (!status)
            status = grow_tree(rule, user, &root, threads, out);
        if (rule->end)
            rule->end(user);
    }
    room_free(refs.ref);
    if (!status && options->presplit > 0)
        status = presplit_merge(out, scene->tri_count);
    if (!status)
        return STATUS_OK;
    room_free(out->node);
    room_free(out->prim);
    *out = (struct bvh){0};
    return fail(reason, status, "no memory to build a tree of %u triangles", scene->tri_count);
}
