#define _POSIX_C_SOURCE 200809L
/* Waivers and the matrix: what they excuse, when they are themselves at fault, what is shown. */
#include "tests/hard/matrix.h"
#include "fuzz/findings/waivers.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

static enum status read_text(const char *text, struct waivers *out, struct reason *reason)
{
    char path[] = "/tmp/raydiff-waivers-XXXXXX";
    int fd = mkstemp(path);
    FILE *file = fd < 0 ? NULL : fdopen(fd, "w");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
    enum status status = waivers_read(path, out, reason);
    unlink(path);
    return status;
}

static void lines_are_read(void **state)
{
    struct waivers w;
    struct reason reason = {""};
    (void)state;
    assert_int_equal(read_text("# a comment\n\n"
                               "hard.03-*.embree.* @Embree_3.13 borders, as known https://a.b/c\n"
                               "  *.rf16.*\tneeds more  README.md\r\n",
                               &w, &reason),
                     STATUS_OK);
    assert_int_equal(w.count, 2);
    assert_string_equal(w.waiver[0].pattern, "hard.03-*.embree.*");
    assert_string_equal(w.waiver[0].version, "Embree 3.13");
    assert_string_equal(w.waiver[0].reason, "borders, as known");
    assert_string_equal(w.waiver[0].link, "https://a.b/c");
    assert_int_equal(w.waiver[0].line, 3);
    assert_null(w.waiver[1].version);
    assert_string_equal(w.waiver[1].link, "README.md");
    waivers_free(&w);
}

static void bad_lines_are_refused(void **state)
{
    static const char *const bad[] = {"*.rf16.*\n",
                                      "*.rf16.* because\n",
                                      "*.rf16.* https://a.b/c\n",
                                      "\n*.x.* @V https://a.b/c\n",
                                      "*.a.* @E_4..3 why https://a.b/c\n",
                                      "*.a.* @E_3..x why https://a.b/c\n",
                                      "*.a.* @E_..3 why https://a.b/c\n",
                                      "*.a.* @3..4 why https://a.b/c\n",
                                      "*.a.* why\x01 https://a.b/c\n",
                                      "*.a.* why https://a.b/c\n*.a.* how https://a.b/d\n"};
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
        struct waivers w;
        struct reason reason = {""};
        assert_int_equal(read_text(bad[i], &w, &reason), STATUS_INPUT);
        assert_non_null(strstr(reason.text, i == 3 || i == ARRAY_COUNT(bad) - 1 ? ":2: " : ":1: "));
        assert_int_equal(w.count, 0);
    }
}

/* Numbers are compared as numbers, each of the ends belongs to the range, and the name counts. */
static void versions_are_parts_or_ranges(void **state)
{
    static const struct {
        const char *said, *version;
        bool told;
    } cases[] = {
        {"Embree 3.13.5, 2 threads", "Embree 3.13", true},
        {"Embree 3.13.5, 2 threads", "Embree 4.", false},
        {"Embree 3.13.5, 2 threads", "Embree 3..4.3.3", true},
        {"Embree 3.0.0", "Embree 3..4.3.3", true},
        {"Embree 2.17.7", "Embree 3..4.3.3", false},
        {"Embree 4.3.3, 16 threads", "Embree 3..4.3.3", true},
        {"Embree 4.3.4, 2 threads", "Embree 3..4.3.3", false},
        {"Embree 4.4.0, 2 threads", "Embree 3..4.3.3", false},
        {"Embree 40.0.0, 2 threads", "Embree 3..4.3.3", false},
        {"Embree 4.3.3", "Embree 3..4.3", true},
        {"Embree 4.10.0", "Embree 3..4.3", false},
        {"Embree 4.10.0", "Embree 4.9..5", true},
        {"Embree 4.3", "Embree 4.3.0..4.3.3", true},
        {"Embree 4.3.3", "Embree 4.3.1..4.3", true}, /* all of 4.3 are up to 4.3 */
        {"Embree 4.3.0", "Embree 4.3.1..4.3", false},
        {"Embree 4.3.2", "Embree 4.3.1..4", true},
        {"Mesa 3.5", "Embree 3..4.3.3", false},
        {"OtherEmbree 3.5", "Embree 3..4.3.3", false},
        {"embree: 2 threads\nembree: Embree 4.3.3, 2 threads", "Embree 4..5", true},
        {"Embree is not here", "Embree 0..9", false},
        {"", "Embree 0..9", false},
    };
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++)
        if (version_told(cases[i].said, cases[i].version) != cases[i].told)
            fail_msg("'%s' of '%s'", cases[i].version, cases[i].said);
    struct waivers w;
    struct reason reason = {""};
    assert_int_equal(read_text("*.a.* @Embree_3..4.3.3 why https://a.b/c\n", &w, &reason),
                     STATUS_OK);
    assert_non_null(waivers_note(&w, "x.a.y", WAIVER_FAILED, "Embree 4.3.3, 2 threads"));
    assert_null(waivers_note(&w, "x.a.y", WAIVER_FAILED, "Embree 4.4.0, 2 threads"));
    waivers_free(&w);
}

/* A version as it is written, with its numbers: those that are not written are 0. */
struct said_version {
    char text[40];
    int number[4];
    size_t count;
};

static size_t all_versions(struct said_version *out)
{
    static const int few[] = {0, 3, 10};
    size_t made = 0;
    for (size_t count = 1, all = 3; count <= 4; count++, all *= 3)
        for (size_t i = 0; i < all; i++) {
            struct said_version *one = &out[made++];
            *one = (struct said_version){.count = count};
            for (size_t k = 0, rest = i, used = 0; k < count; k++, rest /= 3) {
                one->number[k] = few[rest % 3];
                used += (size_t)snprintf(one->text + used, sizeof one->text - used, "%s%d",
                                         k ? "." : "", one->number[k]);
            }
        }
    return made;
}

static int order_of(const struct said_version *a, const struct said_version *b, size_t count)
{
    for (size_t k = 0; k < count; k++)
        if (a->number[k] != b->number[k])
            return a->number[k] < b->number[k] ? -1 : 1;
    return 0;
}

/* Every version against ranges of every two: the numbers that the upper end does not have may be
 * any, those that the lower end does not have are 0. A version lies in the range of itself. */
static void ranges_hold_what_lies_between_their_ends(void **state)
{
    static struct said_version all[3 + 9 + 27 + 81];
    const size_t count = all_versions(all);
    size_t told = 0, ranges = 0;
    (void)state;
    for (size_t a = 0; a < count; a += 1 + a % 3)
        for (size_t b = 0; b < count; b += 1 + b % 2) {
            char version[100], line[160];
            struct waivers w;
            struct reason reason = {""};
            snprintf(version, sizeof version, "E %.39s..%.39s", all[a].text, all[b].text);
            bool good = order_of(&all[a], &all[b], all[b].count) <= 0;
            if (a % 8 == 0 && b % 8 == 0) { /* ends the wrong way round are refused */
                snprintf(line, sizeof line, "*.a.* @E_%s..%s why https://a.b/c\n", all[a].text,
                         all[b].text);
                assert_int_equal(read_text(line, &w, &reason), good ? STATUS_OK : STATUS_INPUT);
                waivers_free(&w);
            }
            ranges += good;
            for (size_t i = 0; i < count && good; i++) {
                char said[60];
                bool wanted = order_of(&all[a], &all[i], 4) <= 0 &&
                              order_of(&all[i], &all[b], all[b].count) <= 0;
                snprintf(said, sizeof said, "E %.39s, 2 threads", all[i].text);
                if (version_told(said, version) != wanted)
                    fail_msg("'%s' of '%s': %s", version, said, wanted ? "not told" : "told");
                told += wanted;
            }
        }
    assert_true(ranges > 500 && told > 10000);
    for (size_t i = 0; i < count; i++) {
        char version[100], said[60];
        snprintf(version, sizeof version, "E %s..%s", all[i].text, all[i].text);
        snprintf(said, sizeof said, "E %s", all[i].text);
        assert_true(version_told(said, version));
    }
}

/* Plays names against three waivers and judges these at the end. */
static void waivers_excuse_and_grow_old(void **state)
{
    struct waivers w;
    struct reason reason = {""};
    (void)state;
    assert_int_equal(read_text("*.a.* first https://a.b/c\n"
                               "*.b.* second https://a.b/c\n"
                               "*.c.* @Embree_3 third https://a.b/c\n"
                               "*.d.* fourth https://a.b/c\n"
                               "*.e.* fifth https://a.b/c\n",
                               &w, &reason),
                     STATUS_OK);
    assert_ptr_equal(waivers_note(&w, "x.a.b.y", WAIVER_FAILED, "Embree 3.13.5"), &w.waiver[0]);
    assert_null(waivers_note(&w, "x.z.y", WAIVER_FAILED, "Embree 3.13.5"));
    assert_null(waivers_note(&w, "x.a.y", WAIVER_PASSED, "Embree 3.13.5"));
    assert_null(waivers_note(&w, "x.c.y", WAIVER_PASSED, "Embree 3.13.5"));
    assert_null(waivers_note(&w, "x.d.y", WAIVER_PASSED, "Embree 3.13.5"));
    assert_null(waivers_note(&w, "x.e.y", WAIVER_SKIPPED, "Embree 3.13.5"));
    /* The second matched the first name too, which failed. */
    assert_int_equal(waiver_judge(&w.waiver[0], true, "Embree 3.13.5"), WAIVER_FINE);
    assert_int_equal(waiver_judge(&w.waiver[1], true, "Embree 3.13.5"), WAIVER_FINE);
    assert_int_equal(waiver_judge(&w.waiver[2], true, "Embree 4.3.0"), WAIVER_GONE);
    assert_int_equal(waiver_judge(&w.waiver[2], true, "Embree 3.13.5"), WAIVER_UNUSED);
    assert_int_equal(waiver_judge(&w.waiver[3], true, ""), WAIVER_UNUSED);
    assert_int_equal(waiver_judge(&w.waiver[3], false, ""), WAIVER_UNUSED);
    assert_int_equal(waiver_judge(&w.waiver[4], true, ""), WAIVER_FINE);
    /* Cut by a pattern: the fourth matches a name that was not played. */
    assert_true(waivers_count(&w, "x.d.y"));
    assert_int_equal(waiver_judge(&w.waiver[3], false, ""), WAIVER_UNUSED);
    assert_true(waivers_count(&w, "x.d.z")); /* of the third there may be more, too */
    assert_int_equal(waiver_judge(&w.waiver[3], false, ""), WAIVER_FINE);
    assert_true(waivers_count(&w, "x.c.y") && waivers_count(&w, NULL));
    assert_int_equal(waiver_judge(&w.waiver[2], false, "Embree 4.3.0"), WAIVER_GONE);
    assert_false(waivers_count(&w, "x.c.z") || waivers_count(&w, NULL));
    assert_int_equal(waiver_judge(&w.waiver[2], false, "Embree 4.3.0"), WAIVER_FINE);
    assert_int_equal(waiver_judge(&w.waiver[3], true, ""), WAIVER_UNUSED);
    /* A failure in another version is not excused, and is no sign that the waiver is needed. */
    assert_true(waivers_name_version(&w, "x.c.y") && !waivers_name_version(&w, "x.a.y"));
    assert_null(waivers_note(&w, "x.c.y", WAIVER_FAILED, "Embree 4.3.0"));
    assert_int_equal(waiver_judge(&w.waiver[2], true, "Embree 4.3.0"), WAIVER_GONE);
    assert_ptr_equal(waivers_note(&w, "x.c.y", WAIVER_FAILED, "Embree 3.13.5"), &w.waiver[2]);
    waivers_free(&w);
    assert_int_equal(read_text("*.no-such.* reason https://a.b/c\n", &w, &reason), STATUS_OK);
    (void)waivers_note(&w, "x.a.y", WAIVER_FAILED, "Embree 3.13.5");
    assert_int_equal(waiver_judge(&w.waiver[0], true, ""), WAIVER_NOTHING);
    assert_int_equal(waiver_judge(&w.waiver[0], false, ""), WAIVER_FINE);
    waivers_free(&w);
}

/* --- matrix ----------------------------------------------------------------------------------- */

static struct hard_member member(const char *engine, const char *layout, const char *tri)
{
    return (struct hard_member){.query = QUERY_CLOSEST,
                                .engine = engine_find(engine),
                                .layout = layout_find(layout),
                                .builder = builder_find("median"),
                                .box = box_test_find("robust"),
                                .tri = tri_test_find(tri)};
}

static void put(struct hard_matrix *m, size_t row, const struct hard_member *who,
                enum matrix_outcome outcome, const char *why)
{
    struct reason reason = {""};
    if (matrix_add(m, hard_case_at(row), who, outcome, 10, why, &reason))
        fail_msg("%s", reason.text);
}

/* One of each outcome; the cell of two shows the worse. */
static struct hard_matrix filled(void)
{
    struct hard_matrix m = {.row_count = 0};
    struct hard_member cpu = member("cpu", "f32", "mt"), woop = member("cpu", "f32", "woop"),
                       seed = member("cpu", "rtrs_rf", "mt"), gpu = member("vulkan", "f32", "mt");
    put(&m, 0, &cpu, OUTCOME_PASSED, "");
    put(&m, 0, &cpu, OUTCOME_FAILED, "1 ray < lost & | gone");
    put(&m, 0, &woop, OUTCOME_REFUSED, "");
    put(&m, 0, &gpu, OUTCOME_SKIPPED, "");
    put(&m, 1, &seed, OUTCOME_WAIVED, "F2 https://a.b/c");
    put(&m, 1, &seed, OUTCOME_WAIVED, "F2 https://a.b/c");
    put(&m, 1, &cpu, OUTCOME_KNOWN, "F9");
    return m;
}

static void matrix_counts(void **state)
{
    struct hard_matrix m = filled();
    (void)state;
    assert_int_equal(m.row_count, 2);
    assert_int_equal(m.column_count, 4);
    assert_int_equal(m.rays, 70);
    assert_int_equal(matrix_worst(matrix_at(&m, 0, 0)), OUTCOME_FAILED);
    assert_int_equal(matrix_worst(matrix_at(&m, 0, 3)), OUTCOME_COUNT);
    assert_int_equal(matrix_worst(matrix_at(&m, 1, 3)), OUTCOME_WAIVED);
    assert_true(matrix_in_table(&m, 3, 1) && !matrix_in_table(&m, 3, 0));
    assert_true(matrix_table_is_empty(&m, 2));
    assert_int_equal(m.note_count, 3); /* the two waived ones are one note */
    matrix_free(&m);
}

/* Every layout with every triangle test: as many columns as that are, and every result in its
 * own. */
static void matrix_is_as_wide_as_it_has_to_be(void **state)
{
    struct hard_matrix m = {.apart = true};
    size_t wide = 0;
    (void)state;
    for (size_t row = 0; row < 3; row++)
        for (size_t l = 0; layouts_all[l]; l++)
            for (size_t t = 0; tri_tests[t] && !layouts_all[l]->faithful; t++) {
                struct hard_member one = member("cpu", layouts_all[l]->name, tri_tests[t]->name);
                if (tri_tests[t]->faithful || hard_member_published(&one))
                    continue;
                wide += row == 0;
                put(&m, row, &one, row == 1 && l == 7 ? OUTCOME_FAILED : OUTCOME_PASSED, "");
            }
    assert_int_equal(m.column_count, wide);
    assert_true(wide > 64);
    for (size_t c = 0; c < wide; c++)
        for (size_t row = 0; row < 3; row++) {
            const bool bad = row == 1 && m.column[c].layout == layouts_all[7];
            assert_int_equal(matrix_at(&m, row, c)->count[OUTCOME_FAILED], bad);
            assert_int_equal(matrix_at(&m, row, c)->count[OUTCOME_PASSED], !bad);
        }
    assert_int_equal(matrix_worst(matrix_at(&m, 1000, wide - 1)), OUTCOME_COUNT);
    matrix_free(&m);
}

typedef void writer(const struct hard_matrix *matrix, const char *versions, FILE *out);

static void written_text(const struct hard_matrix *matrix, const char *versions, FILE *out)
{
    (void)versions;
    matrix_text(matrix, out);
}

static char *written(writer *write, const struct hard_matrix *m)
{
    char *text = NULL;
    size_t bytes = 0;
    FILE *out = open_memstream(&text, &bytes);
    assert_non_null(out);
    write(m, "cpu: <2 threads>\n", out);
    assert_int_equal(fclose(out), 0);
    return text;
}

/* Every row and every failure with its reproduction is shown; what is markup is escaped. */
static void matrix_is_shown(void **state)
{
    struct hard_matrix m = filled();
    const char *name = "raydiff conform 'hard.01-axis.closest.cpu.f32.median.robust.mt'";
    char *text = written(written_text, &m), *page = written(matrix_html, &m),
         *markdown = written(matrix_markdown, &m);
    (void)state;
    assert_non_null(strstr(text, name));
    assert_non_null(strstr(text, "\n01  axis                   F      r      s"));
    assert_non_null(strstr(text, "1 failed, 2 waived, 1 known, 1 passed, 1 refused, 1 skipped"));
    assert_non_null(strstr(markdown, "| 01 axis | FAILED | refused | skipped |"));
    assert_non_null(strstr(markdown, "1 ray &lt; lost &amp; \\| gone"));
    assert_non_null(strstr(markdown, "F2 https://a.b/c"));
    assert_non_null(strstr(page, "<td class=\"failed\" title=\"1 failed 1 passed \">FAILED</td>"));
    assert_non_null(strstr(page, "1 ray &lt; lost &amp; | gone"));
    assert_non_null(strstr(page, "cpu: &lt;2 threads&gt;"));
    assert_null(strstr(page, "lost &  "));
    assert_non_null(strstr(page, hard_case_at(1)->name));
    free(text);
    free(page);
    free(markdown);
    matrix_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_are_read),
        cmocka_unit_test(bad_lines_are_refused),
        cmocka_unit_test(versions_are_parts_or_ranges),
        cmocka_unit_test(ranges_hold_what_lies_between_their_ends),
        cmocka_unit_test(waivers_excuse_and_grow_old),
        cmocka_unit_test(matrix_counts),
        cmocka_unit_test(matrix_is_as_wide_as_it_has_to_be),
        cmocka_unit_test(matrix_is_shown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
