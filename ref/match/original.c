#include "ref/match/original.h"

#include "ref/oracle/exact.h"
#include "ref/trace/trace.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* The error of distances along a ray in double, in DBL_EPSILON of the largest coordinate. */
#define SLACK 4096.0

enum status original_make(const struct scene *scene, const struct quantised *quantised,
                          const struct ray *ray, size_t ray_count, struct original *out,
                          struct reason *reason)
{
    *out = (struct original){.scene = scene, .quantised = *quantised};
    enum status status = oracle_make(scene, &out->oracle, reason);
    if (!status)
        out->truth = alloc_zeroed(ray_count, sizeof *out->truth);
    if (!status && !out->truth)
        status = fail(reason, STATUS_MEMORY, "no memory for %zu rays", ray_count);
    if (!status)
        status = oracle_closest(out->oracle, ORACLE_TREE, ORACLE_CLOSED, ray, ray_count, 0,
                                out->truth, NULL, reason);
    if (status)
        original_free(out);
    return status;
}

uint32_t original_flat(const struct scene *decoded)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < decoded->tri_count; i++) {
        float v[3][3];
        scene_tri(decoded, i, v);
        count += exact_no_area(v);
    }
    return count;
}

void original_free(struct original *original)
{
    oracle_free(original->oracle);
    free(original->truth);
    *original = (struct original){0};
}

static double largest(const struct scene *scene)
{
    double most = 0.0;
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++)
        most = fmax(most, fabs((double)scene->vertex[i]));
    return most;
}

/* Counts the kind of a closest hit for the original. */
static void count_kind(const struct original *original, const struct ray *ray,
                       const struct oracle_answer *truth, const struct hit *hit, struct row *row)
{
    bool hits = truth->prim != ABI_NO_PRIM, answers = hit->prim != ABI_NO_PRIM;
    row->original.lost += hits && !answers;
    row->original.phantom += !hits && answers;
    if (!hits || !answers || hit->prim == truth->prim || row->options.query != QUERY_CLOSEST)
        return;
    struct oracle_pair pair;
    oracle_pair(original->oracle, ray, hit->prim, &pair);
    bool same = truth->tie_count > 1 && oracle_is_hit(&pair) &&
                oracle_compare(original->oracle, ray, hit->prim, truth->prim) == 0;
    row->original.other += !same;
}

static bool is_judged(const struct match *match, const struct ray *ray, const struct hit *hit)
{
    if (!ray_in_contract(ray))
        return false;
    return hit->prim == ABI_NO_PRIM ||
           (hit->prim < match->scene->tri_count && float_is_finite(hit->t));
}

enum status original_judge(const struct original *original, const struct match *match,
                           struct row *row)
{
    const struct model model = {.formula = TWIN_UNKNOWN};
    struct judge *here = NULL, *there = NULL;
    struct reason reason;
    if (row->status != ROW_OK || row->options.query == QUERY_ALL)
        return STATUS_OK;
    enum status status = judge_make(match->oracle, &model, row->options.query, &here, &reason);
    if (!status)
        status = judge_make(original->oracle, &model, row->options.query, &there, &reason);
    const double coordinate = largest(original->scene);
    for (size_t i = 0; i < match->ray_count && !status; i++) {
        const struct ray *ray = &match->ray[i];
        const struct hit *hit = &match->answer[i];
        double decoded = 0.0, need = 0.0;
        if (!is_judged(match, ray, hit))
            continue;
        status = judge_need(here, ray, &match->truth[i], hit, &decoded);
        if (!status)
            status = judge_need(there, ray, &original->truth[i], hit, &need);
        double far = coordinate;
        for (int k = 0; k < 3; k++)
            far = fmax(far, fabs((double)ray->org[k]));
        double most = original->quantised.distance + decoded + SLACK * DBL_EPSILON * far;
        row->original.judged++;
        row->original.most = fmax(row->original.most, need);
        row->original.most_decoded = fmax(row->original.most_decoded, decoded);
        row->original.beyond += !(need <= most);
        count_kind(original, ray, &original->truth[i], hit, row);
    }
    row->original.allowed = original->quantised.distance;
    row->differences += row->original.beyond;
    judge_free(here);
    judge_free(there);
    return status;
}
