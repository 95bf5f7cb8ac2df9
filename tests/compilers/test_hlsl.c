/* HLSL has values in the place of specialization constants: of each constant that a shader has, the
 * first, the last, and those between. */
#include "gpu/shaders/compiler.h"
#include "gpu/shaders/shaders.h"
#include "ref/abi_world.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <string.h>

#define CONSTANTS (ABI_SPEC_LAYOUT_1 + 1)

static void each_constant_has_its_value(void **state)
{
    (void)state;
    static const uint32_t first[CONSTANTS] = {64, 1, 0, 0, 32, 0, 0, 0};
    static const uint32_t other[CONSTANTS] = {32, 2, 1, 1, 64, 1, 1, 1};
    static const size_t at[] = {ABI_SPEC_WORKGROUP, ABI_SPEC_STACK, ABI_SPEC_LAYOUT_0,
                                ABI_SPEC_LAYOUT_1};
    const struct shader *found = shader_find("trace_grid4");
    struct compiler compiler;
    struct compiled out, changed;
    struct reason reason = {""};
    uint32_t constant[CONSTANTS];
    assert_non_null(found);
    struct vk_shader shader = {.name = found->name,
                               .word = found->word,
                               .word_count = found->word_count,
                               .constant = first,
                               .constant_count = CONSTANTS};
    assert_int_equal(compiler_parse("hlsl", &compiler, &reason), STATUS_OK);
    const enum status status = compiler_run(&compiler, &shader, &out, &reason);
    if (status == STATUS_UNSUPPORTED) {
        print_message("SKIP %s\n", reason.text);
        skip();
    }
    if (status)
        fail_msg("%s", reason.text);
    shader.constant = constant;
    for (size_t i = 0; i < ARRAY_COUNT(at); i++) {
        memcpy(constant, first, sizeof constant);
        constant[at[i]] = other[at[i]];
        assert_int_equal(compiler_run(&compiler, &shader, &changed, &reason), STATUS_OK);
        if (changed.count == out.count &&
            memcmp(changed.word, out.word, sizeof *out.word * out.count) == 0)
            fail_msg("constant %zu has the value of another shader", at[i]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_constant_has_its_value)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
