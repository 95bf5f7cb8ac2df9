#include "ref/build/few.h"

#include <math.h>

/* Sorts references by their centres in one axis; equal ones keep their order. */
static void sort_few(const lanes *centre, uint32_t count, int axis, uint8_t *order)
{
    for (uint32_t i = 0; i < count; i++) {
        uint32_t at = i;
        for (; at > 0 && centre[order[at - 1]][axis] > centre[i][axis]; at--)
            order[at] = order[at - 1];
        order[at] = (uint8_t)i;
    }
}

/* Finds the cheapest position to cut an order, if better than *best. */
static uint32_t cut_few(const struct lane_box *box, uint32_t count, const uint8_t *order,
                        float *best)
{
    float above[FEW_MOST];
    struct lane_box side = box[order[count - 1]];
    for (uint32_t i = count - 1;; i--) {
        above[i] = lanes_half_area(side.hi - side.lo) * (float)(count - i);
        if (i == 1)
            break;
        lane_box_add(&side, &box[order[i - 1]]);
    }
    uint32_t cut = 0;
    side = box[order[0]];
    for (uint32_t i = 1; i < count; i++) {
        float cost = lanes_half_area(side.hi - side.lo) * (float)i + above[i];
        if (cost < *best) {
            *best = cost;
            cut = i;
        }
        lane_box_add(&side, &box[order[i]]);
    }
    return cut;
}

uint32_t few_split(struct ref *ref, uint32_t count, uint32_t leaf)
{
    struct lane_box whole = ref[0].box, box[FEW_MOST];
    struct ref copy[FEW_MOST];
    lanes centre[FEW_MOST];
    uint8_t order[3][FEW_MOST];
    for (uint32_t i = 1; i < count; i++)
        lane_box_add(&whole, &ref[i].box);
    lanes reach = lane_box_reach(&whole), half = lanes_all(0.5f);
    /* Boxes relative to the corner and size of the whole; sides are 2 at most. */
    lanes unit = lanes_all(lanes_unit(reach)), base = whole.lo * half;
    for (uint32_t i = 0; i < count; i++) {
        copy[i] = ref[i];
        centre[i] = ref_centre(&ref[i]);
        box[i].lo = (ref[i].box.lo * half - base) * unit;
        box[i].hi = (ref[i].box.hi * half - base) * unit;
    }
    float area = lanes_half_area(reach * unit);
    float best = count <= leaf ? area * ((float)count - COST_NODE) : INFINITY;
    uint32_t cut = 0, axis = 0;
    for (uint32_t k = 0; k < 3; k++) {
        sort_few(centre, count, (int)k, order[k]);
        uint32_t found = cut_few(box, count, order[k], &best);
        axis = found ? k : axis;
        cut = found ? found : cut;
    }
    for (uint32_t i = 0; i < count && cut; i++)
        ref[i] = copy[order[axis][i]];
    return cut;
}
