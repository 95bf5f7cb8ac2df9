/* The replay of the triangle tests by rationals gives C's bits, and decides verdicts for good. */
#include "ref/primitives/primitives.h"
#include "tests/exact/exact_gmp_redecide.h"
#include "tests/exact/exact_gmp_replay.h"
#include "tests/exact/oracle_batch.h"
#include "ref/primitives/test_run.h"

#include <math.h>
#include <stdio.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const uint32_t tests_of[] = {ABI_TRI_MT, ABI_TRI_MT_RTRS, ABI_TRI_WOOP, ABI_TRI_PLUECKER,
                                    ABI_TRI_BALDWIN_WEBBER};
static const enum twin_formula formula_of[] = {TWIN_MT, TWIN_MT_RTRS, TWIN_WOOP, TWIN_PLUECKER,
                                               TWIN_BALDWIN_WEBBER};

static struct model model_of(enum twin_formula formula)
{
    return (struct model){.formula = formula, .rounding = ROUNDING_IEEE, .bits = true};
}

static bool same_float(float a, float b)
{
    return a == b || (isnan(a) && isnan(b));
}

static void rounds_as_the_processor_does(void **state)
{
    (void)state;
    struct rng rng = rng_make(11, 1);
    size_t halfway = 0, count = count_per_kind(200000);
    mpq_t x;
    mpq_init(x);
    for (size_t i = 0; i < count; i++) {
        /* A float32, and up to 1.5 steps of it in 8ths: a quarter of them ties. */
        double base = (double)random_bits(&rng),
               step = fabs((double)nextafterf((float)base, INFINITY) - base);
        double value = base + step * (double)rng_below(&rng, 13) / 8;
        if (!isfinite(value))
            continue;
        mpq_set_d(x, value);
        halfway += fabs(value - (double)(float)value) * 2 == step;
        assert_true(same_float(exact_gmp_round(x), (float)value));
    }
    mpq_clear(x);
    printf("%zu roundings, %zu of ties\n", count, halfway);
    assert_true(halfway > count / 20);
}

static void replays_the_bits_of_c(void **state)
{
    (void)state;
    size_t same = 0, faults = 0, unsaid = 0, accepted = 0;
    for (int k = 0; k < ORACLE_CASES; k++)
#pragma omp parallel for schedule(dynamic, 4) reduction(+ : same, faults, unsaid, accepted)
        for (uint64_t b = 0; b < count_per_kind(3200) / BATCH; b++) {
            struct oracle_batch batch;
            batch_make(&oracle_cases[k], 70000 + b, &batch);
            for (uint32_t i = 0; i < BATCH; i++)
                for (size_t f = 0; f < ARRAY_COUNT(tests_of); f++) {
                    struct model model = model_of(formula_of[f]);
                    struct tri_ray r = tri_ray_make(&batch.ray[i]);
                    struct gmp_replay replay;
                    struct hit hit;
                    float v[3][3];
                    scene_tri(&batch.scene, i, v);
                    if (!exact_gmp_replay(&model, &batch.ray[i], v, &replay)) {
                        unsaid++;
                        continue;
                    }
                    bool hits = tri_test_run(tests_of[f], &r, v, &hit);
                    faults += hits != exact_gmp_replay_hits(&replay, &batch.ray[i], f == 1);
                    faults += hits && (hit.t != replay.t || hit.u != replay.u || hit.v != replay.v);
                    accepted += hits;
                    same++;
                }
            batch_free(&batch);
        }
    printf("%zu replayed, %zu of them accepted, %zu beyond a replay, %zu differ\n", same, accepted,
           unsaid, faults);
    assert_int_equal(faults, 0);
    assert_true(accepted > 1000 && same > 10 * unsaid / 8);
}

static void needs_the_promise_of_bits(void **state)
{
    (void)state;
    static float v[3][3] = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    struct ray ray = {{0.25f, 0.25f, 0}, 0, {0, 0, 1}, 10};
    struct gmp_replay replay;
    struct model model = model_of(TWIN_WOOP);
    assert_true(exact_gmp_replay(&model, &ray, v, &replay));
    assert_true(replay.accepted && replay.t == 1 && replay.u == 0.25f && replay.v == 0.25f);
    assert_true(exact_gmp_replay_hits(&replay, &ray, true));
    ray.tmax = 1;
    assert_true(exact_gmp_replay_hits(&replay, &ray, false));
    assert_false(exact_gmp_replay_hits(&replay, &ray, true));
    model.bits = false;
    assert_false(exact_gmp_replay(&model, &ray, v, &replay));
    model = model_of(TWIN_WOOP);
    model.rounding = ROUNDING_FLUSHED;
    assert_false(exact_gmp_replay(&model, &ray, v, &replay));
    model = model_of(TWIN_EMBREE);
    assert_false(exact_gmp_replay(&model, &ray, v, &replay));
    ray.dir[2] = 0x1p-149f;
    ray.dir[0] = 0x1p-149f;
    model = model_of(TWIN_WOOP); /* 1 / d overflows */
    assert_false(exact_gmp_replay(&model, &ray, v, &replay));
}

/* One triangle and a ray through its inside, or past it: what each answer must be called. */
static void decides_for_good(void **state)
{
    (void)state;
    static const float corner[9] = {0, 0, 1, 1, 0, 1, 0, 1, 1};
    struct scene scene;
    struct ray ray = {{0.3f, 0.3f, 0}, 0, {0, 0, 1}, 10};
    struct model model = model_of(TWIN_MT);
    assert_int_equal(scene_make(3, 1, &scene), STATUS_OK);
    for (uint32_t i = 0; i < 9; i++)
        scene.vertex[i] = corner[i];
    for (uint32_t i = 0; i < 3; i++)
        scene.index[i] = i;
    struct hit right = {1, 0.3f, 0.3f, 0}, miss = {0, 0, 0, ABI_NO_PRIM}, bad = right;
    assert_int_equal(exact_gmp_redecide(&scene, &ray, &model, false, &miss).proof,
                     GMP_PROOF_MISSED);
    assert_int_equal(exact_gmp_redecide(&scene, &ray, &model, false, &right).opinion,
                     GMP_OVERTURNED);
    bad.t = nextafterf(1, 2);
    assert_int_equal(exact_gmp_redecide(&scene, &ray, &model, false, &bad).proof,
                     GMP_PROOF_DISTANCE);
    bad = right;
    bad.u = nextafterf(0.3f, 0);
    assert_int_equal(exact_gmp_redecide(&scene, &ray, &model, false, &bad).proof,
                     GMP_PROOF_BARYCENTRIC);
    bad.u = NAN;
    assert_int_equal(exact_gmp_redecide(&scene, &ray, &model, false, &bad).proof,
                     GMP_PROOF_NOT_FINITE);
    ray.org[0] = 2;
    assert_int_equal(exact_gmp_redecide(&scene, &ray, &model, false, &right).proof,
                     GMP_PROOF_PHANTOM);
    assert_int_equal(exact_gmp_redecide(&scene, &ray, &model, false, &miss).proof, GMP_PROOF_RIGHT);
    scene_free(&scene);
}

/* Edges that exact arithmetic hits and Moeller-Trumbore in float32 rejects: a miss is excused. */
static void excuses_what_the_formula_rejects(void **state)
{
    (void)state;
    struct rng rng = rng_make(5, 1);
    struct model model = model_of(TWIN_MT);
    struct scene scene;
    size_t excused = 0, missed = 0;
    assert_int_equal(scene_make(3, 1, &scene), STATUS_OK);
    for (uint32_t i = 0; i < 3; i++)
        scene.index[i] = i;
    for (int n = 0; n < 4000; n++) {
        struct ray ray = {{0, 0, 0}, 0, {0, 0, 0}, INFINITY};
        for (int i = 0; i < 9; i++)
            scene.vertex[i] = rng_float(&rng) + (i % 3 == 2 ? 1.0f : 0.0f);
        for (int k = 0; k < 3; k++) /* at vertex 1, which the ray hits exactly */
            ray.dir[k] = scene.vertex[3 + k];
        float v[3][3];
        struct hit hit, miss = {0, 0, 0, ABI_NO_PRIM};
        struct tri_ray r = tri_ray_make(&ray);
        scene_tri(&scene, 0, v);
        bool accepted = tri_test_run(ABI_TRI_MT, &r, v, &hit);
        enum gmp_proof proof = exact_gmp_redecide(&scene, &ray, &model, false, &miss).proof;
        assert_int_equal(proof, accepted ? GMP_PROOF_MISSED : GMP_PROOF_EXCUSED);
        excused += !accepted;
        missed += accepted;
    }
    scene_free(&scene);
    printf("%zu misses excused, %zu confirmed\n", excused, missed);
    assert_true(excused > 100 && missed > 100);
}

/* Rays at the shared edges of a closed mesh: some triangle of both is accepted, so a miss is proven
 * wrong even where the triangle that exact arithmetic hits is the one that the formula rejects. */
static void asks_the_neighbours_of_watertight_formulas(void **state)
{
    (void)state;
    static const float corner[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    static const uint32_t face[12] = {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2};
    struct rng rng = rng_make(9, 1);
    struct model model = model_of(TWIN_WOOP);
    struct scene scene;
    size_t by_neighbour = 0;
    assert_int_equal(scene_make(4, 4, &scene), STATUS_OK);
    for (uint32_t i = 0; i < 12; i++) {
        scene.vertex[i] = corner[i / 3][i % 3];
        scene.index[i] = face[i];
    }
    for (int n = 0; n < 2000; n++) {
        struct ray ray = {{0, 0, 0}, 0, {0, 0, 0}, INFINITY};
        float along = rng_float(&rng);
        for (int k = 0; k < 3; k++) {
            ray.org[k] = rng_range(&rng, -0.2f, 0.2f);
            ray.dir[k] = corner[0][k] + along * (corner[1][k] - corner[0][k]) - ray.org[k];
        }
        struct hit miss = {0, 0, 0, ABI_NO_PRIM};
        struct gmp_second tight, loose;
        model.watertight = true;
        tight = exact_gmp_redecide(&scene, &ray, &model, false, &miss);
        model.watertight = false;
        loose = exact_gmp_redecide(&scene, &ray, &model, false, &miss);
        assert_int_equal(tight.proof, GMP_PROOF_MISSED);
        assert_true(loose.proof == GMP_PROOF_MISSED || loose.proof == GMP_PROOF_EXCUSED);
        by_neighbour += loose.proof == GMP_PROOF_EXCUSED;
    }
    scene_free(&scene);
    printf("%zu of 2000 by a neighbour\n", by_neighbour);
    assert_true(by_neighbour > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rounds_as_the_processor_does),
        cmocka_unit_test(replays_the_bits_of_c),
        cmocka_unit_test(needs_the_promise_of_bits),
        cmocka_unit_test(decides_for_good),
        cmocka_unit_test(excuses_what_the_formula_rejects),
        cmocka_unit_test(asks_the_neighbours_of_watertight_formulas),
    };
    return cmocka_run_group_tests_name("oracle_replay", tests, NULL, NULL) ? 1 : 0;
}
