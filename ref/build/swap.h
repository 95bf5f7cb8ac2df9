/* In-place division of references. */
#ifndef SWAP_H
#define SWAP_H

#include "ref/build/bins.h"

/* References whose bin in `axis` is below `bin` belong to the first side. */
struct ref_cut {
    const struct bin_map *map;
    uint32_t axis;
    int32_t bin;
};

/* Moves the first side's references to the front; returns their number. Writes the bounds of the
 * centres of both sides. Large ranges are divided in parts that threads share; the order of the
 * result does not depend on the number of threads. */
uint32_t refs_divide(struct ref *ref, uint32_t count, const struct ref_cut *cut, uint32_t threads,
                     struct lane_box *fst, struct lane_box *snd);

/* Moves the half with the smaller centres, in the longest axis of `centres`, to the front; returns
 * count / 2. At most 32 passes for any input. */
uint32_t refs_halve(struct ref *ref, uint32_t count, const struct lane_box *centres,
                    struct lane_box *fst, struct lane_box *snd);

#endif
