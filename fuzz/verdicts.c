/* Judges what all seats answered to a trial. */
#include "fuzz/coverage.h"
#include "fuzz/stage.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A trial being judged. */
struct judging {
    const struct stage *stage;
    const struct fuzz_player *player;
    struct fuzz_result *out;
    struct judge *judge[FUZZ_CONTESTANTS_MOST]; /* owned by the first seat of a kind */
    size_t alike[FUZZ_CONTESTANTS_MOST];        /* the first seat that is judged alike */
    bool bits[FUZZ_CONTESTANTS_MOST];
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

static void keep(struct judging *j, size_t seat, enum fuzz_kind kind, uint32_t ray,
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
        finding->answer = answers->hit[ray];
    if (judgement)
        finding->judgement = *judgement;
}

/* One judge for all seats that are judged alike. */
static enum status make_judges(struct judging *j, struct reason *reason)
{
    const struct stage *stage = j->stage;
    const struct fuzz_trial *trial = stage->trial;
    struct model model[FUZZ_CONTESTANTS_MOST];
    for (size_t i = 0; i < j->player->contestants; i++) {
        j->judge[i] = NULL;
        j->alike[i] = i;
        if (stage->answers[i].fared != FARED_PLAYED)
            continue;
        model[i] = seat_model(&j->player->seat[i], trial);
        j->bits[i] = model[i].bits;
        for (size_t k = 0; k < i && j->alike[i] == i; k++)
            if (j->judge[k] && same_model(&model[k], &model[i]))
                j->alike[i] = k;
        if (j->alike[i] != i)
            continue;
        enum status status = judge_make(stage->oracle, &trial->scene, &model[i], trial->tri,
                                        trial->query, &j->judge[i], reason);
        if (status)
            return status;
    }
    return STATUS_OK;
}

static void compare_bits(struct judging *j, size_t seat, uint32_t i,
                         const struct judgement *judgement)
{
    const struct stage *stage = j->stage;
    size_t reference = j->player->seat[seat].reference;
    if (!j->bits[seat] || reference >= SEATS_MOST || reference == seat)
        return;
    const struct answers *expected = &stage->answers[reference], *given = &stage->answers[seat];
    if (expected->fared != FARED_PLAYED || expected->flag[i] != ABI_FLAG_DONE ||
        judge_bits(&stage->trial->ray[i], &expected->hit[i], &given->hit[i]) != VERDICT_WRONG)
        return;
    j->out->wrong++;
    keep(j, seat, FUZZ_KIND_BITS, i, judgement);
}

/* All answers to ray i. A judge is a function of ray and answer: who is judged alike and has the
 * same bits has the same verdict. */
static enum status judge_ray(struct judging *j, uint32_t i)
{
    const struct stage *stage = j->stage;
    struct judgement judgement[FUZZ_CONTESTANTS_MOST];
    const enum query query = stage->trial->query;
    uint32_t verdicts = 0;
    bool all = true;
    for (size_t s = 0; s < j->player->contestants; s++) {
        const struct answers *answers = &stage->answers[s], *first = &stage->answers[j->alike[s]];
        if (answers->fared != FARED_PLAYED)
            continue;
        if (answers->flag[i] != ABI_FLAG_DONE) {
            j->out->wrong++;
            keep(j, s, FUZZ_KIND_UNFINISHED, i, NULL);
            all = false;
            continue;
        }
        if (j->alike[s] != s && first->flag[i] == ABI_FLAG_DONE &&
            memcmp(&first->hit[i], &answers->hit[i], sizeof first->hit[i]) == 0)
            judgement[s] = judgement[j->alike[s]];
        else if (judge_answer(j->judge[j->alike[s]], &stage->trial->ray[i], &stage->truth[i],
                              &answers->hit[i], &judgement[s]))
            return STATUS_MEMORY;
        else
            coverage_add_answer(j->out->coverage, query, &judgement[s]);
        verdicts |= 1u << judgement[s].verdict;
        j->out->count[judgement[s].verdict]++;
        if (judgement[s].verdict == VERDICT_WRONG) {
            j->out->wrong++;
            keep(j, s, FUZZ_KIND_WRONG + judgement[s].wrong, i, &judgement[s]);
        }
        compare_bits(j, s, i, &judgement[s]);
    }
    j->out->judged += all && verdicts;
    coverage_add_verdicts(j->out->coverage, verdicts);
    return STATUS_OK;
}

/* True if the layout could not be made because the program that it reproduces ends there. */
static bool ends(const struct stage *stage, const struct seat *seat)
{
    return stage->has_tree && !stage->has_packed[seat->layout_index] && seat->layout->end &&
           seat->layout->end(&stage->bvh, NULL) != LAYOUT_GOES_ON;
}

/* What is not about a single ray: refusals, faults, and, once a layout, bytes that are no tree or
 * an end in their place. */
static void judge_seats(struct judging *j)
{
    bool told[LAYOUTS_MOST] = {false};
    for (size_t s = 0; s < j->player->contestants; s++) {
        const struct seat *seat = &j->player->seat[s];
        const struct answers *answers = &j->stage->answers[s];
        if (answers->fared == FARED_REFUSED) {
            j->out->refused++;
            j->out->refusers |= 1u << s;
        }
        if (seat->layout && !told[seat->layout_index]) {
            told[seat->layout_index] = true;
            if (j->stage->broken[seat->layout_index])
                keep(j, s, FUZZ_KIND_TREE, 0, NULL);
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
static void cover(const struct judging *j)
{
    const struct stage *stage = j->stage;
    const struct fuzz_trial *trial = stage->trial;
    const struct box empty = box_empty();
    const struct box *root = stage->bvh.node_count ? &stage->bvh.node[0].bounds : &empty;
    uint64_t *map = j->out->coverage;
    for (uint32_t i = 0; i < trial->ray_count; i++)
        coverage_add_truth(map, &trial->ray[i], root, &stage->truth[i]);
    if (!stage->has_tree)
        return;
    coverage_add_tree(map, trial, &stage->bvh);
    for (size_t i = 0; i < j->player->layout_count; i++)
        if (stage->has_packed[i])
            coverage_add_packed(map, &stage->packed[i]);
        else
            coverage_add_refusal(map, j->player->layout[i], trial, &stage->bvh);
}

enum status stage_judge(const struct stage *stage, const struct fuzz_player *player,
                        struct fuzz_result *out, struct reason *reason)
{
    struct judging j = {.stage = stage, .player = player, .out = out};
    bool faulty = false;
    *out = (struct fuzz_result){0};
    cover(&j);
    judge_seats(&j);
    for (size_t i = 0; i < player->contestants; i++)
        faulty = faulty || stage->answers[i].fared == FARED_FAULTY;
    enum status status = make_judges(&j, reason);
    for (uint32_t i = 0; i < stage->trial->ray_count && !status; i++)
        if ((status = judge_ray(&j, i)))
            (void)fail(reason, status, "no memory to judge a ray");
    if (faulty)
        out->judged = 0; /* somebody has no verdict */
    for (size_t i = 0; i < player->contestants; i++)
        judge_free(j.judge[i]);
    return status;
}
