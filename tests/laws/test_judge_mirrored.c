/* A verdict is that of the scene, the ray and the answer turned half round an axis, or mirrored in
 * 0: signs round alike. Numbers are the same but for the order of sums, as Woop's test exchanges
 * axes with the sign of a direction. Scenes lie on one side of 0, so that what forgets a sign does
 * so on one side alone. */
#include "ref/base/rng.h"
#include "ref/judge/judge_inner.h"
#include "ref/oracle/oracle.h"
#include "ref/trace/trace.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/judge/judge_fixture.h"

#define RAYS    160u
#define ANSWERS 7u
#define TURNS   4u

/* Axes with the other sign: none, two of three, all. */
static const uint32_t turns[TURNS] = {0, 3, 5, 7};

/* A scene and its rays in one turn. */
struct turned {
    struct scene scene;
    struct oracle *oracle;
    struct ray ray[RAYS];
    struct oracle_answer truth[RAYS];
};

static void turn(float *x, uint32_t count, uint32_t axes)
{
    for (uint32_t i = 0; i < count; i++)
        x[i] = axes >> i % 3 & 1 ? 0.0f - x[i] : x[i];
}

static void turned_make(struct turned *t, const char *spec, const char *rays, uint32_t axes)
{
    struct reason reason = {""};
    if (scene_open(spec, 3, &t->scene, &reason))
        fail_msg("%s: %s", spec, reason.text);
    for (uint32_t i = 0; i < 3 * t->scene.vertex_count; i++)
        t->scene.vertex[i] += 3;
    assert_int_equal(ray_set_make(ray_set_find(rays), &t->scene, 5, RAYS, t->ray, &reason), 0);
    for (uint32_t i = 0; i < RAYS; i += 4) { /* what ends or begins at what it hits */
        struct hit hit;
        trace_brute(&t->scene, tri_test_find("mt"), QUERY_CLOSEST, &t->ray[i], &hit);
        *(i % 8 ? &t->ray[i].tmax : &t->ray[i].tmin) = hit.prim == ABI_NO_PRIM ? 1 : hit.t;
    }
    turn(t->scene.vertex, 3 * t->scene.vertex_count, axes);
    assert_int_equal(oracle_make(&t->scene, &t->oracle, &reason), STATUS_OK);
    for (uint32_t i = 0; i < RAYS; i++) {
        turn(t->ray[i].org, 3, axes);
        turn(t->ray[i].dir, 3, axes);
    }
    assert_int_equal(oracle_closest(t->oracle, ORACLE_BRUTE, ORACLE_CLOSED, t->ray, RAYS, 1,
                                    t->truth, NULL, &reason),
                     0);
}

static void turned_free(struct turned *t)
{
    oracle_free(t->oracle);
    scene_free(&t->scene);
}

/* Answers to a ray: what a test finds, and others that are wrong by little and by much. */
static struct hit answer_of(const struct turned *t, const char *tri, uint32_t ray, uint32_t number)
{
    static const float off[] = {0x1p-23f, -0x1p-21f, 0x1p-17f};
    struct hit hit;
    trace_brute(&t->scene, tri_test_find(tri), QUERY_CLOSEST, &t->ray[ray], &hit);
    if (number == 1 || hit.prim == ABI_NO_PRIM)
        return number == 2 ? (struct hit){.t = 1, .prim = 0} : (struct hit){.prim = ABI_NO_PRIM};
    if (number == 2)
        hit.prim = (hit.prim + 1) % t->scene.tri_count;
    else if (number == 3)
        hit.u += 0x1p-18f;
    else if (number >= 4)
        hit.t *= 1 + off[number - 4];
    return hit;
}

static bool near(double a, double b)
{
    return a == b || fabs(a - b) <= 0x1p-40 * fmax(fabs(a), fabs(b));
}

static bool same(const struct judgement *a, const struct judgement *b)
{
    return a->verdict == b->verdict && a->wrong == b->wrong && a->expected == b->expected &&
           near(a->t_lo, b->t_lo) && near(a->t_hi, b->t_hi) && a->behind == b->behind &&
           (!a->behind ||
            (a->lost == b->lost && near(a->lost_lo, b->lost_lo) && near(a->lost_hi, b->lost_hi))) &&
           near(a->over, b->over) && near(a->displacement, b->displacement) &&
           near(a->share, b->share) && near(a->margin, b->margin) && a->edge_lost == b->edge_lost &&
           a->fan == b->fan;
}

static void must_judge_alike(const struct fixture_subject *subject, const struct turned *base,
                             const struct turned *other, enum query query, uint32_t axes,
                             size_t seen[VERDICT_COUNT])
{
    struct judge *judge[2];
    assert_int_equal(judge_make(base->oracle, &subject->model, query, &judge[0], NULL), 0);
    assert_int_equal(judge_make(other->oracle, &subject->model, query, &judge[1], NULL), 0);
    for (uint32_t i = 0; i < RAYS * ANSWERS; i++) {
        const uint32_t ray = i / ANSWERS;
        const struct hit hit = answer_of(base, subject->tri, ray, i % ANSWERS);
        struct judgement one = {0}, two = {0};
        assert_int_equal(judge_answer(judge[0], &base->ray[ray], &base->truth[ray], &hit, &one), 0);
        assert_int_equal(judge_answer(judge[1], &other->ray[ray], &other->truth[ray], &hit, &two),
                         0);
        seen[one.verdict]++;
        if (!same(&one, &two))
            fail_msg(
                "%s, axes %u, ray %u, answer %u: %s (%s) err/E %a, displacement %a and %s (%s) "
                "err/E %a, displacement %a",
                subject->name, axes, ray, i % ANSWERS, verdict_name(one.verdict),
                wrong_name(one.wrong), one.over, one.displacement, verdict_name(two.verdict),
                wrong_name(two.wrong), two.over, two.displacement);
    }
    judge_free(judge[0]);
    judge_free(judge[1]);
}

static void a_verdict_is_that_of_the_mirrored_answer(void **state)
{
    (void)state;
    static const char *const specs[][2] = {{"soup:n=40", "random"},
                                           {"needles:n=40", "edges"},
                                           {"sphere:n=4", "vertices"},
                                           {"grid:n=5", "edges"}};
    static struct turned turned[TURNS];
    size_t seen[VERDICT_COUNT] = {0}, kinds = 0;
    for (size_t n = 0; n < ARRAY_COUNT(specs); n++) {
        for (uint32_t k = 0; k < TURNS; k++)
            turned_make(&turned[k], specs[n][0], specs[n][1], turns[k]);
        for (size_t s = 0; s < SUBJECTS; s++)
            for (uint32_t k = 1; k < TURNS; k++)
                must_judge_alike(&subjects[s], &turned[0], &turned[k],
                                 k % 2 ? QUERY_CLOSEST : QUERY_ANY, turns[k], seen);
        for (uint32_t k = 0; k < TURNS; k++)
            turned_free(&turned[k]);
    }
    for (size_t v = 0; v < VERDICT_COUNT; v++) {
        print_message("%-16s %zu\n", verdict_name((enum verdict)v), seen[v]);
        kinds += seen[v] > 0;
    }
    assert_true(kinds >= 7);
}

/* --- first looks ------------------------------------------------------------------------------ */

/* Triangles on one side of a ray's origin, of which it passes some at any distance. */
static void first_looks_are_those_of_the_mirrored(void **state)
{
    (void)state;
    const struct fixture_subject *subject = subject_of("unknown");
    static struct turned turned[TURNS];
    struct judge *judge[TURNS];
    struct rng rng = rng_make(4, 9);
    size_t possible = 0, all = 0;
    for (uint32_t k = 0; k < TURNS; k++) {
        turned_make(&turned[k], "soup:n=64,size=0.5", "random", turns[k]);
        assert_int_equal(
            judge_make(turned[k].oracle, &subject->model, QUERY_CLOSEST, &judge[k], NULL), 0);
    }
    for (uint32_t n = 0; n < 30000; n++) {
        float v[3][3], at[3], off = rng_range(&rng, -1, 1);
        struct ray ray = {.tmax = INFINITY};
        uint64_t look[TURNS];
        off = ldexpf(off, -(int)rng_below(&rng, 24));
        scene_tri(&turned[0].scene, n % 64, v);
        for (uint32_t i = 0; i < 3; i++) { /* beside an edge, from near or far on either side */
            at[i] = 0.5f * (v[0][i] + v[1][i]) + off * (v[2][i] - v[0][i]);
            ray.dir[i] = rng_range(&rng, -1, 1) * (n / 64 % 3 == i ? 4 : 0.25f);
            ray.org[i] = at[i] - (n / 192 % 2 ? 2.0f : -2.0f) * ray.dir[i];
        }
        for (uint32_t k = 0; k < TURNS; k++) {
            struct ray as = ray;
            turn(as.org, 3, turns[k]);
            turn(as.dir, 3, turns[k]);
            look[k] = judge_first_look(judge[k], &as, 0, 64);
            assert_true(look[k] == look[0]);
        }
        possible += look[0] >> n % 64 & 1;
        all++;
    }
    assert_true(possible > all / 20 && possible < all);
    for (uint32_t k = 0; k < TURNS; k++) {
        judge_free(judge[k]);
        turned_free(&turned[k]);
    }
}

/* Boxes on one side of 0, small and large beside the origin of the ray. */
static void boxes_come_as_near(void **state)
{
    (void)state;
    struct rng rng = rng_make(5, 9);
    size_t near_ones = 0;
    for (uint32_t n = 0; n < 60000; n++) {
        struct box box;
        struct ray ray = {.tmax = INFINITY};
        const float size = n % 2 ? 1 : 8;
        for (int i = 0; i < 3; i++) {
            box.lo[i] = rng_range(&rng, 1, 4);
            box.hi[i] = box.lo[i] + rng_range(&rng, 0, 0.5f);
            ray.org[i] = rng_range(&rng, -size, size);
            ray.dir[i] = box.lo[i] + rng_range(&rng, -0.5f, 0.75f) - ray.org[i];
        }
        const bool near_it = judge_comes_near(&ray, &box);
        near_ones += near_it;
        for (uint32_t axes = 1; axes < 8; axes++) {
            struct box as = box;
            struct ray by = ray;
            turn(by.org, 3, axes);
            turn(by.dir, 3, axes);
            for (uint32_t i = 0; i < 3; i++)
                if (axes >> i & 1) {
                    as.lo[i] = -box.hi[i];
                    as.hi[i] = -box.lo[i];
                }
            assert_int_equal(judge_comes_near(&by, &as), near_it);
        }
    }
    assert_true(near_ones > 10000 && near_ones < 50000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_verdict_is_that_of_the_mirrored_answer),
        cmocka_unit_test(first_looks_are_those_of_the_mirrored),
        cmocka_unit_test(boxes_come_as_near),
    };
    return cmocka_run_group_tests_name("mirrored verdicts", tests, NULL, NULL);
}
