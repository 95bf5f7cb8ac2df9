/* Binning of references by their centres, and the cheapest split between bins. */
#ifndef BINS_H
#define BINS_H

#include "ref/build/refs.h"

#define BINS_MOST BUILD_BINS_MOST

/* The bin of a centre is (centre - base) * scale, in each axis. */
struct bin_map {
    lanes base, scale;
    uint32_t count;
};

/* Bounds and number of references of each bin. */
struct bins {
    struct lane_box box[BINS_MOST][3];
    uint32_t count[BINS_MOST][3];
};

/* A split: references whose bin in `axis` is below `bin` go to the first side. bin 0: no split
 * found. */
struct bin_split {
    uint32_t axis, bin;
    float cost;  /* sum of area times items of both sides, relative to the range's area */
    float whole; /* area of the range in the same unit */
};

struct bin_map bin_map_of(const struct lane_box *centres, uint32_t bins);

/* 0 .. count - 1, whatever the reference: a centre that is NaN may have spoilt the bounds of those
 * before it, so that they lie below `base`. */
static inline lanes_int bin_of(const struct bin_map *map, const struct ref *ref)
{
    lanes at = (ref_centre(ref) - map->base) * map->scale;
    lanes below = lanes_min(at, lanes_all((float)map->count - 1));
    return lanes_to_int(lanes_max(below, lanes_all(0)));
}

void bins_clear(struct bins *bins, uint32_t count);
void bins_add(struct bins *bins, const struct bin_map *map, const struct ref *ref, uint32_t count);
/* Adds the second to the first. */
void bins_merge(struct bins *bins, const struct bins *other, uint32_t count);

/* Finds the cheapest split. */
struct bin_split bins_split(const struct bins *bins, uint32_t count);

#endif
