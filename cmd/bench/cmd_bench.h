/* What the benchmarks share. For commands only. */
#ifndef CMD_BENCH_H
#define CMD_BENCH_H

#include "bench/chart/spread.h"
#include "cmd/common/cmd_tree.h"
#include "ref/frame.h"
#include "ref/match/match.h"
#include "ref/files/file.h"

#include <jansson.h>

#define BENCH_SCENES    16
#define BENCH_ROUNDS    99
#define BENCH_TREE_NAME 120

/* Parts of benchmark.takes: options of processors and drivers, and of engines from outside. */
#define BENCH_MACHINE " threads driver device workgroup"
#define BENCH_OUTSIDE " peer-time peer-memory shader"

/* Settings of a run, and where its rows go. */
struct bench {
    const char *scene[BENCH_SCENES]; /* the user's, if any */
    size_t scene_count;
    uint64_t ray_count, rounds, seed;                  /* ray_count 0: the benchmark's own */
    struct list engine, layout, store, tri, box, rays; /* count 0: the benchmark's own */
    struct engine_options engines;
    struct progress progress;
    const char *csv_path, *json_path, *svg_path;
    struct {
        uint64_t frames; /* 0: the benchmark's own */
        uint64_t width, height;
        uint64_t turns, warm_up, bounces;
        enum profile profile;
        const char *out;                       /* base path of files; NULL: the benchmark's own */
        char csv[4096], json[4096], svg[4096]; /* of `out`, where rows go there */
    } picture;
    bool quick;
    const char *bvh;      /* of --bvh: a tree of the one scene; NULL: built */
    struct file_out csv;  /* stream NULL: none */
    const char *csv_head; /* benchmark whose column names were written last */
    json_t *rows;         /* for JSON and SVG; NULL: none */
    int code;             /* the worst exit code so far, see bench_worse */
};

/* Measures one scene. Errors: printed by bench_failed. */
typedef enum status bench_play(struct bench *bench, const char *spec, const struct scene *scene,
                               struct reason *reason);

/* A benchmark: plays scenes, or runs by itself. */
struct benchmark {
    const char *name;
    const char *summary;
    const char *takes;  /* the options that it uses, by name, blanks between */
    const char *about;  /* more than a line, for --help; or NULL */
    const char *scenes; /* where the user names none, ';' between */
    const char *made;   /* in place of them if none of their files was fetched; or NULL */
    bench_play *play;
    int (*run)(struct bench *bench); /* returns an exit code, or bench->code; NULL: bench_each */
    bool titled;                     /* its name is printed before the scenes */
    bool triangles;                  /* a scene without triangles is an error */
    bool alone;    /* takes minutes or writes files of its own: runs only if it is named */
    bool rows_out; /* --out BASE names its files of rows and its plot */
};

extern const struct benchmark bench_layouts, bench_error, bench_spawn, bench_builders, bench_oracle,
    bench_fuzz, bench_frames, bench_paper, bench_special, bench_fast, bench_matrix, bench_tightness;

/* Counts an exit code into bench->code; that of a signal counts only if nothing else was wrong. */
void bench_worse(struct bench *bench, int code);

/* Unless STATUS_OK: prints why on the standard error, "raydiff bench: SCENE: why", and counts the
 * exit code. The scene's name is left out if `spec` is NULL or the reason begins with it. */
void bench_failed(struct bench *bench, const char *spec, enum status status,
                  const struct reason *reason);

/* Opens the user's scenes with the bench's seed, or else those of the benchmark (files that were
 * not fetched are left out with a line), and plays each. Returns bench->code. */
int bench_each(struct bench *bench, const struct benchmark *benchmark);

/* The members of a table that the user named, or else those with the names `own` (NULL-terminated).
 * Returns how many pointers to members are in `out`. */
size_t bench_members(enum table table, const struct list *named, const char *const *own,
                     const void *out[LIST_MOST]);

/* What trees are made by, as tables name it: "builder median, leaf 4", or "tree FILE". */
const char *bench_tree_name(const struct bench *bench, char text[BENCH_TREE_NAME]);

/* Reads the user's tree of the scene, which must be JSON, since layouts are packed from it; *out is
 * zero where the user named none. Errors: STATUS_INPUT, STATUS_MEMORY. */
enum status bench_tree_open(const struct bench *bench, const struct scene *scene,
                            struct tree_file *out, struct reason *reason) MUST_USE;

/* The scene's tree: a copy of the user's, or what the default builder makes. Errors: as above, and
 * those of builders. */
enum status bench_tree_make(const struct bench *bench, const struct scene *scene, struct bvh *out,
                            struct reason *reason) MUST_USE;

/* Rays per trace: the user's, or the benchmark's own number. */
size_t bench_rays_count(const struct bench *bench, size_t own);

/* Adds a flat object of named texts, numbers and nulls as a row of the CSV (before the benchmark's
 * first row its names are written as the header) and of the JSON. Takes `row` over; NULL (no
 * memory) is left out. All rows of a benchmark have the same names in the same order. */
void bench_row(struct bench *bench, const struct benchmark *benchmark, json_t *row);

#endif
