#include "scenes/picture/colour_picture.h"

#include "scenes/picture/draw.h"
#include "scenes/picture/ticks.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* In pixels of unenlarged text. */
#define MARGIN     8
#define LINE       13 /* distance between lines of text */
#define BAR_HEIGHT 12
#define BAR_LEAST  220
#define BAR_MOST   640
#define SWATCH     9
#define TEXT_WIDTH 400u /* pixels of the values for each time that text is enlarged */

#define INK   image_rgb(0, 0, 0)
#define PAPER image_rgb(255, 255, 255)

/* Layout of a picture. */
struct picture_sheet {
    const struct colour_scale *scale;
    int text;               /* scale factor of text, bar and swatches */
    int left, top;          /* of the area of values */
    int values_w, values_h; /* its size in pixels */
    int inner;              /* width between the margins */
    struct image *image;    /* NULL: only measure */
    int y;                  /* of the next line */
};

/* Draws text at x in the current line, unless only measuring. */
static void put(const struct picture_sheet *sheet, int x, const char *text)
{
    if (sheet->image)
        draw_text(sheet->image, x, sheet->y, (unsigned)sheet->text, INK, text);
}

/* Draws a line cut to the width between the margins; "..." replaces the rest. */
static void put_cut(struct picture_sheet *sheet, const char *text)
{
    char line[400];
    snprintf(line, sizeof line, "%s", text);
    size_t most = (size_t)(sheet->inner / (FONT_ADVANCE * sheet->text));
    most = most < sizeof line ? most : sizeof line - 1;
    if (strlen(line) > most)
        strcpy(line + most - 3, "...");
    put(sheet, MARGIN, line);
    sheet->y += LINE * sheet->text;
}

/* Draws a swatch and its name, in a new line if this one is full. */
static void put_swatch(struct picture_sheet *sheet, int *x, uint32_t colour, const char *name)
{
    const int side = SWATCH * sheet->text;
    const int width = side + 4 * sheet->text + (int)draw_text_width(name, (unsigned)sheet->text);
    if (*x > MARGIN && *x + width > MARGIN + sheet->inner) {
        *x = MARGIN;
        sheet->y += LINE * sheet->text;
    }
    if (sheet->image) {
        draw_rect(sheet->image, *x, sheet->y - 1, side, side, colour);
        draw_frame(sheet->image, *x, sheet->y - 1, side, side, INK);
    }
    put(sheet, *x + side + 4 * sheet->text, name);
    *x += width + 12 * sheet->text;
}

static void put_legend(struct picture_sheet *sheet)
{
    const struct colour_scale *scale = sheet->scale;
    int x = MARGIN;
    if (scale->kind == COLOUR_CLASSES)
        for (size_t i = 0; i < scale->class_count; i++)
            put_swatch(sheet, &x, colour_of_class(i), scale->class_name[i]);
    if (scale->no_data)
        put_swatch(sheet, &x, COLOUR_NO_DATA, scale->no_data);
    if (x > MARGIN)
        sheet->y += LINE * sheet->text;
}

/* Range of the bar. */
static void ends_of(const struct colour_scale *scale, double *lo, double *hi)
{
    *hi = scale->hi;
    *lo = scale->kind == COLOUR_DIVERGING ? -scale->hi : scale->lo;
}

static double part_of(const struct colour_scale *scale, double value)
{
    double lo, hi;
    ends_of(scale, &lo, &hi);
    if (scale->logarithmic)
        return log(value / lo) / log(hi / lo);
    return (value - lo) / (hi - lo);
}

/* Draws ticks and their numbers. A number that would overlap the previous one is left out. */
static void put_ticks(const struct picture_sheet *sheet, int width)
{
    double lo, hi, step = 0.0, tick[TICKS_MOST];
    char text[40];
    ends_of(sheet->scale, &lo, &hi);
    size_t count = sheet->scale->logarithmic
                       ? ticks_log(lo, hi, tick)
                       : ticks_linear(lo, hi, (size_t)(width / (60 * sheet->text)), tick, &step);
    int free_from = 0;
    for (size_t i = 0; i < count; i++) {
        int x = MARGIN + (int)(part_of(sheet->scale, tick[i]) * (width - 1) + 0.5);
        tick_text(tick[i], step, text, sizeof text);
        int text_w = (int)draw_text_width(text, (unsigned)sheet->text);
        int from = x - text_w / 2;
        from = from > MARGIN + width - text_w ? MARGIN + width - text_w : from;
        from = from < MARGIN ? MARGIN : from;
        draw_rect(sheet->image, x, sheet->y, sheet->text, 3 * sheet->text, INK);
        if (from < free_from)
            continue;
        free_from = from + text_w + 5 * sheet->text;
        draw_text(sheet->image, from, sheet->y + 5 * sheet->text, (unsigned)sheet->text, INK, text);
    }
}

static void put_bar(struct picture_sheet *sheet)
{
    const struct colour_scale *scale = sheet->scale;
    const int most = BAR_MOST * sheet->text;
    const int width = sheet->inner < most ? sheet->inner : most;
    const int height = BAR_HEIGHT * sheet->text;
    for (int x = 0; sheet->image && x < width; x++) {
        double part = (double)x / (width - 1);
        uint32_t colour = scale->kind == COLOUR_DIVERGING ? colour_diverging(2.0 * part - 1.0)
                                                          : colour_sequential(part);
        draw_rect(sheet->image, MARGIN + x, sheet->y, 1, height, colour);
    }
    sheet->y += height;
    if (sheet->image)
        put_ticks(sheet, width);
    sheet->y += (5 + LINE) * sheet->text;
}

/* "boxes visited, 3 to 187" */
static void put_unit(struct picture_sheet *sheet)
{
    const struct colour_scale *scale = sheet->scale;
    const char *unit = scale->unit ? scale->unit : "";
    char line[300];
    snprintf(line, sizeof line, "%s", unit);
    if (scale->kind == COLOUR_SEQUENTIAL || scale->kind == COLOUR_DIVERGING) {
        char from[40], to[40];
        double lo, hi;
        ends_of(scale, &lo, &hi);
        tick_text(lo, 0.0, from, sizeof from);
        tick_text(hi, 0.0, to, sizeof to);
        snprintf(line, sizeof line, "%.200s%s%s to %s%s", unit, *unit ? ", " : "", from, to,
                 scale->logarithmic ? ", logarithmic" : "");
    }
    if (*line)
        put_cut(sheet, line);
}

/* Lays out all texts around the values. Afterwards sheet->y is below the last line. */
static void put_words(struct picture_sheet *sheet)
{
    sheet->y = MARGIN;
    if (sheet->scale->title)
        put_cut(sheet, sheet->scale->title);
    sheet->left = MARGIN;
    sheet->top = sheet->y;
    sheet->y += sheet->values_h + 6;
    if (sheet->scale->kind == COLOUR_SEQUENTIAL || sheet->scale->kind == COLOUR_DIVERGING)
        put_bar(sheet);
    put_unit(sheet);
    put_legend(sheet);
}

enum status colour_picture_of(const struct colour_scale *scale, const uint32_t *pixel,
                              uint32_t width, uint32_t height, unsigned zoom, struct image *out,
                              struct colour_place *place, struct reason *reason)
{
    *out = (struct image){0};
    *place = (struct colour_place){0};
    const uint64_t wide = (uint64_t)width * zoom, high = (uint64_t)height * zoom;
    if (wide == 0 || high == 0 || wide > IMAGE_SIDE_MOST || high > IMAGE_SIDE_MOST)
        return fail(reason, STATUS_INPUT,
                    "picture: %u x %u values %u times enlarged: sides are 1 to %u", width, height,
                    zoom, IMAGE_SIDE_MOST);
    struct picture_sheet sheet = {.scale = scale,
                                  .text = wide < 2 * TEXT_WIDTH ? 1 : (int)(wide / TEXT_WIDTH),
                                  .values_w = (int)wide,
                                  .values_h = (int)high};
    const int least = BAR_LEAST * sheet.text;
    sheet.inner = sheet.values_w > least ? sheet.values_w : least;
    put_words(&sheet);
    enum status status =
        image_make((uint32_t)(sheet.inner + 2 * MARGIN), (uint32_t)(sheet.y + 2), out, reason);
    if (status != STATUS_OK)
        return status;
    sheet.image = out;
    draw_rect(out, 0, 0, (int)out->width, (int)out->height, PAPER);
    put_words(&sheet);
    draw_frame(out, sheet.left - 1, sheet.top - 1, sheet.values_w + 2, sheet.values_h + 2, INK);
    draw_pixels(out, sheet.left, sheet.top, pixel, width, height, zoom);
    *place = (struct colour_place){(uint32_t)sheet.left, (uint32_t)sheet.top, zoom};
    return STATUS_OK;
}

enum status colour_picture(const struct colour_scale *scale, const float *value, uint32_t width,
                           uint32_t height, unsigned zoom, struct image *out,
                           struct colour_place *place, struct reason *reason)
{
    *out = (struct image){0};
    *place = (struct colour_place){0};
    const size_t count = (size_t)width * height;
    uint32_t *pixel = alloc_zeroed(count, sizeof *pixel);
    if (!pixel)
        return fail(reason, STATUS_MEMORY, "no memory for a picture of %u x %u", width, height);
    for (size_t i = 0; i < count; i++)
        pixel[i] = colour_of(scale, value[i]);
    enum status status = colour_picture_of(scale, pixel, width, height, zoom, out, place, reason);
    free(pixel);
    return status;
}
