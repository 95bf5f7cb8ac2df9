#include "ref/builders/climb.h"

#include "ref/build/links.h"
#include "ref/build/refs.h"
#include "ref/build/room.h"

#define ALONE 4096u /* most nodes of a subtree that one thread climbs by itself */

/* Nodes are numbered in pre-order when a round begins: a subtree is a range of numbers, and what is
 * moved within it keeps to that range. */
struct climb {
    const struct climb_rule *rule;
    struct spots spots;
    uint32_t *size; /* nodes below each node and itself */
    uint32_t *top;  /* roots of the largest subtrees of at most ALONE nodes */
    uint32_t tops, threads;
};

static bool is_top(const struct climb *c, uint32_t node)
{
    uint32_t parent = c->spots.spot[node].parent;
    return c->size[node] <= ALONE && (parent == LINKS_NONE || c->size[parent] > ALONE);
}

/* Errors: STATUS_MEMORY. */
static enum status find_tops(struct climb *c)
{
    uint32_t nodes = c->spots.count;
    for (uint32_t i = nodes; i-- > 0;) {
        const uint32_t *child = c->spots.spot[i].child;
        c->size[i] = child[0] == LINKS_NONE ? 1 : 1 + c->size[child[0]] + c->size[child[1]];
    }
    for (uint32_t i = 0; i < nodes; i++)
        c->tops += is_top(c, i);
    c->top = room_make(c->tops, sizeof *c->top);
    if (!c->top)
        return STATUS_MEMORY;
    for (uint32_t i = 0, n = 0; i < nodes; i++)
        if (is_top(c, i))
            c->top[n++] = i;
    return STATUS_OK;
}

static void climb_all(struct climb *c)
{
    const struct climb_rule *rule = c->rule;
#pragma omp parallel for schedule(dynamic) num_threads(c->threads) if (c->threads > 1)
    for (uint32_t n = 0; n < c->tops; n++)
        for (uint32_t i = c->top[n] + c->size[c->top[n]]; i-- > c->top[n];)
            rule->at(rule->user, &c->spots, i);
    for (uint32_t i = c->spots.count; i-- > 0;)
        if (c->size[i] > ALONE)
            rule->at(rule->user, &c->spots, i);
}

static enum status climb_round(const struct bvh *bvh, const struct climb_rule *rule,
                               uint32_t threads, struct bvh *out)
{
    struct climb c = {.rule = rule, .threads = threads};
    *out = (struct bvh){0};
    enum status status = spots_make(bvh, &c.spots);
    c.size = room_make(bvh->node_count, sizeof *c.size);
    if (!status)
        status = c.size ? find_tops(&c) : STATUS_MEMORY;
    if (!status)
        climb_all(&c);
    room_free(c.size);
    room_free(c.top);
    if (!status)
        status = spots_write(&c.spots, bvh, out);
    spots_free(&c.spots);
    return status;
}

enum status tree_climb(struct bvh *bvh, const struct climb_rule *rule, uint32_t rounds,
                       uint32_t threads)
{
    const struct build_options options = {.threads = threads};
    double cost = 0, before = 0;
    threads = build_threads(&options, bvh->node_count);
    enum status status = tree_collapsed_cost(bvh, rule->leaf, &before);
    for (uint32_t i = 0; i < rounds && !status; i++) {
        struct bvh moved;
        status = climb_round(bvh, rule, threads, &moved);
        if (!status)
            status = tree_collapsed_cost(&moved, rule->leaf, &cost);
        if (status || !(cost < before)) {
            tree_drop(&moved);
            break;
        }
        tree_drop(bvh);
        *bvh = moved;
        before = cost;
    }
    return status;
}
