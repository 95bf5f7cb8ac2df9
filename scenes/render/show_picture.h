/* Makes pictures in false colours from values of pixels (scenes/render/show.h). */
#ifndef SHOW_PICTURE_H
#define SHOW_PICTURE_H

#include "scenes/picture/colour_picture.h"
#include "scenes/render/show.h"

/* Fixed ends of the colour scale, to compare pictures; lo < hi. */
struct show_range {
    bool given;
    double lo, hi;
};

/* Checks that a range applies: to amounts and to differences of normals (angles), not to names or
 * normals. Differences of amounts need -hi and hi. Errors: STATUS_INPUT with the rule. */
enum status show_range_check(const struct show *show, bool difference,
                             const struct show_range *range, struct reason *reason) MUST_USE;

/* Makes a picture of width x height pixels with a title, a scale bar or legend, and the meaning of
 * pixels without a value. Small pictures are enlarged.
 *   value       of show_values; if `difference`, of show_difference
 *   range       of colours. If not given: amounts from least to most; errors logarithmic, at least
 *               from 0.001 to 1; differences symmetric to 0, so that nine of ten that are not 0
 *               are within
 *   place, out  as in colour_picture
 * If few pixels are not right, or name something else, each gets a frame around it, unless pixels
 * are enlarged by more than 3.
 * Errors: as show_range_check and colour_picture. */
enum status show_picture(const struct show *show, bool difference, const double *value,
                         uint32_t width, uint32_t height, const struct show_range *range,
                         const char *title, struct image *out, struct colour_place *place,
                         struct reason *reason) MUST_USE;

#endif
