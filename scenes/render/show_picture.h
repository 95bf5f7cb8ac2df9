/* Values of pixels (scenes/render/show.h) as a picture in false colours. */
#ifndef SHOW_PICTURE_H
#define SHOW_PICTURE_H

#include "scenes/picture/colour_picture.h"
#include "scenes/render/show.h"

/* Fixed ends of the colours, so that pictures can be compared; lo < hi. */
struct show_range {
    bool given;
    double lo, hi;
};

/* Whether a range says anything there: amounts have one; names and normals have none, unless what
 * is shown is the difference of two normals, which is an angle. Differences of amounts have ends
 * -hi and hi. Errors: STATUS_INPUT with what is wrong with it. */
enum status show_range_check(const struct show *show, bool difference,
                             const struct show_range *range, struct reason *reason) MUST_USE;

/* Makes a picture of width x height pixels with a title, a scale bar or legend, and what pixels
 * without a value are; small ones are enlarged.
 *   value       as show_values has them, or with `difference` as show_difference
 *   range       of colours; not given: amounts from the least to the most; errors from 0.001 to 1
 *               at least, logarithmic; differences the same to both sides of 0, so far that nine of
 *               ten that are not 0 are within
 * Where few pixels are not right, or name something else, each has a frame around it, unless pixels
 * are enlarged by more than 3.
 *   place, out  as colour_picture
 * Errors: as show_range_check and colour_picture. */
enum status show_picture(const struct show *show, bool difference, const double *value,
                         uint32_t width, uint32_t height, const struct show_range *range,
                         const char *title, struct image *out, struct colour_place *place,
                         struct reason *reason) MUST_USE;

#endif
