/* What goes into the oracle's integers of 128 bits (ref/oracle/small.h): the vertices from the
 * origin and the direction, each in units of the lowest bit of any, to the bit, with the number of
 * bits that they take; numbers that need more than 60 are refused, and none else. */
#include "ref/base/base.h"
#include "ref/base/rng.h"
#include "ref/oracle/small.h"

#include <math.h>
#include <stdlib.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

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

static int bits_of(uint64_t x)
{
    int bits = 0;
    for (; x; x /= 2)
        bits++;
    return bits;
}

/* Around 2^middle, within `spread` powers; some are 0, some have few bits. */
static float draw_float(struct rng *rng, int middle, uint32_t spread)
{
    float x = ldexpf(1 + rng_float(rng), middle + (int)rng_below(rng, spread + 1));
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
    assert_int_equal(small.place_bits, bits_of(place_size));
    assert_int_equal(small.way_bits, bits_of(way_size));
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
    const struct CMUnitTest tests[] = {cmocka_unit_test(small_grid_is_exact)};
    return cmocka_run_group_tests_name("oracle_small", tests, NULL, NULL);
}
