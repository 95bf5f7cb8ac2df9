/* Mutants of SPIR-V: each is one change and no other, most are valid, and pipelines reach what the
 * source says they do. */
#include "gpu/shaders/compiler_tools.h"
#include "gpu/shaders/shaders.h"
#include "ref/abi.h"
#include "tests/shader_mutants/spirv_live.h"
#include "tests/shader_mutants/spirv_mutant.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

enum { STEP = 29, FUNCTION_END = 56, CONTROL_BARRIER = 224 };

static struct spirv_code code_of(const uint32_t *word, size_t count)
{
    struct spirv_code code;
    struct reason reason;
    if (spirv_code_make(word, count, &code, &reason))
        fail_msg("%s", reason.text);
    return code;
}

static struct spirv_code code_named(const char *name)
{
    const struct shader *shader = shader_find(name);
    assert_non_null(shader);
    return code_of(shader->word, shader->word_count);
}

static struct spirv_mutants mutants_of(const struct spirv_code *code)
{
    struct spirv_mutants out;
    struct reason reason;
    if (spirv_mutants_make(code, &out, &reason))
        fail_msg("%s", reason.text);
    return out;
}

static uint32_t *made(const struct spirv_code *code, const struct spirv_mutant *mutant,
                      size_t *count)
{
    uint32_t *word;
    struct reason reason;
    if (spirv_mutate(code, mutant, &word, count, &reason))
        fail_msg("%s", reason.text);
    return word;
}

/* Of the source one instruction goes at most; of those that come one stands in its place, and one
 * in front of it or of all functions. */
static void each_is_one_change(void **state)
{
    static const char *const names[] = {"trace_rf16", "trace_brute"};
    (void)state;
    for (size_t n = 0; n < ARRAY_COUNT(names); n++) {
        struct spirv_code code = code_named(names[n]);
        struct spirv_mutants all = mutants_of(&code);
        assert_true(all.count > 500);
        for (size_t i = n; i < all.count; i += STEP) {
            size_t count, removed = 0;
            uint32_t *word = made(&code, &all.one[i], &count);
            struct spirv_code other = code_of(word, count);
            struct spirv_diff diff;
            struct reason reason;
            assert_int_equal(spirv_diff_make(&code, &other, &diff, &reason), STATUS_OK);
            for (size_t e = 0; e < diff.count; e++)
                removed += !diff.edit[e].added;
            const bool doubles = all.one[i].kind == MUTANT_CONTRACTION; /* in five steps */
            assert_true(diff.count >= 1 && removed <= 1);
            assert_true(diff.count - removed <= (doubles ? 9 : 2));
            assert_true(word[3] >= code.word[3] && word[3] <= code.word[3] + (doubles ? 7 : 1));
            spirv_diff_free(&diff);
            spirv_code_free(&other);
            free(word);
        }
        spirv_mutants_free(&all);
        spirv_code_free(&code);
    }
}

static void names_are_different_and_of_all_kinds(void **state)
{
    (void)state;
    struct spirv_code code = code_named("trace_brute");
    struct spirv_mutants all = mutants_of(&code);
    size_t of[MUTANT_KINDS] = {0};
    for (size_t i = 0; i < all.count; i++) {
        of[all.one[i].kind]++;
        for (size_t k = 0; k < i; k++)
            assert_false(all.one[i].kind == all.one[k].kind &&
                         all.one[i].number == all.one[k].number &&
                         strcmp(all.one[i].function, all.one[k].function) == 0);
    }
    for (size_t kind = 0; kind < MUTANT_KINDS; kind++)
        assert_int_equal(of[kind] > 0, kind != MUTANT_BARRIER); /* no shader here has one */
    spirv_mutants_free(&all);
    spirv_code_free(&code);
}

/* A barrier as the last but one instruction of a shader: its one mutant of that kind is the shader
 * without it. */
static void barriers_are_dropped(void **state)
{
    (void)state;
    const struct shader *shader = shader_find("probe_free");
    uint32_t *with = calloc(shader->word_count + 4, sizeof *with);
    struct spirv_code source = code_of(shader->word, shader->word_count);
    assert_non_null(with);
    assert_int_equal(spirv_op(&source, source.count - 1), FUNCTION_END);
    const size_t front = source.at[source.count - 2]; /* in front of OpReturn */
    const uint32_t barrier[] = {4u << 16 | CONTROL_BARRIER, 1, 1, 1};
    memcpy(with, shader->word, front * sizeof *with);
    memcpy(with + front, barrier, sizeof barrier);
    memcpy(with + front + 4, shader->word + front, (shader->word_count - front) * sizeof *with);
    struct spirv_code code = code_of(with, shader->word_count + 4);
    struct spirv_mutants all = mutants_of(&code);
    size_t found = 0;
    for (size_t i = 0; i < all.count; i++)
        if (all.one[i].kind == MUTANT_BARRIER) {
            size_t count;
            uint32_t *word = made(&code, &all.one[i], &count);
            assert_int_equal(count, shader->word_count);
            assert_memory_equal(word, shader->word, count * sizeof *word);
            free(word);
            found++;
        }
    assert_int_equal(found, 1);
    spirv_mutants_free(&all);
    spirv_code_free(&code);
    spirv_code_free(&source);
    free(with);
}

static void most_are_valid(void **state)
{
    (void)state;
    struct spirv_code code = code_named("trace_brute");
    struct spirv_mutants all = mutants_of(&code);
    size_t tried = 0, valid = 0;
    for (size_t i = 0; i < all.count; i += all.count / 40) {
        struct reason reason;
        size_t count;
        uint32_t *word = made(&code, &all.one[i], &count);
        const enum status status = compiler_validate(word, count, &reason);
        free(word);
        if (status == STATUS_UNSUPPORTED) {
            print_message("SKIP %s\n", reason.text);
            skip();
        }
        tried++;
        valid += status == STATUS_OK;
    }
    assert_true(tried >= 40 && 10 * valid >= 8 * tried);
    spirv_mutants_free(&all);
    spirv_code_free(&code);
}

/* Functions, and the constant with which alone a pipeline reaches them; NO_CONSTANT: all do. */
#define NO_CONSTANT 99u
static const struct {
    const char *function;
    uint32_t constant, value;
} reached[] = {
    {"main", NO_CONSTANT, 0},
    {"step_leaf", NO_CONSTANT, 0},
    {"tri_in_range", NO_CONSTANT, 0},
    {"tri_woop", ABI_SPEC_TRI, ABI_TRI_WOOP},
    {"tri_pluecker", ABI_SPEC_TRI, ABI_TRI_PLUECKER},
    {"tri_baldwin_webber", ABI_SPEC_TRI, ABI_TRI_BALDWIN_WEBBER},
    {"slab_watertight", ABI_SPEC_BOX, ABI_BOX_WATERTIGHT},
    {"slab_robust", ABI_SPEC_BOX, ABI_BOX_ROBUST},
    {"slab_rtrs", ABI_SPEC_BOX, ABI_BOX_RTRS},
    {"list", ABI_SPEC_QUERY, ABI_QUERY_ALL},
};

static void must_reach(const struct spirv_code *code, const uint32_t *constant, const bool *live)
{
    for (size_t r = 0; r < ARRAY_COUNT(reached); r++) {
        const bool want =
            reached[r].constant == NO_CONSTANT || constant[reached[r].constant] == reached[r].value;
        size_t seen = 0, lives = 0;
        for (size_t i = 0; i < code->count; i++) {
            char name[SPIRV_SAY_MOST];
            if (spirv_op(code, i) != OP_FUNCTION)
                continue;
            spirv_function(code, i, name);
            if (strcmp(name, reached[r].function) != 0)
                continue;
            seen++;
            lives += live[i];
        }
        assert_int_equal(seen, 1);
        if (lives != want)
            fail_msg("%s: reached %zu, box %u, tri %u, query %u", reached[r].function, lives,
                     constant[ABI_SPEC_BOX], constant[ABI_SPEC_TRI], constant[ABI_SPEC_QUERY]);
    }
}

static void pipelines_reach_what_their_constants_choose(void **state)
{
    (void)state;
    struct spirv_code code = code_named("trace_f32");
    bool *live = calloc(code.count, sizeof *live);
    struct reason reason;
    assert_non_null(live);
    for (uint32_t box = 0; box < 3; box++)
        for (uint32_t tri = 0; tri <= ABI_TRI_BALDWIN_WEBBER; tri++)
            for (uint32_t query = 0; query <= ABI_QUERY_ALL; query++) {
                const uint32_t constant[] = {64, box, tri, query, 16, 0, 0, 0};
                assert_int_equal(spirv_live(&code, constant, 8, live, &reason), STATUS_OK);
                must_reach(&code, constant, live);
            }
    free(live);
    spirv_code_free(&code);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_is_one_change),
        cmocka_unit_test(names_are_different_and_of_all_kinds),
        cmocka_unit_test(barriers_are_dropped),
        cmocka_unit_test(most_are_valid),
        cmocka_unit_test(pipelines_reach_what_their_constants_choose),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
