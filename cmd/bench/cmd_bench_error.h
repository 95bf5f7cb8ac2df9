/* Speed against error: the results on one page of the benchmark, and functions that print them. For
 * commands only. */
#ifndef CMD_BENCH_ERROR_H
#define CMD_BENCH_ERROR_H

#include "cmd/bench/cmd_bench_known.h"
#include "bench/measure/error_measure.h"
#include "bench/measure/leak_rays.h"

#define LEAK_TARGETS 2

/* One contestant. */
struct error_row {
    const struct engine *engine;
    const struct layout *layout; /* NULL: none */
    const struct tri_test *tri;  /* NULL: the engine uses its own box and triangle tests */
    const struct box_test *box;
    struct spread mrays, ratio;
    const char *base; /* name of the ratio's base */
    struct error_sum sum;
    size_t leak[LEAK_TARGETS];
    bool judged; /* false: a member as published takes part, so errors are only counted */
    struct known_verdicts verdicts;
    double boxes, tris;  /* tests per ray; NAN: not counted */
    double boxes_to_f32; /* relative to the same engine and tests on f32; NAN: not available */
    double tris_to_f32;
    uint64_t node_bytes, item_bytes, memory_bytes; /* totals; without a layout 0 is not known */
};

/* One scene with one ray set. */
struct error_page {
    const char *scene, *rays;
    uint32_t tri_count;
    size_t ray_count, exact_hits;
    size_t leak_rays[LEAK_TARGETS]; /* 0: the mesh is not closed */
    struct reason no_leaks;         /* the reason, if there are no leak rays */
    struct error_row row[CONTESTANTS];
    size_t row_count;
};

/* Prints the page's tables and adds its rows to CSV and JSON. */
void error_print(struct bench *bench, const struct error_page *page);

/* Writes the plots of the bench's rows to its SVG, if there are any rows. Errors: STATUS_INPUT
 * cannot write there, STATUS_MEMORY. */
enum status error_plot(const struct bench *bench, const char *driver,
                       struct reason *reason) MUST_USE;

/* Writes the driver that engine vulkan would use, such as "llvmpipe Mesa 22.3.6", or "" without
 * one. Includes only the part of its description that is the same on every machine. */
void error_driver(const struct engine_options *options, char *text, size_t text_bytes);

#endif
