#include "ref/build/links.h"

#include "ref/build/grow.h"
#include "ref/build/room.h"
#include "ref/tree/tree_quality.h"

/* A tree being written. */
struct writer {
    const struct links *links;
    struct bvh_node *node;
    uint32_t *prim;
    uint32_t node_count, prim_count;
    uint32_t *list; /* one element per leaf */
};

static struct lane_box write_leaf(struct writer *w, uint32_t from)
{
    uint32_t items = 0, first = w->prim_count;
    struct lane_box box = w->links->leaf(w->links->user, from, w->prim + first, &items);
    w->node[w->node_count++] = (struct bvh_node){lane_box_store(&box), 0, 0, first, items};
    w->prim_count += items;
    return box;
}

static struct lane_box write_inner(struct writer *w, uint32_t mine, uint32_t first, uint32_t snd,
                                   struct lane_box box, const struct lane_box *other)
{
    lane_box_add(&box, other);
    w->node[mine] = (struct bvh_node){lane_box_store(&box), mine + 1, snd, first, 0};
    return box;
}

/* Writes a balanced tree of the leaves in list[0 .. count). */
static struct lane_box write_halves(struct writer *w, const uint32_t *list, uint32_t count)
{
    if (count == 1)
        return write_leaf(w, list[0]);
    uint32_t mine = w->node_count++, first = w->prim_count;
    struct lane_box box = write_halves(w, list, count / 2);
    uint32_t snd = w->node_count;
    struct lane_box other = write_halves(w, list + count / 2, count - count / 2);
    return write_inner(w, mine, first, snd, box, &other);
}

/* Lists the leaves below a node in their order. Waiting nodes are stacked downward from the list's
 * end. They never meet the finished ones: there are never more waiting nodes than leaves to
 * come. */
static void list_leaves(struct writer *w, uint32_t from)
{
    uint32_t done = 0, waiting = w->links->leaves[from];
    uint32_t *list = w->list;
    list[--waiting] = from;
    while (waiting < w->links->leaves[from]) {
        uint32_t node = list[waiting++];
        const uint32_t *child = w->links->child[node];
        if (child[0] == LINKS_NONE) {
            list[done++] = node;
        } else {
            list[--waiting] = child[1];
            list[--waiting] = child[0];
        }
    }
}

static struct lane_box write_node(struct writer *w, uint32_t from, uint32_t depth)
{
    const uint32_t *child = w->links->child[from], *leaves = w->links->leaves;
    if (child[0] == LINKS_NONE)
        return write_leaf(w, from);
    uint32_t larger = leaves[child[0]] > leaves[child[1]] ? leaves[child[0]] : leaves[child[1]];
    if (depth + 1 + log2_ceil(larger) > GROW_DEPTH_MOST) {
        list_leaves(w, from);
        return write_halves(w, w->list, leaves[from]);
    }
    uint32_t mine = w->node_count++, first = w->prim_count;
    struct lane_box box = write_node(w, child[0], depth + 1);
    uint32_t snd = w->node_count;
    struct lane_box other = write_node(w, child[1], depth + 1);
    return write_inner(w, mine, first, snd, box, &other);
}

enum status links_write(const struct links *links, struct bvh *out)
{
    uint32_t count = 2 * links->leaves[links->root] - 1;
    struct writer w = {.links = links};
    *out = (struct bvh){0};
    w.node = room_make(count, sizeof *w.node);
    w.prim = room_make(links->items, sizeof *w.prim);
    w.list = room_make(links->leaves[links->root], sizeof *w.list);
    bool enough = w.node && w.prim && w.list;
    if (enough) {
        (void)write_node(&w, links->root, 0);
        *out = (struct bvh){.node = w.node,
                            .prim = w.prim,
                            .node_count = w.node_count,
                            .prim_count = w.prim_count,
                            .tri_count = links->tris};
    } else {
        room_free(w.node);
        room_free(w.prim);
    }
    room_free(w.list);
    return enough ? STATUS_OK : STATUS_MEMORY;
}

/* Decides which nodes become leaves: bottom-up, as children come after their parents. Writes each
 * node's cost to `cost`, and to `items` its number of items if they may be one leaf, else 0. */
static void collapse_mark(const struct bvh *bvh, uint32_t leaf, double *cost, uint32_t *items)
{
    for (uint32_t i = bvh->node_count; i-- > 0;) {
        const struct bvh_node *node = &bvh->node[i];
        double area = box_half_area(&node->bounds);
        if (node->item_count) {
            items[i] = node->item_count;
            cost[i] = area * QUALITY_TRIANGLE * node->item_count;
            continue;
        }
        uint32_t all = items[node->fst] + items[node->snd];
        bool may = items[node->fst] && items[node->snd] && all <= leaf &&
                   bvh_items_differ(bvh, node->item_first, all);
        double split = area * QUALITY_NODE + cost[node->fst] + cost[node->snd];
        double whole = area * QUALITY_TRIANGLE * all;
        items[i] = may && whole <= split ? all : 0;
        cost[i] = items[i] ? whole : split;
    }
}

/* Writes the remaining nodes over the tree; items becomes each node's new index. Returns the number
 * of remaining nodes. */
static uint32_t collapse_write(struct bvh *bvh, uint32_t *items)
{
    uint32_t count = 0, end = 0; /* of the items in nodes already written */
    for (uint32_t i = 0; i < bvh->node_count; i++) {
        struct bvh_node node = bvh->node[i];
        if (node.item_first < end)
            continue; /* it is below a new leaf */
        node.item_count = items[i];
        end = node.item_first + node.item_count;
        items[i] = count;
        bvh->node[count++] = node;
    }
    for (uint32_t i = 0; i < count; i++) {
        struct bvh_node *node = &bvh->node[i];
        node->fst = node->item_count ? 0 : i + 1;
        node->snd = node->item_count ? 0 : items[node->snd];
    }
    return count;
}

enum status tree_collapse(struct bvh *bvh, uint32_t leaf)
{
    double *cost = room_make(bvh->node_count, sizeof *cost);
    uint32_t *items = room_make(bvh->node_count, sizeof *items);
    bool enough = cost && items;
    if (enough && bvh->node_count) {
        collapse_mark(bvh, leaf, cost, items);
        bvh->node_count = collapse_write(bvh, items);
    }
    room_free(cost);
    room_free(items);
    return enough ? STATUS_OK : STATUS_MEMORY;
}

enum status tree_collapsed_cost(const struct bvh *bvh, uint32_t leaf, double *out)
{
    double *cost = room_make(bvh->node_count, sizeof *cost);
    uint32_t *items = room_make(bvh->node_count, sizeof *items);
    bool enough = cost && items;
    *out = 0;
    if (enough && bvh->node_count) {
        collapse_mark(bvh, leaf, cost, items);
        *out = cost[0];
    }
    room_free(cost);
    room_free(items);
    return enough ? STATUS_OK : STATUS_MEMORY;
}

void tree_drop(struct bvh *bvh)
{
    room_free(bvh->node);
    room_free(bvh->prim);
    *bvh = (struct bvh){0};
}
