/* The report of raydiff diff on engines, as text and as JSON. */
#include "cmd/common/cmd_json.h"
#include "cmd/diff/cmd_diff.h"
#include "cmd/common/cmd_screen.h"
#include "ref/base/command.h"
#include "ref/base/text.h"
#include "ref/base/json_record.h"

#include <stdio.h>

void diff_print_subject(const struct diff_run *run)
{
    const struct render_settings *settings = &run->options->settings;
    const struct frame_job *job = &run->stage.job;
    printf("%s: %s; %u x %u pixels, profile %s, %s, %s\n", settings->scene,
           COUNTED(run->stage.scene.tri_count, "triangle"), job->width, job->height,
           job->look.profile == PROFILE_RTRS ? "rtrs" : "repaired",
           COUNTED(job->look.bounces, "bounce"), COUNTED(job->light_count, "light"));
    if (run->stage.packed.layout)
        printf("tree: %s %s, layout %s, box test %s", settings->bvh ? "file" : "builder",
               settings->bvh ? settings->bvh : settings->builder->name,
               run->stage.packed.layout->name, settings->box->name);
    printf("%striangle test %s\n", run->stage.packed.layout ? ", " : "", settings->tri->name);
    for (size_t i = 0; i < run->count; i++)
        if (run->member[i].status)
            screen_line(4, "left out: %s\n", run->member[i].reason.text);
}

/* Prints the count of every class, also if it is 0: "tie 3, near_tie 0, ...". */
static void print_whys(const struct pair *pair)
{
    size_t fine = 0;
    for (enum why why = WHY_SAME; !why_is_fault(why); why++)
        fine += pair->why[why];
    char line[600];
    snprintf(line, sizeof line,
             "  explained   %zu of %zu pixels: same path %zu, rounding %zu, drift %zu", fine,
             pair->asked, pair->why[WHY_SAME], pair->why[WHY_ROUNDING], pair->why[WHY_DRIFT]);
    for (enum verdict verdict = VERDICT_TIE; verdict < VERDICT_WRONG; verdict++)
        text_append(line, sizeof line, ", %s %zu", verdict_name(verdict), pair->verdict[verdict]);
    screen_line(14, "%s, wrong as published %zu\n", line, pair->why[WHY_PUBLISHED]);
    screen_line(14,
                "  faults      wrong answer %zu, picture not of its rays %zu, unexplained %zu; "
                "err/E at most %.3g\n",
                pair->why[WHY_WRONG], pair->why[WHY_RENDERER], pair->why[WHY_UNEXPLAINED],
                pair->over);
}

static const char *class_of(const struct path_why *why)
{
    return why->why == WHY_ALLOWED ? verdict_name(why->verdict) : why_name(why->why);
}

/* Prints one pixel. For wrong answers, also prints the ray and the command. */
static void print_pixel(const struct diff_run *run, const struct diff_member *member,
                        const struct pixel_why *found)
{
    const struct path_why *why = &found->why;
    const struct diff_member *side[2] = {&run->member[run->reference], member};
    uint32_t width = run->stage.job.width;
    printf("  pixel %zu,%zu %s: values differ by %u", found->pixel % width, found->pixel / width,
           class_of(why), found->apart);
    if (found->field != PATH_SAME)
        printf("; pictures part at segment %u (%s)", found->segment, path_field_name(found->field));
    if (why->why > WHY_ROUNDING && why->why != WHY_RENDERER) {
        printf("; rays at segment %u", why->segment);
        if (why->light != WHY_NO_LIGHT)
            printf(", light %u", why->light);
    }
    if (why->why == WHY_RENDERER || why->why == WHY_WRONG || why->why == WHY_PUBLISHED ||
        why->why == WHY_ALLOWED)
        printf(", of %s", side[why->side]->engine->name);
    putchar('\n');
    for (unsigned i = 0; i < 2; i++) {
        const struct why_answer *answer = &why->answer[i];
        char line[512], command[EXPLAIN_COMMAND_MOST];
        if (!answer->judged || answer->judgement.verdict != VERDICT_WRONG)
            continue;
        judge_line(&answer->ray, &answer->judgement, &answer->hit, line, sizeof line);
        diff_explain(run, side[i], why->light != WHY_NO_LIGHT, &answer->ray, command);
        screen_line(6, "    WRONG %s %s %s\n", wrong_name(answer->judgement.wrong),
                    side[i]->engine->name, line);
        printf("    explain: %s\n", command);
    }
}

static void print_pixel_command(const struct diff_run *run, size_t pixel)
{
    uint32_t width = run->stage.job.width;
    printf("  look: %s --pixel %zu,%zu\n", run->command, pixel % width, pixel / width);
}

static void print_pair(const struct diff_run *run, const struct diff_member *member)
{
    const struct pair *pair = &member->pair;
    const struct frame_diff *diff = &pair->diff;
    const struct diff_member *reference = &run->member[run->reference];
    uint64_t list = run->options->list;
    printf("\n%s against %s: %s\n", member->engine->name, reference->engine->name,
           pair->same_bits ? "the same bits are demanded" : "each difference is to be explained");
    printf("  paths       %zu of %zu differ\n", diff->paths_apart, diff->paths);
    screen_line(
        14, "  segments    %zu, different in triangle %zu, t %zu, lights asked %zu, shadows %zu\n",
        diff->segments, diff->field[PATH_PRIM], diff->field[PATH_T], diff->field[PATH_ASKED],
        diff->field[PATH_SHADOWED]);
    screen_line(
        14,
        "  values      %zu of %zu pixels differ, by %u at most; same path: %zu within the bound "
        "of a rounding border, %zu not\n",
        diff->colours, diff->paths, diff->largest, diff->allowed, pair->bounded ? diff->excess : 0);
    print_whys(pair);
    for (size_t i = 0; i < pair->border_count && i < list; i++) {
        const struct pixel_border *border = &pair->border[i];
        const uint32_t *value = border->value;
        printf("  pixel %zu,%zu border: rgb %u %u %u and %u %u %u, bound %.3g of a step\n",
               border->pixel % run->stage.job.width, border->pixel / run->stage.job.width,
               value[0] & 255u, value[0] >> 8 & 255u, value[0] >> 16 & 255u, value[1] & 255u,
               value[1] >> 8 & 255u, value[1] >> 16 & 255u, (double)border->bound);
    }
    const struct pixel_why *worst = NULL;
    for (enum why why = WHY_COUNT; why-- > WHY_SAME;)
        for (size_t i = 0; i < pair->why[why] && i < list; i++) {
            worst = worst ? worst : &pair->example[why][i];
            print_pixel(run, member, &pair->example[why][i]);
        }
    if (worst)
        print_pixel_command(run, worst->pixel);
    printf("  %s\n", diff_is_vacuous(pair) ? "vacuous: no path of either hits a triangle"
                     : pair_agrees(pair)   ? "as it should be"
                                           : "DIFFERS");
}

bool diff_is_vacuous(const struct pair *pair)
{
    return pair_agrees(pair) && pair->diff.hits == 0;
}

void diff_print(const struct diff_run *run)
{
    diff_print_subject(run);
    for (size_t i = run->reference + 1; i < run->count; i++)
        if (!run->member[i].status)
            print_pair(run, &run->member[i]);
}

void diff_print_conclusion(const struct diff_run *run)
{
    size_t pairs = 0, agree = 0;
    for (size_t i = run->reference + 1; i < run->count; i++) {
        const struct diff_member *member = &run->member[i];
        pairs += member->status == STATUS_OK;
        agree += !member->status && pair_agrees(&member->pair) && !diff_is_vacuous(&member->pair);
    }
    screen_line(4, "conclusion: %zu of %zu comparison%s with %s as it should be\n", agree, pairs,
                plural(pairs), run->member[run->reference].engine->name);
}

static json_t *answer_json(const struct diff_run *run, const struct diff_member *member,
                           const struct path_why *why, unsigned side)
{
    const struct why_answer *answer = &why->answer[side];
    char command[EXPLAIN_COMMAND_MOST];
    if (!answer->judged)
        return json_null();
    diff_explain(run, member, why->light != WHY_NO_LIGHT, &answer->ray, command);
    return json_record(
        "engine=%s answer=%p verdict=%s wrong=%s expected=%p t_lo=%g t_hi=%g explain=%s",
        member->engine->name, json_hit(&answer->hit), verdict_name(answer->judgement.verdict),
        wrong_name(answer->judgement.wrong), json_prim(answer->judgement.expected),
        answer->judgement.t_lo, answer->judgement.t_hi, command);
}

static json_t *pixels_json(const struct diff_run *run, const struct diff_member *member,
                           const struct pixel_why *found, size_t count)
{
    json_t *out = json_array();
    uint32_t width = run->stage.job.width;
    for (size_t i = 0; i < count && i < PAIR_KEPT; i++) {
        const struct path_why *why = &found[i].why;
        json_array_append_new(
            out,
            json_record(
                "x=%zu y=%zu class=%s value_difference=%u picture_field=%s picture_segment=%u "
                "segment=%u light=%p answers=%p",
                found[i].pixel % width, found[i].pixel / width, class_of(why), found[i].apart,
                path_field_name(found[i].field), found[i].segment, why->segment,
                why->light == WHY_NO_LIGHT ? json_null() : json_integer((json_int_t)why->light),
                json_pack("[o, o]", answer_json(run, &run->member[run->reference], why, 0),
                          answer_json(run, member, why, 1))));
    }
    return out;
}

static json_t *borders_json(const struct diff_run *run, const struct pair *pair)
{
    json_t *out = json_array();
    uint32_t width = run->stage.job.width;
    for (size_t i = 0; i < pair->border_count; i++)
        json_array_append_new(
            out, json_record("x=%zu y=%zu values=%p bound=%g", pair->border[i].pixel % width,
                             pair->border[i].pixel / width,
                             json_pack("[I, I]", (json_int_t)pair->border[i].value[0],
                                       (json_int_t)pair->border[i].value[1]),
                             (double)pair->border[i].bound));
    return out;
}

static json_t *pair_json(const struct diff_run *run, const struct diff_member *member)
{
    const struct pair *pair = &member->pair;
    const struct frame_diff *diff = &pair->diff;
    json_t *why = json_object(), *verdicts = json_object();
    for (enum why i = WHY_SAME; i < WHY_COUNT; i++)
        json_add(why, "%s=%zu", why_name(i), pair->why[i]);
    for (enum verdict i = VERDICT_TIE; i < VERDICT_WRONG; i++)
        json_add(verdicts, "%s=%zu", verdict_name(i), pair->verdict[i]);
    json_t *out =
        json_record("engine=%s reference=%s same_bits_demanded=%i agrees=%i vacuous=%i paths=%zu "
                    "paths_different=%zu segments=%zu triangle=%zu t=%zu asked=%zu shadowed=%zu "
                    "values_different=%zu largest=%u at_a_border=%zu beyond_the_bound=%zu "
                    "to_explain=%zu why=%p allowed=%p err_over_bound=%g borders=%p",
                    member->engine->name, run->member[run->reference].engine->name, pair->same_bits,
                    pair_agrees(pair) && !diff_is_vacuous(pair), diff_is_vacuous(pair), diff->paths,
                    diff->paths_apart, diff->segments, diff->field[PATH_PRIM], diff->field[PATH_T],
                    diff->field[PATH_ASKED], diff->field[PATH_SHADOWED], diff->colours,
                    diff->largest, diff->allowed, pair->bounded ? diff->excess : 0, pair->asked,
                    why, verdicts, pair->over, borders_json(run, pair));
    json_t *pixels = json_object();
    for (enum why i = WHY_SAME; i < WHY_COUNT; i++)
        json_add(pixels, "%s=%p", why_name(i),
                 pixels_json(run, member, pair->example[i], pair->why[i]));
    json_add(out, "pixels=%p", pixels);
    return out;
}

json_t *diff_subject_json(const struct diff_run *run, int exit_code)
{
    const struct render_settings *settings = &run->options->settings;
    const struct frame_job *job = &run->stage.job;
    json_t *skipped = json_array();
    for (size_t i = 0; i < run->count; i++)
        if (run->member[i].status)
            json_array_append_new(skipped,
                                  json_record("engine=%s reason=%s", run->member[i].engine->name,
                                              run->member[i].reason.text));
    return json_record("raydiff=%s exit=%d scene=%s triangles=%u width=%u height=%u profile=%s "
                       "bounces=%u lights=%u layout=%p tri=%s left_out=%p",
                       RAYDIFF_VERSION, exit_code, settings->scene, run->stage.scene.tri_count,
                       job->width, job->height,
                       job->look.profile == PROFILE_RTRS ? "rtrs" : "repaired", job->look.bounces,
                       job->light_count,
                       json_text(run->stage.packed.layout ? run->stage.packed.layout->name : NULL),
                       settings->tri->name, skipped);
}

enum status diff_write_json(const struct diff_run *run, int exit_code, struct reason *reason)
{
    json_t *out = diff_subject_json(run, exit_code), *pairs = json_array();
    for (size_t i = run->reference + 1; i < run->count; i++)
        if (!run->member[i].status)
            json_array_append_new(pairs, pair_json(run, &run->member[i]));
    json_add(out, "pairs=%p", pairs);
    return json_write(run->options->json, out, 17, reason);
}
