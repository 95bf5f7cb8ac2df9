/* Pictures of numbers that can be read: title, values as colours, scale bar or legend. */
#ifndef COLOUR_PICTURE_H
#define COLOUR_PICTURE_H

#include "scenes/picture/colour.h"

/* Where the values are in the picture: value (i, j) is the zoom x zoom pixels from x + zoom i,
 * y + zoom j on, all of exactly its colour. Nothing else is drawn there. */
struct colour_place {
    uint32_t x, y, zoom;
};

/* A picture of width x height values, row 0 at the top: the title above, below them the scale bar
 * with ticks, or the classes, and what no_data means. A long title is cut to the picture's width.
 * Errors: STATUS_INPUT a side or the zoom is 0, or the picture too large (image_make);
 * STATUS_MEMORY. */
enum status colour_picture(const struct colour_scale *scale, const float *value, uint32_t width,
                           uint32_t height, unsigned zoom, struct image *out,
                           struct colour_place *place, struct reason *reason) MUST_USE;

/* The same of pixels that have their colours already. A scale of kind COLOUR_IDS has no bar, only
 * its title and unit. */
enum status colour_picture_of(const struct colour_scale *scale, const uint32_t *pixel,
                              uint32_t width, uint32_t height, unsigned zoom, struct image *out,
                              struct colour_place *place, struct reason *reason) MUST_USE;

#endif
