#include "ref/packed/packed_walk.h"

#include <stdio.h>
#include <stdlib.h>

struct packed_name packed_name(const struct packed *packed, uint32_t ref)
{
    struct packed_name name;
    const struct layout *layout = packed->layout;
    uint32_t slot = ref - packed->node_count;
    if (ref < packed->node_count)
        snprintf(name.text, sizeof name.text, "record %u", ref);
    else if (layout_is_wide(layout) && layout_refs(layout) == 1 + layout->width)
        snprintf(name.text, sizeof name.text, "record %u, slot %u", slot / layout->width,
                 slot % layout->width);
    else
        snprintf(name.text, sizeof name.text, "reference %u", ref);
    return name;
}

/* Appends a visit unless the node was reached before. `seen` has a bit per record. */
static void reach(struct packed_walk *walk, uint8_t *seen, const struct packed_visit *visit)
{
    uint8_t bit = (uint8_t)(1u << visit->ref % 8);
    if (seen[visit->ref / 8] & bit) {
        if (walk->repeats++ == 0)
            walk->repeat_ref = visit->ref;
        return;
    }
    seen[visit->ref / 8] |= bit;
    walk->visit[walk->visit_count++] = *visit;
    if (visit->stack > walk->stack_most)
        walk->stack_most = visit->stack;
}

/* Appends the children of visit `i`. */
static void expand(const struct packed *packed, struct packed_walk *walk, uint8_t *seen, uint32_t i)
{
    struct wide node;
    packed->layout->load(packed, walk->visit[i].ref, &node);
    if (node.item_count > 0 && node.child_count == 0)
        return;
    uint32_t least = layout_is_wide(packed->layout) ? 1 : 2;
    if (node.child_count < least) {
        if (walk->bad_refs == 0)
            walk->bad_ref = walk->visit[i].ref;
        walk->bad_refs += least - node.child_count;
    }
    /* A wide node pushes all its children before the nearest is popped. */
    uint32_t pushed = walk->visit[i].stack + node.child_count;
    if (layout_is_wide(packed->layout) && pushed > walk->stack_most)
        walk->stack_most = pushed;
    for (uint32_t c = 0; c < node.child_count; c++) {
        struct packed_visit child = {.ref = node.child[c],
                                     .parent = i,
                                     .stack = walk->visit[i].stack + node.child_count - 1,
                                     .box = node.box[c]};
        reach(walk, seen, &child);
    }
}

enum status packed_walk_make(const struct packed *packed, struct packed_walk *out)
{
    *out = (struct packed_walk){0};
    if (packed->node_count == 0)
        return STATUS_OK;
    if (!packed_ref_valid(packed, packed->root)) {
        out->bad_refs = 1;
        out->bad_ref = packed->root;
        return STATUS_OK;
    }
    uint8_t *seen = alloc_zeroed((size_t)packed->ref_count / 8 + 1, 1);
    out->visit = alloc_zeroed(packed->ref_count, sizeof *out->visit);
    if (!seen || !out->visit) {
        free(seen);
        packed_walk_free(out);
        return STATUS_MEMORY;
    }
    struct packed_visit root = {.ref = packed->root,
                                .box = packed->layout->box(packed, packed->root)};
    reach(out, seen, &root);
    for (uint32_t i = 0; i < out->visit_count; i++)
        expand(packed, out, seen, i);
    free(seen);
    return STATUS_OK;
}

void packed_walk_free(struct packed_walk *walk)
{
    free(walk->visit);
    *walk = (struct packed_walk){0};
}

enum status packed_links(const struct packed *packed, uint32_t **out, struct reason *reason)
{
    const char *name = packed->layout->name;
    struct packed_walk walk;
    *out = NULL;
    if (layout_is_wide(packed->layout))
        return fail(reason, STATUS_UNSUPPORTED,
                    "%s: a traversal without a stack needs a binary layout", name);
    if (packed->node_count == 0)
        return STATUS_OK;
    enum status status = packed_walk_make(packed, &walk);
    uint32_t *parent = alloc_zeroed(packed->ref_count, sizeof *parent);
    if (status || !parent)
        status = fail(reason, STATUS_MEMORY, "%s: no memory for the links of %u records", name,
                      packed->ref_count);
    else if (walk.repeats > 0 || walk.bad_refs > 0)
        status = fail(reason, STATUS_LIMIT,
                      "%s: record %u %s: without a stack only a tree can be walked", name,
                      walk.repeats > 0 ? walk.repeat_ref : walk.bad_ref,
                      walk.repeats > 0 ? "is reached more than once" : "lacks a child");
    for (uint32_t r = 0; r < packed->ref_count && !status; r++)
        parent[r] = ABI_NO_PRIM;
    for (uint32_t i = 1; i < walk.visit_count && !status; i++)
        parent[walk.visit[i].ref] = walk.visit[walk.visit[i].parent].ref;
    packed_walk_free(&walk);
    if (status)
        free(parent);
    else
        *out = parent;
    return status;
}
