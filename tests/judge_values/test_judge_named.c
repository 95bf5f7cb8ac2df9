/* What is judged of a named triangle (ref/judge/judge_named.c), by value: twins are given to it,
 * and numbers at every border. */
#include "ref/judge/judge_inner.h"
#include "ref/base/rng.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define U 0x1p-24L

typedef long double wide;

static const struct model mt = {.formula = TWIN_MT, .rounding = {1, 1, 1, 0x1p-149}, .bits = true};
static const struct model loose = {.formula = TWIN_MT, .rounding = {2, 2, 5, 0x1p-126}};

/* One triangle before a judge. */
struct named_one {
    struct scene scene;
    struct oracle *oracle;
    struct judge *judge;
};

static void named_open(struct named_one *out, const struct model *model, float v[3][3])
{
    assert_int_equal(scene_make(3, 1, &out->scene), STATUS_OK);
    memcpy(out->scene.vertex, v, 9 * sizeof(float));
    for (uint32_t c = 0; c < 3; c++)
        out->scene.index[c] = c;
    assert_int_equal(oracle_make(&out->scene, &out->oracle, NULL), STATUS_OK);
    assert_int_equal(judge_make(out->oracle, model, QUERY_CLOSEST, &out->judge, NULL), STATUS_OK);
}

static void named_close(struct named_one *one)
{
    judge_free(one->judge);
    oracle_free(one->oracle);
    scene_free(&one->scene);
}

/* The answer's class, told this twin. */
static enum verdict named(const struct named_one *one, const struct ray *ray,
                          const struct twin *twin, const struct hit *answer, enum wrong *wrong)
{
    const struct oracle_answer truth = {.prim = 0, .tie_count = 1};
    const struct judge_known known = {{0}, {*twin}, 1};
    struct judgement out = {.verdict = VERDICT_RIGHT};
    enum verdict verdict = judge_named(one->judge, ray, &truth, answer, &known, &out);
    *wrong = out.wrong;
    return verdict;
}

static float across[3][3] = {{-1, -1, 3}, {2, -1, 3}, {-1, 2, 3}};

static double pick(struct rng *rng, const double *from, uint32_t count)
{
    return from[rng_below(rng, count)];
}

/* From `at`, some float32s away from where `off` leads. */
static float around(struct rng *rng, double at, double off)
{
    double sign = rng_below(rng, 2) ? 1 : -1;
    float x = (float)(at + sign * off);
    int steps = (int)rng_below(rng, 5) - 2;
    for (int i = 0; i < abs(steps); i++)
        x = nextafterf(x, steps > 0 ? INFINITY : -INFINITY);
    return x;
}

static wide last_place(wide x)
{
    return 2 * U * fabsl(x) + 0x1p-149L;
}

static bool within(float x, double near, wide off)
{
    return fabsl((wide)x - (wide)near) <= last_place((wide)near) + off;
}

/* --- numbers that no evaluation comes to ------------------------------------------------------ */

static struct twin wide_twin(struct rng *rng)
{
    static const double nears[] = {0, 1, 0.3333, 5, 0x1p-30, 0x1p-140};
    static const double offs[] = {0, 0, 0x1p-40, 0x1p-22, 0x1p-12};
    static const double errors[] = {0, 0.3, 1, 4, INFINITY};
    struct twin twin = {.possible = true, .t_err = 1e9};
    twin.t_near = pick(rng, nears, ARRAY_COUNT(nears));
    twin.t_off = pick(rng, offs, ARRAY_COUNT(offs));
    twin.u_near = pick(rng, nears, ARRAY_COUNT(nears)) * 0.125;
    twin.v_near = pick(rng, nears, ARRAY_COUNT(nears)) * 0.125;
    twin.u_err = pick(rng, errors, ARRAY_COUNT(errors));
    twin.v_err = pick(rng, errors, ARRAY_COUNT(errors));
    return twin;
}

static bool weighs(float x, double near, double err)
{
    return isinf(err) || fabsl((wide)x - (wide)near) <= (wide)err * (1 + 0x1p-20L);
}

/* The exact hit to one unit of the last place, and what its near values are off, is right though a
 * replay does not come to it; what is farther is not. */
static void what_is_exactly_right_needs_no_replay(void **state)
{
    (void)state;
    struct rng rng = rng_make(1, 54);
    struct ray ray = {{0, 0, 0}, 0, {0, 0, 1}, INFINITY};
    struct named_one one;
    size_t right = 0, distance = 0, beside = 0;
    named_open(&one, &mt, across);
    for (int i = 0; i < 60000; i++) {
        struct twin twin = wide_twin(&rng);
        wide of_u = 0x1p-20L * fminl((wide)twin.u_err, 1), of_v = 0x1p-20L;
        of_v *= fminl((wide)twin.v_err, 1);
        struct hit hit = {.prim = 0};
        bool far = rng_below(&rng, 2);
        double by = far ? (double)last_place((wide)twin.t_near) + twin.t_off : 0;
        hit.t = around(&rng, twin.t_near, by);
        by = far ? (double)(last_place((wide)twin.u_near) + of_u) : 0;
        hit.u = around(&rng, twin.u_near, by);
        by = far ? (double)(last_place((wide)twin.v_near) + of_v) : 0;
        hit.v = around(&rng, twin.v_near, by);
        if (!(hit.t >= 0))
            continue;
        bool exact = within(hit.t, twin.t_near, (wide)twin.t_off) &&
                     within(hit.u, twin.u_near, of_u) && within(hit.v, twin.v_near, of_v);
        bool weighed =
            weighs(hit.u, twin.u_near, twin.u_err) && weighs(hit.v, twin.v_near, twin.v_err);
        enum wrong wrong, expected = !exact     ? WRONG_DISTANCE
                                     : !weighed ? WRONG_BARYCENTRIC
                                                : WRONG_NOT;
        enum verdict verdict = named(&one, &ray, &twin, &hit, &wrong);
        assert_int_equal(wrong, expected);
        assert_int_equal(verdict, wrong ? VERDICT_WRONG : VERDICT_RIGHT);
        right += !wrong;
        distance += wrong == WRONG_DISTANCE;
        beside += wrong == WRONG_BARYCENTRIC;
    }
    named_close(&one);
    print_message("right %zu, distance %zu, barycentric %zu\n", right, distance, beside);
    assert_true(right > 1000 && distance > 1000 && beside > 1000);
}

/* Of no bound of t: by the exact t, and weights of a point of the triangle. */
static void the_exact_t_of_a_sliver_needs_no_replay(void **state)
{
    (void)state;
    static const double weights[] = {-0x1p-149, 0, 0.25, 0.5, 1, 1 + 0x1p-20, 1 + 0x1p-19};
    struct rng rng = rng_make(2, 54);
    struct ray ray = {{0, 0, 0}, 0, {0, 0, 7}, INFINITY};
    struct named_one one;
    struct oracle_pair pair;
    size_t taken = 0, refused = 0;
    named_open(&one, &mt, across);
    oracle_pair(one.oracle, &ray, 0, &pair);
    for (int i = 0; i < 20000; i++) {
        struct twin twin = {.possible = true, .t_err = INFINITY, .u_err = 1, .v_err = 1};
        struct hit hit = {.prim = 0, .u = (float)pick(&rng, weights, 7)};
        hit.v = (float)pick(&rng, weights, 7);
        hit.t = around(&rng, pair.t_lo, (double)last_place((wide)pair.t_lo));
        bool near = (wide)hit.t >= (wide)pair.t_lo - last_place((wide)pair.t_lo) &&
                    (wide)hit.t <= (wide)pair.t_hi + last_place((wide)pair.t_hi);
        bool inside = hit.u >= 0 && hit.v >= 0 && (wide)hit.u + (wide)hit.v <= 1 + 0x1p-20L;
        enum wrong wrong;
        enum verdict verdict = named(&one, &ray, &twin, &hit, &wrong);
        assert_int_equal(wrong, near && inside ? WRONG_NOT : WRONG_DISTANCE);
        assert_int_equal(verdict, wrong ? VERDICT_WRONG : VERDICT_BOUNDARY);
        taken += !wrong;
        refused += wrong != WRONG_NOT;
    }
    named_close(&one);
    assert_true(taken > 1000 && refused > 1000);
}

/* A bound decides alone up to a quarter, of t, u and v; else a replay does. */
static void sharp_bounds_decide_alone(void **state)
{
    (void)state;
    static const double errors[] = {0.125, 0.25, 0.25 + 0x1p-40, 0.5};
    struct rng rng = rng_make(3, 54);
    struct ray ray = {{0, 0, 0}, 0, {0, 0, 1}, INFINITY};
    struct named_one one;
    named_open(&one, &mt, across);
    for (int i = 0; i < 4000; i++) {
        double of_t = 4 * pick(&rng, errors, 4);
        double of_u = pick(&rng, errors, 4);
        double of_v = pick(&rng, errors, 4);
        struct twin twin = {.possible = true, .t_err = of_t, .u_err = of_u, .v_err = of_v};
        twin.t_near = 4;
        twin.u_near = twin.v_near = 0.25;
        struct hit hit = {4.125f, 0.25f, 0.25f, 0};
        bool sharp = of_t <= 1 && of_u <= 0.25 && of_v <= 0.25;
        enum wrong wrong;
        enum verdict verdict = named(&one, &ray, &twin, &hit, &wrong);
        assert_int_equal(verdict, sharp ? VERDICT_RIGHT : VERDICT_WRONG);
        assert_int_equal(wrong, sharp ? WRONG_NOT : WRONG_DISTANCE);
    }
    named_close(&one);
}

/* Near values are no excuse where the triangle is not hit, or not in the range. */
static void what_is_not_hit_is_not_exact(void **state)
{
    (void)state;
    static const struct ray rays[] = {{{0, 0, 0}, 0, {0, 0, 1}, 2.5f},
                                      {{9, 0, 0}, 0, {0, 0, 1}, INFINITY}};
    for (size_t i = 0; i < ARRAY_COUNT(rays); i++)
        for (int open = 0; open < 2; open++) {
            struct named_one one;
            struct twin twin = {.possible = true, .t_err = open ? INFINITY : 1e9};
            struct hit hit = {2, 0.25f, 0.25f, 0};
            enum wrong wrong;
            twin.t_near = 2;
            twin.u_near = twin.v_near = 0.25;
            twin.u_err = twin.v_err = 4;
            named_open(&one, &mt, across);
            assert_int_equal(named(&one, &rays[i], &twin, &hit, &wrong), VERDICT_WRONG);
            assert_int_equal(wrong, WRONG_TRIANGLE);
            named_close(&one);
        }
}

/* Nor is it possible, whatever the numbers, if its twin is not; nor right beyond the range. */
static void what_is_impossible_or_beyond_is_wrong(void **state)
{
    (void)state;
    struct ray ray = {{0, 0, 0}, 0, {0, 0, 1}, 3.5f};
    struct hit right = {3, 1.0f / 3, 1.0f / 3, 0}, beyond = right;
    struct twin twin = {.possible = true,
                        .t_near = 3,
                        .t_err = 1,
                        .u_near = 1.0 / 3,
                        .v_near = 1.0 / 3,
                        .u_err = 0.1,
                        .v_err = 0.1};
    struct named_one one;
    enum wrong wrong;
    named_open(&one, &mt, across);
    beyond.t = 3.75f;
    assert_int_equal(named(&one, &ray, &twin, &right, &wrong), VERDICT_RIGHT);
    assert_int_equal(named(&one, &ray, &twin, &beyond, &wrong), VERDICT_WRONG);
    assert_int_equal(wrong, WRONG_DISTANCE);
    twin.possible = false;
    assert_int_equal(named(&one, &ray, &twin, &right, &wrong), VERDICT_WRONG);
    assert_int_equal(wrong, WRONG_TRIANGLE);
    named_close(&one);
}

/* t may be off by its bound from where the exact one may be, and no more. */
static void a_bound_counts_from_both_ends_of_the_exact_t(void **state)
{
    (void)state;
    struct ray ray = {{0, 0, 0}, 0, {0, 0, 1}, INFINITY};
    const struct twin twin = {.possible = true,
                              .t_near = 4,
                              .t_err = 0.5,
                              .t_off = 0.125,
                              .u_near = 0.25,
                              .v_near = 0.25,
                              .u_err = 0.25,
                              .v_err = 0.25};
    const struct oracle_answer truth = {.prim = 0, .tie_count = 1};
    const struct judge_known known = {{0}, {twin}, 1};
    struct named_one one;
    named_open(&one, &mt, across);
    for (int step = -80; step <= 80; step++) {
        struct hit hit = {4 + (float)step / 64, 0.25f, 0.25f, 0};
        struct judgement out = {.verdict = VERDICT_RIGHT};
        int beyond = abs(step) > 8 ? abs(step) - 8 : 0;
        enum verdict found = judge_named(one.judge, &ray, &truth, &hit, &known, &out);
        assert_true(out.over == beyond / 32.0);
        assert_int_equal(found, beyond > 32 ? VERDICT_WRONG : VERDICT_RIGHT);
        assert_int_equal(out.wrong, beyond > 32 ? WRONG_DISTANCE : WRONG_NOT);
    }
    named_close(&one);
}

/* --- where t has no bound --------------------------------------------------------------------- */

/* The ray's point at t is in the triangle's box, but for 64 u of the coordinates. */
static bool is_in_box(const struct ray *ray, float v[3][3], double t, bool *near)
{
    bool in = true;
    for (int k = 0; k < 3; k++) {
        wide at = (wide)ray->org[k] + (wide)t * (wide)ray->dir[k];
        wide lo = (wide)fminf(v[0][k], fminf(v[1][k], v[2][k]));
        wide hi = (wide)fmaxf(v[0][k], fmaxf(v[1][k], v[2][k]));
        wide pad = 64 * U * (fmaxl(fabsl(lo), fabsl(hi)) + fabsl((wide)ray->org[k]));
        wide off = fmaxl(lo - at, at - hi);
        in = in && off <= pad;
        *near = *near || fabsl(off - pad) <= 1e-9L * pad;
    }
    return in;
}

/* Multiples of 2^-17: the plane x + y = z has ray and triangle exactly, and products round. */
static void draw_in_plane(struct rng *rng, float v[3][3], struct ray *ray)
{
    for (int k = 0; k < 2; k++) {
        float at = (float)rng_below(rng, 1 << 18) * 0x1p-17f;
        for (int c = 0; c < 3; c++)
            v[c][k] = at + (float)rng_below(rng, 1 << 16) * 0x1p-17f;
        ray->org[k] = (float)rng_below(rng, 1 << 18) * -0x1p-17f;
        ray->dir[k] = v[0][k] - ray->org[k];
    }
    for (int c = 0; c < 3; c++)
        v[c][2] = v[c][0] + v[c][1];
    ray->org[2] = ray->org[0] + ray->org[1];
    ray->dir[2] = ray->dir[0] + ray->dir[1];
}

/* Through the middle of a small triangle. */
static void draw_through(struct rng *rng, float v[3][3], struct ray *ray)
{
    for (int k = 0; k < 3; k++) {
        float at = rng_range(rng, -4, 4), size = 0x1p-18f * rng_range(rng, 0, 1);
        size = rng_below(rng, 3) ? size : 0;
        for (int c = 0; c < 3; c++)
            v[c][k] = at + size * rng_range(rng, -1, 1);
        ray->org[k] = rng_range(rng, -8, 8);
        ray->dir[k] = (v[0][k] + v[1][k] + v[2][k]) / 3 - ray->org[k];
    }
}

static void what_is_off_the_triangle_is_noise(void **state)
{
    (void)state;
    struct rng rng = rng_make(4, 54);
    size_t counts[VERDICT_COUNT] = {0};
    for (int i = 0; i < 8000; i++) {
        float v[3][3];
        struct named_one one;
        struct ray ray = {.tmin = 0, .tmax = INFINITY};
        struct oracle_pair pair;
        if (i % 2)
            draw_in_plane(&rng, v, &ray);
        else
            draw_through(&rng, v, &ray);
        named_open(&one, i % 2 ? &loose : &mt, v);
        judge_by_bounds(one.judge, true);
        struct twin twin = {.possible = true, .t_err = INFINITY, .u_err = 9, .v_err = 9};
        float step = rng_range(&rng, -1, 1);
        step = ldexpf(step, (i % 2 ? 0 : -14) - (int)rng_below(&rng, 6));
        struct hit hit = {1 + step, 2, 2, 0};
        bool near = false;
        bool in = is_in_box(&ray, v, (double)hit.t, &near);
        oracle_pair(one.oracle, &ray, 0, &pair);
        if (!near && ray_in_contract(&ray) && judge_can_hit(one.judge, &ray, 0)) {
            enum wrong wrong;
            bool flat = pair.class == ORACLE_IN_PLANE || pair.class == ORACLE_ZERO_AREA;
            enum verdict found = named(&one, &ray, &twin, &hit, &wrong);
            assert_int_equal(found, !in    ? VERDICT_NOISE
                                    : flat ? VERDICT_IN_PLANE
                                           : VERDICT_BOUNDARY);
            counts[found]++;
        }
        named_close(&one);
    }
    print_message("noise %zu, in plane %zu, boundary %zu\n", counts[VERDICT_NOISE],
                  counts[VERDICT_IN_PLANE], counts[VERDICT_BOUNDARY]);
    assert_true(counts[VERDICT_NOISE] > 500 && counts[VERDICT_IN_PLANE] > 100);
    assert_true(counts[VERDICT_BOUNDARY] > 500);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_exactly_right_needs_no_replay),
        cmocka_unit_test(the_exact_t_of_a_sliver_needs_no_replay),
        cmocka_unit_test(sharp_bounds_decide_alone),
        cmocka_unit_test(what_is_not_hit_is_not_exact),
        cmocka_unit_test(what_is_impossible_or_beyond_is_wrong),
        cmocka_unit_test(a_bound_counts_from_both_ends_of_the_exact_t),
        cmocka_unit_test(what_is_off_the_triangle_is_noise),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
