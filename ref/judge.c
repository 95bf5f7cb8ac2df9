#include "ref/judge.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* (5.5 + 3) u of (|b| + |o|) / |d|: the error of b / d - o / d with Embree's reciprocal, rounded
 * up; it does not shrink with the distance to the box, so no factor on the far plane repairs it. */
#define SLAB_ERROR (9.0 * 0x1p-24)
/* How far outside a triangle's box, relative to the coordinates, a hit in its plane may be. */
#define IN_PLANE_PAD (64.0 * 0x1p-24)
/* Embree replaces smaller direction components by this one. */
#define EMBREE_LEAST_DIR 1e-18

const char *verdict_name(enum verdict verdict)
{
    static const char *const names[VERDICT_COUNT] = {
        "same", "tie", "near_tie", "boundary", "slab", "out_of_contract", "different",
    };
    return verdict < VERDICT_COUNT ? names[verdict] : "unknown";
}

struct judge judge_make(const struct scene *scene, const struct tri_test *tri, enum query query,
                        enum subject subject, bool reference_complete)
{
    struct judge judge = {.scene = scene,
                          .tri = tri,
                          .query = query,
                          .subject = subject,
                          .reference_complete = reference_complete};
    struct box box = scene_bounds(scene);
    for (int k = 0; k < 3 && scene->tri_count > 0; k++)
        judge.largest[k] = fmaxf(fabsf(box.lo[k]), fabsf(box.hi[k]));
    return judge;
}

static struct twin twin_of(const struct judge *judge, bool of_subject, const struct ray *ray,
                           uint32_t prim)
{
    float v[3][3];
    scene_tri(judge->scene, prim, v);
    if (of_subject && judge->subject == SUBJECT_EMBREE)
        return twin_eval(TWIN_EMBREE, ROUNDING_EMBREE, ray, v);
    if (of_subject && judge->subject == SUBJECT_EMBREE_ROBUST)
        return twin_eval(TWIN_EMBREE_ROBUST, ROUNDING_EMBREE, ray, v);
    return twin_eval(twin_of_tri(judge->tri->id), ROUNDING_IEEE, ray, v);
}

static bool same_bits(const struct hit *a, const struct hit *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

enum verdict judge_bits(const struct ray *ray, const struct hit *a, const struct hit *b)
{
    if (same_bits(a, b))
        return VERDICT_SAME;
    return ray_in_contract(ray) ? VERDICT_DIFFERENT : VERDICT_OUT_OF_CONTRACT;
}

/* True if Embree's default box test may miss the hit at `t` in triangle `prim`. In exact arithmetic
 * the slabs of every box around the triangle overlap at t. Computed ones can come apart only where
 * the gap between leaving one axis and entering another is within both errors; slabs of one axis
 * are rounded alike and stay in order. A box around more triangles has wider gaps and the errors of
 * at most the largest coordinate. `tbest` cuts the boxes behind it, so it has the same error. */
static bool slab_may_miss(const struct judge *judge, const struct ray *ray, uint32_t prim,
                          double tbest)
{
    struct box box = scene_tri_bounds(judge->scene, prim);
    double enter[3], leave[3], error[3];
    for (int k = 0; k < 3; k++) {
        double d = (double)ray->dir[k], o = (double)ray->org[k];
        if (fabs(d) < EMBREE_LEAST_DIR)
            d = EMBREE_LEAST_DIR;
        enter[k] = ((double)(d < 0 ? box.hi[k] : box.lo[k]) - o) / d;
        leave[k] = ((double)(d < 0 ? box.lo[k] : box.hi[k]) - o) / d;
        error[k] = SLAB_ERROR * ((double)judge->largest[k] + fabs(o)) / fabs(d);
    }
    for (int i = 0; i < 3; i++) {
        if (leave[i] - (double)ray->tmin <= error[i] || tbest - enter[i] <= error[i])
            return true;
        for (int j = 0; j < 3; j++)
            if (i != j && leave[j] - enter[i] <= error[i] + error[j])
                return true;
    }
    return false;
}

/* Is there a hit that no correct engine of the subject's kind can miss, clearly nearer than
 * `tbest`? Tests every triangle, so it is asked only when an answer is already in doubt. */
static bool certain_hit_before(const struct judge *judge, const struct ray *ray, double tbest)
{
    struct tri_ray r = tri_ray_make(ray);
    for (uint32_t prim = 0; prim < judge->scene->tri_count; prim++) {
        float v[3][3];
        struct hit hit;
        scene_tri(judge->scene, prim, v);
        if (!tri_test_run(judge->tri->id, &r, v, &hit) || (double)hit.t >= tbest)
            continue;
        struct twin own = twin_of(judge, false, ray, prim);
        struct twin theirs = twin_of(judge, true, ray, prim);
        if (!own.certain || !theirs.certain)
            continue;
        if (tbest <= (double)hit.t + own.t_err + theirs.t_err)
            continue;
        if (judge->subject == SUBJECT_EMBREE && slab_may_miss(judge, ray, prim, tbest))
            continue;
        return true;
    }
    return false;
}

/* One side lost the hit of `prim`, which the other found; `tbest` is what it answered instead. */
static enum verdict judge_lost(const struct judge *judge, const struct ray *ray, uint32_t prim,
                               double tbest)
{
    struct twin own = twin_of(judge, false, ray, prim);
    struct twin theirs = twin_of(judge, true, ray, prim);
    enum verdict verdict = VERDICT_DIFFERENT;
    if (!own.possible && !theirs.possible)
        return VERDICT_DIFFERENT;
    if (!own.certain || !theirs.certain)
        verdict = VERDICT_BOUNDARY;
    else if (judge->subject == SUBJECT_EMBREE && slab_may_miss(judge, ray, prim, tbest))
        verdict = VERDICT_SLAB;
    else
        return VERDICT_DIFFERENT;
    return certain_hit_before(judge, ray, tbest) ? VERDICT_DIFFERENT : verdict;
}

/* True if an own engine's hit is exactly what its triangle test says of that triangle. */
static bool hit_is_own(const struct judge *judge, const struct ray *ray, const struct hit *answer)
{
    if (answer->prim >= judge->scene->tri_count)
        return false;
    float v[3][3];
    struct hit hit;
    struct tri_ray r = tri_ray_make(ray);
    scene_tri(judge->scene, answer->prim, v);
    if (!tri_test_run(judge->tri->id, &r, v, &hit))
        return false;
    hit.prim = answer->prim;
    return same_bits(&hit, answer);
}

static enum verdict judge_any(const struct judge *judge, const struct ray *ray,
                              const struct hit *reference, const struct hit *answer)
{
    bool expected = reference->prim != ABI_NO_PRIM, got = answer->prim != ABI_NO_PRIM;
    if (got && judge->subject == SUBJECT_TREE && !hit_is_own(judge, ray, answer))
        return VERDICT_DIFFERENT;
    if (expected == got)
        return VERDICT_SAME;
    if (expected)
        return judge_lost(judge, ray, reference->prim, INFINITY);
    if (judge->subject == SUBJECT_TREE)
        return judge->reference_complete ? VERDICT_DIFFERENT
                                         : judge_lost(judge, ray, answer->prim, INFINITY);
    /* Embree does not name what it hit: some triangle must be possible for its formula. */
    for (uint32_t prim = 0; prim < judge->scene->tri_count; prim++)
        if (twin_of(judge, true, ray, prim).possible)
            return VERDICT_BOUNDARY;
    return VERDICT_DIFFERENT;
}

/* Is the answer's t right for the triangle it names, whatever the reference found? Where the
 * determinant's sign is open the ray lies in the triangle's plane, as far as float32 can tell: then
 * every t is right at which the ray is inside the triangle's box. */
static bool distance_is_of(const struct judge *judge, const struct ray *ray,
                           const struct hit *answer, double their_err)
{
    struct twin named = twin_of(judge, false, ray, answer->prim);
    double allowed = named.t_err + their_err;
    if (isfinite(allowed))
        return fabs((double)answer->t - (double)named.t) <= allowed;
    struct box box = scene_tri_bounds(judge->scene, answer->prim);
    for (int k = 0; k < 3; k++) {
        double o = (double)ray->org[k], at = o + (double)answer->t * (double)ray->dir[k];
        double pad = IN_PLANE_PAD * ((double)judge->largest[k] + fabs(o));
        if (!(at >= (double)box.lo[k] - pad && at <= (double)box.hi[k] + pad))
            return false;
    }
    return true;
}

/* Both found a hit, in different triangles or, for Embree, perhaps in the same. */
static enum verdict judge_two_hits(const struct judge *judge, const struct ray *ray,
                                   const struct hit *reference, const struct hit *answer)
{
    struct twin own = twin_of(judge, false, ray, reference->prim);
    struct twin theirs = twin_of(judge, true, ray, answer->prim);
    double apart = fabs((double)answer->t - (double)reference->t);
    double allowed = own.t_err + theirs.t_err;
    bool known = isfinite(allowed); /* else a determinant's sign is open: A3, not A2 */
    bool near = known && apart <= allowed;
    if (answer->prim == reference->prim)
        return near ? VERDICT_SAME : known ? VERDICT_DIFFERENT : VERDICT_BOUNDARY;
    if (judge->subject != SUBJECT_TREE && !theirs.possible)
        return VERDICT_DIFFERENT;
    if (!distance_is_of(judge, ray, answer, theirs.t_err))
        return VERDICT_DIFFERENT;
    if (answer->t == reference->t)
        return VERDICT_TIE;
    if (near)
        return VERDICT_NEAR_TIE;
    if (answer->t > reference->t)
        return judge_lost(judge, ray, reference->prim, (double)answer->t);
    if (judge->subject == SUBJECT_TREE && judge->reference_complete)
        return VERDICT_DIFFERENT; /* the reference tests all: nothing can be nearer */
    return judge_lost(judge, ray, answer->prim, (double)reference->t);
}

enum verdict judge_answer(const struct judge *judge, const struct ray *ray,
                          const struct hit *reference, const struct hit *answer)
{
    if (same_bits(reference, answer))
        return VERDICT_SAME;
    if (!ray_in_contract(ray))
        return VERDICT_OUT_OF_CONTRACT;
    if (judge->query == QUERY_ANY)
        return judge_any(judge, ray, reference, answer);
    bool expected = reference->prim != ABI_NO_PRIM, got = answer->prim != ABI_NO_PRIM;
    if (!expected && !got)
        return VERDICT_DIFFERENT; /* a miss has one spelling */
    if (got && answer->prim >= judge->scene->tri_count)
        return VERDICT_DIFFERENT;
    if (got && judge->subject == SUBJECT_TREE && !hit_is_own(judge, ray, answer))
        return VERDICT_DIFFERENT;
    if (expected && got)
        return judge_two_hits(judge, ray, reference, answer);
    if (expected)
        return judge_lost(judge, ray, reference->prim, INFINITY);
    if (judge->subject == SUBJECT_TREE && judge->reference_complete)
        return VERDICT_DIFFERENT;
    if (judge->subject != SUBJECT_TREE && !twin_of(judge, true, ray, answer->prim).possible)
        return VERDICT_DIFFERENT;
    return judge_lost(judge, ray, answer->prim, INFINITY);
}

static int print_hit(const struct hit *hit, char *text, size_t text_bytes)
{
    if (hit->prim == ABI_NO_PRIM)
        return snprintf(text, text_bytes, "miss");
    return snprintf(text, text_bytes, "prim=%u t=%a u=%a v=%a", hit->prim, (double)hit->t,
                    (double)hit->u, (double)hit->v);
}

void judge_line(const struct ray *ray, const struct hit *reference, const struct hit *answer,
                char *text, size_t text_bytes)
{
    char expected[128], got[128];
    print_hit(reference, expected, sizeof expected);
    print_hit(answer, got, sizeof got);
    snprintf(text, text_bytes, "o=(%a,%a,%a) d=(%a,%a,%a) t=[%a,%a] => %s  expected: %s",
             (double)ray->org[0], (double)ray->org[1], (double)ray->org[2], (double)ray->dir[0],
             (double)ray->dir[1], (double)ray->dir[2], (double)ray->tmin, (double)ray->tmax, got,
             expected);
}
