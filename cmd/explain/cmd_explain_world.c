#include "cmd/explain/cmd_explain_world.h"

#include "ref/base/command.h"
#include "ref/base/text.h"
#include "ref/store.h"
#include "ref/two_level/world_check.h"
#include "scenes/rays/world_rays.h"
#include "scenes/worlds.h"

#include <stdlib.h>

#define RAYS_OWN 5000

/* --- answers ---------------------------------------------------------------------------------- */

static enum status check_use(const struct explain_options *o, struct reason *reason)
{
    static const char *const scenes_only[] = {"ray",   "index", "cause", "bvh",
                                              "store", "html",  "svg"};
    for (size_t i = 0; i < ARRAY_COUNT(scenes_only); i++)
        if (option_was_given(scenes_only[i]))
            return fail(reason, STATUS_INPUT,
                        "--%s: %s is a world; it is for scenes (docs/worlds.md)", scenes_only[i],
                        o->of.spec);
    if (!o->of.engine->worlds)
        return fail(reason, STATUS_UNSUPPORTED, "%s traces scenes, not worlds", o->of.engine->name);
    return STATUS_OK;
}

static enum status pack(struct explain_world *e, struct packed_world *packed, struct reason *reason)
{
    const struct explain_of *of = &e->options->of;
    const struct world_build how = {.top = of->builder,
                                    .bottom = of->builder,
                                    .top_options = of->build,
                                    .bottom_options = of->build,
                                    .braid = e->options->braid};
    struct world_trees trees;
    enum status status = world_trees_make(e->world, &how, &trees, reason);
    if (status)
        return status;
    e->layout = of->layout;
    status = packed_world_make(e->world, &trees, e->layout, e->layout, of->store, packed, reason);
    if (status == STATUS_LIMIT && !option_was_given("layout")) {
        e->layout = layout_find(EXPLAIN_LARGE_LAYOUT);
        status =
            packed_world_make(e->world, &trees, e->layout, e->layout, of->store, packed, reason);
    }
    world_trees_free(&trees);
    if (!status && world_pack_check(e->world, packed, &e->faults, &e->tree_fault) == STATUS_MEMORY)
        status = fail(reason, STATUS_MEMORY, "no memory to check the trees");
    return status;
}

static enum status answer(struct explain_world *e, struct pool *pool, struct reason *reason)
{
    const struct explain_of *of = &e->options->of;
    struct packed_world packed = {.mesh_count = 0};
    struct world_job job = {.world = e->world, .box = of->box, .tri = of->tri, .query = of->query};
    struct trace_report report;
    enum status status = STATUS_OK;
    if (of->engine->needs_packed) {
        status = pack(e, &packed, reason);
        job.packed = &packed;
    }
    void *self = status ? NULL : pool_get(pool, of->engine, &status, reason);
    if (!status)
        status = of->engine->worlds->prepare_world(self, &job, reason);
    if (!status)
        status = of->engine->worlds->trace_world(self, e->ray, e->mode, e->count, e->hit, e->tag,
                                                 &report, reason);
    packed_world_free(&packed);
    return status;
}

/* --- judging ---------------------------------------------------------------------------------- */

static enum status judge_all(struct explain_world *e, const struct oracle *oracle,
                             const struct judge *judge, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < e->count && !status; i++) {
        struct oracle_answer truth;
        status = oracle_closest_world(oracle, ORACLE_AUTO, ORACLE_CLOSED, &e->ray[i], &e->mode[i],
                                      1, 1, &truth, NULL, reason);
        if (!status && judge_world_answer(judge, &e->ray[i], e->mode[i], &truth, &e->hit[i],
                                          e->tag[i], &e->judgement[i]))
            status = fail(reason, STATUS_MEMORY, "no memory to judge");
    }
    return status;
}

static enum status judge_and_explain(struct explain_world *e, struct pool *pool,
                                     struct reason *reason)
{
    const struct explain_of *of = &e->options->of;
    struct oracle *oracle = NULL;
    struct judge *judge = NULL;
    enum status status = oracle_make_world(e->world, &oracle, reason);
    void *self = status ? NULL : pool_get(pool, of->engine, &status, reason);
    if (!status) {
        const struct model model = engine_model(of->engine, self, of->tri);
        status = judge_make(oracle, &model, of->query, &judge, reason);
    }
    if (!status)
        status = judge_all(e, oracle, judge, reason);
    const struct world_evidence answers = {.world = e->world,
                                           .tri = of->tri,
                                           .query = of->query,
                                           .ray = e->ray,
                                           .mode = e->mode,
                                           .hit = e->hit,
                                           .tag = e->tag,
                                           .judgement = e->judgement,
                                           .count = e->count,
                                           .faults = &e->faults};
    if (!status)
        status = world_why(&answers, &e->why, reason);
    judge_free(judge);
    oracle_free(oracle);
    return status;
}

const char *explain_world_set(const struct explain_world *e)
{
    return e->options->has_file ? "its own" : e->options->rays->name;
}

const char *explain_world_modes(const struct explain_world *e)
{
    return e->options->has_file ? "its own" : ray_modes_name((enum ray_modes)e->options->modes);
}

/* --- the page --------------------------------------------------------------------------------- */

static void print_kinds(const struct explain_world *e, char *text, size_t bytes)
{
    const char *between = "";
    text[0] = 0;
    for (int w = 0; w < WRONG_COUNT; w++)
        if (e->why.kind[w]) {
            text_append(text, bytes, "%s%s %zu", between, wrong_name((enum wrong)w),
                        e->why.kind[w]);
            between = ", ";
        }
}

static void print_first(const struct explain_world *e, const struct screen *screen)
{
    const size_t i = e->why.first;
    char line[400];
    judge_line(&e->ray[i], &e->judgement[i], &e->hit[i], line, sizeof line);
    screen_text(screen, "the first, ray %zu, mask 0x%02x, flags 0x%03x: %s\n", i, e->mode[i].mask,
                e->mode[i].flags, line);
}

/* The attempts that give most of the WRONG answers. */
static void print_attempts(const struct explain_world *e)
{
    const struct world_why *why = &e->why;
    printf("  of %3u WRONG  of %3u others  cause           a tracer that\n", why->wrong_compared,
           why->other_compared);
    for (enum world_defect d = WORLD_DEFECT_NONE + 1; d < WORLD_DEFECT_COUNT; d++)
        if (2 * why->attempt[d].told_wrong >= why->wrong_compared)
            printf("  %12u  %13u  %-14s  %s%s\n", why->attempt[d].told_wrong,
                   why->attempt[d].told_other, world_cause_name(world_defect_about(d)->cause),
                   world_defect_about(d)->text, d == why->defect ? "  <" : "");
    if (why->defect == WORLD_DEFECT_NONE)
        printf("  %12u  %13s  %-14s  loses what lies at the rim of an instance's box\n",
               why->at_the_rim, "-", "world_box");
}

static void print_conclusion(const struct explain_world *e, const struct screen *screen)
{
    const struct world_why *why = &e->why;
    const char *cause = world_cause_name(why->cause);
    if (why->cause == WORLD_CAUSE_NONE) {
        screen_text(screen, "conclusion: no answer is wrong\n");
        return;
    }
    if (why->defect != WORLD_DEFECT_NONE)
        screen_text(screen, "cause  %s: it answers as a tracer that %s\n", cause,
                    world_defect_about(why->defect)->text);
    else if (e->tree_fault.text[0])
        screen_text(screen, "cause  %s: %s\n", cause, e->tree_fault.text);
    else if (why->cause == WORLD_CAUSE_BOX)
        screen_text(screen, "cause  %s: hits are lost at the rim of instances' boxes\n", cause);
    else
        screen_text(screen, "cause  %s: no defect that is tried gives these answers\n", cause);
    screen_text(screen, "conclusion: WRONG: %zu of %zu answers, by %s\n", why->wrong, e->count,
                cause);
}

static void print(const struct explain_world *e, const struct screen *screen)
{
    const struct explain_of *of = &e->options->of;
    char shown[WORLD_SHOWN], kinds[400];
    screen_text(screen, "%s: %s\n", of->spec, world_show(e->world, shown));
    print_kinds(e, kinds, sizeof kinds);
    screen_text(screen, "%s%s%s, query %s: %zu rays of set %s, modes %s: %zu WRONG%s%s\n",
                of->engine->name, e->layout ? " on " : "", e->layout ? e->layout->name : "",
                query_name(of->query), e->count, explain_world_set(e), explain_world_modes(e),
                e->why.wrong, kinds[0] ? ": " : "", kinds);
    if (e->why.wrong > 0) {
        print_first(e, screen);
        print_attempts(e);
    }
    print_conclusion(e, screen);
}

static enum status make_arrays(struct explain_world *e, const struct fuzz_trial *trial,
                               struct reason *reason)
{
    e->hit = alloc_zeroed(e->count, sizeof *e->hit);
    e->tag = alloc_zeroed(e->count, sizeof *e->tag);
    e->judgement = alloc_zeroed(e->count, sizeof *e->judgement);
    if (!e->hit || !e->tag || !e->judgement)
        return fail(reason, STATUS_MEMORY, "no memory for %zu answers", e->count);
    if (trial) {
        e->ray = alloc_copy(trial->ray, e->count, sizeof *e->ray);
        e->mode = alloc_copy(trial->world.mode, e->count, sizeof *e->mode);
        return e->ray && e->mode ? STATUS_OK
                                 : fail(reason, STATUS_MEMORY, "no memory for %zu rays", e->count);
    }
    return world_rays_new(e->world, e->options->rays, (enum ray_modes)e->options->modes,
                          e->options->of.seed, e->count, &e->ray, &e->mode, reason);
}

enum status explain_world(const struct explain_options *options, struct world *world,
                          const struct fuzz_trial *trial, struct pool *pool, int *code,
                          struct reason *reason)
{
    const struct screen screen = screen_make(&options->screen);
    struct explain_world e = {.options = options,
                              .world = world,
                              .count = trial                       ? trial->ray_count
                                       : option_was_given("count") ? (size_t)options->count
                                                                   : RAYS_OWN};
    enum status status = check_use(options, reason);
    if (!status)
        status = make_arrays(&e, trial, reason);
    if (!status)
        status = answer(&e, pool, reason);
    if (!status)
        status = judge_and_explain(&e, pool, reason);
    if (!status) {
        *code = e.why.wrong ? EXIT_MISMATCH : EXIT_AGREE;
        print(&e, &screen);
        if (options->json)
            status = explain_world_json(&e, *code, reason);
    }
    free(e.ray);
    free(e.mode);
    free(e.hit);
    free(e.tag);
    free(e.judgement);
    return status;
}
