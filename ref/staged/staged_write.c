/* Trees in stages as canonical ones. */
#include "ref/build/grow.h"
#include "ref/build/links.h"
#include "ref/build/room.h"
#include "ref/staged/staged_inner.h"

#include <stdlib.h>
#include <string.h>

/* The nodes in pre-order, as they are found from the root. */
struct staged_walk {
    const struct staged *staged;
    uint32_t *link;  /* 2 count - 1 */
    uint32_t *snd;   /* of each of these that is inner: where its second child stands */
    uint32_t *depth; /* of each */
    uint32_t *open;  /* stack of nodes whose second child is still to come */
    uint8_t *seen;   /* per link: bit 0 inner node, bit 1 leaf */
    uint32_t deepest;
};

static enum status no_tree(struct reason *reason, uint32_t link, const char *rule)
{
    return fail(reason, STATUS_DEVICE, "the links are no tree: %s %u %s",
                link & STAGED_LEAF ? "leaf" : "node", link & ~STAGED_LEAF, rule);
}

static enum status visit(struct staged_walk *w, uint32_t link, struct reason *reason)
{
    const struct staged *staged = w->staged;
    const bool leaf = (link & STAGED_LEAF) != 0;
    const uint32_t at = link & ~STAGED_LEAF, bit = leaf ? 2 : 1;
    if (at >= (leaf ? staged->count : staged->count - 1))
        return no_tree(reason, link, "is out of range");
    if (w->seen[at] & bit)
        return no_tree(reason, link, "has two parents");
    w->seen[at] |= (uint8_t)bit;
    if (leaf && staged->order[at] >= staged->count)
        return no_tree(reason, link, "names no triangle");
    return STATUS_OK;
}

/* Lists the nodes. Each is visited once, so the list never overflows. */
static enum status walk(struct staged_walk *w, struct reason *reason)
{
    uint32_t found = 0, open = 0, link = w->staged->root, depth = 0;
    for (;;) {
        enum status status = visit(w, link, reason);
        if (status)
            return status;
        w->link[found] = link;
        w->depth[found] = depth;
        w->deepest = depth > w->deepest ? depth : w->deepest;
        if (!(link & STAGED_LEAF)) {
            w->open[open++] = found++;
            link = w->staged->child[link][0];
            depth++;
            continue;
        }
        found++;
        if (open == 0)
            break;
        uint32_t parent = w->open[--open];
        w->snd[parent] = found;
        link = w->staged->child[w->link[parent]][1];
        depth = w->depth[parent] + 1;
    }
    return found == 2 * w->staged->count - 1
               ? STATUS_OK
               : fail(reason, STATUS_DEVICE, "the links are no tree: %u of %u nodes below the root",
                      found, 2 * w->staged->count - 1);
}

static enum status check_order(const struct staged_walk *w, struct reason *reason)
{
    const struct staged *staged = w->staged;
    memset(w->seen, 0, staged->count);
    for (uint32_t i = 0; i < staged->count; i++) {
        if (w->seen[staged->order[i]]++)
            return fail(reason, STATUS_DEVICE, "the order has triangle %u twice", staged->order[i]);
    }
    return STATUS_OK;
}

struct box staged_box_of(const struct staged *staged, uint32_t link)
{
    const uint32_t *bits = staged_box(staged, link);
    struct box box;
    for (int k = 0; k < 3; k++) {
        box.lo[k] = float_from_bits(bits[k]);
        box.hi[k] = float_from_bits(bits[3 + k]);
    }
    return box;
}

static enum status write(const struct staged_walk *w, struct bvh *out)
{
    const struct staged *staged = w->staged;
    const uint32_t nodes = 2 * staged->count - 1;
    out->node = room_make(nodes, sizeof *out->node);
    out->prim = room_make(staged->count, sizeof *out->prim);
    if (!out->node || !out->prim)
        return STATUS_MEMORY;
    out->tri_count = staged->count;
    for (; out->node_count < nodes; out->node_count++) {
        uint32_t i = out->node_count, link = w->link[i];
        struct bvh_node *node = &out->node[i];
        *node =
            (struct bvh_node){.bounds = staged_box_of(staged, link), .item_first = out->prim_count};
        if (link & STAGED_LEAF) {
            node->item_count = 1;
            out->prim[out->prim_count++] = staged->order[link & ~STAGED_LEAF];
        } else {
            node->fst = i + 1;
            node->snd = w->snd[i];
        }
    }
    return STATUS_OK;
}

static struct lane_box leaf_of(const void *user, uint32_t at, uint32_t *prim, uint32_t *items)
{
    const struct staged_walk *w = user;
    const uint32_t link = w->link[at];
    const struct box box = staged_box_of(w->staged, link);
    *items = 1;
    *prim = w->staged->order[link & ~STAGED_LEAF];
    return lane_box_load(&box);
}

/* The same with halves where it is too deep; the boxes of inner nodes are those of the leaves. */
static enum status write_shallow(const struct staged_walk *w, struct bvh *out)
{
    const uint32_t nodes = 2 * w->staged->count - 1;
    struct links links = {
        .leaf = leaf_of, .user = w, .items = w->staged->count, .tris = w->staged->count};
    links.child = room_make(nodes, sizeof *links.child);
    links.leaves = room_make(nodes, sizeof *links.leaves);
    enum status status = links.child && links.leaves ? STATUS_OK : STATUS_MEMORY;
    for (uint32_t i = nodes; i-- > 0 && !status;) {
        bool leaf = (w->link[i] & STAGED_LEAF) != 0;
        links.child[i][0] = leaf ? LINKS_NONE : i + 1;
        links.child[i][1] = leaf ? LINKS_NONE : w->snd[i];
        links.leaves[i] = leaf ? 1 : links.leaves[i + 1] + links.leaves[w->snd[i]];
    }
    if (!status)
        status = links_write(&links, out);
    room_free(links.child);
    room_free(links.leaves);
    return status;
}

static enum status write_all(struct staged_walk *w, uint32_t leaf, struct bvh *out,
                             struct reason *reason)
{
    enum status status = walk(w, reason);
    if (!status)
        status = check_order(w, reason);
    if (status)
        return status;
    status = w->deepest > GROW_DEPTH_MOST ? write_shallow(w, out) : write(w, out);
    if (!status)
        status = tree_collapse(out, leaf);
    return status ? fail(reason, status, "no memory for a tree of %u triangles", w->staged->count)
                  : STATUS_OK;
}

enum status staged_write(const struct staged *staged, uint32_t leaf, struct bvh *out,
                         struct reason *reason)
{
    const size_t n = staged->count;
    struct staged_walk w = {.staged = staged};
    *out = (struct bvh){0};
    if (n == 0)
        return STATUS_OK;
    w.link = room_make(2 * n, sizeof *w.link);
    w.snd = room_make(2 * n, sizeof *w.snd);
    w.depth = room_make(2 * n, sizeof *w.depth);
    w.open = room_make(n, sizeof *w.open);
    w.seen = alloc_zeroed(n, 1);
    enum status status = w.link && w.snd && w.depth && w.open && w.seen
                             ? write_all(&w, leaf, out, reason)
                             : fail(reason, STATUS_MEMORY, "no memory for a tree");
    room_free(w.link);
    room_free(w.snd);
    room_free(w.depth);
    room_free(w.open);
    free(w.seen);
    if (status)
        tree_drop(out);
    return status;
}
