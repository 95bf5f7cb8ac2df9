#include "tests/shader_mutants/mutant_cases.h"

#include "ref/store.h"
#include "tests/shader_mutants/spirv_live.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RAYS 1000 /* as raydiff conform */

/* --- pipelines -------------------------------------------------------------------------------- */

static enum status pipeline_of(struct mutant_cases *cases, const uint32_t *constant, size_t *out,
                               struct reason *reason)
{
    struct mutant_pipeline one;
    memcpy(one.constant, constant, sizeof one.constant);
    for (*out = 0; *out < cases->pipeline_count; ++*out)
        if (memcmp(cases->pipeline[*out].constant, constant, sizeof one.constant) == 0)
            return STATUS_OK;
    one.live = alloc_zeroed(cases->code->count, sizeof *one.live);
    if (!one.live || array_reserve(&cases->pipeline, &cases->pipeline_capacity,
                                   cases->pipeline_count + 1, sizeof one))
        return fail(reason, STATUS_MEMORY, "no memory for pipelines");
    enum status status = spirv_live(cases->code, constant, DISPATCH_CONSTANTS, one.live, reason);
    if (!status)
        cases->pipeline[cases->pipeline_count++] = one;
    return status;
}

static void constants_of(const struct mutant_case *one, uint32_t constant[DISPATCH_CONSTANTS])
{
    const struct trial *t = &one->trial;
    const struct hard_member *m = &one->member;
    const struct box_test *box = one->hard ? m->box : t->box;
    const struct layout *layout = one->hard ? m->layout : t->layout;
    memset(constant, 0, DISPATCH_CONSTANTS * sizeof *constant);
    constant[ABI_SPEC_BOX] = box ? (uint32_t)box->id : (uint32_t)ABI_BOX_ROBUST;
    constant[ABI_SPEC_TRI] = (uint32_t)(one->hard ? m->tri->id : t->tri->id);
    constant[ABI_SPEC_QUERY] = (uint32_t)(one->hard ? m->query : t->query);
    constant[ABI_SPEC_STORE] = !one->hard && t->store ? (uint32_t)t->store->id : 0;
    constant[ABI_SPEC_LAYOUT_0] = layout ? layout->constant[0] : 0;
    constant[ABI_SPEC_LAYOUT_1] = layout ? layout->constant[1] : 0;
}

static enum status add_case(struct mutant_cases *cases, struct mutant_case *one,
                            struct reason *reason)
{
    uint32_t constant[DISPATCH_CONSTANTS];
    constants_of(one, constant);
    enum status status = pipeline_of(cases, constant, &one->pipeline, reason);
    if (!status &&
        array_reserve(&cases->one, &cases->capacity, cases->count + 1, sizeof *cases->one))
        status = fail(reason, STATUS_MEMORY, "no memory for cases");
    if (!status)
        cases->one[cases->count++] = *one;
    return status;
}

/* --- trials ----------------------------------------------------------------------------------- */

static const struct engine *prepared_by(const struct mutant_cases *cases)
{
    return engine_reference(cases->engine->needs_packed);
}

static enum status add_trial(struct mutant_cases *cases, const struct trial *trial,
                             struct reason *reason)
{
    struct mutant_case one = {.trial = *trial, .stage = cases->trial_count};
    struct trial_stage *stage = alloc_zeroed(1, sizeof *stage);
    struct trial first = *trial;
    struct row row;
    char name[TRIAL_NAME_MOST];
    if (!stage || array_reserve(&cases->trial, &cases->trial_capacity, cases->trial_count + 1,
                                sizeof *cases->trial))
        return fail(reason, STATUS_MEMORY, "no memory for trials");
    stage->pool.options = (struct engine_options){.device = -1, .threads = 1};
    stage->ray_count = RAYS;
    first.engine = prepared_by(cases);
    enum status status = trial_stage_run(stage, &first, &row, reason);
    if (status)
        return status;
    if (row.status == ROW_REFUSED || row.status == ROW_SKIPPED) {
        trial_stage_free(stage);
        free(stage);
        return STATUS_OK;
    }
    cases->trial[cases->trial_count++] = stage;
    trial_print(trial, name);
    snprintf(one.name, sizeof one.name, "%.150s", name);
    return add_case(cases, &one, reason);
}

/* Whether the engine's module for the layout is this shader. */
static bool uses(const struct mutant_cases *cases, const struct layout *layout)
{
    const char *name = strchr(cases->shader->name, '_') + 1;
    return cases->engine->needs_packed && !layout->outside &&
           strcmp(layout_shader(layout), name) == 0;
}

static struct list layouts_of(const struct mutant_cases *cases)
{
    struct list list = {.count = 0};
    for (size_t l = 0; layouts_all[l]; l++)
        if (uses(cases, layouts_all[l]))
            list.index[list.count++] = l;
    return list;
}

static enum status add_suite(struct mutant_cases *cases, struct suite *suite, size_t most,
                             struct reason *reason)
{
    suite->list[TABLE_ENGINES] = list_of_one(TABLE_ENGINES, cases->engine);
    if (cases->engine->needs_packed)
        suite->list[TABLE_LAYOUTS] = layouts_of(cases);
    enum status status = suite_make(suite, reason);
    for (size_t i = 0; i < suite->count && i < most && !status; i++)
        status = add_trial(cases, &suite->trial[i], reason);
    suite_free(suite);
    return status;
}

/* conform --engine E --layout L; the same with --store every --box robust;
 * conform 'all.E.L.median.robust.*.soup.mixed.1', which lists. */
static enum status add_trials(struct mutant_cases *cases, bool quick, struct reason *reason)
{
    struct suite suite = {.kind = SUITE_COVERING};
    char pattern[96];
    const bool tree = cases->engine->needs_packed;
    enum status status = add_suite(cases, &suite, quick ? 4 : SIZE_MAX, reason);
    if (status || quick)
        return status;
    if (tree) {
        suite = (struct suite){.kind = SUITE_COVERING};
        suite.list[TABLE_STORES] = table_all(TABLE_STORES);
        suite.list[TABLE_BOX_TESTS] = list_of_one(TABLE_BOX_TESTS, box_test_find("robust"));
        status = add_suite(cases, &suite, SIZE_MAX, reason);
    }
    for (size_t l = 0; layouts_all[l] && !status; l++) {
        if (tree ? !uses(cases, layouts_all[l]) : l > 0)
            continue;
        snprintf(pattern, sizeof pattern, "all.%s.%s.*.soup.mixed.1", cases->engine->name,
                 tree ? layouts_all[l]->name : "-.-.-");
        if (tree)
            snprintf(pattern, sizeof pattern, "all.%s.%s.median.robust.*.soup.mixed.1",
                     cases->engine->name, layouts_all[l]->name);
        suite = (struct suite){.kind = SUITE_PATTERN, .pattern = pattern};
        status = add_suite(cases, &suite, SIZE_MAX, reason);
    }
    return status;
}

/* --- hard cases ------------------------------------------------------------------------------- */

struct hard_adding {
    struct mutant_cases *cases;
    size_t most, count;
    enum status status;
    struct reason *reason;
};

/* The stage of a case, with its truth. */
static enum status stage_of(struct mutant_cases *cases, const struct hard_case *one, size_t *out,
                            struct reason *reason)
{
    const struct engine_options options = {.device = -1, .threads = 1};
    struct hard_result unused;
    for (*out = 0; *out < cases->hard_count; ++*out)
        if (cases->hard[*out]->one == one)
            return STATUS_OK;
    struct hard_stage *stage = alloc_zeroed(1, sizeof *stage);
    if (!stage || array_reserve(&cases->hard, &cases->hard_capacity, cases->hard_count + 1,
                                sizeof *cases->hard))
        return fail(reason, STATUS_MEMORY, "no memory for hard cases");
    *stage = hard_stage_make(&options);
    cases->hard[cases->hard_count++] = stage;
    const struct hard_member first = {.engine = engine_find("brute"), .tri = tri_test_find("mt")};
    return hard_run(stage, one, &first, &unused, reason);
}

static void take_member(void *user, const struct hard_case *one, const struct hard_member *member)
{
    struct hard_adding *adding = user;
    struct mutant_cases *cases = adding->cases;
    struct mutant_case c = {.hard = one, .member = *member};
    char name[HARD_NAME_MOST];
    if (adding->status || adding->count >= adding->most || member->engine != cases->engine ||
        !member->tri->core || hard_member_published(member) > 1)
        return;
    adding->count++;
    hard_name_print(one, member, name);
    snprintf(c.name, sizeof c.name, "%.150s", name);
    adding->status = stage_of(cases, one, &c.stage, adding->reason);
    if (!adding->status)
        adding->status = add_case(cases, &c, adding->reason);
}

/* conform --hard --quick --engine E --layout L --builder median: layouts of a
 * family come by turns. */
static enum status add_hard(struct mutant_cases *cases, bool quick, struct reason *reason)
{
    const struct list layout = layouts_of(cases);
    const struct builder *const builder[] = {builder_find("median"), NULL};
    struct hard_adding adding = {.cases = cases, .most = quick ? 4 : SIZE_MAX, .reason = reason};
    for (size_t i = 0; hard_case_at(i); i++) {
        const struct hard_case *one = hard_case_at(i);
        struct hard_tables tables = hard_tables_all();
        const struct layout *of[] = {NULL, NULL};
        if (one->probe || one->driver || one->flags & HARD_WORLD)
            continue;
        if (layout.count)
            of[0] = layouts_all[layout.index[i % layout.count]];
        tables.layout = of;
        tables.builder = builder;
        tables.chosen = true;
        hard_each_member(one, &tables, take_member, &adding);
    }
    return adding.status;
}

/* --- all -------------------------------------------------------------------------------------- */

static const char *engine_of(const char *shader)
{
    if (strcmp(shader, "trace_brute") == 0)
        return "vulkan_brute";
    if (strncmp(shader, "stackless_", 10) == 0)
        return "vulkan_stackless";
    return strncmp(shader, "trace_", 6) == 0 ? "vulkan" : "";
}

enum status mutant_cases_make(const char *shader, bool quick, struct spirv_code *code,
                              struct mutant_cases *out, struct reason *reason)
{
    *out = (struct mutant_cases){
        .shader = shader_find(shader), .engine = engine_find(engine_of(shader)), .code = code};
    if (!out->shader || !out->engine)
        return fail(reason, STATUS_INPUT, "'%.60s': no shader that traces scenes", shader);
    enum status status = spirv_code_make(out->shader->word, out->shader->word_count, code, reason);
    if (!status)
        status = add_trials(out, quick, reason);
    return status ? status : add_hard(out, quick, reason);
}

static int play_trial(struct mutant_cases *cases, const struct mutant_case *one, struct pool *pool)
{
    struct trial_stage *stage = cases->trial[one->stage];
    struct reason reason;
    struct row row;
    stage->pool = *pool;
    const enum status status = trial_stage_run(stage, &one->trial, &row, &reason);
    *pool = stage->pool;
    return status ? 1000 + (int)status : 2 * (int)row.status + row_failed(&row);
}

static int play_hard(struct mutant_cases *cases, const struct mutant_case *one, struct pool *pool)
{
    struct hard_stage *stage = cases->hard[one->stage];
    struct reason reason;
    struct hard_result result;
    stage->pool = stage->many = *pool;
    const enum status status = hard_run(stage, one->hard, &one->member, &result, &reason);
    *pool = stage->pool;
    return status ? 1000 + (int)status : 100 + 2 * (int)result.outcome + result.unfinished;
}

int mutant_case_play(struct mutant_cases *cases, size_t i, struct pool *pool)
{
    const struct mutant_case *one = &cases->one[i];
    return one->hard ? play_hard(cases, one, pool) : play_trial(cases, one, pool);
}
