/* Laws of vk_settle: where constants decide a branch, the module goes that
 * way; nothing else changes. */
#include "gpu/shaders/shaders.h"
#include "gpu/vk/vk_settle.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

enum { NOP = 0, SPEC_OP = 52, PHI = 245, MERGE = 247, LABEL = 248, BRANCH = 249, BRANCH_IF = 250 };

/* The words with the constants; NULL where they are no module. */
static uint32_t *settle(const uint32_t *word, uint32_t count, const uint32_t *value,
                        uint32_t values)
{
    uint32_t *out;
    assert_int_equal(vk_settle(word, count, value, values, &out), STATUS_OK);
    return out;
}

static uint32_t op_at(const uint32_t *word)
{
    return word[0] & 0xFFFF;
}

/* Modules in words, with numbers for what a test varies. */
#define INST(op, length) ((uint32_t)(length) << 16 | (op))
#define HEAD(bound)      0x07230203u, 0x00010300u, 0, bound, 0
enum { BOOL = 1, UINT, SPEC, THREE, IS, FUN, ENTRY, THEN, ELSE, END, VOID, FUN_TYPE, VALUE, BOUND };

/* if (SPEC op 3) THEN else ELSE; SPEC, constant 2, is 7. make() fills in what is 0. */
static const uint32_t choice[] = {HEAD(BOUND),
                                  INST(71, 4),
                                  SPEC,
                                  1,
                                  2,
                                  INST(19, 2),
                                  VOID,
                                  INST(20, 2),
                                  BOOL,
                                  INST(21, 4),
                                  UINT,
                                  32,
                                  0,
                                  INST(33, 3),
                                  FUN_TYPE,
                                  VOID,
                                  INST(50, 4),
                                  UINT,
                                  SPEC,
                                  7,
                                  INST(43, 4),
                                  UINT,
                                  THREE,
                                  3,
                                  INST(SPEC_OP, 6),
                                  BOOL,
                                  IS,
                                  0,
                                  SPEC,
                                  THREE,
                                  INST(54, 5),
                                  VOID,
                                  FUN,
                                  0,
                                  FUN_TYPE,
                                  INST(LABEL, 2),
                                  ENTRY,
                                  INST(MERGE, 3),
                                  END,
                                  0,
                                  INST(BRANCH_IF, 4),
                                  IS,
                                  THEN,
                                  ELSE,
                                  INST(LABEL, 2),
                                  THEN,
                                  INST(BRANCH, 2),
                                  END,
                                  INST(LABEL, 2),
                                  ELSE,
                                  0,
                                  INST(BRANCH, 2),
                                  END,
                                  INST(LABEL, 2),
                                  END,
                                  INST(253, 1),
                                  INST(56, 1)};

static void make(uint32_t op, uint32_t first_of_else, uint32_t *out, uint32_t *count)
{
    memcpy(out, choice, sizeof choice);
    *count = sizeof choice / sizeof choice[0];
    for (uint32_t i = 0; i < *count; i++) {
        if (out[i] == INST(SPEC_OP, 6))
            out[i + 3] = op;
        if (out[i] == ELSE && out[i - 1] == INST(LABEL, 2))
            out[i + 1] = INST(first_of_else, 1);
    }
}

/* Where the first branch of the module goes: its target; 0: it still depends on a condition. */
static uint32_t goes(const uint32_t *word, uint32_t count)
{
    for (uint32_t at = 5; at < count; at += word[at] >> 16) {
        if (op_at(word + at) == BRANCH_IF)
            return 0;
        if (op_at(word + at) == BRANCH)
            return word[at + 1];
    }
    return 0;
}

static void a_branch_goes_where_the_constants_send_it(void **state)
{
    (void)state;
    static const struct {
        uint32_t op, of_three, of_four; /* the target if SPEC is 3, and if it is 4 */
    } rule[] = {{170, THEN, ELSE}, {171, ELSE, THEN}, {172, 0, 0}};
    for (size_t i = 0; i < sizeof rule / sizeof rule[0]; i++) {
        uint32_t word[100], count;
        make(rule[i].op, NOP, word, &count);
        for (uint32_t spec = 3; spec <= 4; spec++) {
            const uint32_t value[] = {9, 9, spec};
            uint32_t *out = settle(word, count, value, 3);
            assert_non_null(out);
            assert_int_equal(goes(out, count), spec == 3 ? rule[i].of_three : rule[i].of_four);
            free(out);
        }
        uint32_t *out = settle(word, count, (uint32_t[]){3, 3}, 2); /* it is 7, as in the module */
        assert_int_equal(goes(out, count), rule[i].of_four);
        free(out);
    }
}

static void truth_values_are_put_together(void **state)
{
    (void)state;
    static const struct {
        uint32_t op;
        bool truth[2][2];
    } rule[] = {{164, {{1, 0}, {0, 1}}},
                {165, {{0, 1}, {1, 0}}},
                {166, {{0, 1}, {1, 1}}},
                {167, {{0, 0}, {0, 1}}},
                {168, {{1, 1}, {0, 0}}}};
    for (size_t i = 0; i < sizeof rule / sizeof rule[0]; i++)
        for (uint32_t a = 0; a < 2; a++)
            for (uint32_t b = 0; b < 2; b++) {
                const bool one = rule[i].op == 168;
                const uint32_t word[] = {HEAD(20),
                                         INST(42 - a, 3),
                                         1,
                                         2,
                                         INST(42 - b, 3),
                                         1,
                                         3,
                                         INST(SPEC_OP, one ? 5 : 6),
                                         1,
                                         4,
                                         rule[i].op,
                                         2,
                                         one ? INST(NOP, 1) : 3,
                                         INST(MERGE, 3),
                                         9,
                                         0,
                                         INST(BRANCH_IF, 6),
                                         4,
                                         7,
                                         8,
                                         1,
                                         1};
                const uint32_t count = sizeof word / sizeof word[0];
                uint32_t *out = settle(word, count, NULL, 0);
                assert_non_null(out);
                assert_int_equal(goes(out, count), rule[i].truth[a][b] ? 7 : 8);
                free(out);
            }
}

/* A block that begins with OpPhi names the blocks before it, of which none may be cut off. */
static void a_block_that_names_those_before_it_keeps_them(void **state)
{
    (void)state;
    uint32_t word[100], count;
    make(170, PHI, word, &count);
    uint32_t *left = settle(word, count, (uint32_t[]){0, 0, 3}, 3);
    uint32_t *taken = settle(word, count, (uint32_t[]){0, 0, 4}, 3);
    assert_non_null(left);
    assert_non_null(taken);
    assert_memory_equal(left, word, count * sizeof *word);
    assert_int_equal(goes(taken, count), ELSE);
    free(left);
    free(taken);
}

/* Every module of the build, with constants from 0 to 8: all but settled branches is as it was, and
 * what they cut off is cut off by a condition of constants. */
static void nothing_but_branches_changes(void **state)
{
    (void)state;
    size_t settled = 0;
    for (const struct shader *shader = shaders; shader->name; shader++)
        for (uint32_t all = 0; all <= 8; all += 4) {
            const uint32_t value[8] = {64, all, all, all, all, all, all, all};
            const uint32_t count = shader->word_count, *was = shader->word;
            uint32_t *out = settle(was, count, value, 8);
            assert_non_null(out);
            assert_memory_equal(out, was, 5 * sizeof *was);
            for (uint32_t at = 5, next; at < count; at = next) {
                next = at + (was[at] >> 16);
                if (memcmp(out + at, was + at, (next - at) * sizeof *was) == 0)
                    continue;
                assert_int_equal(op_at(was + at), MERGE);
                assert_int_equal(op_at(was + next), BRANCH_IF);
                const uint32_t target = next;
                next += was[next] >> 16;
                for (uint32_t i = at; i < next - 2; i++)
                    assert_int_equal(out[i], INST(NOP, 1));
                assert_int_equal(out[next - 2], INST(BRANCH, 2));
                assert_true(out[next - 1] == was[target + 2] || out[next - 1] == was[target + 3]);
                settled++;
            }
            free(out);
        }
    assert_true(settled > 1000);
}

static void what_is_no_module_is_refused(void **state)
{
    (void)state;
    uint32_t word[100], count;
    make(170, NOP, word, &count);
    for (uint32_t cut = 0; cut < count;
         cut++) { /* each a block of its own: nothing behind it is read */
        uint32_t *part = malloc((cut + 1) * sizeof *part);
        memcpy(part, word, cut * sizeof *part);
        free(settle(part, cut, NULL, 0));
        free(part);
    }
    const struct {
        uint32_t at, value;
    } fault[] = {{0, 1}, {3, 0}, {3, 0x400000}, {5, INST(71, 0)}, {count - 1, INST(56, 2)}};
    for (size_t i = 0; i < sizeof fault / sizeof fault[0]; i++) {
        make(170, NOP, word, &count);
        word[fault[i].at] = fault[i].value;
        assert_null(settle(word, count, NULL, 0));
    }
    for (uint32_t at = 5; at < count; at++) { /* any word may be wrong */
        static const uint32_t wrong[] = {0, 1, 0xFFFFFFFF, INST(MERGE, 3), INST(BRANCH_IF, 1)};
        for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
            make(170, NOP, word, &count);
            word[at] = wrong[i];
            free(settle(word, count, (uint32_t[]){3, 3, 3}, 3));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_branch_goes_where_the_constants_send_it),
        cmocka_unit_test(truth_values_are_put_together),
        cmocka_unit_test(a_block_that_names_those_before_it_keeps_them),
        cmocka_unit_test(nothing_but_branches_changes),
        cmocka_unit_test(what_is_no_module_is_refused),
    };
    return cmocka_run_group_tests_name("settle", tests, NULL, NULL);
}
