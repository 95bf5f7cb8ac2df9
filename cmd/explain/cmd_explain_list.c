#define _POSIX_C_SOURCE 200809L
#include "cmd/explain/cmd_explain_list.h"

#include "cmd/common/cmd_json.h"
#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"
#include "ref/judge/judge_all.h"
#include "ref/trace/all_hits.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* How far before a lost hit the nearest one is asked for, relative to its t. */
#define BEFORE 0x1p-11f

/* A triangle that is hit exactly, or listed, or both. */
struct list_line {
    uint32_t prim;
    bool exact; /* `pair` is its exact hit, in the ray's range */
    struct oracle_pair pair;
    struct hit hit;     /* as listed first, if `times` is not 0 */
    unsigned times;     /* that it is listed */
    bool nearest_asked; /* lost, and the engine was asked for the nearest hit from before it on: */
    bool nearest_found;
};

/* The list of one ray. */
struct shown_list {
    size_t index;
    struct list_judgement said;
    struct list_line *line; /* the exact ones by t, then the others as listed */
    size_t count, exact, listed, lost, asked, found;
};

static bool is_wrong(const struct shown_list *one)
{
    return one->said.judgement.verdict == VERDICT_WRONG;
}

static struct list_line *line_of(const struct shown_list *one, uint32_t prim)
{
    for (size_t i = 0; i < one->count; i++)
        if (one->line[i].prim == prim)
            return &one->line[i];
    return NULL;
}

/* Sets exact and listed hits side by side. */
static enum status put_together(const struct explain_lists *l, const struct hit *hit, size_t listed,
                                struct shown_list *one, struct reason *reason)
{
    struct oracle_crossing *crossing = NULL;
    size_t capacity = 0, exact = 0;
    enum status status = oracle_crossings(l->oracle, &l->ray[one->index], INFINITY, &crossing,
                                          &capacity, &exact, reason);
    if (!status)
        one->line = alloc_zeroed(exact + listed + 1, sizeof *one->line);
    if (!status && !one->line)
        status = fail(reason, STATUS_MEMORY, "no memory for a list of %zu hits", listed);
    for (size_t i = 0; !status && i < exact; i++)
        one->line[one->count++] =
            (struct list_line){.prim = crossing[i].prim, .exact = true, .pair = crossing[i].pair};
    for (size_t i = 0; !status && i < listed; i++) {
        struct list_line *at = line_of(one, hit[i].prim);
        if (!at) {
            at = &one->line[one->count++];
            at->prim = hit[i].prim;
        }
        if (!at->times++)
            at->hit = hit[i];
    }
    for (size_t i = 0; !status && i < exact; i++)
        one->lost += !one->line[i].times;
    one->exact = exact;
    one->listed = listed;
    free(crossing);
    return status;
}

/* Finds the list of ray `index`, or of the first from there on that is WRONG; one->index is the
 * number of rays if none is. */
static enum status find(const struct explain_lists *l, const struct judge *judge, size_t index,
                        bool this_one, struct shown_list *one, struct reason *reason)
{
    const struct engine *engine = l->options->of.engine;
    struct all_hits all = {0};
    enum status status = STATUS_OK;
    const size_t end = this_one ? index + 1 : l->count;
    bool found = false;
    for (size_t at = index; at < end && !status && !found; at += all.done) {
        status = all_hits_next(engine, l->self, l->ray + at, end - at, &all, reason);
        for (size_t i = 0; i < all.done && !status && !found; i++) {
            struct hit *hit = all.hit + all.first[i];
            const size_t listed = all.first[i + 1] - all.first[i];
            all_hits_sort(hit, listed);
            status = judge_list(judge, &l->ray[at + i], hit, listed, &one->said);
            if (status)
                status = fail(reason, status, "no memory to judge a list");
            found = !status && (this_one || is_wrong(one));
            one->index = at + i;
            if (found)
                status = put_together(l, hit, listed, one, reason);
        }
    }
    if (!found && !status)
        one->index = l->count;
    all_hits_free(&all);
    return status;
}

/* Where a ray begins for which exact hit i is the nearest: not far before it, and not before the
 * hit in front of it. */
static float start_of(const struct shown_list *one, size_t i, const struct ray *ray)
{
    const double t = one->line[i].pair.t_lo;
    double from = t - BEFORE * fabs(t);
    for (size_t k = i; k-- > 0;)
        if (one->line[k].pair.t_lo < t) {
            from = fmax(from, one->line[k].pair.t_lo / 2 + t / 2);
            break;
        }
    return fmaxf(ray->tmin, fminf((float)from, ray->tmax));
}

/* Is it hit i, or one at the same t? */
static bool is_there(const struct shown_list *one, size_t i, uint32_t prim)
{
    const struct list_line *line = line_of(one, prim);
    return line && line->exact && line->pair.t_lo <= one->line[i].pair.t_hi &&
           line->pair.t_hi >= one->line[i].pair.t_lo;
}

/* Asks for the nearest hit from just before each that is lost on: is it the list that loses it? */
static enum status ask_nearest(const struct explain_lists *l, struct shown_list *one,
                               struct reason *reason)
{
    const struct engine *engine = l->options->of.engine;
    struct job job = *l->job;
    struct trace_report report;
    job.query = QUERY_CLOSEST;
    enum status status = one->lost ? engine->prepare(l->self, &job, reason) : STATUS_OK;
    for (size_t i = 0; i < one->exact && one->lost && !status; i++) {
        struct list_line *line = &one->line[i];
        struct ray ray = l->ray[one->index];
        struct hit hit;
        if (line->times)
            continue;
        ray.tmin = start_of(one, i, &ray);
        status = engine->trace(l->self, &ray, 1, &hit, &report, reason);
        line->nearest_asked = !status;
        line->nearest_found = !status && is_there(one, i, hit.prim);
        one->asked++;
        one->found += line->nearest_found;
    }
    return status;
}

/* True if exactly those are lost that lie behind the last one listed. */
static bool ends_early(const struct shown_list *one)
{
    const size_t kept = one->exact - one->lost;
    for (size_t i = 0; i < one->exact; i++)
        if (!one->line[i].times != (i >= kept))
            return false;
    return one->lost && kept;
}

static void print_lines(FILE *out, const struct shown_list *one)
{
    fprintf(out, "  %10s  %-20s %-8s %s\n", "triangle", "exact t", "where", "listed at t");
    for (size_t i = 0; i < one->count; i++) {
        const struct list_line *line = &one->line[i];
        char t[32] = "-", listed[32] = "LOST";
        if (line->exact)
            snprintf(t, sizeof t, "%.15g", line->pair.t_lo);
        if (line->times)
            snprintf(listed, sizeof listed, "%.9g", (double)line->hit.t);
        fprintf(out, "  %10u  %-20s %-8s %s", line->prim, t,
                line->exact ? oracle_class_name(line->pair.class) : "no hit", listed);
        if (line->times > 1)
            fprintf(out, ", %u times", line->times);
        if (line->nearest_asked)
            fprintf(out, ", %s as the nearest from there on",
                    line->nearest_found ? "found" : "lost");
        putc('\n', out);
    }
}

static void print_verdict(FILE *out, const struct list_judgement *said)
{
    const struct judgement *judgement = &said->judgement;
    if (judgement->verdict != VERDICT_WRONG) {
        fprintf(out, "verdict   %s%s\n", judgement->verdict == VERDICT_RIGHT ? "" : "allowed: ",
                verdict_name(judgement->verdict));
        return;
    }
    fprintf(out, "verdict   WRONG: %s, triangle %u\n", wrong_name(judgement->wrong),
            said->at_fault.prim == ABI_NO_PRIM ? judgement->expected : said->at_fault.prim);
}

static void conclude(const struct explain_lists *l, const struct shown_list *one,
                     char text[EXPLAIN_CONCLUSION_MOST])
{
    const struct judgement *judgement = &one->said.judgement;
    const size_t size = EXPLAIN_CONCLUSION_MOST;
    text[0] = '\0';
    if (one->index == l->count) {
        text_append(text, size, "no list is wrong");
        return;
    }
    if (is_wrong(one))
        text_append(text, size, "WRONG: %s", wrong_name(judgement->wrong));
    else if (judgement->verdict == VERDICT_RIGHT)
        text_append(text, size, "the list is right");
    else
        text_append(text, size, "the list is allowed: %s", verdict_name(judgement->verdict));
    text_append(text, size, "; %zu listed, of %zu exact hit%s %zu lost", one->listed, one->exact,
                one->exact == 1 ? "," : "s,", one->lost);
    if (one->asked)
        text_append(text, size, ", of which %zu found as the nearest from there on%s", one->found,
                    one->found == one->asked ? ": the list alone loses them" : "");
    if (ends_early(one))
        text_append(text, size, "; they lie behind the last that is listed");
}

static void print_page(FILE *out, const struct explain_lists *l, const struct shown_list *one)
{
    const struct explain_options *o = l->options;
    const struct ray *ray = &l->ray[one->index];
    const float range[2] = {ray->tmin, ray->tmax};
    char command[EXPLAIN_COMMAND_MOST], file[EXPLAIN_COMMAND_MOST];
    const char *again = explain_again(o, one->index, file);
    fprintf(out, "scene     %s: %u triangle%s\n", o->of.spec, l->scene->tri_count,
            plural(l->scene->tri_count));
    if (!o->ray_text && o->has_file)
        fprintf(out, "ray       %zu of %zu\n", one->index, l->count);
    else if (!o->ray_text)
        fprintf(out, "ray       %zu of %zu of set %s, seed %llu\n", one->index, l->count,
                o->rays->name, (unsigned long long)o->of.seed);
    print_floats(out, 0, "origin", ray->org, 3);
    print_floats(out, 0, "direction", ray->dir, 3);
    print_floats(out, 0, "range", range, 2);
    fprintf(out, "engine    %s, query all\n", o->of.engine->name);
    fprintf(out, "list      %zu of %zu exact hit%s, %zu listed in all\n", one->exact - one->lost,
            one->exact, plural(one->exact), one->listed);
    print_lines(out, one);
    print_verdict(out, &one->said);
    explain_command(&o->of, ray, command);
    fprintf(out, "again     %s\n", again ? again : command);
}

static void print(const struct explain_lists *l, const struct shown_list *one,
                  const struct screen *screen)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = screen->wide ? NULL : open_memstream(&text, &size);
    print_page(out ? out : stdout, l, one);
    if (out && fclose(out) == 0)
        screen_page(screen, text, "again ");
    free(text);
}

static json_t *lines_json(const struct shown_list *one)
{
    json_t *out = json_array();
    for (size_t i = 0; i < one->count; i++) {
        const struct list_line *line = &one->line[i];
        json_array_append_new(
            out,
            json_record("prim=%u t=%p where=%p listed=%u hit=%p nearest=%p", line->prim,
                        line->exact ? json_real(line->pair.t_lo) : json_null(),
                        json_text(line->exact ? oracle_class_name(line->pair.class) : NULL),
                        line->times, line->times ? json_hit(&line->hit) : json_null(),
                        line->nearest_asked ? json_boolean(line->nearest_found) : json_null()));
    }
    return out;
}

static enum status write_json(const struct explain_lists *l, const struct shown_list *one, int code,
                              struct reason *reason)
{
    const struct explain_options *o = l->options;
    const bool none = one->index == l->count;
    const struct judgement *judgement = &one->said.judgement;
    json_t *out = json_object();
    json_add(out, "raydiff=%s exit=%d scene=%s engine=%s query=%s rays=%zu index=%p",
             RAYDIFF_VERSION, code, o->of.spec, o->of.engine->name, query_name(QUERY_ALL), l->count,
             none ? json_null() : json_integer((json_int_t)one->index));
    if (!none)
        json_add(out, "ray=%p verdict=%s wrong=%s exact=%zu listed=%zu lost=%zu hits=%p",
                 json_ray_bits(&l->ray[one->index]), verdict_name(judgement->verdict),
                 wrong_name(judgement->wrong), one->exact, one->listed, one->lost, lines_json(one));
    return json_write(o->json, out, 17, reason);
}

enum status explain_list(const struct explain_lists *l, char conclusion[EXPLAIN_CONCLUSION_MOST],
                         int *code, struct reason *reason)
{
    const struct explain_options *o = l->options;
    const struct screen screen = screen_make(&o->screen);
    const struct model model = engine_model(o->of.engine, l->self, l->job->tri);
    const bool this_one = o->ray_text || o->has_index;
    struct shown_list one = {0};
    struct judge *judge = NULL;
    enum status status = judge_make(l->oracle, &model, QUERY_ALL, &judge, reason);
    if (!status)
        status = find(l, judge, o->ray_text ? 0 : (size_t)o->index, this_one, &one, reason);
    if (!status && one.index < l->count)
        status = ask_nearest(l, &one, reason);
    if (!status) {
        *code =
            exit_worse(*code, is_wrong(&one) && one.index < l->count ? EXIT_MISMATCH : EXIT_AGREE);
        if (one.index == l->count)
            screen_text(&screen, "%s: %zu ray%s: no list of %s is wrong\n", o->of.spec, l->count,
                        plural(l->count), o->of.engine->name);
        else
            print(l, &one, &screen);
        conclude(l, &one, conclusion);
        if (o->json)
            status = write_json(l, &one, *code, reason);
    }
    judge_free(judge);
    free(one.line);
    return status;
}

int explain_list_check_use(const struct explain_options *o)
{
    static const char own[] = "html svg cause";
    const char *flag;
    for (size_t i = 0; (flag = option_given(i)) != NULL; i++)
        if (option_among(own, flag))
            return usage_error(o->command, "--%s: not used by --query all", flag);
    return -1;
}
