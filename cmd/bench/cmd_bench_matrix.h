/* The matrix of builders, layouts, triangle storages and engines: what one contestant is, and what
 * was measured of it. For commands only. */
#ifndef CMD_BENCH_MATRIX_H
#define CMD_BENCH_MATRIX_H

#include "cmd/bench/cmd_bench_known.h"
#include "bench/measure/error_measure.h"
#include "bench/measure/leak_rays.h"
#include "bench/measure/touch.h"

enum matrix_kind { KIND_PRIM, KIND_RAND, KIND_DIFF, KIND_O_SHAD, KIND_O_RAND, MATRIX_KINDS };

#define MATRIX_CLOSEST 3 /* the first kinds ask for the closest hit, the others for any */
#define MATRIX_MEAN    4 /* and the mean is of the first four */
#define MATRIX_TREES   8
#define MATRIX_NAME    72

extern const char *const matrix_kinds[MATRIX_KINDS];

/* A contestant. */
struct matrix_entry {
    char name[MATRIX_NAME];
    const struct engine *engine;
    const struct layout *layout;   /* NULL: takes no tree */
    const struct tri_store *store; /* NULL likewise */
    const struct builder *builder; /* NULL likewise */
    uint32_t passes;               /* of reinsertion */
    bool compact, avx512;          /* Embree's */
};

struct matrix_entries {
    struct matrix_entry entry[CONTESTANTS];
    size_t count;
};

/* Bytes of 64-byte lines per ray: looked for, and from beyond each level of the cache. */
struct matrix_touch {
    double looked, beyond[CACHE_SIM_LEVELS];
};

/* What was measured. */
struct matrix_row {
    const struct matrix_entry *entry;
    unsigned threads;
    size_t rays; /* of each kind */
    struct spread mrays[MATRIX_KINDS], ratio[MATRIX_KINDS];
    double mean;                                  /* geometric, of the ratios */
    uint64_t node_bytes, item_bytes, scene_bytes; /* read by the traversal */
    uint64_t held_bytes;                          /* as the engine reports */
    size_t asked, lost, wrong;                    /* prim and rand rays, against the oracle */
    size_t leak_rays, leaks;                      /* 0 rays: the mesh is not closed */
    bool touched;                                 /* false: what it reads is not known */
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
    struct known_rays sample, leak; /* leak.count 0: not closed; its answers are all hits */
    struct matrix_row *row;         /* of one number of threads */
    size_t row_count;
    struct race race;
};

/* The contestants: the benchmark's own, or what the user named: Embree or the layout f32, then each
 * engine with each layout (engine fast has its own) on builder sah_binned. A user's engine that
 * needs layouts when none was named takes all that lose nothing. Errors: STATUS_LIMIT. */
enum status matrix_entries_make(const struct bench *bench, struct matrix_entries *out,
                                struct reason *reason) MUST_USE;

/* True if the user named only engines of the GPU. */
bool matrix_is_gpu(const struct bench *bench);

/* True if its speed is compared with the layout f32 of the same engine, not with Embree. */
bool matrix_entry_is_gpu(const struct matrix_entry *entry);

/* Makes the rays whose exact answers are known. Errors: STATUS_MEMORY. */
enum status matrix_known_make(struct matrix *matrix, struct reason *reason) MUST_USE;

/* Measures of a contestant that is prepared for closest hits what is not speed: bytes, errors,
 * leaks, lines. Errors: those of engine.trace; STATUS_MEMORY. */
enum status matrix_measure(struct matrix *matrix, const struct contestant *c,
                           struct matrix_row *row, struct reason *reason) MUST_USE;

/* Marks what is on the front and worth using, prints the tables and hands out rows. With `full`
 * also the table of sizes, which do not depend on threads. */
void matrix_print(struct matrix *matrix, bool full);

/* A figure of the rows: benchmark matrix, the first number of threads of each scene. Errors:
 * STATUS_INPUT cannot write there, STATUS_MEMORY. */
enum status matrix_plot(const char *path, const json_t *rows, struct reason *reason) MUST_USE;

#endif
