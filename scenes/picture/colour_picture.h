/* Pictures of numbers: title, values as colours, scale bar or legend. */
#ifndef COLOUR_PICTURE_H
#define COLOUR_PICTURE_H

#include "scenes/picture/colour.h"

/* Position of the values: value (i, j) covers the zoom x zoom pixels from (x + zoom i, y + zoom j)
 * on, in exactly its colour. Nothing else is drawn there. */
struct colour_place {
    uint32_t x, y, zoom;
};

/* Makes a picture of width x height values, row 0 at the top. The title is above; below are the
 * scale bar with ticks or the classes, and the meaning of no data. A long title is cut to the
 * picture's width. Text grows with the picture: a line is 9 pixels high in less than 800 pixels, 18
 * from 800 on, 27 from 1200 on, and so on.
 * Errors: STATUS_INPUT a side or the zoom is 0, or the picture is too large (image_make);
 * STATUS_MEMORY. */
enum status colour_picture(const struct colour_scale *scale, const float *value, uint32_t width,
                           uint32_t height, unsigned zoom, struct image *out,
                           struct colour_place *place, struct reason *reason) MUST_USE;

/* The same for pixels that already have their colours. A scale of kind COLOUR_IDS has no bar, only
 * title and unit. */
enum status colour_picture_of(const struct colour_scale *scale, const uint32_t *pixel,
                              uint32_t width, uint32_t height, unsigned zoom, struct image *out,
                              struct colour_place *place, struct reason *reason) MUST_USE;

#endif
