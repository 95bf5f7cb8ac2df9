/* How much slack the judge's own constants have: what the exact values it compares with may be off,
 * and how far woop may move a vertex, which the bands for unknown formulas come from. Prints the
 * tables; fails above the proof. */
#include "tests/exact/trials.h"

#include "ref/judge/judge_inner.h"
#include "ref/primitives/test_run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

static uint64_t trials(void)
{
    return getenv("RAYDIFF_SLOW") ? 200000 : 20000;
}

/* Small triangles far from the origin, where differences of large products cancel. */
static void draw_far(struct rng *rng, struct gmp_pair *pair, struct trials_trial *out)
{
    double target[3];
    float size = ldexpf(1, -(int)rng_below(rng, 24));
    float a = rng_float(rng), b = rng_below(rng, 2) ? (1 - a) * rng_float(rng) : 0; /* an edge */
    for (int k = 0; k < 3; k++) {
        float centre = rng_range(rng, -1, 1);
        out->ray.org[k] = rng_range(rng, -1, 1);
        for (int c = 0; c < 3; c++)
            out->v[c][k] = centre + size * rng_range(rng, -1, 1);
        target[k] = (double)(1 - a - b) * (double)out->v[0][k] + (double)a * (double)out->v[1][k] +
                    (double)b * (double)out->v[2][k];
        out->ray.dir[k] = (float)(target[k] - (double)out->ray.org[k]);
    }
    out->ray.tmin = 0;
    out->ray.tmax = INFINITY;
    trial_truth(pair, out);
}

static double off(double value, struct sum exact)
{
    return fabs((value - exact.head) - exact.tail);
}

struct most {
    double t, uv;
    uint64_t count;
};

static void take(const struct trials_trial *trial, enum twin_formula formula, struct most *most)
{
    float v[3][3];
    memcpy(v, trial->v, sizeof v);
    struct twin twin = twin_eval(formula, ROUNDING_IEEE, &trial->ray, v);
    if (!trial->truth.point || !twin.det || !isfinite(twin.t_err) || !isfinite(twin.u_err) ||
        !isfinite(twin.v_err))
        return;
    most->count++;
    most->t = fmax(most->t, off(twin.t_near, trial->truth.t) / twin.t_off);
    assert_true(4 * twin.t_off <= twin.t_err);
    most->uv = fmax(most->uv, off(twin.u_near, trial->truth.weight[1]) / twin.u_err);
    most->uv = fmax(most->uv, off(twin.v_near, trial->truth.weight[2]) / twin.v_err);
}

static void near_values_have_this_much_slack(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        enum twin_formula formula;
    } formulas[] = {{"mt", TWIN_MT},
                    {"woop", TWIN_WOOP},
                    {"pluecker", TWIN_PLUECKER},
                    {"baldwin_webber", TWIN_BALDWIN_WEBBER},
                    {"tri_accel", TWIN_TRI_ACCEL},
                    {"embree", TWIN_EMBREE},
                    {"embree_robust", TWIN_EMBREE_ROBUST}};
    struct most most[ARRAY_COUNT(formulas)] = {{0}};
    struct gmp_pair pair;
    struct rng rng = rng_make(71, 0);
    exact_gmp_init(&pair);
    for (uint64_t n = 0; n < trials(); n++) {
        struct trials_trial trial;
        if (n % 2)
            draw_far(&rng, &pair, &trial);
        else
            trial_make((int)(n / 2 % TRIAL_KINDS), n, &pair, &trial);
        for (size_t f = 0; f < ARRAY_COUNT(formulas); f++)
            take(&trial, formulas[f].formula, &most[f]);
    }
    exact_gmp_clear(&pair);
    for (size_t f = 0; f < ARRAY_COUNT(formulas); f++) {
        print_message("near-exact values, %-14s: t seen 2^%.1f of its proof; u and v chosen 2^-20 "
                      "E, proof 2^-28 E, seen 2^%.1f E, of %llu\n",
                      formulas[f].name, log2(most[f].t), log2(most[f].uv),
                      (unsigned long long)most[f].count);
    }
    for (size_t f = 0; f < ARRAY_COUNT(formulas); f++) {
        assert_true(most[f].t <= 1 && most[f].uv <= 0x1p-28 && 0x1p-28 < JUDGE_SHARE);
        assert_true(most[f].t > 0x1p-6 && most[f].count > trials() / 4);
    }
}

/* An honest answer is never WRONG, however small the triangle and far the origin: a double that
 * lost more than the bound allows would say so. */
static void honest_answers_are_not_wrong(void **state)
{
    (void)state;
    static const char *const tests[] = {"mt", "woop", "pluecker", "baldwin_webber"};
    static const enum twin_formula formulas[] = {TWIN_MT, TWIN_WOOP, TWIN_PLUECKER,
                                                 TWIN_BALDWIN_WEBBER};
    uint64_t judged = 0;
    struct gmp_pair pair;
    struct rng rng = rng_make(73, 0);
    exact_gmp_init(&pair);
    for (uint64_t n = 0; n < trials(); n++) {
        struct trials_trial trial;
        draw_far(&rng, &pair, &trial);
        float vertex[9];
        uint32_t index[3] = {0, 1, 2};
        memcpy(vertex, trial.v, sizeof vertex);
        struct scene scene = {.vertex = vertex, .index = index, .vertex_count = 3, .tri_count = 1};
        struct oracle *oracle = NULL;
        struct oracle_answer truth;
        assert_int_equal(oracle_make(&scene, &oracle, NULL), STATUS_OK);
        assert_int_equal(oracle_closest(oracle, ORACLE_BRUTE, ORACLE_CLOSED, &trial.ray, 1, 1,
                                        &truth, NULL, NULL),
                         STATUS_OK);
        for (size_t f = 0; f < ARRAY_COUNT(tests); f++) {
            const struct tri_test *tri = tri_test_find(tests[f]);
            struct model model = {.formula = formulas[f], .rounding = ROUNDING_IEEE};
            struct tri_ray r = tri_ray_make(&trial.ray);
            struct judge *judge = NULL;
            struct judgement judgement;
            struct hit hit;
            if (!tri_test_run(tri->id, &r, trial.v, &hit))
                continue;
            hit.prim = 0;
            assert_int_equal(judge_make(oracle, &model, QUERY_CLOSEST, &judge, NULL), STATUS_OK);
            assert_int_equal(judge_answer(judge, &trial.ray, &truth, &hit, &judgement), STATUS_OK);
            if (judgement.verdict == VERDICT_WRONG)
                fail_msg("%s: an honest answer is WRONG (%s)", tests[f],
                         wrong_name(judgement.wrong));
            judge_free(judge);
            judged++;
        }
        oracle_free(oracle);
    }
    exact_gmp_clear(&pair);
    assert_true(judged > trials() / 2);
}

/* --- how far woop moves a vertex -------------------------------------------------------------- */

static const struct {
    const char *name;
    struct rounding rounding;
} roundings[] = {
    {"ieee", ROUNDING_IEEE}, {"vulkan rte", ROUNDING_VULKAN_RTE}, {"vulkan", ROUNDING_VULKAN}};

/* Largest distance in u * max |v - o| of the computed places across the ray from the exact ones. */
static double moved(struct legal *l, const struct trials_trial *trial)
{
    float v[3][3], x[3], y[3], z[3];
    double most = 0, size = 0;
    struct tri_ray r = tri_ray_make(&trial->ray);
    memcpy(v, trial->v, sizeof v);
    legal_woop_shear(l, &r, v, x, y, z);
    for (int c = 0; c < 3; c++) {
        double p[3];
        for (int k = 0; k < 3; k++) {
            p[k] = (double)v[c][k] - (double)r.o[k];
            size = fmax(size, fabs(p[k]));
        }
        double depth = p[r.kz] / (double)r.d[r.kz];
        most = fmax(most, hypot((double)x[c] - (p[r.kx] - (double)r.d[r.kx] * depth),
                                (double)y[c] - (p[r.ky] - (double)r.d[r.ky] * depth)));
    }
    return most / size / JUDGE_UNIT;
}

/* Vertices and directions just above powers of two, where rounding is largest; the line is nearly
 * diagonal, so that the shear is near 1. */
static void draw_diagonal(struct rng *rng, struct trials_trial *out)
{
    for (int k = 0; k < 3; k++) {
        out->ray.org[k] = rng_range(rng, -0x1p-20f, 0x1p-20f);
        out->ray.dir[k] = (rng_below(rng, 2) ? 1 : -1) * (1 + rng_float(rng) * 0x1p-8f);
        for (int c = 0; c < 3; c++)
            out->v[c][k] = (rng_below(rng, 2) ? 1 : -1) * (1 + rng_float(rng) * 0x1p-8f);
    }
    out->ray.tmin = 0;
    out->ray.tmax = INFINITY;
}

static void woop_moves_vertices_this_far(void **state)
{
    (void)state;
    for (size_t n = 0; n < ARRAY_COUNT(roundings); n++) {
        const struct rounding *k = &roundings[n].rounding;
        double proven = (5 * k->add + k->div) * sqrt(2), most = 0;
        struct rng rng = rng_make(72, n);
        struct legal legal = {.rounding = *k, .style = LEGAL_CHOSEN};
        for (uint64_t i = 0; i < 20 * trials(); i++) {
            struct trials_trial trial;
            draw_diagonal(&rng, &trial);
            legal.count = 0;
            for (int c = 0; c < 32; c++)
                legal.choice[c] = (uint8_t)rng_below(&rng, 3);
            most = fmax(most, moved(&legal, &trial));
        }
        print_message("woop moves a vertex, %-10s: proof %.1f u M, seen %.2f; FAN_BAND %g, "
                      "JUDGE_DISPLACEMENT_MOST %g, of %llu\n",
                      roundings[n].name, proven, most, FAN_BAND, JUDGE_DISPLACEMENT_MOST,
                      (unsigned long long)(20 * trials()));
        assert_true(most <= proven * (1 + 1e-5) && most > 0.3 * proven && proven < FAN_BAND);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(near_values_have_this_much_slack),
        cmocka_unit_test(honest_answers_are_not_wrong),
        cmocka_unit_test(woop_moves_vertices_this_far),
    };
    return cmocka_run_group_tests_name("bounds_judge", tests, NULL, NULL) ? 1 : 0;
}
