/* Any-hit answers that name no triangle, and any-hit against closest-hit. */
#include "ref/judge/judge.h"
#include "ref/base/rng.h"
#include "tests/exact/legal.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/judge/judge_fixture.h"

#include <math.h>
#include <stdlib.h>

static const struct hit a_hit = {.prim = 0};

static const struct fixture_subject black_box = {
    "black box, unnamed", "mt", {.formula = TWIN_UNKNOWN, .any_unnamed = true}};
static const struct fixture_subject mt_unnamed = {
    "mt, unnamed", "mt", {.formula = TWIN_MT, .rounding = ROUNDING_IEEE, .any_unnamed = true}};

/* The last has as many triangles as are looked at together. */
static const char *const specs[] = {"soup:n=200", "sphere:n=8", "grid:n=8,height=0", "needles:n=60",
                                    "cornell",    "stack",      "soup:n=64"};

static struct ray some_ray(const struct judge_fixture *c, struct rng *rng)
{
    struct box box = scene_bounds(&c->scene);
    struct ray ray = {.tmax = 0x1p60f};
    float v[3][3];
    scene_tri(&c->scene, rng_below(rng, c->scene.tri_count), v);
    bool beside = rng_below(rng, 2);
    float a = rng_float(rng) * 2, by = ldexpf(1, -(int)rng_below(rng, 26)) - 0x1p-25f;
    for (int k = 0; k < 3; k++) {
        float side = box.hi[k] - box.lo[k] + 1;
        ray.org[k] = rng_range(rng, box.lo[k] - side, box.hi[k] + side);
        float to = rng_range(rng, box.lo[k] - side, box.hi[k] + side);
        float on = v[0][k] + a * (v[1][k] - v[0][k]) - by * (v[2][k] - v[0][k]);
        ray.dir[k] = (beside ? on : to) - ray.org[k];
    }
    return ray;
}

/* The cheat: everything is hit. */
static void a_tracer_that_always_says_hit_is_wrong(void **state)
{
    (void)state;
    const struct fixture_subject *who[] = {&black_box, &mt_unnamed};
    for (size_t w = 0; w < ARRAY_COUNT(who); w++)
        for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
            size_t misses = 0, taken = 0;
            struct judge_fixture *c = judge_fixture_open(specs[s], 1);
            struct box box = scene_bounds(&c->scene);
            struct rng rng = rng_make(s, 1);
            judge_fixture_seat(c, who[w], QUERY_ANY);
            for (int i = 0; i < 2000; i++) {
                struct ray ray = {.tmax = 0x1p60f};
                for (int k = 0; k < 3; k++) {
                    float side = box.hi[k] - box.lo[k] + 1;
                    ray.org[k] = rng_range(&rng, box.lo[k] - side, box.hi[k] + side);
                    ray.dir[k] = rng_range(&rng, -1, 1);
                }
                judge_fixture_ask(c, ray);
                if (c->truth.prim != ABI_NO_PRIM)
                    continue;
                misses++;
                taken += verdict(c, a_hit) != VERDICT_WRONG;
                assert_true(c->judgement.verdict == VERDICT_BOUNDARY ||
                            c->judgement.wrong == WRONG_PHANTOM);
            }
            assert_true(misses > 300);
            if (taken * 500 > misses)
                fail_msg("%s: %s: %zu of %zu misses may be called hits", who[w]->name, specs[s],
                         taken, misses);
            judge_fixture_close(c);
        }
}

/* A triangle whose determinant is 0 in every evaluation excuses no hit. */
static void a_triangle_without_area_excuses_no_hit(void **state)
{
    (void)state;
    for (size_t s = 0; s < SUBJECTS; s++) {
        struct scene scene = layers();
        scene.tri_count = 2;
        scene.index[3] = scene.index[4] = scene.index[5] = 2;
        struct judge_fixture *c = judge_fixture_of(scene);
        struct fixture_subject subject = subjects[s];
        subject.model.any_unnamed = true;
        judge_fixture_seat(c, &subject, QUERY_ANY);
        for (int i = 0; i < 50; i++) {
            judge_fixture_ask(c, along_z(2.0f + (float)i, 0.3f));
            must_be_wrong(c, a_hit, WRONG_PHANTOM);
            judge_fixture_ask(c,
                              (struct ray){{0.3f, 3, -4}, 0, {0.01f * (float)i, 0.1f, 1}, 1e30f});
            must_be_wrong(c, a_hit, WRONG_PHANTOM);
        }
        judge_fixture_close(c);
    }
}

/* What the first look drops judge_may_be_hit does not take. */
static void the_first_look_drops_nothing(void **state)
{
    (void)state;
    size_t possible = 0, misses = 0;
    for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
        struct judge_fixture *c = judge_fixture_open(specs[s], 2);
        struct rng rng = rng_make(s, 3);
        judge_fixture_seat(c, &black_box, QUERY_ANY);
        for (int i = 0; i < 4000; i++) {
            judge_fixture_ask(c, some_ray(c, &rng));
            if (!ray_in_contract(&c->ray) || c->truth.prim != ABI_NO_PRIM)
                continue;
            bool any = false;
            for (uint32_t prim = 0; prim < c->scene.tri_count && !any; prim++)
                any = judge_may_be_hit(c->judge, &c->ray, prim);
            must_be(c, a_hit, any ? VERDICT_BOUNDARY : VERDICT_WRONG);
            misses++;
            possible += any;
        }
        judge_fixture_close(c);
    }
    print_message("%zu misses, %zu may be called hits\n", misses, possible);
    assert_true(misses > 4000 && possible > 400);
}

/* Nor what the twin of a named formula takes. */
static void nor_of_named_formulas(void **state)
{
    (void)state;
    static const enum twin_formula formulas[] = {TWIN_MT, TWIN_EMBREE, TWIN_PLUECKER, TWIN_WOOP};
    size_t possible = 0, misses = 0;
    for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
        struct judge_fixture *c = judge_fixture_open(specs[s], 6);
        struct rng rng = rng_make(s, 7);
        for (int i = 0; i < 2000; i++) {
            struct fixture_subject subject = mt_unnamed;
            subject.model.formula = formulas[i % 4];
            subject.model.rounding = ROUNDING_VULKAN;
            judge_fixture_ask(c, some_ray(c, &rng));
            if (!ray_in_contract(&c->ray) || c->truth.prim != ABI_NO_PRIM)
                continue;
            bool any = false;
            for (uint32_t prim = 0; prim < c->scene.tri_count && !any; prim++) {
                float v[3][3];
                scene_tri(&c->scene, prim, v);
                struct twin twin =
                    twin_eval(subject.model.formula, subject.model.rounding, &c->ray, v);
                any = twin.possible && isfinite(twin.t_err);
            }
            judge_fixture_seat(c, &subject, QUERY_ANY);
            if (any)
                must_be(c, a_hit, VERDICT_BOUNDARY);
            misses++;
            possible += any;
        }
        judge_fixture_close(c);
    }
    assert_true(misses > 2000 && possible > 100);
}

/* What published formulas come to, as badly as Vulkan lets them, is not called WRONG. */
static void honest_hits_are_not_wrong(void **state)
{
    (void)state;
    static const enum twin_formula formulas[] = {TWIN_MT, TWIN_WOOP};
    size_t phantoms = 0, lost = 0;
    int tries = getenv("RAYDIFF_SLOW") ? 20000 : 1500;
    for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
        struct judge_fixture *c = judge_fixture_open(specs[s], 4);
        struct rng rng = rng_make(s, 5);
        for (int i = 0; i < tries; i++) {
            size_t f = (size_t)i % ARRAY_COUNT(formulas);
            struct legal legal = {.rounding = ROUNDING_VULKAN,
                                  .style = LEGAL_ALIKE,
                                  .seed = (uint64_t)i,
                                  .fuses = i % 3 == 0};
            struct fixture_subject named = mt_unnamed;
            named.model.formula = formulas[f];
            named.model.rounding = legal.rounding;
            judge_fixture_ask(c, some_ray(c, &rng));
            if (!ray_in_contract(&c->ray))
                continue;
            struct hit answer = a_miss();
            for (uint32_t prim = 0; prim < c->scene.tri_count && answer.prim == ABI_NO_PRIM;
                 prim++) {
                float v[3][3];
                scene_tri(&c->scene, prim, v);
                if (legal_evaluate(&legal, formulas[f], &c->ray, v).accepted)
                    answer = a_hit;
            }
            const struct fixture_subject *who[] = {&black_box, &named};
            for (size_t w = 0; w < ARRAY_COUNT(who); w++) {
                judge_fixture_seat(c, who[w], QUERY_ANY);
                if (verdict(c, answer) == VERDICT_WRONG)
                    must_be(c, answer, VERDICT_BOUNDARY);
            }
            phantoms += answer.prim != ABI_NO_PRIM && c->truth.prim == ABI_NO_PRIM;
            lost += answer.prim == ABI_NO_PRIM && c->truth.prim != ABI_NO_PRIM;
        }
        judge_fixture_close(c);
    }
    print_message("%zu hits where nothing is, %zu misses where something is\n", phantoms, lost);
    assert_true(phantoms > 20 && lost > 20);
}

/* A miss of a black box is measured as any other. */
static void a_miss_of_a_black_box_is_judged_by_displacement(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    judge_fixture_seat(c, &black_box, QUERY_ANY);
    must_be_wrong(c, a_miss(), WRONG_MISSED);
    assert_true(c->judgement.displacement > 1000);
    judge_fixture_ask(c, along_z(1, 0.25f));
    must_be(c, a_miss(), VERDICT_BOUNDARY);
    judge_fixture_close(c);
}

/* A hit where the range ends just before or behind a layer needs the distance of that end from it:
 * in units of 2^-24 of the largest coordinate of a vertex from the origin, which is 1.5. */
static void a_hit_beyond_an_end_needs_its_distance_from_it(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    const double unit = 0x1p-24 * 1.5;
    size_t asked = 0;
    judge_fixture_seat(c, &black_box, QUERY_ANY);
    for (int end = 0; end < 2; end++)
        for (float turn = 1; turn <= 4; turn *= 2) /* t counts in multiples of the direction */
            for (int units = 1; units < 31; units++) {
                struct ray ray = {{0.5f, -0.25f, 0}, 0, {0.03125f, 0.0625f, turn}, 1};
                const double off = units * unit;
                ray.tmax = (float)((1 - off) / (double)turn);
                if (end == 1) { /* between the layers' planes, the lower one behind its beginning */
                    ray.tmin = (float)((1 + off) / (double)turn);
                    ray.tmax = 1.5f / turn;
                }
                judge_fixture_ask(c, ray);
                assert_int_equal(c->truth.prim, ABI_NO_PRIM);
                must_be(c, a_hit, VERDICT_BOUNDARY);
                double from = (double)(end ? ray.tmin : ray.tmax) * (double)turn - 1;
                assert_true(fabs(c->judgement.displacement - fabs(from) / unit) < 1e-6 * units);
                asked++;
            }
    assert_int_equal(asked, 180);
    judge_fixture_close(c);
}

/* Two codes of one engine may differ where it is open whether something is hit, nowhere else. */
static void only_an_open_hit_excuses_any_from_closest(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    struct judgement hit = {.expected = 0}, miss = {.expected = 0};
    const struct hit triangle = {1, 0.25f, 0.25f, 0};
    for (size_t s = 0; s < SUBJECTS; s++)
        for (int v = 0; v < VERDICT_OUT_OF_CONTRACT; v++) {
            bool open = v != VERDICT_RIGHT && v != VERDICT_TIE && v != VERDICT_NEAR_TIE;
            judge_fixture_seat(c, &subjects[s], QUERY_ANY);
            bool excused = open && !twin_is_own(subjects[s].model.formula);
            for (int any = 0; any < 2; any++) {
                const struct hit none = a_miss();
                /* Something is hit, so that the miss has to be open, whatever the hit is. */
                hit.verdict = VERDICT_BOUNDARY;
                miss = (struct judgement){.verdict = (enum verdict)v, .expected = 0};
                struct judgement judged = any ? hit : miss;
                judge_any_against_closest(c->judge, &c->ray, any ? &none : &triangle,
                                          any ? &miss : &hit, any ? &triangle : &none, &judged);
                assert_int_equal(judged.wrong, excused ? WRONG_NOT : WRONG_ANY_DISAGREES);
            }
        }
    judge_fixture_close(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tracer_that_always_says_hit_is_wrong),
        cmocka_unit_test(a_triangle_without_area_excuses_no_hit),
        cmocka_unit_test(the_first_look_drops_nothing),
        cmocka_unit_test(nor_of_named_formulas),
        cmocka_unit_test(honest_hits_are_not_wrong),
        cmocka_unit_test(a_miss_of_a_black_box_is_judged_by_displacement),
        cmocka_unit_test(a_hit_beyond_an_end_needs_its_distance_from_it),
        cmocka_unit_test(only_an_open_hit_excuses_any_from_closest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
