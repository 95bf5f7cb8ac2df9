/* Answers of an unknown formula, judged by the displacement of vertices that makes them right
 * (ref/judge/judge_distance.c): answers for displaced vertices need no more than that, and what
 * needs too much is WRONG. */
#include "ref/judge/judge.h"
#include "ref/base/rng.h"
#include "ref/scene/quantise.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/judge/judge_fixture.h"

#include <math.h>

#define RAYS 25000

static const struct fixture_subject *const unknown = &subjects[SUBJECTS - 1];

/* Exact but for 2^-50: does the ray hit vertices p (relative to its origin)? */
static bool meets(const struct ray *ray, double p[3][3], double *t, double *u, double *v)
{
    double w[3], side = 0, n[3];
    for (int c = 0; c < 3; c++) {
        const double *a = p[(c + 1) % 3], *b = p[(c + 2) % 3];
        w[c] = 0;
        for (int k = 0; k < 3; k++) {
            n[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
            w[c] += (double)ray->dir[k] * n[k];
            side += c == 0 ? p[0][k] * n[k] : 0;
        }
    }
    double det = w[0] + w[1] + w[2];
    *t = side / det;
    *u = w[1] / det;
    *v = w[2] / det;
    return det != 0 && w[0] / det >= 0 && *u >= 0 && *v >= 0 && *t >= (double)ray->tmin &&
           *t <= (double)ray->tmax;
}

/* What is right after each vertex of each triangle moved by up to `most` units of u times the
 * largest |vertex - origin|, along each axis. */
static struct hit displaced(struct rng *rng, const struct judge_fixture *c, const struct ray *ray,
                            float most)
{
    struct hit best = {.prim = ABI_NO_PRIM};
    double best_t = INFINITY, t, u, w;
    for (uint32_t prim = 0; prim < c->scene.tri_count; prim++) {
        float v[3][3];
        double p[3][3], size = 0;
        scene_tri(&c->scene, prim, v);
        for (int i = 0; i < 9; i++) {
            p[i / 3][i % 3] = (double)v[i / 3][i % 3] - (double)ray->org[i % 3];
            size = fmax(size, fabs(p[i / 3][i % 3]));
        }
        for (int i = 0; i < 9; i++)
            p[i / 3][i % 3] += (double)rng_range(rng, -most, most) * 0x1p-24 * size;
        if (!meets(ray, p, &t, &u, &w) || !(t < best_t))
            continue;
        best_t = t;
        best = (struct hit){(float)t, (float)u, (float)w, prim};
    }
    /* Rounding must not leave the range. */
    best.t = fminf(fmaxf(best.t, ray->tmin), ray->tmax);
    if (best.prim == ABI_NO_PRIM)
        best.t = 0;
    return best;
}

static const char *const specs[] = {"soup:n=60", "sphere:n=2",   "grid:n=5,height=0",
                                    "cornell",   "needles:n=60", "stack:n=12"};

static void displaced_vertices_need_no_more_than_they_were_moved(void **state)
{
    (void)state;
    static const float mosts[] = {0, 1, 8, 16};
    static struct ray ray[RAYS];
    struct rng rng = rng_make(5, 0);
    for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
        struct judge_fixture *c = judge_fixture_open(specs[s], 7);
        judge_fixture_seat(c, unknown, QUERY_CLOSEST);
        assert_int_equal(ray_set_make(ray_sets[0], &c->scene, 8, RAYS, ray, NULL), STATUS_OK);
        for (size_t m = 0; m < ARRAY_COUNT(mosts); m++) {
            double worst = 0, bound = (double)mosts[m] * sqrt(3) + 2; /* 2: rounding of t */
            for (size_t i = 0; i < RAYS; i++) {
                if (!ray_in_contract(&ray[i]))
                    continue;
                judge_fixture_ask(c, ray[i]);
                struct hit hit = displaced(&rng, c, &ray[i], mosts[m]);
                if (verdict(c, hit) == VERDICT_WRONG)
                    must_be(c, hit, VERDICT_RIGHT);
                worst = fmax(worst, c->judgement.displacement);
            }
            if (!(worst <= bound && worst > 0.3 * (double)mosts[m]))
                fail_msg("%s moved by %g: %g", specs[s], (double)mosts[m], worst);
        }
        judge_fixture_close(c);
    }
}

/* Where a large displacement changes the answer by much, that is no rounding. */
static void large_displacements_are_wrong(void **state)
{
    (void)state;
    static struct ray ray[RAYS];
    struct rng rng = rng_make(6, 0);
    size_t kinds[WRONG_COUNT] = {0}, answers = 0;
    for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
        struct judge_fixture *c = judge_fixture_open(specs[s], 7);
        judge_fixture_seat(c, unknown, QUERY_CLOSEST);
        assert_int_equal(ray_set_make(ray_sets[0], &c->scene, 9, RAYS, ray, NULL), STATUS_OK);
        for (size_t i = 0; i < RAYS / 8; i++) {
            if (!ray_in_contract(&ray[i]))
                continue;
            judge_fixture_ask(c, ray[i]);
            struct hit hit = displaced(&rng, c, &ray[i], 0x1p18f);
            if (hit.prim == ABI_NO_PRIM && c->truth.prim == ABI_NO_PRIM)
                continue;
            answers++;
            if (verdict(c, hit) == VERDICT_WRONG)
                kinds[c->judgement.wrong]++;
            else
                assert_true(c->judgement.share <= 1);
        }
        judge_fixture_close(c);
    }
    size_t wrong = 0;
    for (int w = WRONG_MISSED; w < WRONG_COUNT; w++)
        wrong += kinds[w];
    assert_true(wrong > answers * 3 / 4);
    assert_true(kinds[WRONG_MISSED] && kinds[WRONG_PHANTOM] && kinds[WRONG_TRIANGLE] &&
                kinds[WRONG_DISTANCE]);
}

/* --- the measure itself ---------------------------------------------------------------------- */

static struct judge_fixture *before(void)
{
    struct judge_fixture *c = inside();
    judge_fixture_seat(c, unknown, QUERY_CLOSEST);
    return c;
}

static void a_hit_needs_its_distance_to_the_triangle(void **state)
{
    (void)state;
    struct judge_fixture *c = before();
    static const int moves[] = {1, 4, 256, 2048};
    for (size_t i = 0; i < ARRAY_COUNT(moves); i++) {
        int units = moves[i];
        judge_fixture_ask(c, along_z(0.5f, -0.25f));
        struct hit hit = right_answer(c, 0);
        hit.t += (float)units * 0x1p-24f * 2;
        must_be(c, hit, units <= 4 ? VERDICT_RIGHT : VERDICT_WRONG);
        assert_true(fabs(c->judgement.displacement - 2 * units / 1.5) < 1e-3);
        /* Beside the rim: the ray must be brought back. */
        float beside = 1 + (float)units * 0x1p-23f;
        judge_fixture_ask(c, along_z(beside, 0.25f));
        must_be(c, right_answer(c, 0), units <= 4 ? VERDICT_BOUNDARY : VERDICT_WRONG);
        double most = (double)beside + 1; /* the other side is farthest from the origin */
        assert_true(fabs(c->judgement.displacement - 2 * units / most) < 1e-3);
    }
    judge_fixture_close(c);
}

static void a_lost_hit_needs_its_nearest_way_out(void **state)
{
    (void)state;
    struct judge_fixture *c = before();
    /* Out of the triangle: 40 * 2^-24 from the rim; vertices are up to 2 away. */
    judge_fixture_ask(c, along_z(1 - 40 * 0x1p-24f, 0.25f));
    must_be(c, a_miss(), VERDICT_BOUNDARY);
    assert_true(fabs(c->judgement.displacement - 20) < 0.1);
    /* Behind what was answered: the far layer 16 * 2^-23 behind; that is 32 of the units. */
    struct scene scene = layers();
    scene.tri_count = 4;
    for (int i = 4; i < 8; i++)
        scene.vertex[3 * i + 2] = 1 + 16 * 0x1p-23f;
    struct judge_fixture *close = judge_fixture_of(scene);
    judge_fixture_seat(close, unknown, QUERY_CLOSEST);
    judge_fixture_ask(close, along_z(0.5f, -0.25f));
    must_be(close, right_answer(close, 2), VERDICT_NEAR_TIE);
    assert_true(fabs(close->judgement.displacement - 32 / 1.5) < 0.1);
    judge_fixture_close(close);
    /* Out of the range: its end is 16 * 2^-23 behind the triangle. */
    struct ray ray = along_z(0.5f, -0.25f);
    ray.tmax = 1 + 16 * 0x1p-23f;
    judge_fixture_ask(c, ray);
    must_be(c, a_miss(), VERDICT_BORDER);
    assert_true(fabs(c->judgement.displacement - 32 / 1.5) < 0.1);
    judge_fixture_close(c);
}

static void the_worst_of_several_needs_counts(void **state)
{
    (void)state;
    struct judge_fixture *c = before();
    /* On the rim of the near layer, inside the far one: a miss loses both. */
    judge_fixture_ask(c, (struct ray){{1.5f, 0.25f, 0}, 0, {-0.5f, 0, 1}, 1e30f});
    must_be_wrong(c, a_miss(), WRONG_MISSED);
    assert_int_equal(c->judgement.expected, c->truth.prim);
    assert_true(c->judgement.behind && c->judgement.lost == 2);
    assert_true(c->judgement.displacement > 1e6);
    judge_fixture_close(c);
}

/* A triangle about the world's origin, seen from afar: whatever its size, it can be lost by no less
 * than moving it aside, and by no more than its size. */
static void small_triangles_far_away_are_lost_for_less_than_their_size(void **state)
{
    (void)state;
    struct rng rng = rng_make(7, 0);
    size_t hits = 0;
    for (int exponent = -70; exponent <= -6; exponent++)
        for (int i = 0; i < 20; i++) {
            struct scene scene;
            struct ray ray = {.tmax = 1e30f};
            assert_int_equal(scene_make(3, 1, &scene), STATUS_OK);
            for (uint32_t k = 0; k < 3; k++) {
                int a = (int)rng_below(&rng, 65) - 32, b = (int)rng_below(&rng, 65) - 32;
                scene.vertex[k] = ldexpf((float)a, exponent - 5);
                scene.vertex[3 + k] = ldexpf((float)b, exponent - 5);
                scene.vertex[6 + k] = ldexpf((float)(-a - b), exponent - 5);
                scene.index[k] = k;
                ray.org[k] = rng_range(&rng, 2, 8);
                ray.dir[k] = -ray.org[k];
            }
            struct judge_fixture *c = judge_fixture_of(scene);
            judge_fixture_seat(c, unknown, QUERY_CLOSEST);
            judge_fixture_ask(c, ray);
            if (c->truth.prim == 0) {
                hits++;
                enum verdict lost = verdict(c, a_miss());
                assert_true(c->judgement.displacement <= ldexp(4.0, exponent + 24));
                if (exponent < -22) /* 32 u of 3.4 and more are above 2^-18 */
                    assert_int_equal(lost, VERDICT_BOUNDARY);
            }
            judge_fixture_close(c);
        }
    assert_true(hits > 1000);
}

static double need_of(struct judge_fixture *c, struct hit answer)
{
    double need = -1;
    assert_int_equal(judge_need(c->judge, &c->ray, &c->truth, &answer, &need), STATUS_OK);
    return need;
}

/* In units of the scene, for each query: what is answered by the distance at its t, what is lost by
 * its nearest way out; an any-hit answer that is a hit has lost nothing. */
static void a_need_is_a_length(void **state)
{
    (void)state;
    for (enum query query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
        struct judge_fixture *c = before();
        judge_fixture_seat(c, unknown, query);
        judge_fixture_ask(c, along_z(0.5f, -0.25f)); /* half a unit from the rims of both layers */
        struct hit near = right_answer(c, 0), far = right_answer(c, 2);
        assert_true(need_of(c, near) < 1e-6);
        assert_true(fabs(need_of(c, far) - (query == QUERY_CLOSEST ? 0.5 : 0)) < 1e-6);
        assert_true(fabs(need_of(c, a_miss()) - 0.5) < 1e-6);
        near.t += 0.25f;
        assert_true(fabs(need_of(c, near) - 0.25) < 1e-6);
        judge_fixture_ask(c, along_z(1.25f, 0.25f)); /* a miss by a quarter */
        assert_true(need_of(c, a_miss()) == 0);
        assert_true(fabs(need_of(c, right_answer(c, 0)) - 0.25) < 1e-6);
        judge_fixture_close(c);
    }
}

/* What is right for a scene, or a hit of any of its triangles at any t up to 4. */
static struct hit some_answer(struct rng *rng, const struct judge_fixture *c)
{
    const uint32_t kind = rng_below(rng, 4);
    if (kind == 0 || c->truth.prim == ABI_NO_PRIM)
        return a_miss();
    float t = (float)(0.5 * (c->truth.t_lo + c->truth.t_hi));
    if (kind == 1)
        return (struct hit){.t = 4 * rng_float(rng), .prim = rng_below(rng, c->scene.tri_count)};
    return (struct hit){.t = kind == 2 ? t : t * rng_range(rng, 0.9f, 1.1f), .prim = c->truth.prim};
}

/* Where no vertex of another scene is farther away than D, an answer needs at most D more there,
 * or less: of slivers as of other triangles, for which rounding allows less. */
static void answers_for_another_scene_need_its_distance_more_or_less(void **state)
{
    (void)state;
    static struct ray ray[600];
    struct rng rng = rng_make(9, 0);
    double largest = 0;
    for (size_t s = 0; s < 3 * ARRAY_COUNT(specs); s++) {
        struct judge_fixture *c = judge_fixture_open(specs[s / 3], 7), *other;
        struct scene scene;
        struct quantised by;
        assert_int_equal(scene_quantise(&c->scene, 8 + 4 * (uint32_t)(s % 3), &scene, &by, NULL),
                         STATUS_OK);
        other = judge_fixture_of(scene);
        assert_int_equal(ray_set_make(ray_sets[0], &c->scene, 8 + s, ARRAY_COUNT(ray), ray, NULL),
                         STATUS_OK);
        for (size_t i = 0; i < ARRAY_COUNT(ray); i++) {
            if (!ray_in_contract(&ray[i]))
                continue;
            const enum query query = i % 2 ? QUERY_ANY : QUERY_CLOSEST;
            judge_fixture_seat(c, unknown, query);
            judge_fixture_seat(other, unknown, query);
            judge_fixture_ask(c, ray[i]);
            judge_fixture_ask(other, ray[i]);
            struct hit answer = some_answer(&rng, i % 4 < 2 ? c : other);
            const double need[] = {need_of(c, answer), need_of(other, answer)};
            const double apart = fabs(need[0] - need[1]), slack = 1e-9 * (1 + need[0]);
            if (!(apart <= by.distance + slack))
                fail_msg("%s, ray %zu: %g and %g of scenes that are %g apart", specs[s / 3], i,
                         need[0], need[1], by.distance);
            largest = fmax(largest, apart / by.distance);
        }
        judge_fixture_close(c);
        judge_fixture_close(other);
    }
    assert_true(largest > 0.7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(displaced_vertices_need_no_more_than_they_were_moved),
        cmocka_unit_test(large_displacements_are_wrong),
        cmocka_unit_test(a_hit_needs_its_distance_to_the_triangle),
        cmocka_unit_test(a_lost_hit_needs_its_nearest_way_out),
        cmocka_unit_test(the_worst_of_several_needs_counts),
        cmocka_unit_test(small_triangles_far_away_are_lost_for_less_than_their_size),
        cmocka_unit_test(a_need_is_a_length),
        cmocka_unit_test(answers_for_another_scene_need_its_distance_more_or_less),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
