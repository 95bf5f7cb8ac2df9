/* Colours for numbers. All maps are readable with red-green colour blindness: lightness
 * follows the number. */
#ifndef COLOUR_H
#define COLOUR_H

#include "scenes/picture/image.h"

enum colour_kind {
    COLOUR_SEQUENTIAL, /* dark to light */
    COLOUR_DIVERGING,  /* differences: blue below 0, white at 0, brown above */
    COLOUR_IDS,        /* whole numbers, each with a colour of its own: colour_of_id */
    COLOUR_CLASSES,    /* an index of class_name: colour_of_class */
};

/* The colours of values, and the texts around them. Texts are borrowed; NULL is none. */
struct colour_scale {
    enum colour_kind kind;
    bool logarithmic; /* only sequential: lo > 0, and values below lo look as lo */
    double lo, hi;    /* sequential: lo < hi; diverging: from -hi to hi, hi > 0; else unread */
    const char *title;
    const char *unit;    /* what is counted, beside the scale bar, such as "boxes visited" */
    const char *no_data; /* what a NaN means, such as "miss" */
    const char *const *class_name;
    size_t class_count;
};

/* Of values that are NaN, and class indices that are none. No map has it. */
#define COLOUR_NO_DATA image_rgb(112, 112, 112)

/* part from 0 (dark) to 1 (light); beyond, the end's; even steps look even. */
uint32_t colour_sequential(double part);

/* part from -1 to 1; 0 is neutral. */
uint32_t colour_diverging(double part);

/* A colour by hash: the same for the same id, mostly another for another, never gray. */
uint32_t colour_of_id(uint32_t id);

/* Colours of classes and of series, taken modulo COLOUR_CLASS_COUNT. Okabe and Ito 2008. */
#define COLOUR_CLASS_COUNT 8
uint32_t colour_of_class(size_t index);

/* "#0072b2" */
void colour_text(uint32_t colour, char text[8]);

/* Sets lo and hi of a sequential or diverging scale so that every finite value has its colour; a
 * scale of width 0 is widened. Without any, 0 to 1 (logarithmic: 1 to 10). */
void colour_fit(struct colour_scale *scale, const float *value, size_t count);

/* The colour of one value. Infinities have that of their end. */
uint32_t colour_of(const struct colour_scale *scale, float value);

#endif
