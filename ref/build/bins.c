#include "ref/build/bins.h"

#include <math.h>

struct bin_map bin_map_of(const struct lane_box *centres, uint32_t bins)
{
    /* Below this an axis is practically flat, and the scale could overflow. */
    lanes least = lanes_all(1e-30f);
    lanes extent = centres->hi - centres->lo;
    lanes_int flat = extent < least;
    lanes scale = lanes_all((float)bins) / lanes_select(flat, lanes_all(1), extent);
    struct bin_map map = {.base = centres->lo, .count = bins};
    map.scale = lanes_select(flat, lanes_all(0), scale);
    map.scale[3] = 0;
    return map;
}

void bins_clear(struct bins *bins, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < 3; k++) {
            bins->box[i][k] = lane_box_empty();
            bins->count[i][k] = 0;
        }
}

void bins_add(struct bins *bins, const struct bin_map *map, const struct ref *ref, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        struct lane_box box = ref[i].box;
        lanes_int bin = bin_of(map, &ref[i]);
        for (int k = 0; k < 3; k++) {
            lane_box_add(&bins->box[bin[k]][k], &box);
            bins->count[bin[k]][k]++;
        }
    }
}

void bins_merge(struct bins *bins, const struct bins *other, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < 3; k++) {
            lane_box_add(&bins->box[i][k], &other->box[i][k]);
            bins->count[i][k] += other->count[i][k];
        }
}

/* Half areas of three boxes, one for each axis. */
static lanes areas_of(const struct lane_box box[3], lanes unit)
{
    lanes x = lane_box_reach(&box[0]) * unit, y = lane_box_reach(&box[1]) * unit;
    lanes z = lane_box_reach(&box[2]) * unit;
    lanes side0 = {x[0], y[0], z[0], 0}, side1 = {x[1], y[1], z[1], 0};
    lanes side2 = {x[2], y[2], z[2], 0};
    return side0 * side1 + side1 * side2 + side2 * side0;
}

static lanes counts_of(const uint32_t count[3])
{
    return (lanes){(float)count[0], (float)count[1], (float)count[2], 0};
}

static void join(struct lane_box box[3], const struct lane_box other[3])
{
    for (int k = 0; k < 3; k++)
        lane_box_add(&box[k], &other[k]);
}

struct bin_split bins_split(const struct bins *bins, uint32_t count)
{
    struct lane_box side[3] = {lane_box_empty(), lane_box_empty(), lane_box_empty()};
    struct lane_box whole = lane_box_empty();
    lanes above[BINS_MOST];
    lanes best = lanes_all(INFINITY), zero = lanes_all(0), n = zero;
    lanes_int best_bin = {0, 0, 0, 0};
    for (uint32_t i = 0; i < count; i++)
        lane_box_add(&whole, &bins->box[i][0]);
    lanes reach = lane_box_reach(&whole);
    lanes unit = lanes_all(lanes_unit(reach));
    for (uint32_t i = count; i-- > 1;) {
        join(side, bins->box[i]);
        n += counts_of(bins->count[i]);
        above[i] = lanes_select(n > zero, areas_of(side, unit) * n, lanes_all(INFINITY));
    }
    for (int k = 0; k < 3; k++)
        side[k] = lane_box_empty();
    n = zero;
    for (uint32_t i = 1; i < count; i++) {
        join(side, bins->box[i - 1]);
        n += counts_of(bins->count[i - 1]);
        lanes cost =
            lanes_select(n > zero, areas_of(side, unit) * n + above[i], lanes_all(INFINITY));
        lanes_int better = cost < best;
        int32_t at = (int32_t)i;
        best = lanes_select(better, cost, best);
        best_bin = (better & (lanes_int){at, at, at, at}) | (~better & best_bin);
    }
    struct bin_split split = {.cost = best[0], .bin = (uint32_t)best_bin[0]};
    for (uint32_t k = 1; k < 3; k++)
        if (best[k] < split.cost)
            split = (struct bin_split){.axis = k, .cost = best[k], .bin = (uint32_t)best_bin[k]};
    split.whole = lanes_half_area(reach * unit);
    return split;
}
