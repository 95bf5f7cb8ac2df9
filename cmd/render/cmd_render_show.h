/* Shared by the files of `raydiff render --show`. Commands only. */
#ifndef CMD_RENDER_SHOW_H
#define CMD_RENDER_SHOW_H

#include "bench/measure/error_measure.h"
#include "cmd/render/cmd_render.h"
#include "scenes/render/show_picture.h"

#define SHOW_LAYERS_MOST 2

/* The values of one layout, or the difference of two. */
struct show_layer {
    const char *name;              /* of the layout, or of an engine that needs none */
    double *value;                 /* show->planes values per pixel; one for a difference */
    struct trace_counts counts;    /* the engine's own counters */
    struct show_sum sum;           /* only with one plane; else all 0 */
    struct quantiles quantiles;    /* only with one plane */
    size_t verdict[VERDICT_COUNT]; /* for class */
};

/* A picture in progress. */
struct showing {
    const struct show *show;
    const struct render_settings *settings;
    const struct engine *engine; /* for values from the walk: cpu */
    const char *csv;             /* or NULL */
    struct show_range range;
    size_t pixels;
    struct show_layer layer[SHOW_LAYERS_MOST];
    size_t layer_count;
    struct show_layer difference; /* only with two layers */
    size_t alone;                 /* pixels where only one layer has a value */
    bool judged; /* false: a member as published takes part, so results are only counted */
    char title[256];
};

/* Prints the statistics to standard output. */
void showing_print(const struct showing *showing, const struct image *image);

/* Writes every pixel as a line "x,y,VALUES"; two layers are followed by their difference. Errors:
 * those of options_out and file_out_commit. */
enum status showing_csv(const struct showing *showing, struct reason *reason) MUST_USE;

/* Writes the printed statistics as JSON. Errors: those of json_write. */
enum status showing_json(const struct showing *showing, const char *path,
                         struct reason *reason) MUST_USE;

#endif
