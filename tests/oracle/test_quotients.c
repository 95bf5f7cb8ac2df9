/* Quotients with one divisor against all divisors and numerators, one by one: small multiples of a
 * power of two, with which everything is exact. */
#include "ref/base/base.h"
#include "ref/base/rng.h"
#include "ref/twin/quotients.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define MOST 64

/* All numbers of a scatter. */
struct quotients_numbers {
    double value[MOST];
    int count;
};

static struct quotients_numbers numbers_of(const struct scatter *s)
{
    struct quotients_numbers out = {.count = s->count};
    for (int i = 0; i < s->count; i++)
        out.value[i] = s->value[i];
    if (s->count)
        return out;
    double step = ldexp(1, s->grid);
    for (double x = ceil(s->lo / step) * step; x <= s->hi; x += step) {
        assert_true(out.count < MOST);
        out.value[out.count++] = x;
    }
    return out;
}

static double low_of(const struct quotients *s, int part)
{
    return s->part[part].lo - s->share * fabs(s->part[part].lo) - s->tiny;
}

static double high_of(const struct quotients *s, int part)
{
    return s->part[part].hi + s->share * fabs(s->part[part].hi) + s->tiny;
}

/* The definition: some divisor of the sign, over `above`, and for each part a numerator within. */
static bool fits(const struct quotients *s, int sign)
{
    struct quotients_numbers divisors = numbers_of(&s->divisor);
    for (int i = 0; i < divisors.count; i++) {
        double d = divisors.value[i] * sign;
        if (d <= 0 || d <= s->above)
            continue;
        bool all =
            (low_of(s, 0) - s->mean_hi) * d <= s->pad && (s->mean_lo - high_of(s, 0)) * d <= s->pad;
        for (int p = 0; p < s->parts && all; p++) {
            struct quotients_numbers n = numbers_of(&s->part[p].number);
            bool some = false;
            for (int j = 0; j < n.count; j++)
                some = some || (n.value[j] * sign >= low_of(s, p) * d &&
                                n.value[j] * sign <= high_of(s, p) * d);
            all = some;
        }
        if (all)
            return true;
    }
    return false;
}

/* Listed, or by bounds; multiples of 2^grid. */
static struct scatter draw(struct rng *rng, int range, int grid)
{
    int count = (int)rng_below(rng, 4);
    double first = ldexp((double)rng_below(rng, 2 * (uint32_t)range + 1) - range, grid);
    struct scatter out = scatter_single(first);
    for (int i = 1; i < count; i++) {
        double next = ldexp((double)rng_below(rng, 2 * (uint32_t)range + 1) - range, grid);
        struct scatter one = scatter_single(next);
        out = scatter_either(&out, &one);
    }
    if (count)
        return out;
    double width = ldexp((double)rng_below(rng, 12), grid - 1); /* ends between multiples, too */
    return (struct scatter){.lo = first, .hi = first + width, .grid = grid};
}

static struct quotients draw_all(struct rng *rng)
{
    static const double shares[] = {0, 0.125, 0.25}, tinies[] = {0, 0.0625, 0.5};
    int grid = (int)rng_below(rng, 3) - 1;
    struct quotients s = {.divisor = draw(rng, 8, grid),
                          .parts = 1 + (int)rng_below(rng, 3),
                          .share = shares[rng_below(rng, 3)],
                          .tiny = tinies[rng_below(rng, 3)],
                          .mean_lo = -INFINITY,
                          .mean_hi = INFINITY,
                          .pad = INFINITY};
    if (rng_below(rng, 3) == 0) /* between multiples: a bound may keep its end */
        s.above = ldexp((double)rng_below(rng, 5) + 0.5, grid);
    for (int p = 0; p < s.parts; p++) {
        s.part[p].number = draw(rng, 12, (int)rng_below(rng, 3) - 1);
        s.part[p].lo = ((double)rng_below(rng, 65) - 32) / 8;
        if (rng_below(rng, 3) && s.divisor.hi != 0) /* near a quotient */
            s.part[p].lo = floor(s.part[p].number.lo / s.divisor.hi * 8) / 8;
        s.part[p].hi = s.part[p].lo + (double)rng_below(rng, 5) / 8;
    }
    if (rng_below(rng, 2)) {
        s.mean_lo = ((double)rng_below(rng, 65) - 32) / 8;
        s.mean_hi = s.mean_lo + (double)rng_below(rng, 9) / 8;
        s.pad = (double)rng_below(rng, 5) / 4;
    }
    return s;
}

static void divisors_and_numerators_one_by_one(void **state)
{
    (void)state;
    struct rng rng = rng_make(4, 7);
    size_t fitting = 0, refused = 0;
    for (int round = 0; round < 150000; round++) {
        struct quotients s = draw_all(&rng);
        bool up = fits(&s, 1), down = fits(&s, -1);
        assert_int_equal(quotients_fit(&s, false), up);
        assert_int_equal(quotients_fit(&s, true), down);
        assert_int_equal(quotients_fit_either(&s), up || down);
        fitting += up || down;
        refused += !up && !down;
    }
    print_message("%zu fit, %zu do not\n", fitting, refused);
    assert_true(fitting > 20000 && refused > 20000);
}

/* No multiple of 8 over a whole number is the answer, which shows only where 4097 are tried. */
static void divisors_are_tried_while_they_are_few(void **state)
{
    (void)state;
    for (int few = 0; few < 2; few++) {
        double most = few ? 4097 : 4098;
        struct quotients s = {.divisor = {.lo = 1, .hi = most, .grid = 0},
                              .parts = 1,
                              .mean_lo = -INFINITY,
                              .mean_hi = INFINITY,
                              .pad = INFINITY};
        s.part[0].number = (struct scatter){.lo = 0.5, .hi = 3000, .grid = 3};
        s.part[0].lo = s.part[0].hi = 0.7314159;
        assert_int_equal(quotients_fit(&s, false), !few);
        assert_false(quotients_fit(&s, true));
        s.divisor.lo = -most;
        s.divisor.hi = -1;
        s.part[0].number.lo = -3000;
        s.part[0].number.hi = -0.5;
        assert_int_equal(quotients_fit(&s, true), !few);
        assert_false(quotients_fit(&s, false));
    }
}

/* A quotient may be off by 2^-40 for the roundings of the double, and no more. */
static void quotients_are_as_sharp_as_doubles(void **state)
{
    (void)state;
    for (int n = -50; n <= 50; n++)
        for (int d = 1; d <= 50; d++)
            for (int listed = 0; listed < 2; listed++) {
                struct quotients s = {.divisor = scatter_single(d),
                                      .parts = 1,
                                      .mean_lo = -INFINITY,
                                      .mean_hi = INFINITY,
                                      .pad = INFINITY};
                static const double off[] = {0, 0x1p-42, -0x1p-42, 0x1.4p-40, -0x1.4p-40};
                s.part[0].number = scatter_single(n);
                if (!listed)
                    s.part[0].number = (struct scatter){.lo = n, .hi = n, .grid = 0};
                for (int i = 0; i < 5; i++) {
                    s.part[0].lo = s.part[0].hi = (double)n / d * (1 + off[i]);
                    assert_int_equal(quotients_fit(&s, false), i < 3 || n == 0);
                }
            }
}

/* Of millions of divisors a part leaves those between two quotients: 4097 of them are tried, and
 * none fits; of more it is not known. */
static void parts_leave_few_divisors(void **state)
{
    (void)state;
    const double answer = 0.7314159;
    for (int sign = -1; sign <= 1; sign += 2)
        for (int part = 0; part < 3; part++)
            for (int few = 0; few < 2; few++) {
                double from = (5000 - 0.5) * answer, to = (few ? 9096.5 : 9097.5) * answer;
                struct quotients s = {.divisor = {.lo = -0x1p30, .hi = 0x1p30, .grid = 0},
                                      .parts = 3,
                                      .mean_lo = -INFINITY,
                                      .mean_hi = INFINITY,
                                      .pad = INFINITY};
                for (int i = 0; i < 3; i++) { /* the others say nothing */
                    s.part[i].number = (struct scatter){.lo = -0x1p40, .hi = 0x1p40, .grid = -20};
                    s.part[i].lo = -1;
                    s.part[i].hi = 1;
                }
                s.part[part].lo = s.part[part].hi = sign * answer;
                s.part[part].number = (struct scatter){
                    .lo = sign > 0 ? from : -to, .hi = sign > 0 ? to : -from, .grid = 3};
                assert_int_equal(quotients_fit(&s, false), !few);
                s.part[part].lo = s.part[part].hi = 0; /* times anything is 0 */
                assert_false(quotients_fit(&s, false));
            }
}

/* The mean leaves divisors up to pad / 0.5 = 4097, or more. */
static void means_leave_few_divisors(void **state)
{
    (void)state;
    for (int high = 0; high < 2; high++)
        for (int few = 0; few < 2; few++) {
            struct quotients s = {.divisor = {.lo = 1, .hi = 0x1p30, .grid = 0},
                                  .parts = 1,
                                  .mean_lo = high ? 1.2314159 : -8,
                                  .mean_hi = high ? 8 : 0.2314159,
                                  .pad = (few ? 4097.5 : 4098.5) / 2};
            s.part[0].number = (struct scatter){.lo = 0.5, .hi = 0x1p40, .grid = 3};
            s.part[0].lo = s.part[0].hi = 0.7314159;
            assert_int_equal(quotients_fit(&s, false), !few);
        }
}

/* Of estimated divisions nothing is promised for divisors below 2^-125 or above 2^125. */
static void nothing_is_promised_of_extreme_divisors(void **state)
{
    (void)state;
    static const double divisors[] = {0x1p-125,       0x1p125,  1,      0x1.fffffep-126,
                                      0x1.000002p125, 0x1p-149, 0x1p127};
    for (int sign = -1; sign <= 1; sign += 2)
        for (int estimated = 0; estimated < 2; estimated++)
            for (size_t i = 0; i < ARRAY_COUNT(divisors); i++) {
                struct quotients s = {.divisor = scatter_single(sign * divisors[i]),
                                      .parts = 1,
                                      .estimated = estimated,
                                      .mean_lo = -INFINITY,
                                      .mean_hi = INFINITY,
                                      .pad = INFINITY};
                s.part[0].number = scatter_single(sign * divisors[i]);
                s.part[0].lo = s.part[0].hi = 2; /* 1 in truth */
                assert_int_equal(quotients_fit(&s, sign < 0), estimated && i >= 3);
                assert_false(quotients_fit(&s, sign > 0));
                s.part[0].lo = s.part[0].hi = 1;
                assert_true(quotients_fit(&s, sign < 0));
            }
}

static void no_divisor_is_of_no_sign(void **state)
{
    (void)state;
    struct quotients s = {.divisor = {.lo = -0x1p-126, .hi = 0, .grid = -149},
                          .parts = 1,
                          .estimated = true,
                          .mean_lo = -INFINITY,
                          .mean_hi = INFINITY,
                          .pad = INFINITY};
    s.part[0].number = scatter_single(1);
    assert_false(quotients_fit(&s, false));
    assert_true(quotients_fit(&s, true));
    s.divisor = scatter_single(0);
    assert_false(quotients_fit_either(&s));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(divisors_and_numerators_one_by_one),
        cmocka_unit_test(divisors_are_tried_while_they_are_few),
        cmocka_unit_test(quotients_are_as_sharp_as_doubles),
        cmocka_unit_test(parts_leave_few_divisors),
        cmocka_unit_test(means_leave_few_divisors),
        cmocka_unit_test(no_divisor_is_of_no_sign),
        cmocka_unit_test(nothing_is_promised_of_extreme_divisors),
    };
    return cmocka_run_group_tests_name("quotients", tests, NULL, NULL) ? 1 : 0;
}
