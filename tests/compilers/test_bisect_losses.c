/* What raydiff bisect counts as lost: a NoContraction that a module has no more, of any operation.
 * Translators have no word for that of a negation, which rounds nothing: with them alone it is
 * none. Nothing is lost where no decorations were asked for. */
#include "gpu/bisect/bisect.h"
#include "gpu/shaders/shaders.h"
#include "gpu/shaders/spirv_words.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

enum { NEGATE = 127, ADD = 129, SUB = 131, MUL = 133 };

/* The module without the decoration of the first such operation that has one; its words. */
static size_t without(const struct shader *shader, uint32_t op, uint32_t *out)
{
    const uint32_t *word = shader->word;
    for (uint32_t i = 5; i < shader->word_count; i += word[i] >> 16) {
        if ((word[i] & 0xFFFFu) != op)
            continue;
        for (uint32_t d = 5; d < i; d += word[d] >> 16)
            if ((word[d] & 0xFFFFu) == OP_DECORATE && word[d + 1] == word[i + 2] &&
                word[d + 2] == NO_CONTRACTION) {
                const uint32_t length = word[d] >> 16;
                memcpy(out, word, 4 * (size_t)d);
                memcpy(out + d, word + d + length, 4 * (size_t)(shader->word_count - d - length));
                return shader->word_count - length;
            }
    }
    fail_msg("no operation %u with NoContraction", op);
    return 0;
}

static void a_decoration_that_is_gone_is_lost(void **state)
{
    (void)state;
    static const uint32_t ops[] = {NEGATE, ADD, SUB, MUL};
    static const struct {
        const char *name;
        bool translates, decorates;
    } ways[] = {{"opt", false, true},       {"passes:ccp", false, true}, {"raw", false, true},
                {"cross", true, true},      {"hlsl", true, true},        {"shaderc", true, true},
                {"opt:none", false, false}, {"cross:none", true, false}};
    static const uint32_t constant[8] = {64, 1, 0, 0, 32, 0, 0, 0};
    const struct shader *found = shader_find("trace_f32");
    const struct vk_shader shader = {.name = found->name,
                                     .word = found->word,
                                     .word_count = found->word_count,
                                     .constant = constant,
                                     .constant_count = 8};
    uint32_t *word = calloc(found->word_count, sizeof *word);
    assert_non_null(word);
    for (size_t w = 0; w < ARRAY_COUNT(ways); w++) {
        struct compiler compiler;
        struct reason reason = {""};
        unsigned loss = 77;
        assert_int_equal(compiler_parse(ways[w].name, &compiler, &reason), STATUS_OK);
        assert_int_equal(
            bisect_loses(&compiler, &shader, found->word, found->word_count, &loss, &reason),
            STATUS_OK);
        assert_int_equal(loss, 0);
        for (size_t i = 0; i < ARRAY_COUNT(ops); i++) {
            const size_t count = without(found, ops[i], word);
            const bool is = ways[w].decorates && !(ops[i] == NEGATE && ways[w].translates);
            assert_int_equal(bisect_loses(&compiler, &shader, word, count, &loss, &reason),
                             STATUS_OK);
            if ((loss & LOSS_DECORATION) != (is ? LOSS_DECORATION : 0))
                fail_msg("%s, operation %u: %u", ways[w].name, ops[i], loss);
        }
    }
    free(word);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_decoration_that_is_gone_is_lost)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
