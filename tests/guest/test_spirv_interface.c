/* Laws of gpu/shaders/spirv_interface.h: what a module expects is read from its words, and what is
 * not offered is refused. */
#include "gpu/shaders/spirv_interface.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#define OP(code, words) ((uint32_t)(words) << 16 | (code))

/* A module of a compute shader `main` and these decorations; returns its words. */
static size_t module(uint32_t word[64], uint32_t model, const char *name, uint32_t local_y,
                     uint32_t decoration, uint32_t value)
{
    const uint32_t head[] = {0x07230203, 0x10300, 0, 10, 0, OP(17, 2), 1, OP(15, 5), model, 1};
    const uint32_t tail[] = {OP(16, 6), 1, 17, 32, local_y, 1, OP(71, 4), 2, decoration, value};
    size_t at = sizeof head / sizeof *head;
    memcpy(word, head, sizeof head);
    memset(word + at, 0, 8);
    memcpy(word + at, name, strlen(name));
    word[7] = OP(15, 5);
    at += 2;
    memcpy(word + at, tail, sizeof tail);
    return at + sizeof tail / sizeof *tail;
}

static void must_say(uint32_t model, const char *name, uint32_t local_y, uint32_t decoration,
                     uint32_t value, const char *text)
{
    uint32_t word[64];
    struct spirv_interface found;
    struct reason reason = {""};
    const size_t count = module(word, model, name, local_y, decoration, value);
    const enum status status = spirv_interface(word, count, 4, &found, &reason);
    assert_int_equal(status, text ? STATUS_INPUT : STATUS_OK);
    if (text && !strstr(reason.text, text))
        fail_msg("'%s' has no '%s'", reason.text, text);
    assert_int_equal(found.local[0], text ? 0 : 32);
    assert_int_equal(found.local_chosen, !text && decoration == 1 && value == 0);
}

static void an_interface_is_read_from_the_words(void **state)
{
    (void)state;
    must_say(5, "main", 1, 33, 3, NULL);
    must_say(5, "main", 1, 34, 0, NULL);
    must_say(5, "main", 1, 1, 0, NULL); /* constant 0 is the workgroup's size */
    must_say(5, "main", 1, 1, 1, NULL);
}

static void what_is_not_offered_is_refused(void **state)
{
    (void)state;
    must_say(5, "main", 1, 33, 4, "binding 4: there are 0 to 3");
    must_say(5, "main", 1, 34, 1, "descriptor set 1");
    must_say(4, "main", 1, 33, 0, "no compute shader");
    must_say(5, "mai", 1, 33, 0, "no entry point main");
    must_say(5, "mainly", 1, 33, 0, "no entry point main");
    must_say(5, "main", 2, 33, 0, "a workgroup of 32 x 2 x 1");
}

static void each_prefix_is_no_module_or_says_why(void **state)
{
    uint32_t word[64];
    struct spirv_interface found;
    struct reason reason;
    const size_t count = module(word, 5, "main", 1, 33, 3);
    (void)state;
    for (size_t cut = 0; cut < count; cut++) {
        const enum status status = spirv_interface(word, cut, 4, &found, &reason);
        assert_true(status == STATUS_INPUT || (status == STATUS_OK && cut >= 12));
    }
    word[6] = 10; /* Float64 */
    assert_int_equal(spirv_interface(word, count, 4, &found, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "it needs 1 capabilities beyond Shader"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_interface_is_read_from_the_words),
        cmocka_unit_test(what_is_not_offered_is_refused),
        cmocka_unit_test(each_prefix_is_no_module_or_says_why),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
