/* Lists of what is known, drawn, and read back word for word: patterns, versions, days, reasons and
 * links, with other lines between them, and whatever the last line ends with. */
#include "fuzz/findings/waivers.h"
#include "ref/base/rng.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static struct reason reason;

/* A list that is drawn: what each entry is to be, and its text, to which `end` is the last byte. */
struct drawn_entry {
    char pattern[20], version[60], until[24], reason[60], link[40];
    size_t line;
};

static size_t draw_list(struct rng *rng, struct drawn_entry *entry, const char *end, char *text)
{
    static const char *const other[] = {"", "# a comment", "  ", "\t# no entry", "#"};
    size_t count = 0, lines = 1 + rng_below(rng, 6);
    text[0] = '\0';
    for (size_t line = 1; line <= lines; line++) {
        struct drawn_entry *e = &entry[count];
        char *at = text + strlen(text);
        const uint32_t words = rng_below(rng, 4);
        const char *eol = line < lines ? "\n" : end;
        if (rng_below(rng, 3) == 0) {
            sprintf(at, "%s%s", other[rng_below(rng, ARRAY_COUNT(other))], eol);
            continue;
        }
        *e = (struct drawn_entry){.line = line};
        sprintf(e->pattern, "p%zu.*", line);
        const uint32_t day = rng_below(rng, 90);
        sprintf(e->until, "2026-0%u-1%u", 1 + day / 10, day % 10);
        strcpy(e->reason, "why");
        for (uint32_t w = 0; w < words; w++) {
            sprintf(e->version + strlen(e->version), "%sN%u", w ? " " : "", w);
            sprintf(e->reason + strlen(e->reason), "%s it_%u", w ? " " : "", w);
        }
        sprintf(e->link, "https://a.b/%zu", line);
        at += sprintf(at, "%s", e->pattern);
        if (words > 0)
            at += sprintf(at, " @%s", e->version);
        for (char *blank = text; words > 0 && (blank = strstr(blank, " N"));)
            *blank = '_';
        sprintf(at, " until %s %s %s%s", e->until, e->reason, e->link, eol);
        count++;
    }
    return count;
}

/* Each word of each line, whatever stands around it, and whether or not the last line has an end.
 */
static void every_entry_is_read_word_for_word(void **state)
{
    (void)state;
    static const char *const ends[] = {"\n", "", "\n\n", "\n# the end"};
    struct rng rng = rng_make(5, 1);
    size_t all = 0;
    for (uint32_t i = 0; i < 2000; i++) {
        struct drawn_entry want[6];
        struct waivers got;
        char *text = malloc(2000);
        assert_non_null(text);
        size_t count = draw_list(&rng, want, ends[i % ARRAY_COUNT(ends)], text);
        if (waivers_parse("list", text, strlen(text), true, &got, &reason))
            fail_msg("%s", reason.text);
        assert_int_equal(got.count, count);
        for (size_t k = 0; k < count; k++) {
            const struct waiver *is = &got.waiver[k];
            assert_string_equal(is->pattern, want[k].pattern);
            assert_int_equal(is->version != NULL, want[k].version[0] != '\0');
            assert_string_equal(is->version ? is->version : "", want[k].version);
            assert_string_equal(is->until, want[k].until);
            assert_string_equal(is->reason, want[k].reason);
            assert_string_equal(is->link, want[k].link);
            assert_int_equal(is->line, want[k].line);
        }
        all += count;
        waivers_free(&got);
    }
    assert_true(all > 3000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_entry_is_read_word_for_word)};
    return cmocka_run_group_tests_name("waivers_read", tests, NULL, NULL);
}
