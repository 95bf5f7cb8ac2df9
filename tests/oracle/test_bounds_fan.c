/* Why woop is watertight: the sign of its edge function is never wrong, so some triangle of a
 * closed fan is accepted. Holds for every monotone rounding; not with fused operations, nor where
 * each operation may round either way. */
#include "tests/exact/legal.h"

#include "ref/base/base.h"
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
    return getenv("RAYDIFF_SLOW") ? 20000000 : 200000;
}

static int sign(double x)
{
    return (x > 0) - (x < 0);
}

/* Sign of a b - c d. A difference of two exact products in double may be rounded, never to the
 * wrong side of 0. */
static int exact_sign(float a, float b, float c, float d)
{
    return sign((double)a * (double)b - (double)c * (double)d);
}

/* Often so small that the products are subnormal. */
static float some(struct rng *rng)
{
    int down = rng_below(rng, 4) ? 0 : (int)rng_below(rng, 70);
    return ldexpf(1 + rng_float(rng), -down);
}

static float near(struct rng *rng, float x)
{
    return float_from_bits(float_bits(x) + rng_below(rng, 5) - 2);
}

static float computed(struct legal *l, float a, float b, float c, float d)
{
    return legal_add(l, legal_mul(l, a, b), -legal_mul(l, c, d));
}

static void sign_of_an_edge_is_never_wrong(void **state)
{
    (void)state;
    uint64_t zero = 0, fused_wrong = 0, free_wrong = 0;
    struct rng rng = rng_make(31, 0);
    struct legal ieee = {.rounding = ROUNDING_IEEE};
    struct legal flushed = {.rounding = ROUNDING_FLUSHED, .style = LEGAL_CHOSEN};
    struct legal either = {.rounding = ROUNDING_VULKAN, .style = LEGAL_RANDOM};
    memset(flushed.choice, LEGAL_FLUSH | LEGAL_FLUSH_A | LEGAL_FLUSH_B, sizeof flushed.choice);
    for (uint64_t n = 0; n < trials(); n++) {
        float a = some(&rng), b = some(&rng);
        float c = near(&rng, a), d = near(&rng, b);
        int exact = exact_sign(a, b, c, d);
        flushed.count = either.count = 0;
        float plain = computed(&ieee, a, b, c, d);
        assert_true(sign((double)plain) * exact >= 0);
        assert_true(sign((double)computed(&flushed, a, b, c, d)) * exact >= 0);
        /* From the other side of the edge: the same products, the other way around. */
        assert_true(computed(&ieee, d, c, b, a) == -plain);
        zero += plain == 0 && exact != 0;
        fused_wrong += sign((double)fmaf(a, b, -(c * d))) * exact < 0;
        free_wrong += sign((double)computed(&either, a, b, c, d)) * exact < 0;
    }
    print_message(
        "edge functions of %llu: wrong sign 0, zero instead %llu; wrong if fused %llu, if "
        "rounded either way %llu\n",
        (unsigned long long)trials(), (unsigned long long)zero, (unsigned long long)fused_wrong,
        (unsigned long long)free_wrong);
    assert_true(zero > 0 && fused_wrong > 0 && free_wrong > 0);
}

#define SPOKES_MOST 9

/* Triangles around a vertex, which lies at `centre`. */
struct bounds_fan {
    struct ray ray;
    uint32_t count;
    float centre[3], rim[SPOKES_MOST][3];
};

static void fan_triangle(const struct bounds_fan *fan, uint32_t i, float v[3][3])
{
    memcpy(v[i % 3], fan->centre, sizeof fan->centre); /* any corner can be the centre */
    memcpy(v[(i + 1) % 3], fan->rim[i], sizeof fan->centre);
    memcpy(v[(i + 2) % 3], fan->rim[(i + 1) % fan->count], sizeof fan->centre);
}

/* A crooked umbrella, and a ray at its middle or past one of its spokes by about rounding. */
static void draw(struct rng *rng, struct bounds_fan *fan)
{
    double turn = 6.283185307179586 * (double)rng_float(rng), at[3];
    int axis = (int)rng_below(rng, 3);
    float offset = rng_below(rng, 2) ? 0.0f : 50.0f, distance = 1 + 7 * rng_float(rng);
    fan->count = 3 + rng_below(rng, SPOKES_MOST - 2);
    for (int k = 0; k < 3; k++)
        fan->centre[k] = offset + rng_range(rng, -1, 1);
    for (uint32_t i = 0; i < fan->count; i++) {
        double angle = turn + 6.283185307179586 * i / fan->count;
        float size = rng_range(rng, 0.125f, 1);
        const double out[3] = {cos(angle), sin(angle), (double)rng_range(rng, -1, 1)};
        for (int k = 0; k < 3; k++)
            fan->rim[i][(axis + k) % 3] =
                fan->centre[(axis + k) % 3] + (float)((double)size * out[k]);
    }
    const float *spoke = fan->rim[rng_below(rng, fan->count)];
    double share = rng_below(rng, 2) ? 0 : (double)rng_float(rng);
    double off = ldexp(1, -18 - (int)rng_below(rng, 12));
    for (int k = 0; k < 3; k++) {
        at[k] = (double)fan->centre[k] + share * (double)(spoke[k] - fan->centre[k]);
        at[k] += off * (double)rng_range(rng, -1, 1);
    }
    for (int k = 0; k < 3; k++) {
        int i = (axis + k) % 3;
        fan->ray.org[i] = (float)at[i] + rng_range(rng, -0.5f, 0.5f) + (k == 2 ? distance : 0);
        fan->ray.dir[i] = (float)(at[i] - (double)fan->ray.org[i]);
    }
    fan->ray.tmin = 0;
    fan->ray.tmax = INFINITY;
}

/* All determinants proven of one sign, all rim edges proven of that sign, all t in range. */
static bool proven(const struct bounds_fan *fan, struct rounding rounding)
{
    int det = 0;
    for (uint32_t i = 0; i < fan->count; i++) {
        float v[3][3];
        fan_triangle(fan, i, v);
        struct twin twin = twin_eval(TWIN_WOOP, rounding, &fan->ray, v);
        if (i == 0)
            det = twin.det;
        if (det == 0 || twin.det != det || twin.edge[i % 3] != det ||
            !((double)twin.t - 2 * twin.t_err > 0))
            return false;
    }
    return true;
}

static bool contracted_accepts(struct legal *l, const struct bounds_fan *fan, float v[3][3])
{
    struct tri_ray r = tri_ray_make(&fan->ray);
    float x[3], y[3], z[3];
    bool positive = false, negative = false;
    l->count = 0;
    legal_woop_shear(l, &r, v, x, y, z);
    for (int c = 0; c < 3; c++) {
        int a = (c + 2) % 3, b = (c + 1) % 3;
        float w = fmaf(x[a], y[b], -(y[a] * x[b]));
        positive |= w > 0;
        negative |= w < 0;
    }
    return !(positive && negative);
}

struct fan_leaks {
    uint64_t fans, shared, missed, contracted;
};

static void count(struct legal *l, const struct bounds_fan *fan, struct fan_leaks *leaks)
{
    uint32_t accepted = 0, contracted = 0;
    for (uint32_t i = 0; i < fan->count; i++) {
        float v[3][3];
        fan_triangle(fan, i, v);
        accepted += legal_evaluate(l, TWIN_WOOP, &fan->ray, v).accepted;
        contracted += contracted_accepts(l, fan, v);
    }
    leaks->fans++;
    leaks->shared += accepted > 1;
    leaks->missed += accepted == 0;
    leaks->contracted += contracted == 0;
}

static void closed_fan_is_hit(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        struct rounding rounding;
        uint8_t always; /* flushing is a property of the processor, not of the operation */
    } roundings[] = {
        {"ieee", ROUNDING_IEEE, 0},
        {"flushed", ROUNDING_FLUSHED, LEGAL_FLUSH | LEGAL_FLUSH_A | LEGAL_FLUSH_B},
        {"vulkan rte", ROUNDING_VULKAN_RTE, 0},
    };
    for (size_t n = 0; n < ARRAY_COUNT(roundings); n++) {
        struct fan_leaks leaks = {0};
        struct rng rng = rng_make(32, n);
        struct legal legal = {.rounding = roundings[n].rounding, .style = LEGAL_CHOSEN};
        memset(legal.choice, roundings[n].always, sizeof legal.choice);
        for (uint64_t i = 0; i < trials() / 4; i++) {
            struct bounds_fan fan;
            draw(&rng, &fan);
            if (!proven(&fan, roundings[n].rounding))
                continue;
            for (int shear = 0; shear < 3; shear++) /* one shear for all triangles, however bad */
                legal.choice[shear] = (uint8_t)(roundings[n].always | rng_below(&rng, 3));
            count(&legal, &fan, &leaks);
        }
        print_message("closed fans, %-10s: %llu proven, two or more hits in %llu, leaks %llu; "
                      "contracted %llu\n",
                      roundings[n].name, (unsigned long long)leaks.fans,
                      (unsigned long long)leaks.shared, (unsigned long long)leaks.missed,
                      (unsigned long long)leaks.contracted);
        assert_true(leaks.fans > trials() / 16);
        assert_int_equal(leaks.missed, 0);
        assert_true(leaks.contracted > 0); /* the rays are near enough to edges */
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sign_of_an_edge_is_never_wrong),
        cmocka_unit_test(closed_fan_is_hit),
    };
    return cmocka_run_group_tests_name("bounds_fan", tests, NULL, NULL) ? 1 : 0;
}
