/* Finds the cheapest plane of a voxel among the bounds of the parts of triangles in it. */
#ifndef KD_PLANE_H
#define KD_PLANE_H

#include "ref/base/base.h"
#include "ref/build/clip.h"

/* Costs of Wald and Havran 2006, "On building fast kd-trees for ray tracing, and on doing that in
 * O(N log N)": a step through a node, the test of a triangle, and the share that remains where one
 * side is empty. */
#define KD_COST_STEP  15.0
#define KD_COST_TRI   20.0
#define KD_COST_EMPTY 0.8

/* Where a part begins, ends or lies in a plane, of one axis: the place above, in an order of
 * numbers, then the kind, then the part. Sorted as numbers: at one place ends come first, and parts
 * that begin come last. */
typedef uint64_t kd_event;
enum { KD_ENDS, KD_FLAT, KD_BEGINS };
#define KD_PARTS_MOST ((uint32_t)1 << 30)

static inline kd_event kd_event_of(float place, uint64_t kind, uint32_t part)
{
    uint32_t bits = float_bits(place);
    uint64_t key = bits & 0x80000000u ? ~bits : bits | 0x80000000u;
    return key << 32 | kind << 30 | part;
}

static inline uint32_t kd_event_part(kd_event event)
{
    return (uint32_t)event & (KD_PARTS_MOST - 1);
}

/* The parts in a voxel, and their events along each axis in order. */
struct kd_set {
    struct part *part;
    kd_event *event[3];
    uint32_t count, events[3];
};

struct kd_plane {
    int axis; /* -1: none */
    float at;
    bool flat_right; /* parts that lie in the plane are put to the right */
    double cost;
};

/* The events of one part along an axis, written to `out`: one or two, which are counted. */
static inline uint32_t kd_events(const struct part *part, uint32_t number, int axis, kd_event *out)
{
    float lo = part->box.lo[axis], hi = part->box.hi[axis];
    bool flat = lo == hi;
    out[0] = kd_event_of(lo, flat ? KD_FLAT : KD_BEGINS, number);
    if (!flat)
        out[1] = kd_event_of(hi, KD_ENDS, number);
    return flat ? 1 : 2;
}

/* The cheapest plane strictly inside of the voxel; the first of equal ones. */
struct kd_plane kd_plane_find(const struct kd_set *set, const struct box *voxel);

#endif
