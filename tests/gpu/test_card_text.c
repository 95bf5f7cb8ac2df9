/* What a driver's card says of made-up measurements, in text and in JSON: a driver at hand need
 * not have the faults that a line is there for. */
#include "gpu/card/card.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define TEXT_BYTES 8192

static struct card card_of_faults(void)
{
    struct card card = {
        .limits = {.device = "a device", .driver = "a driver"},
        .arithmetic = {{1.5, 2.5, 3.5, 0.0}, false, true},
        .sqrt = {101, 102, 103},
        .inversesqrt = {104, 105, 106},
        .min = {NAN, 1.0f, -0.0f, 0.0f},
        .max = {1.0f, NAN, 0.0f, -0.0f},
        .fma = {201, 202, 203, 204},
        .contraction = {205, 206, 205, 207},
        .distribution = {208, 208, 209, 210},
        .unpack = {301, 302, 303, 304},
        .pack = {401, 402, 403, 404, 405, 406, 0x1.8p+3f, 0x4A01, 0x4A02},
        .loop = {{501, 502, 503}, {504, 505, 506}},
    };
    for (uint32_t k = 0; k < PROBE_OPS; k++) {
        uint32_t n = 1000 + 10 * k;
        card.op[k] = (struct probe_op){"an op", n, n + 1, n + 2, n + 3, n + 4, n + 5};
    }
    return card;
}

/* The rest of the line that begins with the label. */
static void assert_line(const char *text, const char *label, const char *rest)
{
    char line[256] = "\n";
    snprintf(line, sizeof line, "\n%-22s %s\n", label, rest);
    if (!strstr(text, line))
        fail_msg("no line '%s' in\n%s", line + 1, text);
}

static void every_line_has_its_numbers(void **state)
{
    (void)state;
    char text[TEXT_BYTES];
    struct card card = card_of_faults();
    card_text(&card, text, sizeof text);
    assert_line(text, "subnormals", "see above");
    assert_line(text, "sqrt", "102 of 101 differ from the nearest, at most 103 ulp");
    assert_line(text, "inversesqrt", "105 of 104 differ from the nearest, at most 106 ulp");
    assert_line(text, "with one NaN", "min gives the first operand, max the second operand");
    assert_line(text, "of -0 and +0", "min gives the first, max the second");
    assert_line(text, "fma(a,b,c)", "of 201 telling 202 as written, 203 fused, 204 neither");
    assert_line(text, "a*b+c, if free", "fused (205 of 205 telling)");
    assert_line(text, "(a-b)*c, if free",
                "as written, each operation rounded (208 of 208 telling)");
    assert_non_null(strstr(text, "zeros, normal, infinite, NaN: 301 wrong; subnormal: 302 kept, "
                                 "303 zero, 304 wrong\n"));
    assert_line(text, "packHalf2x16",
                "402 of 401 are not the nearest half: 404 from 65520, 405 below 2^-14, 406 "
                "between; 403 no neighbour; 0x1.8p+3 gives 4a01, nearest 4a02");
    assert_line(text, "loops",
                "ENDED EARLY, silently: 504 of 501; two in turn 505 of 502; nested 506 of 503");
    assert_line(text, "the judge uses", probe_arithmetic_text(&card.arithmetic));
}

static void a_card_without_faults_is_short(void **state)
{
    (void)state;
    char text[TEXT_BYTES];
    struct card card = card_of_faults();
    memcpy(card.loop.ran, card.loop.asked, sizeof card.loop.ran);
    card.pack.differs = 0;
    card.distribution = (struct card_choice){208, 209, 208, 210};
    card.min = (struct card_pair){NAN, NAN, -0.0f, -0.0f};
    card.max = (struct card_pair){1.0f, 1.0f, 0.0f, 0.0f};
    card.arithmetic.bits = true;
    card_text(&card, text, sizeof text);
    assert_line(text, "subnormals", "become zeros");
    assert_line(text, "loops", "run to their end (502 iterations)");
    assert_line(text, "packHalf2x16", "0 of 401 are not the nearest half");
    assert_line(text, "(a-b)*c, if free", "as a*c-b*c (208 of 208 telling)");
    assert_line(text, "with one NaN", "min gives NaN, max the number");
    assert_line(text, "of -0 and +0", "min gives -0, max +0");
    card.arithmetic.flushes = false;
    card_text(&card, text, sizeof text);
    assert_line(text, "subnormals", "kept");
    for (uint32_t i = 0; i < CARD_LOOPS; i++) { /* any loop that is cut */
        card.loop.ran[i]--;
        card_text(&card, text, sizeof text);
        assert_non_null(strstr(text, "ENDED EARLY"));
        card.loop.ran[i]++;
    }
}

static void the_json_has_every_number(void **state)
{
    (void)state;
    static const char expected[] =
        "{'device': 'a device', 'driver': 'a driver',"
        " 'judge': {'bits': false, 'flushes': true, 'add_u': 1.5, 'mul_u': 2.5, 'div_u': 3.5},"
        " 'sqrt': {'count': 101, 'differs': 102, 'worst_ulp': 103},"
        " 'inversesqrt': {'count': 104, 'differs': 105, 'worst_ulp': 106},"
        " 'min': {'with_one_nan': 'the first operand', 'of_zeros': 'the first'},"
        " 'max': {'with_one_nan': 'the second operand', 'of_zeros': 'the second'},"
        " 'fma': {'telling': 201, 'as_written': 202, 'other': 203, 'neither': 204},"
        " 'free_mul_add': {'telling': 205, 'as_written': 206, 'other': 205, 'neither': 207},"
        " 'free_distribution': {'telling': 208, 'as_written': 208, 'other': 209, 'neither': 210},"
        " 'half': {'unpack': {'wrong': 301, 'subnormal_kept': 302, 'subnormal_zero': 303,"
        " 'subnormal_wrong': 304}, 'pack': {'count': 401, 'not_nearest': 402, 'no_neighbour': 403,"
        " 'overflow': 404, 'tiny': 405, 'normal': 406}},"
        " 'loops': {'ended_early': true, 'asked': [501, 502, 503], 'ran': [504, 505, 506]}}";
    char text[sizeof expected];
    for (size_t i = 0; i < sizeof expected; i++)
        text[i] = expected[i] == '\'' ? '"' : expected[i];
    struct card card = card_of_faults();
    json_t *known = json_loads(text, 0, NULL), *json = card_json(&card), *ops = json_array();
    for (uint32_t k = 0; k < PROBE_OPS; k++) {
        json_int_t n = 1000 + 10 * (json_int_t)k;
        json_array_append_new(ops, json_pack("{s:s,s:I,s:I,s:I,s:I,s:I,s:I}", "op", "an op",
                                             "ordinary", n, "ordinary_differs", n + 1, "special",
                                             n + 2, "special_differs", n + 3, "flushed", n + 4,
                                             "worst_ulp", n + 5));
    }
    assert_non_null(known);
    assert_non_null(json);
    json_object_set_new(known, "ops", ops);
    if (!json_equal(known, json))
        fail_msg("%s", json_dumps(json, JSON_INDENT(1)));
    json_decref(known);
    json_decref(json);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_line_has_its_numbers),
        cmocka_unit_test(a_card_without_faults_is_short),
        cmocka_unit_test(the_json_has_every_number),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
