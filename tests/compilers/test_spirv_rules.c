/* Laws of what modules from compilers may hold (gpu/shaders/spirv_fix.h), on modules made by hand:
 * an instruction is refused under the rules that name it, at its word, wherever it stands, and
 * taken under all others; a module that is cut or ends elsewhere is refused. */
#include "gpu/shaders/spirv_fix.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

enum { PLAIN = 1, TRACING = 2, RENDER = 4, QUERY = 8, ALL = 15, WORDS = 64 };

static const struct spirv_rules rules[] = {
    {.free = false}, {.tracing = true}, {.render = true}, {.tracing = true, .query = true}};

struct small_module {
    uint32_t word[WORDS];
    size_t count;
};

static void add(struct small_module *out, uint32_t op, uint32_t count, const uint32_t *rest)
{
    out->word[out->count++] = count << 16 | op;
    for (uint32_t i = 1; i < count; i++)
        out->word[out->count++] = rest[i - 1];
}

/* The instruction stands first, between others, or last before the end. */
static size_t make(struct small_module *out, const uint32_t *instruction, int place)
{
    const uint32_t header[] = {0x07230203, 0x10000, 0, 99, 0}, shader = 1, real[] = {7, 32};
    const uint32_t product[] = {7, 20, 21, 21};
    size_t at = 0;
    memcpy(out->word, header, sizeof header);
    out->count = 5;
    for (int i = 0; i < 3; i++) {
        if (place == i) {
            at = out->count;
            for (uint32_t k = 0; k < instruction[0] >> 16; k++)
                out->word[out->count++] = instruction[k];
        }
        if (i == 0)
            add(out, 17, 2, &shader); /* OpCapability */
        if (i == 0)
            add(out, 22, 3, real); /* OpTypeFloat */
        if (i == 1)
            add(out, 133, 5, product); /* OpFMul */
    }
    add(out, 56, 1, NULL); /* OpFunctionEnd */
    return at;
}

/* `taken`: the rules under which it is. */
static void must_be_taken(const uint32_t *instruction, int taken, const char *what)
{
    for (int place = 0; place < 3; place++)
        for (int r = 0; r < 4; r++) {
            struct small_module module;
            struct reason reason = {""};
            char wanted[160];
            uint32_t *word;
            size_t count;
            const size_t at = make(&module, instruction, place);
            enum status status =
                spirv_fix(module.word, module.count, &rules[r], &word, &count, &reason);
            snprintf(wanted, sizeof wanted, "word %zu: %s: ", at, what);
            if (taken & 1 << r) {
                if (status)
                    fail_msg("rules %d: %s", r, reason.text);
                assert_int_equal(count, module.count + 3); /* OpFMul's decoration */
            } else {
                assert_int_equal(status, STATUS_INPUT);
                assert_null(word);
                if (strncmp(reason.text, wanted, strlen(wanted)) != 0)
                    fail_msg("rules %d: '%s' is not '%s'", r, reason.text, wanted);
            }
            free(word);
        }
}

static void instructions_are_refused_by_their_rules(void **state)
{
    (void)state;
    static const uint32_t capability = 2u << 16 | 17, real = 3u << 16 | 22, whole = 4u << 16 | 21;
    uint32_t name[7] = {6u << 16 | 10};
    must_be_taken((const uint32_t[]){capability, 1}, ALL, "");
    must_be_taken((const uint32_t[]){capability, 9}, 0, "OpCapability");
    must_be_taken((const uint32_t[]){capability, 4472}, QUERY, "OpCapability");
    must_be_taken((const uint32_t[]){capability, 4478}, QUERY, "OpCapability");
    memcpy(name + 1, "SPV_KHR_ray_query", 18);
    must_be_taken(name, QUERY, "OpExtension");
    memcpy(name + 1, "SPV_KHR_ray_quern", 18);
    must_be_taken(name, 0, "OpExtension");
    name[0] = 6u << 16 | 11, name[1] = 30, name[5] = 0;
    memcpy(name + 2, "GLSL.std.450", 13);
    must_be_taken(name, ALL, "");
    memcpy(name + 2, "GLSL.std.451", 13);
    must_be_taken(name, 0, "OpExtInstImport");
    for (uint32_t bits = 8; bits <= 64; bits *= 2) {
        must_be_taken((const uint32_t[]){real, 31, bits}, bits == 32 ? ALL : 0, "OpTypeFloat");
        must_be_taken((const uint32_t[]){whole, 31, bits, 0}, bits == 32 ? ALL : 0, "OpTypeInt");
    }
}

/* Of GLSL.std.450 what is exact, and of OpSpecConstantOp what is no arithmetic of floats. */
static void arithmetic_is_refused_where_it_traces(void **state)
{
    (void)state;
    static const uint32_t exact[] = {4, 5, 38, 39, 41, 42, 44, 45, 62, 73, 75};
    static const uint32_t floats[] = {127, 129, 131, 133, 136, 140, 141,
                                      142, 143, 147, 144, 145, 146, 148};
    for (uint32_t number = 1; number <= 81; number++) {
        int taken = number == 26 || number == 31 ? PLAIN | RENDER : PLAIN;
        char what[64];
        for (size_t i = 0; i < sizeof exact / sizeof exact[0]; i++)
            taken = number == exact[i] ? ALL : taken;
        snprintf(what, sizeof what, "GLSL.std.450 %s (%u)",
                 number == 50   ? "Fma"
                 : number == 58 ? "PackHalf2x16"
                                : "instruction",
                 number);
        if (taken == ALL || number == 50 || number == 58 || number == 1)
            must_be_taken((const uint32_t[]){6u << 16 | 12, 7, 40, 30, number, 20}, taken, what);
        else if (taken & RENDER)
            must_be_taken((const uint32_t[]){6u << 16 | 12, 7, 40, 30, number, 20}, taken,
                          number == 31 ? "GLSL.std.450 Sqrt (31)"
                                       : "GLSL.std.450 instruction (26)");
    }
    must_be_taken((const uint32_t[]){4u << 16 | 12, 7, 40, 30}, PLAIN, "OpExtInst");
    for (uint32_t op = 124; op <= 152; op++) {
        int taken = ALL;
        for (size_t i = 0; i < sizeof floats / sizeof floats[0]; i++)
            taken = op == floats[i] ? PLAIN : taken;
        must_be_taken((const uint32_t[]){6u << 16 | 52, 7, 40, op, 20, 20}, taken,
                      "OpSpecConstantOp on floats");
    }
    must_be_taken((const uint32_t[]){5u << 16 | 144, 7, 40, 20, 20}, PLAIN, "OpVectorTimesMatrix");
    must_be_taken((const uint32_t[]){5u << 16 | 145, 7, 40, 20, 20}, PLAIN, "OpMatrixTimesVector");
    must_be_taken((const uint32_t[]){5u << 16 | 146, 7, 40, 20, 20}, PLAIN, "OpMatrixTimesMatrix");
    must_be_taken((const uint32_t[]){5u << 16 | 148, 7, 40, 20, 20}, PLAIN, "OpDot");
}

static void a_module_ends_after_its_last_function(void **state)
{
    (void)state;
    const uint32_t shader[] = {2u << 16 | 17, 1};
    struct small_module module;
    struct reason reason = {""};
    uint32_t *word;
    size_t count;
    make(&module, shader, 0);
    for (size_t cut = 0; cut < module.count; cut++) {
        assert_int_equal(spirv_fix(module.word, cut, &rules[0], &word, &count, &reason),
                         STATUS_INPUT);
        assert_null(word);
        assert_int_equal(count, 0);
        if (cut < 5)
            assert_non_null(strstr(reason.text, "word 0: no SPIR-V header"));
    }
    assert_int_equal(spirv_fix(module.word, module.count - 1, &rules[0], &word, &count, &reason),
                     STATUS_INPUT);
    assert_string_equal(reason.text, "word 17: end of module: it must come after OpFunctionEnd");
}

/* Without decorations a cut module is refused as well, but it may end anywhere. */
static void what_is_stripped_has_whole_instructions(void **state)
{
    (void)state;
    const uint32_t pinned[] = {3u << 16 | 71, 20, 42};
    struct small_module module, bare;
    struct reason reason = {""};
    uint32_t *word;
    size_t count;
    make(&module, pinned, 1);
    make(&bare, (const uint32_t[]){0}, 1);
    for (size_t cut = 0; cut <= module.count; cut++) {
        const bool whole = cut == 5 || cut == 7 || cut == 10 || cut == 13 || cut >= 18;
        enum status status = spirv_strip(module.word, cut, &word, &count, &reason);
        assert_int_equal(status, whole ? STATUS_OK : STATUS_INPUT);
        if (cut == module.count) {
            assert_int_equal(count, bare.count);
            assert_memory_equal(word, bare.word, 4 * bare.count);
        }
        if (!whole)
            assert_true(word == NULL && count == 0);
        free(word);
    }
    module.word[7] &= 0xFFFF; /* of no words */
    assert_int_equal(spirv_strip(module.word, module.count, &word, &count, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "word 7: instruction length"));
    assert_int_equal(spirv_fix(module.word, module.count, &rules[0], &word, &count, &reason),
                     STATUS_INPUT);
    assert_non_null(strstr(reason.text, "word 7: instruction length"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(instructions_are_refused_by_their_rules),
        cmocka_unit_test(arithmetic_is_refused_where_it_traces),
        cmocka_unit_test(a_module_ends_after_its_last_function),
        cmocka_unit_test(what_is_stripped_has_whole_instructions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
