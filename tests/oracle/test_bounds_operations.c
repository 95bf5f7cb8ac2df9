/* How much slack the constants of single operations have, where no other rounding helps out: each
 * is turned, alone, until an operation that the rounding allows leaves its bound. Prints the
 * tables; fails if that happens with the constant as it is, or if the search cannot break it. */
static struct {
    double slack, largest, normal, divisor_least, divisor_most;
} turned;
#define TWIN_TURNED
#define SLACK         turned.slack
#define LARGEST       turned.largest
#define NORMAL        turned.normal
#define DIVISOR_LEAST turned.divisor_least
#define DIVISOR_MOST  turned.divisor_most
#include "ref/twin/twin.c"

#include "tests/exact/legal.h"

#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

static void turn_back(void)
{
    turned.slack = 1.0 + 0x1p-20;
    turned.largest = 0x1.fffffap127;
    turned.normal = 0x1.001p-126;
    turned.divisor_least = 0x1p-125;
    turned.divisor_most = 0x1p125;
}

static uint64_t trials(void)
{
    return getenv("RAYDIFF_SLOW") ? 4000000 : 400000;
}

enum operation { OP_ADD, OP_MUL, OP_DIV, OPERATIONS };

struct operations_sample {
    enum operation op;
    float a, b;
    uint32_t choice;
};

static struct bounded bound_of(const struct rounding *k, const struct operations_sample *s)
{
    const struct rules rules = rules_of(k);
    struct bounded a = exact(s->a), b = exact(s->b);
    return s->op == OP_ADD   ? add(&rules, a, b)
           : s->op == OP_MUL ? mul(&rules, a, b)
                             : divide(&rules, a, b);
}

static float legally(const struct rounding *k, const struct operations_sample *s)
{
    struct legal l = {.rounding = *k, .style = LEGAL_CHOSEN};
    l.choice[0] = (uint8_t)s->choice;
    return s->op == OP_ADD   ? legal_add(&l, s->a, s->b)
           : s->op == OP_MUL ? legal_mul(&l, s->a, s->b)
                             : legal_div(&l, s->a, s->b);
}

/* |result - exact|. Sums and products of the samples are exact in double; of a quotient the rest
 * is.
 */
static double error_of(const struct operations_sample *s, float result)
{
    double a = (double)s->a, b = (double)s->b, r = (double)result;
    if (s->op == OP_DIV)
        return fabs(fma(r, b, -a) / b);
    return fabs(r - (s->op == OP_ADD ? a + b : a * b));
}

/* Leaves the result its bound? */
static bool broken(const struct rounding *legal, const struct rounding *bound,
                   const struct operations_sample *s)
{
    double e = bound_of(bound, s).e;
    float result = legally(legal, s);
    return isfinite(e) && !(error_of(s, result) <= e);
}

static float significand(struct rng *rng)
{
    /* Often just above 1, where results just above 1 have the largest share of error. */
    uint32_t bits = rng_below(rng, 2) ? 12 : 23;
    return 1 + (float)rng_below(rng, 1u << bits) * 0x1p-23f;
}

static struct operations_sample draw(struct rng *rng, enum operation op)
{
    struct operations_sample s = {.op = op, .a = significand(rng), .b = significand(rng)};
    if (op == OP_ADD)
        s.b = ldexpf(s.b, -(int)rng_below(rng, 27));
    s.choice = rng_below(rng, 3);
    return s;
}

static void print_held(const char *name, const char *rounding, double chosen, double held,
                       double broke, uint64_t count)
{
    print_message("%-14s %-11s %14.9g %14.9g %14.9g %10llu\n", name, rounding, chosen, held, broke,
                  (unsigned long long)count);
}

static void print_head(void)
{
    print_message("%-14s %-11s %14s %14s %14s %10s\n", "one operation", "rounding", "chosen",
                  "held", "broke", "trials");
}

#define STEPS 200

static const struct {
    const char *name;
    struct rounding rounding;
} roundings[] = {{"ieee", ROUNDING_IEEE},
                 {"vulkan rte", ROUNDING_VULKAN_RTE},
                 {"vulkan", ROUNDING_VULKAN},
                 {"embree", ROUNDING_EMBREE}};

/* k with the constant of one operation times a factor. */
static struct rounding shrunk(struct rounding k, enum operation op, double factor)
{
    *(op == OP_ADD ? &k.add : op == OP_MUL ? &k.mul : &k.div) *= factor;
    return k;
}

static void relative_constants_have_this_much_slack(void **state)
{
    (void)state;
    static const char *const names[OPERATIONS] = {"add", "mul", "div"};
    print_head();
    for (size_t r = 0; r < ARRAY_COUNT(roundings); r++)
        for (enum operation op = 0; op < OPERATIONS; op++) {
            const struct rounding *k = &roundings[r].rounding;
            double proven = op == OP_ADD ? k->add : op == OP_MUL ? k->mul : k->div;
            int steps = STEPS; /* fewest that broke, of STEPS that would leave nothing */
            struct rng rng = rng_make(50 + (uint64_t)op, r);
            for (uint64_t n = 0; n < trials() / 8; n++) {
                struct operations_sample s = draw(&rng, op);
                for (; steps >= 0; steps--) {
                    double factor = 1 - (double)(steps - 1) / STEPS;
                    struct rounding tight = shrunk(*k, op, factor);
                    if (!broken(k, &tight, &s))
                        break;
                }
            }
            print_held(names[op], roundings[r].name, proven,
                       proven * (1 - (double)(steps - 1) / STEPS),
                       proven * (1 - (double)steps / STEPS), trials() / 8);
            assert_true(steps > 0);           /* as it is, it holds */
            assert_true(steps <= STEPS / 10); /* and it is not far too large */
        }
}

/* Results and operands around the least normal number, many of them subnormal. */
static struct operations_sample draw_tiny(struct rng *rng, bool operands)
{
    struct operations_sample s = draw(rng, operands ? (enum operation)rng_below(rng, 2) : OP_MUL);
    s.a = ldexpf(s.a, operands ? -126 - (int)rng_below(rng, 3) : -100);
    s.b = ldexpf(s.b, operands ? (s.op == OP_ADD ? -126 : 30) : -26 - (int)rng_below(rng, 24));
    s.choice = rng_below(rng, 32);
    return s;
}

static void constants_near_zero_have_this_much_slack(void **state)
{
    (void)state;
    static const struct rounding ieee = ROUNDING_IEEE, flushed = ROUNDING_FLUSHED;
    const struct rounding *const both[] = {&ieee, &flushed};
    struct rng rng = rng_make(60, 0);
    print_head();
    for (int f = 0; f < 2; f++) {
        int steps = STEPS;
        for (uint64_t n = 0; n < trials(); n++) {
            struct operations_sample s = draw_tiny(&rng, false);
            for (; steps >= 0; steps--) {
                struct rounding tight = *both[f];
                tight.tiny *= 1 - (double)(steps - 1) / STEPS;
                if (!broken(both[f], &tight, &s))
                    break;
            }
        }
        print_held("tiny", f ? "flushed" : "ieee", both[f]->tiny,
                   both[f]->tiny * (1 - (double)(steps - 1) / STEPS),
                   both[f]->tiny * (1 - (double)steps / STEPS), trials());
        assert_true(steps > 0 && steps < STEPS);
    }
    double broke = 0, held = turned.normal;
    for (uint64_t n = 0; n < trials(); n++) {
        struct operations_sample s = draw_tiny(&rng, true);
        turn_back();
        assert_false(broken(&flushed, &flushed, &s));
        turned.normal = fmax(fabs((double)s.a), broke); /* not below it: taken for normal */
        if (turned.normal < 0x1p-126 && turned.normal > broke && broken(&flushed, &flushed, &s))
            broke = turned.normal;
    }
    turn_back();
    held = broke + 0x1p-149;
    print_held("NORMAL", "flushed", turned.normal, held, broke, trials());
    assert_true(broke > 0x1p-128 && held <= turned.normal);
}

/* --- where the range ends --------------------------------------------------------------------- */

/* In halves of a unit of FLT_MAX's last place, from FLT_MAX on. */
static double from_top(int halves)
{
    return (double)FLT_MAX + halves * 0x1p103;
}

static void largest_has_this_much_slack(void **state)
{
    (void)state;
    int broke = 64;
    struct rng rng = rng_make(61, 0);
    for (uint64_t n = 0; n < trials(); n++) {
        size_t r = rng_below(&rng, ARRAY_COUNT(roundings));
        struct operations_sample s = draw(&rng, (enum operation)rng_below(&rng, 3));
        if (s.op == OP_ADD) {
            s.a = FLT_MAX;
            s.b = ldexpf(s.b, 103 - (int)rng_below(&rng, 4));
        } else { /* a product, or a quotient, near 2^128 */
            s.a = ldexpf(2 - 0x1p-23f * (float)(1 + rng_below(&rng, 4)), 100);
            s.b = 1 + 0x1p-23f * (float)(rng_below(&rng, 4));
            s.b = s.op == OP_MUL ? ldexpf(s.b, 27) : ldexpf(1, -27);
        }
        if (isfinite(legally(&roundings[r].rounding, &s)))
            continue;
        turn_back();
        assert_true(isinf(bound_of(&roundings[r].rounding, &s).e));
        for (turned.largest = from_top(--broke); isfinite(bound_of(&roundings[r].rounding, &s).e);)
            turned.largest = from_top(--broke);
        broke++; /* the least that broke */
    }
    turn_back();
    print_message("LARGEST: chosen FLT_MAX - 2 ulp, held %+.1f ulp, broke %+.1f ulp, of %llu\n",
                  (broke - 1) / 2.0, broke / 2.0, (unsigned long long)trials());
    assert_true(broke > -4 && broke < 64);
}

/* A division as many processors do it, by the rounded reciprocal: of large divisors it is subnormal
 * and may be flushed, of the least ones it overflows. */
static float by_reciprocal(float a, float b)
{
    float inverse = 1 / b;
    return a * (fabsf(inverse) < FLT_MIN ? 0 : inverse);
}

static void divisors_have_this_much_slack(void **state)
{
    (void)state;
    double least = 0, most = INFINITY;
    /* Operands are kept: flushed ones have no bound anyway. */
    static const struct rounding inexact = {2.0, 2.0, 5.0, 0x1p-149};
    struct rng rng = rng_make(62, 0);
    for (uint64_t n = 0; n < trials(); n++) {
        bool low = rng_below(&rng, 2);
        struct operations_sample s = draw(&rng, OP_DIV);
        s.b = ldexpf(s.b, low ? -130 + (int)rng_below(&rng, 6) : 123 + (int)rng_below(&rng, 5));
        s.a = ldexpf(s.a, low ? -40 : 60);
        float result = by_reciprocal(s.a, s.b);
        turn_back();
        double e = bound_of(&inexact, &s).e;
        assert_true(isinf(e) || error_of(&s, result) <= e);
        turned.divisor_least = 0x1p-149;
        turned.divisor_most = (double)FLT_MAX;
        if (error_of(&s, result) <= bound_of(&inexact, &s).e)
            continue;
        if (low)
            least = fmax(least, (double)s.b);
        else
            most = fmin(most, (double)s.b);
    }
    turn_back();
    print_message(
        "DIVISOR_LEAST: chosen 2^-125, broke at 2^%.3f; DIVISOR_MOST: chosen 2^125, broke "
        "at 2^%.3f, of %llu\n",
        log2(least), log2(most), (unsigned long long)trials());
    assert_true(least > 0x1p-130 && least < turned.divisor_least);
    assert_true(most < 0x1p127 && most > turned.divisor_most);
}

/* The factor over every bound: what it covers, the rounding of the bounds themselves in double, is
 * 2^-53 of them, so it breaks just below 1. */
static void slack_has_this_much_slack(void **state)
{
    (void)state;
    double broke = 0;
    struct rng rng = rng_make(63, 0);
    for (uint64_t n = 0; n < trials(); n++) {
        size_t r = rng_below(&rng, ARRAY_COUNT(roundings));
        struct operations_sample s = draw(&rng, (enum operation)rng_below(&rng, 3));
        if (s.op == OP_DIV && rng_below(&rng, 2)) /* a sum that attains its bound but for u^2 */
            s = (struct operations_sample){OP_ADD, 1, ldexpf(1 - 0x1p-24f, -23), LEGAL_LOW};
        const struct rounding *k = &roundings[r].rounding;
        turn_back();
        assert_false(broken(k, k, &s));
        turned.slack = 1;
        double share = error_of(&s, legally(k, &s)) / bound_of(k, &s).e;
        broke = fmax(broke, share);
    }
    turn_back();
    print_message("SLACK: chosen 1 + 2^-20, broke at 1 - 2^%.1f, of %llu\n", log2(1 - broke),
                  (unsigned long long)trials());
    assert_true(broke > 1 - 0x1p-10);
}

int main(void)
{
    turn_back();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(relative_constants_have_this_much_slack),
        cmocka_unit_test(constants_near_zero_have_this_much_slack),
        cmocka_unit_test(largest_has_this_much_slack),
        cmocka_unit_test(divisors_have_this_much_slack),
        cmocka_unit_test(slack_has_this_much_slack),
    };
    return cmocka_run_group_tests_name("bounds_operations", tests, NULL, NULL) ? 1 : 0;
}
