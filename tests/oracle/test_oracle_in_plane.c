/* A ray in a triangle's plane by integers of 128 bits (ref/oracle/small.h) and by GMP rationals: at
 * every size that is taken, and where two ends are closer than doubles tell. And what goes into
 * these integers: vertices from the origin and the direction, each in units of the lowest bit of
 * any, with the number of bits that they take. */
#include "ref/base/base.h"
#include "ref/oracle/exact.h"
#include "ref/oracle/small.h"
#include "ref/base/rng.h"

#include <gmp.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define CASES 60000u

struct plane_overlap {
    bool any;
    mpq_t in, out;
};

static void set_ratio(mpq_t out, const mpz_t num, const mpz_t den)
{
    mpz_set(mpq_numref(out), num);
    mpz_set(mpq_denref(out), den);
    mpq_canonicalize(out);
}

/* a x b in coordinates i, j. */
static void set_side(mpz_t out, const int64_t a[3], const int64_t b[3], int i, int j)
{
    mpz_t left, right;
    mpz_init_set_si(left, a[i]);
    mpz_init_set_si(right, a[j]);
    mpz_mul_si(left, left, b[j]);
    mpz_mul_si(right, right, b[i]);
    mpz_sub(out, left, right);
    mpz_clears(left, right, NULL);
}

static void take(struct plane_overlap *overlap, const mpq_t t)
{
    if (!overlap->any || mpq_cmp(t, overlap->in) < 0)
        mpq_set(overlap->in, t);
    if (!overlap->any || mpq_cmp(t, overlap->out) > 0)
        mpq_set(overlap->out, t);
    overlap->any = true;
}

/* The line's ends in the triangle: where it crosses an edge, at a share of the way from one vertex
 * to the other, and vertices that it meets. */
static void find_overlap(const struct small *small, int i, int j, struct plane_overlap *out)
{
    mpz_t side[3], whole, way;
    mpq_t share, t, edge;
    int along = small->d[i] ? i : j;
    mpz_inits(side[0], side[1], side[2], whole, way, NULL);
    mpq_inits(share, t, edge, NULL);
    mpz_set_si(way, small->d[along]);
    out->any = false;
    for (int c = 0; c < 3; c++)
        set_side(side[c], small->d, small->a[c], i, j);
    for (int c = 0; c < 3; c++) {
        int e = (c + 1) % 3, first = mpz_sgn(side[c]), second = mpz_sgn(side[e]);
        if (first != 0 && first * second >= 0)
            continue;
        mpz_sub(whole, side[c], side[e]);
        if (first == 0)
            mpq_set_si(share, 0, 1);
        else
            set_ratio(share, side[c], whole);
        mpz_set_si(whole, small->a[e][along]);
        mpz_set_si(mpq_numref(t), small->a[c][along]);
        mpz_set_si(mpq_denref(t), 1);
        mpz_sub(whole, whole, mpq_numref(t));
        mpq_set_z(edge, whole);
        mpq_mul(edge, edge, share);
        mpq_add(t, t, edge);
        mpq_set_z(edge, way);
        mpq_div(t, t, edge);
        take(out, t);
    }
    mpz_clears(side[0], side[1], side[2], whole, way, NULL);
    mpq_clears(share, t, edge, NULL);
}

static void set_wide(mpz_t out, const struct oracle_wide *wide)
{
    mpz_import(out, (size_t)wide->count, -1, sizeof wide->limb[0], 0, 0, wide->limb);
    if (wide->sign < 0)
        mpz_neg(out, out);
}

static bool same(const struct fraction *fraction, const mpq_t want)
{
    mpz_t num, den;
    mpq_t got;
    mpz_inits(num, den, NULL);
    mpq_init(got);
    set_wide(num, &fraction->num);
    set_wide(den, &fraction->den);
    bool is = mpz_sgn(den) != 0;
    if (is) {
        set_ratio(got, num, den);
        is = mpq_equal(got, want) != 0;
    }
    mpz_clears(num, den, NULL);
    mpq_clear(got);
    return is;
}

static int64_t draw(struct rng *rng, int bits)
{
    int64_t size = (int64_t)(rng_u64(rng) >> (64 - bits));
    return rng_below(rng, 2) ? size : -size;
}

/* Any triangle and direction in the plane of axes i and j. */
static void draw_any(struct rng *rng, int i, int j, struct small *out)
{
    int place = 1 + (int)rng_below(rng, 60), way = 1 + (int)rng_below(rng, 59);
    out->d[i] = rng_below(rng, 4) ? draw(rng, way) : 0;
    out->d[j] = rng_below(rng, 4) ? draw(rng, way) : 0;
    for (int c = 0; c < 3; c++) {
        out->a[c][i] = draw(rng, place);
        out->a[c][j] = rng_below(rng, 8) ? draw(rng, place) : 0;
    }
}

/* Along axis i through a vertex at p and an edge that it crosses at p + 1 / m or p - 1 / m. */
static void draw_close(struct rng *rng, int i, int j, struct small *out)
{
    int64_t p = draw(rng, 44), u = 1 + draw(rng, 20), v = draw(rng, 20), b = 0, c = 0;
    int64_t old[2] = {1, 0}, now[2] = {0, 1}, x = u = llabs(u) + 1, y = v = llabs(v) + 1;
    while (y) { /* Euclid: old[0] u + old[1] v is x */
        int64_t times = x / y, rest = x % y;
        for (int k = 0; k < 2; k++) {
            int64_t next = old[k] - times * now[k];
            old[k] = now[k];
            now[k] = next;
        }
        x = y;
        y = rest;
    }
    int64_t sign = rng_below(rng, 2) ? 1 : -1;
    c = sign * old[0];
    b = sign * old[1];
    out->d[i] = draw(rng, 22) | 1;
    out->a[0][i] = p;
    out->a[1][i] = p + b;
    out->a[1][j] = -u;
    out->a[2][i] = p + c;
    out->a[2][j] = v;
}

static int bits_of(int64_t x)
{
    return x ? 64 - __builtin_clzll((uint64_t)llabs(x)) : 0;
}

static void measure(struct small *small)
{
    for (int k = 0; k < 3; k++) {
        int way = bits_of(small->d[k]);
        small->way_bits = way > small->way_bits ? way : small->way_bits;
        for (int c = 0; c < 3; c++) {
            int place = bits_of(small->a[c][k]);
            small->place_bits = place > small->place_bits ? place : small->place_bits;
        }
    }
}

static bool has_area(const struct small *small, int i, int j)
{
    int64_t first[3] = {0}, second[3] = {0};
    mpz_t area;
    mpz_init(area);
    for (int k = 0; k < 3; k++) {
        first[k] = small->a[1][k] - small->a[0][k];
        second[k] = small->a[2][k] - small->a[0][k];
    }
    set_side(area, first, second, i, j);
    bool has = mpz_sgn(area) != 0;
    mpz_clear(area);
    return has;
}

static void the_overlap_is_exact(void **state)
{
    (void)state;
    size_t overlaps[2] = {0}, none = 0, refused = 0;
    struct rng rng = rng_make(41, 0);
    struct plane_overlap want;
    mpq_inits(want.in, want.out, NULL);
    for (uint32_t n = 0; n < CASES; n++) {
        int i = (int)rng_below(&rng, 3), j = (i + 1 + (int)rng_below(&rng, 2)) % 3;
        uint32_t kind = n % 2;
        struct small small = {.scale = 0};
        struct fraction in, out;
        bool any;
        if (kind)
            draw_close(&rng, i, j, &small);
        else
            draw_any(&rng, i, j, &small);
        measure(&small);
        if (!has_area(&small, i, j) || (small.d[i] == 0 && small.d[j] == 0))
            continue;
        find_overlap(&small, i, j, &want);
        if (!small_in_plane(&small, &any, &in, &out)) {
            assert_true(2 * small.place_bits + small.way_bits > 122 ||
                        small.place_bits + 2 * small.way_bits > 122);
            refused++;
            continue;
        }
        assert_int_equal(any, want.any);
        if (any && (!same(&in, want.in) || !same(&out, want.out)))
            fail_msg("case %u: another overlap, of %d and %d bits", n, small.place_bits,
                     small.way_bits);
        overlaps[kind] += any;
        none += !any;
    }
    mpq_clears(want.in, want.out, NULL);
    assert_true(overlaps[0] > 1000 && overlaps[1] > 1000 && none > 1000 && refused > 1000);
}

/* The normal is on either side by the order of the vertices: the overlap does not depend on it, in
 * numbers too wide for small integers as well. */
static void either_side_has_the_same_overlap(void **state)
{
    (void)state;
    struct rng rng = rng_make(91, 0);
    size_t met = 0;
    for (uint32_t n = 0; n < 3000; n++) {
        int k = (int)(n % 3), i = (k + 1) % 3, j = (k + 2) % 3;
        float v[3][3] = {{0}}, turned[3][3];
        struct ray ray = {{0}, 0, {0}, INFINITY};
        for (int c = 0; c < 3; c++) {
            v[c][i] = rng_range(&rng, -1, 1);
            v[c][j] = ldexpf(rng_range(&rng, -1, 1), n % 2 ? -60 : 0);
        }
        ray.org[i] = -2;
        ray.dir[i] = 1;
        ray.dir[j] = v[0][j] / 4;
        for (int k2 = 0; k2 < 3; k2++) {
            turned[0][k2] = v[0][k2];
            turned[1][k2] = v[2][k2];
            turned[2][k2] = v[1][k2];
        }
        struct fraction in[2], out[2];
        bool any = exact_in_plane(&ray, v, NULL, &in[0], &out[0]);
        assert_int_equal(exact_in_plane(&ray, turned, NULL, &in[1], &out[1]), any);
        if (!any)
            continue;
        assert_int_equal(fraction_compare(&in[0], &in[1]), 0);
        assert_int_equal(fraction_compare(&out[0], &out[1]), 0);
        met++;
    }
    assert_true(met > 500);
}

/* --- what goes into them -------------------------------------------------------------------- */

/* Of several floats: exponents of the lowest bit of any and of what is above all; both 0 if all
 * are 0. */
struct bit_span {
    int low, high;
    bool any;
};

static void span_add(struct bit_span *span, float x)
{
    int exponent;
    float share = frexpf(x, &exponent);
    if (x == 0)
        return;
    int64_t whole = (int64_t)fabsf(ldexpf(share, 24)), low = exponent - 24;
    for (; whole % 2 == 0; whole /= 2)
        low++;
    if (!span->any || (int)low < span->low)
        span->low = (int)low;
    if (!span->any || exponent > span->high)
        span->high = exponent;
    span->any = true;
}

static int size_in_bits(uint64_t x)
{
    int bits = 0;
    for (; x; x /= 2)
        bits++;
    return bits;
}

/* Around 2^middle, within `spread` powers; some are 0, some have few bits. */
static float draw_float(struct rng *rng, int middle, uint32_t spread)
{
    float x = 1 + rng_float(rng);
    x = ldexpf(x, middle + (int)rng_below(rng, spread + 1));
    if (rng_below(rng, 3) == 0)
        x = float_from_bits(float_bits(x) & ~0u << rng_below(rng, 24));
    x = rng_below(rng, 4) ? x : 0;
    return rng_below(rng, 2) ? x : -x;
}

struct small_tally {
    uint32_t taken, refused, sixty, more;
};

static void expect_small(const struct ray *ray, float v[3][3], struct small_tally *tally)
{
    struct bit_span place = {0}, way = {0};
    struct small small;
    uint64_t place_size = 0, way_size = 0;
    for (int k = 0; k < 3; k++) {
        span_add(&way, ray->dir[k]);
        span_add(&place, ray->org[k]);
        for (int c = 0; c < 3; c++)
            span_add(&place, v[c][k]);
    }
    const int place_bits = place.high - place.low, way_bits = way.high - way.low;
    const bool fits = place_bits <= 60 && way_bits <= 60;
    assert_int_equal(small_make(ray, v, &small), fits);
    tally->taken += fits;
    tally->refused += !fits;
    tally->sixty += fits && (place_bits == 60 || way_bits == 60);
    tally->more += (place_bits == 61 && way_bits <= 60) || (way_bits == 61 && place_bits <= 60);
    if (!fits)
        return;
    assert_int_equal(small.scale, place.low - way.low);
    for (int k = 0; k < 3; k++) {
        assert_true(ldexpl((long double)small.d[k], way.low) == (long double)ray->dir[k]);
        way_size |= (uint64_t)llabs(small.d[k]);
        for (int c = 0; c < 3; c++) {
            assert_true(ldexpl((long double)small.a[c][k], place.low) ==
                        (long double)v[c][k] - (long double)ray->org[k]);
            place_size |= (uint64_t)llabs(small.a[c][k]);
        }
    }
    assert_int_equal(small.place_bits, size_in_bits(place_size));
    assert_int_equal(small.way_bits, size_in_bits(way_size));
}

static void small_grid_is_exact(void **state)
{
    (void)state;
    struct rng rng = rng_make(57, 0);
    struct small_tally tally = {0};
    for (uint32_t n = 0; n < 60000; n++) {
        const uint32_t spread = n % 4 ? 36 + rng_below(&rng, 6) : rng_below(&rng, 90);
        const int low = n % 16 ? (int)rng_below(&rng, 160) - 126 : -149; /* subnormal */
        float v[3][3];
        struct ray ray = {.tmax = 1};
        for (int k = 0; k < 3; k++) {
            ray.org[k] = draw_float(&rng, low, spread < 40 ? 30 : spread);
            ray.dir[k] = draw_float(&rng, low / 2, rng_below(&rng, 3) ? 12 : spread);
            for (int c = 0; c < 3; c++)
                v[c][k] = n % 64 ? draw_float(&rng, low, spread) : 0;
        }
        const int where = (int)rng_below(&rng, 15); /* a lone number matters, wherever it is */
        if (n % 5 == 0)
            for (int i = 0; i < 15; i++) {
                float *x = i < 3 ? &ray.org[i] : i < 6 ? &ray.dir[i - 3] : &v[(i - 6) / 3][i % 3];
                *x = i == where ? draw_float(&rng, low, 90) : i % 2 ? ldexpf(1, low + 20) : 0;
            }
        expect_small(&ray, v, &tally);
    }
    print_message("%u taken, %u of them of 60 bits; %u refused, %u of 61\n", tally.taken,
                  tally.sixty, tally.refused, tally.more);
    assert_true(tally.taken > 10000 && tally.refused > 3000);
    assert_true(tally.sixty > 300 && tally.more > 300);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_overlap_is_exact),
                                       cmocka_unit_test(either_side_has_the_same_overlap),
                                       cmocka_unit_test(small_grid_is_exact)};
    return cmocka_run_group_tests_name("oracle_in_plane", tests, NULL, NULL) ? 1 : 0;
}
