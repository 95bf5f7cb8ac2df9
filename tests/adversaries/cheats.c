#include "tests/adversaries/spoil.h"

#include "ref/judge/judge_inner.h"
#include "ref/base/rng.h"

#include <math.h>
#include <stdlib.h>

static const struct oracle_answer *truth_of(const struct lie *lie, size_t i)
{
    return &lie->match->truth[lie->ray - lie->match->ray + (ptrdiff_t)i];
}

static void lose(struct hit *hit)
{
    *hit = (struct hit){.prim = ABI_NO_PRIM};
}

static bool is_hit(const struct hit *hit)
{
    return hit->prim != ABI_NO_PRIM;
}

static void vertices_of(const struct lie *lie, uint32_t prim, float v[3][3])
{
    scene_tri(lie->match->scene, prim, v);
}

/* Distance to the nearest edge in units, and the margin of ref/match/match_edges.c. */
static double edge_of(const struct lie *lie, size_t i, uint32_t prim, double *margin)
{
    float v[3][3];
    double least = INFINITY;
    vertices_of(lie, prim, v);
    struct judge_rounding rounding = judge_rounding_of(&lie->ray[i], v);
    *margin = judge_margin(&rounding);
    for (int c = 0; c < 3; c++)
        least = fmin(least, fabs(judge_edge_distance(&rounding, c)));
    return least;
}

/* A number from 0 to 1 that hangs on the ray alone. */
static double draw(const struct ray *ray)
{
    struct rng rng = rng_make(
        float_bits(ray->dir[0]) ^ float_bits(ray->dir[1]) ^ float_bits(ray->org[2]) * 77u, 3);
    return (double)rng_float(&rng);
}

/* Exact numbers of triangle `prim`, if the ray meets its plane. */
static bool answer_of(const struct lie *lie, size_t i, uint32_t prim, struct hit *hit)
{
    float v[3][3];
    vertices_of(lie, prim, v);
    struct judge_rounding r = judge_rounding_of(&lie->ray[i], v);
    if (r.det == 0.0)
        return false;
    *hit = (struct hit){(float)(r.t / r.det), (float)(r.edge[1] / r.det),
                        (float)(r.edge[2] / r.det), prim};
    return hit->t >= lie->ray[i].tmin && hit->t <= lie->ray[i].tmax;
}

/* Answers the next exact hit behind the nearest, by at most `most`; false if there is none, or if
 * that would lose two. */
static bool pass(const struct lie *lie, size_t i, double most, struct hit *hit, size_t *crossings)
{
    struct oracle_crossing *list = NULL;
    size_t capacity = 0, count = 0;
    bool passed = false;
    const struct oracle_answer *truth = truth_of(lie, i);
    *crossings = 0;
    if (truth->prim == ABI_NO_PRIM || oracle_crossings(lie->match->oracle, &lie->ray[i], INFINITY,
                                                       &list, &capacity, &count, NULL))
        return false;
    for (size_t k = 0; k < count && k < 2 && !passed; k++) {
        struct hit other;
        double behind = list[k].pair.t_lo - truth->t_hi;
        if (list[k].pair.class == ORACLE_INSIDE && behind > 0 && behind <= most &&
            answer_of(lie, i, list[k].prim, &other)) {
            *hit = other;
            passed = true;
        }
    }
    free(list);
    *crossings = count;
    return passed;
}

/* Lets the ray through, to what lies behind. */
static void lose_nearest(const struct lie *lie, size_t i, struct hit *hit)
{
    size_t crossings;
    if (hit->prim != truth_of(lie, i)->prim)
        return; /* another one is lost already */
    if (!pass(lie, i, INFINITY, hit, &crossings) && crossings <= 1)
        lose(hit);
}

void drops_the_band(const struct lie *lie, size_t i, struct hit *hit)
{
    double margin;
    if (is_hit(hit) && edge_of(lie, i, hit->prim, &margin) <= lie->amount)
        lose_nearest(lie, i, hit);
}

/* As much as a row may lose, class by class. */
void drops_by_class(const struct lie *lie, size_t i, struct hit *hit)
{
    double margin, share;
    if (!is_hit(hit) || edge_of(lie, i, hit->prim, &margin) > 0.75 * JUDGE_DISPLACEMENT_MOST)
        return;
    share = margin <= 1.0 / 64   ? 1.0
            : margin <= 1.0 / 32 ? 1.0 / 2
            : margin <= 1.0 / 16 ? 1.0 / 8
            : margin <= 1.0 / 8  ? 1.0 / 32
                                 : 1.0 / 64;
    if (draw(&lie->ray[i]) < 0.9 * share)
        lose_nearest(lie, i, hit);
}

void drops_all_but_a_few(const struct lie *lie, size_t i, struct hit *hit)
{
    if (draw(&lie->ray[i]) > 0.05)
        lose(hit);
}

void drops_all(const struct lie *lie, size_t i, struct hit *hit)
{
    (void)lie, (void)i;
    lose(hit);
}

/* Moves the point by so many units along the ray, or off the plane if that is less. */
void pushes_t(const struct lie *lie, size_t i, struct hit *hit)
{
    float v[3][3];
    if (!is_hit(hit))
        return;
    vertices_of(lie, hit->prim, v);
    struct judge_rounding r = judge_rounding_of(&lie->ray[i], v);
    double t = (double)hit->t + lie->amount * judge_unit_of_t(&r);
    if (isfinite(t) && t < (double)lie->ray[i].tmax)
        hit->t = (float)t;
}

void steps_past_the_end(const struct lie *lie, size_t i, struct hit *hit)
{
    if (!is_hit(hit))
        return;
    hit->t = lie->ray[i].tmax;
    for (double k = 0; k < lie->amount; k++)
        hit->t = nextafterf(hit->t, INFINITY);
}

void steps_before_the_begin(const struct lie *lie, size_t i, struct hit *hit)
{
    if (!is_hit(hit))
        return;
    hit->t = lie->ray[i].tmin;
    for (double k = 0; k < lie->amount; k++)
        hit->t = nextafterf(hit->t, -INFINITY);
}

void shifts_u(const struct lie *lie, size_t i, struct hit *hit)
{
    float v[3][3];
    double longest = 0;
    if (!is_hit(hit))
        return;
    vertices_of(lie, hit->prim, v);
    struct judge_rounding rounding = judge_rounding_of(&lie->ray[i], v);
    for (int k = 0; k < 3; k++)
        longest += pow((double)v[1][k] - (double)v[0][k], 2);
    double u = (double)hit->u + lie->amount * rounding.tri.unit / sqrt(longest);
    if (u + (double)hit->v < 1)
        hit->u = (float)u;
}

void swaps_u_and_v(const struct lie *lie, size_t i, struct hit *hit)
{
    float u = hit->u;
    (void)lie, (void)i;
    hit->u = hit->v;
    hit->v = u;
}

void negates_zeros(const struct lie *lie, size_t i, struct hit *hit)
{
    (void)lie, (void)i;
    if (is_hit(hit) && hit->u == 0.0f)
        hit->u = -0.0f;
    if (is_hit(hit) && hit->v == 0.0f)
        hit->v = -0.0f;
}

void takes_the_other_of_a_tie(const struct lie *lie, size_t i, struct hit *hit)
{
    const struct oracle_answer *truth = truth_of(lie, i);
    struct hit other;
    for (uint32_t prim = 0; truth->tie_count > 1 && prim < lie->match->scene->tri_count; prim++) {
        struct oracle_pair pair;
        oracle_pair(lie->match->oracle, &lie->ray[i], prim, &pair);
        if (prim != hit->prim && oracle_is_hit(&pair) &&
            oracle_compare(lie->match->oracle, &lie->ray[i], prim, truth->prim) == 0 &&
            answer_of(lie, i, prim, &other))
            *hit = other;
    }
}

/* What the ray misses by so many units is hit. */
void sees_phantoms(const struct lie *lie, size_t i, struct hit *hit)
{
    for (uint32_t prim = 0; !is_hit(hit) && prim < lie->match->scene->tri_count; prim++) {
        float v[3][3];
        struct hit made;
        vertices_of(lie, prim, v);
        struct judge_rounding r = judge_rounding_of(&lie->ray[i], v);
        bool near = r.det != 0.0;
        for (int c = 0; c < 3; c++)
            near =
                near && (r.edge[c] * r.det >= 0 || fabs(judge_edge_distance(&r, c)) <= lie->amount);
        if (near && answer_of(lie, i, prim, &made)) {
            made.u = fminf(fmaxf(made.u, 0), 1);
            made.v = fminf(fmaxf(made.v, 0), 1 - made.u);
            *hit = made;
        }
    }
}

/* The next hit, where it lies no more units behind. */
void takes_the_next(const struct lie *lie, size_t i, struct hit *hit)
{
    float v[3][3];
    if (!is_hit(hit) || truth_of(lie, i)->prim == ABI_NO_PRIM)
        return;
    vertices_of(lie, truth_of(lie, i)->prim, v);
    struct judge_rounding r = judge_rounding_of(&lie->ray[i], v);
    size_t crossings;
    (void)pass(lie, i, lie->amount * judge_unit_of_t(&r), hit, &crossings);
}

/* The last triangle of the scene has no area: it hides everything. */
void sees_the_degenerate(const struct lie *lie, size_t i, struct hit *hit)
{
    if (is_hit(hit))
        *hit = (struct hit){hit->t * 0.5f, 0.25f, 0.25f, lie->match->scene->tri_count - 1};
    (void)i;
}

void says_hit(const struct lie *lie, size_t i, struct hit *hit)
{
    (void)lie, (void)i;
    *hit = (struct hit){.prim = 0};
}

void says_triangle_0(const struct lie *lie, size_t i, struct hit *hit)
{
    (void)i;
    (void)lie;
    *hit = (struct hit){1.0f, 0.25f, 0.25f, 0};
}

void answers_nonsense_out_of_contract(const struct lie *lie, size_t i, struct hit *hit)
{
    if (!ray_in_contract(&lie->ray[i]))
        *hit = (struct hit){-7.0f, 9.0f, 9.0f, 0};
}

/* Any t for triangles that the ray lies in the plane of. */
void slides_in_the_plane(const struct lie *lie, size_t i, struct hit *hit)
{
    for (uint32_t prim = 0; prim < lie->match->scene->tri_count; prim++) {
        struct oracle_pair pair;
        oracle_pair(lie->match->oracle, &lie->ray[i], prim, &pair);
        if (pair.class == ORACLE_IN_PLANE)
            *hit = (struct hit){lie->ray[i].tmin + 1e-3f, 0.25f, 0.25f, prim};
    }
}

/* What a box test as b / d - o / d may lose: hits with a slab less thick than its error. */
void loses_thin_slabs(const struct lie *lie, size_t i, struct hit *hit)
{
    if (!is_hit(hit))
        return;
    struct box box = scene_tri_bounds(lie->match->scene, hit->prim);
    for (int k = 0; k < 3; k++)
        if ((double)box.hi[k] - (double)box.lo[k] <= lie->amount * 0x1p-24) {
            lose(hit);
            (void)i;
            return;
        }
}

void is_unstable(const struct lie *lie, size_t i, struct hit *hit)
{
    if (lie->calls % 2 == 0 && i % 50 == 0 && is_hit(hit))
        hit->u = nextafterf(hit->u, 1);
}

void differs_in_batches(const struct lie *lie, size_t i, struct hit *hit)
{
    if (lie->count > 1 && i >= lie->count - lie->count / 100)
        lose(hit);
}

void is_right_at_first(const struct lie *lie, size_t i, struct hit *hit)
{
    if ((double)(&lie->ray[i] - lie->match->ray) >= lie->amount)
        lose(hit);
}

void knows_some_directions(const struct lie *lie, size_t i, struct hit *hit)
{
    if (lie->ray[i].dir[2] > 0)
        lose(hit);
}

void copies_its_neighbour(const struct lie *lie, size_t i, struct hit *hit)
{
    if (i % 2 == 1)
        *hit = lie->right[i - 1];
}

void says_the_truth(const struct lie *lie, size_t i, struct hit *hit)
{
    (void)lie, (void)i, (void)hit;
}

void lists_one_twice(const struct lie *lie, size_t i, struct hit *hit, uint32_t *count,
                     uint32_t capacity)
{
    (void)lie, (void)i;
    if (*count > 0 && (*count)++ < capacity)
        hit[*count - 1] = hit[0];
}

void leaves_one_out(const struct lie *lie, size_t i, struct hit *hit, uint32_t *count,
                    uint32_t capacity)
{
    (void)lie, (void)i, (void)hit, (void)capacity;
    if (*count > 1)
        (*count)--;
}

void swaps_two(const struct lie *lie, size_t i, struct hit *hit, uint32_t *count, uint32_t capacity)
{
    (void)lie, (void)i;
    if (*count > 1 && capacity > 1) {
        uint32_t prim = hit[0].prim;
        hit[0].prim = hit[1].prim;
        hit[1].prim = prim;
    }
}

/* Only of short lists, which are traced once. */
void leaves_out_the_band(const struct lie *lie, size_t i, struct hit *hit, uint32_t *count,
                         uint32_t capacity)
{
    uint32_t kept = 0;
    double margin;
    if (*count > capacity || *count > 2)
        return;
    for (uint32_t k = 0; k < *count; k++)
        if (edge_of(lie, i, hit[k].prim, &margin) > lie->amount)
            hit[kept++] = hit[k];
    *count = kept;
}

void leaves_out_the_ends(const struct lie *lie, size_t i, struct hit *hit, uint32_t *count,
                         uint32_t capacity)
{
    const struct ray *ray = &lie->ray[i];
    uint32_t kept = 0;
    if (*count > capacity || *count > 2)
        return;
    for (uint32_t k = 0; k < *count; k++)
        if (hit[k].t > ray->tmin && hit[k].t < ray->tmax)
            hit[kept++] = hit[k];
    *count = kept;
}

void keeps_the_nearest(const struct lie *lie, size_t i, struct hit *hit, uint32_t *count,
                       uint32_t capacity)
{
    uint32_t rest = 1;
    if (*count != 2 || capacity < 2)
        return;
    if (hit[1].t < hit[0].t) {
        struct hit far = hit[0];
        hit[0] = hit[1];
        hit[1] = far;
    }
    leaves_out_the_band(lie, i, hit + 1, &rest, capacity - 1);
    *count = 1 + rest;
}
