/* Compares two pictures pixel by pixel. */
#ifndef IMAGE_DIFF_H
#define IMAGE_DIFF_H

#include "scenes/picture/colour_picture.h"

enum { IMAGE_CHANNELS = 4 }; /* red, green, blue, alpha */

/* Classes of the largest difference of a pixel: 1, 2, 3-7, 8-31, 32 and more. */
enum { IMAGE_DIFF_SIZES = 5 };
extern const char *const image_diff_size_names[IMAGE_DIFF_SIZES];

struct image_diff_pixel {
    uint32_t x, y;
    uint32_t a, b; /* as in struct image */
};

/* A pixel's difference is the largest of its channels. */
struct image_diff {
    uint64_t pixels, differing;
    unsigned largest[IMAGE_CHANNELS];
    uint64_t total[IMAGE_CHANNELS]; /* sum over all pixels */
    uint64_t by_size[IMAGE_DIFF_SIZES];
    /* Of the differing pixels; zero if there are none. */
    uint32_t least_x, least_y, most_x, most_y; /* bounding box, ends included */
    struct image_diff_pixel first, worst;      /* in row order; `worst`: first of equals */
};

/* Errors: STATUS_INPUT the sides differ. */
enum status image_diff(const struct image *a, const struct image *b, struct image_diff *out,
                       struct reason *reason) MUST_USE;

/* The largest difference of all channels, 0 to 255. */
unsigned image_diff_largest(const struct image_diff *diff);

/* Difference of two pixels: the largest of their channels. */
unsigned image_diff_of(uint32_t a, uint32_t b);

/* Makes a heat map with scale bar of the compared pictures `a` and `b`. Small pictures are
 * enlarged; equal pixels have COLOUR_NO_DATA. The scale is logarithmic if the largest difference is
 * at least 16. Errors: STATUS_INPUT too large (colour_picture); STATUS_MEMORY. */
enum status image_diff_heat(const struct image *a, const struct image *b,
                            const struct image_diff *diff, const char *title, struct image *out,
                            struct colour_place *place, struct reason *reason) MUST_USE;

#endif
