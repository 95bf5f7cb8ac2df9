#include "scenes/render/diff_frames.h"

#include "scenes/picture/image_diff.h"

#include <math.h>

const char *path_field_name(enum path_field field)
{
    static const char *const names[PATH_FIELD_COUNT] = {"same", "prim", "t", "asked", "shadowed"};
    return field < PATH_FIELD_COUNT ? names[field] : "unknown";
}

static bool same_t(float a, float b)
{
    return float_bits(a) == float_bits(b);
}

/* The members that differ, as bits of enum path_field. */
static unsigned apart(const struct segment *a, const struct segment *b)
{
    unsigned fields = 0;
    if (a->prim != b->prim)
        fields |= 1u << PATH_PRIM;
    if (!same_t(a->t, b->t))
        fields |= 1u << PATH_T;
    if (a->asked != b->asked)
        fields |= 1u << PATH_ASKED;
    if (a->shadowed != b->shadowed)
        fields |= 1u << PATH_SHADOWED;
    return fields;
}

/* Segment `i` of a path; an empty one after its end. */
static struct segment segment_of(const struct segment *path, uint32_t i, bool *ended)
{
    *ended = *ended || path[i].prim == ABI_NO_SEGMENT;
    return *ended ? (struct segment){.prim = ABI_NO_SEGMENT} : path[i];
}

static enum path_field first_of(unsigned fields)
{
    for (enum path_field field = PATH_PRIM; field < PATH_FIELD_COUNT; field++)
        if (fields & 1u << field)
            return field;
    return PATH_SAME;
}

enum path_field path_first(const struct segment *a, const struct segment *b, uint32_t bounces,
                           uint32_t *segment)
{
    bool a_ended = false, b_ended = false;
    for (*segment = 0; *segment < bounces && !(a_ended && b_ended); ++*segment) {
        struct segment of_a = segment_of(a, *segment, &a_ended);
        struct segment of_b = segment_of(b, *segment, &b_ended);
        enum path_field field = first_of(apart(&of_a, &of_b));
        if (field != PATH_SAME)
            return field;
    }
    *segment = 0;
    return PATH_SAME;
}

bool pixel_within(const float color[3], float bound, uint32_t pixel)
{
    for (unsigned channel = 0; channel < 3; channel++) {
        float total = color[channel], clamped = total > 0.0f ? total < 1.0f ? total : 1.0f : 0.0f;
        double sum = (double)(255.0f * clamped + 0.5f), value = pixel >> 8 * channel & 255u;
        if (!(bound >= 0.0f))
            return false;
        if (value < floor(sum - (double)bound) || value > floor(sum + (double)bound))
            return false;
    }
    return pixel >> 24 == 255u;
}

/* Counts the segments of a path by the members that differ. Returns the first that differs. */
static enum path_field count_segments(const struct segment *a, const struct segment *b,
                                      uint32_t bounces, struct frame_diff *diff)
{
    enum path_field first = PATH_SAME;
    bool a_ended = false, b_ended = false;
    for (uint32_t i = 0; i < bounces; i++) {
        struct segment of_a = segment_of(a, i, &a_ended), of_b = segment_of(b, i, &b_ended);
        if (a_ended && b_ended)
            break;
        unsigned fields = apart(&of_a, &of_b);
        diff->segments++;
        diff->hits += of_a.prim < ABI_NO_SEGMENT || of_b.prim < ABI_NO_SEGMENT;
        diff->field[PATH_SAME] += fields == 0;
        for (enum path_field field = PATH_PRIM; field < PATH_FIELD_COUNT; field++)
            diff->field[field] += fields >> field & 1u;
        if (first == PATH_SAME)
            first = first_of(fields);
    }
    return first;
}

static bool has_bound(const struct frame *frame, size_t pixel)
{
    return frame->color && frame->bound && !isnan(frame->bound[pixel]);
}

void frame_compare_pixel(const struct frame *a, const struct frame *b, size_t pixel,
                         uint32_t bounces, struct frame_diff *diff)
{
    const struct segment *path_a = a->segment + pixel * bounces;
    const struct segment *path_b = b->segment + pixel * bounces;
    enum path_field first = count_segments(path_a, path_b, bounces, diff);
    unsigned difference = image_diff_of(a->pixel[pixel], b->pixel[pixel]);
    diff->paths++;
    diff->paths_apart += first != PATH_SAME;
    diff->first[first]++;
    diff->colours += difference > 0;
    diff->largest = difference > diff->largest ? difference : diff->largest;
    if (difference == 0 || first != PATH_SAME)
        return;
    const struct frame *known = has_bound(a, pixel) ? a : has_bound(b, pixel) ? b : NULL;
    const float *color = known ? known->color + 3 * pixel : NULL;
    bool within = known && pixel_within(color, known->bound[pixel], a->pixel[pixel]) &&
                  pixel_within(color, known->bound[pixel], b->pixel[pixel]);
    diff->allowed += within;
    diff->excess += !within;
}

struct frame_diff frame_compare(const struct frame *a, const struct frame *b, uint32_t width,
                                uint32_t height, uint32_t bounces)
{
    struct frame_diff diff = {0};
    for (size_t pixel = 0; pixel < (size_t)width * height; pixel++)
        frame_compare_pixel(a, b, pixel, bounces, &diff);
    return diff;
}
