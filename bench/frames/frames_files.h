/* The files of a measured run of frames. */
#ifndef FRAMES_FILES_H
#define FRAMES_FILES_H

#include "bench/chart/chart.h"
#include "bench/frames/frames.h"

#define FRAMES_NOTES 12

/* Description of the measurement for the files. All borrowed. */
struct frames_about {
    const char *title; /* of the chart, such as "terrain:k=6, 384 x 288, 4 bounces" */
    struct {
        const char *name, *value; /* such as "device", "driver"; name NULL: the end */
    } note[FRAMES_NOTES];
    size_t base; /* contestant that ratios refer to; SIZE_MAX: none */
};

/* How the samples were measured: "GPU timestamps", or "host clock" if any sample has no timestamps;
 * followed by ", rays alone" if shading is excluded. */
const char *frames_clock(const struct frames_contestant *contestant);

/* The line of a contestant in a chart; borrows the run. */
struct chart_series frames_series(const struct frames_run *run, size_t contestant);

/* A chart of such lines: ms over the requested frames. */
struct chart frames_chart(const struct frames_run *run, const char *title,
                          const struct chart_series *series, size_t count);

#define FRAMES_FILES     4
#define FRAMES_PATH_MOST 4096

/* The name of file 0 to FRAMES_FILES - 1 of those that frames_write writes. Errors: STATUS_INPUT
 * too long a name (reason). */
enum status frames_file(const char *base, size_t file, char path[FRAMES_PATH_MOST],
                        struct reason *reason) MUST_USE;

/* Writes the measurements so far, each file completely or not at all:
 *   BASE.csv   a row per handler and frame: handler, bytes, clock, frame, angle_deg, ms, and the
 *              handler's average_ms, min_ms, max_ms, median_ms
 *   BASE.json  the same, with the notes, dropped warm-up frames, and ratios to about->base
 *   BASE.svg, BASE.png   a line per handler: ms over frame
 * Errors: STATUS_INPUT cannot write (reason); STATUS_MEMORY. */
enum status frames_write(const struct frames_run *run, const struct frames_about *about,
                         const char *base, struct reason *reason) MUST_USE;

#endif
