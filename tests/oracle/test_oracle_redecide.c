/* The second opinion on WRONG verdicts: its bounds hold for every evaluation, its proofs find
 * planted wrong answers, and it overturns what is right. */
#include "ref/engine.h"
#include "ref/primitives/primitives.h"
#include "tests/exact/exact_gmp_bounds.h"
#include "tests/exact/exact_gmp_redecide.h"
#include "tests/exact/oracle_batch.h"
#include "tests/support/ray_fixture.h"
#include "ref/primitives/test_run.h"

#include <math.h>
#include <stdio.h>

static const uint32_t tests_of[] = {ABI_TRI_MT, ABI_TRI_MT_RTRS, ABI_TRI_WOOP, ABI_TRI_PLUECKER,
                                    ABI_TRI_BALDWIN_WEBBER};
static const enum twin_formula formula_of[] = {TWIN_MT, TWIN_MT_RTRS, TWIN_WOOP, TWIN_PLUECKER,
                                               TWIN_BALDWIN_WEBBER};

/* Distance of a float to the exact value over its bound. */
static double over(const struct known *known, float value)
{
    mpq_t off;
    mpq_init(off);
    mpq_set_d(off, (double)value);
    mpq_sub(off, off, known->v);
    mpq_abs(off, off);
    if (mpq_sgn(known->e) > 0)
        mpq_div(off, off, known->e);
    double ratio = mpq_get_d(off);
    mpq_clear(off);
    return ratio;
}

/* What C computes never leaves the bounds; what is certain is accepted, what is impossible not. */
static void bounds_hold_for_the_tests_of_c(void **state)
{
    (void)state;
    size_t certain = 0, impossible = 0, accepted = 0, faults = 0;
    double largest[ARRAY_COUNT(tests_of)] = {0};
    for (int k = 0; k < ORACLE_CASES; k++)
#pragma omp parallel for schedule(dynamic, 4) reduction(+ : certain, impossible, accepted, faults)
        for (uint64_t b = 0; b < count_per_kind(1600) / (3 * BATCH); b++) {
            struct oracle_batch batch;
            struct gmp_bounds bounds;
            struct gmp_pair pair;
            batch_make(&oracle_cases[k], 40000 + b, &batch);
            gmp_bounds_init(&bounds);
            exact_gmp_init(&pair);
            for (uint32_t i = 0; i < BATCH; i++)
                for (size_t f = 0; f < ARRAY_COUNT(tests_of); f++) {
                    const struct ray *ray = &batch.ray[i];
                    struct model model = {.formula = formula_of[f], .rounding = ROUNDING_IEEE};
                    struct tri_ray r = tri_ray_make(ray);
                    struct hit hit;
                    float v[3][3];
                    scene_tri(&batch.scene, i, v);
                    gmp_bounds_of(&model, ray, v, &bounds);
                    exact_gmp_pair(ray, v, &pair);
                    bool hits = tri_test_run(tests_of[f], &r, v, &hit);
                    bool is_certain = gmp_bounds_certain(&bounds, ray);
                    bool in_open_range = hits && hit.t > ray->tmin && hit.t < ray->tmax;
                    faults += is_certain && !in_open_range;
                    faults += is_certain && !exact_gmp_hits(&pair, ORACLE_OPEN);
                    faults += !gmp_bounds_possible(&bounds, ray) && in_open_range;
                    certain += is_certain;
                    impossible += !gmp_bounds_possible(&bounds, ray);
                    accepted += hits;
                    if (!hits || bounds.none || !bounds.divided)
                        continue;
                    faults += pair.point && mpq_cmp(bounds.t.v, pair.t) != 0;
                    if (!isfinite(hit.t) || !isfinite(hit.u) || !isfinite(hit.v)) {
                        faults++;
                        continue;
                    }
                    double most = fmax(over(&bounds.t, hit.t),
                                       fmax(over(&bounds.u, hit.u), over(&bounds.v, hit.v)));
                    faults += !(most <= 1);
#pragma omp critical
                    largest[f] = fmax(largest[f], most);
                }
            gmp_bounds_clear(&bounds);
            exact_gmp_clear(&pair);
            batch_free(&batch);
        }
    printf("%zu certain, %zu impossible, %zu accepted; largest error over its bound: mt %.2f, "
           "mt_rtrs %.2f, woop %.2f, pluecker %.2f, baldwin_webber %.2f\n",
           certain, impossible, accepted, largest[0], largest[1], largest[2], largest[3],
           largest[4]);
    assert_int_equal(faults, 0);
    assert_true(certain > 1000 && impossible > 1000 && accepted > 1000);
    for (size_t f = 0; f < ARRAY_COUNT(tests_of);
         f++) /* a bound never nearly reached would confirm nothing */
        assert_true(largest[f] > 0.05);
}

/* Woop's numerator of t is of degree 4: 1 / d times three lengths. */
static void overflow_has_no_bounds(void **state)
{
    (void)state;
    const struct ray ray = {
        {-0x1p-44f, 3, 0x1p15f}, -0x1p127f, {-0x1p-29f, 0x1p-58f, 0x1p-44f}, INFINITY};
    float v[3][3] = {
        {0x1p36f, -0x1p-34f, 0x1p36f}, {0x1p-5f, 0x1p35f, -0x1p18f}, {-0x1p34f, -0x1p-54f, -1}};
    const struct model model = {.formula = TWIN_WOOP, .rounding = ROUNDING_IEEE};
    struct gmp_bounds bounds;
    struct tri_ray r = tri_ray_make(&ray);
    struct hit hit;
    gmp_bounds_init(&bounds);
    gmp_bounds_of(&model, &ray, v, &bounds);
    bool hits = tri_test_run(ABI_TRI_WOOP, &r, v, &hit);
    bool none = bounds.none;
    gmp_bounds_clear(&bounds);
    assert_true(hits && isinf(hit.t));
    assert_true(none);
}

/* Embree's answers, by its own formulas: what it names is possible, and its numbers are allowed. */
static void bounds_hold_for_embree(void **state)
{
    (void)state;
    enum { RAYS = 400 };
    static const char *const names[] = {"embree", "embree_robust"};
    static const char *const scenes[] = {"flake", "terrain", "needles", "grid"};
    static struct ray ray[RAYS];
    static struct hit hit[RAYS];
    size_t named = 0;
    for (size_t n = 0; n < 2 * ARRAY_COUNT(scenes); n++) {
        const struct engine *engine = engine_find(names[n % 2]);
        const struct engine_options options = {.threads = 1, .device = -1};
        struct scene scene = default_scene(scenes[n / 2]);
        struct reason reason = {""};
        struct trace_report report;
        void *self;
        double largest = 0;
        if (engine_open(engine, &options, &self, &reason) == STATUS_UNSUPPORTED) {
            printf("SKIP %s\n", reason.text);
            scene_free(&scene);
            skip();
        }
        struct job job = {.scene = &scene, .box = box_tests[0], .tri = tri_tests[0]};
        make_rays("mixed", &scene, 9, RAYS, ray);
        if (engine->prepare(self, &job, &reason) ||
            engine->trace(self, ray, RAYS, hit, &report, &reason))
            fail_msg("%s", reason.text);
        struct model model = engine_model(engine, self, job.tri);
        struct gmp_bounds bounds;
        gmp_bounds_init(&bounds);
        for (int i = 0; i < RAYS; i++) {
            float v[3][3];
            if (hit[i].prim == ABI_NO_PRIM)
                continue;
            scene_tri(&scene, hit[i].prim, v);
            gmp_bounds_of(&model, &ray[i], v, &bounds);
            assert_true(gmp_bounds_possible(&bounds, &ray[i]));
            if (!bounds.none && bounds.divided)
                largest =
                    fmax(largest, fmax(over(&bounds.t, hit[i].t),
                                       fmax(over(&bounds.u, hit[i].u), over(&bounds.v, hit[i].v))));
            named++;
        }
        printf("%s, %s: largest error over its bound %.3f\n", scenes[n / 2], names[n % 2], largest);
        assert_true(largest <= 1);
        gmp_bounds_clear(&bounds);
        engine->close(self);
        scene_free(&scene);
    }
    assert_true(named > 1000);
}

/* Each planted wrong answer, and the proof that must be found. */
static enum gmp_proof proof_of(const struct scene *scene, const struct ray *ray, bool any,
                               struct hit answer)
{
    struct model model = {.formula = TWIN_WOOP, .rounding = ROUNDING_IEEE};
    struct gmp_second second = exact_gmp_redecide(scene, ray, &model, any, &answer);
    assert_int_equal(second.opinion, second.proof == GMP_PROOF_NONE    ? GMP_OPEN
                                     : second.proof == GMP_PROOF_RIGHT ? GMP_OVERTURNED
                                                                       : GMP_CONFIRMED);
    return second.proof;
}

static void planted_wrong_answers_are_confirmed(void **state)
{
    (void)state;
    enum { RAYS = 60 };
    static struct ray ray[RAYS];
    struct scene scene = make_scene("flake", 1);
    size_t confirmed = 0, nearer = 0;
    make_rays("random", &scene, 3, RAYS, ray);
    for (int i = 0; i < RAYS; i++) {
        struct hit good, bad;
        trace_brute(&scene, tri_test_find("woop"), QUERY_CLOSEST, &ray[i], &good);
        enum gmp_proof proof = proof_of(&scene, &ray[i], false, good);
        assert_true(proof == GMP_PROOF_NONE || proof == GMP_PROOF_RIGHT);
        if (good.prim == ABI_NO_PRIM) {
            assert_int_equal(proof, GMP_PROOF_RIGHT);
            bad = (struct hit){1, 0.25f, 0.25f, 7};
            assert_int_equal(proof_of(&scene, &ray[i], false, bad), GMP_PROOF_PHANTOM);
            continue;
        }
        bad = (struct hit){0, 0, 0, ABI_NO_PRIM};
        assert_int_equal(proof_of(&scene, &ray[i], false, bad), GMP_PROOF_MISSED);
        bad = good;
        bad.t = good.t * (1 + 0x1p-6f);
        assert_int_equal(proof_of(&scene, &ray[i], false, bad), GMP_PROOF_DISTANCE);
        bad = good;
        bad.u = good.v + 0.125f;
        assert_int_equal(proof_of(&scene, &ray[i], false, bad), GMP_PROOF_BARYCENTRIC);
        bad = good;
        bad.t = NAN;
        assert_int_equal(proof_of(&scene, &ray[i], true, bad), GMP_PROOF_NOT_FINITE);
        bad = good;
        bad.prim = scene.tri_count;
        assert_int_equal(proof_of(&scene, &ray[i], true, bad), GMP_PROOF_NO_TRIANGLE);
        bad = good;
        bad.prim = (good.prim + 1) % scene.tri_count;
        proof = proof_of(&scene, &ray[i], false, bad);
        assert_true(proof == GMP_PROOF_PHANTOM || proof == GMP_PROOF_DISTANCE);
        struct ray behind = ray[i];
        behind.tmin = nextafterf(good.t, INFINITY) * (1 + 0x1p-10f);
        trace_brute(&scene, tri_test_find("woop"), QUERY_CLOSEST, &behind, &bad);
        if (bad.prim != ABI_NO_PRIM) {
            assert_int_equal(proof_of(&scene, &ray[i], false, bad), GMP_PROOF_NEARER);
            proof = proof_of(&scene, &ray[i], true, bad); /* any-hit may name it */
            assert_true(proof == GMP_PROOF_NONE || proof == GMP_PROOF_RIGHT);
            nearer++;
        }
        confirmed++;
    }
    scene_free(&scene);
    printf("%zu wrong answers of each kind confirmed, %zu nearer\n", confirmed, nearer);
    assert_true(confirmed > 10 && nearer > 5);
}

/* Where signs are open nothing is proven, unless the answer is the exact one. */
static void boundaries_stay_open(void **state)
{
    (void)state;
    struct scene scene;
    static const float v[9] = {0, 0, 1, 1, 0, 1, 0, 1, 1};
    struct ray ray = {{0.5f, 0, 0}, 0, {0, 0, 1}, 10}; /* on the edge v0 v1 */
    assert_int_equal(scene_make(3, 1, &scene), STATUS_OK);
    for (uint32_t i = 0; i < 9; i++)
        scene.vertex[i] = v[i];
    for (uint32_t i = 0; i < 3; i++)
        scene.index[i] = i;
    struct hit miss = {0, 0, 0, ABI_NO_PRIM}, exact = {1, 0.5f, 0, 0};
    assert_int_equal(proof_of(&scene, &ray, false, miss), GMP_PROOF_NONE);
    assert_int_equal(proof_of(&scene, &ray, false, exact), GMP_PROOF_RIGHT);
    ray.tmax = 1; /* at the end of a closed range */
    assert_int_equal(proof_of(&scene, &ray, false, exact), GMP_PROOF_RIGHT);
    ray.tmax = 0.5f;
    assert_int_equal(proof_of(&scene, &ray, false, exact), GMP_PROOF_PHANTOM);
    assert_int_equal(proof_of(&scene, &ray, false, miss), GMP_PROOF_RIGHT);
    struct model unknown = {.formula = TWIN_UNKNOWN, .rounding = ROUNDING_IEEE};
    assert_int_equal(exact_gmp_redecide(&scene, &ray, &unknown, false, &exact).opinion, GMP_OPEN);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bounds_hold_for_the_tests_of_c),
        cmocka_unit_test(overflow_has_no_bounds),
        cmocka_unit_test(bounds_hold_for_embree),
        cmocka_unit_test(planted_wrong_answers_are_confirmed),
        cmocka_unit_test(boundaries_stay_open),
    };
    return cmocka_run_group_tests_name("oracle_redecide", tests, NULL, NULL) ? 1 : 0;
}
