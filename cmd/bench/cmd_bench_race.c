#include "cmd/bench/cmd_bench_race.h"

#include "bench/frames/turns.h"
#include "cmd/common/cmd_use.h"
#include "cmd/common/cmd_screen.h"
#include "ref/base/command.h"
#include "ref/store.h"

#include <stdlib.h>
#include <string.h>

static struct job job_of(const struct race *race, const struct contestant *c, enum query query)
{
    return (struct job){.scene = race->scene,
                        .packed = c->layout ? &c->packed : NULL,
                        .box = c->box,
                        .tri = c->tri,
                        .query = query};
}

static enum status prepare(const struct race *race, const struct contestant *c, enum query query,
                           struct reason *reason)
{
    if (race->world) {
        const struct world_job job = {.world = race->world,
                                      .packed = c->engine->needs_packed ? race->packed_world : NULL,
                                      .box = c->box,
                                      .tri = c->tri,
                                      .query = query,
                                      .bare = true};
        return c->engine->worlds->prepare_world(c->self, &job, reason);
    }
    struct job job = job_of(race, c, query);
    return c->engine->prepare(c->self, &job, reason);
}

enum status race_trace(const struct race *race, const struct contestant *who, const struct ray *ray,
                       size_t count, struct hit *hit, struct trace_report *report,
                       struct reason *reason)
{
    if (race->world)
        return who->engine->worlds->trace_world(who->self, ray, NULL, count, hit, race->tag, report,
                                                reason);
    return who->engine->trace(who->self, ray, count, hit, report, reason);
}

enum status race_add(struct race *race, const struct contestant *who,
                     const struct engine_options *options, struct reason *reason)
{
    if (race->count == CONTESTANTS)
        return fail(reason, STATUS_LIMIT, "more than %d contestants", CONTESTANTS);
    struct contestant *c = &race->contestant[race->count];
    *c = *who;
    c->bvh = who->bvh ? who->bvh : race->bvh;
    enum status status = STATUS_OK;
    if (race->world && !c->engine->worlds)
        status = fail(reason, STATUS_UNSUPPORTED, "%s traces scenes, not worlds", c->engine->name);
    if (!status && c->layout)
        status = packed_make_stored(c->layout, c->store ? c->store : tri_stores[0], c->bvh,
                                    race->scene, &c->packed, reason);
    if (status == STATUS_OK)
        status = engine_open(c->engine, options, &c->self, reason);
    if (status == STATUS_OK) {
        status = prepare(race, c, QUERY_CLOSEST, reason);
        if (status)
            c->engine->close(c->self);
    }
    if (status)
        packed_free(&c->packed);
    else
        race->count++;
    return status;
}

enum status race_prepare(struct race *race, enum query query, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < race->count && !status; i++)
        status = prepare(race, &race->contestant[i], query, reason);
    return status;
}

/* True if member i takes part: it was named; or nothing was named and it is in `own`; or there is
 * no `own` and it is not left out by default. */
static bool wanted(const struct list *list, size_t i, const char *own, const char *name,
                   bool left_out)
{
    if (list->count > 0)
        return list_has(list, i);
    return own ? option_among(own, name) : !left_out;
}

static void enter_one(struct race *race, const struct engine *engine, const struct layout *layout,
                      const struct box_test *box, const struct tri_test *tri)
{
    struct bench *bench = race->bench;
    struct reason reason = {""};
    const struct contestant who = {.engine = engine, .layout = layout, .box = box, .tri = tri};
    enum status status = race_add(race, &who, &bench->engines, &reason);
    if (status == STATUS_OK)
        return;
    progress_end(&bench->progress);
    screen_line(4, "%-14s %-12s left out: %s\n", engine->name, layout ? layout->name : "-",
                reason.text);
    bool named = true;
    if (status == STATUS_LIMIT)
        named = layout && bench->layout.count;
    if (status == STATUS_UNSUPPORTED)
        named = bench->engine.count > 0;
    if (named)
        bench_worse(bench, exit_of_status(status));
}

/* Returns the first watertight box test for a watertight triangle test, else the first box test. */
static const struct box_test *box_for(const struct tri_test *tri)
{
    for (size_t b = 0; box_tests[b] && tri->watertight; b++)
        if (box_tests[b]->watertight)
            return box_tests[b];
    return box_tests[0];
}

static void enter_layouts(struct race *race, const struct engine *engine,
                          const struct tri_test *tri)
{
    const struct list *boxes = &race->bench->box;
    bool core = true; /* layouts_all begins with layouts */
    for (size_t l = 0; layouts_all[l]; l++) {
        core = core && layouts[l];
        for (size_t b = 0; b < (boxes->count ? boxes->count : 1); b++) {
            const struct box_test *box = boxes->count ? box_tests[boxes->index[b]] : box_for(tri);
            if (wanted(&race->bench->layout, l, race->own_layouts, layouts_all[l]->name,
                       !core || layouts_all[l]->faithful))
                enter_one(race, engine, layouts_all[l], box, tri);
        }
    }
}

void race_enter(struct race *race)
{
    for (size_t e = 0; engines[e]; e++) {
        bool entered = false;
        if (!wanted(&race->bench->engine, e, race->own_engines, engines[e]->name,
                    strstr(engines[e]->name, "brute") != NULL))
            continue;
        for (size_t t = 0; tri_tests[t]; t++) {
            bool take = wanted(&race->bench->tri, t, NULL, tri_tests[t]->name,
                               tri_tests[t]->faithful || !tri_tests[t]->core);
            if (!take || (entered && engines[e]->own_tri)) /* own formula: only once */
                continue;
            entered = true;
            if (engines[e]->needs_packed)
                enter_layouts(race, engines[e], tri_tests[t]);
            else
                enter_one(race, engines[e], NULL, box_tests[0], tri_tests[t]);
        }
    }
}

size_t race_missed(const struct race *race, size_t count, size_t i)
{
    size_t missed = 0;
    for (size_t n = 0; n < count; n++) {
        bool any = false;
        for (size_t k = 0; k < race->count; k++)
            any = any || race->contestant[k].answer[n].prim != ABI_NO_PRIM;
        missed += any && race->contestant[i].answer[n].prim == ABI_NO_PRIM;
    }
    return missed;
}

void race_leave(struct race *race)
{
    for (size_t i = 0; i < race->count; i++) {
        race->contestant[i].engine->close(race->contestant[i].self);
        packed_free(&race->contestant[i].packed);
        free(race->contestant[i].answer);
    }
    race->count = 0;
}

/* The same tests, by this engine on this layout. */
static bool is_alike(const struct contestant *b, const struct contestant *c,
                     const struct engine *engine, const struct layout *layout)
{
    return b->engine == engine && b->tri == c->tri && b->box == c->box && b->layout == layout;
}

/* Index of the contestant that contestant i is compared with: of compiled shaders the same with the
 * shaders as built; on a GPU the same engine and tests on the first layout; else Embree or, if that
 * does not run, as on a GPU; i itself if there is none. */
static size_t base_of(const struct race *race, size_t i)
{
    const struct contestant *c = &race->contestant[i];
    const struct engine_compiled *compiled = c->engine->compiled;
    const bool gpu = c->engine->gpu && c->layout;
    for (size_t k = 0; k < race->count && !compiled && !gpu; k++)
        if (race->contestant[k].engine->library)
            return k;
    for (size_t k = 0; k < race->count; k++)
        if (is_alike(&race->contestant[k], c, compiled ? compiled->raw : c->engine,
                     compiled ? c->layout : layouts[0]))
            return k;
    return i;
}

const char *race_base_name(const struct race *race, const struct contestant *contestant)
{
    const struct contestant *base = &race->contestant[contestant->base];
    return base->engine == contestant->engine && base->layout ? base->layout->name
                                                              : base->engine->name;
}

/* --- rounds ----------------------------------------------------------------------------------- */

/* The rays of a race, each array two times in a row, so that a trace may begin anywhere. */
struct laps {
    enum query query;
    struct ray *ray, *few;
    size_t count, few_count;
    struct hit *hit; /* of one trace */
    struct rng rng;
};

static struct ray *twice(const struct ray *ray, size_t count)
{
    struct ray *out = alloc_zeroed(2 * count, sizeof *out);
    if (out && count) {
        memcpy(out, ray, count * sizeof *out);
        memcpy(out + count, ray, count * sizeof *out);
    }
    return out;
}

static void laps_free(struct laps *laps)
{
    free(laps->ray);
    free(laps->few);
    free(laps->hit);
}

/* Room for answers of all contestants, none of which is known yet. */
static enum status laps_make(struct race *race, enum query query, const struct ray *ray,
                             size_t count, struct laps *out, struct reason *reason)
{
    *out = (struct laps){.query = query,
                         .ray = twice(ray, count),
                         .few = twice(race->few, race->few_count),
                         .count = count,
                         .few_count = race->few_count,
                         .hit = alloc_zeroed(count, sizeof *out->hit),
                         .rng = rng_make(race->bench->seed, count + 1)};
    bool room = out->ray && out->few && out->hit;
    for (size_t i = 0; i < race->count && room; i++) {
        struct contestant *c = &race->contestant[i];
        free(c->answer);
        c->answer = alloc_zeroed(count, sizeof *c->answer);
        c->answers = 0;
        room = c->answer != NULL;
    }
    return room ? STATUS_OK : fail(reason, STATUS_MEMORY, "no memory for %zu rays", count);
}

static bool same_answer(enum query query, const struct hit *a, const struct hit *b)
{
    const bool miss = a->prim == ABI_NO_PRIM;
    if (miss || query == QUERY_ANY)
        return miss == (b->prim == ABI_NO_PRIM);
    return memcmp(a, b, sizeof *a) == 0;
}

/* Takes the answers of a trace that began at ray `first`; later ones are to be the same. */
static enum status take_answers(struct contestant *c, const struct laps *laps, size_t count,
                                size_t first, struct reason *reason)
{
    for (size_t i = 0; i < count; i++) {
        const size_t ray = (first + i) % count;
        if (c->answers == 0)
            c->answer[ray] = laps->hit[i];
        else if (!same_answer(laps->query, &c->answer[ray], &laps->hit[i]))
            return fail(reason, STATUS_DEVICE,
                        "%.80s: its answer to ray %zu is another one from trace to trace",
                        c->engine->name, ray);
    }
    c->answers = count;
    return STATUS_OK;
}

/* Traces once. *mrays: million rays a second. */
static enum status time_once(const struct race *race, struct contestant *c, struct laps *laps,
                             double *mrays, struct reason *reason)
{
    struct trace_report report = {0};
    const size_t rays = c->few ? laps->few_count : laps->count;
    const size_t packets = rays % RACE_PACKET ? 0 : rays / RACE_PACKET;
    const size_t first = packets ? RACE_PACKET * rng_below(&laps->rng, (uint32_t)packets) : 0;
    const struct ray *ray = (c->few ? laps->few : laps->ray) + first;
    const uint64_t start = core_time_ns();
    enum status status = race_trace(race, c, ray, rays, laps->hit, &report, reason);
    const uint64_t ns = !race->core_time ? report.ns
                        : report.core_ns ? report.core_ns /* without conversions */
                                         : core_time_ns() - start;
    c->boxes = report.boxes;
    c->tris = report.tris;
    c->node_bytes = report.node_bytes;
    c->scene_bytes = report.scene_bytes;
    if (report.memory_bytes > c->memory_bytes)
        c->memory_bytes = report.memory_bytes;
    *mrays = 1e3 * (double)rays / (double)(ns ? ns : 1);
    return status ? status : take_answers(c, laps, rays, first, reason);
}

/* The turn of a contestant in a round; of round 0 no speed is kept. */
static enum status play_turn(const struct race *race, struct contestant *c, size_t round,
                             struct laps *laps, struct reason *reason)
{
    double mrays, warm = 0;
    enum status status = time_once(race, c, laps, &mrays, reason);
    for (int i = 0; i < RACE_WARM && race->warm && round > 0 && !status; i++)
        status = time_once(race, c, laps, &warm, reason);
    if (round > 0) {
        c->mrays[round - 1] = mrays;
        c->warm[round - 1] = warm;
    }
    return status;
}

static void make_ratios(struct race *race)
{
    for (size_t i = 0; i < race->count; i++) {
        struct contestant *c = &race->contestant[i];
        c->base = base_of(race, i);
        const struct contestant *base = &race->contestant[c->base];
        for (size_t round = 0; round < race->bench->rounds; round++) {
            c->ratio[round] = c->mrays[round] / base->mrays[round];
            c->warm_ratio[round] = c->warm[round] / base->warm[round];
        }
    }
}

enum status race_run(struct race *race, enum query query, const struct ray *ray, size_t count,
                     struct reason *reason)
{
    struct bench *bench = race->bench;
    struct rng rng = rng_make(bench->seed, count);
    size_t order[CONTESTANTS];
    struct laps laps;
    enum status status = laps_make(race, query, ray, count, &laps, reason);
    turns_start(order, race->count);
    /* Round 0 is for warming up: pipelines, caches, page faults. */
    for (size_t round = 0; round <= bench->rounds && !status; round++) {
        turns_next(&rng, order, race->count);
        for (size_t i = 0; i < race->count && !status; i++) {
            progress_done(&bench->progress, round * race->count + i,
                          (bench->rounds + 1) * race->count, "these rounds");
            progress_step(&bench->progress, "%s, round %zu of %llu", race->label, round,
                          (unsigned long long)bench->rounds);
            status = play_turn(race, &race->contestant[order[i]], round, &laps, reason);
        }
    }
    laps_free(&laps);
    if (!status)
        make_ratios(race);
    return status;
}
