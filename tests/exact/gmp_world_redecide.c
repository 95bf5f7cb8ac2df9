#include "tests/exact/gmp_world_redecide.h"

#include "tests/exact/exact_gmp_replay.h"
#include "tests/exact/gmp_object_ray.h"
#include "tests/exact/gmp_steady.h"

#include <math.h>

/* A triangle that is looked at. */
struct world_work {
    const struct gmp_world_question *q;
    bool any;
    uint32_t prim;
    struct place place;
    struct gmp_pair pair;
    struct gmp_steady steady;
    bool replayed; /* what the formula makes of it is known, bit for bit */
    struct gmp_replay replay;
    uint32_t instance; /* whose ray `object` is; WORLD_NO_MESH: none yet */
    bool has_object;
    struct ray object;
};

/* Whether the engine promises the bits of a formula of ours. */
static bool is_replayable(const struct model *model)
{
    return model->bits && twin_is_own(model->formula);
}

static bool replay(struct world_work *w)
{
    const struct world *world = w->q->world;
    float v[3][3];
    if (!is_replayable(w->q->model))
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
    w->prim = prim;
    w->place = gmp_world_place(w->q->world, prim);
    gmp_world_pair(w->q->world, w->q->ray, prim, &w->pair);
    gmp_steady_load(w->q->world, w->q->ray, prim, &w->pair, &w->steady);
    w->replayed = replay(w);
}

/* Whether every evaluation sees the side that is exactly seen. A formula of ours computes it of its
 * own ray in the mesh, so that only what follows may err: by some 2^-20 of the products' sizes. */
static bool side_is_steady(const struct world_work *w)
{
    const struct scene *scene = w->q->world->mesh[w->place.mesh].scene;
    long double e[2][3], det = 0, sizes = 0;
    float v[3][3];
    if (!w->replayed)
        return gmp_steady_side(&w->steady);
    scene_tri(scene, w->place.prim, v);
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 2; c++)
            e[c][k] = (long double)v[c + 1][k] - (long double)v[0][k];
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        long double d = (long double)w->object.dir[k];
        det += d * (e[0][i] * e[1][j] - e[0][j] * e[1][i]);
        sizes += fabsl(d) * (fabsl(e[0][i] * e[1][j]) + fabsl(e[0][j] * e[1][i]));
    }
    int exact = gmp_world_facing(w->q->world, w->q->ray, w->prim);
    return fabsl(det) > 0x1p-16L * sizes && (det > 0 ? 1 : -1) == exact;
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
    if (by_side && !side_is_steady(w))
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
    if (!finite)
        return GMP_PROOF_NOT_FINITE;
    const bool within = hit->u >= 0 && hit->v >= 0 && hit->u <= 1 && hit->v <= 1;
    if (hit->t < ray->tmin || hit->t > ray->tmax ||
        (w->pair.point && gmp_steady_t(&w->steady, w->pair.t, (double)hit->t) != 0))
        return GMP_PROOF_DISTANCE;
    if (w->pair.point && w->pair.class == ORACLE_MISS && gmp_steady_hit(&w->steady))
        return GMP_PROOF_PHANTOM;
    return within && gmp_steady_beside(w->q->world, ray, hit->prim, &w->steady, hit->u, hit->v)
               ? GMP_PROOF_BARYCENTRIC
               : GMP_PROOF_NONE;
}

static bool other_side(const struct world_work *w, bool tagged_front)
{
    const struct instance *instance = &w->q->world->instance[w->place.instance];
    bool front = gmp_world_facing(w->q->world, w->q->ray, w->q->hit->prim) < 0;
    if (instance->flags & ABI_INSTANCE_FLIP_FACING)
        front = !front;
    return front != tagged_front && side_is_steady(w);
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
        if (side_is_steady(w))
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

/* The triangle at hand is surely hit, and nearer than the answer. */
static bool proves_nearer(const struct world_work *w)
{
    double answered = (double)w->q->hit->t;
    if (w->replayed)
        return w->replay.t < w->q->hit->t && exact_gmp_compare(w->pair.t, answered) < 0;
    return gmp_steady_t(&w->steady, w->pair.t, answered) < 0;
}

/* What the exact hits besides the named one leave of an answer. */
struct others {
    bool right;   /* none that counts is nearer, or there at all if the answer is a miss */
    bool excused; /* none that counts is accepted by the formula, as far as it was replayed */
};

static bool share_a_corner(float a[3][3], float b[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (a[i][0] == b[j][0] && a[i][1] == b[j][1] && a[i][2] == b[j][2])
                return true;
    return false;
}

/* A watertight formula may reject a triangle that is hit near its border, but then accepts another
 * at that border, of the same instance, which shares a corner. */
static bool neighbour_is_lost(struct world_work *w, uint32_t *prim)
{
    const struct place place = w->place;
    const uint32_t of = *prim, first = of - place.prim;
    const struct scene *scene = w->q->world->mesh[place.mesh].scene;
    float hit[3][3], other[3][3];
    scene_tri(scene, place.prim, hit);
    for (uint32_t k = 0; k < scene->tri_count; k++) {
        scene_tri(scene, k, other);
        if (k == place.prim || !share_a_corner(hit, other))
            continue;
        look_at(w, first + k);
        *prim = first + k;
        if (w->replayed && exact_gmp_replay_hits(&w->replay, w->q->ray, w->q->model->open) &&
            (w->q->hit->prim == ABI_NO_PRIM || proves_nearer(w)) && surely_counts(w, *prim))
            return true;
    }
    *prim = of;
    return false;
}

/* Looks at one exact hit. */
static enum gmp_proof against_one(struct world_work *w, uint32_t *at, enum oracle_ends ends,
                                  struct others *left)
{
    const uint32_t prim = *at;
    const struct gmp_world_question *q = w->q;
    const bool missed = q->hit->prim == ABI_NO_PRIM;
    look_at(w, prim);
    if (gmp_world_admit(q->world, q->ray, q->mode, prim, &w->pair) == ORACLE_ADMITTED) {
        const double before = (double)nextafterf(q->hit->t, -INFINITY);
        left->right &= !missed && (w->any || exact_gmp_compare(w->pair.t, before) >= 0);
        left->excused &= w->replayed && !surely_hit(w, ends);
    }
    if (!missed && (w->any || !proves_nearer(w)))
        return GMP_PROOF_NONE;
    bool lost = surely_counts(w, prim) && surely_hit(w, ends);
    if (!lost && q->model->watertight && w->replayed && !w->replay.accepted)
        lost = neighbour_is_lost(w, at);
    if (!lost)
        return GMP_PROOF_NONE;
    return missed ? GMP_PROOF_MISSED : GMP_PROOF_NEARER;
}

/* Goes through all placed triangles near the ray. */
static enum gmp_proof against_others(struct world_work *w, uint32_t *prim, struct others *left)
{
    const struct gmp_world_question *q = w->q;
    const enum oracle_ends ends = q->model->open ? ORACLE_OPEN : ORACLE_CLOSED;
    uint32_t number = 0;
    *left = (struct others){true, true};
    for (uint32_t i = 0; i < q->world->instance_count; i++) {
        const struct scene *scene = world_scene(q->world, i);
        for (uint32_t k = 0; scene && k < scene->tri_count; k++, number++) {
            float p[3][3];
            scene_tri(scene, k, p);
            if (gmp_world_far_off(&q->world->instance[i], q->ray, p))
                continue;
            gmp_world_pair(q->world, q->ray, number, &w->pair);
            *prim = number;
            enum gmp_proof proof =
                exact_gmp_hits(&w->pair, ends) ? against_one(w, prim, ends, left) : GMP_PROOF_NONE;
            if (proof)
                return proof;
        }
    }
    *prim = ABI_NO_PRIM;
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
    struct others left = {false, false};
    out->prim = q->hit->prim;
    if (missed && q->tag != 0)
        out->proof = GMP_PROOF_TAG;
    else if (!missed && q->hit->prim >= world_tri_count(q->world))
        out->proof = GMP_PROOF_NO_TRIANGLE;
    else if (!missed)
        out->proof = against_named(w);
    if (!out->proof)
        out->proof = against_others(w, &out->prim, &left);
    if (out->proof) {
        out->opinion = GMP_CONFIRMED;
        return;
    }
    if (left.right && (missed || named_is_right(w))) {
        out->opinion = GMP_OVERTURNED;
        out->proof = GMP_PROOF_RIGHT;
    } else if (missed && left.excused && is_replayable(q->model) && !q->model->watertight) {
        out->opinion = GMP_OVERTURNED;
        out->proof = GMP_PROOF_EXCUSED;
    }
}

struct gmp_second gmp_world_redecide(const struct gmp_world_question *question)
{
    struct gmp_second second = {GMP_OPEN, GMP_PROOF_NONE, ABI_NO_PRIM};
    struct world_work work = {.q = question,
                              .any = question->any || (question->mode.flags & ABI_RAY_FIRST),
                              .instance = WORLD_NO_MESH};
    if (work.any && question->model->any_unnamed && question->hit->prim != ABI_NO_PRIM)
        return second;
    exact_gmp_init(&work.pair);
    gmp_steady_init(&work.steady);
    decide(&work, &second);
    exact_gmp_clear(&work.pair);
    gmp_steady_clear(&work.steady);
    return second;
}
