#include "tests/exact_gmp_redecide.h"

#include "tests/exact_gmp_bounds.h"

#include <float.h>
#include <math.h>

const char *gmp_opinion_name(enum gmp_opinion opinion)
{
    static const char *const name[] = {"confirmed", "open", "overturned"};
    return opinion <= GMP_OVERTURNED ? name[opinion] : "unknown";
}

/* Spares the rationals what is far off: two edge products of surely opposite sign, by more than any
 * float32 formula errs (2^-16 of the product of the vectors' lengths; some 2^-19 is possible). */
static bool far_off(const struct ray *ray, float v[3][3])
{
    long double a[3][3], length[3] = {0, 0, 0}, d_length = 0;
    bool positive = false, negative = false;
    for (int k = 0; k < 3; k++) {
        d_length += fabsl((long double)ray->dir[k]);
        for (int c = 0; c < 3; c++) {
            a[c][k] = (long double)v[c][k] - (long double)ray->org[k];
            length[c] += fabsl(a[c][k]);
        }
    }
    for (int c = 0; c < 3; c++) {
        int one = (c + 1) % 3, two = (c + 2) % 3;
        long double sum = 0, limit = 0x1p-16L * d_length * length[one] * length[two];
        for (int k = 0; k < 3; k++) {
            int i = (k + 1) % 3, j = (k + 2) % 3;
            sum += (long double)ray->dir[k] * (a[one][i] * a[two][j] - a[one][j] * a[two][i]);
        }
        positive |= sum > limit;
        negative |= sum < -limit;
    }
    return positive && negative;
}

struct work {
    const struct scene *scene;
    const struct ray *ray;
    const struct model *model;
    const struct hit *answer;
    enum oracle_ends ends;
    struct gmp_pair pair;     /* of the triangle at hand */
    struct gmp_bounds bounds; /* likewise */
};

/* Loads triangle `prim`. */
static void look_at(struct work *work, uint32_t prim)
{
    float v[3][3];
    scene_tri(work->scene, prim, v);
    exact_gmp_pair(work->ray, v, &work->pair);
    gmp_bounds_of(work->model, work->ray, v, &work->bounds);
}

/* fl(x) is one of the two floats around x, or x itself. */
static bool rounds_to(const mpq_t x, float value)
{
    return float_is_finite(value) &&
           exact_gmp_compare(x, (double)nextafterf(value, -INFINITY)) >= 0 &&
           exact_gmp_compare(x, (double)nextafterf(value, INFINITY)) <= 0;
}

/* What the named triangle alone proves against the answer. */
static enum gmp_proof against_named(struct work *work)
{
    const struct hit *answer = work->answer;
    look_at(work, answer->prim);
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

/* Whether the triangle at hand must be accepted, and so much nearer than the answer that no tree
 * may have turned it away for that: t + 2 E + 32 u t is before it. */
static bool surely_nearer(const struct work *work)
{
    const struct gmp_bounds *bounds = &work->bounds;
    mpq_t limit, margin;
    mpq_inits(limit, margin, NULL);
    mpq_abs(limit, bounds->t.v);
    mpq_div_2exp(limit, limit, 19);
    mpq_mul_2exp(margin, bounds->t.e, 1);
    mpq_add(limit, limit, margin);
    mpq_add(limit, limit, bounds->t.v);
    bool nearer = exact_gmp_compare(limit, (double)work->answer->t) < 0;
    mpq_clears(limit, margin, NULL);
    return nearer;
}

/* What the other triangles prove against it: one that must have been found instead. */
static enum gmp_proof against_others(struct work *work, bool miss, uint32_t *prim)
{
    for (uint32_t i = 0; i < work->scene->tri_count; i++) {
        float v[3][3];
        scene_tri(work->scene, i, v);
        if (far_off(work->ray, v))
            continue;
        look_at(work, i);
        if (!gmp_bounds_certain(&work->bounds, work->ray) ||
            !exact_gmp_hits(&work->pair, work->ends))
            continue;
        *prim = i;
        if (miss)
            return GMP_PROOF_MISSED;
        if (surely_nearer(work))
            return GMP_PROOF_NEARER;
    }
    *prim = ABI_NO_PRIM;
    return GMP_PROOF_NONE;
}

/* Nothing exact is hit by a miss; or the named triangle is one of the nearest, or any for an
 * any-hit query, and every number the exact one rounded. */
static bool is_right(struct work *work, bool any)
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

static bool any_possible(struct work *work)
{
    for (uint32_t i = 0; i < work->scene->tri_count; i++) {
        float v[3][3];
        scene_tri(work->scene, i, v);
        if (far_off(work->ray, v))
            continue;
        look_at(work, i);
        if (gmp_bounds_possible(&work->bounds, work->ray))
            return true;
    }
    return false;
}

static enum gmp_proof find_proof(struct work *work, bool any, uint32_t *prim)
{
    uint32_t named = work->answer->prim;
    *prim = named;
    if (named == ABI_NO_PRIM)
        return against_others(work, true, prim);
    if (any && work->model->any_unnamed)
        return any_possible(work) ? GMP_PROOF_NONE : GMP_PROOF_PHANTOM;
    if (named >= work->scene->tri_count)
        return GMP_PROOF_NO_TRIANGLE;
    enum gmp_proof proof = against_named(work);
    return proof || any ? proof : against_others(work, false, prim);
}

struct gmp_second exact_gmp_redecide(const struct scene *scene, const struct ray *ray,
                                     const struct model *model, bool any, const struct hit *answer)
{
    struct gmp_second second = {GMP_OPEN, GMP_PROOF_NONE, ABI_NO_PRIM};
    struct work work = {.scene = scene,
                        .ray = ray,
                        .model = model,
                        .answer = answer,
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
    }
    exact_gmp_clear(&work.pair);
    gmp_bounds_clear(&work.bounds);
    return second;
}
