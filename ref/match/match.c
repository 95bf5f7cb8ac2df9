#include "ref/match/match.h"

#include "ref/match/match_engine.h"
#include "ref/match/match_judge.h"
#include "ref/match/match_lists.h"
#include "ref/oracle/oracle_world.h"
#include "ref/match/match_trees.h"
#include "ref/base/base.h"
#include "ref/store.h"

#include <stdlib.h>
#include <string.h>

/* Below one hit in this many rays (and always without a hit) a row proves nothing. */
#define VACUOUS_ONE_IN 1000
/* Ray-triangle tests of engine brute for the rays that it traces again. */
#define BRUTE_AGAIN 10000000u

/* How many rays brute force decides, by the options. */
static size_t brute_share(const struct match *match)
{
    uint64_t tris = match_tri_count(match), per_ray = tris ? tris : 1;
    uint64_t affordable = match->options.brute_budget / per_ray;
    if (match->options.brute_rays && affordable > match->options.brute_rays)
        affordable = match->options.brute_rays;
    return affordable < match->ray_count ? (size_t)affordable : match->ray_count;
}

/* True if two answers of the oracle to one ray agree. Enclosures may differ, but hold the same
 * t. */
static bool same_truth(const struct oracle_answer *a, const struct oracle_answer *b)
{
    return a->prim == b->prim && a->tie_count == b->tie_count && a->class == b->class &&
           (a->prim == ABI_NO_PRIM || (a->t_lo <= b->t_hi && b->t_lo <= a->t_hi));
}

static enum status decide(struct match *match, enum oracle_path path, size_t count,
                          struct oracle_answer *out, struct reason *reason)
{
    if (match->world)
        return oracle_closest_world(match->oracle, path, ORACLE_CLOSED, match->ray, match->mode,
                                    count, 0, out, &match->work, reason);
    return oracle_closest(match->oracle, path, ORACLE_CLOSED, match->ray, count, 0, out,
                          &match->work, reason);
}

/* Decides all rays by the oracle's tree and the first ones by brute force too. */
static enum status truth_make(struct match *match, struct reason *reason)
{
    enum status status = match->world ? oracle_make_world(match->world, &match->oracle, reason)
                                      : oracle_make(match->scene, &match->oracle, reason);
    match->brute_count = brute_share(match);
    struct oracle_answer *brute = alloc_zeroed(match->brute_count, sizeof *brute);
    if (status == STATUS_OK && !brute)
        status = fail(reason, STATUS_MEMORY, "no memory for %zu rays", match->ray_count);
    if (status == STATUS_OK)
        status = decide(match, ORACLE_TREE, match->ray_count, match->truth, reason);
    if (status == STATUS_OK)
        status = decide(match, ORACLE_BRUTE, match->brute_count, brute, reason);
    for (size_t i = 0; i < match->brute_count && status == STATUS_OK; i++)
        if (!same_truth(&brute[i], &match->truth[i]))
            status =
                fail(reason, STATUS_INTERNAL,
                     "oracle: ray %zu: brute force says triangle %u of %u at t %.17g, the tree "
                     "%u of %u at %.17g",
                     i, (unsigned)brute[i].prim, (unsigned)brute[i].tie_count, brute[i].t_lo,
                     (unsigned)match->truth[i].prim, (unsigned)match->truth[i].tie_count,
                     match->truth[i].t_lo);
    free(brute);
    return status;
}

static bool make_room(struct match *match)
{
    size_t count = match->ray_count, tags = match->world ? count : 0;
    match->truth = alloc_zeroed(count, sizeof *match->truth);
    match->answer = alloc_zeroed(count, sizeof *match->answer);
    match->again = alloc_zeroed(count, sizeof *match->again);
    match->answer_tag = alloc_zeroed(tags, sizeof *match->answer_tag);
    match->again_tag = alloc_zeroed(tags, sizeof *match->again_tag);
    match->unstable = alloc_zeroed(count, 1);
    match->closest.hit = alloc_zeroed(count, sizeof *match->closest.hit);
    match->closest.tag = alloc_zeroed(tags, sizeof *match->closest.tag);
    return match->truth && match->answer && match->again && match->answer_tag && match->again_tag &&
           match->unstable && match->closest.hit && match->closest.tag;
}

/* What is known of *out by now is what match_make and match_make_world were given. */
static enum status make(struct match *out, struct reason *reason)
{
    const struct match_options options = out->options;
    enum status status = match_rebuild(out, options.builder, &options.build, options.tri, reason);
    if (status == STATUS_OK && !make_room(out))
        status = fail(reason, STATUS_MEMORY, "no memory for %zu rays", out->ray_count);
    if (status == STATUS_OK)
        status = truth_make(out, reason);
    if (status)
        match_free(out);
    return status;
}

enum status match_make(const struct scene *scene, const struct ray *ray, size_t ray_count,
                       const struct match_options *options, struct pool *pool, struct match *out,
                       struct reason *reason)
{
    *out = (struct match){
        .options = *options, .scene = scene, .ray = ray, .ray_count = ray_count, .pool = pool};
    return make(out, reason);
}

enum status match_make_world(const struct world *world, const struct ray *ray,
                             const struct ray_mode *mode, size_t ray_count,
                             const struct match_options *options, struct pool *pool,
                             struct match *out, struct reason *reason)
{
    *out = (struct match){.options = *options,
                          .world = world,
                          .mode = mode,
                          .ray = ray,
                          .ray_count = ray_count,
                          .pool = pool};
    return make(out, reason);
}

void match_free(struct match *match)
{
    match_unpack(match);
    bvh_free(&match->bvh);
    world_trees_free(&match->trees);
    oracle_free(match->oracle);
    free(match->truth);
    free(match->answer);
    free(match->again);
    free(match->answer_tag);
    free(match->again_tag);
    free(match->unstable);
    free(match->closest.hit);
    free(match->closest.tag);
    *match = (struct match){0};
}

void match_set(struct match *match, const struct box_test *box, enum query query)
{
    match->options.box = box;
    match->options.query = query;
    match_forget_against(match);
}

void match_refused(const struct match *match, const struct layout *layout,
                   const struct engine *engine, enum status cause, const struct reason *reason,
                   struct row *row)
{
    *row = (struct row){.options = match->options,
                        .stats = match->stats,
                        .engine = engine,
                        .layout = layout,
                        .status = ROW_REFUSED,
                        .cause = cause,
                        .reason = *reason};
}

/* Traces again and marks rays whose answer differs in a bit. */
static enum status trace_again(struct match *match, const struct engine *engine, void *self,
                               size_t count, struct trace_report *report, struct row *row)
{
    *report = (struct trace_report){0};
    enum status status = match_trace(match, engine, self, count, match->again, match->again_tag,
                                     report, &row->reason);
    for (size_t i = 0; i < count && status == STATUS_OK; i++)
        match->unstable[i] |=
            !match_same_bits(match->answer, match->again, match->world ? match->answer_tag : NULL,
                             match->again_tag, i);
    return status;
}

/* Takes what the engine holds, and of one without a layout what it tells of its tree. */
static void take_bytes(struct row *row, const struct trace_report *report)
{
    if (report->memory_bytes > row->memory_bytes)
        row->memory_bytes = report->memory_bytes;
    if (row->layout)
        return;
    row->node_bytes = report->node_bytes;
    row->scene_bytes = report->scene_bytes;
}

/* Traces `repeats` times, at least twice; times and work go to the row, the hits of the first to
 * match->answer. Brute force takes minutes for 100,000 rays on 70,000 triangles, in a time per ray
 * that is known: it answers as many rays as the budget pays for, is timed once, and traces few
 * again. */
static enum status timed_traces(struct match *match, const struct engine *engine, void *self,
                                struct row *row)
{
    double speed[REPEAT_MOST];
    unsigned repeats = engine->brute ? 1 : match->options.repeats;
    uint64_t tris = match_tri_count(match), per_ray = tris ? tris : 1;
    memset(match->unstable, 0, match->ray_count);
    for (unsigned i = 0; i < repeats; i++) {
        struct trace_report report = {0};
        enum status status = i ? trace_again(match, engine, self, row->rays, &report, row)
                               : match_trace(match, engine, self, row->rays, match->answer,
                                             match->answer_tag, &report, &row->reason);
        if (status)
            return status;
        speed[i] = 1e3 * (double)row->rays / (double)(report.ns ? report.ns : 1);
        row->boxes = report.boxes;
        row->tris = report.tris;
        row->device_clock = report.device_clock;
        take_bytes(row, &report);
    }
    sort_doubles(speed, repeats);
    row->mrays[0] =
        repeats % 2 ? speed[repeats / 2] : 0.5 * (speed[repeats / 2 - 1] + speed[repeats / 2]);
    row->mrays[1] = speed[0];
    row->mrays[2] = speed[repeats - 1];
    if (repeats > 1)
        return STATUS_OK;
    size_t few = (size_t)(BRUTE_AGAIN / per_ray) + 1;
    struct trace_report untimed;
    return trace_again(match, engine, self, engine->brute && few < row->rays ? few : row->rays,
                       &untimed, row);
}

/* Opens the engine that a row is compared with and prepares it for the match. */
static enum status prepare_against(const struct match *match, const struct engine *engine,
                                   void **self, struct reason *reason)
{
    enum status status = STATUS_OK;
    *self = pool_get(match->pool, engine, &status, reason);
    return status ? status : match_prepare(match, engine, *self, reason);
}

/* Fills match->against for a row. A row of brute force may have fewer rays than others. */
static enum status against_hits(struct match *match, struct row *row)
{
    const struct engine *engine = row->against;
    const size_t count = match->ray_count;
    if (match->against.engine == engine)
        return STATUS_OK;
    void *self;
    struct trace_report report;
    match_forget_against(match);
    match->against.hit = alloc_zeroed(count, sizeof *match->against.hit);
    match->against.tag = alloc_zeroed(match->world ? count : 0, sizeof *match->against.tag);
    enum status status = STATUS_OK;
    if (!match->against.hit || !match->against.tag)
        status = fail(&row->reason, STATUS_MEMORY, "no memory for %zu rays", count);
    if (status == STATUS_OK)
        status = prepare_against(match, engine, &self, &row->reason);
    if (status == STATUS_OK)
        status = match_trace(match, engine, self, engine->brute ? row->rays : count,
                             match->against.hit, match->against.tag, &report, &row->reason);
    if (status)
        match_forget_against(match);
    else
        match->against.engine = engine;
    return status;
}

/* Keeps closest hits for the any-hits that may follow. */
static void keep_closest(struct match *match, const struct engine *engine, size_t count)
{
    if (match->options.query != QUERY_CLOSEST)
        return;
    memcpy(match->closest.hit, match->answer, count * sizeof *match->answer);
    if (match->world)
        memcpy(match->closest.tag, match->answer_tag, count * sizeof *match->answer_tag);
    match->closest.count = count;
    match->closest.engine = engine;
    match->closest.box = match->options.box;
}

/* A row is judged only if no member in it is as published: RTRS's parts are known to be wrong, so
 * their wrong answers are only counted. */
static bool is_judged(const struct match *match, const struct engine *engine)
{
    if (!engine->needs_packed)
        return true;
    const struct match_options *o = &match->options;
    return !match_layout(match)->faithful && !o->builder->faithful && !o->box->faithful &&
           !(o->top_layout && o->top_layout->faithful) &&
           !(o->top_builder && o->top_builder->faithful);
}

/* Lists all hits and judges them, beside those of the engine that they are compared with. */
static enum status run_lists(struct match *match, const struct engine *engine, void *self,
                             const struct model *model, struct row *row)
{
    enum status status = STATUS_OK;
    void *beside = NULL;
    if (row->against && engine != row->against)
        status = prepare_against(match, row->against, &beside, &row->reason);
    if (status == STATUS_OK)
        status = match_lists(match, engine, self, beside, model, row);
    return status;
}

/* Traces and judges on an engine that is prepared. */
static enum status play_row(struct match *match, const struct engine *engine, void *self,
                            struct row *row)
{
    struct model model = match_model(match, engine, self, row);
    row->judged = is_judged(match, engine);
    if (engine->compiled) {
        row->compiled = *engine->compiled;
        row->against = engine->compiled->raw;
        row->bits = engine->compiled->equal;
    } else if (engine->plain && match->options.query != QUERY_ALL) {
        row->against = engine->plain;
        row->bits = engine->plain_bits;
    } else if (row->bits || (engine->foreign_bits && match->options.query != QUERY_ALL)) {
        row->against = engine_reference(true);
    }
    struct trace_report own = {0};
    if (engine->own_tree &&
        engine->trace(self, match->ray, 0, NULL, &own, &row->reason) == STATUS_OK) {
        row->node_bytes = own.node_bytes;
        row->item_bytes = own.item_bytes;
    }
    if (match->options.query == QUERY_ALL && match->scene && !engine->gpu &&
        engine->trace(self, match->ray, 0, NULL, &own, &row->reason) == STATUS_OK)
        take_bytes(row, &own); /* lists come without a report */
    if (match->options.query == QUERY_ALL)
        return run_lists(match, engine, self, &model, row);
    enum status status = timed_traces(match, engine, self, row);
    if (status == STATUS_OK && row->against)
        status = against_hits(match, row);
    if (status == STATUS_OK)
        status = match_judge(match, &model, row);
    if (status == STATUS_OK)
        status = match_again(match, engine, row);
    return status;
}

static enum status run_and_judge(struct match *match, const struct engine *engine, struct row *row)
{
    enum status status = STATUS_OK;
    void *self = pool_get(match->pool, engine, &status, &row->reason);
    if (status) {
        row->status = status == STATUS_UNSUPPORTED ? ROW_SKIPPED : ROW_FAILED;
        row->absent = row->status == ROW_SKIPPED;
        return status;
    }
    if (engine->needs_packed && !match_layout(match)) {
        row->status = ROW_FAILED;
        return fail(&row->reason, STATUS_INPUT, "engine %s needs a packed layout", engine->name);
    }
    row->life.updated = row->life.fate == LIFE_REFITTED &&
                        (match->world ? engine_moves_worlds(engine) : engine_moves(engine, self));
    status = match_prepare(match, engine, self, &row->reason);
    if (status == STATUS_LIMIT || status == STATUS_UNSUPPORTED) {
        row->status = status == STATUS_LIMIT ? ROW_REFUSED : ROW_SKIPPED;
        row->declined = row->status == ROW_REFUSED;
        row->absent = (match->world && !engine_traces_worlds(engine, self)) ||
                      (engine->compiled && engine->compiled->words == 0);
        return status;
    }
    if (status == STATUS_OK)
        status = play_row(match, engine, self, row);
    row->declined = status == STATUS_REFUSED;
    row->status = row->declined ? ROW_REFUSED : status ? ROW_FAILED : ROW_OK;
    if (status == STATUS_OK)
        keep_closest(match, engine, row->rays);
    return status;
}

void match_run(struct match *match, const struct engine *engine, struct row *row)
{
    *row = (struct row){.options = match->options,
                        .stats = match->stats,
                        .refit = match->refit,
                        .engine = engine,
                        .of_world = match->world != NULL,
                        .rays = match->ray_count};
    if (engine->needs_packed) {
        row->layout = match_layout(match);
        match_row_bytes(match, row);
    }
    if (engine->brute && match->brute_count > 0)
        row->rays = match->brute_count;
    match_row_life(match, engine, row);
    row->cause = run_and_judge(match, engine, row);
    size_t floor = row->rays / VACUOUS_ONE_IN;
    if (match->options.life && match->options.life->count > 0)
        return; /* a step may leave nothing to hit */
    /* What is already shown to be at fault is not vacuous. */
    if (row->status == ROW_OK && row->judged && row->differences == 0 &&
        row->hits < (floor ? floor : 1)) {
        row->status = ROW_VACUOUS;
        fail(&row->reason, STATUS_OK, "vacuous: %zu hits of %zu rays prove nothing", row->hits,
             row->rays);
    }
}
