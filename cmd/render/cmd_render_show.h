/* What the parts of `raydiff render --show` share. For commands only. */
#ifndef CMD_RENDER_SHOW_H
#define CMD_RENDER_SHOW_H

#include "bench/measure/error_measure.h"
#include "cmd/render/cmd_render.h"
#include "scenes/render/show_picture.h"

#define SHOW_LAYERS_MOST 2

/* One layout's values, or the difference of both. */
struct show_layer {
    const char *name;              /* of the layout, or of an engine that needs none */
    double *value;                 /* show->planes of each pixel; of a difference one */
    struct trace_counts counts;    /* as the engine counted */
    struct show_sum sum;           /* of one plane; else all 0 */
    struct quantiles quantiles;    /* likewise */
    size_t verdict[VERDICT_COUNT]; /* of class */
};

/* A picture being made. */
struct showing {
    const struct show *show;
    const struct render_settings *settings;
    const struct engine *engine; /* of the walk the one that counts: cpu */
    const char *csv;             /* or NULL */
    struct show_range range;
    size_t pixels;
    struct show_layer layer[SHOW_LAYERS_MOST];
    size_t layer_count;
    struct show_layer difference; /* of two layers */
    size_t alone;                 /* pixels of which only one layer has a value */
    bool judged;                  /* false: a member as published takes part, only counted */
    char title[256];
};

/* What was seen, on the standard output. */
void showing_print(const struct showing *showing, const struct image *image);

/* Every pixel as a line "x,y,VALUES", and with two layers their difference.
 * Errors: as options_out and file_out_commit. */
enum status showing_csv(const struct showing *showing, struct reason *reason) MUST_USE;

/* The statistics that are printed. Errors: as json_write. */
enum status showing_json(const struct showing *showing, const char *path,
                         struct reason *reason) MUST_USE;

#endif
