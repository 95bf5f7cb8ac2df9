/* The subject of raydiff explain: a scene, a trial's name or a finding's file. */
#include "cmd/explain/cmd_explain_inner.h"

#include "gpu/build/device_builders.h"
#include "ref/outside/plugin_shader.h"
#include "cmd/common/cmd_outside.h"
#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"
#include "ref/base/text.h"
#include "cmd/conform/cmd_trial.h"
#include "scenes/scenes.h"
#include "scenes/spec.h"
#include "scenes/worlds.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* True if the text begins like a trial's name, with a query and a dot. */
static bool is_trial(const char *text)
{
    for (enum query query = 0; query < QUERY_COUNT; query++) {
        size_t length = strlen(query_name(query));
        if (strncmp(text, query_name(query), length) == 0 && text[length] == '.')
            return true;
    }
    return false;
}

static enum status take_trial(struct explain_options *o, const char *text, struct reason *reason)
{
    static struct trial trial; /* static: the options point to its scene */
    enum status status = trial_parse(text, &trial, reason);
    if (!status && o->of.tree)
        status = fail(reason, STATUS_INPUT, "--bvh: a trial's name says which tree it builds");
    if (status)
        return status;
    o->of = (struct explain_of){.spec = trial.scene,
                                .seed = trial.seed,
                                .engine = trial.engine,
                                .layout = trial.layout,
                                .store = trial.store,
                                .builder = trial.builder,
                                .build = o->of.build,
                                .box = trial.box,
                                .tri = trial.tri,
                                .query = trial.query};
    o->rays = trial.rays;
    o->has_trial = true;
    if (!option_was_given("count"))
        o->count = 1000;
    return STATUS_OK;
}

/* True if the text names a generator, with parameters or without: it stands before any file. */
static bool is_generator(const char *text)
{
    bool is = false;
    for (size_t i = 0; generators[i]; i++)
        is = is || spec_names(text, generators[i]->name);
    for (size_t i = 0; world_generators[i]; i++)
        is = is || spec_names(text, world_generators[i]->name);
    return is;
}

/* A folder is refused as one of findings. */
static bool is_file(const char *text)
{
    static const char ending[] = ".trial";
    size_t length = strlen(text), least = sizeof ending - 1;
    struct stat about;
    if (!is_generator(text) && stat(text, &about) == 0 && S_ISDIR(about.st_mode))
        return true;
    return length > least && strcmp(text + length - least, ending) == 0;
}

/* Uses the signature's engine, unless the user named another. */
static enum status take_engine(struct explain_options *o, const struct fuzz_signature *signature,
                               struct reason *reason)
{
    if (!o->has_engine)
        o->of.engine = fuzz_signature_engine(signature);
    if (!o->of.engine && outside_is_known(signature->engine)) {
        enum status status = outside_engine(signature->engine, &o->of.engine, reason);
        if (status)
            return status;
    }
    if (!o->of.engine)
        return fail(reason, STATUS_INPUT,
                    "%s: engine '%s' is not available: name one with --engine", o->of.spec,
                    signature->engine);
    return STATUS_OK;
}

/* The file decides everything except engine and layout. Without --index and --cause, its own cause
 * is searched for, if it has one. */
static enum status take_file(struct explain_options *o, const char *path, struct finding_file *file,
                             struct reason *reason)
{
    static const char own[] = "ray rays count seed bvh store builder leaf eps bins radius "
                              "split-budget split-alpha presplit optimize "
                              "box tri query modes braid";
    const char *flag;
    for (size_t i = 0; (flag = option_given(i)) != NULL; i++)
        if (option_among(own, flag))
            return fail(reason, STATUS_INPUT, "--%s: %s brings its own", flag, path);
    enum status status = finding_file_read(path, file, reason);
    if (status)
        return status;
    const struct fuzz_trial *trial = &file->trial;
    const bool scene =
        !trial->world.is; /* of a world all answers are explained, by no cause here */
    o->has_file = true;
    o->of.builder = trial->builder;
    o->of.build = trial->build;
    o->of.store = trial->store;
    o->of.box = trial->box;
    o->of.tri = trial->tri;
    o->of.query = trial->query;
    if (file->has_signature) {
        const struct fuzz_signature *signature = &file->signature;
        bool on_ray = signature->kind <= FUZZ_KIND_BITS || signature->kind == FUZZ_KIND_UNFINISHED;
        o->about_tree =
            scene && signature->kind == FUZZ_KIND_TREE && !o->has_index && !o->has_cause;
        if (!on_ray && !o->has_index && !o->about_tree)
            status = fail(reason, STATUS_INPUT, "%s: a finding of kind %s is on no ray: %s", path,
                          fuzz_kind_name(signature->kind),
                          scene ? "name one with --index, or replay it" : "replay it");
        if (!status && !o->about_tree)
            status = take_engine(o, signature, reason);
        else if (!status && !o->of.engine->needs_packed)
            status = fail(reason, STATUS_INPUT, "%s: it is about a tree, and engine %s takes none",
                          path, o->of.engine->name);
        if (!option_was_given("layout") && signature->layout)
            o->of.layout = signature->layout;
        if (scene && !o->has_cause && !o->has_index && signature->cause != CAUSE_NOT_REPEATABLE) {
            o->has_cause = true;
            o->cause = signature->cause;
        }
    }
    if (status)
        finding_file_free(file);
    return status;
}

const char *explain_again(const struct explain_options *o, size_t index,
                          char text[EXPLAIN_COMMAND_MOST])
{
    if (!o->has_file)
        return NULL;
    snprintf(text, EXPLAIN_COMMAND_MOST, "raydiff explain");
    command_word(text, EXPLAIN_COMMAND_MOST, o->of.spec);
    text_append(text, EXPLAIN_COMMAND_MOST, " --index %zu --engine", index);
    command_word(text, EXPLAIN_COMMAND_MOST, o->of.engine->name);
    if (o->of.layout)
        plugin_command(text, EXPLAIN_COMMAND_MOST, o->of.layout);
    if (o->of.engine->gpu && o->of.driver) {
        command_word(text, EXPLAIN_COMMAND_MOST, "--driver");
        command_word(text, EXPLAIN_COMMAND_MOST, o->of.driver);
    }
    return text;
}

enum status explain_take_subject(struct explain_options *o, const char *text,
                                 struct finding_file *file, struct reason *reason)
{
    enum status status = STATUS_OK;
    o->of.spec = text;
    if (is_trial(text))
        status = take_trial(o, text, reason);
    else if (is_file(text))
        status = take_file(o, text, file, reason);
    o->of.driver = o->engines.driver;
    if (status) /* there may be no engine */
        return status;
    if (o->of.tree && !o->of.engine->needs_packed)
        status = fail(reason, STATUS_INPUT, "--bvh: engine %s takes no tree", o->of.engine->name);
    if (o->of.tree)
        o->of.builder = &tree_file_builder;
    if (!o->of.engine->needs_packed) {
        o->of.layout = NULL;
        o->of.builder = NULL;
    }
    if (!status && o->ray_text && (option_was_given("rays") || o->has_index))
        status = fail(reason, STATUS_INPUT, "--ray is one ray: it goes without --rays and --index");
    return status;
}

int explain_check_use(const struct explain_options *o, char *const *spec)
{
    const char *const never = o->ray_text ? "rays index count cause" : o->has_index ? "cause" : "";
    const struct list engine = list_of_one(TABLE_ENGINES, o->of.engine);
    const struct list layout = list_of_one(TABLE_LAYOUTS, o->of.layout);
    const struct list builder = list_of_one(TABLE_BUILDERS, o->of.builder);
    if (o->about_tree && (o->html || o->svg))
        return usage_error(o->command,
                           "--%s: not used here: the finding is about a tree, on no ray",
                           o->html ? "html" : "svg");
    const struct option_use use = {.by = o->ray_text ? "--ray" : "--index",
                                   .never = o->has_file ? "" : never,
                                   .engine = &engine,
                                   .layout = &layout,
                                   .builder = &builder,
                                   .compares = true,
                                   .seeded = !o->ray_text && !o->rays->seedless,
                                   .scene = spec,
                                   .scene_count = 1};
    int code = -1;
    device_builders_use(&o->engines);
    if (o->has_trial) {
        char words[80];
        snprintf(words, sizeof words, "%s%s store builder box tri query rays seed",
                 engine_is_peer(o->of.engine) ? "" : "engine ",
                 o->of.layout && o->of.layout->outside ? "" : "layout");
        const struct option_use own = {.by = "a trial, whose name says it", .never = words};
        code = options_refused(o->command, &own);
    }
    return code < 0 ? options_refused(o->command, &use) : code;
}

enum status explain_compare_built(const struct builder *builder, const struct scene *scene,
                                  struct reason *built, struct reason *reason)
{
    enum status status = builder && builder->compare ? builder->compare(scene, built) : STATUS_OK;
    if (status == STATUS_OK)
        built->text[0] = '\0';
    return status && status != STATUS_DEVICE ? fail(reason, status, "%s", built->text) : STATUS_OK;
}
