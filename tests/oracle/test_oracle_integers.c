/* The oracle's integers against GMP: those of a fixed width (ref/integers/wide.h) in every
 * operation, whichever operand the result overwrites, and the products in 128 and 320 bits
 * (ref/oracle/small.h, ref/oracle/medium.h) up to the largest numbers that they take. */
#include "ref/base/rng.h"
#include "ref/oracle/medium.h"
#include "ref/oracle/small.h"

#include <gmp.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define CASES 20000u

/* --- wide.h ----------------------------------------------------------------------------------- */

static void set_gmp(mpz_t out, const struct oracle_wide *wide)
{
    mpz_import(out, (size_t)wide->count, -1, sizeof wide->limb[0], 0, 0, wide->limb);
    if (wide->sign < 0)
        mpz_neg(out, out);
}

/* The same number, no limb of it idle. */
static void expect_wide(const struct oracle_wide *got, const mpz_t want)
{
    mpz_t is;
    mpz_init(is);
    set_gmp(is, got);
    assert_int_equal(mpz_cmp(is, want), 0);
    assert_int_equal(got->sign, mpz_sgn(want));
    assert_int_equal(got->count, mpz_sgn(want) ? (mpz_sizeinbase(want, 2) + 63) / 64 : 0);
    mpz_clear(is);
}

/* Up to `limbs` limbs, many of them of equal bits, so that carries run far. */
static void draw_wide(struct rng *rng, int limbs, struct oracle_wide *out, mpz_t same)
{
    *out = (struct oracle_wide){.count = (int)rng_below(rng, (uint32_t)limbs + 1)};
    for (int i = 0; i < out->count; i++) {
        uint32_t kind = rng_below(rng, 4);
        out->limb[i] = kind == 0 ? 0 : kind == 1 ? UINT64_MAX : rng_u64(rng);
    }
    if (out->count) {
        uint64_t *top = &out->limb[out->count - 1];
        *top = *top >> rng_below(rng, 64);
        *top = *top ? *top : 1;
        out->sign = rng_below(rng, 2) ? 1 : -1;
    }
    set_gmp(same, out);
}

/* Sums and differences, beside their operands or in place of one. */
static void expect_sums(const struct oracle_wide *a, const struct oracle_wide *b, const mpz_t p,
                        const mpz_t q)
{
    mpz_t want;
    mpz_init(want);
    for (int place = 0; place < 3; place++) {
        struct oracle_wide x = *a, y = *b, other;
        struct oracle_wide *out = place == 0 ? &other : place == 1 ? &x : &y;
        wide_add(&x, &y, out);
        mpz_add(want, p, q);
        expect_wide(out, want);
        x = *a;
        y = *b;
        wide_sub(&x, &y, out);
        mpz_sub(want, p, q);
        expect_wide(out, want);
    }
    mpz_clear(want);
}

static void expect_shifts(struct rng *rng, const struct oracle_wide *a, const mpz_t p)
{
    uint32_t room = 64 * WIDE_LIMBS - wide_bits(a);
    uint32_t by = rng_below(rng, 3) ? rng_below(rng, room + 1) : rng_below(rng, room / 64 + 1) * 64;
    struct oracle_wide moved = *a;
    mpz_t want;
    mpz_init(want);
    wide_shift_left(&moved, by);
    mpz_mul_2exp(want, p, by);
    expect_wide(&moved, want);
    wide_shift_right(&moved, by);
    expect_wide(&moved, p);
    unsigned zeros = wide_trailing(a);
    assert_int_equal(zeros, mpz_sgn(p) ? mpz_scan1(p, 0) : 0);
    moved = *a;
    wide_shift_right(&moved, zeros);
    mpz_tdiv_q_2exp(want, p, zeros);
    expect_wide(&moved, want);
    mpz_clear(want);
}

/* The 64 highest bits and whether there are others; and division by a limb. */
static void expect_parts(struct rng *rng, const struct oracle_wide *a, const mpz_t p)
{
    mpz_t size, want, rest;
    mpz_inits(size, want, rest, NULL);
    mpz_abs(size, p);
    assert_int_equal(wide_bits(a), mpz_sgn(p) ? mpz_sizeinbase(p, 2) : 0);
    if (a->sign) {
        uint64_t top;
        int exponent;
        int whole = wide_top(a, &top, &exponent);
        assert_int_equal(exponent, (int)mpz_sizeinbase(p, 2) - 64);
        assert_true(top >> 63);
        if (exponent < 0)
            mpz_mul_2exp(want, size, (mp_bitcnt_t)-exponent);
        else
            mpz_tdiv_q_2exp(want, size, (mp_bitcnt_t)exponent);
        assert_int_equal(mpz_cmp_ui(want, top), 0);
        assert_int_equal(whole != 0,
                         exponent <= 0 || mpz_divisible_2exp_p(p, (mp_bitcnt_t)exponent));
    }
    struct oracle_wide quotient = *a;
    uint64_t by = rng_below(rng, 2) ? 10 : rng_u64(rng) >> rng_below(rng, 63) | 1;
    uint64_t left = wide_divide_small(&quotient, by);
    assert_true(left == mpz_tdiv_q_ui(want, size, by));
    if (a->sign < 0)
        mpz_neg(want, want);
    expect_wide(&quotient, want);
    mpz_clears(size, want, rest, NULL);
}

static void wide_numbers_are_whole_numbers(void **state)
{
    (void)state;
    struct rng rng = rng_make(61, 0);
    mpz_t p, q, want;
    mpz_inits(p, q, want, NULL);
    for (uint32_t n = 0; n < CASES; n++) {
        struct oracle_wide a, b, product, turned;
        draw_wide(&rng, 1 + (int)(n % 13), &a, p);
        draw_wide(&rng, 1 + (int)(n % 11), &b, q);
        if (n % 5 == 0) { /* the same size, the same sign or not */
            b = a;
            b.sign = rng_below(&rng, 2) ? a.sign : -a.sign;
            set_gmp(q, &b);
        }
        assert_int_equal(wide_compare_size(&a, &b),
                         (mpz_cmpabs(p, q) > 0) - (mpz_cmpabs(p, q) < 0));
        expect_sums(&a, &b, p, q);
        wide_mul(&a, &b, &product);
        wide_mul(&b, &a, &turned);
        mpz_mul(want, p, q);
        expect_wide(&product, want);
        expect_wide(&turned, want);
        wide_copy(&product, &a);
        expect_wide(&a, want);
        expect_shifts(&rng, &b, q);
        expect_parts(&rng, &b, q);
    }
    mpz_clears(p, q, want, NULL);
}

/* --- small.h and medium.h --------------------------------------------------------------------- */

static void set_128(mpz_t out, __int128 x)
{
    struct oracle_wide wide;
    wide_set(x, &wide);
    set_gmp(out, &wide);
}

/* x . (y cross z) */
static void triple(mpz_t out, mpz_t x[3], mpz_t y[3], mpz_t z[3])
{
    mpz_t term;
    mpz_init(term);
    mpz_set_ui(out, 0);
    for (int k = 0; k < 3; k++)
        for (int turn = 1; turn < 3; turn++) {
            mpz_mul(term, y[(k + turn) % 3], z[(k + 3 - turn) % 3]);
            mpz_mul(term, term, x[k]);
            if (turn == 1)
                mpz_add(out, out, term);
            else
                mpz_sub(out, out, term);
        }
    mpz_clear(term);
}

/* w, D and T by their definition. */
struct products_gmp {
    mpz_t a[3][3], d[3], w[3], det, t;
};

static void products_init(struct products_gmp *p)
{
    mpz_inits(p->det, p->t, NULL);
    for (int k = 0; k < 3; k++)
        mpz_inits(p->a[0][k], p->a[1][k], p->a[2][k], p->d[k], p->w[k], NULL);
}

static void products_clear(struct products_gmp *p)
{
    mpz_clears(p->det, p->t, NULL);
    for (int k = 0; k < 3; k++)
        mpz_clears(p->a[0][k], p->a[1][k], p->a[2][k], p->d[k], p->w[k], NULL);
}

static void products_find(struct products_gmp *p)
{
    mpz_set_ui(p->det, 0);
    for (int c = 0; c < 3; c++) {
        triple(p->w[c], p->d, p->a[(c + 1) % 3], p->a[(c + 2) % 3]);
        mpz_add(p->det, p->det, p->w[c]);
    }
    triple(p->t, p->a[0], p->a[1], p->a[2]);
}

/* Of at most `bits` bits; half of them are the largest. */
static __int128 draw(struct rng *rng, int bits)
{
    __int128 most = ((__int128)1 << bits) - 1;
    __int128 any = (__int128)rng_u64(rng) << 62 | (__int128)(rng_u64(rng) >> 2);
    __int128 size = rng_below(rng, 2) ? most : any & most;
    return rng_below(rng, 2) ? size : -size;
}

/* Numbers of these bits, the largest among them. */
static void draw_input(struct rng *rng, int place, int way, struct medium_input *out)
{
    *out = (struct medium_input){.place_bits = place, .way_bits = way};
    for (int k = 0; k < 3; k++) {
        out->d[k] = draw(rng, way);
        for (int c = 0; c < 3; c++)
            out->a[c][k] = draw(rng, place);
    }
}

static void set_products(const struct medium_input *in, struct products_gmp *out)
{
    for (int k = 0; k < 3; k++) {
        set_128(out->d[k], in->d[k]);
        for (int c = 0; c < 3; c++)
            set_128(out->a[c][k], in->a[c][k]);
    }
    products_find(out);
}

static void expect_128(__int128 got, const mpz_t want)
{
    struct oracle_wide wide;
    wide_set(got, &wide);
    expect_wide(&wide, want);
}

/* Of numbers below 2^b_p and 2^b_d: |D| is at most 18 times 2^(b_d + 2 b_p), |T| 6 times 2^(3
 * b_p), and what is sure to stay below 2^127 is taken. */
static void small_products_are_taken_as_long_as_they_fit(void **state)
{
    (void)state;
    struct rng rng = rng_make(62, 0);
    struct products_gmp want;
    uint32_t taken = 0, refused = 0;
    products_init(&want);
    for (int place = 0; place <= 61; place++)
        for (int way = 0; way <= 60; way++)
            for (int n = 0; n < 4; n++) {
                struct medium_input in;
                struct small small = {.place_bits = place, .way_bits = way};
                struct small_products got;
                draw_input(&rng, place, way, &in);
                for (int k = 0; k < 3; k++) {
                    small.d[k] = (int64_t)in.d[k];
                    for (int c = 0; c < 3; c++)
                        small.a[c][k] = (int64_t)in.a[c][k];
                }
                bool fits = ldexp(18, way + 2 * place) < 0x1p127 && ldexp(6, 3 * place) < 0x1p127;
                assert_int_equal(small_multiply(&small, &got), fits);
                taken += fits;
                refused += !fits;
                if (!fits)
                    continue;
                set_products(&in, &want);
                for (int c = 0; c < 3; c++)
                    expect_128(got.w[c], want.w[c]);
                expect_128(got.det, want.det);
                expect_128(got.t, want.t);
            }
    products_clear(&want);
    assert_true(taken > 1000 && refused > 1000);
}

static void expect_medium(const struct medium *got, const mpz_t want)
{
    struct oracle_wide wide;
    medium_wide(got, &wide);
    expect_wide(&wide, want);
    assert_int_equal(medium_sign(got), mpz_sgn(want));
}

/* The same in 320 bits: products of numbers of 314 bits together, with a sign and five for sums. */
static void medium_products_are_taken_as_long_as_they_fit(void **state)
{
    (void)state;
    struct rng rng = rng_make(63, 0);
    struct products_gmp want;
    uint32_t taken = 0, refused = 0;
    products_init(&want);
    for (int place = 0; place <= 126; place++)
        for (int way = 0; way <= 126; way += way < 100 && place < 90 ? 5 : 1) {
            struct medium_input in;
            struct medium_products got;
            draw_input(&rng, place, way, &in);
            bool fits = way + place + place <= 314 && place + place + place <= 314;
            assert_int_equal(medium_multiply(&in, &got), fits);
            taken += fits;
            refused += !fits;
            if (!fits)
                continue;
            set_products(&in, &want);
            for (int c = 0; c < 3; c++)
                expect_medium(&got.w[c], want.w[c]);
            expect_medium(&got.det, want.det);
            expect_medium(&got.t, want.t);
        }
    products_clear(&want);
    assert_true(taken > 1000 && refused > 1000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wide_numbers_are_whole_numbers),
        cmocka_unit_test(small_products_are_taken_as_long_as_they_fit),
        cmocka_unit_test(medium_products_are_taken_as_long_as_they_fit),
    };
    return cmocka_run_group_tests_name("oracle_integers", tests, NULL, NULL);
}
