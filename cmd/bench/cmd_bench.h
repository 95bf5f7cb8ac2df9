/* Shared by the benchmarks. For commands only. */
#ifndef CMD_BENCH_H
#define CMD_BENCH_H

#include "bench/chart/spread.h"
#include "cmd/traffic/cmd_traffic.h"
#include "cmd/common/cmd_compiler.h"
#include "cmd/common/cmd_grid.h"
#include "cmd/common/cmd_tree.h"
#include "cmd/common/cmd_progress.h"
#include "ref/frame.h"
#include "ref/match/match.h"
#include "ref/files/file.h"

#include <jansson.h>

#define BENCH_SCENES    16
#define BENCH_ROUNDS    99
#define BENCH_TREE_NAME 120

#define BENCH_ENGINE_NAME 32

/* Parts of benchmark.takes: options of CPUs and Vulkan drivers, and of outside engines and
 * layouts. */
#define BENCH_MACHINE   " threads driver device workgroup"
#define BENCH_SCREEN    " wide color"
#define BENCH_COMPILERS " compiler decorate buffers"
#define BENCH_OUTSIDE   " peer-time peer-memory shader"

/* Settings of a run, and its outputs. */
struct bench {
    const char *scene[BENCH_SCENES]; /* named by the user, if any */
    size_t scene_count;
    uint64_t ray_count, rounds, seed;                  /* ray_count 0: the benchmark's default */
    uint64_t instances;                                /* likewise */
    struct list engine, layout, store, tri, box, rays; /* count 0: the benchmark's default */
    struct engine_options engines;
    struct compiler_options compilers;
    struct screen_options screen;
    struct screen screen_is; /* made of them; benchmarks that print one table for all ignore it */
    struct progress progress;
    const char *csv_path, *json_path, *svg_path;
    struct {
        uint64_t frames; /* 0: the benchmark's default */
        uint64_t width, height;
        uint64_t turns, warm_up, bounces;
        enum profile profile;
        const char *out;                       /* base name of the files; NULL: the default */
        char csv[4096], json[4096], svg[4096]; /* names made from `out` for the rows */
    } picture;
    bool quick;
    struct traffic_options traffic;
    const char *bvh;      /* --bvh: a tree file of the one scene; NULL: built */
    struct file_out csv;  /* stream NULL: no CSV */
    const char *csv_head; /* benchmark whose column names were written last */
    json_t *rows;         /* for JSON and SVG; NULL: not collected */
    size_t row_count;     /* of the benchmark that runs */
    int code;             /* the worst exit code so far, see bench_worse */
};

/* Measures one scene. bench_failed prints the errors. */
typedef enum status bench_play(struct bench *bench, const char *spec, const struct scene *scene,
                               struct reason *reason);

/* A benchmark measures scenes one by one with `play`, or has a `run` of its own. */
struct benchmark {
    const char *name;
    const char *summary;
    const char *takes;  /* names of the options it uses, separated by blanks */
    const char *about;  /* longer text for --help; or NULL */
    const char *scenes; /* default scenes, separated by ';' */
    const char *made;   /* used instead if none of those files was fetched; or NULL */
    bench_play *play;
    int (*run)(struct bench *bench); /* returns an exit code, or bench->code; NULL: bench_each */
    bool titled;                     /* prints its name before the scenes */
    bool triangles;                  /* a scene without triangles is an error */
    bool alone;          /* runs only if it is named: takes minutes or writes files of its own */
    bool undrawn;        /* it draws no rays: --seed is of the scene, or of the one in `scenes` */
    bool rows_out;       /* --out BASE names the files of its rows and its plot */
    const char *shown;   /* what exit code 0 means, for the last line */
    const char *refuted; /* what 1 means; NULL: nothing is judged */
};

extern const struct benchmark bench_layouts, bench_error, bench_spawn, bench_builders, bench_oracle,
    bench_fuzz, bench_frames, bench_paper, bench_special, bench_fast, bench_matrix, bench_tightness,
    bench_worlds, bench_traffic;

/* Merges an exit code into bench->code. A signal's code counts only if nothing else was wrong. */
void bench_worse(struct bench *bench, int code);

/* Counts a tree that was left out: with STATUS_LIMIT, which says that it does not hold the scene,
 * if the user named its layout or its storage; so does raydiff check. */
void bench_left_out(struct bench *bench, const struct layout *layout, const struct tri_store *store,
                    enum status status);

/* Prints "raydiff bench: SCENE: why" on standard error and counts the exit code, unless `status` is
 * STATUS_OK. Leaves out the scene's name if `spec` is NULL or the reason begins with it. */
void bench_failed(struct bench *bench, const char *spec, enum status status,
                  const struct reason *reason);

/* Opens the user's scenes, or else the benchmark's, with the bench's seed and measures each. Skips
 * default files that were not fetched and prints a line for each. Returns bench->code. */
int bench_each(struct bench *bench, const struct benchmark *benchmark);

/* Writes pointers to the table members that the user named to `out`, or else to those named in
 * `own` (NULL-terminated). Returns their number. */
size_t bench_members(enum table table, const struct list *named, const char *const *own,
                     const void *out[LIST_MOST]);

/* Writes the source of the trees as tables show it: "builder median, leaf 4" or "tree FILE".
 * Returns `text`. */
const char *bench_tree_name(const struct bench *bench, char text[BENCH_TREE_NAME]);

/* Writes the engine's name as tables show it: of one from outside, without the folders of its file,
 * which would take the room. Returns `text`. */
const char *bench_engine_name(const struct engine *engine, char text[BENCH_ENGINE_NAME]);

/* Reads the user's tree of the scene. It must be JSON, since layouts are packed from it. *out is
 * zero if the user named none. Errors: STATUS_INPUT, STATUS_MEMORY. */
enum status bench_tree_open(const struct bench *bench, const struct scene *scene,
                            struct tree_file *out, struct reason *reason) MUST_USE;

/* Makes the scene's tree: a copy of the user's, or a new one by the default builder. Errors: as
 * bench_tree_open, and those of builders. */
enum status bench_tree_make(const struct bench *bench, const struct scene *scene, struct bvh *out,
                            struct reason *reason) MUST_USE;

/* As bench_each, on one thread unless the user named a number; prints how times are taken first. */
int bench_on_core(struct bench *bench, const struct benchmark *benchmark);

/* Rays per trace: the user's number, or the benchmark's own. */
size_t bench_rays_count(const struct bench *bench, size_t own);

/* Writes `row` to the CSV and adds it to the JSON rows. `row` is a flat object of named texts,
 * numbers and nulls. Before a benchmark's first row its names are written as the CSV header, so all
 * rows of a benchmark have the same names in the same order. Takes ownership of `row`; NULL (no
 * memory) is skipped. */
void bench_row(struct bench *bench, const struct benchmark *benchmark, json_t *row);

#endif
