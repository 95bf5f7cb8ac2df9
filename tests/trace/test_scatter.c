/* Scatters against all results that are legal, by rational numbers: none is left out, and nothing
 * is in a scatter that no rounding gives. */
#include "tests/trace/scatter_cases.h"
#include "tests/trace/scatter_truth.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define NORMAL 0x1p-126
#define LEAST  0x1p-149
#define UNIT   0x1p-24

static const struct liberty liberties[] = {
    {{1.0, 1.0, 1.0, LEAST}, false},  {{1.0, 1.0, 1.0, NORMAL}, false},
    {{1.0, 1.0, 5.5, NORMAL}, false}, {{2.0, 2.0, 5.0, NORMAL}, false},
    {{1.0, 1.0, 5.0, NORMAL}, true},  {{2.0, 2.0, 5.0, NORMAL}, true},
    {{2.0, 1.0, 1.0, LEAST}, true},   {{1.0, 2.0, 2.5, LEAST}, false},
    {{3.0, 3.0, 3.0, LEAST}, false},
};
#define LIBERTIES (int)(sizeof liberties / sizeof *liberties)

/* Ends of ranges, and numbers whose sums, products and quotients are ties, exact, or neither. */
static const float numbers[] = {
    0.0f,
    1.0f,
    0x1.000002p0f,
    0x1.fffffep0f,
    3.0f,
    0.1f,
    -0.1f,
    -1.0f,
    -1.5f,
    0x1p-24f,
    0x1.8p-24f,
    0x1p-25f,
    0x1p-126f,
    -0x1p-126f,
    0x1.000002p-126f,
    0x1.fffffcp-127f,
    0x1p-149f,
    -0x1p-149f,
    0x1.8p-148f,
    0x1p-125f,
    0x1p125f,
    0x1.fffffep125f,
    0x1p64f,
    -0x1.234568p63f,
    0x1p-63f,
    0x1.8p-63f,
    -0x1.fffffep126f,
    0x1p127f,
    0x1.fffffep127f,
    16777215.0f,
};
#define NUMBERS (int)(sizeof numbers / sizeof *numbers)

static struct scatter apply(const struct liberty *k, enum scatter_op op, const struct scatter *a,
                            const struct scatter *b)
{
    return op == SCATTER_ADD   ? scatter_add(k, a, b)
           : op == SCATTER_SUB ? scatter_sub(k, a, b)
           : op == SCATTER_MUL ? scatter_mul(k, a, b)
                               : scatter_div(k, a, b);
}

static double relative_of(const struct liberty *k, enum scatter_op op)
{
    return op == SCATTER_DIV   ? k->rounding.div
           : op == SCATTER_MUL ? k->rounding.mul
                               : k->rounding.add;
}

/* The exponent of the lowest bit that is set; of 0 SCATTER_ZERO. */
static int lowest_of(double x)
{
    uint64_t bits;
    int exponent;
    if (x == 0.0)
        return SCATTER_ZERO;
    x = frexp(x, &exponent); /* of 53 bits the implied one is the highest */
    memcpy(&bits, &x, sizeof bits);
    return exponent - 53 + __builtin_ctzll(bits | 1ull << 52);
}

static int lowest_of_all(const struct scatter *a)
{
    int least = SCATTER_ZERO;
    for (int i = 0; i < a->count; i++)
        least = lowest_of(a->value[i]) < least ? lowest_of(a->value[i]) : least;
    return least;
}

static void assert_unknown(const struct scatter *s)
{
    assert_true(s->lo == -INFINITY && s->hi == INFINITY);
    assert_int_equal(s->grid, -149);
    assert_int_equal(s->count, 0);
}

static void assert_zero(const struct scatter *s)
{
    assert_true(s->lo == 0.0 && s->hi == 0.0 && s->count == 1 && s->value[0] == 0.0);
    assert_int_equal(s->grid, SCATTER_ZERO);
    assert_true(scatter_is_zero(s));
}

/* Every multiple that may be the result, and no finer than a float32 of that size is. */
static void assert_grid(const struct liberty *k, enum scatter_op op, const struct scatter *a,
                        const struct scatter *b, const struct scatter *got)
{
    int x = lowest_of_all(a), y = lowest_of_all(b), exponent;
    int grid = op == SCATTER_DIV ? -149 : op == SCATTER_MUL ? x + y : x < y ? x : y;
    if (op == SCATTER_MUL && k->fuses) {
        assert_int_equal(got->grid, grid);
        return;
    }
    if (grid < -149)
        grid = -149;
    double least = got->lo > 0.0 ? got->lo : got->hi < 0.0 ? -got->hi : 0.0;
    (void)frexp(least, &exponent);
    if (least > NORMAL && exponent - 24 > grid)
        grid = exponent - 24;
    assert_int_equal(got->grid, grid);
}

/* Bounds where no numbers are listed: as far as one rounding goes, and no further. */
static void assert_bounds(const struct liberty *k, enum scatter_op op,
                          const struct scatter_truth *t, const struct scatter *got)
{
    bool flushes = k->rounding.tiny > LEAST, sum = op == SCATTER_ADD || op == SCATTER_SUB;
    double slip = relative_of(k, op) * UNIT;
    bool low = t->lo - slip * fabs(t->lo) < NORMAL && t->hi + slip * fabs(t->hi) > -NORMAL;
    double tiny = low && (!sum || k->fuses) ? LEAST : 0.0;
    double lo[2], hi[2]; /* as far as must be, as far as may be */
    for (int i = 0; i < 2; i++) {
        double more = i ? 1.0 + 0x1p-37 : 1.0 - 0x1p-40, beside = i ? 0x1p-51 : 0.0;
        lo[i] = t->lo - slip * more * fabs(t->lo) - beside * fabs(t->lo) - tiny;
        hi[i] = t->hi + slip * more * fabs(t->hi) + beside * fabs(t->hi) + tiny;
        lo[i] = t->lo >= 0.0 ? fmax(lo[i], 0.0) : lo[i];
        hi[i] = t->hi <= 0.0 ? fmin(hi[i], 0.0) : hi[i];
        lo[i] = low && flushes ? fmin(lo[i], 0.0) : lo[i];
        hi[i] = low && flushes ? fmax(hi[i], 0.0) : hi[i];
    }
    if (!(got->lo <= lo[0] && got->lo >= lo[1] && got->hi >= hi[0] && got->hi <= hi[1]))
        fail_msg("bounds %a %a, expected from %a %a to %a %a", got->lo, got->hi, lo[0], hi[0],
                 lo[1], hi[1]);
}

static bool is_subnormal(double x)
{
    return x != 0.0 && fabs(x) < NORMAL;
}

/* True if results are listed one by one. */
static bool is_listed(const struct liberty *k, enum scatter_op op, const struct scatter *a,
                      const struct scatter *b, const struct scatter_truth *t)
{
    bool flushes = k->rounding.tiny > LEAST;
    if (op == SCATTER_DIV)
        return relative_of(k, op) <= 1.0 && a->count == 1 && b->count == 1 && !t->small &&
               !(flushes && (is_subnormal(a->value[0]) || is_subnormal(b->value[0])));
    return relative_of(k, op) <= 2.0 && !t->small && t->count <= SCATTER_MOST;
}

static void compare(const struct liberty *k, enum scatter_op op, const struct scatter *a,
                    const struct scatter *b)
{
    static struct scatter_truth t;
    struct scatter got = apply(k, op, a, b);
    scatter_truth_make(k, op, a, b, &t);
    if (op == SCATTER_DIV) {
        double least = fmin(fabs(b->lo), fabs(b->hi)), most = fmax(fabs(b->lo), fabs(b->hi));
        t.beyond = t.beyond || b->lo * b->hi <= 0.0 ||
                   (k->rounding.div > 1.0 && (least < 0x1p-125 || most > 0x1p125));
    }
    bool zero = op == SCATTER_MUL ? scatter_is_zero(a) || scatter_is_zero(b)
                                  : t.count == 1 && t.value[0] == 0.0 && !t.small;
    if (zero && !(op == SCATTER_DIV && t.beyond)) {
        assert_zero(&got);
        return;
    }
    if (t.beyond || -t.value[0] >= (double)FLT_MAX || t.value[t.count - 1] >= (double)FLT_MAX) {
        assert_unknown(&got);
        return;
    }
    for (int i = 0; i < t.count; i++)
        if (!(t.value[i] >= got.lo && t.value[i] <= got.hi && lowest_of(t.value[i]) >= got.grid))
            fail_msg("%d: %a is not in %a %a, multiples of 2^%d; add %g mul %g div %g", (int)op,
                     t.value[i], got.lo, got.hi, got.grid, k->rounding.add, k->rounding.mul,
                     k->rounding.div);
    assert_grid(k, op, a, b, &got);
    if (!is_listed(k, op, a, b, &t)) {
        if (fmax(-t.lo, t.hi) * (1.0 + relative_of(k, op) * UNIT) >= (double)FLT_MAX) {
            assert_unknown(&got);
            return;
        }
        assert_int_equal(got.count, 0);
        assert_bounds(k, op, &t, &got);
        return;
    }
    if (got.count != t.count)
        fail_msg("%d numbers are listed, %d are legal", got.count, t.count);
    assert_memory_equal(got.value, t.value, sizeof *t.value * (size_t)t.count);
    assert_true(got.lo == t.value[0] && got.hi == t.value[t.count - 1]);
}

static void results_of_two_numbers_are_those_that_are_legal(void **state)
{
    (void)state;
    for (int l = 0; l < LIBERTIES; l++)
        for (int op = 0; op < SCATTER_OPS; op++)
            for (int i = 0; i < NUMBERS; i++)
                for (int j = 0; j < NUMBERS; j++) {
                    struct scatter a = scatter_of(numbers[i]), b = scatter_of(numbers[j]);
                    compare(&liberties[l], (enum scatter_op)op, &a, &b);
                }
}

static void results_of_lists_are_those_that_are_legal(void **state)
{
    (void)state;
    struct rng rng = rng_make(15, 0);
    for (int i = 0; i < 20000; i++) {
        struct scatter a = drawn_list(&rng), b = drawn_list(&rng);
        compare(&liberties[i % LIBERTIES], (enum scatter_op)(i / LIBERTIES % SCATTER_OPS), &a, &b);
    }
}

/* Sums of what a fused operation has not rounded: rounded once, also beside a tie that has more
 * bits than a double. */
static void sums_of_products_are_rounded_once(void **state)
{
    (void)state;
    struct rng rng = rng_make(18, 0);
    for (int i = 0; i < 4000; i++) {
        const struct liberty *k = &liberties[4 + i % 3];
        float step = 0x1p-20f * (float)(1 + rng_below(&rng, 3)), one = i % 2 ? 1.0f : -1.0f;
        struct scatter a = scatter_of(one + step), b = scatter_of((one - step) * 0x1p-24f);
        struct scatter c = scatter_of(1.0f + 0x1p-23f * (float)rng_below(&rng, 8));
        struct scatter product = scatter_mul(k, &a, &b);
        compare(k, i % 5 ? SCATTER_ADD : SCATTER_SUB, &product, &c);
        compare(k, i % 5 ? SCATTER_SUB : SCATTER_ADD, &c, &product);
        a = drawn_list(&rng), b = drawn_list(&rng), c = drawn_list(&rng);
        product = scatter_mul(k, &a, &b);
        if (product.count)
            compare(k, SCATTER_ADD, &c, &product);
    }
}

static void compare_ranges(const struct liberty *k, enum scatter_op op, const struct scatter *a,
                           const struct scatter *b)
{
    static struct scatter_truth t;
    struct scatter x = range_of(a), y = range_of(b), got = apply(k, op, &x, &y);
    scatter_truth_make(k, op, a, b, &t); /* of the ends, which have the extremes */
    bool divided = op == SCATTER_DIV;
    double least = fmin(fabs(b->lo), fabs(b->hi)), most = fmax(fabs(b->lo), fabs(b->hi));
    if ((divided && (t.beyond || b->lo * b->hi <= 0.0)) ||
        (divided && k->rounding.div > 1.0 && (least < 0x1p-125 || most > 0x1p125)) ||
        fmax(-t.lo, t.hi) * (1.0 + relative_of(k, op) * UNIT) >= (double)FLT_MAX) {
        assert_unknown(&got);
        return;
    }
    if (t.lo == 0.0 && t.hi == 0.0) {
        assert_zero(&got);
        return;
    }
    assert_int_equal(got.count, 0);
    assert_grid(k, op, a, b, &got);
    assert_bounds(k, op, &t, &got);
}

static void results_of_ranges_are_as_far_as_their_ends_are(void **state)
{
    (void)state;
    struct rng rng = rng_make(16, 0);
    for (int i = 0; i < 30000; i++) {
        struct scatter pair[2];
        for (int p = 0; p < 2; p++) {
            float x = rng_below(&rng, 3) ? drawn(&rng) : numbers[rng_below(&rng, NUMBERS)];
            float y = rng_below(&rng, 3) ? drawn(&rng) : numbers[rng_below(&rng, NUMBERS)];
            struct scatter other = scatter_of(y);
            pair[p] = scatter_of(x);
            pair[p] = scatter_either(&pair[p], &other);
        }
        compare_ranges(&liberties[i % LIBERTIES], (enum scatter_op)(i / LIBERTIES % SCATTER_OPS),
                       &pair[0], &pair[1]);
    }
}

/* 0 times what is not known is 0; all else of it is not known. */
static void of_the_unknown_nothing_is_known(void **state)
{
    (void)state;
    const struct scatter unknown = {.lo = -INFINITY, .hi = INFINITY, .grid = -149};
    const struct scatter upward = {.lo = 1.0, .hi = INFINITY, .grid = -149};
    const struct scatter zero = scatter_of(0.0f), one = scatter_of(1.0f);
    for (int l = 0; l < LIBERTIES; l++)
        for (int op = 0; op < SCATTER_OPS; op++)
            for (int swapped = 0; swapped < 2; swapped++) {
                const struct scatter *of[] = {&unknown, &upward, &zero, &one};
                for (int i = 0; i < 8; i++) {
                    const struct scatter *a = of[i % 2], *b = of[i / 2];
                    struct scatter got =
                        apply(&liberties[l], (enum scatter_op)op, swapped ? b : a, swapped ? a : b);
                    if (op == SCATTER_MUL && b == &zero)
                        assert_zero(&got);
                    else
                        assert_unknown(&got);
                }
            }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(results_of_two_numbers_are_those_that_are_legal),
        cmocka_unit_test(results_of_lists_are_those_that_are_legal),
        cmocka_unit_test(sums_of_products_are_rounded_once),
        cmocka_unit_test(results_of_ranges_are_as_far_as_their_ends_are),
        cmocka_unit_test(of_the_unknown_nothing_is_known),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
