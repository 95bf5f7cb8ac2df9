/* Errors planted by hand come out of the measure with the size that arithmetic on paper gives. */
#include "bench/measure/error_measure.h"
#include "bench/measure/leak_rays.h"
#include "ref/trace/trace.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct measure_field {
    struct scene scene;
    struct oracle *oracle;
};

static void field_make(struct measure_field *f)
{
    struct reason reason = {""};
    if (oracle_make(&f->scene, &f->oracle, &reason))
        fail_msg("%s", reason.text);
}

static void field_free(struct measure_field *f)
{
    oracle_free(f->oracle);
    scene_free(&f->scene);
    free(f);
}

/* Right triangles of legs 1 in the planes z = 1, 1 (the same triangle) and 2, and one standing in
 * the plane y = 0.25, all times `scale`. */
static struct measure_field *stack(float scale)
{
    static const float vertex[12][3] = {
        {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0, 0, 1},         {1, 0, 1},        {0, 1, 1},
        {0, 0, 2}, {1, 0, 2}, {0, 1, 2}, {-1, 0.25f, 0.5f}, {1, 0.25f, 0.5f}, {0, 0.25f, 3}};
    struct measure_field *f = calloc(1, sizeof *f);
    assert_non_null(f);
    assert_int_equal(scene_make(12, 4, &f->scene), STATUS_OK);
    for (uint32_t i = 0; i < 12; i++) {
        f->scene.index[i] = i;
        for (uint32_t k = 0; k < 3; k++)
            f->scene.vertex[3 * i + k] = scale * vertex[i][k];
    }
    field_make(f);
    return f;
}

/* Along z through (x, y), times `scale`, with a direction of length `length`. */
static struct ray down(float x, float y, float scale, float length)
{
    return (struct ray){{scale * x, scale * y, 0}, 0, {0, 0, length}, 1e30f};
}

static struct error_one measured(const struct measure_field *f, const struct ray *ray,
                                 struct hit answer)
{
    struct oracle_answer truth;
    struct reason reason = {""};
    if (oracle_closest(f->oracle, ORACLE_BRUTE, ORACLE_CLOSED, ray, 1, 1, &truth, NULL, &reason))
        fail_msg("%s", reason.text);
    return error_measure(f->oracle, &f->scene, ray, &truth, &answer);
}

static void t_off_by_ulps_is_off_by_twice_as_many_units(void **state)
{
    (void)state;
    /* M is 1 and so is t, whose ulp is 2 u; whatever the scale and the length of the direction. */
    for (int scaling = -20; scaling <= 20; scaling += 10) {
        float scale = ldexpf(1, scaling), length = ldexpf(1, scaling / 10);
        struct measure_field *f = stack(scale);
        struct ray ray = down(0.25f, 0.125f, scale, length);
        for (int ulps = 0; ulps < 50; ulps += 7) {
            struct hit hit = {(1 + (float)ulps * 0x1p-23f) * scale / length, 0.25f, 0.125f, 0};
            struct error_one one = measured(f, &ray, hit);
            assert_int_equal(one.kind, ERROR_RIGHT);
            assert_true(fabs(one.forward - (2.0 * ulps)) <= 1e-3);
            assert_true(fabs(one.plane - (2.0 * ulps)) <= 1e-3);
            assert_true(fabs(one.point - (2.0 * ulps)) <= 1e-3);
        }
        field_free(f);
    }
}

static void wrong_barycentrics_are_a_distance(void **state)
{
    (void)state;
    struct measure_field *f = stack(1);
    struct ray ray = down(0.25f, 0.125f, 1, 1);
    struct error_one one = measured(f, &ray, (struct hit){1, 0.25f + 0x1p-20f, 0.125f, 0});
    assert_true(fabs(one.point - 16) <= 1e-3);
    assert_true(fabs(one.forward) <= 1e-3 && fabs(one.plane) <= 1e-3);
    field_free(f);
}

static void every_kind_is_told_from_the_others(void **state)
{
    (void)state;
    struct measure_field *f = stack(1);
    const struct hit miss = {0, 0, 0, ABI_NO_PRIM};
    struct ray through = down(0.25f, 0.125f, 1, 1), outside = down(5, 5, 1, 1);
    struct ray inside_plane = down(0.25f, 0.25f, 1, 1), nan = through, past = through;
    struct ray alone = inside_plane; /* its range ends before what it would hit */
    nan.dir[0] = NAN, past.tmin = 1.5f, alone.tmax = 0.875f;
    const struct {
        struct ray ray;
        struct hit answer;
        enum error_kind kind;
    } cases[] = {
        {through, {1, 0.25f, 0.125f, 0}, ERROR_RIGHT},
        {through, {1, 0.25f, 0.125f, 1}, ERROR_RIGHT}, /* the same triangle once more */
        {through, {2, 0.25f, 0.125f, 2}, ERROR_WRONG}, /* behind the nearest */
        {past, {2, 0.25f, 0.125f, 2}, ERROR_RIGHT},
        {past, {1, 0.25f, 0.125f, 0}, ERROR_WRONG}, /* before the range */
        {through, {1, 0.25f, 0.125f, 77}, ERROR_WRONG},
        {through, {NAN, 0.25f, 0.125f, 0}, ERROR_RIGHT},
        {through, miss, ERROR_LOST},
        {outside, miss, ERROR_RIGHT},
        {outside, {1, 5, 5, 0}, ERROR_PHANTOM},
        {outside, {1, 5, 5, 77}, ERROR_PHANTOM},
        {inside_plane, {0.75f, 0.5f, 0.25f, 3}, ERROR_FREE},
        {alone, {0.75f, 0.5f, 0.25f, 3}, ERROR_FREE},
        {inside_plane, {1, 0.25f, 0.25f, 1}, ERROR_RIGHT},
        {nan, {1, 0.25f, 0.125f, 0}, ERROR_REFUSED},
    };
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        struct error_one one = measured(f, &cases[i].ray, cases[i].answer);
        if (one.kind != cases[i].kind)
            fail_msg("case %zu: kind %d, not %d", i, one.kind, cases[i].kind);
    }
    struct error_one none = measured(f, &through, miss);
    assert_true(isnan(none.forward) && isnan(none.plane));
    assert_true(isinf(measured(f, &through, cases[6].answer).forward));
    assert_true(isnan(measured(f, &outside, cases[9].answer).forward)); /* no exact t */
    assert_true(fabs(measured(f, &outside, cases[9].answer).plane - (0)) <= 1e-3);
    field_free(f);
}

/* An answer with a number that is not finite has no finite error, whichever number it is. */
static void what_is_not_finite_has_no_error(void **state)
{
    (void)state;
    static const float none[] = {NAN, INFINITY, -INFINITY};
    struct measure_field *f = stack(1);
    struct ray through = down(0.25f, 0.125f, 1, 1);
    for (int slot = 0; slot < 3; slot++)
        for (size_t i = 0; i < ARRAY_COUNT(none); i++) {
            struct hit answer = {1, 0.25f, 0.125f, 0};
            *(slot == 0 ? &answer.t : slot == 1 ? &answer.u : &answer.v) = none[i];
            const struct error_one one = measured(f, &through, answer);
            if (!(isinf(one.forward) && isinf(one.plane) && isinf(one.point)))
                fail_msg("slot %d: errors %g, %g, %g", slot, one.forward, one.plane, one.point);
        }
    field_free(f);
}

#define RAYS 4000

struct played {
    struct ray ray[RAYS];
    struct oracle_answer truth[RAYS];
    struct hit answer[RAYS];
};

/* Truth and the answers of a triangle test on every triangle. */
static struct played *play(const struct measure_field *f, const char *set, const char *tri)
{
    struct played *p = calloc(1, sizeof *p);
    struct reason reason = {""};
    assert_non_null(p);
    assert_int_equal(ray_set_make(ray_set_find(set), &f->scene, 5, RAYS, p->ray, &reason),
                     STATUS_OK);
    if (oracle_closest(f->oracle, ORACLE_BRUTE, ORACLE_CLOSED, p->ray, RAYS, 0, p->truth, NULL,
                       &reason))
        fail_msg("%s", reason.text);
    for (size_t i = 0; i < RAYS; i++)
        trace_brute(&f->scene, tri_test_find(tri), QUERY_CLOSEST, &p->ray[i], &p->answer[i]);
    return p;
}

static struct error_sum sum_of(const struct measure_field *f, const struct played *p, size_t count)
{
    struct error_sum sum;
    struct reason reason = {""};
    if (error_sum_make(f->oracle, &f->scene, p->ray, p->truth, p->answer, count, &sum, &reason))
        fail_msg("%s", reason.text);
    return sum;
}

static struct measure_field *opened(const char *spec)
{
    struct measure_field *f = calloc(1, sizeof *f);
    struct reason reason = {""};
    assert_non_null(f);
    if (scene_open(spec, 1, &f->scene, &reason))
        fail_msg("%s", reason.text);
    field_make(f);
    return f;
}

static void planted_errors_are_counted(void **state)
{
    (void)state;
    struct measure_field *f = opened("soup:n=300,size=0.5");
    struct played *p = play(f, "random", "woop");
    struct error_sum before = sum_of(f, p, RAYS);
    size_t lost = 0, phantom = 0, wrong = 0;
    assert_int_equal(before.rays, RAYS);
    assert_true(before.hits > RAYS / 10 && before.hits < RAYS);
    for (size_t i = 0; i < RAYS; i += 10) {
        bool right = p->answer[i].prim == p->truth[i].prim;
        bool hit = p->answer[i].prim != ABI_NO_PRIM;
        if (!right)
            continue;
        if (hit && i % 20 == 0) {
            p->answer[i] = (struct hit){.prim = ABI_NO_PRIM};
            lost++;
        } else if (hit) {
            p->answer[i].prim = (p->answer[i].prim + 1) % f->scene.tri_count;
            wrong++;
        } else {
            p->answer[i] = (struct hit){1, 0.25f, 0.25f, 0};
            phantom++;
        }
    }
    assert_true(lost > 10 && wrong > 10 && phantom > 10);
    struct error_sum after = sum_of(f, p, RAYS);
    assert_int_equal(after.kind[ERROR_LOST], before.kind[ERROR_LOST] + lost);
    assert_int_equal(after.kind[ERROR_PHANTOM], before.kind[ERROR_PHANTOM] + phantom);
    assert_int_equal(after.kind[ERROR_WRONG], before.kind[ERROR_WRONG] + wrong);
    assert_int_equal(after.hits, before.hits - lost + phantom);
    /* A hit where there is none is far from the plane of the triangle it names. */
    assert_true(after.plane.most > 1e4 && before.plane.most < 1e3);
    free(p);
    field_free(f);
}

static void same_quantiles(struct quantiles is, double *value, size_t count)
{
    struct quantiles wanted = quantiles_of(value, count);
    assert_memory_equal(&is, &wanted, sizeof is);
}

/* Each measure's quantiles are those of all answers, each measured alone. */
static void a_sum_is_made_of_all_answers(void **state)
{
    (void)state;
    struct measure_field *f = opened("soup:n=300,size=0.5");
    struct played *p = play(f, "random", "mt");
    for (size_t i = 5; i < RAYS; i += 9) /* no ray, which engines may yet answer with a hit */
        p->ray[i].dir[i % 3] = NAN;
    assert_int_equal(oracle_closest(f->oracle, ORACLE_BRUTE, ORACLE_CLOSED, p->ray, RAYS, 0,
                                    p->truth, NULL, NULL),
                     STATUS_OK);
    for (size_t i = 0; i < RAYS; i++) { /* the three measures are apart, and each has its own */
        p->answer[i].t *= 1 + (float)(i % 90) * 0x1p-22f;
        p->answer[i].u += (float)(i % 70) * 0x1p-20f;
    }
    for (size_t count = 1; count <= RAYS; count = count * 3 + 1) {
        struct error_sum sum = sum_of(f, p, count);
        double value[3][RAYS];
        size_t hits = 0, kind[ARRAY_COUNT(sum.kind)] = {0};
        for (size_t i = 0; i < count; i++) {
            struct error_one one =
                error_measure(f->oracle, &f->scene, &p->ray[i], &p->truth[i], &p->answer[i]);
            value[0][i] = one.forward;
            value[1][i] = one.plane;
            value[2][i] = one.point;
            kind[one.kind]++;
            hits += one.kind != ERROR_REFUSED && p->answer[i].prim != ABI_NO_PRIM;
        }
        same_quantiles(sum.forward, value[0], count);
        same_quantiles(sum.plane, value[1], count);
        same_quantiles(sum.point, value[2], count);
        assert_memory_equal(sum.kind, kind, sizeof kind);
        assert_int_equal(sum.rays, count - kind[ERROR_REFUSED]);
        assert_int_equal(sum.hits, hits);
        assert_true(count < 20 || kind[ERROR_REFUSED] > 0);
    }
    free(p);
    field_free(f);
}

static void far_answers_raise_the_quantiles(void **state)
{
    (void)state;
    struct measure_field *f = opened("sphere:n=6");
    struct played *p = play(f, "random", "mt");
    struct error_sum before = sum_of(f, p, RAYS);
    assert_true(before.forward.p99 > 0.1 && before.forward.p99 < 100);
    size_t raised = 0;
    for (size_t i = 0; i < RAYS; i++)
        if (p->answer[i].prim != ABI_NO_PRIM && raised++ % 20 == 0) /* more than 1 % */
            p->answer[i].t *= 1 + 0x1p-10f;
    struct error_sum after = sum_of(f, p, RAYS);
    assert_true(after.forward.p50 < 2 * before.forward.p50 + 1);
    assert_true(after.forward.p99 > 1000);
    free(p);
    field_free(f);
}

static size_t leaks(const struct measure_field *f, const struct ray *ray, size_t count,
                    const char *tri)
{
    size_t leaked = 0;
    for (size_t i = 0; i < count; i++) {
        struct hit hit;
        trace_brute(&f->scene, tri_test_find(tri), QUERY_CLOSEST, &ray[i], &hit);
        leaked += hit.prim == ABI_NO_PRIM;
    }
    return leaked;
}

static void rays_from_inside_all_hit_and_only_watertight_tests_see_it(void **state)
{
    (void)state;
    static const char *const specs[] = {"sphere:n=6", "flake:depth=1", "platonic"};
    for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
        struct measure_field *f = opened(specs[s]);
        struct played *p = calloc(1, sizeof *p);
        assert_non_null(p);
        for (int target = LEAK_EDGE; target <= LEAK_VERTEX; target++) {
            struct reason reason = {""};
            if (leak_rays_make(f->oracle, &f->scene, (enum leak_target)target, 3, RAYS, p->ray,
                               &reason))
                fail_msg("%s: %s", specs[s], reason.text);
            assert_int_equal(oracle_closest(f->oracle, ORACLE_BRUTE, ORACLE_CLOSED, p->ray, RAYS, 0,
                                            p->truth, NULL, &reason),
                             STATUS_OK);
            for (size_t i = 0; i < RAYS; i++)
                assert_int_not_equal(p->truth[i].prim, ABI_NO_PRIM);
            assert_int_equal(leaks(f, p->ray, RAYS, "woop"), 0);
            if (s == 0)
                assert_true(leaks(f, p->ray, RAYS, "mt") > RAYS / 100);
        }
        free(p);
        field_free(f);
    }
}

static void an_open_mesh_has_no_inside(void **state)
{
    (void)state;
    struct measure_field *f = opened("sphere:n=6");
    struct ray ray[8];
    struct reason reason = {""};
    f->scene.tri_count--;
    assert_int_equal(leak_rays_make(f->oracle, &f->scene, LEAK_EDGE, 1, 8, ray, &reason),
                     STATUS_INPUT);
    assert_non_null(strstr(reason.text, "edge"));
    f->scene.tri_count++;
    assert_int_equal(leak_rays_make(f->oracle, &f->scene, LEAK_EDGE, 1, 8, ray, &reason),
                     STATUS_OK);
    field_free(f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(t_off_by_ulps_is_off_by_twice_as_many_units),
        cmocka_unit_test(wrong_barycentrics_are_a_distance),
        cmocka_unit_test(every_kind_is_told_from_the_others),
        cmocka_unit_test(what_is_not_finite_has_no_error),
        cmocka_unit_test(planted_errors_are_counted),
        cmocka_unit_test(a_sum_is_made_of_all_answers),
        cmocka_unit_test(far_answers_raise_the_quantiles),
        cmocka_unit_test(rays_from_inside_all_hit_and_only_watertight_tests_see_it),
        cmocka_unit_test(an_open_mesh_has_no_inside),
    };
    return cmocka_run_group_tests_name("error_measure", tests, NULL, NULL) ? 1 : 0;
}
