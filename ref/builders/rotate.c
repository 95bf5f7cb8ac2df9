#include "ref/builders/rotate.h"

#include "ref/build/links.h"
#include "ref/builders/climb.h"

/* Child `side` of a node would change places with child `below` of the other child. */
struct rotation {
    double gain; /* decrease of the other child's area; above 0 */
    int side, below;
};

static struct lane_box common_box(const struct spot *spot, uint32_t a, uint32_t b)
{
    struct lane_box both = spot[a].box;
    lane_box_add(&both, &spot[b].box);
    return both;
}

/* The best of four, the first of equally good ones; gain 0 if none is. */
static struct rotation best_of(const struct spot *spot, const uint32_t child[2])
{
    struct rotation best = {0};
    for (int side = 0; side < 2; side++) {
        const struct spot *other = &spot[child[!side]];
        if (other->child[0] == LINKS_NONE)
            continue;
        double area = lane_box_half_area(&other->box);
        for (int below = 0; below < 2; below++) {
            struct lane_box box = common_box(spot, child[side], other->child[!below]);
            double gain = area - lane_box_half_area(&box);
            if (gain > best.gain)
                best = (struct rotation){gain, side, below};
        }
    }
    return best;
}

static void rotate(void *user, struct spots *spots, uint32_t node)
{
    struct spot *spot = spots->spot;
    uint32_t *child = spot[node].child;
    (void)user;
    if (child[0] == LINKS_NONE)
        return;
    struct rotation best = best_of(spot, child);
    if (!(best.gain > 0))
        return;
    uint32_t down = child[best.side], other = child[!best.side];
    uint32_t up = spot[other].child[best.below];
    child[best.side] = up;
    spot[up].parent = node;
    spot[other].child[best.below] = down;
    spot[down].parent = other;
    spot[other].box = common_box(spot, spot[other].child[0], spot[other].child[1]);
    spot[other].area = lanes_half_area(spot[other].box.hi - spot[other].box.lo);
}

enum status tree_rotate(struct bvh *bvh, uint32_t passes, uint32_t threads)
{
    const struct climb_rule rule = {.at = rotate, .leaf = 1};
    return bvh->node_count < 5 ? STATUS_OK : tree_climb(bvh, &rule, passes, threads);
}
