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
        "same", "tie", "near_tie", "boundary", "slab", "noise", "out_of_contract", "different",
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

/* Is the answer's t right for the triangle it names, whatever the reference found? */
enum distance {
    DISTANCE_RIGHT,
    DISTANCE_NOISE, /* the determinant is within its error of zero, and t is not on the triangle */
    DISTANCE_WRONG,
};

/* Where the determinant's sign is open the ray lies in the triangle's plane, as far as float32 can
 * tell: then every t is right at which the ray is inside the triangle's box, and any other is the
 * quotient of two roundings. */
static enum distance distance_of(const struct judge *judge, const struct ray *ray,
                                 const struct hit *answer, const struct twin *own,
                                 const struct twin *theirs)
{
    double allowed = own->t_err + theirs->t_err;
    if (!float_is_finite(answer->t))
        return DISTANCE_WRONG;
    if (isfinite(allowed))
        return fabs((double)answer->t - (double)own->t) <= allowed ? DISTANCE_RIGHT
                                                                   : DISTANCE_WRONG;
    struct box box = scene_tri_bounds(judge->scene, answer->prim);
    for (int k = 0; k < 3; k++) {
        double o = (double)ray->org[k], at = o + (double)answer->t * (double)ray->dir[k];
        double pad = IN_PLANE_PAD * ((double)judge->largest[k] + fabs(o));
        if (!(at >= (double)box.lo[k] - pad && at <= (double)box.hi[k] + pad))
            return judge->subject == SUBJECT_TREE ? DISTANCE_RIGHT : DISTANCE_NOISE;
    }
    return DISTANCE_RIGHT;
}

/* The same triangle twice: t within both bounds. */
static enum verdict judge_same_triangle(const struct twin *own, const struct twin *theirs,
                                        const struct hit *reference, const struct hit *answer)
{
    double allowed = own->t_err + theirs->t_err;
    if (!isfinite(allowed))
        return VERDICT_BOUNDARY;
    return fabs((double)answer->t - (double)reference->t) <= allowed ? VERDICT_SAME
                                                                     : VERDICT_DIFFERENT;
}

/* Two triangles at different t: who lost the nearer one, and may it?
 * The subject lost the reference's: near if its own t for that triangle could be as large as what
 * it answered. The reference lost the subject's: near if the reference's own t for that triangle is
 * no smaller than what it answered (it may have found the other first), or within both its bounds.
 */
static enum verdict judge_order(const struct judge *judge, const struct ray *ray,
                                const struct hit *reference, const struct hit *answer,
                                const struct twin *answer_own)
{
    struct twin own = twin_of(judge, false, ray, reference->prim);
    struct twin theirs = twin_of(judge, true, ray, reference->prim);
    double apart = fabs((double)answer->t - (double)reference->t);
    if (answer->t > reference->t) {
        double allowed =
            own.t_err + (judge->subject == SUBJECT_TREE ? answer_own->t_err : theirs.t_err);
        if (isfinite(allowed) && apart <= allowed)
            return VERDICT_NEAR_TIE;
        return judge_lost(judge, ray, reference->prim, (double)answer->t);
    }
    if (judge->subject == SUBJECT_TREE && judge->reference_complete)
        return VERDICT_DIFFERENT; /* the reference tests all: nothing can be nearer */
    double allowed = own.t_err + answer_own->t_err;
    double own_apart = (double)reference->t - (double)answer_own->t;
    if (own_apart <= 0.0 || (isfinite(allowed) && own_apart <= allowed))
        return VERDICT_NEAR_TIE;
    return judge_lost(judge, ray, answer->prim, (double)reference->t);
}

/* Both found a hit, in different triangles or, for Embree, perhaps in the same. */
static enum verdict judge_two_hits(const struct judge *judge, const struct ray *ray,
                                   const struct hit *reference, const struct hit *answer)
{
    struct twin own = twin_of(judge, false, ray, answer->prim);
    struct twin theirs = twin_of(judge, true, ray, answer->prim);
    if (answer->prim == reference->prim)
        return judge_same_triangle(&own, &theirs, reference, answer);
    if (judge->subject != SUBJECT_TREE && !theirs.possible)
        return VERDICT_DIFFERENT;
    enum distance distance = distance_of(judge, ray, answer, &own, &theirs);
    if (distance == DISTANCE_WRONG)
        return VERDICT_DIFFERENT;
    if (distance == DISTANCE_RIGHT)
        return answer->t == reference->t ? VERDICT_TIE
                                         : judge_order(judge, ray, reference, answer, &own);
    /* Noise hides what is behind it, but it excuses no certain hit before it. */
    if (answer->t > reference->t &&
        judge_order(judge, ray, reference, answer, &own) == VERDICT_DIFFERENT)
        return VERDICT_DIFFERENT;
    return VERDICT_NOISE;
}

/* The answer is a hit where the reference has none. */
static enum verdict judge_extra_hit(const struct judge *judge, const struct ray *ray,
                                    const struct hit *answer)
{
    if (judge->subject == SUBJECT_TREE && judge->reference_complete)
        return VERDICT_DIFFERENT;
    struct twin own = twin_of(judge, false, ray, answer->prim);
    struct twin theirs = twin_of(judge, true, ray, answer->prim);
    if (judge->subject != SUBJECT_TREE && !theirs.possible)
        return VERDICT_DIFFERENT;
    enum distance distance = distance_of(judge, ray, answer, &own, &theirs);
    if (distance == DISTANCE_WRONG)
        return VERDICT_DIFFERENT;
    if (distance == DISTANCE_NOISE)
        return VERDICT_NOISE;
    return judge_lost(judge, ray, answer->prim, INFINITY);
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
    return judge_extra_hit(judge, ray, answer);
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
