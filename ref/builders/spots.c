#include "ref/builders/spots.h"

#include "ref/build/links.h"
#include "ref/build/room.h"

#include <string.h>

#define SEEK_STACK 128u
#define SEEK_MOST  2000u /* most nodes visited in one search */

static float union_area(const struct lane_box *a, const struct lane_box *b)
{
    struct lane_box both = *a;
    lane_box_add(&both, b);
    return lanes_half_area(both.hi - both.lo);
}

enum status spots_make(const struct bvh *bvh, struct spots *out)
{
    *out = (struct spots){.spot = room_make(bvh->node_count, sizeof *out->spot)};
    if (!out->spot)
        return STATUS_MEMORY;
    out->count = bvh->node_count;
    struct lane_box root = lane_box_load(&bvh->node[0].bounds);
    lanes unit = lanes_all(lanes_scale(&root));
    out->spot[0].parent = LINKS_NONE;
    for (uint32_t i = 0; i < out->count; i++) {
        const struct bvh_node *node = &bvh->node[i];
        struct spot *spot = &out->spot[i];
        spot->box = lane_box_load(&node->bounds);
        spot->box.lo *= unit;
        spot->box.hi *= unit;
        spot->area = lanes_half_area(spot->box.hi - spot->box.lo);
        bool leaf = node->item_count > 0;
        spot->child[0] = leaf ? LINKS_NONE : node->fst;
        spot->child[1] = leaf ? LINKS_NONE : node->snd;
        if (!leaf)
            out->spot[node->fst].parent = out->spot[node->snd].parent = i;
    }
    return STATUS_OK;
}

void spots_free(struct spots *spots)
{
    room_free(spots->spot);
    *spots = (struct spots){0};
}

static uint32_t sibling_of(const struct spot *spot, uint32_t node)
{
    const uint32_t *child = spot[spot[node].parent].child;
    return child[child[0] == node];
}

/* A search for the best place of one node. */
struct seek {
    const struct spot *spot;
    const struct spot *moved;
    uint32_t target, visits;
    float gain;
};

/* Searches the subtree of `top` for better places; `fall` is the decrease of the cost before the
 * node is inserted again. */
static void seek_below(struct seek *s, uint32_t top, float fall)
{
    struct {
        uint32_t node;
        float fall;
    } stack[SEEK_STACK];
    uint32_t waiting = 0;
    stack[waiting++].node = top;
    stack[0].fall = fall;
    while (waiting > 0 && s->visits < SEEK_MOST) {
        uint32_t node = stack[--waiting].node;
        float left = stack[waiting].fall;
        /* The new parent is at least as large as the moved node. */
        if (left - s->moved->area <= s->gain)
            continue;
        s->visits++;
        const struct spot *spot = &s->spot[node];
        float gain = left - union_area(&spot->box, &s->moved->box);
        if (gain > s->gain) {
            s->gain = gain;
            s->target = node;
        }
        /* One level deeper, `spot` itself is enlarged instead. */
        if (spot->child[0] == LINKS_NONE || gain + spot->area - s->moved->area <= s->gain ||
            waiting + 2 > SEEK_STACK)
            continue;
        for (int k = 1; k >= 0; k--) {
            stack[waiting].node = spot->child[k];
            stack[waiting++].fall = gain + spot->area;
        }
    }
}

uint32_t spots_seek(const struct spots *spots, uint32_t node, float *gain)
{
    const struct spot *spot = spots->spot;
    struct seek s = {.spot = spot, .moved = &spot[node], .target = LINKS_NONE};
    *gain = 0;
    if (node == 0 || spot[node].parent == 0)
        return LINKS_NONE;
    uint32_t at = spot[node].parent, other = sibling_of(spot, node);
    /* The box of `at` without the node. At first it is that of the sibling, which replaces the
     * parent. */
    struct lane_box rest = spot[other].box;
    float fall = spot[at].area;
    for (;;) {
        seek_below(&s, other, fall);
        uint32_t parent = spot[at].parent;
        if (at != spot[node].parent) {
            lane_box_add(&rest, &spot[other].box);
            float kept = lanes_half_area(rest.hi - rest.lo);
            /* As a sibling of `at`, the node gets a parent as large as `at` was. */
            if (parent != LINKS_NONE && fall - kept > s.gain) {
                s.gain = fall - kept;
                s.target = at;
            }
            fall += spot[at].area - kept;
        }
        if (parent == LINKS_NONE)
            break;
        other = sibling_of(spot, at);
        at = parent;
    }
    *gain = s.gain;
    return s.target;
}

/* Refits the boxes from a node upward until one does not change; returns the increase of the
 * areas. */
static double fit_up(struct spot *spot, uint32_t node)
{
    double rise = 0;
    for (; node != LINKS_NONE; node = spot[node].parent) {
        struct lane_box box = spot[spot[node].child[0]].box;
        lane_box_add(&box, &spot[spot[node].child[1]].box);
        if (memcmp(&box, &spot[node].box, sizeof box) == 0)
            break;
        float area = lanes_half_area(box.hi - box.lo);
        rise += (double)area - (double)spot[node].area;
        spot[node].box = box;
        spot[node].area = area;
    }
    return rise;
}

/* Removes a node and its parent, and inserts both beside `target`. Returns the increase of the
 * areas. */
static double move(struct spot *spot, uint32_t node, uint32_t target)
{
    uint32_t parent = spot[node].parent, other = sibling_of(spot, node);
    uint32_t above = spot[parent].parent;
    float before = spot[parent].area;
    spot[above].child[spot[above].child[1] == parent] = other;
    spot[other].parent = above;
    double rise = fit_up(spot, above);
    uint32_t place = spot[target].parent;
    spot[place].child[spot[place].child[1] == target] = parent;
    spot[parent].parent = place;
    spot[parent].child[0] = target;
    spot[parent].child[1] = node;
    spot[target].parent = parent;
    spot[parent].box = spot[target].box;
    lane_box_add(&spot[parent].box, &spot[node].box);
    spot[parent].area = lanes_half_area(spot[parent].box.hi - spot[parent].box.lo);
    rise += (double)spot[parent].area - (double)before;
    return rise + fit_up(spot, place);
}

double spots_move(struct spots *spots, uint32_t node, uint32_t target)
{
    struct spot *spot = spots->spot;
    uint32_t parent = spot[node].parent;
    /* Earlier moves may have made the target invalid. */
    if (parent == 0 || target == parent || target == 0)
        return 0;
    uint32_t other = sibling_of(spot, node);
    if (target == other)
        return 0;
    for (uint32_t at = target; at != LINKS_NONE; at = spot[at].parent)
        if (at == node)
            return 0;
    double rise = move(spot, node, target);
    if (rise < 0)
        return -rise;
    (void)move(spot, node, other);
    return 0;
}

static struct lane_box leaf(const void *user, uint32_t node, uint32_t *prim, uint32_t *items)
{
    const struct bvh *bvh = user;
    const struct bvh_node *from = &bvh->node[node];
    *items = from->item_count;
    memcpy(prim, bvh->prim + from->item_first, from->item_count * sizeof *prim);
    return lane_box_load(&from->bounds);
}

enum status spots_write(const struct spots *spots, const struct bvh *bvh, struct bvh *out)
{
    const uint32_t nodes = spots->count;
    struct links links = {
        .leaf = leaf, .user = bvh, .items = bvh->prim_count, .tris = bvh->tri_count};
    *out = (struct bvh){0};
    links.child = room_make(nodes, sizeof *links.child);
    links.leaves = room_make(nodes, sizeof *links.leaves);
    uint32_t *list = room_make(nodes, sizeof *list);
    enum status status = STATUS_MEMORY;
    if (links.child && links.leaves && list) {
        uint32_t count = 1;
        list[0] = 0;
        for (uint32_t i = 0; i < count; i++) {
            const struct spot *spot = &spots->spot[list[i]];
            memcpy(links.child[list[i]], spot->child, sizeof spot->child);
            for (int k = 0; k < 2 && spot->child[0] != LINKS_NONE; k++)
                list[count++] = spot->child[k];
        }
        while (count-- > 0) {
            const uint32_t *child = links.child[list[count]];
            links.leaves[list[count]] =
                child[0] == LINKS_NONE ? 1 : links.leaves[child[0]] + links.leaves[child[1]];
        }
        status = links_write(&links, out);
    }
    room_free(links.child);
    room_free(links.leaves);
    room_free(list);
    return status;
}
