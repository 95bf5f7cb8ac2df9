/* Compares two pictures of the same scene and view path by path: segments that hit something else,
 * bits of t, shadows, and 8-bit values. scenes/render/diff_why.h finds the causes. */
#ifndef DIFF_FRAMES_H
#define DIFF_FRAMES_H

#include "ref/frame.h"

/* Members of a segment, in order of computation. */
enum path_field { PATH_SAME, PATH_PRIM, PATH_T, PATH_ASKED, PATH_SHADOWED, PATH_FIELD_COUNT };

/* "same", "prim", "t", "asked", "shadowed". */
const char *path_field_name(enum path_field field);

struct frame_diff {
    size_t paths;                   /* paths compared, one per pixel */
    size_t segments;                /* segments of either picture */
    size_t hits;                    /* of those, segments that end on a triangle in either */
    size_t paths_apart;             /* paths with a segment that differs in any bit */
    size_t field[PATH_FIELD_COUNT]; /* segments that differ in that member; [PATH_SAME]: in none */
    size_t first[PATH_FIELD_COUNT]; /* paths by the first member that differs */
    size_t colours;                 /* pixels whose value differs in any channel */
    size_t allowed;   /* of those with bit-identical paths: rounding allows both values */
    size_t excess;    /* of those with bit-identical paths: rounding does not */
    unsigned largest; /* largest difference of a channel */
};

/* The first segment and member in which two paths of `bounces` segments differ; PATH_SAME if all
 * bits are equal (t of 0 and -0 differ). A path ends before the first segment whose prim is
 * ABI_NO_SEGMENT; later ones are not read. */
enum path_field path_first(const struct segment *a, const struct segment *b, uint32_t bounces,
                           uint32_t *segment);

/* Whether `pixel` may be the value of a renderer whose colour differs from `color` by at most
 * `bound` (see struct frame): each channel lies between floor(s - bound) and floor(s + bound), s =
 * 255 times the clamped colour + 0.5. False if `bound` is NaN. */
bool pixel_within(const float color[3], float bound, uint32_t pixel);

/* Compares two frames with `segment`. The values that rounding allows follow from color and bound
 * of the frame that the C renderer drew, `a` if both have them. Without one (bound NULL or NaN) no
 * difference is allowed. */
struct frame_diff frame_compare(const struct frame *a, const struct frame *b, uint32_t width,
                                uint32_t height, uint32_t bounces);

/* The same for one pixel; adds to *diff. */
void frame_compare_pixel(const struct frame *a, const struct frame *b, size_t pixel,
                         uint32_t bounces, struct frame_diff *diff);

#endif
