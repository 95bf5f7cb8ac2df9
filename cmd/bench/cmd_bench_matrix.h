/* The matrix of builders, layouts, triangle storages and engines: contestants and their
 * measurements. For commands only. */
#ifndef CMD_BENCH_MATRIX_H
#define CMD_BENCH_MATRIX_H

#include "cmd/bench/cmd_bench_known.h"
#include "bench/measure/error_measure.h"
#include "bench/measure/leak_rays.h"
#include "bench/measure/touch.h"

enum matrix_kind { KIND_PRIM, KIND_RAND, KIND_DIFF, KIND_O_SHAD, KIND_O_RAND, MATRIX_KINDS };

#define MATRIX_CLOSEST 3 /* the first kinds trace closest hits, the others any hits */
#define MATRIX_MEAN    4 /* the mean is of the first four kinds */
#define MATRIX_TREES   8
#define MATRIX_NAME    72

extern const char *const matrix_kinds[MATRIX_KINDS];

/* A contestant. */
struct matrix_entry {
    char name[MATRIX_NAME];
    const struct engine *engine;
    const struct layout *layout;   /* NULL: uses no tree */
    const struct tri_store *store; /* NULL likewise */
    const struct builder *builder; /* NULL likewise */
    uint32_t passes;               /* passes of reinsertion */
    bool compact, avx512;          /* modes of Embree */
};

struct matrix_entries {
    struct matrix_entry entry[CONTESTANTS];
    size_t count;
};

/* Bytes of 64-byte cache lines per ray: all that were looked up, and those not found up to each
 * cache level. */
struct matrix_touch {
    double looked, beyond[CACHE_SIM_LEVELS];
};

/* Measurements of a contestant. */
struct matrix_row {
    const struct matrix_entry *entry;
    unsigned threads;
    size_t rays; /* of each kind */
    struct spread mrays[MATRIX_KINDS], ratio[MATRIX_KINDS];
    struct spread warm[MATRIX_KINDS]; /* ratios of warm speeds (see race_run); not of a GPU */
    double mean, mean_warm;           /* geometric means of the ratios */
    bool told; /* by a tracer from outside, of the next four: 0 is not known */
    uint64_t node_bytes, item_bytes, scene_bytes; /* read by the traversal */
    uint64_t held_bytes;                          /* as the engine reports */
    size_t asked, lost, wrong;                    /* prim and rand rays, judged by the oracle */
    size_t leak_rays, leaks;                      /* 0 rays: the mesh is not closed */
    bool judged;                    /* false: a member as published; verdicts are only counted */
    struct known_verdicts verdicts; /* of prim, rand and leak rays, and of any hits */
    bool judged_any;                /* the verdicts on any hits are among them */
    struct known_verdicts timed;    /* of them, on what was answered when it was timed */
    bool touched;                   /* false: what it reads is unknown */
    struct matrix_touch touch[MATRIX_CLOSEST];
    bool on_front;
    const char *worth; /* why it is worth using, or NULL */
};

struct matrix_tree {
    const struct builder *builder;
    uint32_t passes, leaf;
    struct bvh bvh;
};

/* One scene. */
struct matrix {
    struct bench *bench;
    const char *spec;
    const struct scene *scene;
    struct oracle *oracle;
    struct matrix_entries entries;
    struct matrix_tree tree[MATRIX_TREES];
    size_t tree_count;
    size_t count; /* rays of each kind */
    struct ray *ray[MATRIX_KINDS];
    struct ray *few;
    struct hit *hit;
    struct known_rays sample, leak; /* leak.count 0: not closed; all leak rays must hit */
    struct known_rays any;          /* o-shad and o-rand rays */
    struct matrix_row *row;         /* for the current number of threads */
    size_t row_count;
    struct race race;
};

/* Makes the list of contestants: the benchmark's own if the user named no engine, layout and
 * storage. Else it begins with Embree, unless the user named only GPU engines. Then come each
 * engine (by default cpu) with each layout on builder sah_binned. Engine fast has its own layout,
 * and a GPU engine begins with layout f32. If no layout was named, these are all but RTRS's, or
 * with --store only f32. Errors: STATUS_LIMIT too many; STATUS_INPUT a brute-force engine, or
 * --store with only an engine that stores triangles its own way. */
enum status matrix_entries_make(const struct bench *bench, struct matrix_entries *out,
                                struct reason *reason) MUST_USE;

/* True if the user named only engines of the GPU. */
bool matrix_is_gpu(const struct bench *bench);

/* True for an engine of the GPU. Its speed is compared with layout f32 of the same engine, not with
 * Embree. */
bool matrix_entry_is_gpu(const struct matrix_entry *entry);

/* True for an engine that collapses the tree into nodes and triangles of its own, whatever its
 * layout and storage: fast. */
bool matrix_collapses(const struct engine *engine);

/* Makes the rays whose exact answers are known. Errors: STATUS_MEMORY. */
enum status matrix_known_make(struct matrix *matrix, struct reason *reason) MUST_USE;

/* Measures everything but the speed of a contestant that is prepared for closest hits: bytes,
 * errors, leaks, cache lines. Errors: those of engine.trace; STATUS_MEMORY. */
enum status matrix_measure(struct matrix *matrix, const struct contestant *c,
                           struct matrix_row *row, struct reason *reason) MUST_USE;

/* Judges any hits of a contestant that is prepared for them, unless the row has these verdicts.
 * Errors: those of engine.trace; STATUS_MEMORY. */
enum status matrix_judge_any(struct matrix *matrix, const struct contestant *c,
                             struct matrix_row *row, struct reason *reason) MUST_USE;

/* Judges what a contestant answered when it was timed, of the rays of that kind whose exact answers
 * are known; of KIND_DIFF there are none, and one with `few` has other rays. Errors:
 * STATUS_MEMORY. */
enum status matrix_judge_timed(struct matrix *matrix, enum matrix_kind kind,
                               const struct contestant *c, struct matrix_row *row,
                               struct reason *reason) MUST_USE;

/* Takes these verdicts off the row's, for other times. */
void matrix_forget_timed(struct matrix_row *row);

/* Marks the rows that are on the front and worth using, prints the tables and adds the rows. With
 * `full`, also prints the table of sizes, which do not depend on threads. */
void matrix_print(struct matrix *matrix, bool full);

/* Writes a plot of the rows: benchmark matrix, the first number of threads of each scene. Errors:
 * STATUS_INPUT cannot write there, or nothing to plot; STATUS_MEMORY. */
enum status matrix_plot(const char *path, const json_t *rows, struct reason *reason) MUST_USE;

#endif
