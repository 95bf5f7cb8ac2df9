/* Two pictures of the same scene from the same place, compared path by path: which segments hit
 * something else, in which bits t differs, whose light is in a shadow, and whose 8-bit value
 * differs. The causes are found by scenes/render/diff_why.h. */
#ifndef DIFF_FRAMES_H
#define DIFF_FRAMES_H

#include "ref/frame.h"

/* The members of a segment, in the order in which they are computed. */
enum path_field { PATH_SAME, PATH_PRIM, PATH_T, PATH_ASKED, PATH_SHADOWED, PATH_FIELD_COUNT };

/* "same", "prim", "t", "asked", "shadowed". */
const char *path_field_name(enum path_field field);

struct frame_diff {
    size_t paths;                   /* compared: one a pixel */
    size_t segments;                /* that either picture has */
    size_t hits;                    /* of them those that end on a triangle in either */
    size_t paths_apart;             /* paths with a segment that differs in some bit */
    size_t field[PATH_FIELD_COUNT]; /* segments that differ in that member; [PATH_SAME]: in none */
    size_t first[PATH_FIELD_COUNT]; /* paths by the member that differs first */
    size_t colours;                 /* pixels whose value differs in some channel */
    size_t allowed;   /* of them: the same path to the bit, and rounding may take either value */
    size_t excess;    /* of them: the same path to the bit, and it may not */
    unsigned largest; /* difference of a channel */
};

/* The first segment and member in which two paths of `bounces` segments differ; PATH_SAME if all
 * bits are equal (t of 0 and -0 are not). A path ends before the first segment whose prim is
 * ABI_NO_SEGMENT; what follows it is not read. */
enum path_field path_first(const struct segment *a, const struct segment *b, uint32_t bounces,
                           uint32_t *segment);

/* Whether `pixel` can be the value of a renderer whose colour differs from `color` by at most
 * `bound` (see struct frame): each channel within `bound` of a rounding border between the two,
 * where they differ. NaN as a bound allows nothing. */
bool pixel_within(const float color[3], float bound, uint32_t pixel);

/* Compares two frames with `segment`. The values that rounding allows follow from color and bound
 * of the frame that the C renderer drew, `a` if both; without one (bound NULL or NaN) no difference
 * is allowed. */
struct frame_diff frame_compare(const struct frame *a, const struct frame *b, uint32_t width,
                                uint32_t height, uint32_t bounces);

/* The same of one pixel: adds it to *diff. */
void frame_compare_pixel(const struct frame *a, const struct frame *b, size_t pixel,
                         uint32_t bounces, struct frame_diff *diff);

#endif
