/* The files of a measured run of frames. */
#ifndef FRAMES_FILES_H
#define FRAMES_FILES_H

#include "bench/chart/chart.h"
#include "bench/frames/frames.h"

#define FRAMES_NOTES 12

/* What was measured, for readers of the files. All borrowed. */
struct frames_about {
    const char *title; /* of the chart: "terrain:k=6, 384 x 288, 4 bounces" */
    struct {
        const char *name, *value; /* "device", "driver", ... ; name NULL: the end */
    } note[FRAMES_NOTES];
    size_t base; /* contestant that ratios are to; SIZE_MAX: none */
};

/* What the samples are of: "GPU timestamps", or "host clock" where a sample has none; with ", rays
 * alone" where shading is not in them. */
const char *frames_clock(const struct frames_contestant *contestant);

/* The line of a contestant in a chart of the frames; borrows the run. */
struct chart_series frames_series(const struct frames_run *run, size_t contestant);

/* A chart of such lines, in ms over the frames that were asked for. */
struct chart frames_chart(const struct frames_run *run, const char *title,
                          const struct chart_series *series, size_t count);

/* Writes what is measured so far, each file whole or not at all:
 *   BASE.csv   a row per handler and frame: handler, bytes, clock, frame, angle_deg, ms, and the
 *              handler's average_ms, min_ms, max_ms, median_ms
 *   BASE.json  the same, with the notes, warm-up frames dropped, and ratios to about->base
 *   BASE.svg, BASE.png   a line per handler: ms over frame
 * Errors: STATUS_INPUT cannot write (reason); STATUS_MEMORY. */
enum status frames_write(const struct frames_run *run, const struct frames_about *about,
                         const char *base, struct reason *reason) MUST_USE;

#endif
