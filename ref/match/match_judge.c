#include "ref/match/match_judge.h"

#include "ref/match/match_edges.h"
#include "ref/match/match_engine.h"
#include "ref/judge/judge_world.h"
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
    struct match_tally tally;
    struct judgement *judgement; /* CHUNK of them */
    struct judge *fans; /* options.demands.watertight: finds hits that closed fans lost, or NULL */
};

bool match_tally_start(struct row *row, struct match_tally *out)
{
    *out = (struct match_tally){.row = row};
    if (!row->unknown)
        return true;
    out->displacement = alloc_zeroed(row->rays, sizeof *out->displacement);
    if (row->of_world) /* what a transform rounds is more than what counts beside an edge */
        return out->displacement != NULL;
    out->note = alloc_zeroed(row->rays, sizeof *out->note);
    return out->displacement && out->note;
}

void match_tally_add(struct match_tally *tally, size_t i, bool hit,
                     const struct judgement *judgement)
{
    struct row *row = tally->row;
    row->count[judgement->verdict]++;
    row->wrong[judgement->wrong]++;
    row->hits += hit;
    if (judgement->over > row->worst_over)
        row->worst_over = judgement->over;
    if (tally->displacement && judgement->verdict != VERDICT_OUT_OF_CONTRACT &&
        (hit || judgement->displacement > 0.0))
        tally->displacement[row->displacement.count++] = judgement->displacement;
    if (tally->note)
        tally->note[i] = match_edges_note(judgement);
    row->displacement.fan_lost += judgement->fan;
}

static struct place place_of(const struct world *world, uint32_t prim)
{
    return prim < world_tri_count(world) ? world_place(world, prim) : (struct place){0};
}

static void set_world(const struct match *match, size_t i, struct finding *found)
{
    struct world_finding *world = &found->world;
    world->is = true;
    world->mode = match_mode(match, i);
    world->got = place_of(match->world, found->got.prim);
    world->expected =
        place_of(match->world, found->bits ? found->expected.prim : found->judgement.expected);
}

void match_keep_finding(const struct match *match, size_t i, const struct finding *what,
                        struct row *row)
{
    size_t alike = 0;
    for (size_t k = 0; k < row->finding_count; k++)
        alike += row->finding[k].bits == what->bits;
    if (alike == FINDING_MOST)
        return;
    struct finding *found = &row->finding[row->finding_count++];
    *found = *what;
    found->ray_index = i;
    found->ray = match->ray[i];
    found->truth = match->truth[i];
    if (match->world)
        set_world(match, i, found);
}

enum status match_tally_end(struct match_tally *tally, const struct match *match,
                            enum status status)
{
    struct row *row = tally->row;
    if (!status && tally->displacement)
        match_displacements(tally->displacement, row);
    if (!status && tally->note)
        status = match_edges_count(match->ray, tally->note, row);
    row->compared = row->rays;
    row->brute = match->brute_count < row->rays ? match->brute_count : row->rays;
    row->differences += row->bit_differences;
    if (!row->compiled.translates) /* what a translator cannot say is stated, not a fault */
        row->differences += engine_compiled_lost(&row->compiled);
    if (row->judged)
        row->differences += row->count[VERDICT_WRONG] + row->edges_beyond + row->fans_lost;
    free(tally->displacement);
    free(tally->note);
    return status;
}

/* Judges the answer to ray i; tag of a world alone. */
static enum status judge_with(const struct match *match, const struct judge *judge, size_t i,
                              const struct hit *hit, const uint32_t *tag, struct judgement *out)
{
    const struct ray *ray = &match->ray[i];
    if (!match->world)
        return judge_answer(judge, ray, &match->truth[i], &hit[i], out);
    return judge_world_answer(judge, ray, match_mode(match, i), &match->truth[i], &hit[i], tag[i],
                              out);
}

/* Judges one answer in every way. */
static enum status judge_one(const struct judging *j, size_t i, struct judgement *out)
{
    const struct match *match = j->match;
    const struct ray *ray = &match->ray[i];
    const struct hit *any = &match->answer[i], *closest = &match->closest.hit[i];
    enum status status = judge_with(match, j->judge, i, match->answer, match->answer_tag, out);
    if (status == STATUS_OK && j->closest && i < match->closest.count &&
        (any->prim == ABI_NO_PRIM) != (closest->prim == ABI_NO_PRIM)) {
        struct judgement other;
        status = judge_with(match, j->closest, i, match->closest.hit, match->closest.tag, &other);
        judge_any_against_closest(j->judge, ray, closest, &other, any, out);
    }
    if (status == STATUS_OK && j->fans && out->verdict != VERDICT_OUT_OF_CONTRACT) {
        struct judgement fan;
        status = judge_with(match, j->fans, i, match->answer, match->answer_tag, &fan);
        out->fan = out->fan || fan.fan;
    }
    if (match->unstable[i]) /* whatever the ray */
        judge_set_wrong(out, WRONG_NOT_REPEATABLE);
    return status;
}

static void count_one(struct judging *j, size_t i, const struct judgement *judgement)
{
    struct row *row = j->row;
    const struct match *match = j->match;
    const struct finding finding = {.got = match->answer[i],
                                    .judgement = *judgement,
                                    .world.tag = match->world ? match->answer_tag[i] : 0};
    match_tally_add(&j->tally, i, finding.got.prim != ABI_NO_PRIM, judgement);
    row->fans_lost += judgement->fan && row->options.demands.watertight;
    if (judgement->verdict == VERDICT_WRONG && row->judged)
        match_keep_finding(match, i, &finding, row);
}

void match_displacements(double *displacement, struct row *row)
{
    size_t count = row->displacement.count;
    if (count == 0)
        return;
    sort_doubles(displacement, count);
    row->displacement.p50 = displacement[rank_of(count, 500)];
    row->displacement.p99 = displacement[rank_of(count, 990)];
    row->displacement.most = displacement[count - 1];
}

/* Who is right where a mode of a library has other bits than its plain one. */
static enum status judge_beside(struct judging *j, size_t i, const struct judgement *own)
{
    const struct match *match = j->match;
    struct row *row = j->row;
    struct judgement other;
    if (!row->engine->plain || !row->against || !ray_in_contract(&match->ray[i]) ||
        match_same_bits(match->against.hit, match->answer, match->world ? match->answer_tag : NULL,
                        match->against.tag, i))
        return STATUS_OK;
    const bool right = own->verdict != VERDICT_WRONG;
    enum status status =
        judge_with(match, j->judge, i, match->against.hit, match->against.tag, &other);
    if (status)
        return status;
    const bool other_right = other.verdict != VERDICT_WRONG;
    row->beside.both += right && other_right;
    row->beside.own += right && !other_right;
    row->beside.plain += !right && other_right;
    row->beside.neither += !right && !other_right;
    return STATUS_OK;
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
        for (size_t i = 0; i < count; i++) {
            count_one(j, first + i, &j->judgement[i]);
            failed += judge_beside(j, first + i, &j->judgement[i]) != STATUS_OK;
        }
        if (failed)
            return fail(&j->row->reason, STATUS_MEMORY, "no memory to judge %zu rays", rays);
    }
    return STATUS_OK;
}

static void compare_bits(const struct match *match, struct row *row)
{
    for (size_t i = 0; i < row->rays; i++) {
        const uint32_t *tag = match->world ? match->answer_tag : NULL;
        if (match_same_bits(match->against.hit, match->answer, tag, match->against.tag, i) ||
            !ray_in_contract(&match->ray[i]))
            continue;
        if (!row->bits) {
            row->moved++;
            continue;
        }
        const struct finding finding = {.got = match->answer[i],
                                        .expected = match->against.hit[i],
                                        .bits = true,
                                        .world.tag = tag ? tag[i] : 0,
                                        .world.expected_tag = tag ? match->against.tag[i] : 0};
        row->bit_differences++;
        match_keep_finding(match, i, &finding, row);
    }
}

static enum status judges_make(struct judging *j, const struct model *model)
{
    const struct match *match = j->match;
    const struct match_options *o = &match->options;
    enum status status = judge_make(match->oracle, model, o->query, &j->judge, &j->row->reason);
    bool compare = o->query == QUERY_ANY && match->closest.count > 0 &&
                   match->closest.engine == j->row->engine &&
                   (!j->row->engine->needs_packed || match->closest.box == o->box);
    if (status == STATUS_OK && compare)
        status = judge_make(match->oracle, model, QUERY_CLOSEST, &j->closest, &j->row->reason);
    struct model geometry = {.formula = TWIN_UNKNOWN, .open = model->open};
    if (status == STATUS_OK && o->demands.watertight)
        status = judge_make(match->oracle, &geometry, o->query, &j->fans, &j->row->reason);
    return status;
}

enum status match_judge(const struct match *match, const struct model *model, struct row *row)
{
    struct judging j = {.match = match, .row = row};
    j.judgement = alloc_zeroed(CHUNK, sizeof *j.judgement);
    bool started = match_tally_start(row, &j.tally);
    enum status status = started && j.judgement ? judges_make(&j, model)
                                                : fail(&row->reason, STATUS_MEMORY,
                                                       "no memory to judge %zu rays", row->rays);
    if (status == STATUS_OK && row->against)
        compare_bits(match, row);
    if (status == STATUS_OK)
        status = judge_all(&j);
    judge_free(j.fans);
    judge_free(j.judge);
    judge_free(j.closest);
    free(j.judgement);
    return match_tally_end(&j.tally, match, status);
}
