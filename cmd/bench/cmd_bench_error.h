/* Speed against error: what one page of the benchmark holds, and how it is shown. For commands
 * only. */
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
    const struct tri_test *tri;  /* NULL: the engine has its own, and its own box test */
    const struct box_test *box;
    struct spread mrays, ratio;
    const char *base; /* what the ratio is to */
    struct error_sum sum;
    size_t leak[LEAK_TARGETS];
    bool judged;         /* false: a member as published takes part, only counted */
    size_t wrong;        /* answers that the judge calls WRONG */
    size_t named;        /* answers in an allowed class */
    double over;         /* largest error of t over its proven bound; 0: none is
                            bounded; NAN: not judged */
    double displacement; /* the largest that an answer of an unknown formula needs, see judge.h */
    double boxes, tris;  /* tests per ray; NAN: not counted */
    double boxes_to_f32; /* against the same engine and tests on f32; NAN: not there */
    double tris_to_f32;
    uint64_t node_bytes, item_bytes, memory_bytes; /* in all */
};

/* One scene with one ray set. */
struct error_page {
    const char *scene, *rays;
    uint32_t tri_count;
    size_t ray_count, exact_hits;
    size_t leak_rays[LEAK_TARGETS]; /* 0: the mesh is not closed */
    struct reason no_leaks;         /* why, if so */
    struct error_row row[CONTESTANTS];
    size_t row_count;
};

/* Prints the page's tables and hands its rows to CSV and JSON. */
void error_print(struct bench *bench, const struct error_page *page);

/* Writes the figures of the bench's rows, if there are some, to its SVG. Errors: STATUS_INPUT
 * cannot write there, STATUS_MEMORY. */
enum status error_plot(const struct bench *bench, const char *driver,
                       struct reason *reason) MUST_USE;

/* The driver that engine vulkan would run on as "llvmpipe Mesa 22.3.6", or "" without one: the part
 * of its description that is the same on every machine. */
void error_driver(const struct engine_options *options, char *text, size_t text_bytes);

#endif
