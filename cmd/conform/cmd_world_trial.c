#include "cmd/conform/cmd_world_trial.h"

#include "ref/base/text.h"
#include "ref/world/bake.h"
#include "scenes/rays/rays.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void print_two(const char *top, const char *bottom, char text[WORLD_FIELD_MOST])
{
    if (!bottom)
        snprintf(text, WORLD_FIELD_MOST, "-");
    else if (!top || strcmp(top, bottom) == 0)
        snprintf(text, WORLD_FIELD_MOST, "%s", bottom);
    else
        snprintf(text, WORLD_FIELD_MOST, "%s/%s", top, bottom);
}

void world_trial_field(const struct world_trial *trial, enum world_field field,
                       char text[WORLD_FIELD_MOST])
{
    const struct world_trial *t = trial;
    if (field == WORLD_FIELD_LAYOUT)
        print_two(t->top_layout ? t->top_layout->name : NULL, t->layout ? t->layout->name : NULL,
                  text);
    else if (field == WORLD_FIELD_BUILDER)
        print_two(t->top_builder ? t->top_builder->name : NULL,
                  t->builder ? t->builder->name : NULL, text);
    else
        snprintf(text, WORLD_FIELD_MOST, "%s",
                 field == WORLD_FIELD_QUERY    ? query_name(t->query)
                 : field == WORLD_FIELD_ENGINE ? t->engine->name
                 : field == WORLD_FIELD_BOX    ? (t->box ? t->box->name : "-")
                 : field == WORLD_FIELD_TRI
                     ? t->tri->name
                     : composed_name((enum composed_axis)(field - WORLD_FIELD_OF),
                                     t->of.member[field - WORLD_FIELD_OF]));
}

void world_trial_print(const struct world_trial *trial, char name[WORLD_NAME_MOST])
{
    snprintf(name, WORLD_NAME_MOST, "world");
    for (int f = 0; f < WORLD_FIELDS; f++) {
        char field[WORLD_FIELD_MOST];
        world_trial_field(trial, (enum world_field)f, field);
        text_append(name, WORLD_NAME_MOST, ".%s", field);
    }
    text_append(name, WORLD_NAME_MOST, ".%llu", (unsigned long long)trial->seed);
}

/* --- parsing ---------------------------------------------------------------------------------- */

/* Cuts "TOP/BOTTOM"; *top is "" if there is one alone. */
static char *cut_two(char *field, char **top)
{
    char *slash = strchr(field, '/');
    *top = slash ? field : field + strlen(field);
    if (!slash)
        return field;
    *slash = '\0';
    return slash + 1;
}

static enum status parse_tree(char *const field[WORLD_FIELDS], struct world_trial *out,
                              struct reason *reason)
{
    char *top_layout, *top_builder;
    const char *layout = cut_two(field[WORLD_FIELD_LAYOUT], &top_layout);
    const char *builder = cut_two(field[WORLD_FIELD_BUILDER], &top_builder);
    if (!out->engine->needs_packed) {
        for (int f = WORLD_FIELD_LAYOUT; f <= WORLD_FIELD_BOX; f++)
            if (strcmp(field[f], "-") != 0)
                return fail(reason, STATUS_INPUT, "trial: engine %s takes '-', not '%s'",
                            out->engine->name, field[f]);
        return STATUS_OK;
    }
    out->layout = layout_find(layout);
    out->top_layout = *top_layout ? layout_find(top_layout) : NULL;
    out->builder = builder_find(builder);
    out->top_builder = *top_builder ? builder_find(top_builder) : NULL;
    out->box = box_test_find(field[WORLD_FIELD_BOX]);
    if (!out->layout || (*top_layout && !out->top_layout))
        return fail(reason, STATUS_INPUT, "trial: unknown layout '%s'",
                    out->layout ? top_layout : layout);
    if (!out->builder || (*top_builder && !out->top_builder))
        return fail(reason, STATUS_INPUT, "trial: unknown builder '%s'",
                    out->builder ? top_builder : builder);
    if (!out->box)
        return fail(reason, STATUS_INPUT, "trial: unknown box test '%s'", field[WORLD_FIELD_BOX]);
    return STATUS_OK;
}

static enum status parse_fields(char *const field[WORLD_FIELDS], struct world_trial *out,
                                struct reason *reason)
{
    if (!query_find(field[WORLD_FIELD_QUERY], &out->query))
        return fail(reason, STATUS_INPUT, "trial: unknown query '%s'", field[WORLD_FIELD_QUERY]);
    out->engine = engine_find(field[WORLD_FIELD_ENGINE]);
    if (!out->engine)
        return fail(reason, STATUS_INPUT, "trial: unknown engine '%s'", field[WORLD_FIELD_ENGINE]);
    out->tri = tri_test_find(field[WORLD_FIELD_TRI]);
    if (!out->tri)
        return fail(reason, STATUS_INPUT, "trial: unknown triangle test '%s'",
                    field[WORLD_FIELD_TRI]);
    for (int a = 0; a < COMPOSED_AXES; a++) {
        struct reason why;
        if (composed_find((enum composed_axis)a, field[WORLD_FIELD_OF + a], &out->of.member[a],
                          &why))
            return fail(reason, STATUS_INPUT, "trial: %s", why.text);
    }
    return parse_tree(field, out, reason);
}

/* Cuts a name at its dots, but for those of the engine, which may be a command: fields before it
 * are counted from the front, those behind it from the end. Returns the dot of the seed, which is
 * cut off, or NULL. */
static char *cut_fields(char *text, char *field[WORLD_FIELDS])
{
    char *at = text, *seed = NULL;
    for (int f = 0; f <= WORLD_FIELD_ENGINE; f++) {
        at = strchr(at, '.');
        if (!at)
            return NULL;
        *at++ = '\0';
        field[f] = at;
    }
    for (int f = WORLD_FIELDS; f > WORLD_FIELD_ENGINE; f--) {
        char *dot = strrchr(at, '.');
        if (!dot)
            return NULL;
        *dot = '\0';
        if (f == WORLD_FIELDS)
            seed = dot;
        else
            field[f] = dot + 1;
    }
    return seed;
}

enum status world_trial_parse(const char *name, struct world_trial *out, struct reason *reason)
{
    static const char shape[] = "world.query.engine.layout.builder.box.tri.transform.masks.flags."
                                "geometry.filter.rays.count.seed";
    char text[WORLD_NAME_MOST], *field[WORLD_FIELDS], *at = text, *end = NULL;
    *out = (struct world_trial){0};
    if (strlen(name) >= sizeof text)
        return fail(reason, STATUS_INPUT, "trial: a name has at most %d characters",
                    WORLD_NAME_MOST - 1);
    strcpy(text, name);
    at = cut_fields(text, field);
    if (!at)
        return fail(reason, STATUS_INPUT, "trial: '%s' is not %s, as --worlds --list prints", name,
                    shape);
    out->seed = strtoull(at + 1, &end, 10);
    if (end == at + 1 || *end != '\0')
        return fail(reason, STATUS_INPUT, "trial: seed '%s' is not a number", at + 1);
    return parse_fields(field, out, reason);
}

/* --- running ---------------------------------------------------------------------------------- */

static void drop(struct world_stage *stage)
{
    if (stage->has_match)
        match_free(&stage->match);
    world_free(&stage->world);
    free(stage->ray);
    free(stage->mode);
    stage->ray = NULL;
    stage->mode = NULL;
    stage->has_match = false;
}

void world_stage_free(struct world_stage *stage)
{
    drop(stage);
    pool_free(&stage->pool);
}

/* Rays are aimed at the placed triangles as float32 has them. */
static enum status aim(struct world_stage *stage, struct reason *reason)
{
    struct scene baked;
    enum status status = world_bake(&stage->world, 1u << 20, &baked, reason);
    if (status)
        return status;
    status = ray_set_new(ray_sets[0], &baked, stage->seed, stage->ray_count, &stage->ray, reason);
    scene_free(&baked);
    stage->mode = alloc_zeroed(stage->ray_count, sizeof *stage->mode);
    if (!status && !stage->mode)
        status = fail(reason, STATUS_MEMORY, "no memory for %zu rays", stage->ray_count);
    if (!status)
        composed_modes(&stage->of, stage->seed, stage->ray_count, stage->mode);
    return status;
}

static struct match_options options_of(const struct world_stage *stage,
                                       const struct world_trial *trial)
{
    return (struct match_options){
        .builder = trial->builder ? trial->builder : builders[0],
        .build = {.leaf = BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT},
        .top_builder = trial->top_builder,
        .top_layout = trial->top_layout,
        .box = trial->box ? trial->box : box_tests[0],
        .tri = trial->tri,
        .query = trial->query,
        .repeats = 1,
        .brute_budget = stage->brute_budget,
    };
}

/* Makes world, rays and truth, or keeps them; then the trees of this trial. */
static enum status set(struct world_stage *stage, const struct world_trial *trial,
                       struct reason *reason)
{
    const struct match_options options = options_of(stage, trial);
    if (stage->has_match && stage->seed == trial->seed &&
        memcmp(&stage->of, &trial->of, sizeof stage->of) == 0) {
        struct match_options *now = &stage->match.options;
        now->top_builder = options.top_builder;
        now->top_layout = options.top_layout;
        match_set(&stage->match, options.box, options.query);
        return match_rebuild(&stage->match, options.builder, &options.build, options.tri, reason);
    }
    drop(stage);
    stage->of = trial->of;
    stage->seed = trial->seed;
    enum status status = composed_make(&trial->of, trial->seed, &stage->world, reason);
    if (!status)
        status = aim(stage, reason);
    if (!status)
        status = match_make_world(&stage->world, stage->ray, stage->mode, stage->ray_count,
                                  &options, &stage->pool, &stage->match, reason);
    stage->has_match = !status;
    return status;
}

enum status world_stage_run(struct world_stage *stage, const struct world_trial *trial,
                            struct row *row, struct reason *reason)
{
    *row = (struct row){.engine = trial->engine, .layout = trial->layout};
    enum status status = set(stage, trial, reason);
    if (!status && trial->layout)
        status = match_pack(&stage->match, trial->layout, reason);
    if (status == STATUS_LIMIT) {
        row->status = ROW_REFUSED;
        row->cause = status;
        row->reason = *reason;
        return STATUS_OK;
    }
    if (!status)
        match_run(&stage->match, trial->engine, row);
    return status;
}
