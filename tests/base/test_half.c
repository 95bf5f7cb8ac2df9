/* Laws of ref/base/half.h, against a decoder written from the definition and against the CPU's
 * F16C. */
#include "ref/base/base.h"
#include "ref/base/half.h"
#include "ref/base/rng.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The definition of binary16: no bit tricks shared with half_to_float. */
static double value_of(uint32_t bits)
{
    int exponent = (int)(bits / 1024 % 32);
    double fraction = bits % 1024;
    double magnitude;
    if (exponent == 31)
        magnitude = fraction > 0 ? (double)NAN : HUGE_VAL;
    else if (exponent == 0)
        magnitude = ldexp(fraction, -24);
    else
        magnitude = ldexp(1024 + fraction, exponent - 25);
    return bits >= 32768 ? -magnitude : magnitude;
}

static bool code_is_nan(uint32_t bits)
{
    return bits % 32768 > 31744;
}

static void half_keeps_every_code(void **state)
{
    (void)state;
    for (uint32_t bits = 0; bits < 65536; bits++) {
        struct half h = {(uint16_t)bits};
        float f = half_to_float(h);
        if (code_is_nan(bits)) {
            assert_true(f != f);
            uint32_t quiet = bits | 0x200;
            assert_int_equal(half_down(f).bits, quiet);
            assert_int_equal(half_up(f).bits, quiet);
            assert_int_equal(half_nearest(f).bits, quiet);
            continue;
        }
        assert_true((double)f == value_of(bits));
        assert_int_equal(float_bits(f) >> 31, bits >> 15);
        assert_int_equal(half_down(f).bits, bits);
        assert_int_equal(half_up(f).bits, bits);
        assert_int_equal(half_nearest(f).bits, bits);
    }
}

/* Steps through the floats just below, at and above each half and each midpoint of neighbours. */
static void half_rounds_to_the_neighbours(void **state)
{
    (void)state;
    for (uint32_t bits = 0; bits < 0x7C00; bits++) {
        double lo = value_of(bits), hi = bits == 0x7BFF ? 65536 : value_of(bits + 1);
        float middle = (float)((lo + hi) / 2);
        float probe[] = {nextafterf((float)lo, 1e9f), nextafterf(middle, 0), middle,
                         nextafterf(middle, 1e9f), nextafterf((float)hi, 0)};
        for (size_t i = 0; i < ARRAY_COUNT(probe); i++) {
            double x = (double)probe[i];
            assert_true(lo < x && x < hi);
            uint32_t nearest =
                x - lo < hi - x || (x - lo == hi - x && bits % 2 == 0) ? bits : bits + 1;
            assert_int_equal(half_down(probe[i]).bits, bits);
            assert_int_equal(half_up(probe[i]).bits, bits + 1);
            assert_int_equal(half_nearest(probe[i]).bits, nearest);
            assert_int_equal(half_down(-probe[i]).bits, 0x8000 + bits + 1);
            assert_int_equal(half_up(-probe[i]).bits, 0x8000 + bits);
            assert_int_equal(half_nearest(-probe[i]).bits, 0x8000 + nearest);
        }
    }
}

static void half_overflows_outward(void **state)
{
    (void)state;
    assert_int_equal(half_up(65504.0f).bits, 0x7BFF);
    assert_int_equal(half_up(65505.0f).bits, 0x7C00);
    assert_int_equal(half_down(65505.0f).bits, 0x7BFF);
    assert_int_equal(half_down(3e38f).bits, 0x7BFF);
    assert_int_equal(half_up(-3e38f).bits, 0xFBFF);
    assert_int_equal(half_down(-65505.0f).bits, 0xFC00);
    assert_int_equal(half_nearest(65519.996f).bits, 0x7BFF);
    assert_int_equal(half_nearest(65520.0f).bits, 0x7C00);
    assert_int_equal(half_down(INFINITY).bits, 0x7C00);
    assert_int_equal(half_up(-INFINITY).bits, 0xFC00);
}

static void half_rounds_down_below_zero(void **state)
{
    (void)state;
    assert_int_equal(half_down(-1e-40f).bits, 0x8001);
    assert_int_equal(half_up(-1e-40f).bits, 0x8000);
    assert_int_equal(half_up(1e-40f).bits, 0x0001);
    assert_int_equal(half_down(-0.1f).bits, 0xAE67);
    assert_int_equal(half_up(0.1f).bits, 0x2E67);
    assert_int_equal(half_nearest(0.1f).bits, 0x2E66);
    assert_int_equal(half_nearest(0x1p-25f).bits, 0);
    assert_int_equal(half_nearest(0x1.000002p-25f).bits, 1);
    assert_int_equal(half_nearest(-0x1.8p-24f).bits, 0x8002);
}

static bool is_stored_bound(struct half h)
{
    uint32_t magnitude = h.bits & 0x7FFF;
    return h.bits == 0 || (magnitude >= 0x400 && magnitude <= 0x7C00);
}

/* A bound encloses x, is never subnormal nor -0, and none of those lies between it and x. */
static void check_bounds_of(float x)
{
    struct half lo = half_bound_down(x), hi = half_bound_up(x);
    assert_true(is_stored_bound(lo) && is_stored_bound(hi));
    assert_true(value_of(lo.bits) <= (double)x && (double)x <= value_of(hi.bits));
    if (fabsf(x) >= 0x1p-14f) {
        assert_int_equal(lo.bits, half_down(x).bits);
        assert_int_equal(hi.bits, half_up(x).bits);
    } else if (x > 0) {
        assert_int_equal(lo.bits, 0);
        assert_int_equal(hi.bits, 0x0400);
    } else if (x < 0) {
        assert_int_equal(lo.bits, 0x8400);
        assert_int_equal(hi.bits, 0);
    } else {
        assert_int_equal(lo.bits | hi.bits, 0);
    }
}

static void half_bounds_enclose_without_subnormals(void **state)
{
    (void)state;
    for (uint32_t bits = 0; bits < 65536; bits++) {
        if (code_is_nan(bits))
            continue;
        float f = half_to_float((struct half){(uint16_t)bits});
        check_bounds_of(f);
        check_bounds_of(nextafterf(f, INFINITY));
        check_bounds_of(nextafterf(f, -INFINITY));
    }
    assert_int_equal(half_bound_down(NAN).bits, 0xFC00);
    assert_int_equal(half_bound_up(NAN).bits, 0x7C00);
    assert_int_equal(half_bound_down(-0.0f).bits, 0);
}

#if defined(__x86_64__)
#include <cpuid.h>
#include <immintrin.h>

/* Returns how many of the 4 floats differ from the processor's conversion. Immediate 1 rounds to
 * -infinity, 2 to +infinity, 0 to nearest. */
__attribute__((target("f16c"))) static int differing(uint32_t first)
{
    float x[4];
    uint16_t down[8], up[8], nearest[8];
    for (uint32_t i = 0; i < 4; i++)
        x[i] = float_from_bits(first + i);
    __m128 v = _mm_loadu_ps(x);
    _mm_storeu_si128((__m128i *)down, _mm_cvtps_ph(v, 1));
    _mm_storeu_si128((__m128i *)up, _mm_cvtps_ph(v, 2));
    _mm_storeu_si128((__m128i *)nearest, _mm_cvtps_ph(v, 0));
    int count = 0;
    for (int i = 0; i < 4; i++)
        count += half_down(x[i]).bits != down[i] || half_up(x[i]).bits != up[i] ||
                 half_nearest(x[i]).bits != nearest[i];
    return count;
}

/* F16C is encoded as AVX is, which the operating system must have enabled. */
static bool have_f16c(void)
{
    unsigned a, b, c, d;
    __builtin_cpu_init();
    return __builtin_cpu_supports("avx") && __get_cpuid(1, &a, &b, &c, &d) && (c & bit_F16C);
}
#else
static int differing(uint32_t first)
{
    (void)first;
    return 1;
}

static bool have_f16c(void)
{
    return false;
}
#endif

/* Four neighbours out of every 512 floats: 2^25 of them, every exponent and sign among them. */
static void half_agrees_with_f16c_on_a_sample(void **state)
{
    (void)state;
    if (!have_f16c()) {
        print_message("skipped: this processor has no F16C\n");
        skip();
    }
    struct rng rng = rng_make(1, 0);
    uint64_t wrong = 0;
    for (uint64_t stratum = 0; stratum < (uint64_t)1 << 32; stratum += 512)
        wrong += (uint64_t)differing((uint32_t)stratum + 4 * rng_below(&rng, 128));
    assert_int_equal(wrong, 0);
}

static void half_agrees_with_f16c_on_all_floats(void **state)
{
    (void)state;
    const char *slow = getenv("RAYDIFF_SLOW");
    if (!have_f16c() || !slow || strcmp(slow, "1") != 0) {
        print_message("skipped: needs RAYDIFF_SLOW=1 and F16C\n");
        skip();
    }
    uint64_t wrong = 0;
    for (uint64_t part = 0; part < 64; part++) {
#pragma omp parallel for reduction(+ : wrong)
        for (uint64_t i = 0; i < (uint64_t)1 << 26; i += 4)
            wrong += (uint64_t)differing((uint32_t)((part << 26) + i));
        fprintf(stderr, "\rhalf: %u of 64 parts, %llu differences", (unsigned)part + 1,
                (unsigned long long)wrong);
    }
    fputc('\n', stderr);
    assert_int_equal(wrong, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(half_keeps_every_code),
        cmocka_unit_test(half_rounds_to_the_neighbours),
        cmocka_unit_test(half_overflows_outward),
        cmocka_unit_test(half_rounds_down_below_zero),
        cmocka_unit_test(half_bounds_enclose_without_subnormals),
        cmocka_unit_test(half_agrees_with_f16c_on_a_sample),
        cmocka_unit_test(half_agrees_with_f16c_on_all_floats),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
