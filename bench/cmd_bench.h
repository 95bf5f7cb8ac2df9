/* What the benchmarks share. For commands only. */
#ifndef CMD_BENCH_H
#define CMD_BENCH_H

#include "ref/cmd_options.h"
#include "ref/cmd_tables.h"
#include "ref/match.h"
#include "scenes/file.h"

#define BENCH_SCENES 16
#define BENCH_ROUNDS 99

/* Settings of a run, and where its rows go. */
struct bench {
    const char *scene[BENCH_SCENES]; /* the user's, if any */
    size_t scene_count;
    uint64_t ray_count, rounds;
    struct engine_options engines;
    struct progress progress;
    const char *csv_path;
    struct file_out csv; /* stream NULL: none */
};

/* A benchmark; `run` returns an exit code. */
struct benchmark {
    const char *name;
    const char *summary;
    int (*run)(struct bench *bench);
};

extern const struct benchmark bench_layouts, bench_builders;

/* Median, least and most of `count` values, which are sorted in place; count >= 1. */
struct spread {
    double median, least, most;
};
struct spread spread_of(double *value, size_t count);

/* The user's scenes, or `own` (NULL-terminated), of which files that are not there are left out
 * with a line that says so. Returns how many are in `out`. */
size_t bench_scenes(const struct bench *bench, const char *const *own,
                    const char *out[BENCH_SCENES]);

#endif
