/* Drawing on an image. Nothing is drawn beyond its border, whatever the coordinates. A colour's
 * alpha is how much it covers; the image's own alpha stays. Only + - * / and square roots, so the
 * same pixels everywhere. */
#ifndef DRAW_H
#define DRAW_H

#include "scenes/picture/font.h"
#include "scenes/picture/image.h"

/* A filled rectangle; its top left pixel is x, y. */
void draw_rect(struct image *image, int x, int y, int width, int height, uint32_t colour);

/* Only its outermost pixels. */
void draw_frame(struct image *image, int x, int y, int width, int height, uint32_t colour);

/* A line with round ends, `width` pixels thick, with smooth edges. Pixel x covers x to x + 1, so a
 * thin line is sharp where it lies at .5. Not finite: nothing. */
void draw_line(struct image *image, double x1, double y1, double x2, double y2, double width,
               uint32_t colour);

/* One line of text, each dot `scale` pixels wide; x, y: top left corner of its first character, the
 * last row of which is y + 9 scale - 1. A character beyond ASCII (UTF-8) is one '?'. */
void draw_text(struct image *image, int x, int y, unsigned scale, uint32_t colour,
               const char *text);

/* The same upwards, turned to the left: x, y is the bottom left corner. */
void draw_text_up(struct image *image, int x, int y, unsigned scale, uint32_t colour,
                  const char *text);

/* Width of a text in pixels, without the gap after its last character. Height: 9 scale. */
int64_t draw_text_width(const char *text, unsigned scale);

/* Pixels of another picture, each zoom x zoom large, copied with their alpha. */
void draw_pixels(struct image *image, int x, int y, const uint32_t *pixel, uint32_t width,
                 uint32_t height, unsigned zoom);

#endif
