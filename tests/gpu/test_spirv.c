/* Laws of the embedded SPIR-V, read by another parser (gpu/shaders/spirv_look.h) than that of the
 * tool that made it. */
#define _POSIX_C_SOURCE 200809L
#include "gpu/shaders/spirv_look.h"
#include "ref/layout.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum {
    OP_EXT_INST = 12,
    OP_CAPABILITY = 17,
    OP_TYPE_FLOAT = 22,
    OP_TYPE_VECTOR = 23,
    OP_TYPE_MATRIX = 24,
    OP_FIRST_ARITHMETIC = 126, /* OpSNegate */
    OP_LAST_ARITHMETIC = 152,  /* OpSMulExtended */
    OP_FMUL = 133,
    OP_DOT = 148,
    OP_DECORATE = 71,
    NO_CONTRACTION = 42,
    UNPACK_HALF = 62,
    PACK_HALF = 58,
    POW = 26,
    SQRT = 31,
    FIND_UMSB = 75,
    CAPABILITY_SHADER = 1,
    CAPABILITY_FLOAT16 = 9,
};

static struct spirv_found look(const uint32_t *word, uint32_t count)
{
    struct spirv_found out;
    struct reason reason;
    if (spirv_look(word, count, &out, &reason))
        fail_msg("%s", reason.text);
    return out;
}

static void spirv_pins_every_float_operation(void **state)
{
    (void)state;
    size_t tracing = 0;
    for (const struct shader *shader = shaders; shader->name; shader++) {
        struct spirv_found found = look(shader->word, shader->word_count);
        if (strcmp(shader->name, "probe_free") == 0) { /* measures what happens without */
            assert_true(found.float_ops > 0 && found.bare == found.float_ops);
            continue;
        }
        if (found.bare)
            fail_msg("%s: %u of %u float operations without NoContraction", shader->name,
                     found.bare, found.float_ops);
        if (!shader->tracing)
            continue;
        tracing++;
        if (found.float_ops < 30)
            fail_msg("%s: only %u float operations found", shader->name, found.float_ops);
    }
    assert_true(tracing > 0);
}

static void spirv_of_tracing_has_nothing_inexact(void **state)
{
    (void)state;
    for (const struct shader *shader = shaders; shader->name; shader++) {
        struct spirv_found found = look(shader->word, shader->word_count);
        if (shader->tracing && (found.sums || found.inexact_ext))
            fail_msg("%s: %u products with a sum, %u inexact extended instructions", shader->name,
                     found.sums, found.inexact_ext);
    }
}

/* Beside halves: a root that is corrected, a power of colours. */
static void spirv_of_rendering_has_roots_and_powers_alone(void **state)
{
    (void)state;
    size_t rendering = 0;
    for (const struct shader *shader = shaders; shader->name; shader++) {
        if (strncmp(shader->name, "render_", 7) != 0)
            continue;
        rendering++;
        assert_int_equal(look(shader->word, shader->word_count).sums, 0);
        for (uint32_t i = 5; i < shader->word_count; i += shader->word[i] >> 16) {
            const uint32_t *word = shader->word + i;
            if ((word[0] & 0xFFFFu) == OP_EXT_INST && word[4] != UNPACK_HALF && word[4] != SQRT &&
                word[4] != POW && word[4] != FIND_UMSB)
                fail_msg("%s: extended instruction %u", shader->name, word[4]);
        }
    }
    assert_true(rendering > 1);
}

static void spirv_needs_no_capability_but_shader(void **state)
{
    (void)state;
    for (const struct shader *shader = shaders; shader->name; shader++) {
        int query = strncmp(shader->name, "query_", 6) == 0; /* RayQueryKHR */
        query += strcmp(shader->name, "query_world") == 0; /* RayTraversalPrimitiveCullingKHR */
        assert_int_equal(look(shader->word, shader->word_count).other_capabilities, query);
    }
}

static void spirv_exists_for_every_layout(void **state)
{
    (void)state;
    for (size_t i = 0; layouts[i]; i++) {
        char name[64];
        (void)snprintf(name, sizeof name, "trace_%s", layouts[i]->name);
        const struct shader *shader = shader_find(name);
        if (!shader)
            fail_msg("no shader %s", name);
        assert_true(shader->tracing);
        (void)snprintf(name, sizeof name, "render_%s", layouts[i]->name);
        if (!shader_find(name)) /* made of the layout's file */
            fail_msg("no shader %s", name);
    }
    assert_null(shader_find("trace_nothing"));
}

/* --- the tool, run on modules that were broken by hand --------------------------------------- */

/* A folder for its files, and the tool beside this program's folder; NULL if it is not there. */
struct spirv_bench {
    char folder[32];
    char tool[4096];
};

static int make_bench(void **state)
{
    struct spirv_bench *bench = calloc(1, sizeof *bench);
    if (!bench)
        return -1;
    *state = bench;
    ssize_t length = readlink("/proc/self/exe", bench->tool, sizeof bench->tool - 32);
    for (int up = 0; up < 2 && length > 0; up++)
        while (length > 0 && bench->tool[--length] != '/')
            continue;
    memcpy(bench->tool + length, "/spirv_tool", sizeof "/spirv_tool");
    memcpy(bench->folder, "/tmp/raydiff-XXXXXX", sizeof "/tmp/raydiff-XXXXXX");
    return mkdtemp(bench->folder) ? 0 : -1;
}

static int free_bench(void **state)
{
    struct spirv_bench *bench = *state;
    int left = rmdir(bench->folder);
    free(bench);
    return left;
}

static void path_in(const struct spirv_bench *bench, const char *file, char path[64])
{
    (void)snprintf(path, 64, "%s/%s", bench->folder, file);
}

/* Runs `spirv_tool fix` on the words under the name of a tracing shader. Returns its exit code; its
 * message, and the fixed module if `fixed` is not NULL (*count words). */
static int run_tool(const struct spirv_bench *bench, const uint32_t *word, size_t *count,
                    char said[512], uint32_t *fixed)
{
    char in[64], out[64], command[4096 + 256];
    path_in(bench, "trace_broken.spv", in);
    path_in(bench, "trace_fixed.spv", out);
    FILE *file = fopen(in, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(word, 4, *count, file), *count);
    assert_int_equal(fclose(file), 0);
    (void)snprintf(command, sizeof command, "'%s' fix '%s' '%s' 2>&1", bench->tool, in, out);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    size_t length = fread(said, 1, 511, pipe);
    said[length] = '\0';
    int code = pclose(pipe);
    file = fopen(out, "rb");
    assert_int_equal(file != NULL, code == 0); /* nothing is left of a refused module */
    if (file && fixed)
        *count = fread(fixed, 4, *count + 4096, file);
    if (file)
        (void)fclose(file);
    (void)unlink(out);
    assert_int_equal(unlink(in), 0);
    return WEXITSTATUS(code);
}

static const struct shader *subject(const struct spirv_bench *bench)
{
    if (access(bench->tool, X_OK) != 0) {
        print_message("no %s beside this program: skipped\n", bench->tool);
        skip();
    }
    return shader_find("trace_rf16");
}

/* Copies the subject's words, finds the first instruction `op` (with `value` in its word `at`) and
 * puts another value there; `at` 0 exchanges the opcode. *place: where it begins. */
static uint32_t *broken(const struct shader *shader, uint32_t op, uint32_t at, uint32_t value,
                        uint32_t other, uint32_t *place)
{
    uint32_t *word = malloc(4 * (size_t)shader->word_count);
    assert_non_null(word);
    memcpy(word, shader->word, 4 * (size_t)shader->word_count);
    for (uint32_t i = 5; i < shader->word_count; i += word[i] >> 16) {
        if ((word[i] & 0xFFFFu) != op || (at > 0 && word[i + at] != value))
            continue;
        word[i + at] = at > 0 ? other : (word[i] & 0xFFFF0000u) | other;
        *place = i;
        return word;
    }
    fail_msg("%s has no instruction %u to break", shader->name, op);
    return NULL;
}

static void refuses(void **state, uint32_t op, uint32_t at, uint32_t value, uint32_t other,
                    const char *text)
{
    char said[512], wanted[256];
    const struct shader *shader = subject(*state);
    size_t count = shader->word_count;
    uint32_t place = 0, *word = broken(shader, op, at, value, other, &place);
    int code = run_tool(*state, word, &count, said, NULL);
    free(word);
    assert_int_equal(code, 1);
    snprintf(wanted, sizeof wanted, "trace_broken.spv: word %u: %s\n", (unsigned)place, text);
    if (!strstr(said, wanted))
        fail_msg("'%s' does not end with '%s'", said, wanted);
}

static void tool_refuses_dot_products(void **state)
{
    refuses(state, OP_FMUL, 0, 0, OP_DOT,
            "OpDot: refused in tracing shaders: the order of its sum is open");
}

static void tool_refuses_inexact_instructions(void **state)
{
    refuses(
        state, OP_EXT_INST, 4, UNPACK_HALF, PACK_HALF,
        "GLSL.std.450 PackHalf2x16 (58): refused in tracing shaders: its rounding is not promised");
}

static void tool_refuses_capabilities(void **state)
{
    refuses(state, OP_CAPABILITY, 1, CAPABILITY_SHADER, CAPABILITY_FLOAT16,
            "OpCapability: only Shader is promised everywhere");
}

static void tool_refuses_doubles(void **state)
{
    refuses(state, OP_TYPE_FLOAT, 2, 32, 64,
            "OpTypeFloat: only numbers of 32 bits are promised everywhere");
}

static void tool_refuses_a_module_cut_short(void **state)
{
    char said[512];
    const struct shader *shader = subject(*state);
    size_t count = shader->word_count - 1;
    assert_int_equal(run_tool(*state, shader->word, &count, said, NULL), 1);
    assert_non_null(strstr(said, "OpFunctionEnd"));
    count = 6; /* in the middle of OpCapability */
    assert_int_equal(run_tool(*state, shader->word, &count, said, NULL), 1);
    assert_non_null(strstr(said, "instruction length"));
    count = 3;
    assert_int_equal(run_tool(*state, shader->word, &count, said, NULL), 1);
    assert_non_null(strstr(said, "no SPIR-V header"));
}

static void tool_pins_what_came_bare(void **state)
{
    char said[512];
    const struct shader *shader = subject(*state);
    size_t count = 5;
    uint32_t *bare = malloc(4 * (size_t)shader->word_count);
    uint32_t *fixed = malloc(4 * ((size_t)shader->word_count + 4096));
    assert_true(bare && fixed);
    memcpy(bare, shader->word, 4 * count);
    for (uint32_t i = 5; i < shader->word_count; i += shader->word[i] >> 16) {
        const uint32_t *word = shader->word + i;
        if ((word[0] & 0xFFFFu) == OP_DECORATE && word[2] == NO_CONTRACTION)
            continue;
        memcpy(bare + count, word, 4 * (size_t)(word[0] >> 16));
        count += word[0] >> 16;
    }
    struct spirv_found before = look(bare, (uint32_t)count);
    assert_int_equal(before.bare, before.float_ops);
    assert_int_equal(run_tool(*state, bare, &count, said, fixed), 0);
    struct spirv_found after = look(fixed, (uint32_t)count);
    assert_int_equal(after.bare, 0);
    assert_int_equal(after.float_ops, before.float_ops);
    assert_int_equal(count, shader->word_count);
    free(bare);
    free(fixed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spirv_pins_every_float_operation),
        cmocka_unit_test(spirv_of_tracing_has_nothing_inexact),
        cmocka_unit_test(spirv_of_rendering_has_roots_and_powers_alone),
        cmocka_unit_test(spirv_needs_no_capability_but_shader),
        cmocka_unit_test(spirv_exists_for_every_layout),
        cmocka_unit_test_setup_teardown(tool_refuses_dot_products, make_bench, free_bench),
        cmocka_unit_test_setup_teardown(tool_refuses_inexact_instructions, make_bench, free_bench),
        cmocka_unit_test_setup_teardown(tool_refuses_capabilities, make_bench, free_bench),
        cmocka_unit_test_setup_teardown(tool_refuses_doubles, make_bench, free_bench),
        cmocka_unit_test_setup_teardown(tool_refuses_a_module_cut_short, make_bench, free_bench),
        cmocka_unit_test_setup_teardown(tool_pins_what_came_bare, make_bench, free_bench),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
