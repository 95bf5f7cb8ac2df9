/* Engine webgpu without Node: the text of its shaders, what it refuses, the bounds of WGSL, and the
 * card of what was measured. */
#include "gpu/webgpu/webgpu_card.h"
#include "gpu/webgpu/webgpu_text.h"
#include "ref/store.h"
#include "ref/twin/model.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const char *const with_wgsl[] = {"f32",     "rf16",          "rtrs_direct",
                                        "rtrs_rf", "rtrs_rf_paper", "cwbvh80"};

static size_t occurrences(const char *text, const char *of)
{
    size_t count = 0;
    for (const char *at = text; (at = strstr(at, of)); at++)
        count++;
    return count;
}

static struct job job_of(struct packed *packed, const struct layout *layout, enum query query)
{
    *packed = (struct packed){.layout = layout, .store = tri_stores[0], .stack_need = 9};
    return (struct job){.packed = packed, .box = box_tests[0], .tri = tri_tests[0], .query = query};
}

/* Each part is in the text once, and nothing but one layout's. */
static void test_text(void **state)
{
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(with_wgsl); i++) {
        struct packed packed;
        struct reason reason;
        char *text;
        const struct job job = job_of(&packed, layout_find(with_wgsl[i]), QUERY_CLOSEST);
        assert_true(webgpu_takes(packed.layout));
        assert_int_equal(webgpu_text(&job, &text, &reason), STATUS_OK);
        const char *const once[] = {
            "@compute",      "fn keep(",       "fn slab_test(", "fn tri_test(", "fn node_load(",
            "fn leaf_item(", "fn leaf_count(", "fn step(",      "fn pop(",      "fn walk("};
        for (size_t k = 0; k < ARRAY_COUNT(once); k++)
            assert_int_equal(occurrences(text, once[k]), 1);
        assert_int_equal(occurrences(text, "const ORDER ="), !layout_is_wide(packed.layout));
        assert_int_equal(occurrences(text, "const WIDE ="), layout_is_wide(packed.layout));
        free(text);
    }
}

/* The text names the tests by ref/abi.h's numbers, and a stack that is large enough. */
static void test_constants(void **state)
{
    (void)state;
    struct packed packed;
    struct reason reason;
    struct job job = job_of(&packed, layout_find("f32"), QUERY_ANY);
    for (size_t b = 0; box_tests[b]; b++)
        for (size_t t = 0; tri_tests[t]; t++)
            for (uint32_t need = 1; need <= ABI_STACK_MAX; need += 21) {
                char *text, line[64];
                job.box = box_tests[b];
                job.tri = tri_tests[t];
                packed.stack_need = need;
                assert_int_equal(webgpu_text(&job, &text, &reason), STATUS_OK);
                snprintf(line, sizeof line, "const BOX_TEST = %uu;\n", box_tests[b]->id);
                assert_int_equal(occurrences(text, line), 1);
                snprintf(line, sizeof line, "const TRI_TEST = %uu;\n", tri_tests[t]->id);
                assert_int_equal(occurrences(text, line), 1);
                assert_int_equal(occurrences(text, "const QUERY = 1u;\n"), 1);
                const char *stack = strstr(text, "const STACK = ");
                assert_non_null(stack);
                assert_true(strtoul(stack + strlen("const STACK = "), NULL, 10) >= need);
                free(text);
            }
}

/* What WGSL does not promise is not used: functions whose order or error is open, infinities. */
static void test_no_open_functions(void **state)
{
    (void)state;
    static const char *const open[] = {"fma(",    "dot(",       "cross(",     "normalize(",
                                       "length(", "inverse",    "unpack2x16", "pack2x16",
                                       "clamp(",  "distance(",  "reflect(",   "mix(",
                                       "sqrt(",   "0x7F800000", "enable f16", "7f800000"};
    for (size_t i = 0; wgsl_sources[i].name; i++) {
        for (size_t k = 0; k < ARRAY_COUNT(open) && strstr(wgsl_sources[i].name, ".wgsl"); k++) {
            size_t in = occurrences(wgsl_sources[i].text, open[k]);
            if (strcmp(open[k], "distance(") == 0) /* slab_distance */
                in -= occurrences(wgsl_sources[i].text, "slab_distance(");
            if (in > 0)
                fail_msg("%s has %s", wgsl_sources[i].name, open[k]);
        }
        assert_non_null(wgsl_find(wgsl_sources[i].name));
    }
    assert_null(wgsl_find("none.wgsl"));
}

static void refused(const struct job *job, enum status status, const char *why)
{
    struct reason reason;
    char *text;
    assert_int_equal(webgpu_text(job, &text, &reason), status);
    assert_null(text);
    assert_non_null(strstr(reason.text, why));
}

static void test_refusals(void **state)
{
    (void)state;
    struct packed packed;
    size_t without = 0;
    for (size_t i = 0; layouts_all[i]; i++) {
        const struct job job = job_of(&packed, layouts_all[i], QUERY_CLOSEST);
        if (webgpu_takes(layouts_all[i]))
            continue;
        without++;
        refused(&job, STATUS_UNSUPPORTED, layouts_all[i]->name);
    }
    assert_true(without > 0);
    struct job job = job_of(&packed, layout_find("f32"), QUERY_ALL);
    refused(&job, STATUS_UNSUPPORTED, "lists");
    job.query = QUERY_CLOSEST;
    packed.store = tri_store_find("gathered");
    refused(&job, STATUS_UNSUPPORTED, "gathered");
    packed.store = tri_stores[0];
    packed.stack_need = ABI_STACK_MAX + 1;
    refused(&job, STATUS_LIMIT, "stacks");
}

static void worst(double *most, double error)
{
    *most = fmax(*most, error);
}

/* The bounds are what WGSL's text says of one operation, and no more: either neighbour of the exact
 * result, 2.5 ulp, zero for every subnormal. u is 2^-24 of the exact result. */
static void test_bounds(void **state)
{
    (void)state;
    const struct rounding wgsl = ROUNDING_WGSL;
    double neighbour = 0, ulps = 0;
    for (int i = 1; i < 4096; i++) {
        const double exact = 1.0 + i * 0x1p-12 + 0x1p-40; /* no float */
        const float nearest = (float)exact;
        const float below = (double)nearest < exact ? nearest : nextafterf(nearest, 0.0f);
        const float above = nextafterf(below, 4.0f);
        worst(&neighbour, (exact - (double)below) / (exact * 0x1p-24));
        worst(&neighbour, ((double)above - exact) / (exact * 0x1p-24));
        worst(&ulps, 2.5 * ((double)above - (double)below) / (exact * 0x1p-24));
    }
    worst(&ulps, 2.5 * 0x1p-23 / 0x1p-24); /* of a power of two */
    assert_true(neighbour <= wgsl.add && neighbour <= wgsl.mul);
    assert_true(neighbour > wgsl.add - 0.01 && neighbour > wgsl.mul - 0.01);
    assert_true(ulps <= wgsl.div && ulps > wgsl.div - 0.01);
    const double subnormal = (double)nextafterf(0x1p-126f, 0.0f);
    assert_true(subnormal <= wgsl.tiny && subnormal > wgsl.tiny * 0.99);
    for (size_t t = 0; tri_tests[t]; t++) {
        const struct model model = engine_model(engine_find("webgpu"), NULL, tri_tests[t]);
        assert_memory_equal(&model.rounding, &wgsl, sizeof wgsl);
        assert_false(model.bits || model.watertight);
        assert_int_equal(model.open, tri_tests[t]->open);
        assert_true(twin_is_own(model.formula));
    }
}

/* How a pretended Dawn computes. */
enum pretence {
    FAKE_PLAIN,
    FAKE_FUSED,
    FAKE_DISTRIBUTED,
    FAKE_REORDERED,
    FAKE_DIVIDES_BADLY,
    FAKES
};

static void fake_answers(enum pretence fake, const struct probe_triple *triple, float *out)
{
    for (uint32_t i = 0; i < PROBE_TRIPLES; i++, out += WEBGPU_PROBED) {
        const float a = triple[i].a, b = triple[i].b, c = triple[i].c;
        const float product = a * b, difference = a - b, sum = a + b, right = b + c;
        const float ac = a * c, bc = b * c, quotient = a / b;
        const float all[WEBGPU_PROBED] = {sum,
                                          difference,
                                          product,
                                          fake == FAKE_DIVIDES_BADLY ? nextafterf(quotient, 0.0f)
                                                                     : quotient,
                                          1.0f / b,
                                          product + c,
                                          a < b ? a : b,
                                          fake == FAKE_FUSED ? fmaf(a, b, c) : product + c,
                                          fake == FAKE_DISTRIBUTED ? ac - bc : difference * c,
                                          fake == FAKE_REORDERED ? a + right : sum + c};
        memcpy(out, all, sizeof all);
    }
}

static void test_card(void **state)
{
    (void)state;
    struct probe_triple *triple = alloc_zeroed(PROBE_TRIPLES, sizeof *triple);
    float *got = alloc_zeroed(PROBE_TRIPLES, WEBGPU_PROBED * sizeof *got);
    assert_true(triple && got);
    probe_triples(triple);
    for (enum pretence fake = FAKE_PLAIN; fake < FAKES; fake++) {
        struct webgpu_card card = {.device = ""};
        char text[4096] = "";
        fake_answers(fake, triple, got);
        webgpu_card_of(triple, got, &card);
        webgpu_card_text(&card, text, sizeof text);
        const struct webgpu_choice *choice[] = {&card.contraction, &card.distribution,
                                                &card.reassociation};
        for (size_t k = 0; k < ARRAY_COUNT(choice); k++) {
            const bool other = fake == FAKE_FUSED + k;
            assert_true(choice[k]->telling > 100);
            assert_int_equal(choice[k]->plain, other ? 0 : choice[k]->telling);
            assert_int_equal(choice[k]->other, other ? choice[k]->telling : 0);
            assert_int_equal(choice[k]->neither, 0);
        }
        assert_int_equal(occurrences(text, "as written, "),
                         fake >= FAKE_FUSED && fake < FAKE_DIVIDES_BADLY ? 2 : 3);
        assert_int_equal(card.arithmetic.bits, fake != FAKE_DIVIDES_BADLY);
        assert_int_equal(card.op[PROBE_DIV].worst_ulp, fake == FAKE_DIVIDES_BADLY);
    }
    free(triple);
    free(got);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_text),
        cmocka_unit_test(test_constants),
        cmocka_unit_test(test_no_open_functions),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_bounds),
        cmocka_unit_test(test_card),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
