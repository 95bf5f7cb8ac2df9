#include "ref/judge/judge_all.h"

#include "ref/judge/judge_inner.h"
#include "ref/base/rng.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One list being judged. */
struct listing {
    const struct judge *judge;
    const struct ray *ray;
    const struct hit *hit;
    const uint32_t *tag; /* of each; NULL in a scene */
    size_t count;
    struct judge_found found;
    struct oracle_crossing *crossing;
    size_t crossings;
    struct list_judgement *out;
};

/* Hit `at` of the list is at fault; l->count: one that is lost. */
static void wrong(struct listing *l, enum wrong kind, size_t at)
{
    judge_set_wrong(&l->out->judgement, kind);
    l->out->at_fault = at < l->count ? l->hit[at] : hit_none();
    l->out->tag = at < l->count && l->tag ? l->tag[at] : 0;
}

static bool is_wrong(const struct listing *l)
{
    return l->out->judgement.verdict == VERDICT_WRONG;
}

/* Adds a class that the list needs. */
static void need(struct listing *l, enum verdict verdict)
{
    if (verdict > l->out->judgement.verdict)
        l->out->judgement.verdict = verdict;
}

static void expect(struct listing *l, uint32_t prim, double t_lo, double t_hi)
{
    l->out->judgement.expected = prim;
    l->out->judgement.t_lo = t_lo;
    l->out->judgement.t_hi = t_hi;
}

static int by_prim(const void *left, const void *right)
{
    const struct judge_slot *a = left, *b = right;
    int order = order_numbers(a->prim, b->prim);
    return order ? order : order_numbers(a->at, b->at);
}

/* Indexes the list by triangle; WRONG if one stands there twice. */
static void index_list(struct listing *l)
{
    struct judge_slot *slot = l->found.slot;
    for (size_t i = 0; i < l->count; i++)
        slot[i] = (struct judge_slot){l->hit[i].prim, (uint32_t)i};
    l->found.count = l->count;
    qsort(slot, l->count, sizeof *slot, by_prim);
    for (size_t i = 1; i < l->count && !is_wrong(l); i++)
        if (slot[i].prim == slot[i - 1].prim) {
            double t = (double)l->hit[slot[i - 1].at].t;
            wrong(l, WRONG_TWICE, slot[i].at);
            expect(l, slot[i].prim, t, t);
        }
}

/* The hit `at` is at fault. If its triangle has one that counts, that is what was expected. */
static void wrong_hit(struct listing *l, enum wrong kind, size_t at)
{
    const enum oracle_ends ends = l->judge->model.open ? ORACLE_OPEN : ORACLE_CLOSED;
    wrong(l, kind, at);
    for (size_t i = 0; i < l->crossings; i++) {
        const struct oracle_crossing *crossing = &l->crossing[i];
        if (crossing->prim == l->hit[at].prim && oracle_is_hit(&crossing->pair) &&
            oracle_in_range(&crossing->pair, ends))
            expect(l, crossing->prim, crossing->pair.t_lo, crossing->pair.t_hi);
    }
}

static void find_not_finite(struct listing *l)
{
    for (size_t i = 0; i < l->count && !is_wrong(l); i++)
        if (judge_finite(l->judge, l->ray, &l->hit[i]) == VERDICT_WRONG)
            wrong_hit(l, WRONG_NOT_FINITE, i);
}

/* Judges each listed triangle alone. */
static enum status judge_listed(struct listing *l)
{
    enum status status = STATUS_OK;
    const struct oracle_answer nothing = {.prim = ABI_NO_PRIM}; /* not possible: a phantom */
    struct judgement *sum = &l->out->judgement;
    bool unknown = l->judge->model.formula == TWIN_UNKNOWN;
    for (size_t i = 0; i < l->count && !is_wrong(l) && !status; i++) {
        bool anothers = false;
        struct judgement one = {.verdict = VERDICT_RIGHT};
        enum verdict verdict = judge_finite(l->judge, l->ray, &l->hit[i]);
        if (verdict == VERDICT_RIGHT)
            verdict = unknown
                          ? judge_named_by_distance(l->judge, l->ray, &nothing, &l->hit[i], &one)
                          : judge_named(l->judge, l->ray, &nothing, &l->hit[i], NULL, &one);
        sum->over = fmax(sum->over, one.over);
        sum->displacement = fmax(sum->displacement, one.displacement);
        sum->share = fmax(sum->share, one.share);
        if (verdict == VERDICT_WRONG)
            status = judge_is_anothers(l->judge, l->ray, &l->hit[i], &anothers);
        if (verdict == VERDICT_WRONG)
            wrong_hit(l, anothers ? WRONG_INSTANCE : one.wrong, i);
        else
            need(l, verdict);
    }
    return status;
}

/* Each t is within its bound of the exact one, so sorted ones are in order up to both bounds. */
static void judge_order(struct listing *l)
{
    for (size_t i = 1; i < l->count && !is_wrong(l); i++)
        if (l->hit[i - 1].t > l->hit[i].t) {
            double t = (double)l->hit[i].t;
            wrong(l, WRONG_ORDER, i - 1);
            expect(l, l->hit[i].prim, t, t);
        }
}

/* True if this hit is lost sooner for its edge than for an end of the range or a hit at `reach`. */
static bool beside_edge(const struct listing *l, const struct oracle_crossing *lost, double reach)
{
    return judge_loss_of(l->judge, l->ray, lost, reach).why == VERDICT_BOUNDARY;
}

/* For an unknown formula: one of the exact hits, chosen by the ray alone, represents the list in
 * the count of hits beside edges. Where triangles meet, one of them is enough. */
static void note_one(struct listing *l)
{
    struct judgement *sum = &l->out->judgement;
    const struct oracle_crossing *crossing = NULL;
    uint32_t hits = 0, bits[sizeof *l->ray / sizeof(uint32_t)];
    uint64_t seed = 0;
    memcpy(bits, l->ray, sizeof bits);
    for (size_t k = 0; k < ARRAY_COUNT(bits); k++)
        seed = rng_u64(&(struct rng){seed ^ bits[k]});
    for (size_t i = 0; i < l->crossings; i++)
        hits += oracle_is_hit(&l->crossing[i].pair);
    if (hits == 0)
        return;
    uint32_t at = (uint32_t)(seed % hits);
    for (size_t i = 0; i < l->crossings && !crossing; i++)
        if (oracle_is_hit(&l->crossing[i].pair) && at-- == 0)
            crossing = &l->crossing[i];
    sum->margin = judge_margin_of(l->judge, l->ray, crossing->prim);
    sum->edge_lost =
        !judge_find(&l->found, crossing->prim) && beside_edge(l, crossing, (double)INFINITY);
    for (size_t i = 0; i < l->count && sum->edge_lost; i++)
        sum->edge_lost = beside_edge(l, crossing, (double)l->hit[i].t);
}

/* A hit that an unknown formula left out. */
static enum status left_out_by_distance(struct listing *l, const struct oracle_crossing *crossing)
{
    bool closed = false;
    double limit;
    struct judge_loss loss = judge_loss_of(l->judge, l->ray, crossing, (double)INFINITY);
    struct judgement *sum = &l->out->judgement;
    sum->displacement = fmax(sum->displacement, loss.need);
    sum->share = fmax(sum->share, loss.over);
    if (loss.why == VERDICT_BOUNDARY) {
        enum status status =
            judge_fan(l->judge, l->ray, crossing->prim, &l->found, &closed, &limit);
        if (status)
            return status;
    }
    sum->fan = sum->fan || closed;
    if (loss.over > 1.0 || (l->judge->model.watertight && closed)) {
        wrong(l, WRONG_MISSED, l->count);
        expect(l, crossing->prim, crossing->pair.t_lo, crossing->pair.t_hi);
    } else {
        need(l, loss.why);
    }
    return STATUS_OK;
}

static enum status left_out(struct listing *l, const struct oracle_crossing *crossing)
{
    const struct oracle_pair *pair = &crossing->pair;
    bool lost = false;
    enum status status = judge_cannot_miss(l->judge, l->ray, crossing->prim, pair->t_lo, pair->t_hi,
                                           (double)INFINITY, &l->found, NULL, &lost);
    if (lost) {
        wrong(l, WRONG_MISSED, l->count);
        expect(l, crossing->prim, pair->t_lo, pair->t_hi);
    } else {
        need(l, judge_why_lost(l->judge, l->ray, crossing->prim, pair->t_lo, pair->t_hi,
                               (double)INFINITY, NULL));
    }
    return status;
}

/* Judges every exact hit: whether it is listed, and in its place. */
static enum status judge_left_out(struct listing *l)
{
    bool unknown = l->judge->model.formula == TWIN_UNKNOWN;
    const struct judge_slot *before = NULL;
    enum status status = STATUS_OK;
    for (size_t i = 0; i < l->crossings && !status && !is_wrong(l); i++) {
        const struct oracle_crossing *crossing = &l->crossing[i];
        if (!oracle_is_hit(&crossing->pair))
            continue;
        const struct judge_slot *slot = judge_find(&l->found, crossing->prim);
        if (!slot) {
            status = unknown ? left_out_by_distance(l, crossing) : left_out(l, crossing);
            continue;
        }
        if (before && slot->at < before->at &&
            oracle_compare(l->judge->oracle, l->ray, slot->prim, before->prim) != 0)
            need(l, VERDICT_NEAR_TIE);
        before = slot;
    }
    return status;
}

/* Judges what needs no arithmetic; true if that decides. */
static bool settled(struct listing *l)
{
    const struct judge *judge = l->judge;
    for (size_t i = 0; i < l->count; i++)
        if (l->hit[i].prim >= judge->tri_count) {
            wrong(l, WRONG_PHANTOM, i); /* whatever the ray */
            return true;
        }
    for (size_t i = 0; i < l->count && l->tag; i++) {
        enum wrong ruled = judge_ruled_out(judge, l->ray, &l->hit[i], l->tag[i]);
        if (ruled) {
            wrong(l, ruled, i);
            return true;
        }
    }
    if (!judge->in_contract || !ray_in_contract(l->ray)) {
        l->out->judgement.verdict = VERDICT_OUT_OF_CONTRACT;
        return true;
    }
    return false;
}

enum status judge_list_tagged(const struct judge *judge, const struct ray *ray,
                              const struct hit *hit, const uint32_t *tag, size_t count,
                              struct list_judgement *out)
{
    struct listing l = {
        .judge = judge, .ray = ray, .hit = hit, .tag = tag, .count = count, .out = out};
    size_t capacity = 0;
    *out = (struct list_judgement){.judgement = {.verdict = VERDICT_RIGHT, .expected = ABI_NO_PRIM},
                                   .at_fault = hit_none()};
    if (settled(&l))
        return STATUS_OK;
    l.found.slot = alloc_zeroed(count, sizeof *l.found.slot);
    enum status status = l.found.slot ? STATUS_OK : STATUS_MEMORY;
    if (!status)
        status =
            judge_crossings(judge, ray, (double)INFINITY, &l.crossing, &capacity, &l.crossings);
    if (!status) {
        find_not_finite(&l);
        if (!is_wrong(&l))
            index_list(&l);
        status = judge_listed(&l);
        judge_order(&l);
    }
    if (!status) {
        status = judge_left_out(&l);
    }
    const bool finite = out->judgement.wrong != WRONG_NOT_FINITE;
    if (!status && finite && judge->model.formula == TWIN_UNKNOWN)
        note_one(&l);
    free(l.found.slot);
    free(l.crossing);
    if (status)
        out->judgement.verdict = VERDICT_OUT_OF_CONTRACT;
    return status;
}

enum status judge_list(const struct judge *judge, const struct ray *ray, const struct hit *hit,
                       size_t count, struct list_judgement *out)
{
    return judge_list_tagged(judge, ray, hit, NULL, count, out);
}
