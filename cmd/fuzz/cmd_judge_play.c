/* Judging of recorded answers as a row of raydiff check. */
#include "cmd/fuzz/cmd_judge.h"

#include "ref/base/command.h"
#include "ref/outside/recorded.h"

#include <stdlib.h>

static enum status play(struct judge_run *j, struct row *row, struct reason *reason)
{
    const struct pipe_text *a = &j->answer;
    const struct check_subject *of = &j->of;
    struct recorded recorded = {.ray = j->request.ray,
                                .mode = j->request.mode,
                                .hit = a->hit,
                                .tag = a->tag,
                                .count = a->hit_count,
                                .formula = a->formula,
                                .rounding = a->rounding,
                                .flags = a->flags};
    struct match_options options = {.builder = builders[0],
                                    .build = build_options_default(),
                                    .box = box_tests[0],
                                    .tri = tri_tests[0],
                                    .query = j->request.query,
                                    .demands = j->options->demands,
                                    .repeats = 1,
                                    .brute_budget = j->options->brute};
    struct pool pool = {.options = engine_options_default()};
    struct match match;
    const struct engine *engine;
    enum status status = recorded_engine(&recorded, &engine, reason);
    if (!status)
        status = of->is_world
                     ? match_make_world(&of->world, j->request.ray, j->request.mode,
                                        j->request.ray_count, &options, &pool, &match, reason)
                     : match_make(&of->scene, j->request.ray, j->request.ray_count, &options, &pool,
                                  &match, reason);
    if (status) {
        pool_free(&pool);
        return status;
    }
    match_run(&match, engine, row);
    if (j->options->demands.displacement > 0.0f && !row->unknown)
        status = fail(reason, STATUS_INPUT, "--displacement: the formula is known");
    for (int i = 0; i < 3; i++)
        row->mrays[i] = 0; /* nothing was traced */
    pool_free(&pool);
    match_free(&match);
    return status;
}

/* Judges and prints; returns the exit code. */
static int judge_all(struct judge_run *j)
{
    struct row row;
    struct reason reason = {""};
    struct check_scene result = {.spec = j->spec,
                                 .tri_count = j->of.scene.tri_count,
                                 .vertex_count = j->of.scene.vertex_count,
                                 .modes = j->modes,
                                 .rays = j->ray_name,
                                 .ray_count = j->request.ray_count,
                                 .seed = j->seed,
                                 .row = &row,
                                 .row_count = 1};
    if (j->of.is_world)
        check_describe(&j->of.world, &result);
    enum status status = result.vacuous ? fail(&reason, STATUS_INPUT, "%s: " CHECK_VACUOUS, j->spec)
                                        : play(j, &row, &reason);
    const bool judged = status == STATUS_OK;
    int code = EXIT_AGREE;
    if (!status) {
        const struct screen screen = screen_make(&j->options->screen);
        check_print(&result, &screen);
        code = check_exit(&result, false, true);
    }
    if (!status && j->options->json)
        status = check_write_json(j->options->json, &result, 1, &(struct turnout){.count = 0}, code,
                                  &reason);
    code = exit_worse(code, exit_with_reason(j->command, status, &reason));
    if (judged) {
        const struct screen screen = screen_make(&j->options->screen);
        check_print_conclusion(&result, 1, code, &screen);
    }
    return code;
}

int judge_finish(struct judge_run *j, enum status status, const struct reason *reason)
{
    int code = exit_with_reason(j->command, status, reason);
    if (!status)
        code = judge_all(j);
    check_close(&j->of);
    pipe_text_free(&j->request);
    pipe_text_free(&j->answer);
    return code;
}
