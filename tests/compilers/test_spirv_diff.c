/* What changed between two modules (gpu/bisect/spirv_diff.h), and SPIR-V for people
 * (gpu/bisect/spirv_say.h), beside spirv-dis. */
#include "gpu/bisect/spirv_say.h"
#include "gpu/shaders/shaders.h"
#include "ref/outside/tool.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define INSTRUCTIONS 60
#define WORDS        (5 + 3 * INSTRUCTIONS)

static uint64_t state = 7;

static uint32_t next(void)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(state >> 33);
}

struct drawn_module {
    uint32_t word[WORDS];
    size_t words;
};

/* Instructions of one to three words out of a few, so that many are alike. */
static void draw(struct drawn_module *out)
{
    *out = (struct drawn_module){{0x07230203u, 0x00010300u, 11, 10 + next() % 90, 0}, 5};
    for (uint32_t i = 0, count = next() % INSTRUCTIONS; i < count; i++) {
        const uint32_t length = 1 + next() % 3;
        out->word[out->words++] = length << 16 | (240 + next() % 3);
        for (uint32_t k = 1; k < length; k++)
            out->word[out->words++] = 1 + next() % 3;
    }
}

/* Another one: instructions of a drawn one are left out, doubled or replaced here and there. */
static void change(const struct drawn_module *from, struct drawn_module *out)
{
    memcpy(out->word, from->word, 5 * sizeof out->word[0]);
    out->word[3] = 10 + next() % 90;
    out->words = 5;
    for (size_t at = 5; at < from->words; at += from->word[at] >> 16) {
        const size_t length = from->word[at] >> 16;
        const uint32_t what = next() % 12;
        for (uint32_t k = 0; k < (what == 0 ? 0u : what == 1 ? 2u : 1u); k++) {
            if (out->words + length > WORDS)
                return;
            memcpy(out->word + out->words, from->word + at, length * 4);
            if (what == 2)
                out->word[out->words] ^= 7; /* another opcode */
            out->words += length;
        }
    }
}

/* Length of a longest common subsequence, by the rule that defines it. */
static size_t longest(const struct spirv_code *a, const struct spirv_code *b)
{
    static size_t length[INSTRUCTIONS * 2 + 2][INSTRUCTIONS * 2 + 2];
    memset(length, 0, sizeof length);
    for (size_t i = 1; i <= a->count; i++)
        for (size_t j = 1; j <= b->count; j++) {
            const size_t words = spirv_length(a, i - 1);
            const bool same = words == spirv_length(b, j - 1) &&
                              memcmp(spirv_words(a, i - 1), spirv_words(b, j - 1), 4 * words) == 0;
            length[i][j] = same                                  ? length[i - 1][j - 1] + 1
                           : length[i - 1][j] > length[i][j - 1] ? length[i - 1][j]
                                                                 : length[i][j - 1];
        }
    return length[a->count][b->count];
}

struct drawn_pair {
    struct drawn_module from, to;
    struct spirv_code a, b;
    struct spirv_diff diff;
};

static void pair_make(struct drawn_pair *p, int round)
{
    struct reason reason = {""};
    draw(&p->from);
    if (round % 4 == 0)
        draw(&p->to);
    else
        change(&p->from, &p->to);
    if (spirv_code_make(p->from.word, p->from.words, &p->a, &reason) ||
        spirv_code_make(p->to.word, p->to.words, &p->b, &reason) ||
        spirv_diff_make(&p->a, &p->b, &p->diff, &reason))
        fail_msg("%s", reason.text);
}

static void pair_free(struct drawn_pair *p)
{
    spirv_diff_free(&p->diff);
    spirv_code_free(&p->a);
    spirv_code_free(&p->b);
}

static uint32_t *apply(const struct drawn_pair *p, const bool *done, size_t *count)
{
    uint32_t *out;
    struct reason reason;
    assert_int_equal(spirv_diff_apply(&p->diff, done, &out, count, &reason), STATUS_OK);
    return out;
}

static void none_gives_one_and_all_the_other(void **state_)
{
    static struct drawn_pair p;
    (void)state_;
    for (int round = 0; round < 2000; round++) {
        bool done[2 * WORDS] = {false};
        size_t count;
        pair_make(&p, round);
        uint32_t *none = apply(&p, done, &count);
        const uint32_t bound = p.from.word[3] > p.to.word[3] ? p.from.word[3] : p.to.word[3];
        assert_int_equal(none[3], bound);
        none[3] = p.from.word[3];
        assert_int_equal(count, p.from.words);
        assert_memory_equal(none, p.from.word, 4 * count);
        memset(done, true, sizeof done);
        uint32_t *all = apply(&p, done, &count);
        assert_int_equal(count, p.to.words);
        assert_memory_equal(all + 5, p.to.word + 5, 4 * (count - 5));
        free(none);
        free(all);
        pair_free(&p);
    }
}

static void no_shorter_list_of_edits_does(void **state_)
{
    static struct drawn_pair p;
    (void)state_;
    for (int round = 0; round < 1000; round++) {
        pair_make(&p, round);
        assert_int_equal(p.diff.count, p.a.count + p.b.count - 2 * longest(&p.a, &p.b));
        for (size_t e = 1; e < p.diff.count; e++) {
            const struct spirv_edit *before = &p.diff.edit[e - 1], *edit = &p.diff.edit[e];
            assert_int_equal(edit->hunk, before->hunk + (edit->common != before->common));
        }
        assert_int_equal(p.diff.hunks, p.diff.count ? p.diff.edit[p.diff.count - 1].hunk + 1 : 0);
        pair_free(&p);
    }
}

/* Each edit alone changes the words by its own instruction. */
static void edits_are_independent(void **state_)
{
    static struct drawn_pair p;
    (void)state_;
    for (int round = 0; round < 300; round++) {
        pair_make(&p, round);
        for (size_t e = 0; e < p.diff.count; e++) {
            bool done[2 * WORDS] = {false};
            const struct spirv_edit *edit = &p.diff.edit[e];
            const size_t length = spirv_length(edit->added ? &p.b : &p.a, edit->at);
            size_t count;
            done[e] = true;
            free(apply(&p, done, &count));
            assert_int_equal(count, edit->added ? p.from.words + length : p.from.words - length);
        }
        pair_free(&p);
    }
}

static void what_is_no_module_is_refused(void **state_)
{
    const uint32_t bad[][7] = {{0x03022307u, 1, 1, 1, 0, 1u << 16 | 253},
                               {0x07230203u, 1, 1, 1, 0, 0},
                               {0x07230203u, 1, 1, 1, 0, 9u << 16 | 253}};
    (void)state_;
    for (size_t i = 0; i < 3; i++) {
        struct spirv_code code;
        struct reason reason;
        assert_int_equal(spirv_code_make(bad[i], 6, &code, &reason), STATUS_INPUT);
        assert_null(code.at);
    }
    struct spirv_code code;
    assert_int_equal(spirv_code_make(bad[1], 4, &code, NULL), STATUS_INPUT);
}

/* --- words for people ------------------------------------------------------------------------- */

/* The name of the instruction and all its ids, in order: what both sides say alike. */
static void take_ids(const char *line, size_t length, char *out)
{
    out[0] = '\0';
    for (const char *at = line; at < line + length;) {
        while (at < line + length && *at == ' ')
            at++;
        const size_t word = strcspn(at, " \n");
        if (*at == '"')
            break;
        if (*at == '%' || (strncmp(at, "Op", 2) == 0 && !strstr(out, "Op")))
            sprintf(out + strlen(out), "%.*s ", (int)word, at);
        at += word + 1;
    }
}

static void a_disassembler_says_the_same(void **state_)
{
    static const char *const argv[] = {"spirv-dis", "--raw-id", "--no-header", "-", NULL};
    static const char *const names[] = {"trace_f32", "trace_cwbvh80", "world_rf16", "render_f32"};
    (void)state_;
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        const struct shader *shader = shader_find(names[k]);
        const struct tool_order order = {.argv = argv,
                                         .in = shader->word,
                                         .in_size = 4 * (size_t)shader->word_count,
                                         .most = (size_t)1 << 24,
                                         .ms = 60000};
        struct tool_answer answer;
        struct spirv_code code;
        struct reason reason;
        if (tool_run(&order, &answer, &reason) == STATUS_UNSUPPORTED) {
            print_message("%s\n", reason.text);
            skip();
        }
        assert_int_equal(spirv_code_make(shader->word, shader->word_count, &code, &reason), 0);
        const char *line = answer.out;
        for (size_t i = 0; i < code.count; i++, line += strcspn(line, "\n") + 1) {
            char said[SPIRV_SAY_MOST], mine[1024], theirs[1024];
            if (spirv_op(&code, i) == 15) /* interfaces behind the name are left out */
                continue;
            spirv_say(spirv_words(&code, i), said);
            take_ids(said, strlen(said), mine);
            take_ids(line, strcspn(line, "\n"), theirs);
            if (strlen(said) + 1 < SPIRV_SAY_MOST)
                assert_string_equal(mine, theirs);
        }
        spirv_code_free(&code);
        tool_free(&answer);
    }
}

static void instructions_have_names(void **state_)
{
    const uint32_t fma[] = {8u << 16 | 12, 6, 9, 1, 50, 3, 4, 5};
    const uint32_t lost[] = {3u << 16 | 71, 9, 42};
    const uint32_t unknown[] = {3u << 16 | 4421, 9, 42};
    const uint32_t store[] = {3u << 16 | 62, 7, 8};
    char text[SPIRV_SAY_MOST];
    (void)state_;
    spirv_say(fma, text);
    assert_string_equal(text, "%9 = OpExtInst %6 %1 Fma %3 %4 %5");
    spirv_say_name(fma, text);
    assert_string_equal(text, "Fma");
    spirv_say(lost, text);
    assert_string_equal(text, "OpDecorate %9 NoContraction");
    spirv_say(unknown, text);
    assert_string_equal(text, "Op4421 9 42");
    assert_int_equal(spirv_result(fma), 9);
    assert_int_equal(spirv_operands(fma), 3);
    assert_int_equal(spirv_result(store), 0);
    assert_int_equal(spirv_result(unknown), 0);
}

/* The functions of a shader, as its sources call them; nothing outside of them. */
static void functions_have_their_names(void **state_)
{
    const struct shader *shader = shader_find("trace_f32");
    struct spirv_code code;
    struct reason reason;
    char text[SPIRV_SAY_MOST];
    unsigned functions = 0, tri_sums = 0, names = 0;
    (void)state_;
    assert_int_equal(spirv_code_make(shader->word, shader->word_count, &code, &reason), 0);
    spirv_function(&code, 0, text);
    assert_string_equal(text, "");
    bool inside = false;
    for (size_t i = 0; i < code.count; i++) {
        inside = inside || spirv_op(&code, i) == OP_FUNCTION;
        functions += spirv_op(&code, i) == OP_FUNCTION;
        names += spirv_op(&code, i) == OP_NAME;
        spirv_function(&code, i, text);
        assert_int_equal(text[0] != '\0', inside);
        assert_int_not_equal(text[0], '%');
        assert_null(strchr(text, '('));
        tri_sums += spirv_op(&code, i) == OP_FUNCTION && strcmp(text, "tri_sum") == 0;
        inside = inside && spirv_op(&code, i) != OP_FUNCTION_END;
    }
    assert_true(functions > 20);
    assert_int_equal(names, functions); /* of nothing else */
    assert_int_equal(tri_sums, 1);
    spirv_code_free(&code);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(none_gives_one_and_all_the_other),
        cmocka_unit_test(no_shorter_list_of_edits_does),
        cmocka_unit_test(edits_are_independent),
        cmocka_unit_test(what_is_no_module_is_refused),
        cmocka_unit_test(a_disassembler_says_the_same),
        cmocka_unit_test(instructions_have_names),
        cmocka_unit_test(functions_have_their_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
