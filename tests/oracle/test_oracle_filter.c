/* When double suffices (ref/oracle/filter.h): the bound of a product is nine units of the product
 * of magnitudes, and a pair is decided by the filter exactly when that leaves no sign open, a hit
 * when its margin is known to 2^-20 of itself as well; decided again by long doubles and at the
 * limit itself. */
#include "ref/base/rng.h"
#include "ref/oracle/filter.h"
#include "tests/exact/oracle_batch.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define UNITS 0x9p-53L /* of the magnitudes */
#define KNOWN 0x1p-20L
#define NEAR  1e-12L /* what the magnitudes themselves may be off by */

struct sized {
    long double value, size;
};

/* x . (y cross z), and the same of magnitudes. */
static struct sized triple(const long double x[3], const long double y[3], const long double z[3])
{
    struct sized out = {0, 0};
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        out.value += x[k] * (y[i] * z[j] - y[j] * z[i]);
        out.size += fabsl(x[k]) * (fabsl(y[i] * z[j]) + fabsl(y[j] * z[i]));
    }
    return out;
}

/* w0, w1, w2, D and T. */
static void products(const struct ray *ray, float v[3][3], struct sized out[5])
{
    long double a[3][3], e[3][3], d[3];
    for (int k = 0; k < 3; k++) {
        d[k] = (long double)ray->dir[k];
        for (int c = 0; c < 3; c++) {
            a[c][k] = (long double)v[c][k] - (long double)ray->org[k];
            e[c][k] = (long double)v[(c + 2) % 3][k] - (long double)v[(c + 1) % 3][k];
        }
    }
    for (int c = 0; c < 3; c++)
        out[c] = triple(d, a[(c + 1) % 3], e[c]);
    out[3] = triple(d, e[0], e[1]);
    out[4] = triple(a[0], e[0], e[1]);
}

static bool is_near(double got, long double want)
{
    return fabsl((long double)got - want) <= NEAR * fabsl(want);
}

static void the_bound_is_nine_units_of_the_magnitudes(void **state)
{
    (void)state;
    struct rng rng = rng_make(81, 0);
    for (int kind = 0; kind < ORACLE_CASES; kind++)
        for (uint64_t n = 0; n < 1000; n++) {
            struct ray ray;
            struct filter f;
            struct sized want[5];
            float v[3][3];
            oracle_cases[kind].make(&rng, n, &ray, v);
            filter_edges(&ray, v, &f);
            filter_plane(&f);
            products(&ray, v, want);
            for (int c = 0; c < 3; c++)
                assert_true(is_near(f.w_err[c], UNITS * want[c].size));
            assert_true(is_near(f.det_err, UNITS * want[3].size));
            assert_true(is_near(f.t_err, UNITS * want[4].size));
        }
}

/* A triangle has an area for certain if a component of its normal is more than six units of its
 * magnitude, and only then. */
static void expect_area(float v[3][3], size_t *with, size_t *without)
{
    bool has = false, open = false;
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        long double e1[3], e2[3];
        for (int n = 0; n < 3; n++) {
            e1[n] = (long double)v[1][n] - (long double)v[0][n];
            e2[n] = (long double)v[2][n] - (long double)v[0][n];
        }
        long double left = e1[i] * e2[j], right = e1[j] * e2[i];
        long double share = fabsl(left - right), size = fabsl(left) + fabsl(right);
        has = has || share > 0xep-53L * size;
        open = open || share > 0x1p-60L * size;
    }
    if (has || !open)
        assert_int_equal(filter_has_area(v), has);
    *with += has;
    *without += !open;
}

/* In all planes, those across an axis and along one among them, on lines as well. */
static void areas_are_seen_on_every_axis(void **state)
{
    (void)state;
    struct rng rng = rng_make(83, 0);
    size_t with = 0, without = 0;
    for (uint32_t n = 0; n < 20000; n++) {
        float v[3][3], step[3], turn[3];
        for (int k = 0; k < 3; k++) {
            step[k] = rng_below(&rng, 3) ? (float)rng_below(&rng, 2000) - 1000 : 0;
            turn[k] = rng_below(&rng, 3) ? (float)rng_below(&rng, 2000) - 1000 : 0;
        }
        const float times = n % 2 ? 1.0f : 0.0f, along = (float)rng_below(&rng, 9) - 4;
        for (int k = 0; k < 3; k++) {
            v[0][k] = (float)rng_below(&rng, 2000) - 1000;
            v[1][k] = v[0][k] + step[k];
            v[2][k] = v[0][k] + along * step[k] + times * turn[k];
        }
        expect_area(v, &with, &without);
    }
    assert_true(with > 5000 && without > 5000);
}

/* Whether a sign is certain: 1, 0, or -1 next to the limit. */
static int certain(const struct sized *x, long double known)
{
    long double share = fabsl(x->value) * known - UNITS * x->size;
    return fabsl(share) <= 0x1p-50L * x->size + NEAR * UNITS * x->size ? -1 : share > 0;
}

/* The least of several, where -1 is unsure and 0 is no. */
static int both(int a, int b)
{
    return a == 0 || b == 0 ? 0 : a < 0 || b < 0 ? -1 : 1;
}

/* Whether the filter should suffice for a pair of all depths: 1, 0, or -1 next to a limit. */
static int suffices(const struct ray *ray, float v[3][3])
{
    struct sized x[5];
    products(ray, v, x);
    int sure = certain(&x[3], 1);
    bool inside = true;
    for (int c = 0; c < 3; c++) {
        sure = both(sure, certain(&x[c], 1));
        inside = inside && (x[c].value > 0) == (x[3].value > 0);
    }
    if (sure != 1 || !inside)
        return sure;
    for (int c = 0; c < 4; c++)
        sure = both(sure, certain(&x[c], KNOWN));
    sure = both(sure, certain(&x[4], 1));
    if (sure != 1)
        return sure;
    long double t = x[4].value / x[3].value;
    long double off = UNITS * (x[4].size / fabsl(x[4].value) + x[3].size / fabsl(x[3].value));
    long double ends[] = {(long double)ray->tmin, (long double)ray->tmax};
    for (int n = 0; n < 2; n++)
        if (fabsl(ends[n] - t) <= 2 * off * fabsl(t))
            return -1;
    if (t < ends[0] || t > ends[1])
        return 1;
    return fabsl(2 * off - 0x1p-40L) <= 0x1p-45L ? -1 : 2 * off < 0x1p-40L;
}

struct sufficient {
    size_t did, did_not, unsure;
};

/* Of a hit that the filter decides: t lies between the quotients of the ends of T and D, the
 * larger widened and the smaller lessened by 2^-50 of itself, to within their roundings. */
static void expect_enclosure(const struct ray *ray, float v[3][3], const struct oracle_pair *pair)
{
    struct filter f;
    filter_edges(ray, v, &f);
    filter_plane(&f);
    const long double t = fabsl((long double)f.t), d = fabsl((long double)f.det);
    long double most = (t + f.t_err) / (d - f.det_err) * (1 + 0x1p-50L);
    long double least = (t - f.t_err) / (d + f.det_err) * (1 - 0x1p-50L);
    const bool positive = (f.t > 0) == (f.det > 0);
    const long double hi = positive ? most : -least, lo = positive ? least : -most;
    assert_true(fabsl((long double)pair->t_hi - hi) <= 0x5p-53L * fabsl(hi));
    assert_true(fabsl((long double)pair->t_lo - lo) <= 0x5p-53L * fabsl(lo));
}

static void expect(const struct oracle *oracle, const struct ray *ray, uint32_t prim,
                   struct sufficient *tally)
{
    struct oracle_pair pair;
    float v[3][3];
    scene_tri(oracle_scene(oracle), prim, v);
    oracle_pair(oracle, ray, prim, &pair);
    int want = suffices(ray, v);
    if (pair.by_filter && oracle_is_hit(&pair))
        expect_enclosure(ray, v, &pair);
    if (want >= 0 && pair.class != ORACLE_ZERO_AREA && pair.by_filter != (want > 0))
        fail_msg("o=(%a,%a,%a) d=(%a,%a,%a): by %s", (double)ray->org[0], (double)ray->org[1],
                 (double)ray->org[2], (double)ray->dir[0], (double)ray->dir[1], (double)ray->dir[2],
                 pair.by_filter ? "the filter" : "integers");
    tally->did += want > 0;
    tally->did_not += want == 0;
    tally->unsure += want < 0;
}

static void what_it_can_decide_it_decides(void **state)
{
    (void)state;
    struct sufficient tally = {0};
    for (int kind = 0; kind < ORACLE_CASES; kind++)
        for (uint64_t b = 0; b < 40; b++) {
            struct oracle_batch batch;
            batch_make(&oracle_cases[kind], 9000 + b, &batch);
            for (uint32_t i = 0; i < BATCH; i++)
                for (uint32_t prim = 0; prim < BATCH; prim++)
                    expect(batch.oracle, &batch.ray[i], prim, &tally);
            batch_free(&batch);
        }
    printf("by the filter %zu, not %zu, unsure %zu\n", tally.did, tally.did_not, tally.unsure);
    assert_true(tally.did > 10000 && tally.did_not > 1000);
    assert_true(tally.unsure < tally.did_not);
}

/* A triangle across the z axis, of whose w one is the determinant of two neighbours of Farey's: 1
 * or -1, against magnitudes of up to 2^50. */
static void put_farey(struct rng *rng, float *vertex)
{
    int bits = 20 + (int)rng_below(rng, 5);
    int64_t x, y, old[2], now[2], a, b;
    do {
        old[0] = now[1] = 1;
        old[1] = now[0] = 0;
        a = x = (int64_t)(rng_u64(rng) >> (64 - bits)) | 1;
        b = y = (int64_t)(rng_u64(rng) >> (64 - bits)) | 1;
        while (b) { /* Euclid: old[0] x + old[1] y is a */
            int64_t times = a / b, rest = a % b;
            for (int k = 0; k < 2; k++) {
                int64_t next = old[k] - times * now[k];
                old[k] = now[k];
                now[k] = next;
            }
            a = b;
            b = rest;
        }
    } while (a != 1);
    /* (x, y) and (-old[1], old[0]) span an area of 1. */
    const int64_t by = rng_below(rng, 2) ? 1 : -1;
    const float flat[6] = {
        (float)x,        (float)y,        (float)(-old[1] - (rng_below(rng, 2) ? x : 0)),
        (float)(old[0]), (float)(by * y), (float)(-by * x)};
    for (int c = 0; c < 3; c++) {
        vertex[3 * c] = flat[2 * c];
        vertex[3 * c + 1] = flat[2 * c + 1];
        vertex[3 * c + 2] = (float)(c + 1);
    }
}

static void the_limit_is_where_the_bound_is(void **state)
{
    (void)state;
    enum { TRIS = 4000 };
    struct rng rng = rng_make(82, 0);
    struct scene scene;
    struct oracle *oracle = NULL;
    struct reason reason = {""};
    struct sufficient tally = {0};
    const struct ray ray = {{0, 0, 0}, 0, {0, 0, 1}, INFINITY};
    assert_int_equal(scene_make(3 * TRIS, TRIS, &scene), STATUS_OK);
    for (uint32_t i = 0; i < 3 * TRIS; i++)
        scene.index[i] = i;
    for (uint32_t i = 0; i < TRIS; i++)
        put_farey(&rng, scene.vertex + 9 * (size_t)i);
    assert_int_equal(oracle_make(&scene, &oracle, &reason), STATUS_OK);
    for (uint32_t i = 0; i < TRIS; i++)
        expect(oracle, &ray, i, &tally);
    printf("by the filter %zu, not %zu, unsure %zu\n", tally.did, tally.did_not, tally.unsure);
    assert_true(tally.did > TRIS / 10 && tally.did_not > TRIS / 10);
    oracle_free(oracle);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_bound_is_nine_units_of_the_magnitudes),
        cmocka_unit_test(areas_are_seen_on_every_axis),
        cmocka_unit_test(what_it_can_decide_it_decides),
        cmocka_unit_test(the_limit_is_where_the_bound_is),
    };
    return cmocka_run_group_tests_name("oracle_filter", tests, NULL, NULL);
}
