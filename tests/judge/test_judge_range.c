/* The ends of a ray's range: an answer may lie outside by as much as a comparison before the
 * division lets it, and no farther, however loose the bound of t is. */
#include "ref/judge/judge.h"
#include "ref/base/rng.h"
#include "tests/exact/trials.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/judge/judge_fixture.h"

#include <math.h>
#include <stdlib.h>

#define U 0x1p-24

/* A triangle that the ray grazes, so that t is hardly bounded. */
static struct scene grazed(struct rng *rng, struct ray *ray)
{
    struct scene scene;
    float lift = ldexpf(1, -(int)rng_below(rng, 20));
    assert_int_equal(scene_make(3, 1, &scene), STATUS_OK);
    double target[3] = {0, 0, 0};
    for (int c = 0; c < 3; c++) {
        double weight = c == 2 ? 0.5 : 0.25;
        for (int k = 0; k < 3; k++) {
            scene.vertex[3 * c + k] = rng_range(rng, -1, 1) * (k == 2 ? lift : 1);
            target[k] += weight * (double)scene.vertex[3 * c + k];
        }
        scene.index[c] = (uint32_t)c;
    }
    *ray = (struct ray){.tmin = 0, .tmax = 0x1p60f};
    for (int k = 0; k < 3; k++) {
        ray->org[k] = rng_range(rng, -4, 4) * (k == 2 ? lift : 1);
        ray->dir[k] = (float)(target[k] - (double)ray->org[k]);
    }
    return scene;
}

static float beyond(float x, double units)
{
    double moved = (double)x * (1.0 + units * U);
    float f = (float)moved;
    if (units > 0 ? (double)f < moved : (double)f > moved)
        f = nextafterf(f, units > 0 ? INFINITY : 0);
    return f;
}

static const char *const names[] = {"mt",     "woop",         "pluecker", "mt, Vulkan's rounding",
                                    "embree", "embree_robust"};

/* No test answers 0.1 beyond its range; Embree's default one may answer 7.5 u beyond, no other any.
 */
static void an_answer_beyond_the_range_is_wrong(void **state)
{
    (void)state;
    size_t loose = 0;
    for (size_t n = 0; n < ARRAY_COUNT(names); n++)
        for (uint64_t i = 0; i < 300; i++) {
            struct rng rng = rng_make(i, 1);
            struct ray ray;
            struct scene scene = grazed(&rng, &ray);
            struct judge_fixture *c = judge_fixture_of(scene);
            const struct fixture_subject *subject = subject_of(names[n]);
            bool early = subject->model.formula == TWIN_EMBREE;
            judge_fixture_seat(c, subject, QUERY_CLOSEST);
            judge_fixture_ask(c, ray);
            if (c->truth.prim == 0 && ray_in_contract(&ray)) {
                struct hit hit = right_answer(c, 0);
                float t = hit.t;
                for (int end = 0; end < 2; end++) {
                    ray.tmax = end ? t : 0x1p60f;
                    ray.tmin = end ? 0 : t;
                    judge_fixture_ask(c, ray);
                    hit.t = beyond(t, end ? 1e6 : -1e6);
                    must_be(c, hit, VERDICT_WRONG);
                    hit.t = beyond(t, (end ? 1 : -1) * (early ? 8.0 : 0.5));
                    must_be_wrong(c, hit, WRONG_DISTANCE);
                    hit.t = beyond(t, end ? 4 : -4);
                    if (early && verdict(c, hit) != VERDICT_WRONG)
                        loose++;
                }
            }
            judge_fixture_close(c);
        }
    assert_true(loose > 100); /* what Embree may do is not WRONG */
}

/* Whatever Embree's test comes to at the ends of a range is not called WRONG. */
static void what_is_compared_before_the_division_may_be_answered(void **state)
{
    (void)state;
    size_t answers = 0, outside = 0;
    double worst = 0;
    const struct fixture_subject *subject = subject_of("embree");
    struct legal legal = {.rounding = subject->model.rounding, .fuses = true};
    uint64_t tries = getenv("RAYDIFF_SLOW") ? 40000 : 2000;
    for (uint64_t i = 0; i < tries; i++) {
        struct rng rng = rng_make(i, 2);
        struct ray ray;
        struct judge_fixture *c = judge_fixture_of(grazed(&rng, &ray));
        float v[3][3], range = ray.tmax;
        scene_tri(&c->scene, 0, v);
        judge_fixture_seat(c, subject, QUERY_CLOSEST);
        for (int k = 0; k < 12; k++) {
            legal.style = (enum legal_style)(k % LEGAL_ALIKE);
            legal.rng = rng_make(i, 3);
            ray.tmin = 0;
            ray.tmax = range;
            struct evaluation free = legal_evaluate(&legal, TWIN_EMBREE, &ray, v);
            if (!free.accepted || !isfinite(free.t) || !(free.t > 0))
                continue;
            bool end = rng_below(&rng, 2);
            float at = beyond(free.t, (double)rng_range(&rng, -8, 8));
            ray.tmax = end ? at : range;
            ray.tmin = end ? 0 : at;
            legal.rng = rng_make(i, 3);
            struct evaluation e = legal_evaluate(&legal, TWIN_EMBREE, &ray, v);
            if (!e.accepted || !ray_in_contract(&ray))
                continue;
            judge_fixture_ask(c, ray);
            struct hit hit = {e.t, e.u, e.v, 0};
            if (verdict(c, hit) == VERDICT_WRONG)
                must_be(c, hit, VERDICT_BORDER);
            double off = end ? (double)e.t / (double)at - 1 : 1 - (double)e.t / (double)at;
            answers++;
            outside += off > 0;
            worst = fmax(worst, off / U);
        }
        judge_fixture_close(c);
    }
    print_message("%zu answers at an end, %zu outside, by up to %.2f u of 7.5\n", answers, outside,
                  worst);
    assert_true(answers > 1000 && outside > 50 && worst > 3 && worst <= 7.5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_answer_beyond_the_range_is_wrong),
        cmocka_unit_test(what_is_compared_before_the_division_may_be_answered),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
