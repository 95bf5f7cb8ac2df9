/* Top-down by the surface area heuristic, with every position tried: triangles are sorted by centre
 * along each axis once, and splits preserve the orders (Wald and Havran 2006, section 4, for
 * kd-trees; here with centres, so that each triangle is on one side). Takes the cheapest of all
 * splits between neighbours in one of the three orders; the first of equal ones. Ours: areas
 * relative to the node, and the depth limit. */
#include "ref/build/few.h"
#include "ref/build/grow.h"
#include "ref/build/keys.h"
#include "ref/build/room.h"

#include <math.h>
#include <string.h>

/* In grow_range, centres are the bounds of the range's triangles. */
struct sweep {
    const struct ref *ref;
    uint32_t *order[3]; /* triangles by centre along each axis; those of a range are adjacent */
    uint32_t *spare[3]; /* scratch of the same size, for the same ranges */
    float *above[3];    /* likewise: cost of a second side that begins here */
    uint8_t *side;      /* per triangle: 1 is the second side */
    uint32_t leaf;
};

/* Larger ranges use one thread per axis. */
#define ALONE 16384u

struct sweep_cut {
    float cost;
    uint32_t left; /* 0: none */
};

static lanes reach_of(const struct lane_box *box, lanes unit)
{
    return lane_box_reach(box) * unit;
}

static struct sweep_cut cut_axis(const struct sweep *s, const struct grow_range *range, int axis,
                                 float best)
{
    const uint32_t *order = s->order[axis] + range->first;
    float *above = s->above[axis] + range->first;
    lanes unit = lanes_all(lanes_unit(lane_box_reach(&range->centres)));
    struct lane_box side = lane_box_empty();
    for (uint32_t i = range->count; i-- > 1;) {
        lane_box_add(&side, &s->ref[order[i]].box);
        above[i] = lanes_half_area(reach_of(&side, unit)) * (float)(range->count - i);
    }
    struct sweep_cut cut = {best, 0};
    side = lane_box_empty();
    for (uint32_t i = 1; i < range->count; i++) {
        lane_box_add(&side, &s->ref[order[i - 1]].box);
        float cost = lanes_half_area(reach_of(&side, unit)) * (float)i + above[i];
        if (cost < cut.cost)
            cut = (struct sweep_cut){cost, i};
    }
    return cut;
}

/* Moves the second side's triangles behind the others; both keep their order. */
static void divide_order(const struct sweep *s, const struct grow_range *range, int axis)
{
    uint32_t *order = s->order[axis] + range->first, *spare = s->spare[axis] + range->first;
    uint32_t left = 0, right = 0;
    for (uint32_t i = 0; i < range->count; i++) {
        uint32_t prim = order[i];
        uint32_t second = s->side[prim];
        order[left] = prim;
        spare[right] = prim;
        left += 1 - second;
        right += second;
    }
    memcpy(order + left, spare, right * sizeof *order);
}

/* The first `left` triangles along `axis` become the first side. */
static void divide_at(const struct sweep *s, const struct grow_range *range,
                      struct grow_range child[2], int axis, uint32_t left, uint32_t threads)
{
    const uint32_t *order = s->order[axis] + range->first;
    child[0].centres = child[1].centres = lane_box_empty();
    for (uint32_t i = 0; i < range->count; i++) {
        s->side[order[i]] = i >= left;
        lane_box_add(&child[i >= left].centres, &s->ref[order[i]].box);
    }
#pragma omp parallel for schedule(static, 1)                                                       \
    num_threads(threads) if (threads > 1 && range->count > ALONE)
    for (int k = 0; k < 3; k++)
        if (k != axis)
            divide_order(s, range, k);
}

/* The range's first and last centres are equal along every axis: its triangles cannot be
 * distinguished, and every split costs the same. */
static bool is_point(const struct sweep *s, const struct grow_range *range)
{
    bool point = true;
    for (int k = 0; k < 3; k++) {
        const uint32_t *order = s->order[k] + range->first;
        point = point &&
                ref_centre(&s->ref[order[0]])[k] == ref_centre(&s->ref[order[range->count - 1]])[k];
    }
    return point;
}

static uint32_t halve(void *user, const struct grow_range *range, struct grow_range child[2])
{
    lanes reach = lane_box_reach(&range->centres);
    int axis = reach[1] > reach[0] ? 1 : 0;
    axis = reach[2] > reach[axis] ? 2 : axis;
    divide_at(user, range, child, axis, range->count / 2, 1);
    return range->count / 2;
}

static uint32_t split(void *user, const struct grow_range *range, struct grow_range child[2],
                      uint32_t threads)
{
    const struct sweep *s = user;
    struct sweep_cut cut[3];
    bool may = range->count <= s->leaf;
    if (is_point(s, range))
        return may ? 0 : halve(user, range, child);
    float area = lanes_half_area(
        reach_of(&range->centres, lanes_all(lanes_unit(lane_box_reach(&range->centres)))));
    float most = may ? area * ((float)range->count - COST_NODE) : INFINITY;
#pragma omp parallel for schedule(static, 1)                                                       \
    num_threads(threads) if (threads > 1 && range->count > ALONE)
    for (int k = 0; k < 3; k++)
        cut[k] = cut_axis(s, range, k, most);
    int axis = cut[1].cost < cut[0].cost ? 1 : 0;
    axis = cut[2].cost < cut[axis].cost ? 2 : axis;
    if (cut[axis].left == 0)
        return 0;
    divide_at(s, range, child, axis, cut[axis].left, threads);
    return cut[axis].left;
}

static struct lane_box leaf(void *user, const struct grow_range *range, uint32_t *prim)
{
    const struct sweep *s = user;
    for (uint32_t i = 0; i < range->count; i++)
        prim[i] = ref_prim(&s->ref[s->order[0][range->first + i]]);
    return range->centres;
}

static enum status order_make(struct sweep *s, uint32_t count, int axis, uint32_t threads)
{
    uint64_t *key = room_make(count, sizeof *key);
    s->order[axis] = room_make(count, sizeof *s->order[axis]);
    s->spare[axis] = room_make(count, sizeof *s->spare[axis]);
    s->above[axis] = room_make(count, sizeof *s->above[axis]);
    enum status status = STATUS_MEMORY;
    if (key && s->order[axis] && s->spare[axis] && s->above[axis]) {
        for (uint32_t i = 0; i < count; i++)
            key[i] = (uint64_t)order_key(ref_centre(&s->ref[i])[axis]) << 32 | i;
        status = keys_sort(&key, count, 32, threads);
        for (uint32_t i = 0; i < count && !status; i++)
            s->order[axis][i] = (uint32_t)key[i];
    }
    room_free(key);
    return status;
}

static enum status start(void *user, struct ref *ref, uint32_t threads, struct grow_range *root)
{
    struct sweep *s = user;
    s->ref = ref;
    s->side = room_make(root->count, sizeof *s->side);
    enum status status = s->side ? STATUS_OK : STATUS_MEMORY;
    for (int k = 0; k < 3 && !status; k++)
        status = order_make(s, root->count, k, threads);
    root->centres = lane_box_empty();
    for (uint32_t i = 0; i < root->count; i++)
        lane_box_add(&root->centres, &ref[i].box);
    return status;
}

static void end(void *user)
{
    struct sweep *s = user;
    room_free(s->side);
    for (int k = 0; k < 3; k++) {
        room_free(s->order[k]);
        room_free(s->spare[k]);
        room_free(s->above[k]);
    }
}

static enum status build(const struct scene *scene, const struct build_options *options,
                         struct bvh *out, struct reason *reason)
{
    static const struct grow_rule rule = {start, end, split, halve, leaf};
    struct sweep s = {.leaf = options->leaf};
    return grow_build(&rule, &s, scene, options, out, reason);
}

extern const struct builder build_sah_sweep;
const struct builder build_sah_sweep = {
    .name = "sah_sweep",
    .summary = "surface area heuristic at every place; the best of the top-down trees",
    .build = build,
    .takes = "presplit",
    .tri_bytes = 225,
};
