#include "scenes/picture/image_diff.h"

#include <math.h>
#include <stdlib.h>

#define HEAT_SIDE      480u /* smaller pictures are enlarged up to this side */
#define HEAT_ZOOM_MOST 16u
#define LOGARITHMIC    16u

const char *const image_diff_size_names[IMAGE_DIFF_SIZES] = {"1", "2", "3-7", "8-31", "32+"};

static unsigned channel_diff(uint32_t a, uint32_t b, unsigned channel)
{
    unsigned p = a >> 8 * channel & 255, q = b >> 8 * channel & 255;
    return p > q ? p - q : q - p;
}

unsigned image_diff_of(uint32_t a, uint32_t b)
{
    unsigned most = 0;
    for (unsigned k = 0; k < IMAGE_CHANNELS; k++) {
        unsigned d = channel_diff(a, b, k);
        most = d > most ? d : most;
    }
    return most;
}

static unsigned size_of(unsigned difference)
{
    static const unsigned from[IMAGE_DIFF_SIZES] = {1, 2, 3, 8, 32};
    unsigned size = 0;
    while (size + 1 < IMAGE_DIFF_SIZES && difference >= from[size + 1])
        size++;
    return size;
}

/* Counts a pixel that differs. */
static void take(struct image_diff *out, uint32_t x, uint32_t y, uint32_t a, uint32_t b)
{
    const struct image_diff_pixel pixel = {x, y, a, b};
    const unsigned difference = image_diff_of(a, b);
    if (out->differing++ == 0) {
        out->first = out->worst = pixel;
        out->least_x = out->most_x = x;
        out->least_y = y;
    }
    out->by_size[size_of(difference)]++;
    for (unsigned k = 0; k < IMAGE_CHANNELS; k++) {
        unsigned d = channel_diff(a, b, k);
        out->largest[k] = d > out->largest[k] ? d : out->largest[k];
        out->total[k] += d;
    }
    out->least_x = x < out->least_x ? x : out->least_x;
    out->most_x = x > out->most_x ? x : out->most_x;
    out->most_y = y;
    if (difference > image_diff_of(out->worst.a, out->worst.b))
        out->worst = pixel;
}

enum status image_diff(const struct image *a, const struct image *b, struct image_diff *out,
                       struct reason *reason)
{
    *out = (struct image_diff){0};
    if (a->width != b->width || a->height != b->height)
        return fail(reason, STATUS_INPUT, "%u x %u pixels against %u x %u: sides must be equal",
                    a->width, a->height, b->width, b->height);
    out->pixels = (uint64_t)a->width * a->height;
    for (uint32_t y = 0; y < a->height; y++)
        for (uint32_t x = 0; x < a->width; x++) {
            const size_t i = (size_t)y * a->width + x;
            if (a->pixel[i] != b->pixel[i])
                take(out, x, y, a->pixel[i], b->pixel[i]);
        }
    return STATUS_OK;
}

unsigned image_diff_largest(const struct image_diff *diff)
{
    unsigned most = 0;
    for (unsigned k = 0; k < IMAGE_CHANNELS; k++)
        most = diff->largest[k] > most ? diff->largest[k] : most;
    return most;
}

static unsigned zoom_of(uint32_t width, uint32_t height)
{
    uint32_t side = width > height ? width : height, zoom = HEAT_SIDE / side;
    return zoom < 1 ? 1 : zoom > HEAT_ZOOM_MOST ? HEAT_ZOOM_MOST : zoom;
}

enum status image_diff_heat(const struct image *a, const struct image *b,
                            const struct image_diff *diff, const char *title, struct image *out,
                            struct colour_place *place, struct reason *reason)
{
    *out = (struct image){0};
    *place = (struct colour_place){0};
    const unsigned most = image_diff_largest(diff);
    const struct colour_scale scale = {.kind = COLOUR_SEQUENTIAL,
                                       .logarithmic = most >= LOGARITHMIC,
                                       .lo = most >= LOGARITHMIC ? 1.0 : 0.0,
                                       .hi = most ? most : 1.0,
                                       .title = title,
                                       .unit = "largest difference of a channel",
                                       .no_data = "equal"};
    float *value = alloc_zeroed((size_t)diff->pixels, sizeof *value);
    if (!value)
        return fail(reason, STATUS_MEMORY, "no memory for a heat map of %u x %u", a->width,
                    a->height);
    for (size_t i = 0; i < (size_t)diff->pixels; i++) {
        unsigned difference = image_diff_of(a->pixel[i], b->pixel[i]);
        value[i] = difference ? (float)difference : NAN;
    }
    enum status status = colour_picture(&scale, value, a->width, a->height,
                                        zoom_of(a->width, a->height), out, place, reason);
    free(value);
    return status;
}
