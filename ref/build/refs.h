/* Triangles in the form that builders sort: box and number in 32 bytes. */
#ifndef REFS_H
#define REFS_H

#include "ref/base/base.h"
#include "ref/build/lanes.h"
#include "ref/tree/bvh.h"

/* The number is stored in the fourth lanes, 16 bits in the mantissa of each. They are floats
 * between 1 and 2, harmless in every operation. */
struct ref {
    struct lane_box box;
};

static inline uint32_t ref_prim(const struct ref *ref)
{
    lanes_int lo = (lanes_int)ref->box.lo, hi = (lanes_int)ref->box.hi;
    return ((uint32_t)lo[3] & 0xFFFFu) | (uint32_t)hi[3] << 16;
}

/* Half of the box's centre, as a sum of two quarters: a sum of two floats could overflow. */
static inline lanes ref_centre(const struct ref *ref)
{
    lanes quarter = lanes_all(0.25f);
    return ref->box.lo * quarter + ref->box.hi * quarter;
}

/* Returns a key with the same order as the floats; -0 comes before 0. */
static inline uint32_t order_key(float x)
{
    uint32_t bits = float_bits(x);
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

/* Returns the threads for a build of `count` triangles: 1 if there are few, so that small builds do
 * not start threads. */
uint32_t build_threads(const struct build_options *options, uint32_t count);

/* References of a scene, and the bounds of their centres. */
struct refs {
    struct ref *ref; /* free with room_free */
    uint32_t count;
    struct lane_box centres;
};

/* Makes the references of all triangles in order, with -0 as 0 in the boxes: one each, or of all
 * parts if options->presplit is above 0 (ref/build/presplit.h). Errors: STATUS_LIMIT as
 * presplit_make; STATUS_MEMORY, without a reason. */
enum status refs_make(const struct scene *scene, const struct build_options *options,
                      uint32_t threads, struct refs *out, struct reason *reason) MUST_USE;

#endif
