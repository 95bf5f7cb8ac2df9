/* A race: engines on layouts, prepared once and traced by turns, so that all of them meet the same
 * machine. For commands only. */
#ifndef CMD_BENCH_RACE_H
#define CMD_BENCH_RACE_H

#include "cmd/bench/cmd_bench.h"

#define CONTESTANTS 96

/* One engine with one layout and triangle test, prepared and kept while the others run. */
struct contestant {
    const struct engine *engine;
    const struct layout *layout; /* NULL: none needed */
    const struct tri_test *tri;
    const struct box_test *box;
    const struct tri_store *store; /* NULL: `indexed` */
    const struct bvh *bvh;         /* what `packed` is of; NULL: the race's */
    bool few;                      /* too slow for all rays: traces race.few */
    struct packed packed;
    void *self;
    uint64_t memory_bytes;
    uint64_t boxes, tris; /* tests of one trace; 0: not counted */
    double mrays[BENCH_ROUNDS];
    double ratio[BENCH_ROUNDS]; /* to its base, round by round */
    size_t base; /* index of the contestant that it is compared with; its own: none */
};

struct race {
    struct bench *bench;
    const char *label; /* scene and rays, for progress */
    const struct scene *scene;
    const struct bvh *bvh;
    /* Engines and layouts where the user named none, as "cpu embree"; NULL: see race_enter. */
    const char *own_engines, *own_layouts;
    bool core_time; /* speeds are by the time of the calling thread: for engines that trace on
                       it alone; other work on the machine counts little */
    const struct ray *few; /* some of the rays, evenly spread, for contestants that take few */
    size_t few_count;
    struct contestant contestant[CONTESTANTS];
    size_t count;
};

/* Who takes part in `bench`'s race: everything the user named, else every engine but brute force
 * (its time is the triangle count's), every layout and triangle test but RTRS's (as published
 * they test every node), and for each triangle test the box test that suits it. Engines without a
 * tree have no layout; those whose formula is their own take part once. Those that cannot take part
 * are left out with a line and, if the user named them, counted by bench_worse: 77 cannot run here,
 * 2 cannot hold the scene. */
void race_enter(struct race *race);

/* Adds a copy of `who` (its engine, layout, box, tri, store, bvh and few are read), opened with
 * `options` and prepared for closest hits. Errors: STATUS_LIMIT more than CONTESTANTS, or as
 * packed_make; those of engine.open and .prepare. */
enum status race_add(struct race *race, const struct contestant *who,
                     const struct engine_options *options, struct reason *reason) MUST_USE;

/* Prepares all for another query. Errors: those of engine.prepare. */
enum status race_prepare(struct race *race, enum query query, struct reason *reason) MUST_USE;

/* Traces `count` rays with all, a round to warm up and then the rounds of the bench; fills in
 * speeds and ratios. The base of vulkan is itself on f32, that of the others embree. `hit` is
 * scratch. Errors: those of engine.trace. */
enum status race_run(struct race *race, const struct ray *ray, size_t count, struct hit *hit,
                     struct reason *reason) MUST_USE;

/* Closes all. */
void race_leave(struct race *race);

/* "f32 of vulkan", "embree", ...: what ratios are to. */
const char *race_base_name(const struct race *race, const struct contestant *contestant);

#endif
