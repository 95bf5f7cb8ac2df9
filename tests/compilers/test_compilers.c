/* Compilers of shaders (gpu/shaders/compiler.h): their names, and laws of what they make, counted
 * by another walk through the words. */
#define _POSIX_C_SOURCE 200809L
#include "gpu/shaders/compiler_tools.h"
#include "gpu/shaders/shaders.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { OP_EXT = 12, OP_SPEC_CONSTANT = 50, OP_DECORATE = 71, NO_CONTRACTION = 42, FMA = 50 };

/* OpFNegate, FAdd, FSub, FMul, FDiv, FRem, FMod, VectorTimesScalar, the products of matrices, Dot.
 */
static bool is_float_op(uint32_t op)
{
    static const uint32_t ops[] = {127, 129, 131, 133, 136, 140, 141,
                                   142, 143, 144, 145, 146, 147, 148};
    for (size_t i = 0; i < sizeof ops / sizeof ops[0]; i++)
        if (ops[i] == op)
            return true;
    return false;
}

struct walked {
    uint32_t ops, kept, fused, constants;
};

/* Counts by looking for a decoration of each operation in turn. */
static struct walked walk(const uint32_t *word, uint32_t count)
{
    struct walked out = {0};
    for (uint32_t i = 5; i < count; i += word[i] >> 16) {
        const uint32_t op = word[i] & 0xFFFFu;
        out.fused += op == OP_EXT && word[i + 4] == FMA;
        out.constants += op == OP_SPEC_CONSTANT;
        if (!is_float_op(op))
            continue;
        out.ops++;
        bool kept = false;
        for (uint32_t d = 5; d < i && !kept; d += word[d] >> 16)
            kept = (word[d] & 0xFFFFu) == OP_DECORATE && word[d + 1] == word[i + 2] &&
                   word[d + 2] == NO_CONTRACTION;
        out.kept += kept;
    }
    return out;
}

static struct compiler named(const char *name)
{
    struct compiler compiler;
    struct reason reason;
    if (compiler_parse(name, &compiler, &reason))
        fail_msg("%s: %s", name, reason.text);
    return compiler;
}

/* The constants of a dispatch: closest hits on layout f32. */
static struct vk_shader shader_of(const char *name)
{
    static const uint32_t constant[] = {64, 1, 0, 0, 32, 0, 0, 0};
    const struct shader *found = shader_find(name);
    if (!found)
        fail_msg("no shader %s", name);
    return (struct vk_shader){.name = found->name,
                              .word = found->word,
                              .word_count = found->word_count,
                              .constant = constant,
                              .constant_count = 8};
}

static struct compiled made(const char *name, const char *of)
{
    const struct compiler compiler = named(name);
    const struct vk_shader shader = shader_of(of);
    struct compiled out = {0};
    struct reason reason;
    enum status status = compiler_check(&compiler, &reason);
    if (status == STATUS_UNSUPPORTED) {
        print_message("%s: skipped\n", reason.text);
        skip();
    }
    if (status || compiler_run(&compiler, &shader, &out, &reason))
        fail_msg("%s", reason.text);
    return out;
}

static void names_are_read_and_written(void **state)
{
    static const char *const good[] = {"raw",
                                       "opt",
                                       "size",
                                       "cross",
                                       "hlsl",
                                       "shaderc",
                                       "raw:none",
                                       "opt:final",
                                       "passes:ccp",
                                       "passes:ccp+scalar-replacement=100",
                                       "passes:./a.sh+ccp:none"};
    static const char *const bad[][2] = {{"", "no compiler"},
                                         {"O", "no compiler"},
                                         {"opt:ccp", "takes no list"},
                                         {"passes", "takes names"},
                                         {"passes:", "takes names"},
                                         {"passes:+ccp", "empty pass"},
                                         {"passes:ccp++dce", "empty pass"},
                                         {"passes:ccp+", "empty pass"},
                                         {"passes:a b", "character"},
                                         {"raw:never", "takes no list"}};
    (void)state;
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        char text[COMPILER_NAME_MOST + 32];
        const struct compiler compiler = named(good[i]);
        compiler_name(&compiler, text);
        assert_string_equal(text, good[i]);
    }
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct compiler compiler;
        struct reason reason = {""};
        assert_int_equal(compiler_parse(bad[i][0], &compiler, &reason), STATUS_INPUT);
        if (!strstr(reason.text, bad[i][1]))
            fail_msg("'%s': %s", bad[i][0], reason.text);
    }
}

static void names_have_their_decoration_at_the_end(void **state)
{
    (void)state;
    assert_int_equal(named("opt").decorate, DECORATE_SOURCE);
    assert_false(named("opt").decorated);
    assert_true(named("opt:source").decorated);
    assert_int_equal(named("passes:ccp:final").decorate, DECORATE_FINAL);
    assert_string_equal(named("passes:ccp:final").passes, "ccp");
}

static void what_runs_many_passes_is_refused(void **state)
{
    (void)state;
    char text[2 * COMPILER_NAME_MOST] = "passes:a";
    struct compiler compiler;
    struct reason reason;
    for (int i = 0; i < COMPILER_PASSES_MOST; i++)
        strcat(text, "+a");
    assert_int_equal(compiler_parse(text, &compiler, &reason), STATUS_INPUT);
    memset(text, 'a', sizeof text - 1);
    memcpy(text, "passes:", 7);
    text[sizeof text - 1] = '\0';
    assert_int_equal(compiler_parse(text, &compiler, &reason), STATUS_INPUT);
}

static const char *const modules[] = {"trace_f32",   "trace_rf16", "trace_cwbvh80",
                                      "trace_brute", "world_f32",  "query_rays"};

/* All but what another language has no word for; what a tool says is counted anew. */
static void all_is_kept_by(const char *compiler, bool translated)
{
    for (size_t i = 0; i < sizeof modules / sizeof modules[0]; i++) {
        const struct compiled out = made(compiler, modules[i]);
        const struct vk_shader source = shader_of(modules[i]);
        const struct walked before = walk(source.word, source.word_count);
        const struct walked after = walk(out.word, out.count);
        assert_int_equal(out.source, before.ops);
        assert_int_equal(before.kept, before.ops);
        assert_int_equal(out.ops, after.ops);
        assert_int_equal(out.kept, after.kept);
        assert_int_equal(out.foreign, 0);
        assert_int_equal(after.fused, 0);
        if (!translated)
            assert_int_equal(after.kept, after.ops);
        assert_true(out.ops - out.kept >= out.signs);
        assert_int_equal(out.ops - out.kept - out.signs, 0); /* negations alone */
        assert_true(after.constants > 0 && after.constants <= before.constants);
    }
}

static void opt_keeps_all(void **state)
{
    (void)state;
    all_is_kept_by("opt", false);
}

static void size_keeps_all(void **state)
{
    (void)state;
    all_is_kept_by("size", false);
}

static void passes_keep_all(void **state)
{
    (void)state;
    all_is_kept_by("passes:inline-entry-points-exhaustive+ccp+simplify-instructions", false);
}

static void cross_loses_negations_alone(void **state)
{
    (void)state;
    all_is_kept_by("cross", true);
}

static void shaderc_loses_negations_alone(void **state)
{
    (void)state;
    all_is_kept_by("shaderc", true);
}

/* HLSL has values in the place of specialization constants, so each set of them is a module. */
static void hlsl_has_the_values_of_constants(void **state)
{
    (void)state;
    const struct compiled out = made("hlsl", "trace_f32");
    const struct walked after = walk(out.word, out.count);
    const uint32_t other[] = {64, 1, 2, 1, 64, 0, 0, 0};
    struct vk_shader shader = shader_of("trace_f32");
    struct compiled again;
    struct reason reason;
    assert_int_equal(after.constants, 0);
    assert_int_equal(out.kept, after.kept);
    assert_true(out.kept > 30 && out.ops - out.kept == out.signs);
    const struct compiler compiler = named("hlsl");
    assert_int_equal(compiler_run(&compiler, &shader, &again, &reason), STATUS_OK);
    assert_ptr_equal(again.word, out.word);
    shader.constant = other;
    assert_int_equal(compiler_run(&compiler, &shader, &again, &reason), STATUS_OK);
    assert_ptr_not_equal(again.word, out.word);
    assert_int_not_equal(again.ops, out.ops); /* another triangle test */
}

static void hlsl_refuses_ray_queries(void **state)
{
    (void)state;
    (void)made("hlsl", "trace_f32");
    const struct compiler compiler = named("hlsl");
    const struct vk_shader shader = shader_of("query_rays");
    struct compiled out;
    struct reason reason;
    assert_int_equal(compiler_run(&compiler, &shader, &out, &reason), STATUS_UNSUPPORTED);
    assert_non_null(strstr(reason.text, "query_rays: no way through HLSL: glslangValidator"));
}

/* Without decorations spirv-opt may fuse (that of Debian 12 does), and a decoration after it comes
 * too late. */
static void decorations_come_when_they_are_asked_for(void **state)
{
    (void)state;
    const struct compiled none = made("opt:none", "trace_f32");
    const struct compiled last = made("opt:final", "trace_f32");
    const struct compiled bare = made("raw:none", "trace_f32");
    const struct vk_shader source = shader_of("trace_f32");
    assert_int_equal(walk(none.word, none.count).kept, 0);
    assert_int_equal(walk(bare.word, bare.count).kept, 0);
    assert_int_equal(bare.ops, walk(source.word, source.word_count).ops);
    assert_int_equal(walk(last.word, last.count).kept, last.ops);
    assert_int_equal(last.kept, last.ops);
    assert_int_equal(last.ops, none.ops);
    assert_int_equal(none.foreign, walk(none.word, none.count).fused);
    assert_int_equal(last.foreign, none.foreign);
}

static void a_module_is_compiled_once(void **state)
{
    (void)state;
    const struct compiled one = made("opt", "trace_f32"), again = made("opt", "trace_f32");
    assert_ptr_equal(one.word, again.word);
    assert_ptr_not_equal(made("size", "trace_f32").word, one.word);
    assert_ptr_not_equal(made("opt", "trace_rf16").word, one.word);
}

static void an_unknown_pass_is_no_name(void **state)
{
    (void)state;
    (void)made("opt", "trace_f32");
    const struct compiler compiler = named("passes:ccp+no-such-pass");
    struct reason reason;
    assert_int_equal(compiler_check(&compiler, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "no-such-pass"));
}

/* A program among the passes has the module as the passes before it left it, and what it writes
 * goes to those behind it. */
static void programs_and_passes_take_turns(void **state)
{
    (void)state;
    (void)made("opt", "trace_f32");
    char folder[] = "/tmp/raydiff-XXXXXX", path[64], seen[64], name[256];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/pass", folder);
    snprintf(seen, sizeof seen, "%s/seen", folder);
    FILE *script = fopen(path, "w");
    assert_non_null(script);
    fprintf(script, "#!/bin/sh\nexec tee '%s'\n", seen);
    assert_int_equal(fclose(script), 0);
    assert_int_equal(chmod(path, 0700), 0);
    snprintf(name, sizeof name, "passes:inline-entry-points-exhaustive+%s", path);
    static uint32_t word[1 << 20];
    for (int behind = 0; behind < 2; behind++) {
        strcat(name, behind ? "+eliminate-dead-functions" : "");
        const struct compiled out = made(name, "trace_f32");
        FILE *file = fopen(seen, "rb");
        assert_non_null(file);
        const size_t count = fread(word, 4, sizeof word / 4, file);
        assert_int_equal(fclose(file), 0);
        assert_int_equal(count == out.count, !behind);
        if (!behind)
            assert_memory_equal(word, out.word, 4 * count);
        assert_true(count > shader_of("trace_f32").word_count); /* inlined, and nothing removed */
    }
    assert_int_equal(unlink(seen) | unlink(path) | rmdir(folder), 0);
}

/* What spirv-opt says opt and size stand for makes the same modules, word by word. */
static void levels_are_lists_of_passes(void **state)
{
    static const char *const level[] = {"opt", "size"};
    (void)state;
    for (size_t k = 0; k < 2; k++) {
        const struct compiled whole = made(level[k], "trace_f32");
        const struct compiler compiler = named(level[k]);
        const struct vk_shader source = shader_of("trace_f32");
        const char *pass[COMPILER_LIST_MOST];
        char *text;
        uint32_t *word;
        size_t passes = 0, count;
        struct reason reason = {""};
        assert_int_equal(compiler_level_passes(&compiler, &text, &reason), STATUS_OK);
        for (char *at = strtok(text, "\n"); at; at = strtok(NULL, "\n"))
            pass[passes++] = at;
        assert_true(passes > 10);
        if (compiler_list(pass, passes, source.word, source.word_count, &word, &count, &reason))
            fail_msg("%s", reason.text);
        assert_int_equal(count, whole.count);
        assert_memory_equal(word, whole.word, 4 * count);
        free(word);
        free(text);
    }
}

static void a_missing_tool_is_named(void **state)
{
    static const char *const wants[][3] = {{"opt", "spirv-opt", "spirv-tools"},
                                           {"passes:ccp", "spirv-opt", "spirv-tools"},
                                           {"cross", "spirv-cross", "spirv-cross"},
                                           {"hlsl", "spirv-cross", "spirv-cross"},
                                           {"shaderc", "spirv-cross", "spirv-cross"}};
    (void)state;
    char *before = strdup(getenv("PATH"));
    assert_non_null(before);
    assert_int_equal(setenv("PATH", "/nonexistent", 1), 0);
    for (size_t i = 0; i < sizeof wants / sizeof wants[0]; i++) {
        const struct compiler compiler = named(wants[i][0]);
        char want[128];
        struct reason reason = {""};
        snprintf(want, sizeof want, "there is no program %s (Debian package %s)", wants[i][1],
                 wants[i][2]);
        assert_int_equal(compiler_check(&compiler, &reason), STATUS_UNSUPPORTED);
        assert_string_equal(reason.text, want);
    }
    assert_int_equal(setenv("PATH", before, 1), 0);
    free(before);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_are_read_and_written),
        cmocka_unit_test(names_have_their_decoration_at_the_end),
        cmocka_unit_test(what_runs_many_passes_is_refused),
        cmocka_unit_test(opt_keeps_all),
        cmocka_unit_test(size_keeps_all),
        cmocka_unit_test(passes_keep_all),
        cmocka_unit_test(cross_loses_negations_alone),
        cmocka_unit_test(shaderc_loses_negations_alone),
        cmocka_unit_test(hlsl_has_the_values_of_constants),
        cmocka_unit_test(hlsl_refuses_ray_queries),
        cmocka_unit_test(decorations_come_when_they_are_asked_for),
        cmocka_unit_test(a_module_is_compiled_once),
        cmocka_unit_test(an_unknown_pass_is_no_name),
        cmocka_unit_test(programs_and_passes_take_turns),
        cmocka_unit_test(levels_are_lists_of_passes),
        cmocka_unit_test(a_missing_tool_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
