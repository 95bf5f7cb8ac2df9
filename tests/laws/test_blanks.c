/* Blanks only separate words: in every text that is read line by line, any blanks at either end
 * of a line and between two words, any line end, and where the format has them empty lines and
 * comments, leave what is read as it is. */
#define _POSIX_C_SOURCE 200809L /* open_memstream */
#include "ref/outside/pipe_text.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/laws/text_samples.h"

/* --- the same in other bytes ------------------------------------------------------------------ */

/* How lines are written: of those that `line` is, or of all. */
struct manner {
    const char *name, *before, *between, *behind, *end, *above;
};

static const struct manner plain = {"as they are", "", " ", "", "\n", ""};
static const struct manner manners[] = {
    {"blanks before", " ", " ", "", "\n", ""},
    {"tabs before", "\t\t", " ", "", "\n", ""},
    {"two blanks between", "", "  ", "", "\n", ""},
    {"tabs between", "", "\t", "", "\n", ""},
    {"a page break between", "", "\f", "", "\n", ""},
    {"a blank behind", "", " ", " ", "\n", ""},
    {"blanks behind", "", " ", " \t ", "\n", ""},
    {"a tab behind", "", " ", "\t", "\n", ""},
    {"all blanks", "\t \v", " \f\t", "\v \f", "\n", ""},
    {"lines of Windows", "", " ", "", "\r\n", ""},
    {"blanks in lines of Windows", " ", "\t", "\t", "\r\n", ""},
};
static const struct manner empty_lines[] = {
    {"empty lines above", "", " ", "", "\n", "\n"},
    {"lines of blanks above", "", " ", "", "\n", " \t\n\n"},
    {"lines of old", "", " ", "", "\r", ""},
};
static const struct manner comments[] = {
    {"comments behind", "", " ", " # 1 x", "\n", ""},
    {"comments above", "", " ", "", "\n", "# v 1\n"},
    {"comments behind blanks above", "", " ", "", "\n", "\t# v 1\n"},
};

static size_t put(char *text, size_t at, const char *what, size_t length)
{
    assert_true(at + length < TEXT_MOST);
    memcpy(text + at, what, length);
    return at + length;
}

/* The sample with line `which` in that manner; or with all of them, if it has no line of that
 * number. Returns the bytes, `lines` how many there are. A comment does not stand behind a text
 * that is the rest of its line. */
static size_t write_sample(const struct sample *sample, const struct manner *manner, size_t which,
                           size_t lines, char text[TEXT_MOST])
{
    size_t size = 0, line = 0;
    for (const char *at = sample->text; *at; line++) {
        const struct manner *as = which == line || which >= lines ? manner : &plain;
        const bool rest = *at == '|';
        at += rest;
        /* The first line names the format: it is the first. */
        size = put(text, size, as->above, line ? strlen(as->above) : 0);
        size = put(text, size, as->before, strlen(as->before));
        for (; *at != '\n'; at++)
            size = *at == ' ' && !rest ? put(text, size, as->between, strlen(as->between))
                                       : put(text, size, at, 1);
        at++;
        const char *behind = as->behind; /* a text's own sign, or a blank that no text has */
        if (rest && strpbrk(behind, "#\v\f"))
            behind = strchr(behind, '#') ? "" : " \t";
        size = put(text, size, behind, strlen(behind));
        size = put(text, size, as->end, strlen(as->end));
    }
    text[size] = '\0';
    return size;
}

static size_t lines_of(const struct sample *sample)
{
    size_t lines = 0;
    for (const char *at = sample->text; *at; at++)
        lines += *at == '\n';
    return lines;
}

/* What is read of memory of exactly this size, so that the sanitizer sees a step too far; the
 * caller frees it. */
static char *what_is_read(const struct sample *sample, const char *manner, const char *text,
                          size_t size)
{
    char *copy = malloc(size + 1), *read = NULL;
    size_t read_size = 0;
    struct reason reason = {""};
    FILE *stream = open_memstream(&read, &read_size);
    assert_true(copy && stream);
    memcpy(copy, text, size + 1);
    if (sample->reads(copy, size, stream, &reason))
        fail_msg("%s, %s: %s; of\n%s", sample->what, manner, reason.text, text);
    assert_int_equal(fclose(stream), 0);
    free(copy);
    return read;
}

/* A manner in each line alone, and in all. */
static void must_be_read_alike(const struct sample *sample, const struct manner *manner,
                               const char *wanted)
{
    char text[TEXT_MOST];
    const size_t lines = lines_of(sample);
    for (size_t which = 0; which <= lines; which++) {
        const size_t size = write_sample(sample, manner, which, lines, text);
        char *read = what_is_read(sample, manner->name, text, size);
        if (strcmp(read, wanted) != 0)
            fail_msg("%s, %s, line %zu of\n%s\nis read as\n%s\nnot as\n%s", sample->what,
                     manner->name, which + 1, text, read, wanted);
        free(read);
    }
}

static void blanks_only_separate_words(void **state)
{
    (void)state;
    for (size_t s = 0; s < ARRAY_COUNT(samples); s++) {
        const struct sample *sample = &samples[s];
        char text[TEXT_MOST];
        size_t size = write_sample(sample, &plain, 0, lines_of(sample), text);
        char *wanted = what_is_read(sample, "as it is", text, size);
        for (size_t m = 0; m < ARRAY_COUNT(manners); m++)
            must_be_read_alike(sample, &manners[m], wanted);
        for (size_t m = 0; m < ARRAY_COUNT(empty_lines) && sample->empty_lines; m++)
            must_be_read_alike(sample, &empty_lines[m], wanted);
        for (size_t m = 0; m < ARRAY_COUNT(comments) && sample->comments; m++)
            must_be_read_alike(sample, &comments[m], wanted);
        text[--size] = '\0'; /* the last line has no end */
        char *cut = what_is_read(sample, "no last line end", text, size);
        assert_string_equal(cut, wanted);
        free(cut);
        free(wanted);
    }
}

/* Any byte in the name of a tree's scene: letters of any language stand in it as they are, and
 * so do all signs but that of a comment; what moves a cursor is refused. */
static void names_of_scenes_have_any_letters(void **state)
{
    (void)state;
    for (int byte = 1; byte < 256; byte++) {
        char text[120], name[32];
        struct tree_dump dump;
        struct reason reason = {""};
        if (byte == '#' || strchr(" \t\v\f\n\r", byte))
            continue;
        snprintf(name, sizeof name, "a %cmesh%c.obj", byte, byte);
        snprintf(text, sizeof text, "raydiff tree 1\nscene %s\nleaf 0 0 0 1 1 1 0\nend\n", name);
        const enum status status =
            tree_dump_read("f", text, strlen(text), DUMP_RAYDIFF, &dump, &reason);
        if (status != (byte < 0x20 || byte == 0x7F ? STATUS_INPUT : STATUS_OK))
            fail_msg("byte 0x%x: %s, '%s'", byte, status_text(status), reason.text);
        if (!status)
            assert_string_equal(dump.spec, name);
        tree_dump_free(&dump);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(blanks_only_separate_words),
                                       cmocka_unit_test(names_of_scenes_have_any_letters)};
    return cmocka_run_group_tests_name("blanks", tests, NULL, NULL);
}
