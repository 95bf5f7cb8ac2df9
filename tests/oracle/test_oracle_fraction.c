/* Fractions (ref/integers/fraction.h) against GMP rationals: compared, enclosed in doubles, and
 * as text in buffers of every size; and the grid that ref/oracle/small.h puts a ray and a triangle
 * on. */
#include "ref/integers/oracle_grid.h"
#include "ref/oracle/small.h"
#include "ref/base/rng.h"

#include <gmp.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define CASES 20000u

/* A number of at most `bits` bits, as a wide integer and as GMP's. */
static void draw_wide(struct rng *rng, unsigned bits, struct oracle_wide *out, mpz_t same)
{
    wide_set(0, out);
    mpz_set_ui(same, 0);
    for (unsigned at = 0; at < bits; at += 32) {
        uint64_t part = rng_u64(rng) >> (bits - at < 32 ? 64 - (bits - at) : 32);
        struct oracle_wide low;
        wide_shift_left(out, 32);
        wide_set((__int128)part, &low);
        wide_add(out, &low, out);
        mpz_mul_2exp(same, same, 32);
        mpz_add_ui(same, same, part);
    }
}

/* A fraction, with either sign of either part, and GMP's. */
static void draw(struct rng *rng, struct fraction *out, mpq_t same)
{
    do
        draw_wide(rng, 1 + (unsigned)(rng_u64(rng) % 300), &out->num, mpq_numref(same));
    while (out->num.sign == 0 && rng_u64(rng) % 8 != 0);
    do
        draw_wide(rng, 1 + (unsigned)(rng_u64(rng) % 300), &out->den, mpq_denref(same));
    while (out->den.sign == 0);
    bool negative = rng_u64(rng) & 1, turned = rng_u64(rng) & 1;
    out->num.sign *= negative ? -1 : 1;
    out->den.sign *= turned ? -1 : 1;
    out->scale = (int)(rng_u64(rng) % 400) - 200;
    if (negative != turned)
        mpz_neg(mpq_numref(same), mpq_numref(same));
    mpq_canonicalize(same);
    if (out->scale < 0)
        mpq_div_2exp(same, same, (mp_bitcnt_t)-out->scale);
    else
        mpq_mul_2exp(same, same, (mp_bitcnt_t)out->scale);
}

static int sign(int x)
{
    return (x > 0) - (x < 0);
}

static int compare_gmp(const mpq_t a, double x)
{
    mpq_t other;
    mpq_init(other);
    mpq_set_d(other, x);
    int order = sign(mpq_cmp(a, other));
    mpq_clear(other);
    return order;
}

static void orders_as_rationals(void **state)
{
    struct rng rng = {1};
    struct fraction a, b;
    mpq_t p, q;
    (void)state;
    mpq_inits(p, q, NULL);
    for (unsigned i = 0; i < CASES; i++) {
        draw(&rng, &a, p);
        draw(&rng, &b, q);
        assert_int_equal(fraction_compare(&a, &b), sign(mpq_cmp(p, q)));
        assert_int_equal(fraction_compare(&a, &a), 0);
        struct fraction doubled = a;
        wide_shift_left(&doubled.num, 3);
        doubled.scale -= 3;
        assert_int_equal(fraction_compare(&a, &doubled), 0);
        assert_int_equal(fraction_compare_double(&a, INFINITY), -1);
        assert_int_equal(fraction_compare_double(&a, -INFINITY), 1);
        double near = mpq_get_d(p);
        const double x[] = {near, nextafter(near, INFINITY), nextafter(near, -INFINITY), 0, -near};
        for (size_t k = 0; k < sizeof x / sizeof x[0]; k++)
            assert_int_equal(fraction_compare_double(&a, x[k]), compare_gmp(p, x[k]));
    }
    mpq_clears(p, q, NULL);
}

static void encloses_between_doubles(void **state)
{
    struct rng rng = {2};
    struct fraction a;
    mpq_t p;
    (void)state;
    mpq_init(p);
    for (unsigned i = 0; i < CASES; i++) {
        draw(&rng, &a, p);
        double lo, hi, next;
        fraction_enclose(&a, &lo, &hi);
        assert_true(compare_gmp(p, lo) >= 0 && compare_gmp(p, hi) <= 0);
        next = lo;
        for (int k = 0; k < 3 && next < hi; k++)
            next = nextafter(next, INFINITY);
        assert_true(next >= hi);
    }
    /* Integers and dyadic fractions are enclosed by themselves. */
    for (int i = -5000; i <= 5000; i++) {
        double lo, hi;
        struct fraction whole = {.scale = i % 64};
        wide_set(i, &whole.num);
        wide_set(i % 3 ? 1 : -4, &whole.den);
        fraction_enclose(&whole, &lo, &hi);
        assert_true(lo == hi && lo == ldexp(i % 3 ? i : i / -4.0, i % 64));
    }
    mpq_clear(p);
}

/* What double cannot hold, or hardly, is enclosed by an end of its range, 0 or infinity. */
static void encloses_beyond_double(void **state)
{
    struct rng rng = {3};
    uint32_t beyond = 0;
    (void)state;
    for (int scale = -3000; scale <= 3000; scale++) {
        double lo, hi;
        bool minus = rng_below(&rng, 2);
        mpq_t p;
        struct fraction a = {.scale = scale};
        wide_set((minus ? -1 : 1) * (int)(1 + rng_below(&rng, 9)), &a.num);
        wide_set(7, &a.den);
        mpq_init(p);
        mpq_set_si(p, a.num.sign * (long)a.num.limb[0], 7);
        if (scale < 0)
            mpq_div_2exp(p, p, (mp_bitcnt_t)-scale);
        else
            mpq_mul_2exp(p, p, (mp_bitcnt_t)scale);
        fraction_enclose(&a, &lo, &hi);
        assert_true(isinf(lo) ? lo < 0 : compare_gmp(p, lo) >= 0);
        assert_true(isinf(hi) ? hi > 0 : compare_gmp(p, hi) <= 0);
        double least = minus ? -hi : lo, most = minus ? -lo : hi;
        bool large = least == FRACTION_MOST && most == INFINITY;
        bool small = least == 0 && most == FRACTION_LEAST;
        assert_true(large || small || most - least <= 0x1p-50 * least);
        assert_true(!large || scale > 990);
        assert_true(!small || scale < -990);
        assert_true(large || scale < 1010);
        assert_true(small || scale > -1010);
        beyond += large || small;
        mpq_clear(p);
    }
    assert_true(beyond > 3900);
}

/* Reads "num/den" with "*2^k" behind it. */
static void read_text(const char *text, mpq_t out)
{
    char copy[1024];
    snprintf(copy, sizeof copy, "%s", text);
    char *power = strchr(copy, '*');
    int k = 0;
    if (power) {
        *power = 0;
        assert_int_equal(sscanf(power + 1, "2^%d", &k), 1);
        assert_true(k > 60 || k < -60);
    }
    assert_int_equal(mpq_set_str(out, copy, 10), 0);
    mpz_t common;
    mpz_init(common);
    mpz_gcd(common, mpq_numref(out), mpq_denref(out));
    assert_int_equal(mpz_cmp_ui(common, 1), 0);
    mpz_clear(common);
    if (power && mpq_sgn(out) != 0)
        assert_true(mpz_odd_p(mpq_numref(out)) && mpz_odd_p(mpq_denref(out)));
    if (k < 0)
        mpq_div_2exp(out, out, (mp_bitcnt_t)-k);
    else
        mpq_mul_2exp(out, out, (mp_bitcnt_t)k);
}

/* The text is the number; it fits a buffer that has room for it and its end, and no smaller one. */
static void check_text(const struct fraction *a, const mpq_t p)
{
    char text[1024], small[1024];
    mpq_t read;
    mpq_init(read);
    assert_true(fraction_text(a, text, sizeof text));
    read_text(text, read);
    assert_true(mpq_equal(read, p));
    size_t length = strlen(text);
    for (size_t bytes = length < 8 ? 0 : length - 8; bytes <= length + 1; bytes++) {
        memset(small, '#', sizeof small);
        assert_int_equal(fraction_text(a, small, bytes), bytes > length);
        for (size_t k = bytes; k < bytes + 40; k++)
            assert_int_equal(small[k], '#');
        if (bytes > length)
            assert_string_equal(small, text);
    }
    for (size_t bytes = 0; bytes < length; bytes++) {
        memset(small, '#', sizeof small);
        assert_false(fraction_text(a, small, bytes));
        for (size_t k = bytes; k < bytes + 40; k++)
            assert_int_equal(small[k], '#');
    }
    mpq_clear(read);
}

static void is_written_in_any_room(void **state)
{
    struct rng rng = {3};
    struct fraction a;
    mpq_t p;
    (void)state;
    mpq_init(p);
    for (unsigned i = 0; i < 300; i++) {
        draw(&rng, &a, p);
        check_text(&a, p);
    }
    for (int num = -12; num <= 12; num++)
        for (int den = 1; den <= 12; den++)
            for (int scale = -64; scale <= 64; scale += 4) {
                struct fraction simple = {.scale = scale};
                wide_set(num, &simple.num);
                wide_set(den, &simple.den);
                mpq_set_si(p, num, (unsigned long)den);
                mpq_canonicalize(p);
                if (scale < 0)
                    mpq_div_2exp(p, p, (mp_bitcnt_t)-scale);
                else
                    mpq_mul_2exp(p, p, (mp_bitcnt_t)scale);
                check_text(&simple, p);
            }
    mpq_clear(p);
}

/* --- small.h ---------------------------------------------------------------------------------- */

/* The largest power of two of which all are multiples, as an exponent; 0 if all are 0. */
static int unit_of(const float *x, size_t count)
{
    int unit = 0;
    bool any = false;
    for (size_t i = 0; i < count; i++) {
        int exponent = 0;
        if (x[i] == 0)
            continue;
        double m = frexp((double)x[i], &exponent);
        while (m != floor(m)) {
            m *= 2;
            exponent--;
        }
        unit = !any || exponent < unit ? exponent : unit;
        any = true;
    }
    return unit;
}

static float draw_float(struct rng *rng, int spread)
{
    uint64_t bits = rng_u64(rng);
    unsigned keep = (unsigned)(bits >> 8) % 25;
    double m = (double)((bits >> 32) & 0xFFFFFF >> (24 - keep));
    return (float)ldexp((bits & 1) ? m : -m,
                        (int)((bits >> 16) % (unsigned)(2 * spread + 1)) - spread);
}

/* A grid's unit is the largest that all numbers are multiples of, its bits are the fewest that hold
 * the largest of them, and a number on it is the number. */
static void grids_are_the_least(void **state)
{
    struct rng rng = {5};
    (void)state;
    for (unsigned i = 0; i < CASES; i++) {
        float x[9];
        struct odd odd[9];
        int spread = (int)(i % 60), count = 1 + (int)(i % 9), top = 0;
        double most = 0;
        for (int k = 0; k < count; k++) {
            x[k] = draw_float(&rng, spread);
            odd[k] = odd_of(x[k]);
            assert_true(ldexp(odd[k].m, odd[k].exponent) == (double)x[k]);
            assert_true(odd[k].m & 1 || (odd[k].m == 0 && odd[k].exponent == 0));
            most = fmax(most, fabs((double)x[k]));
        }
        struct oracle_grid grid = grid_of(odd, count);
        (void)frexp(most, &top); /* most is in [2^(top - 1), 2^top) */
        assert_int_equal(grid.exponent, unit_of(x, (size_t)count));
        assert_int_equal(grid.bits, most > 0 ? top - grid.exponent : 0);
        for (int k = 0; k < count && grid.bits <= 126; k++) {
            struct oracle_wide wide, whole;
            __int128 on_grid = grid_int(grid, odd[k]);
            grid_wide(grid, odd[k], &wide);
            wide_set(on_grid, &whole);
            assert_true(ldexp((double)on_grid, grid.exponent) == (double)x[k]);
            assert_true(wide.sign == whole.sign && wide_compare_size(&wide, &whole) == 0);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(orders_as_rationals),    cmocka_unit_test(encloses_between_doubles),
        cmocka_unit_test(encloses_beyond_double), cmocka_unit_test(is_written_in_any_room),
        cmocka_unit_test(grids_are_the_least),
    };
    return cmocka_run_group_tests_name("oracle_fraction", tests, NULL, NULL);
}
