/* raydiff check: compares engines and layouts on scenes, ray by ray. */
#include "cmd/check/cmd_check.h"

#include "gpu/build/device_builders.h"
#include "cmd/common/cmd_tree.h"
#include "cmd/common/cmd_progress.h"
#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"
#include "ref/match/original.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"
#include "ref/store.h"

#include <stdlib.h>

/* How a storage loses precision; NULL: not at all. Lossy ones run on the decoded scene, the others
 * on the scene as it is. */
static const struct lossy *store_lossy(const struct check_options *o, size_t i)
{
    return tri_stores[o->store.index[i]]->lossy;
}

/* State of one run of the command. */
struct check_run {
    struct check_options options;
    struct pool pool;
    struct progress progress;
    size_t rows;                     /* of a scene, at most */
    struct tree_file tree;           /* from --bvh; rows point to it */
    struct turnout turnout;          /* of the named members */
    const struct original *original; /* of the decoded scene in use; NULL: not decoded */
    const struct check_subject *of;  /* in use */
};

/* Adds the rows of one engine for all box tests and queries. Engines with a tree of their own, or
 * without one, have no box test of ours; one with a triangle test of its own has the rows of the
 * first that is named. */
static enum status play_engine(struct check_run *check, struct match *match,
                               const struct engine *engine, struct check_scene *result)
{
    const struct check_options *o = &check->options;
    size_t boxes = engine->needs_packed && !engine->own_tree ? o->box.count : 1;
    if (engine->own_tri && match->options.tri != tri_tests[o->tri.index[0]])
        return STATUS_OK;
    for (size_t b = 0; b < boxes; b++)
        for (size_t q = 0; q < o->query.count; q++) {
            struct row row;
            match_set(match, box_tests[o->box.index[b]], (enum query)o->query.index[q]);
            progress_done(&check->progress, result->row_count, check->rows, "this scene");
            progress_step(&check->progress, "%s: %s %s %s", result->spec,
                          engine->needs_packed ? match_layout(match)->name : "-", engine->name,
                          query_name(match->options.query));
            match_run(match, engine, &row);
            if (check->original && original_judge(check->original, match, &row))
                return STATUS_MEMORY;
            if (check_add_row(result, &row))
                return STATUS_MEMORY;
        }
    return STATUS_OK;
}

/* An engine that traces no worlds has rows of one only if it was named. */
static enum status play_engines(struct check_run *check, struct match *match, bool packed,
                                struct check_scene *result)
{
    const struct check_options *o = &check->options;
    enum status status = STATUS_OK;
    for (size_t e = 0; e < o->engine.count && status == STATUS_OK; e++) {
        const struct engine *engine = engines[o->engine.index[e]];
        if (engine->needs_packed == packed && (!match->world || engine->worlds || o->engine_named))
            status = play_engine(check, match, engine, result);
    }
    return status;
}

static enum status play_layouts(struct check_run *check, struct match *match,
                                struct check_scene *result, struct reason *reason)
{
    const struct check_options *o = &check->options;
    struct list list = o->layout_named ? o->layout : tree_layouts(&check->tree, &o->layout);
    size_t count = o->layout_auto ? 1 : list.count;
    for (size_t i = 0; i < count * o->store.count; i++) {
        const struct layout *layout =
            o->layout_auto ? NULL : layouts_all[list.index[i / o->store.count]];
        struct reason refusal = {""};
        if ((store_lossy(o, i % o->store.count) != NULL) != (check->original != NULL))
            continue;
        match->options.store = tri_stores[o->store.index[i % o->store.count]];
        enum status status =
            layout ? match_pack(match, layout, &refusal)
                   : match_pack_auto(match, result->refused, sizeof result->refused, &refusal);
        struct row row;
        if (status == STATUS_OK) {
            status = play_engines(check, match, true, result);
        } else if (status == STATUS_LIMIT) {
            match_refused(match, layout, NULL, status, &refusal, &row);
            status = check_add_row(result, &row);
        }
        if (status)
            return fail(reason, status, "%s: %s", result->spec,
                        refusal.text[0] ? refusal.text : status_text(status));
    }
    return STATUS_OK;
}

/* Runs all layouts and engines on the match's tree. Engines without a tree run only with the first
 * builder, since builders make no difference to them. */
static enum status play_match(struct check_run *check, struct match *match, bool first_builder,
                              struct check_scene *result, struct reason *reason)
{
    enum status status = play_layouts(check, match, result, reason);
    if (status == STATUS_OK && first_builder && !check->original)
        status = play_engines(check, match, false, result);
    return status;
}

static enum status play_scene(struct check_run *check, const struct scene *scene,
                              const struct scene *rest, const struct ray *rays,
                              struct check_scene *result, struct reason *reason)
{
    const struct check_options *o = &check->options;
    struct match_options options = {.builder = o->bvh ? &tree_file_builder
                                                      : builders_all[o->builder.index[0]],
                                    .build = o->build,
                                    .tree = o->bvh ? &check->tree : NULL,
                                    .rest = o->move > 0 ? rest : NULL,
                                    .life = check->of->lives ? &check->of->life : NULL,
                                    .box = box_tests[o->box.index[0]],
                                    .tri = tri_tests[o->tri.index[0]],
                                    .query = (enum query)o->query.index[0],
                                    .braid = o->braid,
                                    .demands = o->demands,
                                    .repeats = (unsigned)o->repeats,
                                    .brute_budget = o->brute,
                                    .brute_rays = o->brute_rays};
    struct match match;
    struct reason why = {""};
    progress_step(&check->progress, "%s: exact truth", result->spec);
    enum status status =
        check->of->is_world
            ? match_make_world(&check->of->world, rays, check->of->mode, result->ray_count,
                               &options, &check->pool, &match, &why)
            : match_make(scene, rays, result->ray_count, &options, &check->pool, &match, &why);
    if (status)
        return fail(reason, status, "%s: %s", result->spec, why.text);
    for (size_t t = 0; t < o->tri.count && status == STATUS_OK; t++)
        for (size_t b = 0; b < o->builder.count && status == STATUS_OK; b++) {
            if (t + b > 0)
                status = match_rebuild(
                    &match, o->bvh ? &tree_file_builder : builders_all[o->builder.index[b]],
                    &o->build, tri_tests[o->tri.index[t]], &why);
            if (status)
                fail(reason, status, "%s: %s", result->spec, why.text);
            else
                status = play_match(check, &match, b == 0, result, reason);
        }
    match_free(&match);
    return status;
}

/* Runs the lossy storage on the scene that it decodes to. */
static enum status play_decoded(struct check_run *check, const struct lossy *lossy,
                                const struct scene *scene, const struct ray *rays,
                                struct check_scene *result, struct reason *reason)
{
    struct scene decoded;
    struct original original = {0};
    uint32_t bits = check->options.bits ? (uint32_t)check->options.bits : lossy->bits_default;
    enum status status = lossy->move(scene, bits, &decoded, &result->quantised, reason);
    if (status)
        return status;
    result->lossy = lossy;
    result->flat = original_flat(&decoded);
    status = original_make(scene, &result->quantised, rays, result->ray_count, &original, reason);
    check->original = &original;
    if (status == STATUS_OK)
        status = play_scene(check, &decoded, NULL, rays, result, reason);
    check->original = NULL;
    original_free(&original);
    scene_free(&decoded);
    return status;
}

static enum status play_both(struct check_run *check, const struct scene *scene,
                             const struct scene *rest, const struct ray *rays,
                             struct check_scene *result, struct reason *reason)
{
    const struct check_options *o = &check->options;
    const struct lossy *lossy = NULL;
    const char *name = NULL;
    bool plain = false;
    for (size_t i = 0; i < o->store.count; i++) {
        if (!store_lossy(o, i)) {
            plain = true;
            continue;
        }
        if (lossy && lossy != store_lossy(o, i))
            return fail(reason, STATUS_INPUT, "--store: one lossy storage at a time, not %s and %s",
                        name, tri_stores[o->store.index[i]]->name);
        lossy = store_lossy(o, i);
        name = tri_stores[o->store.index[i]]->name;
    }
    if (lossy && (o->bvh || o->layout_auto || o->move > 0 || o->step_count > 0))
        return fail(reason, STATUS_INPUT,
                    "--store %s: not with --bvh, --move, --steps, --layout auto", name);
    if (lossy && o->bits && (o->bits < lossy->bits_least || o->bits > lossy->bits_most))
        return fail(reason, STATUS_INPUT, "--bits %llu: storage %s takes %u to %u",
                    (unsigned long long)o->bits, name, lossy->bits_least, lossy->bits_most);
    enum status status = plain ? play_scene(check, scene, rest, rays, result, reason) : STATUS_OK;
    return status || !lossy ? status : play_decoded(check, lossy, scene, rays, result, reason);
}

/* `step`: after how many of the steps. */
static enum status check_one(struct check_run *check, const char *spec, uint32_t step,
                             struct check_scene *result, struct reason *reason)
{
    const struct check_options *o = &check->options;
    struct check_subject of;
    *result = (struct check_scene){.spec = spec,
                                   .move = (double)o->move,
                                   .step = step,
                                   .rays = ray_sets[o->rays]->name,
                                   .ray_count = (size_t)o->count,
                                   .seed = o->seed,
                                   .driver = o->engines.driver};
    if (step > 0)
        step_write(&o->step[step - 1], result->after);
    progress_step(&check->progress, "%s: reading", spec);
    enum status status = check_open(o, spec, result, &of, reason);
    if (status == STATUS_OK && o->bvh)
        status =
            tree_open("check", o->bvh, o->move > 0 ? &of.rest : &of.scene, &check->tree, reason);
    check->of = &of;
    if (status == STATUS_OK && !result->vacuous)
        status = play_both(check, &of.scene, &of.rest, of.ray, result, reason);
    check->of = NULL;
    check_close(&of);
    return status;
}

/* `specs` texts, each of which has a result before the steps and after each of them. */
static int check_all(struct check_run *check, char *const *spec, size_t specs)
{
    const size_t times = check->options.step_count + 1, count = specs * times;
    int code = EXIT_AGREE;
    bool any = false; /* scene was played */
    struct reason reason = {""};
    struct check_scene *results = alloc_zeroed(count, sizeof *results);
    if (!results)
        return EXIT_INTERNAL;
    const struct check_options *o = &check->options;
    const struct screen screen = screen_make(&o->screen);
    const struct list_rows rows = {&o->engine, &o->tri, &o->box, o->bvh ? 1 : o->builder.count,
                                   (o->layout_auto ? 1 : o->layout.count) * o->store.count};
    check->rows = list_rows(&rows) * o->query.count;
    turnout_expect(&check->turnout, o->engine_named ? &o->engine : NULL, &o->engine,
                   o->layout_named && !o->layout_auto ? &o->layout : NULL);
    for (size_t i = 0; i < count; i++) {
        enum status status =
            check_one(check, spec[i / times], (uint32_t)(i % times), &results[i], &reason);
        progress_end(&check->progress);
        code = exit_worse(code, exit_with_reason("check", status, &reason));
        if (status == STATUS_OK && results[i].vacuous) {
            fprintf(stderr, "raydiff check: %s: " CHECK_VACUOUS "\n", results[i].spec);
            code = exit_worse(code, EXIT_MISMATCH);
        }
        if (status)
            i += times - 1 - i % times; /* the steps behind it would fail, too */
        if (status || results[i].vacuous)
            continue;
        any = true;
        check_print(&results[i], &screen);
        fflush(stdout);
        turnout_rows(&check->turnout, results[i].row, results[i].row_count);
        code = exit_worse(code, check_exit(&results[i], check->options.layout_named,
                                           check->options.engine_named));
    }
    if (any) { /* else it is already told why nothing was run */
        turnout_print(&check->turnout, &screen);
        code = exit_worse(code, turnout_exit(&check->turnout));
    }
    code = exit_worse(code, check_unused(check->options.demands.displacement, results, count));
    if (check->options.json) {
        enum status status =
            check_write_json(check->options.json, results, count, &check->turnout, code, &reason);
        code = exit_worse(code, exit_with_reason("check", status, &reason));
    }
    check_print_conclusion(results, count, code, &screen);
    for (size_t i = 0; i < count; i++)
        free(results[i].row);
    free(results);
    return code;
}

/* Rejects options that this run does not use. Returns -1 if all are used, else the exit code. */
static int check_use(const struct check_options *o, char *const *spec, size_t count)
{
    const struct list rays = {.index = {o->rays}, .count = 1};
    const struct option_use use = {.engine = &o->engine,
                                   .layout = o->layout_auto ? NULL : &o->layout,
                                   .builder = &o->builder,
                                   .store = &o->store,
                                   .rays = &rays,
                                   .scene = spec,
                                   .scene_count = count,
                                   .seeded = o->move > 0};
    device_builders_use(&o->engines);
    return options_refused("check", &use);
}

int cmd_check(int argc, char **argv)
{
    struct check_run check = {.options = {.engine = table_all(TABLE_ENGINES),
                                          .build = build_options_default(),
                                          .engines = engine_options_default()},
                              .progress = progress_make("check")};
    int first, code = options_read(&check_set, &check.options, argc, argv, &first);
    if (code >= 0)
        return code;
    check.options.layout_named = option_was_given("layout");
    check.options.modes_named = option_was_given("modes");
    check.options.engine_named = option_was_given("engine") && !check.options.engine.all;
    if (first == argc)
        return usage_error("check", "no scene given");
    code = compilers_apply("check", &check.options.compilers, option_was_given("engine"),
                           &check.options.engine);
    if (code >= 0)
        return code;
    struct reason reason;
    if (tree_check_options(check.options.bvh, (size_t)(argc - first), &reason))
        return usage_error("check", "%s", reason.text);
    const struct check_options *o = &check.options;
    if (o->step_count > 0 && (o->bvh || o->layout_auto || o->move > 0))
        return usage_error("check", "--steps: not with --bvh, --move, --layout auto");
    if (check.options.demands.watertight && list_has(&check.options.query, QUERY_ALL))
        return usage_error("check", "--require watertight is of closest and any hits, not all");
    code = check_use(&check.options, argv + first, (size_t)(argc - first));
    if (code >= 0)
        return code;
    check.pool.options = check.options.engines;
    code = check_all(&check, argv + first, (size_t)(argc - first));
    pool_free(&check.pool);
    tree_file_free(&check.tree);
    return code;
}
