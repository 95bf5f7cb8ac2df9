/* Pictures of 8-bit colours in memory, and PNG files. */
#ifndef IMAGE_H
#define IMAGE_H

#include "ref/base/base.h"

#define IMAGE_SIDE_MOST   16384u
#define IMAGE_PIXELS_MOST (1u << 26) /* 256 MB; 8192 x 8192 */

/* Owns its pixels (image_free). Row 0 is the top. A pixel has red in bits 0-7, then green, blue
 * and, in bits 24-31, alpha (255: opaque), as in struct frame (ref/frame.h). */
struct image {
    uint32_t width, height;
    uint32_t *pixel; /* width * height */
};

static inline uint32_t image_rgb(unsigned red, unsigned green, unsigned blue)
{
    return (red & 255u) | (green & 255u) << 8 | (blue & 255u) << 16 | 255u << 24;
}

/* Allocates an opaque black image. Errors: STATUS_INPUT a side of 0 or over IMAGE_SIDE_MOST, or
 * more pixels than IMAGE_PIXELS_MOST; STATUS_MEMORY. */
enum status image_make(uint32_t width, uint32_t height, struct image *out,
                       struct reason *reason) MUST_USE;

/* Frees the pixels and zeroes the struct. A zero image is allowed. */
void image_free(struct image *image);

/* Reads a PNG file of any kind as 8 bits per channel (16 are scaled and rounded). Gamma and
 * profiles are not applied. Bytes after the picture's end are ignored. No memory is allocated for
 * pixels that a file of this size cannot hold.
 * Errors: STATUS_INPUT "PATH: rule": cannot be read, no PNG, too large, cut short, damaged (every
 * checksum is checked); STATUS_MEMORY. */
enum status image_read(const char *path, struct image *out, struct reason *reason) MUST_USE;

/* Writes a PNG file of 8-bit RGB (RGBA if a pixel is not opaque) to a temporary file that is then
 * renamed. The same image gives the same bytes. Errors: STATUS_INPUT cannot write (reason);
 * STATUS_MEMORY. */
enum status image_write(const char *path, const struct image *image,
                        struct reason *reason) MUST_USE;

#endif
