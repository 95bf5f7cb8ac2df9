#include "ref/match/match_judge.h"

#include "ref/match/match_edges.h"
#include "ref/base/base.h"

#include <stdlib.h>
#include <string.h>

/* Judgements kept at a time. */
#define CHUNK 16384

/* One row being judged. */
struct judging {
    const struct match *match;
    struct judge *judge;
    struct judge *closest; /* of the closest hits that any-hits are compared with, or NULL */
    struct row *row;
    struct judgement *judgement; /* CHUNK of them */
    double *displacement;        /* of an unknown formula, or NULL */
    uint8_t *note;               /* likewise: of match_edges_note, a ray each */
    struct judge *fans; /* options.demands.watertight: says what closed fans lost, or NULL */
};

static void keep_finding(struct row *row, const struct match *match, size_t i,
                         const struct judgement *judgement)
{
    if (row->finding_count == FINDING_MOST)
        return;
    struct finding *found = &row->finding[row->finding_count++];
    *found = (struct finding){.ray_index = i,
                              .ray = match->ray[i],
                              .got = match->answer[i],
                              .truth = match->truth[i],
                              .bits = judgement == NULL};
    if (judgement)
        found->judgement = *judgement;
    else
        found->expected = match->cpu[i];
}

/* Everything that one answer is judged by. */
static enum status judge_one(const struct judging *j, size_t i, struct judgement *out)
{
    const struct match *match = j->match;
    const struct ray *ray = &match->ray[i];
    const struct hit *any = &match->answer[i], *closest = &match->closest.hit[i];
    enum status status = judge_answer(j->judge, ray, &match->truth[i], any, out);
    if (status == STATUS_OK && j->closest && i < match->closest.count &&
        (any->prim == ABI_NO_PRIM) != (closest->prim == ABI_NO_PRIM)) {
        struct judgement other;
        status = judge_answer(j->closest, ray, &match->truth[i], closest, &other);
        judge_any_against_closest(j->judge, ray, closest, &other, any, out);
    }
    if (status == STATUS_OK && j->fans && out->verdict != VERDICT_OUT_OF_CONTRACT) {
        struct judgement fan;
        status = judge_answer(j->fans, ray, &match->truth[i], any, &fan);
        out->fan = out->fan || fan.fan;
    }
    if (match->unstable[i]) { /* whatever the ray */
        out->verdict = VERDICT_WRONG;
        out->wrong = WRONG_NOT_REPEATABLE;
    }
    return status;
}

static void count_one(struct judging *j, size_t i, const struct judgement *judgement)
{
    struct row *row = j->row;
    bool hit = j->match->answer[i].prim != ABI_NO_PRIM;
    row->count[judgement->verdict]++;
    row->wrong[judgement->wrong]++;
    row->hits += hit;
    if (judgement->over > row->worst_over)
        row->worst_over = judgement->over;
    if (j->displacement && judgement->verdict != VERDICT_OUT_OF_CONTRACT &&
        (hit || judgement->displacement > 0.0))
        j->displacement[row->displacement.count++] = judgement->displacement;
    if (j->note)
        j->note[i] = match_edges_note(judgement);
    row->displacement.fan_lost += judgement->fan;
    row->fans_lost += judgement->fan && row->options.demands.watertight;
    if (judgement->verdict == VERDICT_WRONG && row->judged)
        keep_finding(row, j->match, i, judgement);
}

void match_displacements(double *displacement, struct row *row)
{
    size_t count = row->displacement.count;
    if (count == 0)
        return;
    sort_doubles(displacement, count);
    row->displacement.p50 = displacement[(count - 1) / 2];
    row->displacement.p99 = displacement[(count - 1) * 99 / 100];
    row->displacement.most = displacement[count - 1];
}

static enum status judge_all(struct judging *j)
{
    size_t rays = j->row->rays;
    for (size_t first = 0; first < rays; first += CHUNK) {
        size_t count = rays - first < CHUNK ? rays - first : CHUNK;
        int failed = 0;
#pragma omp parallel for schedule(dynamic, 64) reduction(+ : failed)
        for (long long i = 0; i < (long long)count; i++)
            failed += judge_one(j, first + (size_t)i, &j->judgement[i]) != STATUS_OK;
        if (failed)
            return fail(&j->row->reason, STATUS_MEMORY, "no memory to judge %zu rays", rays);
        for (size_t i = 0; i < count; i++)
            count_one(j, first + i, &j->judgement[i]);
    }
    match_displacements(j->displacement, j->row);
    return j->note ? match_edges_count(j->match->ray, j->note, j->row) : STATUS_OK;
}

static void compare_bits(const struct match *match, struct row *row)
{
    for (size_t i = 0; i < row->rays; i++) {
        if (judge_bits(&match->ray[i], &match->cpu[i], &match->answer[i]) != VERDICT_WRONG)
            continue;
        row->bit_differences++;
        keep_finding(row, match, i, NULL);
    }
    row->differences += row->bit_differences;
}

static enum status judges_make(struct judging *j, const struct model *model)
{
    const struct match *match = j->match;
    const struct match_options *o = &match->options;
    enum status status = judge_make(match->oracle, match->scene, model, o->tri, o->query, &j->judge,
                                    &j->row->reason);
    bool compare = o->query == QUERY_ANY && match->closest.count > 0 &&
                   match->closest.engine == j->row->engine &&
                   (!j->row->engine->needs_packed || match->closest.box == o->box);
    if (status == STATUS_OK && compare)
        status = judge_make(match->oracle, match->scene, model, o->tri, QUERY_CLOSEST, &j->closest,
                            &j->row->reason);
    struct model geometry = {.formula = TWIN_UNKNOWN, .open = model->open};
    if (status == STATUS_OK && o->demands.watertight)
        status = judge_make(match->oracle, match->scene, &geometry, o->tri, o->query, &j->fans,
                            &j->row->reason);
    return status;
}

enum status match_judge(const struct match *match, const struct model *model, struct row *row)
{
    struct judging j = {.match = match, .row = row};
    j.judgement = alloc_zeroed(CHUNK, sizeof *j.judgement);
    bool unknown = model->formula == TWIN_UNKNOWN;
    if (unknown) {
        j.displacement = alloc_zeroed(row->rays, sizeof *j.displacement);
        j.note = alloc_zeroed(row->rays, sizeof *j.note);
    }
    bool made = j.judgement && ((j.displacement && j.note) || !unknown);
    enum status status = made ? STATUS_OK : STATUS_MEMORY;
    if (status)
        fail(&row->reason, status, "no memory to judge %zu rays", row->rays);
    else
        status = judges_make(&j, model);
    if (status == STATUS_OK && row->bits)
        compare_bits(match, row);
    if (status == STATUS_OK)
        status = judge_all(&j);
    row->compared = row->rays;
    row->brute = match->brute_count < row->rays ? match->brute_count : row->rays;
    if (row->judged)
        row->differences += row->count[VERDICT_WRONG] + row->edges_beyond + row->fans_lost;
    judge_free(j.fans);
    free(j.note);
    judge_free(j.judge);
    judge_free(j.closest);
    free(j.judgement);
    free(j.displacement);
    return status;
}
