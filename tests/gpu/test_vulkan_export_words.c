/* The comment of an exported finding: whatever a text of others holds, every character of it is
 * there, none ends the comment, and no line is too long. */
#include "tests/gpu/exported.h"

#define LONGEST 96

/* The comment with this in place of why the engine was not asked; the caller frees it. */
static char *comment_with(struct export_case *the, const char *begin, const char *text)
{
    static char *out; /* gcc 12 takes the text for the pointer's own place if that is a local one */
    size_t size = 0;
    FILE *stream = open_memstream(&out, &size);
    assert_non_null(stream);
    snprintf(the->not_asked, sizeof the->not_asked, "%s", text);
    export_comment(the, begin, stream);
    assert_int_equal(fclose(stream), 0);
    return out;
}

/* The paragraph of that title as one line, a blank for each of its ends. */
static void paragraph(const char *comment, const char *begin, const char *title, char *out)
{
    char head[80];
    size_t used = 0;
    snprintf(head, sizeof head, "\n%s%-12s", begin, title);
    const char *at = strstr(comment, head);
    assert_non_null(at);
    at += strlen(head);
    snprintf(head, sizeof head, "\n%s%-12s", begin, "");
    for (; *at; at++) {
        if (*at == '\n') {
            if (strncmp(at, head, strlen(head)) != 0)
                break;
            at += strlen(head) - 1;
            out[used++] = ' ';
        } else {
            out[used++] = *at;
        }
    }
    out[used] = '\0';
}

static void check(struct export_case *the, const char *begin, const char *text, const char *wanted)
{
    static const char before[] = "it was not run where this file was written: ";
    char is[600];
    char *comment = comment_with(the, begin, text);
    paragraph(comment, begin, "Answered", is);
    assert_int_equal(strncmp(is, before, strlen(before)), 0);
    assert_string_equal(is + strlen(before), wanted);
    assert_null(strstr(comment, "*/"));
    assert_null(strstr(comment, "/*"));
    for (const char *line = comment; line; line = strchr(line, '\n')) {
        line += *line == '\n';
        assert_true(strcspn(line, "\n") <= LONGEST);
    }
    free(comment);
}

static void every_character_is_there_or_replaced(void **state)
{
    (void)state;
    static const char *const begins[] = {"// ", "# "};
    struct finding_file file = corpus_file("wrong-item");
    struct export_case the = make_case(&file, "vulkan_brute", NULL);
    assert_null(the.here);
    for (size_t b = 0; b < ARRAY_COUNT(begins); b++)
        for (int c = 1; c < 256; c++) {
            char text[20], wanted[20], is = (char)(c < 0x20 || c > 0x7E ? '?' : c);
            if (c == ' ')
                continue;
            snprintf(text, sizeof text, "a%cb %cx y%c", c, c, c);
            snprintf(wanted, sizeof wanted, "a%cb %cx y%c", is, is, is);
            check(&the, begins[b], text, wanted);
        }
    export_case_free(&the);
    finding_file_free(&file);
}

static void no_text_ends_a_comment(void **state)
{
    (void)state;
    static const char *const pairs[][2] = {{"a */ b", "a |/ b"},
                                           {"a /* b", "a |* b"},
                                           {"/*/", "||/"},
                                           {"*/", "|/"},
                                           {"a/ *b", "a/ *b"},
                                           {"**/", "*|/"},
                                           {"//* x */*", "/|* x ||*"},
                                           {"/ / * * /", "/ / * * /"}};
    struct finding_file file = corpus_file("wrong-item");
    struct export_case the = make_case(&file, "vulkan_brute", NULL);
    for (size_t i = 0; i < ARRAY_COUNT(pairs); i++)
        check(&the, "// ", pairs[i][0], pairs[i][1]);
    export_case_free(&the);
    finding_file_free(&file);
}

/* Words of all lengths at every place of a line. */
static void lines_break_between_words(void **state)
{
    (void)state;
    struct finding_file file = corpus_file("wrong-item");
    struct export_case the = make_case(&file, "vulkan_brute", NULL);
    for (size_t first = 1; first < 60; first++)
        for (size_t second = 1; second < 60; second += 7) {
            char text[160] = "";
            memset(text, 'a', first);
            text[first] = ' ';
            memset(text + first + 1, 'b', second);
            strcat(text, " c d");
            check(&the, "# ", text, text);
        }
    export_case_free(&the);
    finding_file_free(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_character_is_there_or_replaced),
        cmocka_unit_test(no_text_ends_a_comment),
        cmocka_unit_test(lines_break_between_words),
    };
    return cmocka_run_group_tests_name("export_words", tests, NULL, NULL) ? 1 : 0;
}
