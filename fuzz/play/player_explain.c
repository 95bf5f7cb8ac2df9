/* The cause of a finding: the engine traces the ray again, alone, and its answer is explained. */
#include "fuzz/play/scaled.h"
#include "fuzz/play/stage_world.h"
#include "ref/explain/judged.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static enum cause item_cause(enum item_fault fault)
{
    switch (fault) {
    case ITEM_OK:
        break;
    case ITEM_NOT_READ:
        return CAUSE_SLOT_NOT_READ;
    case ITEM_SENTINEL:
        return CAUSE_SENTINEL;
    case ITEM_TRUNCATED:
        return CAUSE_INDEX_TRUNCATED;
    case ITEM_SHIFTED:
        return CAUSE_INDEX_SHIFTED;
    case ITEM_OTHER:
        return CAUSE_WRONG_ITEM;
    }
    return CAUSE_NONE;
}

/* Bytes that are no tree: of what a comparison with the tree shows the most frequent, the first of
 * equal ones. */
static enum cause tree_cause(const struct explain_tree *tree)
{
    const struct bvh *bvh = tree->bvh;
    uint32_t count[CAUSE_COUNT] = {0};
    enum cause most = CAUSE_UNEXPLAINED;
    for (uint32_t i = 0; i < bvh->node_count; i++) {
        const struct bvh_node *node = &bvh->node[i];
        for (uint32_t slot = 0; slot < node->item_count; slot++) {
            uint32_t stored;
            count[item_cause(explain_item_fault(tree, i, slot, &stored))]++;
        }
        enum ref_fault ref = node->item_count ? REF_OK : explain_ref_fault(tree, i);
        if (ref != REF_OK)
            count[ref == REF_TRUNCATED ? CAUSE_REFERENCE_TRUNCATED : CAUSE_CHILD_REFERENCE]++;
    }
    for (enum cause cause = CAUSE_COUNT; cause-- > CAUSE_NONE + 1;)
        if (count[cause] > 0 && count[cause] >= count[most])
            most = cause;
    return most;
}

static enum cause bound_cause(enum bound_fault fault)
{
    switch (fault) {
    case BOUND_OK:
        break;
    case BOUND_OVERFLOW:
        return CAUSE_HALF_OVERFLOW;
    case BOUND_FLUSHED:
        return CAUSE_HALF_SUBNORMAL_FLUSHED;
    case BOUND_ROUNDED:
        return CAUSE_ROUNDED_INWARD;
    case BOUND_STORED:
        return CAUSE_STORED_BOX;
    case BOUND_CUT:
        return CAUSE_CUT_BOX;
    }
    return CAUSE_UNEXPLAINED;
}

/* The cause that belongs to the first rule that packed_check found broken. */
static enum cause rule_cause(enum packed_rule rule)
{
    static const enum cause causes[] = {
        [PACKED_SOUND] = CAUSE_UNEXPLAINED,       [PACKED_REFERENCE] = CAUSE_CHILD_REFERENCE,
        [PACKED_STACK] = CAUSE_STACK_NEED,        [PACKED_ITEM] = CAUSE_ITEM_RANGE,
        [PACKED_TWICE] = CAUSE_TRIANGLE_TWICE,    [PACKED_VERTICES] = CAUSE_STORED_TRIANGLE,
        [PACKED_LOST] = CAUSE_TRIANGLE_LOST,      [PACKED_BOUND] = CAUSE_BOUND_TOO_SMALL,
        [PACKED_RECORD] = CAUSE_RECORD_MALFORMED, [PACKED_RESULT] = CAUSE_PACK_RESULT,
        [PACKED_DEVICE] = CAUSE_DEVICE_BUILD,
    };
    return causes[rule];
}

/* The cause of the first stored bound that differs from the tree's. */
static enum cause box_cause(const struct explain_tree *tree)
{
    for (uint32_t i = 0; i < tree->bvh->node_count; i++) {
        if (tree->record[i] == EXPLAIN_NONE)
            continue;
        const struct box *canonical = &tree->bvh->node[i].bounds, *exact = &tree->exact[i];
        struct box box = tree->packed->layout->box(tree->packed, tree->record[i]);
        for (int k = 0; k < 3; k++) {
            enum bound_fault lo =
                explain_bound_fault(box.lo[k], canonical->lo[k], exact->lo[k], false);
            enum bound_fault hi =
                explain_bound_fault(box.hi[k], canonical->hi[k], exact->hi[k], true);
            if (lo != BOUND_OK || hi != BOUND_OK)
                return bound_cause(lo != BOUND_OK ? lo : hi);
        }
    }
    return CAUSE_UNEXPLAINED;
}

/* The seat's engine prepared with a stage, and what its answers are compared with. */
struct explain_asked {
    struct job job;
    struct judged judged;
    bool possible; /* else the engine refused, and `judged` is zero */
};

static enum status ask_anew(const struct seat *seat, const struct play_stage *stage,
                            struct explain_asked *out, struct reason *reason)
{
    *out = (struct explain_asked){.job = stage_job(stage, seat)};
    enum status status = stage_prepare(stage, seat, reason);
    if (status)
        return status == STATUS_MEMORY ? status : STATUS_OK;
    const struct judged_job from = {.engine = seat->engine,
                                    .self = seat->self,
                                    .job = &out->job,
                                    .bvh =
                                        seat->layout ? stage_tree(stage, seat->layout_index) : NULL,
                                    .oracle = stage->oracle};
    status = judged_make(&from, &out->judged, reason);
    out->possible = status == STATUS_OK;
    return status;
}

/* The cause of an answer to a ray, from asking anew. */
static enum status ray_cause(struct judged *judged, const struct ray *ray,
                             struct fuzz_finding *finding, struct reason *reason)
{
    struct judged_ray again;
    enum status status = judged_explain(judged, ray, &again, reason);
    if (status)
        return status;
    enum cause *cause = &finding->signature.cause;
    bool finished = finding->signature.kind != FUZZ_KIND_UNFINISHED;
    bool same = again.answer.finished == finished &&
                (!finished || memcmp(&again.answer.hit, &finding->answer, sizeof(struct hit)) == 0);
    *cause = again.why.cause == CAUSE_NONE ? CAUSE_UNEXPLAINED : again.why.cause;
    if (!same && (finished || again.why.cause == CAUSE_NONE))
        *cause = CAUSE_NOT_REPEATABLE;
    explain_free(&again.why);
    return STATUS_OK;
}

/* What only steps bring about has a cause of its own, so that no finding without steps hides it. */
static enum status stale_cause(const struct judged *judged, const struct engine_options *options,
                               const struct fuzz_trial *trial, struct fuzz_finding *finding,
                               struct reason *reason)
{
    bool right;
    if (finding->signature.cause == CAUSE_NOT_REPEATABLE)
        return STATUS_OK;
    enum status status = judged_fresh(judged, options, &trial->ray[finding->ray], &right, reason);
    if (!status && right)
        finding->signature.cause = CAUSE_STALE;
    return status;
}

/* Rays that finish one by one were not finished together. If it happens again, the flags show a
 * driver that counts the rounds of all lanes of a vector as those of one loop. */
static enum status together_cause(const struct seat *seat, const struct fuzz_trial *trial,
                                  struct fuzz_finding *finding, struct reason *reason)
{
    struct trace_report report = {0};
    struct hit *hit = alloc_zeroed(trial->ray_count, sizeof *hit);
    if (!hit)
        return fail(reason, STATUS_MEMORY, "no memory for %u rays", trial->ray_count);
    enum status status =
        seat->engine->trace(seat->self, trial->ray, trial->ray_count, hit, &report, reason);
    uint32_t ends = report.flags & (ABI_FLAG_STACK | ABI_FLAG_VISITS | ABI_FLAG_LOOP);
    if (status && ends == ABI_FLAG_LOOP)
        finding->signature.cause = CAUSE_LOOP_CAP;
    free(hit);
    return status == STATUS_MEMORY ? status : STATUS_OK;
}

/* How far an answer is from what is exactly right, in t; infinite if it is another triangle or its
 * t is no number. */
static double error_of(const struct hit *hit, uint32_t expected, double t_lo, double t_hi)
{
    if (hit->prim != expected || (hit->prim != ABI_NO_PRIM && !float_is_finite(hit->t)))
        return INFINITY;
    double middle = 0.5 * (t_lo + t_hi), off = fabs((double)hit->t - middle);
    return hit->prim == ABI_NO_PRIM || off == 0 ? 0 : off / fabs(middle);
}

/* A hit that was missed must be found, of any-hit rays any exact hit: that a miss became excusable
 * is no cure. Nor is it one that the verdict is another one though the answer is as far off as
 * before: the judge of an unknown formula measures by the scene, which axes of their own change.
 * What was no number is cured by any answer that is allowed. */
static bool is_cured(const struct fuzz_finding *finding, const struct judged_ray *answer, bool any,
                     int power)
{
    const struct oracle_answer *truth = &answer->truth;
    const struct judgement *before = &finding->judgement;
    enum fuzz_kind kind = finding->signature.kind;
    if (!answer->answer.finished || !answer->why.opinion.allowed)
        return false;
    if (kind == FUZZ_KIND_UNFINISHED)
        return true;
    if (fuzz_hit_is_scaled(&finding->answer, &answer->answer.hit, power))
        return false;
    if (kind == fuzz_kind_of_wrong(WRONG_NOT_FINITE))
        return true;
    if (any && kind == fuzz_kind_of_wrong(WRONG_MISSED))
        return answer->answer.hit.prim != ABI_NO_PRIM && answer->judgement.verdict == VERDICT_RIGHT;
    double was = error_of(&finding->answer, before->expected, before->t_lo, before->t_hi);
    const struct hit *hit = &answer->answer.hit;
    bool tied = answer->judgement.verdict == VERDICT_TIE; /* one of several at the expected t */
    double is = error_of(hit, tied ? hit->prim : truth->prim, truth->t_lo, truth->t_hi);
    return isfinite(is) && (kind == fuzz_kind_of_wrong(WRONG_BARYCENTRIC) || is <= 0.25 * was);
}

/* Has an engine from outside trace the ray at another scale. *was_asked: that was possible; *cured:
 * it is then right. */
static enum status ask_scaled(struct fuzz_player *player, const struct fuzz_trial *trial,
                              enum fuzz_scaling scaling, uint32_t step,
                              const struct fuzz_finding *finding, bool *was_asked, bool *cured,
                              struct reason *reason)
{
    const struct seat *seat = &player->seat[finding->contestant];
    struct play_stage *stage = &player->stage[0];
    struct fuzz_trial scaled;
    struct judged_ray answer;
    struct explain_asked asked = {.possible = false};
    bool possible;
    int power;
    *was_asked = *cured = false;
    enum status status =
        fuzz_trial_scaled(trial, finding->ray, scaling, step, &scaled, &power, &possible, reason);
    if (status || !possible)
        return status;
    status = stage_set(stage, player, &scaled, NULL, reason);
    if (!status && scaled.world.is) {
        status = stage_world_ask(stage, seat, &answer, was_asked, reason);
        if (!status && *was_asked)
            *cured = is_cured(finding, &answer, trial->query == QUERY_ANY, power);
    } else if (!status && (!seat->layout || stage->has_packed[seat->layout_index])) {
        status = ask_anew(seat, stage, &asked, reason);
    }
    if (asked.possible && !status &&
        (status = judged_explain(&asked.judged, scaled.ray, &answer, reason)) == STATUS_OK) {
        *was_asked = true;
        *cured = is_cured(finding, &answer, trial->query == QUERY_ANY, power);
        explain_free(&answer.why);
    }
    judged_free(&asked.judged);
    stage_clear(stage);
    fuzz_trial_free(&scaled);
    return status;
}

/* A constant that does not scale, or an underflow, has one place where it begins: all steps before
 * it are wrong, all after it are right. What is wrong now and then at any scale has no such place.
 */
static enum status scaled_cause(struct fuzz_player *player, const struct fuzz_trial *trial,
                                struct fuzz_finding *finding, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (enum fuzz_scaling how = 0; how < FUZZ_SCALINGS && !status; how++) {
        if (how == FUZZ_SCALE_AXES && !fuzz_trial_is_uneven(trial, finding->ray))
            break;
        bool asked, cured, once = false, again = false;
        status = ask_scaled(player, trial, how, FUZZ_SCALE_STEPS, finding, &asked, &cured, reason);
        bool last = asked && cured;
        for (uint32_t step = 1; step < FUZZ_SCALE_STEPS && last && !status; step++) {
            status = ask_scaled(player, trial, how, step, finding, &asked, &cured, reason);
            again = again || (asked && !cured && once);
            once = once || (asked && cured);
        }
        if (!status && last && !again) {
            finding->signature.cause = CAUSE_SCALE;
            return STATUS_OK;
        }
    }
    return status;
}

static enum status find_cause(struct fuzz_player *player, struct play_stage *stage,
                              struct fuzz_finding *finding, struct reason *reason)
{
    const struct seat *seat = &player->seat[finding->contestant];
    const enum fuzz_kind kind = finding->signature.kind;
    enum cause *cause = &finding->signature.cause;
    struct explain_asked asked;
    if (stage->trial->world.is)
        return kind == FUZZ_KIND_TREE
                   ? STATUS_OK
                   : stage_world_explain(stage, seat, &player->options, finding, reason);
    enum status status = ask_anew(seat, stage, &asked, reason);
    if (status || !asked.possible)
        return status;
    if (kind != FUZZ_KIND_TREE) {
        status = ray_cause(&asked.judged, &stage->trial->ray[finding->ray], finding, reason);
        if (!status && stage->trial->step_count > 0)
            status = stale_cause(&asked.judged, &player->options, stage->trial, finding, reason);
    } else if (asked.judged.has_tree) {
        *cause = tree_cause(&asked.judged.tree);
        if (*cause == CAUSE_UNEXPLAINED)
            *cause = box_cause(&asked.judged.tree);
    }
    if (!status && kind == FUZZ_KIND_UNFINISHED && *cause == CAUSE_NOT_REPEATABLE)
        status = together_cause(seat, stage->trial, finding, reason);
    judged_free(&asked.judged);
    return status;
}

/* Why a layout's program ends on the tree. */
static enum cause end_cause(const struct layout *layout, const struct bvh *bvh)
{
    switch (layout && layout->end ? layout->end(bvh, NULL) : LAYOUT_GOES_ON) {
    case LAYOUT_GOES_ON:
        break;
    case LAYOUT_END_LEAF:
        return CAUSE_LEAF_OVERFULL;
    case LAYOUT_END_ITEM:
        return CAUSE_ITEM_AS_NODE;
    }
    return CAUSE_UNEXPLAINED;
}

static enum status explain(struct fuzz_player *player, const struct fuzz_trial *trial,
                           struct fuzz_finding *finding, struct reason *reason)
{
    const struct seat *seat = &player->seat[finding->contestant];
    struct play_stage *stage = &player->stage[0];
    const enum fuzz_kind kind = finding->signature.kind;
    enum cause *cause = &finding->signature.cause;
    if (kind == FUZZ_KIND_CRASH || kind == FUZZ_KIND_HANG || kind == FUZZ_KIND_PROTOCOL)
        return STATUS_OK; /* no answer to explain, and tracing again would fail again */
    enum status status = stage_set(stage, player, trial, NULL, reason);
    if (!status && kind == FUZZ_KIND_REFUSED)
        *cause = stage->has_tree && !trial->world.is ? end_cause(seat->layout, &stage->bvh)
                                                     : CAUSE_UNEXPLAINED;
    else if (!status && (!seat->layout || stage->has_packed[seat->layout_index]) &&
             (finding->ray < trial->ray_count || kind == FUZZ_KIND_TREE))
        status = find_cause(player, stage, finding, reason);
    if (!status && kind == FUZZ_KIND_TREE && seat->layout && *cause == CAUSE_UNEXPLAINED)
        *cause = rule_cause(stage->rule[seat->layout_index]);
    stage_clear(stage);
    if (!status && (*cause == CAUSE_OUTSIDE || *cause == CAUSE_WORLD))
        status = scaled_cause(player, trial, finding, reason);
    return status;
}

enum status fuzz_explain(struct fuzz_player *player, const struct fuzz_trial *trial,
                         struct fuzz_finding *finding, struct reason *reason)
{
    struct fuzz_trial cut;
    if (finding->step == trial->step_count)
        return explain(player, trial, finding, reason);
    enum status status = trial_life_cut(trial, finding->step, &cut, reason);
    if (!status)
        status = explain(player, &cut, finding, reason);
    fuzz_trial_free(&cut);
    return status;
}

enum status fuzz_explain_scaled(struct fuzz_player *player, const struct fuzz_trial *trial,
                                uint32_t ray, struct judged_ray *answer, struct reason *reason)
{
    if (answer->why.cause != CAUSE_OUTSIDE)
        return STATUS_OK;
    struct fuzz_finding finding = {
        .signature = {.kind = answer->answer.finished ? fuzz_kind_of_wrong(answer->judgement.wrong)
                                                      : FUZZ_KIND_UNFINISHED,
                      .cause = CAUSE_OUTSIDE},
        .ray = ray,
        .answer = answer->answer.hit,
        .judgement = answer->judgement};
    enum status status = scaled_cause(player, trial, &finding, reason);
    answer->why.cause = finding.signature.cause;
    return status;
}
