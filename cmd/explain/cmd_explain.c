/* raydiff explain: for one ray and one engine, shows the right answer, the given answer and why it
 * is wrong. */
#include "cmd/explain/cmd_explain_inner.h"
#include "cmd/explain/cmd_explain_list.h"
#include "cmd/explain/cmd_explain_picture.h"
#include "cmd/explain/cmd_explain_world.h"

#include "fuzz/play/player.h"
#include "fuzz/play/trial_life.h"
#include "fuzz/play/trial_tree.h"
#include "cmd/common/cmd_tree.h"
#include "ref/base/command.h"
#include "ref/base/ray_text.h"
#include "ref/two_level/braid.h"
#include "scenes/opening.h"
#include "scenes/worlds.h"

#include <stdlib.h>
#include <string.h>

/* State of a run. */
struct explaining {
    struct explain_options *options;
    struct finding_file file; /* if a finding's file is explained */
    struct scene scene;
    struct world world; /* in place of the scene, if it has instances */
    struct oracle *oracle;
    struct tree_file tree; /* from --bvh */
    struct bvh bvh;
    struct packed packed;
    struct pool pool;
    struct explain_decode decode;
    struct reason built; /* how the tree of a device differs from C's; "": it does not */
    char conclusion[EXPLAIN_CONCLUSION_MOST];
    struct fuzz_player *player; /* plays the file's trial at another scale; opened on first use */
    struct ray *ray;
    size_t ray_count; /* 1 with --ray */
};

static enum status make_rays(struct explaining *e, struct reason *reason)
{
    const struct explain_options *o = e->options;
    if (o->has_file) {
        if (o->has_index && o->index >= e->ray_count)
            return fail(reason, STATUS_INPUT, "--index: %llu is no ray here: 0 to %zu",
                        (unsigned long long)o->index, e->ray_count ? e->ray_count - 1 : 0);
        return STATUS_OK;
    }
    e->ray_count = o->ray_text ? 1 : (size_t)o->count;
    e->ray = alloc_zeroed(e->ray_count, sizeof *e->ray);
    if (!e->ray)
        return fail(reason, STATUS_MEMORY, "no memory for %zu rays", e->ray_count);
    if (o->ray_text)
        return ray_text_read(o->ray_text, RAY_TMAX, e->ray, reason);
    if (o->has_index && o->index >= o->count)
        return fail(reason, STATUS_INPUT, "--index: %llu is no ray here: 0 to %llu",
                    (unsigned long long)o->index, (unsigned long long)o->count - 1);
    return ray_set_make(o->rays, &e->scene, o->of.seed, e->ray_count, e->ray, reason);
}

static enum status make_tree(struct explaining *e, struct reason *reason)
{
    const struct explain_of *of = &e->options->of;
    enum status status = explain_compare_built(of->builder, &e->scene, &e->built, reason);
    if (status || !of->engine->needs_packed)
        return status;
    if (e->options->has_file && !of->tree) {
        struct fuzz_trial trial = e->file.trial;
        trial.builder = of->builder;
        trial.build = of->build;
        return fuzz_trial_tree(&trial, of->layout, &e->bvh, &e->packed, NULL, reason);
    }
    if (of->tree)
        status = tree_open("explain", of->tree, &e->scene, &e->tree, reason);
    if (!status && tree_file_is_packed(&e->tree) && !option_was_given("layout"))
        e->options->of.layout = e->tree.packed.layout;
    if (!status)
        status = of->tree ? tree_file_bvh(&e->tree, &e->scene, &e->bvh, reason)
                          : bvh_build(of->builder, &e->scene, &of->build, &e->bvh, reason);
    if (!status && of->tree)
        return tree_file_pack(&e->tree, of->layout, &e->scene, &e->packed, reason);
    if (!status)
        status = packed_make_stored(of->layout, of->store, &e->bvh, &e->scene, &e->packed, reason);
    if (status == STATUS_LIMIT && e->bvh.node_count > 0 && !option_was_given("layout") &&
        !e->options->has_trial) {
        e->options->of.layout = layout_find(EXPLAIN_LARGE_LAYOUT);
        status = packed_make_stored(of->layout, of->store, &e->bvh, &e->scene, &e->packed, reason);
    }
    return status;
}

/* Explains a ray. A ray of a finding's file is explained in the same way as in the campaign that
 * wrote it. */
static enum status explain_ray(struct explaining *e, struct judged *judged, size_t index,
                               struct judged_ray *out, struct reason *reason)
{
    const struct explain_of *of = &e->options->of;
    enum status status = judged_explain_among(judged, e->ray, e->ray_count, index, out, reason);
    if (!status && e->file.trial.step_count > 0 &&
        (status = judged_stale(judged, &e->options->engines, out, reason)))
        explain_free(&out->why);
    if (status || out->why.cause != CAUSE_OUTSIDE || !e->options->has_file)
        return status;
    const struct fuzz_field field = {
        .who = {{of->engine, of->layout}}, .count = 1, .options = e->options->engines};
    if (!e->player)
        status = fuzz_player_open(&field, &e->player, reason);
    if (!status)
        status = fuzz_explain_scaled(e->player, &e->file.trial, (uint32_t)index, out, reason);
    if (status)
        explain_free(&out->why);
    return status;
}

/* Explains the ray of --ray or --index, or the first wrong one (with the requested cause). *index
 * is the number of rays if there is none. */
static enum status choose(struct explaining *e, struct judged *judged, struct judged_ray *out,
                          size_t *index, struct reason *reason)
{
    const struct explain_options *o = e->options;
    *index = o->ray_text ? 0 : (size_t)o->index;
    if (o->ray_text || o->has_index)
        return explain_ray(e, judged, *index, out, reason);
    for (size_t first = 0;; first = *index + 1) {
        enum status status = judged_find(judged, e->ray, first, e->ray_count, index, reason);
        if (status || *index == e->ray_count)
            return status;
        status = explain_ray(e, judged, *index, out, reason);
        if (status || !o->has_cause || out->why.cause == o->cause)
            return status;
        explain_free(&out->why);
    }
}

/* Explains the chosen ray and prints its page. *code: the exit code. */
static enum status explain_one(struct explaining *e, struct judged *judged, int *code,
                               struct reason *reason)
{
    const struct explain_options *o = e->options;
    const struct screen screen = screen_make(&o->screen);
    struct judged_ray ray;
    size_t index;
    enum status status = choose(e, judged, &ray, &index, reason);
    if (!status && index == e->ray_count && o->shows && e->ray_count > 0)
        status = explain_ray(e, judged, index = 0, &ray, reason); /* one that is right, then */
    if (status)
        return status;
    if (index == e->ray_count) {
        char from[80] = "";
        if (!o->has_file)
            snprintf(from, sizeof from, " of set %s, seed %llu", o->rays->name,
                     (unsigned long long)o->of.seed);
        screen_text(&screen, "%s: %zu ray%s%s: no answer of %s is wrong%s%s\n", o->of.spec,
                    e->ray_count, plural(e->ray_count), from, o->of.engine->name,
                    o->has_cause ? " with cause " : "", o->has_cause ? cause_name(o->cause) : "");
        if (o->html || o->svg)
            screen_text(&screen, "%s is not written: there is nothing to draw\n",
                        o->html ? o->html : o->svg);
        snprintf(e->conclusion, sizeof e->conclusion, "no answer is wrong%s%s",
                 o->has_cause ? " with cause " : "", o->has_cause ? cause_name(o->cause) : "");
        return explain_write_none(o, e->ray_count, &e->decode, *code, reason);
    }
    char again[EXPLAIN_COMMAND_MOST];
    const struct explain_set set = {o->rays->name, e->ray_count};
    struct explain_page page = {.of = &o->of,
                                .scene = &e->scene,
                                .judged = judged,
                                .ray = &ray,
                                .rays = o->ray_text || o->has_file ? NULL : o->rays->name,
                                .index = index,
                                .count = e->ray_count,
                                .all = e->ray,
                                .file = o->has_file ? &e->file : NULL,
                                .decode = &e->decode,
                                .built = e->built.text,
                                .screen = screen,
                                .again = explain_again(o, index, again)};
    if (ray.among && !o->has_file) {
        explain_command_among(&o->of, &set, index, again);
        page.again = again;
    }
    *code = exit_worse(*code, !ray.answer.finished     ? EXIT_ENGINE
                              : explain_is_wrong(&ray) ? EXIT_MISMATCH
                                                       : EXIT_AGREE);
    if (o->shows)
        status = o->shows(o->shows_to, &page, *code, reason);
    else
        explain_print(&page);
    explain_conclude(&ray, e->conclusion);
    if (!status && o->html)
        status = explain_write_html(o->html, &page, reason);
    if (!status && o->svg)
        status = picture_write(o->svg, &page, reason);
    if (!status && o->json)
        status = explain_write_json(o->json, &page, *code, reason);
    explain_free(&ray.why);
    return status;
}

/* Opens a world, or what is a scene and loses nothing. */
static enum status open_either(struct explaining *e, struct reason *reason)
{
    const struct explain_of *of = &e->options->of;
    enum status status = world_open(of->spec, of->seed, &e->world, reason);
    if (!status && world_only_scene(&e->world))
        status = world_take_scene(of->spec, &e->world, &e->scene, reason);
    if (!status && e->world.instance_count == 0 && option_was_given("modes"))
        status = fail(reason, STATUS_INPUT,
                      "--modes: %s is a scene; only worlds have masks and flags (docs/worlds.md)",
                      of->spec);
    if (!status && e->world.instance_count == 0 && option_was_given("braid"))
        status =
            fail(reason, STATUS_INPUT,
                 "--braid: %s is a scene; only worlds have instances (docs/worlds.md)", of->spec);
    return status;
}

static enum status explain_trial_of_world(struct explaining *e, int *code, struct reason *reason)
{
    struct trial_meshes meshes;
    const struct fuzz_trial *trial = &e->file.trial;
    enum status status = trial_meshes_make(&trial->world, &e->scene, &meshes, reason);
    if (status)
        return status;
    status = explain_world(e->options, &meshes.world, trial, &e->pool, code, reason);
    trial_meshes_free(&meshes);
    return status;
}

/* Explains an answer of the prepared engine. */
static enum status explain_answers(struct explaining *e, void *self, const struct job *job,
                                   int *code, struct reason *reason)
{
    const struct screen screen = screen_make(&e->options->screen);
    const struct judged_job from = {e->options->of.engine, self, job, &e->bvh, e->oracle};
    struct judged judged = {0};
    enum status status = judged_make(&from, &judged, reason);
    if (!status)
        status = explain_decode(e->options, &e->packed, &e->decode, reason);
    *code = explain_decode_code(&e->decode);
    if (!status)
        status = explain_one(e, &judged, code, reason);
    if (!status && !e->options->shows) {
        explain_decode_print(&e->decode, &screen);
        explain_print_conclusion(e->conclusion, &e->decode, &screen);
    }
    judged_free(&judged);
    return status;
}

static enum status explain_lists(struct explaining *e, void *self, const struct job *job, int *code,
                                 struct reason *reason)
{
    const struct screen screen = screen_make(&e->options->screen);
    const struct explain_lists lists = {e->options, &e->scene, e->oracle,   self,
                                        job,        e->ray,    e->ray_count};
    enum status status = explain_list(&lists, e->conclusion, code, reason);
    if (!status)
        explain_print_conclusion(e->conclusion, &e->decode, &screen);
    return status;
}

/* Reads the subject: false if the whole of it is explained, a world. */
static enum status open_all(struct explaining *e, bool *scene, int *code, struct reason *reason)
{
    const struct explain_options *o = e->options;
    enum status status = o->has_file ? STATUS_OK : open_either(e, reason);
    const bool world = e->file.trial.world.is || e->world.instance_count > 0;
    *scene = !world;
    if (!status && world && o->shows)
        return fail(reason, STATUS_UNSUPPORTED, "%s: is of a world, and pages are of scenes",
                    o->of.spec);
    if (!status && e->file.trial.world.is && e->file.trial.step_count > 0)
        return fail(reason, STATUS_UNSUPPORTED, "%s: is of a world with steps: replay it",
                    o->of.spec);
    if (!status && e->file.trial.world.is)
        return explain_trial_of_world(e, code, reason);
    if (!status && world)
        return explain_world(o, &e->world, NULL, &e->pool, code, reason);
    if (!status)
        status = make_rays(e, reason);
    if (!status)
        status = make_tree(e, reason);
    return status ? status : oracle_make(&e->scene, &e->oracle, reason);
}

static enum status explain(struct explaining *e, int *code, struct reason *reason)
{
    const struct explain_of *of = &e->options->of;
    bool scene;
    e->pool.options = e->options->engines;
    enum status status = open_all(e, &scene, code, reason);
    if (status || !scene)
        return status;
    if (of->query == QUERY_ALL && e->options->shows)
        return fail(reason, STATUS_UNSUPPORTED, "%s: is of lists, and pages are of one hit",
                    of->spec);
    const struct job job = {.scene = &e->scene,
                            .packed = of->engine->needs_packed ? &e->packed : NULL,
                            .box = of->box,
                            .tri = of->tri,
                            .query = of->query};
    void *self = pool_get(&e->pool, of->engine, &status, reason);
    if (!status) /* without a file: a trial without steps */
        status = trial_life_enter(&e->file.trial, of->engine, self, &job, reason);
    if (status) {
        *code = exit_of_status(status);
        return status;
    }
    return of->query == QUERY_ALL ? explain_lists(e, self, &job, code, reason)
                                  : explain_answers(e, self, &job, code, reason);
}

enum status explain_run(struct explain_options *o, struct finding_file *file, int *code,
                        struct reason *reason)
{
    /* The run takes over the file's scene and rays and frees them below. */
    struct explaining e = {.options = o,
                           .file = *file,
                           .scene = file->trial.scene,
                           .ray = file->trial.ray,
                           .ray_count = file->trial.ray_count};
    *file = (struct finding_file){.has_signature = false};
    *code = EXIT_AGREE;
    enum status status =
        o->about_tree ? explain_tree_finding(o, &e.file, code, reason) : explain(&e, code, reason);
    fuzz_player_close(e.player);
    pool_free(&e.pool);
    oracle_free(e.oracle);
    packed_free(&e.packed);
    bvh_free(&e.bvh);
    tree_file_free(&e.tree);
    scene_free(&e.scene);
    world_free(&e.world);
    trial_world_free(&e.file.trial.world);
    free(e.ray);
    return status;
}

int cmd_explain(int argc, char **argv)
{
    struct reason reason = {""};
    struct finding_file file = {.has_signature = false};
    struct explain_options options = {
        .command = "explain",
        .of.build = build_options_default(),
        .engines = engine_options_default(),
    };
    int first, code = options_read(&explain_set, &options, argc, argv, &first);
    if (code >= 0)
        return code;
    options.has_index = option_was_given("index");
    options.has_engine = option_was_given("engine");
    if (argc - first != 1)
        return usage_error("explain", argc == first ? "no scene given" : "one scene at a time");
    if (tree_check_options(options.of.tree, 1, &reason) ||
        explain_take_subject(&options, argv[first], &file, &reason))
        return usage_error("explain", "%s", reason.text);
    code = explain_check_use(&options, argv + first);
    if (code < 0 && options.of.query == QUERY_ALL)
        code = explain_list_check_use(&options);
    if (code >= 0)
        return finding_file_free(&file), code;
    enum status status = explain_run(&options, &file, &code, &reason);
    return exit_worse(code, exit_with_reason("explain", status, &reason));
}
