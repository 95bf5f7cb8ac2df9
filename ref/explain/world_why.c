#include "ref/explain/world_why.h"

#include "ref/world/world_boxes.h"

#include <math.h>
#include <stdlib.h>

#define ENOUGH(told, of) (10 * (uint64_t)(told) >= 9 * (uint64_t)(of))
#define RIM              0x1p-12
#define NEAR_T           0x1p-10

/* Indices of the answers that are compared. */
struct why_sample {
    size_t at[WORLD_WHY_MOST];
    uint32_t count;
};

static bool is_wrong(const struct world_evidence *a, size_t i)
{
    return a->judgement[i].verdict == VERDICT_WRONG;
}

/* Chooses WRONG answers or others, evenly spread over their number. */
static void choose(const struct world_evidence *a, bool wrong, size_t all, struct why_sample *out)
{
    size_t seen = 0;
    out->count = 0;
    for (size_t i = 0; i < a->count; i++) {
        if (is_wrong(a, i) != wrong)
            continue;
        size_t before = seen * WORLD_WHY_MOST / all, after = (seen + 1) * WORLD_WHY_MOST / all;
        seen++;
        if (all <= WORLD_WHY_MOST || before != after)
            out->at[out->count++] = i;
    }
}

static bool is_same(const struct world_evidence *a, size_t i, const struct hit *hit, uint32_t tag)
{
    const struct hit *given = &a->hit[i];
    const bool any = a->query == QUERY_ANY || (a->mode[i].flags & ABI_RAY_FIRST);
    if ((given->prim == ABI_NO_PRIM) != (hit->prim == ABI_NO_PRIM))
        return false;
    if (hit->prim == ABI_NO_PRIM || any)
        return any || a->tag[i] == tag;
    double apart = fabs((double)given->t - (double)hit->t);
    return given->prim == hit->prim && a->tag[i] == tag && apart <= NEAR_T * fabs((double)hit->t);
}

static uint32_t told_by(const struct world_evidence *a, const struct world_look *look,
                        const struct why_sample *chosen)
{
    uint32_t told = 0;
    for (uint32_t k = 0; k < chosen->count; k++) {
        const size_t i = chosen->at[k];
        struct hit hit;
        uint32_t tag;
        world_look_trace(look, a->query, &a->ray[i], a->mode[i], &a->hit[i], &hit, &tag);
        told += is_same(a, i, &hit, tag);
    }
    return told;
}

/* --- boxes ------------------------------------------------------------------------------------ */

/* Whether the ray passes only the rim of a box. */
static bool passes_rim(const struct ray *ray, const struct box *box)
{
    double from = (double)ray->tmin, to = (double)ray->tmax;
    for (int k = 0; k < 3; k++) {
        double lo = (double)box->lo[k], hi = (double)box->hi[k], d = (double)ray->dir[k];
        double rim = RIM * (hi - lo), o = (double)ray->org[k];
        lo += rim;
        hi -= rim;
        if (d == 0 && (o <= lo || o >= hi))
            return true;
        if (d == 0)
            continue;
        from = fmax(from, fmin((lo - o) / d, (hi - o) / d));
        to = fmin(to, fmax((lo - o) / d, (hi - o) / d));
    }
    return from >= to;
}

static bool is_at_rim(const struct world_evidence *a, size_t i, uint32_t lost,
                      const struct box *box)
{
    if (lost == a->hit[i].prim || lost >= world_tri_count(a->world))
        return false;
    return passes_rim(&a->ray[i], &box[world_instance_of(a->world, lost)]);
}

/* Counts WRONG answers that lose a hit of an instance whose box the ray only touches. */
static uint32_t count_rim(const struct world_evidence *a, const struct why_sample *wrong,
                          const struct box *box)
{
    uint32_t count = 0;
    for (uint32_t k = 0; k < wrong->count; k++) {
        const struct judgement *j = &a->judgement[wrong->at[k]];
        count += is_at_rim(a, wrong->at[k], j->expected, box) ||
                 (j->behind && is_at_rim(a, wrong->at[k], j->lost, box));
    }
    return count;
}

static enum status look_at_boxes(const struct world_evidence *a, const struct why_sample *wrong,
                                 struct world_why *out, struct reason *reason)
{
    struct box *box;
    enum status status = world_boxes_make(a->world, WORLD_BOXES_AUTO, &box, reason);
    if (status)
        return status;
    out->at_the_rim = count_rim(a, wrong, box);
    free(box);
    if (ENOUGH(out->at_the_rim, wrong->count))
        out->cause = WORLD_CAUSE_BOX;
    return STATUS_OK;
}

/* --- defects ---------------------------------------------------------------------------------- */

static enum status try_defects(const struct world_evidence *a, const struct why_sample *wrong,
                               const struct why_sample *other, struct world_why *out,
                               struct reason *reason)
{
    struct world_look look;
    uint32_t most = 0;
    enum status status = world_look_make(a->world, a->tri, &look, reason);
    for (enum world_defect d = 0; d < WORLD_DEFECT_COUNT && !status; d++) {
        struct world_attempt *attempt = &out->attempt[d];
        world_look_bend(&look, d);
        attempt->told_wrong = told_by(a, &look, wrong);
        attempt->told_other = told_by(a, &look, other);
        uint32_t told = attempt->told_wrong + attempt->told_other;
        if (d == WORLD_DEFECT_NONE || told <= most || !ENOUGH(attempt->told_wrong, wrong->count) ||
            !ENOUGH(attempt->told_other, other->count))
            continue;
        most = told;
        out->defect = d;
        out->cause = world_defect_about(d)->cause;
    }
    world_look_free(&look);
    return status;
}

/* --- what is known of the bytes --------------------------------------------------------------- */

static const enum world_cause part_cause[RECORD_PART_COUNT] = {
    [RECORD_FIRST] = WORLD_CAUSE_INDEX,        [RECORD_MESH] = WORLD_CAUSE_INDEX,
    [RECORD_CUSTOM] = WORLD_CAUSE_INDEX,       [RECORD_MASK] = WORLD_CAUSE_MASK,
    [RECORD_FACING] = WORLD_CAUSE_CULL,        [RECORD_OPACITY] = WORLD_CAUSE_OPACITY,
    [RECORD_IDENTITY] = WORLD_CAUSE_TRANSFORM, [RECORD_TRANSLATION] = WORLD_CAUSE_TRANSFORM,
    [RECORD_INVERSE] = WORLD_CAUSE_TRANSFORM,
};

/* A defect says more than the record in which it lies; a tree that loses triangles goes first. */
static void look_at_bytes(const struct world_faults *faults, struct world_why *out)
{
    if (!faults || faults->first == WORLD_SOUND)
        return;
    if (faults->first != WORLD_RECORD) {
        out->defect = WORLD_DEFECT_NONE;
        out->cause = WORLD_CAUSE_BOX;
    } else if (out->defect == WORLD_DEFECT_NONE) {
        out->cause = part_cause[faults->part];
    }
}

enum status world_why(const struct world_evidence *answers, struct world_why *out,
                      struct reason *reason)
{
    struct why_sample wrong, other;
    *out = (struct world_why){.first = answers->count};
    for (size_t i = 0; i < answers->count; i++) {
        if (!is_wrong(answers, i))
            continue;
        out->kind[answers->judgement[i].wrong]++;
        out->first = out->wrong++ ? out->first : i;
    }
    if (out->wrong == 0)
        return STATUS_OK;
    out->cause = WORLD_CAUSE_UNKNOWN;
    choose(answers, true, out->wrong, &wrong);
    choose(answers, false, answers->count - out->wrong, &other);
    out->wrong_compared = wrong.count;
    out->other_compared = other.count;
    enum status status = try_defects(answers, &wrong, &other, out, reason);
    if (!status)
        look_at_bytes(answers->faults, out);
    if (!status && out->cause == WORLD_CAUSE_UNKNOWN)
        status = look_at_boxes(answers, &wrong, out, reason);
    return status;
}
