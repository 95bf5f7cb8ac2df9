#include "tests/exact/gmp_world_redecide.h"

#include "tests/exact/exact_gmp_replay.h"
#include "tests/exact/gmp_object_ray.h"
#include "tests/exact/gmp_steady.h"

#include <math.h>

/* A triangle that is looked at. */
struct world_work {
    const struct gmp_world_question *q;
    bool any;
    struct place place;
    struct gmp_pair pair;
    struct gmp_steady steady;
    bool replayed; /* what the formula makes of it is known, bit for bit */
    struct gmp_replay replay;
    uint32_t instance; /* whose ray `object` is; WORLD_NO_MESH: none yet */
    bool has_object;
    struct ray object;
    bool all_replayed;
};

static bool replay(struct world_work *w)
{
    const struct world *world = w->q->world;
    float v[3][3];
    if (!w->q->model->bits || !twin_is_own(w->q->model->formula))
        return false;
    if (w->instance != w->place.instance) {
        w->instance = w->place.instance;
        w->has_object = gmp_object_ray(&world->instance[w->instance], w->q->ray, &w->object);
    }
    scene_tri(world->mesh[w->place.mesh].scene, w->place.prim, v);
    return w->has_object && exact_gmp_replay(w->q->model, &w->object, v, &w->replay);
}

static void look_at(struct world_work *w, uint32_t prim)
{
    w->place = gmp_world_place(w->q->world, prim);
    gmp_world_pair(w->q->world, w->q->ray, prim, &w->pair);
    gmp_steady_load(w->q->world, w->q->ray, prim, &w->pair, &w->steady);
    w->replayed = replay(w);
    w->all_replayed = w->all_replayed && w->replayed;
}

/* Whether the filter has the same answer wherever u and v can come to; *passes is that. */
static bool filter_is_steady(const struct world_work *w, bool *passes)
{
    const struct filter_rule *filter = &w->q->world->filter;
    double u = 0, v = 0, off = 0;
    if (filter_reads_uv(filter)) {
        if (w->replayed && w->replay.accepted) {
            u = (double)w->replay.u;
            v = (double)w->replay.v;
        } else {
            if (!w->pair.point)
                return false;
            u = mpq_get_d(w->pair.weight[1]);
            v = mpq_get_d(w->pair.weight[2]);
            off = gmp_steady_weight(&w->steady) + 0x1p-20;
        }
        if (!(off < 1.0 / ABI_FILTER_GRID))
            return false;
    }
    int passed = 0;
    for (int k = 0; k < 4; k++) {
        float at[2] = {(float)fmin(fmax(u + (k & 1 ? off : -off), 0), 1),
                       (float)fmin(fmax(v + (k & 2 ? off : -off), 0), 1)};
        passed += filter_passes(filter, &w->place, at[0], at[1]);
    }
    *passes = passed == 4;
    return passed == 0 || passed == 4;
}

/* Whether the triangle at hand counts in every evaluation. */
static bool surely_counts(struct world_work *w, uint32_t prim)
{
    const struct instance *instance = &w->q->world->instance[w->place.instance];
    bool passes;
    enum oracle_admission exact =
        gmp_world_admit(w->q->world, w->q->ray, w->q->mode, prim, &w->pair);
    bool by_side = (w->q->mode.flags & (ABI_RAY_CULL_BACK | ABI_RAY_CULL_FRONT)) &&
                   !(instance->flags & ABI_INSTANCE_CULL_DISABLE);
    if (exact != ORACLE_ADMITTED && exact != ORACLE_FILTERED)
        return false;
    if (by_side && !gmp_steady_side(&w->steady))
        return false;
    /* Whether it is opaque: a filter that passes nothing would leave it out. */
    struct world none = *w->q->world;
    none.filter = (struct filter_rule){.kind = FILTER_NONE};
    if (gmp_world_admit(&none, w->q->ray, w->q->mode, prim, &w->pair) == ORACLE_ADMITTED)
        return true;
    return filter_is_steady(w, &passes) && passes;
}

/* Whether every evaluation hits the triangle at hand, in the ray's range. */
static bool surely_hit(const struct world_work *w, enum oracle_ends ends)
{
    if (!exact_gmp_hits(&w->pair, ends))
        return false;
    if (w->replayed)
        return exact_gmp_replay_hits(&w->replay, w->q->ray, ends == ORACLE_OPEN);
    return gmp_steady_hit(&w->steady) &&
           gmp_steady_t(&w->steady, w->pair.t, (double)w->q->ray->tmin) > 0 &&
           gmp_steady_t(&w->steady, w->pair.t, (double)w->q->ray->tmax) < 0;
}

/* --- the named triangle ----------------------------------------------------------------------- */

static bool apart(const struct world_work *w, int weight, float value)
{
    double off = gmp_steady_weight(&w->steady) + 0x1p-20;
    return fabs(mpq_get_d(w->pair.weight[weight]) - (double)value) > off;
}

static enum gmp_proof against_numbers(const struct world_work *w)
{
    const struct hit *hit = w->q->hit;
    const struct ray *ray = w->q->ray;
    bool finite = float_is_finite(hit->t) && float_is_finite(hit->u) && float_is_finite(hit->v);
    if (w->replayed) {
        if (!exact_gmp_replay_hits(&w->replay, ray, w->q->model->open))
            return GMP_PROOF_PHANTOM;
        if (!finite)
            return GMP_PROOF_NOT_FINITE;
        if (hit->t != w->replay.t)
            return GMP_PROOF_DISTANCE;
        return hit->u != w->replay.u || hit->v != w->replay.v ? GMP_PROOF_BARYCENTRIC
                                                              : GMP_PROOF_NONE;
    }
    if (!gmp_steady_hit(&w->steady) || !w->pair.point)
        return GMP_PROOF_NONE;
    if (w->pair.class == ORACLE_MISS)
        return GMP_PROOF_PHANTOM;
    if (!finite)
        return GMP_PROOF_NOT_FINITE;
    if (hit->t < ray->tmin || hit->t > ray->tmax ||
        gmp_steady_t(&w->steady, w->pair.t, (double)hit->t) != 0)
        return GMP_PROOF_DISTANCE;
    return apart(w, 1, hit->u) || apart(w, 2, hit->v) ? GMP_PROOF_BARYCENTRIC : GMP_PROOF_NONE;
}

static bool other_side(const struct world_work *w, bool tagged_front)
{
    const struct instance *instance = &w->q->world->instance[w->place.instance];
    bool front = gmp_world_facing(w->q->world, w->q->ray, w->q->hit->prim) < 0;
    if (instance->flags & ABI_INSTANCE_FLIP_FACING)
        front = !front;
    return front != tagged_front && gmp_steady_side(&w->steady);
}

static enum gmp_proof against_named(struct world_work *w)
{
    const struct gmp_world_question *q = w->q;
    const uint32_t prim = q->hit->prim;
    bool passes;
    look_at(w, prim);
    switch (gmp_world_admit(q->world, q->ray, q->mode, prim, &w->pair)) {
    case ORACLE_MASKED:
        return GMP_PROOF_MASKED;
    case ORACLE_CULLED_OPACITY:
        return GMP_PROOF_OPACITY;
    case ORACLE_CULLED_FACING:
        if (gmp_steady_side(&w->steady))
            return GMP_PROOF_CULLED;
        break;
    case ORACLE_FILTERED:
        if (filter_is_steady(w, &passes) && !passes)
            return GMP_PROOF_OPACITY;
        break;
    case ORACLE_ADMITTED:
    case ORACLE_ADMISSION_COUNT:
        break;
    }
    if ((q->tag & ABI_TAG_CUSTOM) != q->world->instance[w->place.instance].custom)
        return GMP_PROOF_TAG;
    if (other_side(w, q->tag & ABI_TAG_FRONT))
        return GMP_PROOF_FACING;
    return against_numbers(w);
}

/* --- the others ------------------------------------------------------------------------------- */

/* Spares the rationals what is far off: two edge products of surely opposite sign, by more than
 * placing a vertex in long double errs. */
static bool far_off(const struct instance *instance, const struct ray *ray, float p[3][3])
{
    long double a[3][3], length[3] = {0, 0, 0}, d_length = 0, slack = 0;
    bool positive = false, negative = false;
    for (int k = 0; k < 3; k++) {
        d_length += fabsl((long double)ray->dir[k]);
        for (int c = 0; c < 3; c++) {
            long double sum = (long double)instance->m[k][3], size = fabsl(sum);
            for (int j = 0; j < 3; j++) {
                sum += (long double)instance->m[k][j] * (long double)p[c][j];
                size += fabsl((long double)instance->m[k][j] * (long double)p[c][j]);
            }
            a[c][k] = sum - (long double)ray->org[k];
            length[c] += fabsl(a[c][k]);
            slack = fmaxl(slack, 0x1p-58L * (size + fabsl((long double)ray->org[k])));
        }
    }
    for (int c = 0; c < 3; c++) {
        int one = (c + 1) % 3, two = (c + 2) % 3;
        long double sum = 0, size = (length[one] + slack) * (length[two] + slack);
        long double limit = d_length * (0x1p-16L * size + slack * (length[one] + length[two]));
        for (int k = 0; k < 3; k++) {
            int i = (k + 1) % 3, j = (k + 2) % 3;
            sum += (long double)ray->dir[k] * (a[one][i] * a[two][j] - a[one][j] * a[two][i]);
        }
        positive |= sum > limit;
        negative |= sum < -limit;
    }
    return positive && negative;
}

/* The triangle at hand is surely hit, and nearer than the answer. */
static bool proves_nearer(const struct world_work *w)
{
    double answered = (double)w->q->hit->t;
    if (w->replayed)
        return w->replay.t < w->q->hit->t && exact_gmp_compare(w->pair.t, answered) < 0;
    return gmp_steady_t(&w->steady, w->pair.t, answered) < 0;
}

/* Goes through all placed triangles near the ray. Sets *right if the answer is the exact one as far
 * as distances go. */
static enum gmp_proof against_others(struct world_work *w, uint32_t *prim, bool *right)
{
    const struct gmp_world_question *q = w->q;
    const enum oracle_ends ends = q->model->open ? ORACLE_OPEN : ORACLE_CLOSED;
    const bool missed = q->hit->prim == ABI_NO_PRIM;
    uint32_t number = 0;
    *right = true;
    for (uint32_t i = 0; i < q->world->instance_count; i++) {
        const struct scene *scene = world_scene(q->world, i);
        for (uint32_t k = 0; scene && k < scene->tri_count; k++, number++) {
            float p[3][3];
            scene_tri(scene, k, p);
            if (far_off(&q->world->instance[i], q->ray, p))
                continue;
            gmp_world_pair(q->world, q->ray, number, &w->pair);
            if (!exact_gmp_hits(&w->pair, ends))
                continue;
            look_at(w, number);
            bool counts =
                gmp_world_admit(q->world, q->ray, q->mode, number, &w->pair) == ORACLE_ADMITTED;
            *right &=
                !counts ||
                (missed ? false
                        : w->any || exact_gmp_compare(
                                        w->pair.t, (double)nextafterf(q->hit->t, -INFINITY)) >= 0);
            if ((missed || (!w->any && proves_nearer(w))) && surely_counts(w, number) &&
                surely_hit(w, ends)) {
                *prim = number;
                return missed ? GMP_PROOF_MISSED : GMP_PROOF_NEARER;
            }
        }
    }
    return GMP_PROOF_NONE;
}

/* fl(x) is one of the two floats around x, or x itself. */
static bool rounds_to(const mpq_t x, float value)
{
    return float_is_finite(value) &&
           exact_gmp_compare(x, (double)nextafterf(value, -INFINITY)) >= 0 &&
           exact_gmp_compare(x, (double)nextafterf(value, INFINITY)) <= 0;
}

/* The named triangle counts, is hit, has this side and these numbers. */
static bool named_is_right(struct world_work *w)
{
    const struct gmp_world_question *q = w->q;
    look_at(w, q->hit->prim);
    const struct instance *instance = &q->world->instance[w->place.instance];
    bool front = gmp_world_facing(q->world, q->ray, q->hit->prim) < 0;
    if (instance->flags & ABI_INSTANCE_FLIP_FACING)
        front = !front;
    return exact_gmp_hits(&w->pair, q->model->open ? ORACLE_OPEN : ORACLE_CLOSED) &&
           gmp_world_admit(q->world, q->ray, q->mode, q->hit->prim, &w->pair) == ORACLE_ADMITTED &&
           q->tag == (instance->custom | (front ? ABI_TAG_FRONT : 0)) &&
           rounds_to(w->pair.t, q->hit->t) && rounds_to(w->pair.weight[1], q->hit->u) &&
           rounds_to(w->pair.weight[2], q->hit->v);
}

static void decide(struct world_work *w, struct gmp_second *out)
{
    const struct gmp_world_question *q = w->q;
    const bool missed = q->hit->prim == ABI_NO_PRIM;
    bool right;
    out->prim = q->hit->prim;
    if (missed && q->tag != 0)
        out->proof = GMP_PROOF_TAG;
    else if (!missed && q->hit->prim >= world_tri_count(q->world))
        out->proof = GMP_PROOF_NO_TRIANGLE;
    else if (!missed)
        out->proof = against_named(w);
    if (!out->proof)
        out->proof = against_others(w, &out->prim, &right);
    if (out->proof) {
        out->opinion = GMP_CONFIRMED;
        return;
    }
    if (right && (missed || named_is_right(w))) {
        out->opinion = GMP_OVERTURNED;
        out->proof = GMP_PROOF_RIGHT;
    } else if (missed && w->all_replayed && !q->model->watertight) {
        out->opinion = GMP_OVERTURNED;
        out->proof = GMP_PROOF_EXCUSED;
    }
}

struct gmp_second gmp_world_redecide(const struct gmp_world_question *question)
{
    struct gmp_second second = {GMP_OPEN, GMP_PROOF_NONE, ABI_NO_PRIM};
    struct world_work work = {.q = question,
                              .any = question->any || (question->mode.flags & ABI_RAY_FIRST),
                              .instance = WORLD_NO_MESH,
                              .all_replayed =
                                  question->model->bits && twin_is_own(question->model->formula)};
    if (work.any && question->model->any_unnamed && question->hit->prim != ABI_NO_PRIM)
        return second;
    exact_gmp_init(&work.pair);
    gmp_steady_init(&work.steady);
    decide(&work, &second);
    exact_gmp_clear(&work.pair);
    gmp_steady_clear(&work.steady);
    return second;
}
