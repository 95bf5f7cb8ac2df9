/* Words and lines of any text are those of a plain reader, which splits the text into lines first;
 * numbers and what is told of words. */
#include "ref/base/rng.h"
#include "ref/files/scan.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

/* --- a plain reader --------------------------------------------------------------------------- */

#define TEXT_MOST 24u

/* What a byte of a text is. A line end of two bytes, and a backslash before a line end, are one
 * part; the bytes after the first of a part are MORE. */
enum plain_part { LETTER, BLANK, JOIN, LINE_END, COMMENT, MORE };

struct plain_parts {
    enum plain_part part[TEXT_MOST + 1];
    uint64_t line[TEXT_MOST + 1]; /* that the byte is on */
    size_t count;
};

static size_t line_end_at(const char *text, size_t i)
{
    return text[i] == '\r' && text[i + 1] == '\n' ? 2 : text[i] == '\r' || text[i] == '\n';
}

static struct plain_parts split(const char *text, bool joins, char comment)
{
    struct plain_parts p = {.count = strlen(text)};
    uint64_t line = 1;
    bool in_comment = false, in_word = false;
    for (size_t i = 0; i < p.count;) {
        const size_t joined = joins && text[i] == '\\' ? line_end_at(text, i + 1) : 0;
        size_t bytes = line_end_at(text, i);
        enum plain_part part = LINE_END;
        if (bytes == 0 && joined && !in_comment) {
            part = JOIN;
            bytes = 1 + joined;
        } else if (bytes == 0) {
            in_comment = in_comment || (!in_word && comment && text[i] == comment);
            part = in_comment ? COMMENT : strchr(" \t\v\f", text[i]) ? BLANK : LETTER;
            bytes = 1;
        }
        for (size_t b = 0; b < bytes; b++) {
            p.part[i + b] = b ? MORE : part;
            p.line[i + b] = line;
        }
        line += part == LINE_END || part == JOIN;
        in_comment = in_comment && part != LINE_END;
        in_word = part == LETTER;
        i += bytes;
    }
    p.part[p.count] = LINE_END;
    p.line[p.count] = line;
    return p;
}

/* The end of the part at i. */
static size_t behind(const struct plain_parts *p, size_t i)
{
    if (i < p->count)
        i++;
    while (i < p->count && p->part[i] == MORE)
        i++;
    return i;
}

static size_t skip_blanks(const struct plain_parts *p, size_t i)
{
    while (p->part[i] == BLANK || p->part[i] == JOIN)
        i = behind(p, i);
    return i;
}

static size_t next_line(const struct plain_parts *p, size_t i)
{
    while (p->part[i] != LINE_END)
        i = behind(p, i);
    return behind(p, i);
}

/* --- laws ------------------------------------------------------------------------------------- */

static void must_be_at(const struct scan *scan, const struct plain_parts *p, const char *text,
                       size_t i)
{
    assert_ptr_equal(scan->at, text + i);
    assert_int_equal(scan->line, p->line[i]);
    assert_int_equal(scan_word_done(scan), p->part[i] != LETTER && p->part[i] != COMMENT);
}

/* Reads words and, with `skips`, leaves lines early. */
static void read_all(const char *text, bool joins, char comment, struct rng *rng, bool skips)
{
    const struct plain_parts p = split(text, joins, comment);
    struct scan scan = scan_make("name", text, strlen(text));
    scan.joins = joins;
    scan.comment = comment;
    assert_false(scan.binary);
    for (size_t i = 0; i < p.count;) {
        const char *word;
        if (skips && rng_below(rng, 3) == 0) {
            scan_next_line(&scan);
            i = next_line(&p, i);
            must_be_at(&scan, &p, text, i);
            continue;
        }
        struct scan other = scan;
        const size_t length = scan_word(&scan, &word), from = i = skip_blanks(&p, i);
        scan_blanks(&other);
        must_be_at(&other, &p, text, i);
        assert_int_equal(scan_line_done(&other), p.part[i] == LINE_END || p.part[i] == COMMENT);
        assert_ptr_equal(word, text + i);
        while (p.part[i] == LETTER)
            i++;
        assert_int_equal(length, i - from);
        must_be_at(&scan, &p, text, i);
        if (length == 0) {
            scan_next_line(&scan);
            i = next_line(&p, i);
            must_be_at(&scan, &p, text, i);
        }
    }
    assert_ptr_equal(scan.at, scan.end);
}

static void words_and_lines_are_those_of_a_plain_reader(void **state)
{
    (void)state;
    static const char letter[] = "a# \t\v\f\n\r\\\\\n\r!";
    struct rng rng = rng_make(1, 0);
    for (uint32_t n = 0; n < 60000; n++) {
        char text[TEXT_MOST + 1] = {0};
        const uint32_t size = rng_below(&rng, TEXT_MOST);
        for (uint32_t i = 0; i < size; i++)
            text[i] = letter[rng_below(&rng, sizeof letter - 1)];
        read_all(text, n & 1, n & 2 ? '#' : 0, &rng, n & 4);
    }
}

/* The word in quotes, cut, and '?' for what cannot be printed; or what ends there. */
static void words_are_shown(void **state)
{
    (void)state;
    for (int c = 1; c < 256; c++)
        for (size_t length = 0; length < 60; length++) {
            char text[64] = {0}, wanted[64], shown[SCAN_SHOWN];
            memset(text, c, length);
            const struct scan scan = scan_make("name", text, length);
            const char *got = scan_show(&scan, shown);
            const bool line_end = c == '\n' || c == '\r', blank = strchr(" \t\v\f", c) != NULL;
            const int most = SCAN_SHOWN - 6, show = length < (size_t)most ? (int)length : most;
            char as[64] = {0};
            memset(as, c > 32 && c < 127 ? c : '?', length);
            snprintf(wanted, sizeof wanted, "'%.*s%s'", blank ? 0 : show, as,
                     length > (size_t)most && !blank ? "..." : "");
            assert_string_equal(got, length == 0 ? "end of file"
                                     : line_end  ? "end of line"
                                                 : wanted);
        }
}

/* Of a sign, up to 18 digits, and nothing else. */
static void whole_numbers_have_up_to_18_digits(void **state)
{
    (void)state;
    static const char *const sign[] = {"", "-", "+", "--", "+-"};
    static const char *const rest[] = {"", "x", ".", "-", " x", "\n", "\tx"};
    for (int digits = 0; digits <= 20; digits++)
        for (size_t s = 0; s < ARRAY_COUNT(sign); s++)
            for (size_t r = 0; r < ARRAY_COUNT(rest); r++)
                for (char digit = '0'; digit <= '9'; digit++) {
                    char text[64], word[32] = {0}, wanted[96];
                    struct reason reason = {""};
                    int64_t out = 5, plain = 0;
                    memset(word, digit, (size_t)digits);
                    for (int d = 0; d < digits && d < 18; d++)
                        plain = 10 * plain + (digit - '0');
                    snprintf(text, sizeof text, " %s%s%s", sign[s], word, rest[r]);
                    struct scan scan = scan_make("name", text, strlen(text));
                    const bool number = digits > 0 && digits <= 18 && s < 3;
                    const bool ok = number && (r == 0 || r > 3);
                    assert_int_equal(scan_whole(&scan, "what", &out, &reason),
                                     ok ? STATUS_OK : STATUS_INPUT);
                    assert_true(out == (!ok ? 0 : s == 1 ? -plain : plain));
                    const size_t blanks = strspn(text, " \t");
                    assert_ptr_equal(scan.at, text + blanks + (ok ? (size_t)digits + (s > 0) : 0));
                    char shown[SCAN_SHOWN];
                    snprintf(wanted, sizeof wanted, "name:1: what: %s is not a whole number",
                             scan_show(&scan, shown));
                    assert_string_equal(reason.text, ok ? "" : wanted);
                    scan = scan_make("name", text + 1, strlen(text) - 1);
                    assert_int_equal(scan_digits(&scan, &out), number);
                    assert_ptr_equal(scan.at, text + 1 + (number ? (size_t)digits + (s > 0) : 0));
                }
}

static void floats_are_finite_and_alone(void **state)
{
    (void)state;
    static const struct {
        const char *text, *why;
        float value;
        size_t at;
    } trial[] = {
        {" 1.5 x", "", 1.5f, 4},
        {"-2", "", -2, 2},
        {"\t3e2\n", "", 300, 4},
        {" 1e39 x", "name:1: what: '1e39' is beyond the range of a 32-bit float", 0, 1},
        {" -1e39", "name:1: what: '-1e39' is beyond the range of a 32-bit float", 0, 1},
        {" 1e39x", "name:1: what: '1e39x' is not a finite number", 0, 1},
        {" 1.5x", "name:1: what: '1.5x' is not a finite number", 0, 1},
        {"x", "name:1: what: 'x' is not a finite number", 0, 0},
        {" ", "name:1: what: end of file is not a finite number", 0, 1},
        {" \n1", "name:1: what: end of line is not a finite number", 0, 1},
    };
    for (size_t i = 0; i < ARRAY_COUNT(trial); i++) {
        struct reason reason = {""};
        float out = 7;
        struct scan scan = scan_make("name", trial[i].text, strlen(trial[i].text));
        assert_int_equal(scan_float(&scan, "what", &out, &reason),
                         trial[i].why[0] ? STATUS_INPUT : STATUS_OK);
        assert_string_equal(reason.text, trial[i].why);
        assert_true(out == trial[i].value);
        assert_ptr_equal(scan.at, trial[i].text + trial[i].at);
    }
}

/* Of text the line, of binary files the byte. */
static void failures_name_the_place(void **state)
{
    (void)state;
    static const char text[] = "a\nb\r\nc d";
    for (int binary = 0; binary < 2; binary++) {
        struct scan scan = scan_make("name", text, sizeof text - 1);
        const char *word;
        char wanted[80];
        scan.binary = binary;
        for (uint64_t line = 1; line <= 3; line++) {
            struct reason reason = {""};
            assert_int_equal(scan_word(&scan, &word), 1);
            snprintf(wanted, sizeof wanted,
                     binary ? "name: byte %d: rule 5 of x" : "name:%d: rule 5 of x",
                     binary ? (int)(scan.at - text) : (int)line);
            assert_int_equal(scan_fail(&scan, &reason, "rule %d of %s", 5, "x"), STATUS_INPUT);
            assert_string_equal(reason.text, wanted);
            scan_next_line(&scan);
        }
    }
}

/* Of digits alone, as long as they tell a number of 64 bits; zeros before it are digits. */
static void numbers_of_64_bits_are_whole(void **state)
{
    (void)state;
    static const struct {
        const char *word;
        uint64_t value;
        bool good;
    } cases[] = {{"0", 0, true},
                 {"007", 7, true},
                 {"999999999999999999", 999999999999999999u, true},
                 {"1000000000000000000", 1000000000000000000u, true},
                 {"9223372036854775807", INT64_MAX, true},
                 {"9223372036854775808", (uint64_t)1 << 63, true},
                 {"18446744073709551609", UINT64_MAX - 6, true},
                 {"18446744073709551615", UINT64_MAX, true},
                 {"0000018446744073709551615", UINT64_MAX, true},
                 {"18446744073709551616", 0, false},
                 {"18446744073709551620", 0, false},
                 {"99999999999999999999", 0, false},
                 {"-1", 0, false},
                 {"+1", 0, false},
                 {"1x", 0, false},
                 {"1.", 0, false},
                 {"/", 0, false},
                 {":", 0, false}};
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        char text[64];
        uint64_t value = 7;
        snprintf(text, sizeof text, " \t%s next", cases[i].word);
        struct scan scan = scan_make("name", text, strlen(text));
        assert_int_equal(scan_u64(&scan, &value), cases[i].good);
        assert_true(value == cases[i].value);
        if (cases[i].good)
            assert_string_equal(scan.at, " next");
    }
    uint64_t value = 7;
    struct scan scan = scan_make("name", "\n1", 2);
    assert_false(scan_u64(&scan, &value));
    assert_true(value == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words_and_lines_are_those_of_a_plain_reader),
        cmocka_unit_test(words_are_shown),
        cmocka_unit_test(whole_numbers_have_up_to_18_digits),
        cmocka_unit_test(numbers_of_64_bits_are_whole),
        cmocka_unit_test(floats_are_finite_and_alone),
        cmocka_unit_test(failures_name_the_place),
    };
    return cmocka_run_group_tests_name("scan", tests, NULL, NULL);
}
