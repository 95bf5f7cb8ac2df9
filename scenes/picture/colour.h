/* Colours for numbers. All maps are readable with red-green colour blindness: lightness follows the
 * value. */
#ifndef COLOUR_H
#define COLOUR_H

#include "scenes/picture/image.h"

enum colour_kind {
    COLOUR_SEQUENTIAL, /* dark to light */
    COLOUR_DIVERGING,  /* differences: blue below 0, white at 0, brown above */
    COLOUR_IDS,        /* whole numbers, each with its own colour: colour_of_id */
    COLOUR_CLASSES,    /* index into class_name: colour_of_class */
};

/* How values are coloured, and the texts around them. Texts are borrowed and may be NULL. */
struct colour_scale {
    enum colour_kind kind;
    bool logarithmic; /* sequential only: lo > 0; smaller values have the colour of lo */
    double lo, hi;    /* sequential: lo < hi; diverging: -hi to hi, hi > 0; else unused */
    const char *title;
    const char *unit;    /* what the values count, next to the scale bar: "boxes visited" */
    const char *no_data; /* meaning of NaN, such as "miss" */
    const char *const *class_name;
    size_t class_count;
};

/* Colour of NaN and of invalid class indices. No map contains it. */
#define COLOUR_NO_DATA image_rgb(112, 112, 112)

/* part from 0 (dark) to 1 (light), clamped. Equal steps of `part` look equal. */
uint32_t colour_sequential(double part);

/* part from -1 to 1, clamped; 0 is neutral. */
uint32_t colour_diverging(double part);

/* Colour by hash: the same for equal ids, usually different for different ones, never gray. */
uint32_t colour_of_id(uint32_t id);

/* Colours of classes and series; index modulo COLOUR_CLASS_COUNT. Okabe and Ito 2008. */
#define COLOUR_CLASS_COUNT 8
uint32_t colour_of_class(size_t index);

/* As text: "#0072b2". */
void colour_text(uint32_t colour, char text[8]);

/* Sets lo and hi of a sequential or diverging scale to cover all finite values (logarithmic: all
 * positive ones); a scale of width 0 is widened. Without such a value: 0 to 1 (logarithmic: 1 to
 * 10, diverging: -1 to 1). */
void colour_fit(struct colour_scale *scale, const float *value, size_t count);

/* The colour of a value. Infinities have the colour of their end of the scale. */
uint32_t colour_of(const struct colour_scale *scale, float value);

#endif
