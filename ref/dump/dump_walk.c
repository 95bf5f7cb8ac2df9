#include "ref/dump/dump_walk.h"

#include <stdlib.h>

#define UNSEEN 0
#define OPEN   1 /* on the path from the root */
#define DONE   2

/* Where a walk is. */
struct dump_walking {
    struct dump_walk *walk;
    struct dump_notes *notes;
    unsigned char *state;
    uint32_t *next; /* children of a node that were looked at */
};

static void enter(struct dump_walking *w, uint32_t node, uint32_t parent)
{
    struct dump_walk *walk = w->walk;
    w->state[node] = OPEN;
    walk->parent[node] = parent;
    walk->depth[node] = parent == DUMP_NONE ? 0 : walk->depth[parent] + 1;
    walk->order[walk->count++] = node;
}

/* Looks at the next child of a node; true if it was entered. */
static bool step(struct dump_walking *w, uint32_t node, uint32_t *into)
{
    const struct dump_node *from = &w->walk->dump->node[node];
    uint32_t *child = &w->walk->child[(size_t)from->first + w->next[node]++];
    struct dump_fault fault = {.node = node, .child = *child, .triangle = DUMP_NONE};
    if (*child < w->walk->dump->node_count && w->state[*child] == UNSEEN) {
        *into = *child;
        return true;
    }
    fault.rule = *child >= w->walk->dump->node_count ? DUMP_CHILD
                 : w->state[*child] == OPEN          ? DUMP_CYCLE
                                                     : DUMP_SHARED;
    dump_note(w->notes, &fault);
    *child = DUMP_NONE;
    return false;
}

/* Goes down as long as there is a child, and up where there is none. */
static void walk_nodes(struct dump_walking *w)
{
    uint32_t at = 0, into;
    enter(w, 0, DUMP_NONE);
    while (at != DUMP_NONE) {
        const struct dump_node *node = &w->walk->dump->node[at];
        if (node->leaf || w->next[at] == node->count) {
            w->state[at] = DONE;
            at = w->walk->parent[at];
        } else if (step(w, at, &into)) {
            enter(w, into, at);
            at = into;
        }
    }
}

static void note_unreached(const struct dump_walking *w)
{
    const struct tree_dump *dump = w->walk->dump;
    for (uint32_t i = 0; i < dump->node_count && !dump->holes; i++)
        if (w->state[i] == UNSEEN && (i == 0 || i != dump->unused))
            dump_note(w->notes, &(struct dump_fault){.rule = DUMP_UNREACHED,
                                                     .node = i,
                                                     .child = DUMP_NONE,
                                                     .triangle = DUMP_NONE});
}

/* The triangles of a leaf; seen[prim] is 0, or 1 plus the last leaf that had it, and taken[i] tells
 * whether a leaf had place i of the list. */
static void walk_leaf(struct dump_walk *walk, uint32_t leaf, uint32_t *seen, bool *taken,
                      struct dump_notes *notes)
{
    const struct tree_dump *dump = walk->dump;
    const struct dump_node *node = &dump->node[leaf];
    struct dump_fault fault = {.node = leaf, .child = DUMP_NONE};
    for (size_t i = node->first; i < (size_t)node->first + node->count; i++) {
        fault.rule = i >= dump->item_count ? DUMP_RANGE : taken[i] ? DUMP_TAKEN : DUMP_RULES;
        if (fault.rule != DUMP_RULES) {
            fault.triangle = (uint32_t)i;
            dump_note(notes, &fault);
            return; /* so that no list of ranges takes longer than that of triangles */
        }
        taken[i] = true;
        fault.triangle = dump->item[i];
        if (fault.triangle >= walk->tri_count)
            fault.rule = DUMP_TRIANGLE;
        else if (seen[fault.triangle] && (!dump->splits || seen[fault.triangle] == leaf + 1))
            fault.rule = DUMP_DOUBLED;
        if (fault.rule != DUMP_RULES)
            dump_note(notes, &fault);
        if (fault.rule == DUMP_TRIANGLE)
            continue;
        seen[fault.triangle] = leaf + 1;
        walk->prim[walk->prim_count++] = fault.triangle;
    }
}

static void walk_leaves(struct dump_walk *walk, uint32_t *seen, bool *taken,
                        struct dump_notes *notes)
{
    for (uint32_t i = 0; i < walk->count; i++) {
        const uint32_t node = walk->order[i];
        walk->first[i] = walk->prim_count;
        if (walk->dump->node[node].leaf)
            walk_leaf(walk, node, seen, taken, notes);
        walk->end[i] = walk->prim_count;
    }
    for (uint32_t prim = 0; prim < walk->tri_count; prim++)
        if (!seen[prim])
            dump_note(notes, &(struct dump_fault){.rule = DUMP_MISSING,
                                                  .node = DUMP_NONE,
                                                  .child = DUMP_NONE,
                                                  .triangle = prim});
}

/* What is below a node ends where that of its last child does. `place` is that of a node. */
static void find_ends(struct dump_walk *walk, uint32_t *place)
{
    for (uint32_t i = 0; i < walk->count; i++)
        place[walk->order[i]] = i;
    for (uint32_t i = walk->count; i-- > 1;) {
        const uint32_t up = place[walk->parent[walk->order[i]]];
        if (walk->end[up] < walk->end[i])
            walk->end[up] = walk->end[i];
    }
}

/* Without a scene and a number in the file: as many as the items name, at most as many as there
 * are items. */
static uint32_t count_triangles(const struct tree_dump *dump, const struct scene *scene)
{
    uint32_t count = 0;
    if (scene || dump->tri_known)
        return scene ? scene->tri_count : dump->tri_count;
    for (size_t i = 0; i < dump->item_count; i++)
        if (dump->item[i] >= count)
            count =
                dump->item[i] < dump->item_count ? dump->item[i] + 1 : (uint32_t)dump->item_count;
    return count;
}

enum status dump_walk_make(const struct tree_dump *dump, const struct scene *scene,
                           struct dump_notes *notes, struct dump_walk *out)
{
    const size_t nodes = dump->node_count;
    *out = (struct dump_walk){.dump = dump, .tri_count = count_triangles(dump, scene)};
    struct dump_walking w = {.walk = out, .notes = notes};
    uint32_t *seen = alloc_zeroed(out->tri_count, sizeof *seen);
    bool *taken = alloc_zeroed(dump->item_count, sizeof *taken);
    w.state = alloc_zeroed(nodes, 1);
    w.next = alloc_zeroed(nodes, sizeof *w.next);
    out->order = alloc_zeroed(nodes, sizeof *out->order);
    out->parent = alloc_zeroed(nodes, sizeof *out->parent);
    out->depth = alloc_zeroed(nodes, sizeof *out->depth);
    out->first = alloc_zeroed(nodes, sizeof *out->first);
    out->end = alloc_zeroed(nodes, sizeof *out->end);
    out->prim = alloc_zeroed(dump->item_count, sizeof *out->prim);
    out->child = alloc_zeroed(dump->child_count, sizeof *out->child);
    bool enough = seen && taken && w.state && w.next && out->order && out->parent && out->depth &&
                  out->first && out->end && out->prim && out->child;
    if (enough && nodes > 0) {
        for (size_t i = 0; i < dump->child_count; i++)
            out->child[i] = dump->child[i];
        for (size_t i = 0; i < nodes; i++)
            out->depth[i] = DUMP_NONE;
        walk_nodes(&w);
        note_unreached(&w);
        walk_leaves(out, seen, taken, notes);
        find_ends(out, w.next);
    }
    free(seen);
    free(taken);
    free(w.state);
    free(w.next);
    return enough ? STATUS_OK : STATUS_MEMORY;
}

void dump_walk_free(struct dump_walk *walk)
{
    free(walk->order);
    free(walk->parent);
    free(walk->depth);
    free(walk->first);
    free(walk->end);
    free(walk->prim);
    free(walk->child);
    *walk = (struct dump_walk){0};
}
