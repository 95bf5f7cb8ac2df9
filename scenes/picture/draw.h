/* Drawing on an image. Everything is clipped to the image, whatever the coordinates. A colour's
 * alpha is its opacity; the image's own alpha does not change. Only + - * / and square roots are
 * used, so that pixels are the same on every machine. */
#ifndef DRAW_H
#define DRAW_H

#include "scenes/picture/font.h"
#include "scenes/picture/image.h"

/* A filled rectangle; its top left pixel is x, y. */
void draw_rect(struct image *image, int x, int y, int width, int height, uint32_t colour);

/* The outline of a rectangle, one pixel wide. */
void draw_frame(struct image *image, int x, int y, int width, int height, uint32_t colour);

/* A line with round ends and smooth edges, `width` pixels thick. Pixel x covers x to x + 1, so that
 * a thin line is sharp if it lies at .5. Draws nothing if a number is not finite. */
void draw_line(struct image *image, double x1, double y1, double x2, double y2, double width,
               uint32_t colour);

/* One line of text, each dot `scale` pixels wide. x, y: top left corner of its first character,
 * whose last row is y + 9 scale - 1. Each character beyond ASCII (UTF-8) is drawn as one '?'. */
void draw_text(struct image *image, int x, int y, unsigned scale, uint32_t colour,
               const char *text);

/* The same, rotated to read upwards. x, y is the bottom left corner. */
void draw_text_up(struct image *image, int x, int y, unsigned scale, uint32_t colour,
                  const char *text);

/* Width of a text in pixels, without the gap after its last character. The height is 9 scale. */
int64_t draw_text_width(const char *text, unsigned scale);

/* Copies another picture's pixels with their alpha, each enlarged to zoom x zoom. */
void draw_pixels(struct image *image, int x, int y, const uint32_t *pixel, uint32_t width,
                 uint32_t height, unsigned zoom);

#endif
