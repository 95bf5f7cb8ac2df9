/* A driver's card by value: the probes are computed here, right or wrong in places that are known
 * (tests/gpu/fake_vulkan.h). */
#include "gpu/card/card.h"
#include "ref/base/half.h"

#include "tests/gpu/fake_work.h"

#include <math.h>

#define TRIPLES 8192u
#define CODES   65536u
#define WORDS   (3 * CODES)

enum fake_probe { OPS, FUNCTIONS, FREE, PACK, LOOP };

/* Result `k` of element `i` of a probe; what is right is in *result. */
static void (*twist)(enum fake_probe probe, uint32_t i, uint32_t k, const float *in, float *result);
static bool fused;                 /* a*b+c is, where it may be */
static uint32_t roots, root_at[2]; /* positive numbers, the first and the last one */
static uint32_t told[3]; /* operands that show something: fma, contraction, distribution */

static bool differ(float a, float b)
{
    return float_bits(a) != float_bits(b);
}

static void compute(enum fake_probe probe, uint32_t i, const float *in, float *result)
{
    const float a = in[0], b = in[1], c = in[2], product = a * b, difference = a - b;
    const float ac = a * c, bc = b * c, once = fmaf(a, b, c), twice = product + c;
    const float right[][7] = {
        {a + b, a - b, a * b, a / b, 1.0f / b, twice, a < b ? a : b},
        {(float)sqrt((double)a), (float)(1.0 / sqrt((double)a)), fused ? once : twice, a, b},
        {fused ? once : twice, difference * c},
    };
    const uint32_t columns[] = {7, 5, 2};
    for (uint32_t k = 0; k < columns[probe]; k++) {
        float x = right[probe][k];
        if (twist)
            twist(probe, i, k, in, &x);
        result[k] = x;
    }
    if (probe == FUNCTIONS && i < 2) /* NaN, then zeros of both signs, in both orders */
        assert_true(isnan(i ? a : b) && (i ? b : a) == 1);
    if (probe == FUNCTIONS && i >= 2 && i < 4)
        assert_true(a == 0 && b == 0 && !signbit(a) == (i == 3) && !signbit(b) == (i == 2));
    if (probe == FUNCTIONS && i >= 4) {
        roots += a > 0;
        root_at[0] = roots == 1 && a > 0 ? i : root_at[0];
        root_at[1] = a > 0 ? i : root_at[1];
        told[0] += differ(once, twice);
        told[1] += differ(once, twice);
        told[2] += differ(difference * c, ac - bc);
    }
}

static void pack_word(uint32_t i, const uint32_t *in, uint32_t *result)
{
    const uint32_t word = in[i], half = half_nearest(float_from_bits(word)).bits;
    float out[3] = {
        float_from_bits(half | half << 16),
        half_to_float((struct half){(uint16_t)word}),
        half_to_float((struct half){(uint16_t)(word >> 16)}),
    };
    for (uint32_t k = 0; k < 3; k++) {
        if (twist)
            twist(PACK, i, k, (const float *)(const void *)&in[i], &out[k]);
        memcpy(&result[3 * i + k], &out[k], 4);
    }
}

static void run_probe(const struct fake_dispatch *dispatch)
{
    const void *in = dispatch->part[0].byte;
    void *out = dispatch->part[1].byte;
    const uint64_t bytes = dispatch->part[0].bytes, result = dispatch->part[1].bytes;
    const uint32_t group = dispatch->constant[0], count = dispatch->push[0];
    assert_int_equal(dispatch->constants, 1);
    if (dispatch->push_bytes == 8) {
        const uint32_t ran[9] = {dispatch->push[0],
                                 0,
                                 7,
                                 dispatch->push[0],
                                 dispatch->push[0],
                                 7,
                                 dispatch->push[0] / dispatch->push[1],
                                 dispatch->push[0],
                                 7};
        memcpy(out, ran, sizeof ran);
        for (uint32_t k = 0; k < 9 && twist; k++)
            twist(LOOP, 0, k, in, (float *)out + k);
        assert_int_equal(dispatch->groups * group, 3);
        return;
    }
    assert_int_equal(dispatch->groups * group, count);
    if (bytes == 4 * WORDS) {
        for (uint32_t i = 0; i < count; i++)
            pack_word(i, in, out);
        return;
    }
    assert_int_equal(bytes, 12 * (uint64_t)count);
    const uint64_t columns = result / count / 4;
    const enum fake_probe probe = columns == 7 ? OPS : columns == 5 ? FUNCTIONS : FREE;
    for (uint32_t i = 0; i < count; i++)
        compute(probe, i, (const float *)in + 3 * i, (float *)out + columns * i);
}

static struct card card_now(void (*how)(enum fake_probe, uint32_t, uint32_t, const float *,
                                        float *))
{
    struct vk_options options = fake_options();
    struct reason reason = {""};
    struct card card;
    struct vk *vk;
    fake_reset();
    fake.run = run_probe;
    twist = how;
    roots = told[0] = told[1] = told[2] = 0;
    gpu_must(vk_open(&options, &vk, &reason), &reason);
    gpu_must(card_make(vk, &card, &reason), &reason);
    assert_int_equal(vk_close(vk, NULL), 0);
    must_be_clean("a card");
    return card;
}

static void must_choose(const struct card_choice *choice, uint32_t plain, uint32_t other,
                        uint32_t neither)
{
    assert_int_equal(choice->telling, plain + other + neither);
    assert_int_equal(choice->plain, plain);
    assert_int_equal(choice->other, other);
    assert_int_equal(choice->neither, neither);
}

static void driver_that_is_right_has_a_clean_card(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        fused = i;
        struct card card = card_now(NULL);
        for (int k = 0; k < PROBE_OPS; k++) {
            assert_int_equal(card.op[k].ordinary, 12288);
            assert_int_equal(card.op[k].special, 4096);
            assert_int_equal(card.op[k].ordinary_differs + card.op[k].special_differs, 0);
            assert_int_equal(card.op[k].worst_ulp + card.op[k].flushed, 0);
        }
        assert_true(card.arithmetic.bits && !card.arithmetic.flushes);
        assert_in_range(roots, 3900, 4300);
        assert_int_equal(card.sqrt.count, roots);
        assert_int_equal(card.inversesqrt.count, roots);
        assert_int_equal(card.sqrt.differs + card.sqrt.worst_ulp, 0);
        assert_int_equal(card.inversesqrt.differs + card.inversesqrt.worst_ulp, 0);
        assert_true(told[0] > 2000 && told[2] > 2000);
        must_choose(&card.fma, i ? 0 : told[0], i ? told[0] : 0, 0);
        must_choose(&card.contraction, i ? 0 : told[1], i ? told[1] : 0, 0);
        must_choose(&card.distribution, told[2], 0, 0);
        assert_int_equal(card.unpack.wrong + card.unpack.flushed + card.unpack.subnormal_wrong, 0);
        assert_int_equal(card.unpack.kept, 2 * 2 * 1023);
        assert_int_equal(card.pack.count, WORDS);
        assert_int_equal(card.pack.differs + card.pack.beyond, 0);
        static const uint32_t loops[] = {100000, 200000, 100000};
        assert_memory_equal(card.loop.asked, loops, sizeof loops);
        assert_memory_equal(card.loop.ran, loops, sizeof loops);
    }
}

static uint32_t at[2]; /* roots that are wrong */

/* The first root and the last one are wrong, some by one place; results of the first four triples
 * are those of min and max alone; one fma is neither, and so is the last free product. */
static void twist_functions(enum fake_probe probe, uint32_t i, uint32_t k, const float *in,
                            float *x)
{
    static const int ulp[2][2] = {{5, 1}, {-1, -7}};
    (void)in;
    if ((probe == FREE && k == 1 && i == TRIPLES - 1) || (probe == FUNCTIONS && k == 2 && i == 4))
        *x = 1e9f;
    if (probe != FUNCTIONS)
        return;
    if (i < 4)
        *x = (float)(10 * i + k);
    for (int end = 0; end < 2 && k < 2; end++)
        if (i == at[end])
            *x = float_from_bits(float_bits(*x) + (uint32_t)ulp[end][k]);
}

static void functions_are_compared_one_by_one(void **state)
{
    (void)state;
    fused = false;
    struct card before = card_now(NULL);
    at[0] = root_at[0];
    at[1] = root_at[1];
    struct card card = card_now(twist_functions);
    assert_int_equal(card.sqrt.count, before.sqrt.count);
    assert_int_equal(card.sqrt.differs, 2);
    assert_int_equal(card.inversesqrt.differs, 2);
    assert_int_equal(card.sqrt.worst_ulp, 5);
    assert_int_equal(card.inversesqrt.worst_ulp, 7);
    assert_int_equal(card.fma.neither, 1);
    assert_int_equal(card.fma.other, 0);
    assert_int_equal(card.distribution.neither, 1);
    assert_int_equal(card.distribution.other, 0);
    assert_int_equal(card.contraction.neither, 0);
    assert_true(card.min.first_nan == 13 && card.min.second_nan == 3);
    assert_true(card.min.minus_plus == 23 && card.min.plus_minus == 33);
    assert_true(card.max.first_nan == 14 && card.max.second_nan == 4);
    assert_true(card.max.minus_plus == 24 && card.max.plus_minus == 34);
    assert_true(card.arithmetic.bits);
}

/* Of the ordinary sums one is 9 ulps off, and one differs in its sign; the last special product is
 * wrong, and the first one if it is a subnormal. */
static void twist_operators(enum fake_probe probe, uint32_t i, uint32_t k, const float *in,
                            float *x)
{
    (void)in;
    if (probe != OPS)
        return;
    if (k == PROBE_ADD && i == 0)
        *x = float_from_bits(float_bits(*x) + 9);
    if (k == PROBE_SUB && i == 16382)
        *x = float_from_bits(float_bits(*x) - 1);
    if (k == PROBE_MUL && i == 16383)
        *x = 3e33f;
    if (k == PROBE_DIV && (float_bits(*x) & 0x7F800000u) == 0) /* one of either sign */
        *x = 0;
}

static void operators_are_compared_one_by_one(void **state)
{
    (void)state;
    struct card card = card_now(twist_operators);
    static const uint32_t ordinary[PROBE_OPS] = {1, 1}, ulp[PROBE_OPS] = {9, 1};
    for (int k = 0; k < PROBE_OPS; k++) {
        const struct probe_op *op = &card.op[k];
        assert_int_equal(op->ordinary_differs, ordinary[k]);
        assert_int_equal(op->worst_ulp, ulp[k]);
        assert_int_equal(op->flushed, k == PROBE_DIV ? op->special_differs : 0);
        assert_int_equal(op->special_differs > 0, k == PROBE_MUL || k == PROBE_DIV);
    }
    assert_int_equal(card.op[PROBE_MUL].special_differs, 1);
    assert_true(!card.arithmetic.bits && card.arithmetic.flushes);
    assert_true(card.arithmetic.rounding.add == 19 && card.arithmetic.rounding.mul == 1);
}

/* Of the unpacked codes, one of each kind; the lower half alone. */
static void twist_unpacked(enum fake_probe probe, uint32_t i, uint32_t k, const float *in, float *x)
{
    const uint32_t word = float_bits(*in), code = word & 0xFFFFu;
    if (probe != PACK || k != 1 || i >= CODES || word >> 16 != (code ^ 0x8000u))
        return; /* not the second pass */
    switch (code) {
    case 0x0000: /* zero: wrong */
        *x = -0.0f;
        break;
    case 0x0001: /* the first subnormal, and the last one: zero */
    case 0x83FF:
        *x = code & 0x8000u ? -0.0f : 0;
        break;
    case 0x0002: /* a subnormal: wrong */
        *x *= 2;
        break;
    case 0x0400: /* the first normal number, the last one, infinity: wrong */
    case 0xFBFF:
    case 0x7C00:
        *x = 0;
        break;
    case 0x7C01: /* the first NaN: infinity is wrong */
        *x = INFINITY;
        break;
    case 0xFFFF: /* the last one: another NaN is right */
        *x = float_from_bits(0x7F800001u);
        break;
    default:
        break;
    }
}

static void unpacked_halves_are_counted_by_kind(void **state)
{
    (void)state;
    struct card card = card_now(twist_unpacked);
    assert_int_equal(card.unpack.wrong, 5);
    assert_int_equal(card.unpack.flushed, 2);
    assert_int_equal(card.unpack.subnormal_wrong, 1);
    assert_int_equal(card.unpack.kept, 4 * 1023 - 3);
    assert_int_equal(card.pack.differs, 0);
}

static const uint32_t *chosen; /* words, and what both halves of each become */

static void twist_packed(enum fake_probe probe, uint32_t i, uint32_t k, const float *in, float *x)
{
    for (const uint32_t *one = chosen; probe == PACK && k == 0 && i < CODES && one[1]; one += 2)
        if (float_bits(*in) == one[0])
            *x = float_from_bits(one[1]);
}

static void must_pack(const uint32_t *words, const struct card_pack *want)
{
    chosen = words;
    const struct card_pack got = card_now(twist_packed).pack;
    assert_int_equal(got.count, WORDS + want->count);
    assert_int_equal(got.differs, want->differs);
    assert_int_equal(got.beyond, want->beyond);
    assert_int_equal(got.overflow, want->overflow);
    assert_int_equal(got.tiny, want->tiny);
    assert_int_equal(got.normal, want->normal);
    assert_int_equal(float_bits(got.example), float_bits(want->example));
    assert_int_equal(got.example_got, want->example_got);
    assert_int_equal(got.example_nearest, want->example_nearest);
}

/* 65536 is over 65520, 2^-15 is below 2^-14, which is a half itself. The first normal number is the
 * example, else the first that differs. A NaN may become any NaN. */
static void packed_halves_are_counted_by_kind(void **state)
{
    (void)state;
    static const struct {
        uint32_t words[10];
        struct card_pack want; /* more than without; of which, beyond, overflow, tiny, normal */
    } cases[] = {
        {{0x7FC00000u, 0x7E017E01u}, {0}},
        {{0x47800000u, 0x7BFF7BFFu}, {0, 1, 0, 1, 0, 0, 65536, 0x7BFF, 0x7C00}},
        {{0x38000000u, 0x02010201u}, {0, 1, 1, 0, 1, 0, 0x1p-15f, 0x0201, 0x0200}},
        {{0x38000000u, 0x02010201u, 0x38800000u, 0x04010401u, 0x3F800000u, 0x3C013C01u, 0x47800000u,
          0x7BFF7BFFu},
         {0, 4, 3, 1, 1, 2, 0x1p-14f, 0x0401, 0x0400}},
        {{0x3F800000u, 0x3C013C00u}, {1, 1, 1, 0, 0, 1, 1, 0x3C01, 0x3C00}}, /* the upper half */
    };
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++)
        must_pack(cases[i].words, &cases[i].want);
}

static void twist_loops(enum fake_probe probe, uint32_t i, uint32_t k, const float *in, float *x)
{
    (void)i;
    (void)in;
    if (probe == LOOP)
        *x = float_from_bits(1000 + k);
}

static void loops_are_those_that_ran(void **state)
{
    (void)state;
    struct card card = card_now(twist_loops);
    static const uint32_t ran[] = {1000, 1003 + 1004, 1007};
    assert_memory_equal(card.loop.ran, ran, sizeof ran);
    char text[8192];
    card_text(&card, text, sizeof text);
    assert_non_null(strstr(text, "ENDED EARLY, silently: 1000 of 100000; two in turn 2007 of "
                                 "200000; nested 1007 of 100000\n"));
}

/* A number or a zero, of the first operand or of the second. */
static void rules_of_min_and_max_are_named(void **state)
{
    (void)state;
    static const struct {
        struct card_pair pair;
        const char *nan, *zero;
    } cases[] = {
        {{1, 1, 0, 0}, "the number", "+0"},
        {{NAN, NAN, -0.0f, -0.0f}, "NaN", "-0"},
        {{1, NAN, -0.0f, 0}, "the second operand", "the first"},
        {{NAN, 1, 0, -0.0f}, "the first operand", "the second"},
    };
    struct card card = card_now(NULL);
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        const size_t other = ARRAY_COUNT(cases) - 1 - i;
        char text[8192], wanted[128];
        card.min = cases[i].pair;
        card.max = cases[other].pair;
        card_text(&card, text, sizeof text);
        (void)snprintf(wanted, sizeof wanted, "with one NaN           min gives %s, max %s\n",
                       cases[i].nan, cases[other].nan);
        assert_non_null(strstr(text, wanted));
        (void)snprintf(wanted, sizeof wanted, "of -0 and +0           min gives %s, max %s\n",
                       cases[i].zero, cases[other].zero);
        assert_non_null(strstr(text, wanted));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(driver_that_is_right_has_a_clean_card),
        cmocka_unit_test(functions_are_compared_one_by_one),
        cmocka_unit_test(operators_are_compared_one_by_one),
        cmocka_unit_test(unpacked_halves_are_counted_by_kind),
        cmocka_unit_test(packed_halves_are_counted_by_kind),
        cmocka_unit_test(loops_are_those_that_ran),
        cmocka_unit_test(rules_of_min_and_max_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
