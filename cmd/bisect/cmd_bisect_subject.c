/* The subject of raydiff bisect: a scene, a world, a trial's name or a finding's file. */
#include "cmd/bisect/cmd_bisect.h"

#include "cmd/common/cmd_use.h"
#include "cmd/conform/cmd_trial.h"
#include "gpu/engines/compiled.h"
#include "scenes/move.h"
#include "scenes/opening.h"
#include "scenes/rays/world_rays.h"
#include "scenes/scenes.h"

#include <stdlib.h>
#include <string.h>

#define SIGNATURE_ENGINE_MOST (sizeof((struct fuzz_signature *)0)->engine - 1)

/* True if the text begins like a trial's name, with a query and a dot. */
static bool is_trial(const char *text)
{
    for (enum query query = 0; query < QUERY_COUNT; query++) {
        const size_t length = strlen(query_name(query));
        if (strncmp(text, query_name(query), length) == 0 && text[length] == '.')
            return true;
    }
    return false;
}

static bool is_file(const char *text)
{
    static const char ending[] = ".trial";
    const size_t length = strlen(text), least = sizeof ending - 1;
    return length > least && strcmp(text + length - least, ending) == 0;
}

/* Options that the subject has a word for already. */
static enum status refuse(const char *names, const char *by, struct reason *reason)
{
    const char *flag;
    for (size_t i = 0; (flag = option_given(i)) != NULL; i++)
        if (option_among(names, flag))
            return fail(reason, STATUS_INPUT, "--%s: %.100s says it", flag, by);
    return STATUS_OK;
}

/* --- compilers -------------------------------------------------------------------------------- */

/* An engine with compiled shaders brings the compiler, and is the engine whose shaders they are. */
static const char *take_engine(struct bisect_options *o)
{
    const struct engine_compiled *compiled = o->engine->compiled;
    if (!compiled)
        return NULL;
    o->engine = compiled->raw;
    return compiled->compiler;
}

static enum status parse_one(const char *flag, const char *text, const struct engine *engine,
                             struct compiler *out, char name[COMPILER_NAME_MOST + 32],
                             struct reason *reason)
{
    struct reason why = {""};
    const struct engine *made;
    enum status status = compiler_parse(text, out, &why);
    if (!status && out->memory != MEMORY_STORAGE)
        status = fail(&why, STATUS_INPUT, "'%.60s': a way to read memory has no passes", text);
    if (!status) /* looks for its tools and passes */
        status = compiled_make(engine, out, &made, &why);
    if (status)
        return fail(reason, status, "%s: %s", flag, why.text);
    compiler_name(out, name);
    return STATUS_OK;
}

static enum status take_compilers(struct bisect_options *o, struct bisect_subject *s,
                                  struct reason *reason)
{
    const char *brought = take_engine(o);
    if (!compiled_takes(o->engine))
        return fail(reason, STATUS_INPUT,
                    "engine %s has no shaders to compile: vulkan, vulkan_brute, vulkan_stackless "
                    "and rayquery have",
                    o->engine->name);
    if (brought && o->bad)
        return fail(reason, STATUS_INPUT, "--compiler: the engine has one, %.100s", brought);
    if (!brought && !o->bad)
        return fail(reason, STATUS_INPUT,
                    "no compiler: name that under which it shows with --compiler");
    enum status status = parse_one("--compiler", brought ? brought : o->bad, o->engine, &s->bad,
                                   s->bad_name, reason);
    if (!status)
        status = parse_one("--good", o->good, o->engine, &s->good, s->good_name, reason);
    if (!status && strcmp(s->bad_name, s->good_name) == 0)
        status = fail(reason, STATUS_INPUT, "--good: it is the same compiler, %.100s", s->bad_name);
    return status;
}

/* --- scenes and worlds ------------------------------------------------------------------------ */

static enum status take_scene(struct bisect_options *o, struct bisect_subject *s,
                              struct reason *reason)
{
    enum status status = world_open(s->text, o->seed, &s->world, reason);
    if (status)
        return status;
    s->ray_count = (size_t)o->count;
    if (!world_only_scene(&s->world)) {
        s->is_world = &s->world;
        return world_rays_new(&s->world, o->rays, RAY_MODES_MIXED, o->seed, s->ray_count, &s->ray,
                              &s->mode, reason);
    }
    status = world_take_scene(s->text, &s->world, &s->scene, reason);
    return status ? status
                  : ray_set_new(o->rays, &s->scene, o->seed, s->ray_count, &s->ray, reason);
}

static enum status take_trial(struct bisect_options *o, struct bisect_subject *s,
                              struct reason *reason)
{
    struct trial trial;
    enum status status = refuse("engine layout store builder box tri query rays seed leaf eps",
                                "the trial's name", reason);
    if (!status)
        status = trial_parse(s->text, &trial, reason);
    if (!status && trial.query == QUERY_ALL)
        status = fail(reason, STATUS_INPUT, "trial: closest or any can be bisected, not all");
    if (status)
        return status;
    o->engine = trial.engine;
    o->layout = trial.layout;
    o->store = trial.store;
    if (trial.builder)
        o->builder = trial.builder;
    if (trial.box)
        o->box = trial.box;
    o->tri = trial.tri;
    o->query = trial.query;
    o->rays = trial.rays;
    o->seed = trial.seed;
    s->ray_count = (size_t)o->count;
    status = scene_open(trial.scene, trial.seed, &s->scene, reason);
    return status ? status
                  : ray_set_new(o->rays, &s->scene, o->seed, s->ray_count, &s->ray, reason);
}

/* The signature's engine, unless another is named. */
static enum status take_signature(struct bisect_options *o, const struct bisect_subject *s,
                                  struct reason *reason)
{
    const struct fuzz_signature *signature = &s->file.signature;
    if (!s->file.has_signature)
        return STATUS_OK;
    if (signature->layout && !option_was_given("layout"))
        o->layout = signature->layout;
    if (option_was_given("engine"))
        return STATUS_OK;
    const struct engine *raw = compiled_base(signature->engine);
    const struct engine *found = fuzz_signature_engine(signature);
    if (o->bad) {
        if (raw || (found && compiled_takes(found)))
            o->engine = raw ? raw : found;
        return STATUS_OK;
    }
    if (found && (found->compiled || !raw)) {
        o->engine = found->compiled || compiled_takes(found) ? found : o->engine;
        return STATUS_OK;
    }
    struct reason why = {""};
    const struct engine *made;
    if (raw && strlen(signature->engine) < SIGNATURE_ENGINE_MOST &&
        !compiled_engine(signature->engine, &made, &why)) {
        o->engine = made;
        return STATUS_OK;
    }
    return fail(reason, STATUS_INPUT,
                "%.100s: the compiler of engine '%s' is not known by that: name it with --compiler",
                s->text, signature->engine);
}

static enum status set_at_rest(struct bisect_subject *s, struct reason *reason)
{
    const struct fuzz_trial *trial = &s->file.trial;
    s->rest = s->scene;
    s->rest.vertex =
        alloc_copy(s->scene.vertex, 3 * (size_t)s->scene.vertex_count, sizeof *s->scene.vertex);
    if (!s->rest.vertex)
        return fail(reason, STATUS_MEMORY, "no memory for the vertices of a scene at rest");
    scene_move(&s->rest, trial->move, trial->move_seed);
    s->moved = true;
    return STATUS_OK;
}

static enum status take_file(struct bisect_options *o, struct bisect_subject *s,
                             struct reason *reason)
{
    enum status status =
        refuse("store builder leaf eps box tri query rays count seed", "the file", reason);
    if (!status)
        status = finding_file_read(s->text, &s->file, reason);
    if (!status)
        status = take_signature(o, s, reason);
    if (status)
        return status;
    struct fuzz_trial *trial = &s->file.trial;
    if (trial->step_count > 0)
        return fail(reason, STATUS_INPUT, "%.100s: a trial with steps is not bisected: replay it",
                    s->text);
    o->store = trial->store;
    o->builder = trial->builder;
    o->build = trial->build;
    o->box = trial->box;
    o->tri = trial->tri;
    o->query = trial->query;
    /* The subject takes over scene and rays. */
    s->scene = trial->scene;
    s->ray = trial->ray;
    s->ray_count = trial->ray_count;
    trial->scene = (struct scene){0};
    trial->ray = NULL;
    if (trial->world.is) {
        s->mode = alloc_copy(trial->world.mode, s->ray_count, sizeof *s->mode);
        if (!s->mode)
            return fail(reason, STATUS_MEMORY, "no memory for %zu rays", s->ray_count);
        status = trial_meshes_make(&trial->world, &s->scene, &s->meshes, reason);
        s->is_world = &s->meshes.world;
    }
    return !status && trial->move > 0 ? set_at_rest(s, reason) : status;
}

enum status bisect_subject_open(struct bisect_options *o, const char *text,
                                struct bisect_subject *s, struct reason *reason)
{
    *s = (struct bisect_subject){.text = text};
    enum status status = is_trial(text)  ? take_trial(o, s, reason)
                         : is_file(text) ? take_file(o, s, reason)
                                         : take_scene(o, s, reason);
    if (!status)
        status = take_compilers(o, s, reason);
    if (!status && !o->engine->needs_packed)
        o->layout = NULL;
    return status;
}

void bisect_subject_free(struct bisect_subject *s)
{
    if (s->moved)
        free(s->rest.vertex);
    trial_meshes_free(&s->meshes);
    world_free(&s->world);
    scene_free(&s->scene);
    free(s->ray);
    free(s->mode);
    finding_file_free(&s->file);
    *s = (struct bisect_subject){0};
}
