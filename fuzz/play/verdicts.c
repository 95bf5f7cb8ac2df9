/* Judges what all seats answered to a trial. */
#include "fuzz/play/coverage.h"
#include "fuzz/play/stage_world.h"
#include "ref/judge/judge_world.h"
#include "ref/match/match_edges.h"

#include <stdlib.h>
#include <string.h>

#define PART 32u /* rays that are judged together */

/* A trial being judged. */
struct verdicts_judging {
    const struct play_stage *stage;
    const struct fuzz_player *player;
    struct fuzz_result *out;
    struct judge *judge[FUZZ_CONTESTANTS_MOST]; /* owned by the first seat of a kind */
    size_t alike[FUZZ_CONTESTANTS_MOST];        /* the first seat that is judged alike */
    bool bits[FUZZ_CONTESTANTS_MOST];
    uint8_t *note[FUZZ_CONTESTANTS_MOST]; /* of unknown formulas: of match_edges_note, a ray each */
    /* Of a part of the rays. */
    struct judgement judgement[FUZZ_CONTESTANTS_MOST][PART];
    bool own[FUZZ_CONTESTANTS_MOST][PART]; /* else it is the first seat's */
};

static bool same_rounding(const struct rounding *a, const struct rounding *b)
{
    return a->add == b->add && a->mul == b->mul && a->div == b->div && a->tiny == b->tiny;
}

static bool same_model(const struct model *a, const struct model *b)
{
    return a->formula == b->formula && same_rounding(&a->rounding, &b->rounding) &&
           a->watertight == b->watertight && a->open == b->open && a->slab == b->slab &&
           a->any_unnamed == b->any_unnamed;
}

/* What is answered beside the hit; 0 of a scene. */
static uint32_t tag_of(const struct verdicts_judging *j, size_t seat, uint32_t ray)
{
    return j->stage->trial->world.is ? j->stage->answers[seat].tag[ray] : 0;
}

static void keep(struct verdicts_judging *j, size_t seat, enum fuzz_kind kind, uint32_t ray,
                 const struct judgement *judgement)
{
    const struct seat *who = &j->player->seat[seat];
    const struct answers *answers = &j->stage->answers[seat];
    struct fuzz_result *out = j->out;
    for (size_t i = 0; i < out->finding_count; i++)
        if (out->finding[i].contestant == seat && out->finding[i].signature.kind == kind)
            return;
    if (out->finding_count == FUZZ_FINDINGS_MOST)
        return;
    struct fuzz_finding *finding = &out->finding[out->finding_count++];
    *finding = (struct fuzz_finding){
        .signature = {.layout = who->layout, .kind = kind, .cause = CAUSE_UNEXPLAINED},
        .contestant = seat,
        .ray = ray,
        .answer = {.prim = ABI_NO_PRIM}};
    fuzz_signature_set_engine(&finding->signature, who->engine->name);
    if (answers->fared == FARED_PLAYED && ray < j->stage->trial->ray_count &&
        answers->flag[ray] == ABI_FLAG_DONE)
        finding->answer = answers->hit[ray], finding->tag = tag_of(j, seat, ray);
    if (judgement)
        finding->judgement = *judgement;
    if (who->layout && j->stage->fault[who->layout_index] == kind)
        memcpy(finding->said, j->stage->said[who->layout_index], sizeof finding->said);
}

/* One judge for all seats that are judged alike. */
static enum status make_judges(struct verdicts_judging *j, struct reason *reason)
{
    const struct play_stage *stage = j->stage;
    const struct fuzz_trial *trial = stage->trial;
    struct model model[FUZZ_CONTESTANTS_MOST];
    for (size_t i = 0; i < j->player->contestants; i++) {
        j->alike[i] = i;
        if (stage->answers[i].fared != FARED_PLAYED)
            continue;
        const struct seat *seat = &j->player->seat[i];
        model[i] =
            seat_model(seat, trial, seat->layout && stage_is_split(stage, seat->layout_index));
        j->bits[i] = model[i].bits;
        /* What a transform rounds is more than what counts beside an edge. */
        if (model[i].formula == TWIN_UNKNOWN && !trial->world.is &&
            !(j->note[i] = alloc_zeroed(trial->ray_count, sizeof *j->note[i])))
            return fail(reason, STATUS_MEMORY, "no memory for %u rays", trial->ray_count);
        for (size_t k = 0; k < i && j->alike[i] == i; k++)
            if (j->judge[k] && same_model(&model[k], &model[i]))
                j->alike[i] = k;
        if (j->alike[i] != i)
            continue;
        enum status status =
            judge_make(stage->oracle, &model[i], trial->query, &j->judge[i], reason);
        if (status)
            return status;
    }
    return STATUS_OK;
}

static void compare_bits(struct verdicts_judging *j, size_t seat, uint32_t i,
                         const struct judgement *judgement)
{
    const struct play_stage *stage = j->stage;
    size_t reference = j->player->seat[seat].reference;
    if (!j->bits[seat] || reference >= SEATS_MOST || reference == seat)
        return;
    const struct answers *expected = &stage->answers[reference], *given = &stage->answers[seat];
    const struct ray *ray = &stage->trial->ray[i];
    if (expected->fared != FARED_PLAYED || expected->flag[i] != ABI_FLAG_DONE)
        return;
    if (judge_bits(ray, &expected->hit[i], &given->hit[i]) != VERDICT_WRONG &&
        (tag_of(j, seat, i) == tag_of(j, reference, i) || !ray_in_contract(ray)))
        return;
    j->out->wrong++;
    keep(j, seat, FUZZ_KIND_BITS, i, judgement);
}

/* A verdict depends on ray and answer alone: engines with one judge and the same bits have the same
 * verdict. */
static bool is_copy(const struct verdicts_judging *j, size_t seat, uint32_t i)
{
    const struct answers *answers = &j->stage->answers[seat];
    const struct answers *first = &j->stage->answers[j->alike[seat]];
    return j->alike[seat] != seat && first->flag[i] == ABI_FLAG_DONE &&
           memcmp(&first->hit[i], &answers->hit[i], sizeof first->hit[i]) == 0 &&
           tag_of(j, seat, i) == tag_of(j, j->alike[seat], i);
}

/* Judges what one seat answered to the rays from `first` on, of a world. */
static enum status judge_seat_of_world(struct verdicts_judging *j, size_t seat, uint32_t first,
                                       uint32_t count)
{
    const struct play_stage *stage = j->stage;
    const struct answers *answers = &stage->answers[seat];
    enum status status = STATUS_OK;
    for (uint32_t k = 0; k < count && !status; k++) {
        uint32_t i = first + k;
        j->own[seat][k] = answers->flag[i] == ABI_FLAG_DONE && !is_copy(j, seat, i);
        if (j->own[seat][k])
            status = judge_world_answer(j->judge[j->alike[seat]], &stage->trial->ray[i],
                                        stage->trial->world.mode[i], &stage->truth[i],
                                        &answers->hit[i], answers->tag[i], &j->judgement[seat][k]);
    }
    return status;
}

/* The same of a scene or a world. */
static enum status judge_seat(struct verdicts_judging *j, size_t seat, uint32_t first,
                              uint32_t count)
{
    const struct play_stage *stage = j->stage;
    const struct answers *answers = &stage->answers[seat];
    struct judge_question question[PART];
    struct judgement judgement[PART];
    uint32_t ray[PART], asked = 0;
    if (stage->trial->world.is)
        return judge_seat_of_world(j, seat, first, count);
    for (uint32_t k = 0; k < count; k++) {
        uint32_t i = first + k;
        j->own[seat][k] = false;
        if (answers->flag[i] != ABI_FLAG_DONE || is_copy(j, seat, i))
            continue;
        j->own[seat][k] = true;
        ray[asked] = k;
        question[asked++] =
            (struct judge_question){&stage->trial->ray[i], &stage->truth[i], &answers->hit[i]};
    }
    enum status status = judge_answers(j->judge[j->alike[seat]], question, asked, judgement);
    for (uint32_t k = 0; k < asked; k++)
        j->judgement[seat][ray[k]] = judgement[k];
    return status;
}

/* Counts all answers to ray i, which is ray k of the part. */
static void count_ray(struct verdicts_judging *j, uint32_t i, uint32_t k)
{
    const struct play_stage *stage = j->stage;
    const enum query query = stage->trial->query;
    uint32_t verdicts = 0;
    bool all = true;
    for (size_t s = 0; s < j->player->contestants; s++) {
        const struct answers *answers = &stage->answers[s];
        if (answers->fared != FARED_PLAYED)
            continue;
        if (answers->flag[i] != ABI_FLAG_DONE) {
            j->out->wrong++;
            keep(j, s, FUZZ_KIND_UNFINISHED, i, NULL);
            all = false;
            continue;
        }
        const struct judgement *judgement = &j->judgement[j->own[s][k] ? s : j->alike[s]][k];
        if (j->own[s][k])
            coverage_add_answer(j->out->coverage, query, judgement);
        verdicts |= 1u << judgement->verdict;
        j->out->count[judgement->verdict]++;
        if (j->note[s])
            j->note[s][i] = match_edges_note(judgement);
        if (judgement->verdict == VERDICT_WRONG) {
            j->out->wrong++;
            keep(j, s, fuzz_kind_of_wrong(judgement->wrong), i, judgement);
        } else if (answers->hit[i].prim != ABI_NO_PRIM) {
            j->out->provers |= 1u << s;
        }
        compare_bits(j, s, i, judgement);
    }
    j->out->judged += all && verdicts;
    coverage_add_verdicts(j->out->coverage, verdicts);
}

static enum status judge_rays(struct verdicts_judging *j)
{
    uint32_t rays = j->stage->trial->ray_count;
    for (uint32_t first = 0; first < rays; first += PART) {
        uint32_t count = rays - first < PART ? rays - first : PART;
        for (size_t s = 0; s < j->player->contestants; s++)
            if (j->stage->answers[s].fared == FARED_PLAYED && judge_seat(j, s, first, count))
                return STATUS_MEMORY;
        for (uint32_t k = 0; k < count; k++)
            count_ray(j, first + k, k);
    }
    enum status status = STATUS_OK;
    for (size_t s = 0; s < j->player->contestants && !status; s++)
        if (j->note[s])
            status = match_edges_add(j->stage->trial->ray, j->note[s], rays, j->out->edges[s]);
    return status;
}

/* True if the layout could not be made because the program that it reproduces ends there. */
static bool ends(const struct play_stage *stage, const struct seat *seat)
{
    return !stage->trial->world.is && stage->has_tree && !stage->has_packed[seat->layout_index] &&
           seat->layout->end && seat->layout->end(&stage->bvh, NULL) != LAYOUT_GOES_ON;
}

/* What is not about a single ray: refusals, faults, and, once a layout, bytes that are no tree or
 * an end in their place. */
static void judge_seats(struct verdicts_judging *j)
{
    bool told[LAYOUTS_MOST] = {false};
    for (size_t s = 0; s < j->player->contestants; s++) {
        const struct seat *seat = &j->player->seat[s];
        const struct answers *answers = &j->stage->answers[s];
        enum trial_motion motion =
            seat->layout ? j->stage->motion[seat->layout_index] : TRIAL_STILL;
        if (answers->fared == FARED_REFUSED) {
            j->out->refused++;
            j->out->refusers |= 1u << s;
            j->out->decliners |= (uint32_t)answers->declined << s;
        } else if (answers->fared != FARED_NOT && answers->fared != FARED_FAULTY) {
            j->out->players |= 1u << s;
            j->out->refitted |= (uint32_t)(motion == TRIAL_REFITTED) << s;
            j->out->rebuilt |= (uint32_t)(motion == TRIAL_REBUILT) << s;
        }
        if (seat->layout && !told[seat->layout_index]) {
            told[seat->layout_index] = true;
            if (j->stage->fault[seat->layout_index] != FUZZ_KIND_COUNT)
                keep(j, s, j->stage->fault[seat->layout_index], 0, NULL);
            else if (ends(j->stage, seat))
                keep(j, s, FUZZ_KIND_REFUSED, 0, NULL);
        }
        if (answers->fared == FARED_FAULTY) {
            j->out->wrong++;
            keep(j, s, answers->kind, answers->ray, NULL);
        }
    }
}

/* States that tree, bytes and truth reached. */
static void cover(const struct verdicts_judging *j)
{
    const struct play_stage *stage = j->stage;
    const struct fuzz_trial *trial = stage->trial;
    const struct box empty = box_empty();
    const struct box *root = stage->bvh.node_count ? &stage->bvh.node[0].bounds : &empty;
    uint64_t *map = j->out->coverage;
    if (trial->world.is) {
        stage_world_cover(stage, j->player, map);
        return;
    }
    for (uint32_t i = 0; i < trial->ray_count; i++)
        coverage_add_truth(map, &trial->ray[i], root, &stage->truth[i]);
    if (!stage->has_tree)
        return;
    coverage_add_tree(map, trial, &stage->bvh);
    for (size_t i = 0; i < j->player->layout_count; i++)
        if (stage->has_packed[i] && stage->motion[i] != TRIAL_STILL)
            coverage_add_motion(map, stage->motion[i] == TRIAL_REBUILT);
    for (size_t i = 0; i < j->player->layout_count; i++)
        if (stage->has_packed[i])
            coverage_add_packed(map, &stage->packed[i]);
        else
            coverage_add_refusal(map, j->player->layout[i], trial, &stage->bvh);
}

enum status stage_judge(const struct play_stage *stage, const struct fuzz_player *player,
                        struct fuzz_result *out, struct reason *reason)
{
    struct verdicts_judging j; /* large, and filled where it is used */
    j.stage = stage;
    j.player = player;
    j.out = out;
    for (size_t i = 0; i < player->contestants; i++)
        j.judge[i] = NULL, j.note[i] = NULL;
    bool faulty = false;
    *out = (struct fuzz_result){0};
    cover(&j);
    judge_seats(&j);
    for (size_t i = 0; i < player->contestants; i++)
        faulty = faulty || stage->answers[i].fared == FARED_FAULTY;
    enum status status = make_judges(&j, reason);
    if (!status && (status = judge_rays(&j)))
        (void)fail(reason, status, "no memory to judge a ray");
    if (faulty)
        out->judged = 0; /* a contestant has no verdict */
    for (size_t i = 0; i < player->contestants; i++) {
        judge_free(j.judge[i]);
        free(j.note[i]);
    }
    return status;
}
