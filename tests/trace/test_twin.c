/* The running-error twins against the same formulas in extended precision. */
#include "ref/base/base.h"
#include "ref/base/rng.h"
#include "ref/twin/twin.h"
#include "ref/primitives/test_run.h"

#include <math.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define PAIRS 60000

static const enum twin_formula formulas[] = {
    TWIN_MT,     TWIN_MT_RTRS,       TWIN_WOOP,     TWIN_PLUECKER, TWIN_BALDWIN_WEBBER,
    TWIN_EMBREE, TWIN_EMBREE_ROBUST, TWIN_TRI_ACCEL};

/* Exact to far below float32: edge products, determinant and t of Moeller-Trumbore in long double,
 * whose inputs are floats, so that the differences are exact. */
struct twin_truth {
    long double edge[3], det, t;
};

static void cross_l(const long double a[3], const long double b[3], long double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static long double dot_l(const long double a[3], const long double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static struct twin_truth truth_of(const struct ray *ray, float v[3][3])
{
    long double a[3][3], d[3], n[3];
    struct twin_truth out;
    for (int i = 0; i < 3; i++) {
        d[i] = ray->dir[i];
        for (int c = 0; c < 3; c++)
            a[c][i] = (long double)v[c][i] - (long double)ray->org[i];
    }
    out.det = 0;
    for (int c = 0; c < 3; c++) { /* w_c = [d, next, next but one] */
        cross_l(a[(c + 1) % 3], a[(c + 2) % 3], n);
        out.edge[c] = dot_l(d, n);
        out.det += out.edge[c];
    }
    cross_l(a[1], a[2], n);
    out.t = dot_l(a[0], n) / out.det;
    return out;
}

/* Triangles and rays of mixed scales; a third aimed at a vertex or an edge. */
static void random_pair(struct rng *rng, int kind, struct ray *ray, float v[3][3])
{
    float offset = kind == 1 ? 100.0f : 0.0f, size = kind == 2 ? 1e-3f : 1.0f;
    float target[3] = {0, 0, 0};
    float w0 = rng_float(rng), w1 = (1.0f - w0) * rng_float(rng);
    float weight[3] = {w0, w1, 1.0f - w0 - w1};
    if (rng_below(rng, 3) == 0)
        weight[rng_below(rng, 3)] = 0.0f;
    for (int i = 0; i < 3; i++) {
        float base = offset + rng_range(rng, -1, 1);
        for (int c = 0; c < 3; c++) {
            v[c][i] = base + size * rng_range(rng, -1, 1);
            target[i] += weight[c] * v[c][i];
        }
        ray->org[i] = offset + rng_range(rng, -3, 3);
    }
    for (int i = 0; i < 3; i++)
        ray->dir[i] = target[i] - ray->org[i];
    ray->tmin = 0;
    ray->tmax = 1e30f;
}

static void twin_bounds_the_distance(void **state)
{
    (void)state;
    double largest[ARRAY_COUNT(formulas)] = {0};
    size_t checked = 0;
    struct rng rng = rng_make(3, 0);
    for (int n = 0; n < PAIRS; n++) {
        struct ray ray;
        float v[3][3];
        random_pair(&rng, n % 3, &ray, v);
        struct twin_truth truth = truth_of(&ray, v);
        for (size_t f = 0; f < ARRAY_COUNT(formulas); f++) {
            struct twin twin = twin_eval(formulas[f], ROUNDING_IEEE, &ray, v);
            if (!isfinite(twin.t_err))
                continue;
            double off = fabs((double)((long double)twin.t - truth.t));
            if (off > 0)
                largest[f] = fmax(largest[f], off / twin.t_err);
            assert_true(off <= twin.t_err);
            checked++;
        }
    }
    assert_true(checked > PAIRS);
    /* A bound that is never nearly reached would be too wide to judge with. */
    for (size_t f = 0; f < ARRAY_COUNT(formulas); f++)
        assert_true(largest[f] > 0.01 && largest[f] <= 1.0);
}

static void twin_is_certain_only_of_true_hits(void **state)
{
    (void)state;
    size_t certain = 0, open = 0;
    struct rng rng = rng_make(4, 0);
    for (int n = 0; n < PAIRS; n++) {
        struct ray ray;
        float v[3][3];
        random_pair(&rng, n % 3, &ray, v);
        struct twin_truth truth = truth_of(&ray, v);
        bool positive = true, negative = true;
        for (int c = 0; c < 3; c++) {
            positive = positive && truth.edge[c] > 0;
            negative = negative && truth.edge[c] < 0;
        }
        bool hit = (positive || negative) && truth.t > 0;
        for (size_t f = 0; f < ARRAY_COUNT(formulas); f++) {
            struct twin twin = twin_eval(formulas[f], ROUNDING_EMBREE, &ray, v);
            if (twin.certain)
                assert_true(hit);
            if (hit && (formulas[f] != TWIN_MT_RTRS || twin.det != 0))
                assert_true(twin.possible);
            certain += twin.certain;
            open += twin.possible && !twin.certain;
        }
    }
    assert_true(certain > PAIRS);
    assert_true(open > 100); /* aimed at edges: some must stay open */
}

static void twin_computes_what_the_test_computes(void **state)
{
    (void)state;
    struct rng rng = rng_make(5, 0);
    size_t hits = 0;
    for (int n = 0; n < PAIRS; n++) {
        struct ray ray;
        float v[3][3];
        random_pair(&rng, n % 3, &ray, v);
        struct tri_ray r = tri_ray_make(&ray);
        for (uint32_t id = ABI_TRI_MT_RTRS; id <= ABI_TRI_BALDWIN_WEBBER; id++) {
            struct hit hit;
            struct twin twin = twin_eval(twin_of_tri(id), ROUNDING_IEEE, &ray, v);
            if (!tri_test_run(id, &r, v, &hit)) {
                assert_false(twin.certain);
                continue;
            }
            hits++;
            assert_int_equal(float_bits(twin.t), float_bits(hit.t));
            assert_true(twin.possible);
        }
    }
    assert_true(hits > PAIRS / 2);
}

static void twin_leaves_an_edge_open(void **state)
{
    (void)state;
    float v[3][3] = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    struct ray ray = {{0.5f, 0, 0}, 0, {0, 0, 1}, 10}; /* on the edge v0 v1 */
    for (size_t f = 0; f < ARRAY_COUNT(formulas); f++) {
        struct twin twin = twin_eval(formulas[f], ROUNDING_IEEE, &ray, v);
        assert_true(twin.possible);
        assert_false(twin.certain);
    }
}

static void twin_leaves_the_range_ends_open(void **state)
{
    (void)state;
    float v[3][3] = {{-1, -1, 1}, {1, -1, 1}, {0, 1, 1}};
    struct ray ray = {{0, 0, 0}, 1, {0, 0, 1}, 10}; /* t == tmin */
    assert_false(twin_eval(TWIN_MT, ROUNDING_IEEE, &ray, v).certain);
    assert_true(twin_eval(TWIN_MT, ROUNDING_IEEE, &ray, v).possible);
    ray.tmin = 0.5f;
    assert_true(twin_eval(TWIN_MT, ROUNDING_IEEE, &ray, v).certain);
    ray.tmin = 1.5f;
    assert_false(twin_eval(TWIN_MT, ROUNDING_IEEE, &ray, v).possible);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(twin_bounds_the_distance),
        cmocka_unit_test(twin_is_certain_only_of_true_hits),
        cmocka_unit_test(twin_computes_what_the_test_computes),
        cmocka_unit_test(twin_leaves_an_edge_open),
        cmocka_unit_test(twin_leaves_the_range_ends_open),
    };
    return cmocka_run_group_tests_name("twin", tests, NULL, NULL) ? 1 : 0;
}
