/* Between the files of this room: the stages of struct staged in C. */
#ifndef STAGED_INNER_H
#define STAGED_INNER_H

#include "ref/staged/staged.h"

/* The frame of a scene: coordinates as integers of at most 29 bits and a sign. */
struct staged_frame {
    uint32_t exponent; /* the largest biased exponent of a coordinate, at least 1 */
};

/* Returns the coordinate in units of 2^(exponent - 179), cut toward 0. */
int32_t frame_coordinate(const struct staged_frame *frame, float x);

/* The frame of a scene of that box. */
struct staged_frame staged_frame_of(const uint32_t all[6]);

/* Fills in the boxes of the leaves in the order of the triangles, and codes of 10 or 21 bits an
 * axis; sets *frame. */
void stage_codes(const struct scene *scene, uint32_t axis_bits, struct staged *staged,
                 struct staged_frame *frame);

/* Sorts, and moves the boxes of the leaves to their places. Errors: STATUS_MEMORY. */
enum status stage_order(struct staged *staged) MUST_USE;

/* Returns the last place of the first child of a range of at least two places: where the highest
 * bit in which their codes differ changes, or, if all are equal, that of their places. */
uint32_t stage_cut(const struct staged *staged, uint32_t first, uint32_t last);

/* The links and boxes of each kind. */
void stage_karras(struct staged *staged);
void stage_hploc(const struct staged_frame *frame, struct staged *staged);

/* The box of a link, in struct staged. */
static inline uint32_t *staged_box(const struct staged *staged, uint32_t link)
{
    return staged->box[link & STAGED_LEAF ? staged->count - 1 + (link & ~STAGED_LEAF) : link];
}

/* The same as a box. */
struct box staged_box_of(const struct staged *staged, uint32_t link);

/* Counts the elements that differ. Returns the first, or `count`. */
uint32_t staged_differing(const void *mine, const void *other, size_t bytes, uint32_t count,
                          uint64_t *all);

/* Sets `out` to the union of two boxes, none of which has -0. */
void staged_box_join(const uint32_t a[6], const uint32_t b[6], uint32_t out[6]);

#endif
