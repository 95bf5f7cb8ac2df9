#include "cmd/conform/cmd_trial.h"

#include "cmd/common/cmd_outside.h"
#include "gpu/engines/compiled.h"
#include "ref/outside/pipe.h"
#include "ref/outside/shared_object.h"
#include "scenes/scenes.h"
#include "ref/store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void trial_print(const struct trial *trial, char name[TRIAL_NAME_MOST])
{
    char stored[STORED_NAME_MOST];
    snprintf(name, TRIAL_NAME_MOST, "%s.%s.%s.%s.%s.%s.%s.%s.%llu", query_name(trial->query),
             trial->engine->name, stored_name(trial->layout, trial->store, stored),
             trial->builder ? trial->builder->name : "-", trial->box ? trial->box->name : "-",
             trial->tri->name, trial->scene, trial->rays->name, (unsigned long long)trial->seed);
}

/* Cuts the text at the next dot. Returns the part before it and advances *rest. */
static char *cut_first(char **rest)
{
    char *field = *rest;
    char *dot = strchr(field, '.');
    if (dot)
        *dot = '\0';
    *rest = dot ? dot + 1 : field + strlen(field);
    return field;
}

/* Whether a text begins with the layout's field of a name, "-" if there is none. */
static bool begins_layout(const char *text)
{
    char field[64];
    const size_t length = strcspn(text, ".:");
    if (length == 1 && *text == '-')
        return true;
    snprintf(field, sizeof field, "%.*s", (int)(length < sizeof field ? length : 0), text);
    return layout_find(field) != NULL;
}

/* Cuts off the name of an engine with compiled shaders: the path of a program may contain dots, so
 * it ends before a layout. */
static char *cut_compiled(char **rest)
{
    char *field = *rest;
    for (char *dot = field; (dot = strchr(dot, '.')) != NULL; dot++)
        if (begins_layout(dot + 1)) {
            *dot = '\0';
            *rest = dot + 1;
            return field;
        }
    return cut_first(rest);
}

/* Cuts off the engine's name. A command or a file may contain dots, so it ends at the three '-' of
 * an engine without a tree. */
static char *cut_engine(char **rest)
{
    char *field = *rest;
    if (compiled_base(field))
        return cut_compiled(rest);
    char *end = strstr(field, ".-.-.-.");
    if (end)
        *end = '\0';
    if (!end || !(pipe_is_peer(field) || file_of_engine(field))) {
        if (end)
            *end = '.';
        return cut_first(rest);
    }
    *rest = end + 1;
    return field;
}

static char *cut_last(char *text)
{
    char *dot = strrchr(text, '.');
    if (!dot)
        return NULL;
    *dot = '\0';
    return dot + 1;
}

static enum status parse_fields(char *const field[6], struct trial *out, struct reason *reason)
{
    if (!query_find(field[0], &out->query))
        return fail(reason, STATUS_INPUT, "trial: unknown query '%s'", field[0]);
    out->engine = engine_find(field[1]);
    if (!out->engine && outside_is_engine(field[1])) {
        enum status status = outside_engine(field[1], &out->engine, reason);
        if (status)
            return status;
    }
    if (!out->engine)
        return fail(reason, STATUS_INPUT, "trial: unknown engine '%s'", field[1]);
    out->tri = tri_test_find(field[5]);
    if (!out->tri)
        return fail(reason, STATUS_INPUT, "trial: unknown triangle test '%s'", field[5]);
    if (!out->engine->needs_packed) {
        for (int i = 2; i < 5; i++)
            if (strcmp(field[i], "-") != 0)
                return fail(reason, STATUS_INPUT, "trial: engine %s takes '-', not '%s'", field[1],
                            field[i]);
        return STATUS_OK;
    }
    char *colon = strrchr(field[2], ':');
    out->store = colon ? tri_store_find(colon + 1) : tri_stores[0];
    if (!out->store)
        return fail(reason, STATUS_INPUT, "trial: unknown storage '%s'", colon + 1);
    if (colon)
        *colon = '\0';
    out->layout = layout_find(field[2]);
    out->builder = builder_find(field[3]);
    out->box = box_test_find(field[4]);
    if (!out->layout)
        return fail(reason, STATUS_INPUT, "trial: unknown layout '%s'", field[2]);
    if (!out->builder)
        return fail(reason, STATUS_INPUT, "trial: unknown builder '%s'", field[3]);
    if (!out->box)
        return fail(reason, STATUS_INPUT, "trial: unknown box test '%s'", field[4]);
    return STATUS_OK;
}

enum status trial_parse(const char *name, struct trial *out, struct reason *reason)
{
    char text[TRIAL_NAME_MOST];
    char *field[6], *rest = text;
    *out = (struct trial){0};
    if (strlen(name) >= sizeof text)
        return fail(reason, STATUS_INPUT, "trial: a name has at most %d characters",
                    TRIAL_NAME_MOST - 1);
    strcpy(text, name);
    for (int i = 0; i < 6; i++)
        field[i] = i == 1 ? cut_engine(&rest) : cut_first(&rest);
    char *seed = cut_last(rest);
    char *rays = seed ? cut_last(rest) : NULL;
    if (!rays || *rest == '\0' || strlen(rest) >= sizeof out->scene)
        return fail(reason, STATUS_INPUT,
                    "trial: '%s' is not query.engine.layout.builder.box.tri.scene.rays.seed", name);
    char *end = NULL;
    out->seed = strtoull(seed, &end, 10);
    if (end == seed || *end != '\0')
        return fail(reason, STATUS_INPUT, "trial: seed '%s' is not a number", seed);
    out->rays = ray_set_find(rays);
    if (!out->rays)
        return fail(reason, STATUS_INPUT, "trial: unknown ray set '%s'", rays);
    strcpy(out->scene, rest);
    return parse_fields(field, out, reason);
}

static void drop_match(struct trial_stage *stage)
{
    if (stage->has_match)
        match_free(&stage->match);
    stage->has_match = false;
}

static void drop_scene(struct trial_stage *stage)
{
    drop_match(stage);
    if (stage->has_scene)
        scene_free(&stage->scene);
    free(stage->ray);
    stage->ray = NULL;
    stage->has_scene = false;
}

void trial_stage_free(struct trial_stage *stage)
{
    drop_scene(stage);
    pool_free(&stage->pool);
}

static enum status set_scene(struct trial_stage *stage, const struct trial *trial,
                             struct reason *reason)
{
    if (stage->has_scene && stage->seed == trial->seed && stage->rays == trial->rays &&
        strcmp(stage->scene_spec, trial->scene) == 0)
        return STATUS_OK;
    drop_scene(stage);
    enum status status = scene_open(trial->scene, trial->seed, &stage->scene, reason);
    if (status)
        return status;
    stage->has_scene = true;
    stage->seed = trial->seed;
    stage->rays = trial->rays;
    strcpy(stage->scene_spec, trial->scene);
    status =
        ray_set_new(trial->rays, &stage->scene, trial->seed, stage->ray_count, &stage->ray, reason);
    if (status)
        drop_scene(stage);
    return status;
}

/* Makes or reuses the match of the stage's scene and rays, with the trial's builder and triangle
 * test. */
static enum status set_match(struct trial_stage *stage, const struct trial *trial,
                             struct reason *reason)
{
    const struct builder *builder = trial->builder ? trial->builder : builders[0];
    const struct box_test *box = trial->box ? trial->box : box_tests[0];
    const struct build_options build = {.leaf = BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT};
    enum status status = STATUS_OK;
    if (stage->has_match) { /* the truth depends on scene and rays only, so it is reused */
        if (stage->match.options.builder != builder || stage->match.options.tri != trial->tri)
            status = match_rebuild(&stage->match, builder, &build, trial->tri, reason);
        if (status)
            drop_match(stage);
        else
            match_set(&stage->match, box, trial->query);
        return status;
    }
    struct match_options options = {
        .builder = builder,
        .build = build,
        .box = box,
        .tri = trial->tri,
        .query = trial->query,
        .repeats = 1,
        .brute_budget = stage->brute_budget,
        .demands = stage->demands,
    };
    status = match_make(&stage->scene, stage->ray, stage->ray_count, &options, &stage->pool,
                        &stage->match, reason);
    stage->has_match = status == STATUS_OK;
    return status;
}

enum status trial_stage_run(struct trial_stage *stage, const struct trial *trial, struct row *row,
                            struct reason *reason)
{
    *row = (struct row){.engine = trial->engine, .layout = trial->layout};
    enum status status = set_scene(stage, trial, reason);
    if (status)
        return status;
    status = set_match(stage, trial, reason);
    bool packed = status == STATUS_OK && stage->match.packed.layout == trial->layout &&
                  stage->match.packed.store == trial->store;
    if (status == STATUS_OK && trial->layout && !packed) {
        stage->match.options.store = trial->store;
        status = match_pack(&stage->match, trial->layout, reason);
    }
    if (status == STATUS_LIMIT || status == STATUS_UNSUPPORTED) { /* no device to build on */
        row->status = status == STATUS_LIMIT ? ROW_REFUSED : ROW_SKIPPED;
        row->cause = status;
        row->reason = *reason;
        return STATUS_OK;
    }
    if (status)
        return status;
    match_run(&stage->match, trial->engine, row);
    return STATUS_OK;
}
