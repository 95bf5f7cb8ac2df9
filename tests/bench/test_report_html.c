/* The writer of HTML: nothing in a text can become markup, every element is closed, pictures keep
 * every byte. */
#define _GNU_SOURCE /* open_memstream */
#include "bench/report/report_html.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "tests/readers/well_formed.h"

/* A page in memory. */
struct html_sheet {
    struct html html;
    char *text;
    size_t size;
};

static void begin(struct html_sheet *sheet)
{
    *sheet = (struct html_sheet){.text = NULL};
    sheet->html.out = open_memstream(&sheet->text, &sheet->size);
    assert_non_null(sheet->html.out);
}

static const char *end(struct html_sheet *sheet)
{
    assert_int_equal(sheet->html.depth, 0);
    assert_int_equal(fclose(sheet->html.out), 0);
    return sheet->text;
}

static void text_never_becomes_markup(void **state)
{
    (void)state;
    static const char *const hostile[] = {"<script>alert(1)</script>",
                                          "</td></table>",
                                          "\" onload=\"x",
                                          "&lt;",
                                          "a & b",
                                          "\x01\x1b[31m",
                                          "\xff\xfe bytes",
                                          "<!-- ",
                                          "]]>",
                                          "%s%n"};
    for (size_t i = 0; i < ARRAY_COUNT(hostile); i++) {
        struct html_sheet sheet;
        begin(&sheet);
        html_begin(&sheet.html, "p", "title", hostile[i], NULL);
        html_text(&sheet.html, hostile[i]);
        html_format(&sheet.html, "%s", hostile[i]);
        html_element(&sheet.html, "b", hostile[i], hostile[i]);
        html_element_format(&sheet.html, "b", NULL, "%d %s", 1, hostile[i]);
        html_void(&sheet.html, "br", "class", hostile[i], NULL);
        html_end(&sheet.html, "p");
        const char *text = end(&sheet);
        if (!well_formed(text))
            fail_msg("%s", text);
        assert_int_equal(occurrences(text, "<"), 7); /* p, b, b, br and three ends */
        free(sheet.text);
    }
}

static void elements_are_closed(void **state)
{
    (void)state;
    struct html_sheet sheet;
    begin(&sheet);
    html_begin(&sheet.html, "table", NULL);
    html_begin(&sheet.html, "tr", "class", NULL, NULL);
    html_element(&sheet.html, "td", "n", "1");
    html_element(&sheet.html, "td", NULL, "");
    html_end(&sheet.html, "tr");
    html_end(&sheet.html, "table");
    assert_string_equal(end(&sheet), "<table>\n<tr>\n<td class=\"n\">1</td>\n<td></td>\n</tr>\n"
                                     "</table>");
    free(sheet.text);
}

static void a_long_text_is_whole(void **state)
{
    (void)state;
    char text[3000];
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    struct html_sheet sheet;
    begin(&sheet);
    html_element_format(&sheet.html, "p", NULL, "<%s", text);
    const char *page = end(&sheet);
    assert_int_equal(strlen(page), 3 + 4 + sizeof text - 1 + 4);
    assert_non_null(strstr(page, text));
    free(sheet.text);
}

static void base64_is_that_of_the_rfc(void **state)
{
    (void)state;
    static const char *const pair[][2] = {{"", ""},
                                          {"f", "Zg=="},
                                          {"fo", "Zm8="},
                                          {"foo", "Zm9v"},
                                          {"foob", "Zm9vYg=="},
                                          {"fooba", "Zm9vYmE="},
                                          {"foobar", "Zm9vYmFy"}};
    for (size_t i = 0; i < ARRAY_COUNT(pair); i++) {
        struct html_sheet sheet;
        begin(&sheet);
        html_base64(sheet.html.out, pair[i][0], strlen(pair[i][0]));
        assert_string_equal(end(&sheet), pair[i][1]);
        free(sheet.text);
    }
}

/* All 256 bytes at each of the three places, read back by another way. */
static void base64_keeps_every_byte(void **state)
{
    (void)state;
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    unsigned char bytes[256 + 2];
    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = (unsigned char)(i * 167);
    for (size_t skip = 0; skip < 3; skip++) {
        struct html_sheet sheet;
        size_t size = sizeof bytes - skip, got = 0;
        begin(&sheet);
        html_base64(sheet.html.out, bytes + skip, size);
        const char *text = end(&sheet);
        uint32_t bits = 0, held = 0;
        for (const char *at = text; *at && *at != '='; at++) {
            const char *place = strchr(digit, *at);
            assert_non_null(place);
            bits = bits << 6 | (uint32_t)(place - digit);
            held += 6;
            if (held < 8)
                continue;
            held -= 8;
            assert_true(got < size);
            assert_int_equal(bits >> held & 255u, bytes[skip + got++]);
        }
        assert_int_equal(got, size);
        assert_int_equal(strlen(text) % 4, 0);
        free(sheet.text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(text_never_becomes_markup), cmocka_unit_test(elements_are_closed),
        cmocka_unit_test(a_long_text_is_whole),      cmocka_unit_test(base64_is_that_of_the_rfc),
        cmocka_unit_test(base64_keeps_every_byte),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
