/* The public library: judging. Models, judgements and sums are those of `raydiff judge`
 * (ref/outside/pipe.h, ref/judge/judge.h, ref/match/match_judge.h). */
#include "ref/library/library.h"

#include "ref/judge/judge_world.h"
#include "ref/match/match_judge.h"
#include "ref/outside/pipe.h"

#include <omp.h>
#include <stdio.h>
#include <stdlib.h>

#define CHUNK 16384u /* answers that are held at a time */
#define PART  256u   /* answers of a thread at a time */

/* A row below one hit in this many answers proves nothing, as in a match. */
#define VACUOUS_ONE_IN 1000u

_Static_assert((int)RAYDIFF_VERDICTS == (int)VERDICT_COUNT,
               "verdicts of the interface are the judge's");
_Static_assert((int)RAYDIFF_FAULTS == (int)WRONG_COUNT, "faults of the interface are the judge's");

const char *raydiff_verdict_name(uint32_t number)
{
    return number < RAYDIFF_VERDICTS ? verdict_name((enum verdict)number) : NULL;
}

const char *raydiff_fault_name(uint32_t number)
{
    return number < RAYDIFF_FAULTS ? wrong_name((enum wrong)number) : NULL;
}

/* The two judges of a call, and what they judge. */
struct library_judging {
    const struct raydiff_oracle *oracle;
    const struct ray *ray;
    const struct raydiff_answer *answer;
    const uint32_t *mask;
    unsigned threads;
    struct judge *judge;
    struct judge *fans;          /* demand_watertight: finds hits that closed fans lost; or NULL */
    struct oracle_answer *truth; /* CHUNK of each */
    struct hit *hit;
    struct judgement *judgement;
    struct ray_mode *mode; /* of a world */
};

static enum status model_of(const struct raydiff_judging *how, bool of_world, struct model *out,
                            struct reason *reason)
{
    uint32_t formula, rounding;
    uint32_t flags = (how->open ? PIPE_FLAG_OPEN : 0) |
                     (how->watertight ? PIPE_FLAG_WATERTIGHT : 0) |
                     (how->unnamed ? PIPE_FLAG_UNNAMED : 0);
    enum status status = library_find("formula", how->formula ? how->formula : "unknown",
                                      pipe_formula_name, &formula, reason);
    if (!status)
        status = library_find("rounding", how->rounding ? how->rounding : "ieee",
                              pipe_rounding_name, &rounding, reason);
    if (!status && (!float_is_finite(how->displacement) || how->displacement < 0.0f))
        status = fail(reason, STATUS_INPUT, "displacement: %g is not 0 or more, and finite",
                      (double)how->displacement);
    if (!status)
        status = pipe_model(formula, rounding, flags, out, reason);
    if (!status && how->displacement > 0.0f && out->formula != TWIN_UNKNOWN)
        status = fail(reason, STATUS_INPUT, "displacement: the formula is known");
    if (!status)
        out->displacement = (double)how->displacement;
    if (!status && of_world && out->formula != TWIN_UNKNOWN)
        status = fail(reason, STATUS_INPUT,
                      "formula: in a world transforms are the tracer's own: it is unknown");
    return status;
}

static enum status judges_make(struct library_judging *j, const struct raydiff_judging *how,
                               size_t room, struct model *model, struct reason *reason)
{
    const enum query query = how->any ? QUERY_ANY : QUERY_CLOSEST;
    enum status status = model_of(how, j->oracle->is_world, model, reason);
    if (!status)
        status = judge_make(j->oracle->oracle, model, query, &j->judge, reason);
    const struct model geometry = {.formula = TWIN_UNKNOWN, .open = how->open};
    if (!status && how->demand_watertight)
        status = judge_make(j->oracle->oracle, &geometry, query, &j->fans, reason);
    if (status)
        return status;
    j->truth = alloc_zeroed(room, sizeof *j->truth);
    j->hit = alloc_zeroed(room, sizeof *j->hit);
    j->judgement = alloc_zeroed(room, sizeof *j->judgement);
    j->mode = alloc_zeroed(j->oracle->is_world ? room : 0, sizeof *j->mode);
    return j->truth && j->hit && j->judgement && j->mode
               ? STATUS_OK
               : fail(reason, STATUS_MEMORY, "no memory to judge %zu answers", room);
}

static void judges_free(struct library_judging *j)
{
    judge_free(j->judge);
    judge_free(j->fans);
    free(j->truth);
    free(j->hit);
    free(j->judgement);
    free(j->mode);
}

/* The tag of a right answer that names this triangle: the interface has none. */
static uint32_t tag_of(const struct raydiff_oracle *oracle, const struct ray *ray, uint32_t prim)
{
    struct oracle_pair pair;
    if (prim >= library_triangles(oracle)) /* a miss, or no triangle */
        return 0;
    oracle_pair(oracle->oracle, ray, prim, &pair);
    const bool front = pair.det != 0 && oracle_is_front(oracle->oracle, &pair, prim);
    return oracle->world.instance[world_instance_of(&oracle->world, prim)].custom |
           (front ? ABI_TAG_FRONT : 0);
}

/* Judges answer `at` of the chunk, alone. */
static enum status judge_one(const struct library_judging *j, const struct judge *judge,
                             size_t from, size_t at, struct judgement *out)
{
    const struct ray *ray = &j->ray[from + at];
    const struct hit *hit = &j->hit[at];
    if (!j->oracle->is_world)
        return judge_answer(judge, ray, &j->truth[at], hit, out);
    return judge_world_answer(judge, ray, j->mode[at], &j->truth[at], hit,
                              tag_of(j->oracle, ray, hit->prim), out);
}

/* Judges answers of the chunk that begins at ray `from`; returns how many could not be. */
static int judge_part(const struct library_judging *j, size_t from, size_t first, size_t count)
{
    struct judge_question question[PART] = {{.ray = NULL}};
    int failed = 0;
    for (size_t i = 0; i < count; i++)
        question[i] = (struct judge_question){&j->ray[from + first + i], &j->truth[first + i],
                                              &j->hit[first + i]};
    if (!j->oracle->is_world)
        failed += judge_answers(j->judge, question, count, &j->judgement[first]) != STATUS_OK;
    for (size_t i = 0; i < count && j->oracle->is_world; i++)
        failed += judge_one(j, j->judge, from, first + i, &j->judgement[first + i]) != STATUS_OK;
    for (size_t i = 0; i < count && j->fans; i++) {
        struct judgement fan, *out = &j->judgement[first + i];
        if (out->verdict == VERDICT_OUT_OF_CONTRACT)
            continue;
        failed += judge_one(j, j->fans, from, first + i, &fan) != STATUS_OK;
        out->fan = out->fan || fan.fan;
    }
    return failed;
}

/* The exact answers to a chunk. */
static enum status decide(struct library_judging *j, size_t from, size_t count,
                          struct reason *reason)
{
    const struct oracle *oracle = j->oracle->oracle;
    const struct ray *ray = j->ray + from;
    if (!j->oracle->is_world)
        return oracle_closest(oracle, ORACLE_TREE, ORACLE_CLOSED, ray, count, j->threads, j->truth,
                              NULL, reason);
    for (size_t i = 0; i < count; i++)
        j->mode[i] = library_mode(j->mask, from + i);
    return oracle_closest_world(oracle, ORACLE_TREE, ORACLE_CLOSED, ray, j->mode, count, j->threads,
                                j->truth, NULL, reason);
}

static enum status judge_chunk(struct library_judging *j, size_t from, size_t count,
                               struct reason *reason)
{
    int failed = 0;
    enum status status = decide(j, from, count, reason);
    if (status)
        return status;
    for (size_t i = 0; i < count; i++) {
        const struct raydiff_answer *answer = &j->answer[from + i];
        j->hit[i] = answer->triangle == RAYDIFF_NOTHING
                        ? hit_none()
                        : (struct hit){answer->t, answer->u, answer->v, answer->triangle};
    }
    const long long parts = (long long)((count + PART - 1) / PART);
    int team = j->threads ? (int)j->threads : omp_get_max_threads();
    team = parts < team ? (int)parts : team;
#pragma omp parallel num_threads(team) reduction(+ : failed)
    {
        const unsigned long saved = library_begin(); /* each thread has modes of its own */
#pragma omp for schedule(dynamic, 1)
        for (long long part = 0; part < parts; part++) {
            const size_t first = (size_t)part * PART;
            failed += judge_part(j, from, first, count - first < PART ? count - first : PART);
        }
        library_modes(saved);
    }
    return failed ? fail(reason, STATUS_MEMORY, "no memory to judge %zu answers", count)
                  : STATUS_OK;
}

static struct raydiff_judged judged_of(const struct judgement *from)
{
    const bool hit = from->expected != ABI_NO_PRIM;
    return (struct raydiff_judged){.verdict = from->verdict,
                                   .fault = from->wrong,
                                   .expected = from->expected,
                                   .lost = from->behind ? from->lost : RAYDIFF_NOTHING,
                                   .t_lo = hit ? from->t_lo : 0.0,
                                   .t_hi = hit ? from->t_hi : 0.0,
                                   .over = from->over,
                                   .displacement = from->displacement};
}

/* The sums of a match that judged these answers. */
static struct raydiff_counts counts_of(const struct row *row, double displacement)
{
    struct raydiff_counts out = {.answers = row->rays,
                                 .hits = row->hits,
                                 .beside_edges = row->edges_beyond,
                                 .in_fans = row->fans_lost,
                                 .faults = row->differences,
                                 .over = row->worst_over,
                                 .displacement = displacement};
    const size_t least = row->rays / VACUOUS_ONE_IN;
    for (int i = 0; i < RAYDIFF_VERDICTS; i++)
        out.verdict[i] = row->count[i];
    for (int i = 1; i < RAYDIFF_FAULTS; i++)
        out.fault[i] = row->wrong[i];
    out.vacuous = row->differences == 0 && row->hits < (least ? least : 1);
    return out;
}

/* Judges all chunks. */
static enum status judge_all(struct library_judging *j, const struct raydiff_judging *how,
                             const struct model *model, size_t count, struct raydiff_judged *out,
                             struct raydiff_counts *counts, struct reason *reason)
{
    struct row row = {.rays = count,
                      .judged = true,
                      .unknown = model->formula == TWIN_UNKNOWN,
                      .of_world = j->oracle->is_world};
    const struct match match = {.ray = j->ray, .ray_count = count};
    struct match_tally tally = {.row = &row};
    double displacement = 0.0;
    enum status status = STATUS_OK;
    if (row.unknown && !row.of_world && !(tally.note = alloc_zeroed(count, 1)))
        status = fail(reason, STATUS_MEMORY, "no memory to judge %zu answers", count);
    for (size_t from = 0; from < count && !status; from += CHUNK) {
        const size_t part = count - from < CHUNK ? count - from : CHUNK;
        status = judge_chunk(j, from, part, reason);
        for (size_t i = 0; i < part && !status; i++) {
            const struct judgement *one = &j->judgement[i];
            match_tally_add(&tally, from + i, j->hit[i].prim != ABI_NO_PRIM, one);
            row.fans_lost += one->fan && how->demand_watertight;
            if (one->displacement > displacement && one->verdict != VERDICT_OUT_OF_CONTRACT)
                displacement = one->displacement;
            if (out)
                out[from + i] = judged_of(one);
        }
    }
    const bool judged = status == STATUS_OK;
    status = match_tally_end(&tally, &match, status);
    if (status && judged)
        *reason = row.reason;
    if (!status && counts)
        *counts = counts_of(&row, displacement);
    return status;
}

/* Judges; `line` (or NULL) receives the judgement of the first answer. */
static enum status judge(struct library_judging *j, const struct raydiff_judging *how, size_t count,
                         struct raydiff_judged *out, struct raydiff_counts *counts,
                         struct judgement *line, struct reason *reason)
{
    static const struct raydiff_judging standard = {.formula = NULL};
    struct model model;
    how = how ? how : &standard;
    enum status status = library_given(j->oracle, "oracle", reason);
    if (!status && count)
        status = library_given(j->ray, "rays", reason);
    if (!status && count)
        status = library_given(j->answer, "answers", reason);
    if (!status)
        status = library_masks(j->oracle, how->mask, count, reason);
    j->mask = how->mask;
    if (!status)
        status = judges_make(j, how, count < CHUNK ? count : CHUNK, &model, reason);
    if (!status)
        status = judge_all(j, how, &model, count, out, counts, reason);
    if (!status && line)
        *line = j->judgement[0];
    judges_free(j);
    return status;
}

enum raydiff_error raydiff_judge(const struct raydiff_oracle *oracle,
                                 const struct raydiff_judging *how, const float *ray,
                                 const struct raydiff_answer *answer, size_t count,
                                 uint32_t threads, struct raydiff_judged *out,
                                 struct raydiff_counts *counts, struct raydiff_why *why)
{
    const unsigned long modes = library_begin();
    struct reason reason = {""};
    struct library_judging j = {
        .oracle = oracle, .ray = library_rays(ray), .answer = answer, .threads = threads};
    if (counts)
        *counts = (struct raydiff_counts){0};
    enum status status = judge(&j, how, count, out, counts, NULL, &reason);
    for (size_t i = 0; status && out && i < count; i++)
        out[i] = (struct raydiff_judged){0};
    return library_end(modes, status, &reason, why);
}

enum raydiff_error raydiff_reason(const struct raydiff_oracle *oracle,
                                  const struct raydiff_judging *how, const float *ray,
                                  const struct raydiff_answer *answer, char *text,
                                  struct raydiff_why *why)
{
    const unsigned long modes = library_begin();
    struct reason reason = {""};
    struct library_judging j = {
        .oracle = oracle, .ray = library_rays(ray), .answer = answer, .threads = 1};
    struct judgement one;
    enum status status = library_given(text, "text", &reason);
    if (status)
        return library_end(modes, status, &reason, why);
    text[0] = '\0';
    status = judge(&j, how, 1, NULL, NULL, &one, &reason);
    if (!status) {
        const struct hit hit = {answer->t, answer->u, answer->v, answer->triangle};
        int length = snprintf(text, RAYDIFF_REASON_BYTES, "%s%s%s ", verdict_name(one.verdict),
                              one.wrong ? " " : "", one.wrong ? wrong_name(one.wrong) : "");
        judge_line(j.ray, &one, &hit, text + length, RAYDIFF_REASON_BYTES - (size_t)length);
    }
    return library_end(modes, status, &reason, why);
}
