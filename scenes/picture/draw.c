#include "scenes/picture/draw.h"

#include <math.h>

/* Blends `colour` over the pixel with weight cover / 255, times its alpha. */
static void blend(uint32_t *pixel, uint32_t colour, unsigned cover)
{
    cover = (cover * (colour >> 24) + 127) / 255;
    if (cover == 255) {
        *pixel = (*pixel & 0xFF000000u) | (colour & 0xFFFFFFu);
        return;
    }
    uint32_t out = *pixel & 0xFF000000u;
    for (unsigned shift = 0; shift < 24; shift += 8) {
        unsigned under = *pixel >> shift & 255, over = colour >> shift & 255;
        out |= (under * (255 - cover) + over * cover + 127) / 255 << shift;
    }
    *pixel = out;
}

static int64_t within(int64_t value, int64_t lo, int64_t hi)
{
    return value < lo ? lo : value > hi ? hi : value;
}

/* Clips from .. from + length to 0 .. side. */
static void clip(int64_t from, int64_t length, uint32_t side, int64_t *begin, int64_t *end)
{
    *begin = within(from, 0, side);
    *end = within(from + (length > 0 ? length : 0), 0, side);
}

/* As draw_rect, for sums and products of ints. */
static void fill(struct image *image, int64_t x, int64_t y, int64_t width, int64_t height,
                 uint32_t colour)
{
    int64_t x0, x1, y0, y1;
    clip(x, width, image->width, &x0, &x1);
    clip(y, height, image->height, &y0, &y1);
    for (int64_t v = y0; v < y1; v++)
        for (int64_t u = x0; u < x1; u++)
            blend(&image->pixel[v * image->width + u], colour, 255);
}

void draw_rect(struct image *image, int x, int y, int width, int height, uint32_t colour)
{
    fill(image, x, y, width, height, colour);
}

void draw_frame(struct image *image, int x, int y, int width, int height, uint32_t colour)
{
    if (width < 1 || height < 1)
        return;
    const int64_t right = (int64_t)x + width - 1, bottom = (int64_t)y + height - 1;
    fill(image, x, y, width, 1, colour);
    if (height > 1)
        fill(image, x, bottom, width, 1, colour);
    fill(image, x, (int64_t)y + 1, 1, height - 2, colour);
    if (width > 1)
        fill(image, right, (int64_t)y + 1, 1, height - 2, colour);
}

/* A line in coordinates along its longer axis (u) and its shorter one (v), u1 <= u2. */
struct stroke {
    double u1, v1, u2, v2, radius;
    uint32_t colour;
    bool steep; /* u is y of the image */
};

/* Distance of a point from the line. */
static double distance_to(const struct stroke *stroke, double u, double v)
{
    double du = stroke->u2 - stroke->u1, dv = stroke->v2 - stroke->v1;
    double squared = du * du + dv * dv, part = 0.0;
    if (squared > 0.0)
        part = ((u - stroke->u1) * du + (v - stroke->v1) * dv) / squared;
    part = part < 0.0 ? 0.0 : part > 1.0 ? 1.0 : part;
    double x = u - (stroke->u1 + part * du), y = v - (stroke->v1 + part * dv);
    return sqrt(x * x + y * y);
}

/* Draws the pixels of column u (row u if steep) that the line touches. */
static void draw_column(struct image *image, const struct stroke *stroke, int64_t u)
{
    double du = stroke->u2 - stroke->u1, slope = 0.0, middle = stroke->v1;
    if (du > 0.0)
        slope = (stroke->v2 - stroke->v1) / du; /* at most 1 */
    middle += slope * ((double)u + 0.5 - stroke->u1);
    const uint32_t side = stroke->steep ? image->width : image->height;
    const double reach = 1.5 * stroke->radius + 2.0; /* sqrt(2) and the soft edge */
    double lo = fmax(middle - reach, 0.0), hi = fmin(middle + reach, (double)side);
    if (!(lo < hi))
        return;
    for (int64_t v = (int64_t)lo; (double)v < hi; v++) {
        double cover = stroke->radius + 0.5; /* the edge lies in the middle of its smooth part */
        cover -= distance_to(stroke, (double)u + 0.5, (double)v + 0.5);
        if (!(cover > 0.0))
            continue;
        int64_t x = stroke->steep ? v : u, y = stroke->steep ? u : v;
        blend(&image->pixel[y * image->width + x], stroke->colour,
              cover >= 1.0 ? 255u : (unsigned)(255.0 * cover + 0.5));
    }
}

void draw_line(struct image *image, double x1, double y1, double x2, double y2, double width,
               uint32_t colour)
{
    if (!isfinite(x1) || !isfinite(y1) || !isfinite(x2) || !isfinite(y2) || !(width > 0.0) ||
        !isfinite(width))
        return;
    bool steep = fabs(y2 - y1) > fabs(x2 - x1);
    struct stroke stroke = {x1, y1, x2, y2, 0.5 * width, colour, steep};
    if (steep)
        stroke = (struct stroke){y1, x1, y2, x2, 0.5 * width, colour, steep};
    if (stroke.u1 > stroke.u2)
        stroke = (struct stroke){stroke.u2,     stroke.v2, stroke.u1, stroke.v1,
                                 stroke.radius, colour,    steep};
    const uint32_t side = steep ? image->height : image->width;
    double lo = fmax(stroke.u1 - stroke.radius - 1.0, 0.0);
    double hi = fmin(stroke.u2 + stroke.radius + 1.0, (double)side);
    if (!(lo < hi)) /* outside the image; may be too large for int64_t */
        return;
    for (int64_t u = (int64_t)lo; (double)u < hi; u++)
        draw_column(image, &stroke, u);
}

/* Reads the next character (UTF-8); returns its first byte, 0 at the end. */
static unsigned char next_character(const char **text)
{
    unsigned char first = (unsigned char)**text;
    if (first)
        (*text)++;
    if (first >= 0x80)
        while (((unsigned char)**text & 0xC0) == 0x80)
            (*text)++;
    return first;
}

int64_t draw_text_width(const char *text, unsigned scale)
{
    int64_t count = 0;
    while (next_character(&text))
        count++;
    return count ? (count * FONT_ADVANCE - (FONT_ADVANCE - FONT_WIDTH)) * (int64_t)scale : 0;
}

static void put_text(struct image *image, int64_t x, int64_t y, unsigned scale, uint32_t colour,
                     const char *text, bool up)
{
    unsigned char character;
    for (int64_t at = 0; (character = next_character(&text)) != 0; at += FONT_ADVANCE)
        for (int u = 0; u < FONT_WIDTH; u++)
            for (int v = 0; v < FONT_HEIGHT; v++) {
                if (!font_dot(character, u, v))
                    continue;
                int64_t right = (up ? v : at + u) * scale;
                int64_t down = up ? -(at + u + 1) * (int64_t)scale : v * (int64_t)scale;
                fill(image, x + right, y + down, scale, scale, colour);
            }
}

void draw_text(struct image *image, int x, int y, unsigned scale, uint32_t colour, const char *text)
{
    put_text(image, x, y, scale, colour, text, false);
}

void draw_text_up(struct image *image, int x, int y, unsigned scale, uint32_t colour,
                  const char *text)
{
    put_text(image, x, (int64_t)y + 1, scale, colour, text, true);
}

void draw_pixels(struct image *image, int x, int y, const uint32_t *pixel, uint32_t width,
                 uint32_t height, unsigned zoom)
{
    int64_t x0, x1, y0, y1;
    if (zoom == 0)
        return;
    clip(x, (int64_t)width * zoom, image->width, &x0, &x1);
    clip(y, (int64_t)height * zoom, image->height, &y0, &y1);
    for (int64_t v = y0; v < y1; v++)
        for (int64_t u = x0; u < x1; u++)
            image->pixel[v * image->width + u] = pixel[(v - y) / zoom * width + (u - x) / zoom];
}
