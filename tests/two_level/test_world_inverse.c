/* Inverses of transforms against rationals: each number is the nearest float32, ties to even. */
#include "ref/base/rng.h"
#include "ref/world/object_ray.h"
#include "ref/world/world.h"

#include <float.h>
#include <gmp.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

/* What was met, so that a test can require it. */
struct roundings_met {
    int ties, subnormal, vanished, refused, ordinary;
};

/* By Gauss and Jordan; false if the matrix is singular. */
static bool solve(const float m[3][4], mpq_t w[9])
{
    mpq_t a[3][6], factor, product;
    mpq_inits(factor, product, NULL);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 6; j++) {
            mpq_init(a[i][j]);
            mpq_set_d(a[i][j], j < 3 ? (double)m[i][j] : (double)(j - 3 == i));
        }
    bool regular = true;
    for (int c = 0; c < 3 && regular; c++) {
        int pivot = c;
        while (pivot < 3 && mpq_sgn(a[pivot][c]) == 0)
            pivot++;
        regular = pivot < 3;
        for (int j = 0; j < 6 && regular; j++)
            mpq_swap(a[c][j], a[pivot][j]);
        for (int i = 0; i < 3 && regular; i++) {
            mpq_div(factor, a[i][c], a[c][c]);
            for (int j = 0; j < 6; j++) {
                mpq_mul(product, factor, a[c][j]);
                if (i != c)
                    mpq_sub(a[i][j], a[i][j], product);
            }
        }
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 6; j++) {
            if (regular && j >= 3)
                mpq_div(w[3 * i + j - 3], a[i][j], a[i][i]);
            if (j >= 3)
                mpq_clear(a[i][j]);
        }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            mpq_clear(a[i][j]);
    mpq_clears(factor, product, NULL);
    return regular;
}

/* The middle between a float and its neighbour towards `to`; beyond FLT_MAX as if 2^128 was one. */
static void middle(float x, float to, mpq_t out)
{
    float next = nextafterf(x, to);
    double far = isinf(next) ? copysign(0x1p128, (double)next) : (double)next;
    mpq_t half;
    mpq_init(half);
    mpq_set_d(out, (double)x / 2);
    mpq_set_d(half, far / 2);
    mpq_add(out, out, half);
    mpq_clear(half);
}

/* Whether `x` rounds to `w`. */
static bool rounds_to(const mpq_t x, float w, struct roundings_met *met)
{
    mpq_t below, above;
    mpq_inits(below, above, NULL);
    middle(w, -INFINITY, below);
    middle(w, INFINITY, above);
    int low = mpq_cmp(below, x), high = mpq_cmp(x, above);
    bool even = (float_bits(w) & 1) == 0;
    bool right = (low < 0 || (low == 0 && even)) && (high < 0 || (high == 0 && even));
    met->ties += low == 0 || high == 0;
    met->subnormal += w != 0 && fabsf(w) < FLT_MIN;
    met->vanished += w == 0 && mpq_sgn(x) != 0;
    met->ordinary += fabsf(w) >= FLT_MIN;
    if (w == 0) /* the sign of what vanished; of 0 none */
        right = right && (signbit(w) != 0) == (mpq_sgn(x) < 0);
    mpq_clears(below, above, NULL);
    return right;
}

/* True if it rounds to infinity. */
static bool is_beyond(const mpq_t x)
{
    mpq_t limit, size;
    mpq_inits(limit, size, NULL);
    middle(FLT_MAX, INFINITY, limit);
    mpq_abs(size, x);
    bool beyond = mpq_cmp(size, limit) >= 0;
    mpq_clears(limit, size, NULL);
    return beyond;
}

static void assert_inverse(const float m[3][4], struct roundings_met *met)
{
    mpq_t exact[9];
    float w[9];
    struct reason reason = {""};
    bool beyond = false;
    for (int i = 0; i < 9; i++)
        mpq_init(exact[i]);
    bool regular = solve(m, exact);
    assert_int_equal(regular, instance_det_sign(m) != 0);
    if (regular) {
        for (int i = 0; i < 9; i++)
            beyond = beyond || is_beyond(exact[i]);
        assert_int_equal(transform_inverse(m, w, &reason), beyond ? STATUS_LIMIT : STATUS_OK);
        met->refused += beyond;
        for (int i = 0; i < 9; i++) {
            if (beyond && w[i] != 0)
                fail_msg("refused, and element %d is not 0", i);
            if (!beyond && !rounds_to(exact[i], w[i], met))
                fail_msg("element %d is %a, exactly %g (%a %a %a, %a %a %a, %a %a %a)", i,
                         (double)w[i], mpq_get_d(exact[i]), (double)m[0][0], (double)m[0][1],
                         (double)m[0][2], (double)m[1][0], (double)m[1][1], (double)m[1][2],
                         (double)m[2][0], (double)m[2][1], (double)m[2][2]);
        }
    }
    for (int i = 0; i < 9; i++)
        mpq_clear(exact[i]);
}

static float any_float(struct rng *rng, int least, int most)
{
    float mantissa = 1.0f + (float)rng_below(rng, 1u << 23) * 0x1p-23f;
    int exponent = least + (int)rng_below(rng, (uint32_t)(most - least + 1));
    float x = ldexpf(mantissa, exponent);
    return rng_below(rng, 2) ? x : -x;
}

static void numbers_of_one_size(void **state)
{
    (void)state;
    struct roundings_met met = {0};
    for (uint64_t i = 0; i < 3000; i++) {
        struct rng rng = rng_make(1, i);
        float m[3][4] = {{0}};
        for (int k = 0; k < 9; k++)
            m[k / 3][k % 3] = any_float(&rng, -3, 2);
        assert_inverse(m, &met);
    }
    assert_true(met.ordinary == 9 * 3000);
}

/* From the least subnormal to the largest float, in one matrix. */
static void numbers_of_all_sizes(void **state)
{
    (void)state;
    struct roundings_met met = {0};
    for (uint64_t i = 0; i < 3000; i++) {
        struct rng rng = rng_make(2, i);
        int reach = 1 + (int)(i % 126);
        float m[3][4] = {{0}};
        for (int k = 0; k < 9; k++)
            m[k / 3][k % 3] = any_float(&rng, i % 3 ? -reach : -149, reach);
        assert_inverse(m, &met);
    }
    assert_true(met.refused > 30 && met.subnormal > 100 && met.vanished > 100);
}

/* The third row is a sum of multiples of the others, but for a unit in the last place. */
static void nearly_singular_ones(void **state)
{
    (void)state;
    struct roundings_met met = {0};
    for (uint64_t i = 0; i < 2000; i++) {
        struct rng rng = rng_make(3, i);
        float m[3][4] = {{0}}, a = rng_range(&rng, -2, 2), b = rng_range(&rng, -2, 2);
        for (int k = 0; k < 3; k++) {
            m[0][k] = rng_range(&rng, -1, 1);
            m[1][k] = i % 2 ? rng_range(&rng, -1, 1) : nextafterf(m[0][k], 2.0f);
            m[2][k] = a * m[0][k] + b * m[1][k];
        }
        assert_inverse(m, &met);
    }
    assert_true(met.ordinary > 0);
}

/* Their inverse has -a, a b and -b beside ones: a b of 12 to 14 bits each ends anywhere in the
 * last places, halves included. */
static void shears_with_ties(void **state)
{
    (void)state;
    struct roundings_met met = {0};
    for (uint64_t i = 0; i < 4000; i++) {
        struct rng rng = rng_make(4, i);
        float a = (float)(1 + 2 * rng_below(&rng, 1u << 12)), b = (float)rng_below(&rng, 1u << 13);
        float m[3][4] = {{1, i % 2 ? a : -a, 0}, {0, 1, b}, {0, 0, 1}};
        assert_inverse(m, &met);
    }
    assert_true(met.ties > 100);
}

/* The same at the lower end: 2^-156 a b. */
static void subnormal_ties(void **state)
{
    (void)state;
    struct roundings_met met = {0};
    for (uint64_t i = 0; i < 4000; i++) {
        struct rng rng = rng_make(5, i);
        float a = (float)(1 + rng_below(&rng, 1u << 8)), b = (float)(1 + rng_below(&rng, 1u << 8));
        float m[3][4] = {{1, ldexpf(i % 2 ? a : -a, -78), 0}, {0, 1, ldexpf(b, -78)}, {0, 0, 1}};
        assert_inverse(m, &met);
    }
    assert_true(met.ties > 30 && met.subnormal > 1000 && met.vanished > 10);
}

/* Element 0, 2 of the inverse is (m01 m12 - m02 m11) / (m00 m11 m22). Here it is a tie, an odd
 * number of `bits` bits times 2^exponent, but for a relative error of 2^-48 or less, which the last
 * number leaves: no double tells on which side it lies. */
static void nearly_a_tie(struct rng *rng, int bits, int exponent, float m[3][4])
{
    int64_t tie = (1ll << (bits - 1)) + 2 * (int64_t)rng_below(rng, 1u << (bits - 2)) + 1;
    int64_t a = (1 << 23) + 2 * (int64_t)rng_below(rng, 1u << 22) + 1;
    int64_t b = (1 << 23) + 2 * (int64_t)rng_below(rng, 1u << 22) + 1;
    float first = (float)(tie * a);
    int64_t rest = (int64_t)first - tie * a;
    m[0][0] = (float)a;
    m[0][1] = ldexpf(first, exponent);
    m[0][2] = ldexpf((float)(rest * b), exponent);
    m[1][1] = 1;
    m[1][2] = m[2][2] = (float)b;
}

static void beside_ties(void **state)
{
    (void)state;
    struct roundings_met met = {0};
    for (uint64_t i = 0; i < 6000; i++) {
        struct rng rng = rng_make(6, i);
        float m[3][4] = {{0}};
        if (i % 2)
            nearly_a_tie(&rng, 25, (int)(i % 60) - 30, m);
        else
            nearly_a_tie(&rng, 3 + (int)(i / 2 % 20), -150, m);
        m[0][1] = i % 3 ? m[0][1] : -m[0][1];
        m[0][2] = i % 3 ? m[0][2] : -m[0][2];
        assert_inverse(m, &met);
    }
    assert_true(met.subnormal > 2000);
}

/* Powers of two, mirrors and permutations have exact inverses, or none in range. */
static void powers_of_two(void **state)
{
    (void)state;
    struct roundings_met met = {0};
    static const int order[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                    {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    for (int e = -149; e < 128; e++)
        for (int p = 0; p < 6; p++) {
            float m[3][4] = {{0}}, w[9];
            for (int k = 0; k < 3; k++)
                m[k][order[p][k]] = k == p % 3 ? -ldexpf(1, e) : ldexpf(1, e);
            assert_inverse(m, &met);
            if (e < -127)
                continue;
            assert_int_equal(transform_inverse(m, w, NULL), STATUS_OK);
            for (int k = 0; k < 3; k++)
                assert_true(w[3 * order[p][k] + k] * m[k][order[p][k]] == 1.0f);
        }
    assert_int_equal(met.refused, 22 * 6);
    assert_int_equal(met.ties, 0);
}

/* The last number that rounds down to FLT_MAX, and the first that does not. */
static void the_end_of_the_range(void **state)
{
    (void)state;
    struct roundings_met met = {0};
    float a = ldexpf(16777215, 40), w[9];
    float fits[3][4] = {{1, a, 0}, {0, 1, 0x1p64f}, {0, 0, 1}};
    assert_inverse(fits, &met);
    assert_int_equal(transform_inverse(fits, w, NULL), STATUS_OK);
    assert_true(w[2] == FLT_MAX);

    /* 2^25 - 1 as a float is 2^25. */
    float over[3][4] = {{1, ldexpf(33554431.0f, 38), 0}, {0, 1, 0x1p65f}, {0, 0, 1}};
    assert_inverse(over, &met);
    /* 31 * 1082401 = 2^25 - 1: exactly between FLT_MAX and 2^128. */
    float tie[3][4] = {{1, 31.0f, 0}, {0, 1, ldexpf(1082401, 103)}, {0, 0, 1}};
    struct reason reason = {""};
    assert_inverse(tie, &met);
    assert_int_equal(transform_inverse(tie, w, &reason), STATUS_LIMIT);
    assert_non_null(strstr(reason.text, "row 0, column 2"));
    /* 33554430 = 2 * 16777215 is FLT_MAX; one unit of 25 bits less is a tie that rounds to even. */
    tie[0][1] = 3.0f;
    tie[1][2] = ldexpf(11184809, 103); /* 2^25 - 5 */
    assert_inverse(tie, &met);
    assert_int_equal(transform_inverse(tie, w, NULL), STATUS_OK);
    assert_true(w[2] == ldexpf(16777214, 104));
    assert_int_equal(met.refused, 2);
    assert_int_equal(met.ties, 1);
}

/* The identity is its own inverse, its zeros positive. */
static void the_identity(void **state)
{
    (void)state;
    float m[3][4] = {{1, 0, -0.0f, 7}, {0, 1, 0, 8}, {-0.0f, 0, 1, 9}}, w[9];
    const float expected[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    assert_int_equal(transform_inverse(m, w, NULL), STATUS_OK);
    assert_memory_equal(w, expected, sizeof w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_of_one_size),  cmocka_unit_test(numbers_of_all_sizes),
        cmocka_unit_test(nearly_singular_ones), cmocka_unit_test(shears_with_ties),
        cmocka_unit_test(subnormal_ties),       cmocka_unit_test(beside_ties),
        cmocka_unit_test(powers_of_two),        cmocka_unit_test(the_end_of_the_range),
        cmocka_unit_test(the_identity),
    };
    return cmocka_run_group_tests_name("world_inverse", tests, NULL, NULL);
}
