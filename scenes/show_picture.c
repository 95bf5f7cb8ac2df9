#include "scenes/show_picture.h"

#include "ref/mutant.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define LEAST_SIDE 320u /* pixels are enlarged until a picture is so wide */

/* Which colour a verdict has: of the ten the rarest three that excuse share one. */
enum { CLASS_OTHER = 6, CLASS_NAMES = COLOUR_CLASS_COUNT };
static const size_t class_of[VERDICT_COUNT] = {
#if MUTANT == MUTANT_WRONG_IS_BLUE
    [VERDICT_WRONG] = 0,
#else
    [VERDICT_WRONG] = 1,
#endif
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

/* The legend of verdicts: "right 1234". */
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

static const char *no_data(const struct show *show, bool difference)
{
    if (show->id == SHOW_INFLATION)
        return "no box to compare";
    if (show->from == SHOW_FROM_WALK && show->id != SHOW_OVERLAP && show->id != SHOW_OVERLAP_ALL)
        return NULL;
    if (show->id == SHOW_CLASS)
        return NULL;
    if (show->names && difference)
        return "miss in both";
    if (show->id == SHOW_ERROR)
        return "miss, or no bound";
    return difference ? "miss in one or both" : "miss";
}

static void set_ends(const struct show *show, const float *value, size_t count,
                     const struct show_range *range, struct colour_scale *scale)
{
    colour_fit(scale, value, count);
    if (show->id == SHOW_ERROR && scale->kind == COLOUR_SEQUENTIAL) {
        scale->lo = 0.0;
        scale->hi = fmax(scale->hi, 1.0);
    }
    if (range->given) {
        scale->lo = range->lo;
        scale->hi = range->hi;
    }
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
        snprintf(legend->text[i], sizeof legend->text[i], "%s %zu", name[i], classes[i]);
        legend->name[i] = legend->text[i];
    }
}

static unsigned byte_of(double x)
{
    return (unsigned)(127.5 * (fmin(fmax(x, -1.0), 1.0) + 1.0));
}

/* The colour of pixel i; `value` is the same in float. */
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
    struct colour_scale scale = {.kind = COLOUR_IDS,
                                 .title = title,
                                 .unit = show->label,
                                 .no_data = no_data(show, difference)};
    *out = (struct image){0};
    enum status status = show_range_check(show, difference, range, reason);
    if (status)
        return status;
    float *amount = alloc_zeroed(count, sizeof *amount);
    if (!amount)
        return fail(reason, STATUS_MEMORY, "no memory for a picture of %ux%u", width, height);
    for (size_t i = 0; i < count && (show->planes == 1 || difference); i++)
        amount[i] = (float)value[i];
    if (is_amount(show, difference)) {
        bool both_sides = difference && show->planes == 1;
        scale.kind = both_sides ? COLOUR_DIVERGING : COLOUR_SEQUENTIAL;
        scale.unit = show->planes == 3 ? "degrees between" : show->label;
        set_ends(show, amount, count, range, &scale);
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
    status = draw(show, difference, value, width, height, &scale, amount, out, place, reason);
    free(amount);
    return status;
}
