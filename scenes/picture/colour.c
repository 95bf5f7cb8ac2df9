#include "scenes/picture/colour.h"

#include <math.h>
#include <stdio.h>

/* Both tables are paths through OKLab (Ottosson 2020), sampled in steps of equal length. Entries
 * are 0xRRGGBB; bytes are interpolated between entries. */
#define STEPS 33

/* Lightness 0.18 to 0.96; hue from violet through blue and green to yellow. */
static const uint32_t sequential[STEPS] = {
    0x190232, 0x1E063F, 0x230C4C, 0x271359, 0x2A1A67, 0x2D2175, 0x2E2B7F, 0x2E3787, 0x25428C,
    0x174D90, 0x015792, 0x01608F, 0x01698E, 0x02728D, 0x007B8E, 0x05848F, 0x018E8F, 0x06978E,
    0x00A08C, 0x0BA887, 0x33AF81, 0x4CB77B, 0x63BD74, 0x79C46C, 0x8EC964, 0xA4CE5A, 0xBAD251,
    0xCFD548, 0xDBDB60, 0xE7E177, 0xF2E88C, 0xFCEFA1, 0xFFF3B9};

/* Lightness 0.36 at both ends, 0.96 in the middle; blue and brown. */
static const uint32_t diverging[STEPS] = {
    0x003981, 0x014090, 0x084A9E, 0x1956AB, 0x2662B9, 0x326FC6, 0x3E7BD3, 0x5187D7, 0x6393DB,
    0x759FDF, 0x86ABE2, 0x98B7E5, 0xAAC3E8, 0xBBCFEB, 0xCDDAED, 0xDFE6F0, 0xF2F2F2, 0xEEE2DD,
    0xEBD2C8, 0xE7C3B3, 0xE2B39E, 0xDDA48A, 0xD89475, 0xD28461, 0xCC744B, 0xC66433, 0xBC541A,
    0xAE4702, 0xA04001, 0x913A01, 0x833300, 0x742D01, 0x672600};

static const uint32_t classes[COLOUR_CLASS_COUNT] = {0x0072B2, 0xD55E00, 0x009E73, 0xCC79A7,
                                                     0xE69F00, 0x56B4E9, 0x000000, 0xF0E442};

static uint32_t from_rgb(uint32_t rgb)
{
    return image_rgb(rgb >> 16, rgb >> 8, rgb);
}

/* Table colour at `part`, clamped to 0 .. 1. */
static uint32_t in_table(const uint32_t table[STEPS], double part)
{
    if (!(part > 0.0))
        return from_rgb(table[0]);
    if (part >= 1.0)
        return from_rgb(table[STEPS - 1]);
    const double at = part * (STEPS - 1);
    const unsigned below = (unsigned)at;
    const unsigned share = (unsigned)((at - below) * 256.0);
    uint32_t out = 0;
    for (unsigned shift = 0; shift < 24; shift += 8) {
        uint32_t lo = table[below] >> shift & 255, hi = table[below + 1] >> shift & 255;
        out |= (lo * (256 - share) + hi * share + 128) / 256 << shift;
    }
    return from_rgb(out);
}

uint32_t colour_sequential(double part)
{
    return in_table(sequential, part);
}

uint32_t colour_diverging(double part)
{
    return in_table(diverging, 0.5 + 0.5 * part);
}

uint32_t colour_of_id(uint32_t id)
{
    uint32_t hash = id + 0x9E3779B9u; /* Wellons 2018, lowbias32 */
    hash = (hash ^ hash >> 16) * 0x21F0AAADu;
    hash = (hash ^ hash >> 15) * 0xD35A2D97u;
    hash ^= hash >> 15;
    /* One channel is at least 192, one at most 95: never gray. */
    unsigned full = 192 + (hash & 63), small = hash >> 6 & 95, middle = hash >> 13 & 255;
    switch ((hash >> 21) % 6) {
    case 0:
        return image_rgb(full, middle, small);
    case 1:
        return image_rgb(middle, full, small);
    case 2:
        return image_rgb(small, full, middle);
    case 3:
        return image_rgb(small, middle, full);
    case 4:
        return image_rgb(middle, small, full);
    default:
        return image_rgb(full, small, middle);
    }
}

uint32_t colour_of_class(size_t index)
{
    return from_rgb(classes[index % COLOUR_CLASS_COUNT]);
}

void colour_text(uint32_t colour, char text[8])
{
    snprintf(text, 8, "#%02x%02x%02x", colour & 255u, colour >> 8 & 255u, colour >> 16 & 255u);
}

void colour_fit(struct colour_scale *scale, const float *value, size_t count)
{
    double lo = INFINITY, hi = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        if (!float_is_finite(value[i]) || (scale->logarithmic && !(value[i] > 0.0f)))
            continue;
        lo = fmin(lo, (double)value[i]);
        hi = fmax(hi, (double)value[i]);
    }
    if (scale->kind == COLOUR_DIVERGING) {
        hi = lo <= hi ? fmax(-lo, hi) : 0.0;
        lo = -(hi > 0.0 ? hi : 1.0);
        hi = -lo;
    } else if (!(lo <= hi)) {
        lo = scale->logarithmic ? 1.0 : 0.0;
        hi = scale->logarithmic ? 10.0 : 1.0;
    } else if (lo == hi) {
        hi = scale->logarithmic ? 10.0 * lo : lo + fmax(1.0, 1e-3 * fabs(lo));
    }
    scale->lo = lo;
    scale->hi = hi;
}

uint32_t colour_of(const struct colour_scale *scale, float value)
{
    const double v = (double)value;
    if (value != value)
        return COLOUR_NO_DATA;
    switch (scale->kind) {
    case COLOUR_DIVERGING:
        return colour_diverging(v / scale->hi);
    case COLOUR_IDS:
        return v >= 0.0 && v < 4294967296.0 ? colour_of_id((uint32_t)v) : COLOUR_NO_DATA;
    case COLOUR_CLASSES:
        return v >= 0.0 && v < (double)scale->class_count ? colour_of_class((size_t)v)
                                                          : COLOUR_NO_DATA;
    case COLOUR_SEQUENTIAL:
        break;
    }
    if (scale->logarithmic)
        return colour_sequential(v > scale->lo ? log(v / scale->lo) / log(scale->hi / scale->lo)
                                               : 0.0);
    return colour_sequential((v - scale->lo) / (scale->hi - scale->lo));
}
