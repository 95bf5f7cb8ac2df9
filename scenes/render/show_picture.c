#include "scenes/render/show_picture.h"

#include "scenes/picture/draw.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define ERROR_LEAST 1e-3 /* smaller shares of the bound have the same colour */
#define LABEL_BYTES 80
#define MARKS_MOST  400u /* most odd pixels that get a frame */
#define LEAST_SIDE  320u /* narrower pictures are enlarged up to this width */

/* Colour class of each verdict. Ten verdicts share eight colours: the three rarest allowed ones
 * have the same. */
enum { CLASS_OTHER = 6, CLASS_NAMES = COLOUR_CLASS_COUNT };
static const size_t class_of[VERDICT_COUNT] = {
    [VERDICT_WRONG] = 1,
    [VERDICT_RIGHT] = 0,
    [VERDICT_TIE] = 2,
    [VERDICT_NEAR_TIE] = 3,
    [VERDICT_BOUNDARY] = 4,
    [VERDICT_BORDER] = 5,
    [VERDICT_IN_PLANE] = 7,
    [VERDICT_SLAB] = CLASS_OTHER,
    [VERDICT_NOISE] = CLASS_OTHER,
    [VERDICT_OUT_OF_CONTRACT] = CLASS_OTHER,
};

/* The legend of verdicts, such as "right 1234". */
struct legend {
    char text[CLASS_NAMES][48];
    const char *name[CLASS_NAMES];
};

static bool is_amount(const struct show *show, bool difference)
{
    return !show->names && (show->planes == 1 || difference);
}

enum status show_range_check(const struct show *show, bool difference,
                             const struct show_range *range, struct reason *reason)
{
    if (!range->given)
        return STATUS_OK;
    if (!is_amount(show, difference))
        return fail(reason, STATUS_INPUT, "--show-range: %s has no range of colours", show->name);
    if (!(range->lo < range->hi) || !isfinite(range->lo) || !isfinite(range->hi))
        return fail(reason, STATUS_INPUT, "--show-range: %g:%g is no range", range->lo, range->hi);
    if (difference && show->planes == 1 && range->lo != -range->hi)
        return fail(reason, STATUS_INPUT,
                    "--show-range: a difference has 0 in its middle: %g:%g, not %g:%g", -range->hi,
                    range->hi, range->lo, range->hi);
    return STATUS_OK;
}

/* The meaning of a pixel without value; NULL if all pixels have one. */
static const char *no_data(const struct show *show, bool difference, const double *value,
                           size_t count)
{
    uint32_t planes = difference ? 1 : show->planes;
    size_t with = 0;
    while (with < count && !isnan(value[planes * with]))
        with++;
    if (with == count)
        return NULL;
    if (show->id == SHOW_INFLATION)
        return "no box to compare";
    if (show->names && difference)
        return "miss in both";
    if (show->id == SHOW_ERROR)
        return "miss, or no bound";
    return difference ? "miss in one or both" : "miss";
}

static int by_value(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return order_doubles((double)x, (double)y);
}

/* The 90th percentile of the differences that are not 0, by magnitude; 0 if there are none. With
 * the maximum as the end of the scale, a few large differences would make all others look like 0.
 * Errors: STATUS_MEMORY. */
static enum status usual(const float *value, size_t count, double *out, struct reason *reason)
{
    size_t some = 0;
    *out = 0.0;
    float *size = alloc_zeroed(count, sizeof *size);
    if (!size)
        return fail(reason, STATUS_MEMORY, "no memory for %zu pixels", count);
    for (size_t i = 0; i < count; i++)
        if (float_is_finite(value[i]) && value[i] != 0.0f)
            size[some++] = fabsf(value[i]);
    qsort(size, some, sizeof *size, by_value);
    if (some > 0)
        *out = (double)size[(some - 1) * 9 / 10];
    free(size);
    return STATUS_OK;
}

static enum status set_ends(const struct show *show, const float *value, size_t count,
                            const struct show_range *range, struct colour_scale *scale,
                            char label[LABEL_BYTES], struct reason *reason)
{
    enum status status = STATUS_OK;
    double most;
    colour_fit(scale, value, count);
    if (show->id == SHOW_ERROR && scale->kind == COLOUR_SEQUENTIAL) {
        scale->logarithmic = true;
        scale->lo = ERROR_LEAST;
        scale->hi = fmax(scale->hi, 1.0);
    } else if (scale->kind == COLOUR_DIVERGING && !range->given) {
        status = usual(value, count, &most, reason);
        if (most > 0.0 && most < scale->hi) {
            snprintf(label, LABEL_BYTES, "%s (the largest 10 %% have the end colours)",
                     scale->unit);
            scale->hi = most;
            scale->unit = label;
        }
    }
    if (range->given) {
        scale->lo = range->lo;
        scale->hi = range->hi;
        scale->logarithmic = scale->logarithmic && scale->lo > 0.0;
    }
    return status;
}

static void count_classes(const double *value, size_t count, struct legend *legend)
{
    static const char *const name[CLASS_NAMES] = {
        "right",
        "wrong",
        "tie",
        "near tie",
        "boundary",
        "border",
        "slab, noise or out of contract",
        "in plane",
    };
    size_t classes[CLASS_NAMES] = {0};
    for (size_t i = 0; i < count; i++)
        classes[class_of[(size_t)value[i]]]++;
    for (size_t i = 0; i < CLASS_NAMES; i++) {
        const char *called = name[i];
        snprintf(legend->text[i], sizeof legend->text[i], "%s %zu", called, classes[i]);
        legend->name[i] = legend->text[i];
    }
}

static unsigned byte_of(double x)
{
    return (unsigned)(127.5 * (fmin(fmax(x, -1.0), 1.0) + 1.0));
}

/* The colour of pixel i. `amount` has the values as float. */
static uint32_t colour_at(const struct show *show, bool difference, const double *value, size_t i,
                          const struct colour_scale *scale, const float *amount)
{
    const double *n = value + 3 * i;
    if (show->planes == 3 && !difference)
        return isnan(*n) ? COLOUR_NO_DATA : image_rgb(byte_of(n[0]), byte_of(n[1]), byte_of(n[2]));
    if (show->id == SHOW_PRIM && !difference)
        return isnan(value[i]) ? COLOUR_NO_DATA : colour_of_id((uint32_t)value[i]);
    if (show->id == SHOW_CLASS && !difference)
        return colour_of_class(class_of[(size_t)value[i]]);
    return colour_of(scale, amount[i]);
}

/* Draws frames around the pixels that are not right, or that differ, if they are few: a single
 * pixel among half a million would not be seen. */
static void mark(const struct show *show, bool difference, const double *value, uint32_t width,
                 size_t count, const uint32_t *pixel, const struct colour_place *place,
                 struct image *image)
{
    size_t marks = 0;
    const double plain = difference ? 0.0 : (double)VERDICT_RIGHT;
    if (place->zoom > 3 || (!difference && show->id != SHOW_CLASS) || !show->names)
        return;
    for (size_t i = 0; i < count; i++)
        marks += !isnan(value[i]) && value[i] != plain;
    for (size_t i = 0; i < count && marks <= MARKS_MOST; i++) {
        int x = (int)(place->x + (uint32_t)(i % width) * place->zoom);
        int y = (int)(place->y + (uint32_t)(i / width) * place->zoom);
        int side = (int)place->zoom + 8;
        if (!isnan(value[i]) && value[i] != plain) {
            draw_frame(image, x - 4, y - 4, side, side, pixel[i]);
            draw_frame(image, x - 5, y - 5, side + 2, side + 2, pixel[i]);
        }
    }
}

static enum status draw(const struct show *show, bool difference, const double *value,
                        uint32_t width, uint32_t height, const struct colour_scale *scale,
                        const float *amount, struct image *out, struct colour_place *place,
                        struct reason *reason)
{
    size_t count = (size_t)width * height;
    uint32_t *pixel = alloc_zeroed(count, sizeof *pixel);
    if (!pixel)
        return fail(reason, STATUS_MEMORY, "no memory for a picture of %ux%u", width, height);
    for (size_t i = 0; i < count; i++)
        pixel[i] = colour_at(show, difference, value, i, scale, amount);
    enum status status =
        colour_picture_of(scale, pixel, width, height, width < LEAST_SIDE ? LEAST_SIDE / width : 1,
                          out, place, reason);
    if (!status)
        mark(show, difference, value, width, count, pixel, place, out);
    free(pixel);
    return status;
}

enum status show_picture(const struct show *show, bool difference, const double *value,
                         uint32_t width, uint32_t height, const struct show_range *range,
                         const char *title, struct image *out, struct colour_place *place,
                         struct reason *reason)
{
    static const char *const same_or_not[] = {"the same", "different"};
    size_t count = (size_t)width * height;
    struct legend legend;
    char label[LABEL_BYTES];
    struct colour_scale scale = {.kind = COLOUR_IDS, .title = title, .unit = show->label};
    *out = (struct image){0};
    enum status status = show_range_check(show, difference, range, reason);
    if (status)
        return status;
    scale.no_data = no_data(show, difference, value, count);
    float *amount = alloc_zeroed(count, sizeof *amount);
    if (!amount)
        return fail(reason, STATUS_MEMORY, "no memory for a picture of %ux%u", width, height);
    for (size_t i = 0; i < count && (show->planes == 1 || difference); i++)
        amount[i] = (float)value[i];
    if (is_amount(show, difference)) {
        bool both_sides = difference && show->planes == 1;
        scale.kind = both_sides ? COLOUR_DIVERGING : COLOUR_SEQUENTIAL;
        scale.unit = show->planes == 3 ? "degrees between" : show->label;
        status = set_ends(show, amount, count, range, &scale, label, reason);
    } else if (difference) {
        scale.kind = COLOUR_CLASSES;
        scale.class_name = same_or_not;
        scale.class_count = ARRAY_COUNT(same_or_not);
    } else if (show->id == SHOW_CLASS) {
        count_classes(value, count, &legend);
        scale.kind = COLOUR_CLASSES;
        scale.class_name = legend.name;
        scale.class_count = CLASS_NAMES;
    }
    if (!status)
        status = draw(show, difference, value, width, height, &scale, amount, out, place, reason);
    free(amount);
    return status;
}
