#include "tests/exact/exact_gmp_redecide.h"

#include "tests/exact/exact_gmp_bounds.h"
#include "tests/exact/exact_gmp_replay.h"

#include <float.h>
#include <math.h>

const char *gmp_opinion_name(enum gmp_opinion opinion)
{
    static const char *const name[] = {"confirmed", "open", "overturned"};
    return opinion <= GMP_OVERTURNED ? name[opinion] : "unknown";
}

static bool far_off(const struct ray *ray, float v[3][3])
{
    long double a[3][3];
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            a[c][k] = (long double)v[c][k] - (long double)ray->org[k];
    return exact_gmp_far_off(ray, a, 0);
}

struct redecide_work {
    const struct scene *scene;
    const struct ray *ray;
    const struct model *model;
    const struct hit *answer;
    enum oracle_ends ends;
    struct gmp_pair pair;     /* of the triangle at hand */
    struct gmp_bounds bounds; /* likewise */
    struct gmp_replay replay; /* likewise, if `replayed` */
    bool replayed;
    bool all_replayed; /* so were all that anyone looked at */
};

/* Loads triangle `prim`. */
static void look_at(struct redecide_work *work, uint32_t prim)
{
    float v[3][3];
    scene_tri(work->scene, prim, v);
    exact_gmp_pair(work->ray, v, &work->pair);
    work->replayed = exact_gmp_replay(work->model, work->ray, v, &work->replay);
    if (!work->replayed)
        gmp_bounds_of(work->model, work->ray, v, &work->bounds);
    work->all_replayed = work->all_replayed && work->replayed;
}

/* Whether the formula must accept the triangle at hand: by replay it does, or by bounds. */
static bool must_accept(const struct redecide_work *work)
{
    return work->replayed
               ? exact_gmp_replay_hits(&work->replay, work->ray, work->ends == ORACLE_OPEN)
               : gmp_bounds_certain(&work->bounds, work->ray);
}

/* fl(x) is one of the two floats around x, or x itself. */
static bool rounds_to(const mpq_t x, float value)
{
    return float_is_finite(value) &&
           exact_gmp_compare(x, (double)nextafterf(value, -INFINITY)) >= 0 &&
           exact_gmp_compare(x, (double)nextafterf(value, INFINITY)) <= 0;
}

/* A replay has one answer only. */
static enum gmp_proof against_replay(const struct redecide_work *work)
{
    const struct hit *answer = work->answer;
    const struct gmp_replay *replay = &work->replay;
    if (!must_accept(work))
        return GMP_PROOF_PHANTOM;
    if (!float_is_finite(answer->t) || !float_is_finite(answer->u) || !float_is_finite(answer->v))
        return GMP_PROOF_NOT_FINITE;
    if (answer->t != replay->t)
        return GMP_PROOF_DISTANCE;
    if (answer->u != replay->u || answer->v != replay->v)
        return GMP_PROOF_BARYCENTRIC;
    return GMP_PROOF_NONE;
}

/* What the named triangle alone proves against the answer. */
static enum gmp_proof against_named(struct redecide_work *work)
{
    const struct hit *answer = work->answer;
    look_at(work, answer->prim);
    if (work->replayed)
        return against_replay(work);
    const struct gmp_bounds *bounds = &work->bounds;
    if (!gmp_bounds_possible(bounds, work->ray))
        return GMP_PROOF_PHANTOM;
    if (!bounds->divided)
        return GMP_PROOF_NONE;
    if (!float_is_finite(answer->t) || !float_is_finite(answer->u) || !float_is_finite(answer->v))
        return GMP_PROOF_NOT_FINITE;
    if (!gmp_bounds_allow(&bounds->t, answer->t))
        return GMP_PROOF_DISTANCE;
    if (!gmp_bounds_allow(&bounds->u, answer->u) || !gmp_bounds_allow(&bounds->v, answer->v))
        return GMP_PROOF_BARYCENTRIC;
    return GMP_PROOF_NONE;
}

/* Whether the triangle at hand lies so much nearer than the answer that no tree may have turned it
 * away for that. Our box tests let in every box whose exact entry is before the nearest t so far
 * (docs/numerics.md), and the entry is before the exact t; so with a
 * replay both t are compared as they are. Else a box is entered within 32 u of the exact t, and the
 * formula's own t is off by E, as the answer's may be. */
static bool surely_nearer(const struct redecide_work *work)
{
    const struct gmp_bounds *bounds = &work->bounds;
    if (work->replayed)
        return work->pair.point && work->replay.t < work->answer->t &&
               exact_gmp_compare(work->pair.t, (double)work->answer->t) < 0;
    if (!bounds->divided)
        return false;
    mpq_t limit, margin;
    mpq_inits(limit, margin, NULL);
    mpq_mul_2exp(margin, bounds->t.e, 1);
    mpq_abs(limit, bounds->t.v);
    mpq_div_2exp(limit, limit, 19);
    mpq_add(limit, limit, margin);
    mpq_add(limit, limit, bounds->t.v);
    bool nearer = exact_gmp_compare(limit, (double)work->answer->t) < 0;
    mpq_clears(limit, margin, NULL);
    return nearer;
}

static bool share_a_corner(const struct scene *scene, uint32_t a, uint32_t b)
{
    float one[3][3], two[3][3];
    scene_tri(scene, a, one);
    scene_tri(scene, b, two);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (one[i][0] == two[j][0] && one[i][1] == two[j][1] && one[i][2] == two[j][2])
                return true;
    return false;
}

/* The triangle at hand must be accepted, and its absence or the answer's being farther is wrong. */
static bool should_be_there(const struct redecide_work *work)
{
    return must_accept(work) && (work->answer->prim == ABI_NO_PRIM || surely_nearer(work));
}

/* A watertight formula may reject the triangle that is hit, if the ray is within a rounding of its
 * border, but then accepts another at that border: one that shares a corner. */
static bool neighbour_should_be_there(struct redecide_work *work, uint32_t of, uint32_t *prim)
{
    for (uint32_t i = 0; i < work->scene->tri_count; i++) {
        if (i == of || !share_a_corner(work->scene, of, i))
            continue;
        look_at(work, i);
        if (work->replayed && should_be_there(work)) {
            *prim = i;
            return true;
        }
    }
    return false;
}

/* What the other triangles prove against it: one that must have been found instead. */
static enum gmp_proof against_others(struct redecide_work *work, uint32_t *prim)
{
    enum gmp_proof proof = work->answer->prim == ABI_NO_PRIM ? GMP_PROOF_MISSED : GMP_PROOF_NEARER;
    for (uint32_t i = 0; i < work->scene->tri_count; i++) {
        float v[3][3];
        scene_tri(work->scene, i, v);
        if (far_off(work->ray, v))
            continue;
        look_at(work, i);
        if (!exact_gmp_hits(&work->pair, work->ends))
            continue;
        *prim = i;
        if (should_be_there(work))
            return proof;
        if (work->model->watertight && work->replayed && !must_accept(work) &&
            neighbour_should_be_there(work, i, prim))
            return proof;
    }
    *prim = ABI_NO_PRIM;
    return GMP_PROOF_NONE;
}

/* Nothing exact is hit by a miss; or the named triangle is one of the nearest, or any for an
 * any-hit query, and every number the exact one rounded. */
static bool is_right(struct redecide_work *work, bool any)
{
    const struct hit *answer = work->answer;
    mpq_t nearest;
    bool right = false, hit = false;
    mpq_init(nearest);
    for (uint32_t i = 0; i < work->scene->tri_count; i++) {
        float v[3][3];
        scene_tri(work->scene, i, v);
        if (far_off(work->ray, v))
            continue;
        exact_gmp_pair(work->ray, v, &work->pair);
        if (!exact_gmp_hits(&work->pair, work->ends))
            continue;
        if (!hit || mpq_cmp(work->pair.t, nearest) < 0)
            mpq_set(nearest, work->pair.t);
        hit = true;
    }
    if (answer->prim == ABI_NO_PRIM) {
        right = !hit;
    } else if (any && work->model->any_unnamed) {
        right = hit;
    } else {
        look_at(work, answer->prim);
        right = exact_gmp_hits(&work->pair, work->ends) &&
                (any || mpq_cmp(work->pair.t, nearest) == 0) &&
                rounds_to(work->pair.t, answer->t) && rounds_to(work->pair.weight[1], answer->u) &&
                rounds_to(work->pair.weight[2], answer->v);
    }
    mpq_clear(nearest);
    return right;
}

static bool any_possible(struct redecide_work *work)
{
    for (uint32_t i = 0; i < work->scene->tri_count; i++) {
        float v[3][3];
        scene_tri(work->scene, i, v);
        if (far_off(work->ray, v))
            continue;
        look_at(work, i);
        if (work->replayed ? must_accept(work) : gmp_bounds_possible(&work->bounds, work->ray))
            return true;
    }
    return false;
}

static enum gmp_proof find_proof(struct redecide_work *work, bool any, uint32_t *prim)
{
    uint32_t named = work->answer->prim;
    *prim = named;
    if (named == ABI_NO_PRIM)
        return against_others(work, prim);
    if (any && work->model->any_unnamed)
        return any_possible(work) ? GMP_PROOF_NONE : GMP_PROOF_PHANTOM;
    if (named >= work->scene->tri_count)
        return GMP_PROOF_NO_TRIANGLE;
    enum gmp_proof proof = against_named(work);
    return proof || any ? proof : against_others(work, prim);
}

/* A miss is excused if every triangle was replayed and the formula rejects all that are hit, with
 * their neighbours if it promises to be watertight. */
static bool is_excused(const struct redecide_work *work)
{
    return work->answer->prim == ABI_NO_PRIM && work->all_replayed;
}

struct gmp_second exact_gmp_redecide(const struct scene *scene, const struct ray *ray,
                                     const struct model *model, bool any, const struct hit *answer)
{
    struct gmp_second second = {GMP_OPEN, GMP_PROOF_NONE, ABI_NO_PRIM};
    struct redecide_work work = {.scene = scene,
                                 .ray = ray,
                                 .model = model,
                                 .answer = answer,
                                 .all_replayed = model->formula != TWIN_UNKNOWN,
                                 .ends = model->open ? ORACLE_OPEN : ORACLE_CLOSED};
    bool no_triangle = answer->prim != ABI_NO_PRIM && answer->prim >= scene->tri_count;
    exact_gmp_init(&work.pair);
    gmp_bounds_init(&work.bounds);
    if (model->formula != TWIN_UNKNOWN)
        second.proof = find_proof(&work, any, &second.prim);
    else if (no_triangle && !model->any_unnamed)
        second.proof = GMP_PROOF_NO_TRIANGLE;
    if (second.proof) {
        second.opinion = GMP_CONFIRMED;
    } else if (!(no_triangle && !(any && model->any_unnamed)) && is_right(&work, any)) {
        second.opinion = GMP_OVERTURNED;
        second.proof = GMP_PROOF_RIGHT;
    } else if (is_excused(&work)) {
        second.opinion = GMP_OVERTURNED;
        second.proof = GMP_PROOF_EXCUSED;
    }
    exact_gmp_clear(&work.pair);
    gmp_bounds_clear(&work.bounds);
    return second;
}
