/* What the oracle refuses, relies on and promises beside the arithmetic. */
#include "ref/base/float_mode.h"
#include "ref/oracle/internal.h"
#include "ref/oracle/oracle_world.h"
#include "tests/exact/exact_gmp.h"
#include "tests/exact/oracle_batch.h"

#include <fenv.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

/* One triangle, (0,0,1) (1,0,1) (0,1,1), and its oracle. */
struct rules_one {
    struct scene scene;
    struct oracle *oracle;
};

static void one_make(struct rules_one *one)
{
    static const float v[9] = {0, 0, 1, 1, 0, 1, 0, 1, 1};
    struct reason reason = {""};
    assert_int_equal(scene_make(3, 1, &one->scene), STATUS_OK);
    memcpy(one->scene.vertex, v, sizeof v);
    for (uint32_t c = 0; c < 3; c++)
        one->scene.index[c] = c;
    assert_int_equal(oracle_make(&one->scene, &one->oracle, &reason), STATUS_OK);
}

static void one_free(struct rules_one *one)
{
    oracle_free(one->oracle);
    scene_free(&one->scene);
}

static struct oracle_answer ask(const struct rules_one *one, enum oracle_ends ends, struct ray ray)
{
    struct oracle_answer answer;
    struct reason reason = {""};
    assert_int_equal(
        oracle_closest(one->oracle, ORACLE_AUTO, ends, &ray, 1, 1, &answer, NULL, &reason),
        STATUS_OK);
    return answer;
}

static const struct ray straight = {{0.25f, 0.25f, 0}, 0, {0, 0, 1}, 2};

static void signs_are_those_of_the_definition(void **state)
{
    (void)state;
    struct rules_one one;
    one_make(&one);
    struct oracle_pair pair;
    oracle_pair(one.oracle, &straight, 0, &pair);
    assert_int_equal(pair.class, ORACLE_INSIDE);
    assert_int_equal(pair.det, 1); /* d . N, N = (v1 - v0) x (v2 - v0) = +z */
    assert_int_equal(pair.edge[0] + pair.edge[1] + pair.edge[2], 3);
    assert_true(pair.t_lo <= 1 && 1 <= pair.t_hi);
    assert_true(fabs(pair.margin - 0.25) < 1e-12);
    struct ray back = {{0.25f, 0.25f, 2}, 0, {0, 0, -1}, 2};
    oracle_pair(one.oracle, &back, 0, &pair);
    assert_int_equal(pair.det, -1);
    assert_int_equal(pair.edge[0], -1);
    struct ray on_edge = {{0.5f, 0, 0}, 0, {0, 0, 1}, 2}; /* v0 v1: opposite vertex 2 */
    oracle_pair(one.oracle, &on_edge, 0, &pair);
    assert_int_equal(pair.class, ORACLE_EDGE);
    assert_int_equal(pair.edge[2], 0);
    assert_true(pair.margin == 0 && pair.t_lo == 1 && pair.t_hi == 1);
    struct ray beside = {{-1, 0.25f, 0}, 0, {0, 0, 1}, 2};
    oracle_pair(one.oracle, &beside, 0, &pair);
    assert_int_equal(pair.class, ORACLE_MISS);
    assert_true(fabs(pair.margin + 1) < 1e-12);
    one_free(&one);
}

static void ends_are_open_or_closed(void **state)
{
    (void)state;
    struct rules_one one;
    one_make(&one);
    static const struct {
        float tmin, tmax;
        enum oracle_range range;
        bool closed, open;
    } cases[] = {
        {0, 1, ORACLE_AT_TMAX, true, false},   {1, 2, ORACLE_AT_TMIN, true, false},
        {1, 1, ORACLE_AT_TMIN, true, false},   {0, 2, ORACLE_WITHIN, true, true},
        {0, 0.5f, ORACLE_ABOVE, false, false}, {1.5f, 2, ORACLE_BELOW, false, false},
        {-2, -1, ORACLE_ABOVE, false, false},  {-1, INFINITY, ORACLE_WITHIN, true, true},
    };
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        struct ray ray = straight;
        struct oracle_pair pair;
        ray.tmin = cases[i].tmin;
        ray.tmax = cases[i].tmax;
        oracle_pair(one.oracle, &ray, 0, &pair);
        assert_int_equal(pair.range, cases[i].range);
        assert_int_equal(ask(&one, ORACLE_CLOSED, ray).prim == 0, cases[i].closed);
        assert_int_equal(ask(&one, ORACLE_OPEN, ray).prim == 0, cases[i].open);
    }
    struct ray ray = straight;
    ray.tmax = nextafterf(1, 0);
    assert_int_equal(ask(&one, ORACLE_CLOSED, ray).prim, ABI_NO_PRIM);
    ray.tmax = nextafterf(1, 2);
    assert_int_equal(ask(&one, ORACLE_OPEN, ray).prim, 0);
    ray.tmin = nextafterf(1, 0);
    assert_int_equal(ask(&one, ORACLE_OPEN, ray).prim, 0);
    one_free(&one);
}

static void rays_that_are_no_rays_miss(void **state)
{
    (void)state;
    struct rules_one one;
    one_make(&one);
    float bad[] = {NAN, INFINITY, -INFINITY};
    for (size_t b = 0; b < ARRAY_COUNT(bad); b++)
        for (int at = 0; at < 8; at++) {
            struct ray ray = straight;
            float *const word[8] = {&ray.org[0], &ray.org[1], &ray.org[2], &ray.tmin,
                                    &ray.dir[0], &ray.dir[1], &ray.dir[2], &ray.tmax};
            *word[at] = bad[b];
            bool fine = at == 7 && bad[b] == INFINITY;
            struct oracle_answer got = ask(&one, ORACLE_CLOSED, ray);
            assert_int_equal(got.prim, fine ? 0 : ABI_NO_PRIM);
            assert_int_equal(got.flags & ORACLE_REFUSED, fine ? 0 : ORACLE_REFUSED);
        }
    struct ray ray = straight;
    ray.tmin = 2;
    ray.tmax = 1;
    assert_int_equal(ask(&one, ORACLE_CLOSED, ray).flags, ORACLE_REFUSED);
    ray = straight;
    ray.dir[2] = 0; /* misses, even where it starts on the triangle */
    assert_int_equal(ask(&one, ORACLE_CLOSED, ray).flags, 0);
    ray.org[2] = 1;
    assert_int_equal(ask(&one, ORACLE_CLOSED, ray).prim, ABI_NO_PRIM);
    struct oracle_pair pair;
    oracle_pair(one.oracle, &ray, 0, &pair);
    assert_int_equal(pair.class, ORACLE_MISS);
    one_free(&one);
}

/* Embree sets FTZ and DAZ while it builds; a caller may have set a rounding mode. */
static void the_environment_is_checked_and_made_right(void **state)
{
    (void)state;
    static const unsigned long modes[] = {
        FLOAT_FLUSH,
        FLOAT_DOWN,
        FLOAT_UP,
        FLOAT_DOWN | FLOAT_UP,
#if defined(__SSE2__)
        0x8000,
        0x0040, /* FTZ and DAZ one by one */
#endif
        FLOAT_FLUSH | FLOAT_UP
    };
    const struct oracle_case *denormal = &oracle_cases[13];
    struct oracle_batch batch;
    struct oracle_answer want[BATCH], got[BATCH];
    struct reason reason = {""};
    assert_string_equal(denormal->name, "denormal");
    assert_int_equal(oracle_environment(&reason), STATUS_OK);
    size_t hits = 0;
    for (uint64_t b = 0; b < 20; b++) {
        batch_make(denormal, b, &batch);
        assert_int_equal(oracle_closest(batch.oracle, ORACLE_TREE, ORACLE_CLOSED, batch.ray, BATCH,
                                        1, want, NULL, &reason),
                         STATUS_OK);
        for (size_t m = 0; m < ARRAY_COUNT(modes); m++) {
            unsigned long saved = float_mode(),
                          set = (saved & ~(unsigned long)FLOAT_MODES) | modes[m];
            float_mode_set(set);
            enum status environment = oracle_environment(&reason);
            struct oracle *none;
            enum status made = oracle_make(oracle_scene(batch.oracle), &none, &reason);
            struct oracle *no_world;
            const struct world empty = {0};
            enum status world = oracle_make_world(&empty, &no_world, &reason);
            enum status closest = oracle_closest(batch.oracle, ORACLE_TREE, ORACLE_CLOSED,
                                                 batch.ray, BATCH, 1, got, NULL, &reason);
            unsigned long after = float_mode();
            float_mode_set(saved);
            assert_int_equal(environment, STATUS_UNSUPPORTED);
            assert_int_equal(made, STATUS_UNSUPPORTED);
            assert_int_equal(world, STATUS_UNSUPPORTED);
            assert_null(none);
            assert_null(no_world);
            assert_int_equal(closest, STATUS_OK);
            assert_int_equal(after & FLOAT_MODES, set & FLOAT_MODES);
            for (int i = 0; i < BATCH; i++) {
                assert_int_equal(got[i].prim, want[i].prim);
                assert_true(got[i].t_lo == want[i].t_lo && got[i].t_hi == want[i].t_hi);
                hits += want[i].prim != ABI_NO_PRIM;
            }
        }
        batch_free(&batch);
    }
    assert_true(hits > 100);
}

/* Every kernel gives the same bits, and what it drops is a miss. */
static void kernels_drop_misses_only(void **state)
{
    (void)state;
    size_t dropped = 0, kept = 0;
    for (int k = 0; k < ORACLE_CASES; k++)
        for (uint64_t b = 0; b < 40; b++) {
            struct oracle_batch batch;
            batch_make(&oracle_cases[k], 9000 + b, &batch);
            const struct oracle *oracle = batch.oracle;
            for (int i = 0; i < BATCH; i++) {
                const struct ray *ray = &batch.ray[i];
                if (ray->dir[0] == 0 && ray->dir[1] == 0 && ray->dir[2] == 0)
                    continue;
                struct early_ray early = early_ray_make(ray);
                double largest = 0;
                for (uint32_t n = 0; n < 9 * BATCH; n++)
                    largest = fmax(largest,
                                   fabs((double)batch.scene.vertex[n] - (double)ray->org[n % 3]));
                uint32_t first = (uint32_t)i % 5, count = BATCH - first;
                uint64_t plain =
                    early_kernels[0].look(&oracle->soup, &early, first, count, largest);
                for (const struct early_kernel *kernel = early_kernels; kernel->name; kernel++)
                    if (kernel->runs())
                        assert_true(kernel->look(&oracle->soup, &early, first, count, largest) ==
                                    plain);
                for (uint32_t n = 0; n < count; n++) {
                    struct oracle_pair pair;
                    oracle_pair(oracle, ray, oracle->tree.order[first + n], &pair);
                    bool missed = pair.class == ORACLE_MISS || pair.class == ORACLE_ZERO_AREA;
                    assert_true(missed || plain >> n & 1);
                    dropped += !(plain >> n & 1);
                    kept += plain >> n & 1;
                }
            }
            batch_free(&batch);
        }
    assert_true(dropped > 10000 && kept > 10000);
    assert_non_null(early_best());
}

/* All that a ray meets, against GMP: the same triangles, in order. */
static void crossings_are_complete_and_sorted(void **state)
{
    (void)state;
    struct oracle_crossing *list = NULL;
    size_t capacity = 0, met = 0, planes = 0;
    for (int k = 0; k < ORACLE_CASES; k++)
        for (uint64_t b = 0; b < 20; b++) {
            struct oracle_batch batch;
            struct gmp_pair pair[BATCH];
            batch_make(&oracle_cases[k], 7000 + b, &batch);
            for (int p = 0; p < BATCH; p++)
                exact_gmp_init(&pair[p]);
            for (int i = 0; i < BATCH; i++) {
                size_t count, want = 0;
                struct reason reason = {""};
                double most = i % 3 == 0 ? 1 : i % 3 == 1 ? 0x1p-10 : INFINITY;
                assert_int_equal(oracle_crossings(batch.oracle, &batch.ray[i], most, &list,
                                                  &capacity, &count, &reason),
                                 STATUS_OK);
                bool seen[BATCH] = {false};
                for (size_t n = 0; n < count; n++)
                    seen[list[n].prim] = true;
                for (uint32_t p = 0; p < BATCH; p++) {
                    float v[3][3];
                    struct oracle_pair single;
                    scene_tri(&batch.scene, p, v);
                    exact_gmp_pair(&batch.ray[i], v, &pair[p]);
                    oracle_pair(batch.oracle, &batch.ray[i], p, &single);
                    bool plane = pair[p].class == ORACLE_IN_PLANE;
                    bool in = exact_gmp_hits(&pair[p], ORACLE_CLOSED) ||
                              (plane && pair[p].range == ORACLE_WITHIN);
                    in = in && single.t_lo <= most;
                    assert_int_equal(seen[p], in);
                    want += in;
                    planes += in && plane;
                }
                assert_int_equal(count, want);
                met += count;
                for (size_t n = 1; n < count; n++) {
                    const struct oracle_crossing *a = &list[n - 1], *c = &list[n];
                    bool a_plane = a->pair.class == ORACLE_IN_PLANE;
                    bool c_plane = c->pair.class == ORACLE_IN_PLANE;
                    int sign = a_plane && c_plane
                                   ? (a->pair.t_lo > c->pair.t_lo) - (a->pair.t_lo < c->pair.t_lo)
                               : a_plane ? -exact_gmp_compare(pair[c->prim].t, a->pair.t_lo)
                               : c_plane ? exact_gmp_compare(pair[a->prim].t, c->pair.t_lo)
                                         : mpq_cmp(pair[a->prim].t, pair[c->prim].t);
                    assert_true(sign < 0 || (sign == 0 && a->prim < c->prim));
                }
            }
            for (int p = 0; p < BATCH; p++)
                exact_gmp_clear(&pair[p]);
            batch_free(&batch);
        }
    free(list);
    printf("%zu met, %zu in plane\n", met, planes);
    assert_true(met > 3000 && planes > 50);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(signs_are_those_of_the_definition),
        cmocka_unit_test(ends_are_open_or_closed),
        cmocka_unit_test(rays_that_are_no_rays_miss),
        cmocka_unit_test(the_environment_is_checked_and_made_right),
        cmocka_unit_test(kernels_drop_misses_only),
        cmocka_unit_test(crossings_are_complete_and_sorted),
    };
    return cmocka_run_group_tests_name("oracle_rules", tests, NULL, NULL) ? 1 : 0;
}
