/* A race: engines on layouts are prepared once and traced in turns, so that all run under the same
 * conditions. For commands only. */
#ifndef CMD_BENCH_RACE_H
#define CMD_BENCH_RACE_H

#include "cmd/bench/cmd_bench.h"

#define CONTESTANTS 96
#define RACE_WARM   3
#define RACE_PACKET 16 /* rays */

/* One engine with one layout and triangle test, prepared and kept while the others run. */
struct contestant {
    const struct engine *engine;
    const struct layout *layout; /* NULL: none needed */
    const struct tri_test *tri;
    const struct box_test *box;
    const struct tri_store *store; /* NULL: `indexed` */
    const struct bvh *bvh;         /* the tree of `packed`; NULL: the race's */
    bool few;                      /* too slow for all rays: traces race.few */
    struct packed packed;
    void *self;
    uint64_t memory_bytes;            /* 0: not known */
    uint64_t node_bytes, scene_bytes; /* as the engine reports them; 0: not known */
    uint64_t boxes, tris;             /* tests of one trace; 0: not counted */
    double mrays[BENCH_ROUNDS];
    double ratio[BENCH_ROUNDS]; /* relative to its base, per round */
    double warm[BENCH_ROUNDS];  /* the two again, of races with `warm` */
    double warm_ratio[BENCH_ROUNDS];
    size_t base;        /* index of the contestant it is compared with; its own index: none */
    struct hit *answer; /* to race_run's rays, or to race.few, when it was timed */
    size_t answers;     /* room for so many */
};

struct race {
    struct bench *bench;
    const char *label; /* scene and rays, for progress */
    const struct scene *scene;
    const struct bvh *bvh;
    /* Of a world, in place of scene and bvh: all contestants trace one packed world, and write tags
     * to `tag`, which has room for all rays. */
    const struct world *world;
    const struct packed_world *packed_world;
    uint32_t *tag;
    /* Default engines and layouts, such as "cpu embree"; NULL: see race_enter. */
    const char *own_engines, *own_layouts;
    bool core_time;        /* measures the calling thread's time, so that other work on the machine
                       matters little: only for engines that trace on that thread alone */
    bool warm;             /* measures each contestant also alone, see race_run */
    const struct ray *few; /* some of the rays, evenly spread, for contestants with `few` */
    size_t few_count;
    struct contestant contestant[CONTESTANTS];
    size_t count;
};

/* Enters the contestants: what the user named in `bench`, else own_engines and own_layouts. Where
 * these are NULL, enters every engine but brute force (its time depends on the triangle count) and
 * every layout of layouts[] but RTRS's (as published they test every node). The default triangle
 * tests are the core ones but RTRS's, each with the box test that suits it. Engines without a tree
 * have no layout. Engines with their own formula take part once. A contestant that cannot take part
 * is left out with a line. If the user named it, bench_worse counts it: 77 cannot run here, 2
 * cannot hold the scene. */
void race_enter(struct race *race);

/* Adds a copy of `who` (its engine, layout, box, tri, store, bvh and few are read), opens it with
 * `options` and prepares it for closest hits. Errors: STATUS_LIMIT more than CONTESTANTS, or as
 * packed_make; STATUS_UNSUPPORTED it traces no worlds; those of engine.open and .prepare. */
enum status race_add(struct race *race, const struct contestant *who,
                     const struct engine_options *options, struct reason *reason) MUST_USE;

/* Prepares all contestants for another query. Errors: those of engine.prepare. */
enum status race_prepare(struct race *race, enum query query, struct reason *reason) MUST_USE;

/* Traces `count` rays with all contestants, which are prepared for `query`: one round to warm up,
 * then the rounds of the bench. Fills in speeds and ratios. The base of vulkan is vulkan on f32;
 * that of the others is Embree or, without it, the same engine on f32. In a round each contestant
 * traces once, with the others' data in the caches. With `warm` it goes on: RACE_WARM traces
 * follow, and the last is its warm speed, as of a renderer that runs alone. Each trace begins at
 * another ray, by whole packets of 16, so that answers that were kept are of no use.
 * contestant.answer has what was answered when it was timed, the same every time. Errors: those of
 * engine.trace; STATUS_DEVICE the answers of a contestant change; STATUS_MEMORY. */
enum status race_run(struct race *race, enum query query, const struct ray *ray, size_t count,
                     struct reason *reason) MUST_USE;

/* Traces `count` rays with one contestant. Errors: those of engine.trace. */
enum status race_trace(const struct race *race, const struct contestant *who, const struct ray *ray,
                       size_t count, struct hit *hit, struct trace_report *report,
                       struct reason *reason) MUST_USE;

/* Number of rays that contestant i misses and another one hits, of what race_run traced. */
size_t race_missed(const struct race *race, size_t count, size_t i);

/* Closes all contestants. */
void race_leave(struct race *race);

/* Name of the ratio's base: a layout of the same engine ("f32"), or an engine ("embree"). */
const char *race_base_name(const struct race *race, const struct contestant *contestant);

#endif
