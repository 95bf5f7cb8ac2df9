#include "ref/builders/treelets.h"

#include "ref/build/links.h"
#include "ref/build/room.h"
#include "ref/builders/climb.h"
#include "ref/tree/tree_quality.h"

#define TREELET_LEAVES 7u
#define SUBSETS        (1u << TREELET_LEAVES)

/* Of the subtree of each node that was climbed, as tree_collapse will find it. */
struct treelets {
    double *cost;
    uint32_t *items; /* of a leaf; 0 if it is none */
    uint32_t leaf;
};

/* A node and some below it. inner[0] is the node itself; the others lend their numbers. */
struct treelet {
    uint32_t leaf[TREELET_LEAVES], inner[TREELET_LEAVES - 1];
    uint32_t leaves, inners;
};

/* The cheapest tree of each set of a treelet's leaves, a bit for each. */
struct optimum {
    struct lane_box box[SUBSETS];
    double cost[SUBSETS];
    uint32_t items[SUBSETS];
    uint8_t part[SUBSETS]; /* the second child's leaves; the first child has the lowest one */
};

/* The cost of a node above two subtrees that cost `below` together and have so many items, by the
 * rule of tree_collapse. Sets *items. */
static double cost_above(const struct treelets *t, const struct lane_box *box, double below,
                         uint32_t fst, uint32_t snd, uint32_t *items)
{
    double area = lane_box_half_area(box), split = area * QUALITY_NODE + below;
    double whole = area * QUALITY_TRIANGLE * (fst + snd);
    bool may = fst > 0 && snd > 0 && fst + snd <= t->leaf;
    *items = may && whole <= split ? fst + snd : 0;
    return *items ? whole : split;
}

/* Opens the leaf with the largest area, the first of equal ones, as long as there is one to open
 * and a place for it. */
static void form(const struct spot *spot, uint32_t root, struct treelet *out)
{
    out->inner[0] = root;
    out->leaf[0] = spot[root].child[0];
    out->leaf[1] = spot[root].child[1];
    out->inners = 1;
    out->leaves = 2;
    while (out->leaves < TREELET_LEAVES) {
        uint32_t best = LINKS_NONE;
        for (uint32_t k = 0; k < out->leaves; k++)
            if (spot[out->leaf[k]].child[0] != LINKS_NONE &&
                (best == LINKS_NONE || spot[out->leaf[k]].area > spot[out->leaf[best]].area))
                best = k;
        if (best == LINKS_NONE)
            return;
        uint32_t opened = out->leaf[best];
        out->inner[out->inners++] = opened;
        out->leaf[best] = spot[opened].child[0];
        out->leaf[out->leaves++] = spot[opened].child[1];
    }
}

/* Divides a set of two leaves or more in the cheapest way, the first of equally cheap ones. Sets of
 * fewer leaves, and those that are numerically smaller, are done. */
static void divide(const struct treelets *t, struct optimum *o, uint32_t set)
{
    uint32_t low = set & (~set + 1), rest = set ^ low, part = rest & (~rest + 1);
    uint32_t best = part;
    double least = o->cost[part] + o->cost[set ^ part];
    for (part = (part - rest) & rest; part != 0; part = (part - rest) & rest) {
        double cost = o->cost[part] + o->cost[set ^ part];
        best = cost < least ? part : best;
        least = cost < least ? cost : least;
    }
    o->part[set] = (uint8_t)best;
    o->box[set] = o->box[low];
    lane_box_add(&o->box[set], &o->box[rest]);
    o->cost[set] =
        cost_above(t, &o->box[set], least, o->items[best], o->items[set ^ best], &o->items[set]);
}

static void optimise(const struct treelets *t, const struct spot *spot,
                     const struct treelet *treelet, struct optimum *o)
{
    for (uint32_t k = 0; k < treelet->leaves; k++) {
        uint32_t node = treelet->leaf[k];
        o->box[1u << k] = spot[node].box;
        o->cost[1u << k] = t->cost[node];
        o->items[1u << k] = t->items[node];
    }
    for (uint32_t set = 1; set < 1u << treelet->leaves; set++)
        if (set & (set - 1))
            divide(t, o, set);
}

/* Links the tree of a set; returns its root. `lent` numbers of inner nodes are used already. */
static uint32_t rebuild(const struct treelets *t, struct spot *spot, const struct treelet *treelet,
                        const struct optimum *o, uint32_t set, uint32_t *lent)
{
    if (!(set & (set - 1)))
        return treelet->leaf[__builtin_ctz(set)];
    uint32_t node = treelet->inner[(*lent)++];
    const uint32_t side[2] = {set ^ o->part[set], o->part[set]};
    for (int k = 0; k < 2; k++) {
        uint32_t child = rebuild(t, spot, treelet, o, side[k], lent);
        spot[node].child[k] = child;
        spot[child].parent = node;
    }
    spot[node].box = o->box[set];
    spot[node].area = lanes_half_area(o->box[set].hi - o->box[set].lo);
    t->cost[node] = o->cost[set];
    t->items[node] = o->items[set];
    return node;
}

static void restructure(void *user, struct spots *spots, uint32_t node)
{
    const struct treelets *t = user;
    struct spot *spot = spots->spot;
    const uint32_t *child = spot[node].child;
    struct treelet treelet;
    struct optimum best;
    uint32_t lent = 0;
    if (child[0] == LINKS_NONE) {
        t->items[node] = 1;
        t->cost[node] = lane_box_half_area(&spot[node].box) * QUALITY_TRIANGLE;
        return;
    }
    t->cost[node] = cost_above(t, &spot[node].box, t->cost[child[0]] + t->cost[child[1]],
                               t->items[child[0]], t->items[child[1]], &t->items[node]);
    form(spot, node, &treelet);
    if (treelet.leaves < 3)
        return;
    optimise(t, spot, &treelet, &best);
    uint32_t all = (1u << treelet.leaves) - 1;
    if (best.cost[all] < t->cost[node])
        (void)rebuild(t, spot, &treelet, &best, all, &lent);
}

enum status tree_treelets(struct bvh *bvh, uint32_t leaf, uint32_t rounds, uint32_t threads)
{
    if (bvh->node_count < 5)
        return STATUS_OK; /* there is one tree of up to 2 leaves */
    struct treelets t = {.leaf = leaf};
    t.cost = room_make(bvh->node_count, sizeof *t.cost);
    t.items = room_make(bvh->node_count, sizeof *t.items);
    const struct climb_rule rule = {.at = restructure, .user = &t, .leaf = leaf};
    enum status status = STATUS_MEMORY;
    if (t.cost && t.items)
        status = tree_climb(bvh, &rule, rounds, threads);
    room_free(t.cost);
    room_free(t.items);
    return status;
}
