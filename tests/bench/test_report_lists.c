/* The lists of section 5 of a report: as many mismatches as are promised, each once, and what was
 * left out is counted; the first finding alone is opened. */
#define _GNU_SOURCE /* open_memstream, mkdtemp */
#include "tests/bench/report_fixture.h"

#define SHOWN 60u /* mismatches of a page */

static json_t *finding_at(size_t ray)
{
    char command[64];
    snprintf(command, sizeof command, "raydiff explain number-%zu-", ray);
    return json_pack("{s:I, s:s, s:n, s:{s:s, s:i, s:f, s:f}, s:s}", "ray", (json_int_t)ray,
                     "against", "truth", "got", "judgement", "wrong", "missed", "expected", 4,
                     "t_lo", 1.5, "t_hi", 1.75, "explain", command);
}

/* A part of `count` mismatches from number `from` on, in rows of 7. */
static json_t *check_with(size_t from, size_t count)
{
    json_t *check = check_of("2", "0", "true", "2", "ok"), *row = NULL;
    json_t *rows = json_object_get(check, "rows"), *like = json_deep_copy(json_array_get(rows, 0));
    assert_int_equal(json_array_clear(rows), 0);
    for (size_t i = 0; i < count; i++) {
        if (i % 7 == 0) {
            row = json_deep_copy(like);
            assert_int_equal(json_object_set_new(row, "findings", json_array()), 0);
            assert_int_equal(json_array_append_new(rows, row), 0);
        }
        assert_int_equal(
            json_array_append_new(json_object_get(row, "findings"), finding_at(from + i)), 0);
    }
    json_decref(like);
    return check;
}

static void mismatches_are_shown_up_to_a_number_and_counted_behind_it(void **state)
{
    (void)state;
    static const size_t counts[][2] = {{0, 0},   {1, 0},   {0, 3},   {59, 0}, {60, 0}, {61, 0},
                                       {30, 30}, {30, 31}, {61, 61}, {0, 62}, {100, 7}};
    for (size_t i = 0; i < ARRAY_COUNT(counts); i++) {
        const size_t all = counts[i][0] + counts[i][1], shown = all < SHOWN ? all : SHOWN;
        char note[64], line[64];
        struct report report = empty();
        report.wanted[REPORT_CHECK] = true;
        add(&report, REPORT_CHECK, check_with(0, counts[i][0]), EXIT_MISMATCH);
        add(&report, REPORT_CHECK, check_with(counts[i][0], counts[i][1]), EXIT_MISMATCH);
        char *page = page_of(&report);
        for (size_t k = 0; k < all; k++) {
            snprintf(line, sizeof line, "raydiff explain number-%zu-", k);
            assert_int_equal(occurrences(page, line), k < shown);
            snprintf(line, sizeof line, ", ray %zu: a miss", k);
            assert_int_equal(occurrences(page, line), k < shown);
        }
        assert_int_equal(occurrences(page, "Mismatches of the agreement part"), all > 0);
        assert_int_equal(occurrences(page, "The agreement part met no mismatch."), all == 0);
        snprintf(note, sizeof note, ">%zu more are not shown.<", all - shown);
        assert_int_equal(occurrences(page, note), all > SHOWN);
        assert_int_equal(occurrences(page, "more are not shown."), all > SHOWN);
        free(page);
        report_free(&report);
    }
}

static void the_first_finding_is_opened(void **state)
{
    (void)state;
    for (size_t count = 0; count < 4; count++)
        for (size_t left_out = 0; left_out < 3; left_out++) {
            char note[64];
            struct report report = empty();
            report.wanted[REPORT_FINDING] = true;
            report.findings_left_out = left_out;
            for (size_t k = 0; k < count; k++)
                add(&report, REPORT_FINDING, json_of("{'files': [{'fails': true}]}", NULL, 0),
                    EXIT_MISMATCH);
            char *page = page_of(&report);
            assert_int_equal(occurrences(page, "<summary>explanation</summary>"), count);
            assert_int_equal(occurrences(page, "<details open=\"open\">"), count > 0);
            const char *open = strstr(page, "<details open=\"open\">");
            const char *closed = strstr(page, "<details>");
            assert_true(!closed || open < closed);
            assert_int_equal(occurrences(page, "The folder of findings holds none."), count == 0);
            snprintf(note, sizeof note, ">%zu more findings are not shown.<", left_out);
            assert_int_equal(occurrences(page, note), left_out > 0);
            assert_int_equal(occurrences(page, "more findings are not shown."), left_out > 0);
            free(page);
            report_free(&report);
        }
}

/* A row like that of the fixture, of another storage and with so many ties. */
static void add_row(json_t *rows, const json_t *like, const char *store, const char *builder,
                    int ties)
{
    json_t *row = json_deep_copy(like);
    json_t *own = store ? json_string(store) : json_null();
    assert_int_equal(json_object_set_new(row, "store", own), 0);
    assert_int_equal(json_object_set_new(row, "builder", json_string(builder)), 0);
    if (!store) /* of an engine without a tree */
        assert_int_equal(json_object_set_new(row, "layout", json_null()), 0);
    assert_int_equal(json_object_set_new(json_object_get(row, "counts"), "tie", json_integer(ties)),
                     0);
    assert_int_equal(json_array_append_new(rows, row), 0);
}

/* Every row that has an engine, a layout, a storage or a builder of its own stands in the matrix;
 * of rows that are alike in all of these the first. */
static void each_row_has_its_cell(void **state)
{
    (void)state;
    static const struct {
        const char *store, *builder;
        int ties;
        bool shown, several; /* several: storages, by then */
    } rows[] = {{NULL, "median", 101, true, false},       {"indexed", "median", 102, true, false},
                {"indexed", "median", 103, false, false}, {"indexed", "lbvh", 104, true, false},
                {"compact", "median", 105, true, true},   {"compact", "lbvh", 106, true, true},
                {"compact", "median", 107, false, true},  {NULL, "median", 108, false, true}};
    for (size_t count = 1; count <= ARRAY_COUNT(rows); count++) {
        struct report report = empty();
        json_t *check = check_of("0", "0", "true", "0", "ok");
        json_t *all = json_object_get(check, "rows");
        json_t *like = json_deep_copy(json_array_get(all, 0));
        assert_int_equal(json_array_clear(all), 0);
        for (size_t i = 0; i < count; i++)
            add_row(all, like, rows[i].store, rows[i].builder, rows[i].ties);
        json_decref(like);
        add(&report, REPORT_CHECK, check, 0);
        char *page = page_of(&report), *matrix = strstr(page, "class=\"matrix\"");
        assert_non_null(matrix);
        *strstr(matrix, "</table>") = '\0';
        for (size_t i = 0; i < count; i++) {
            char cell[40];
            snprintf(cell, sizeof cell, "<small>%d allowed</small>", rows[i].ties);
            assert_int_equal(occurrences(matrix, cell), rows[i].shown);
        }
        assert_int_equal(occurrences(matrix, ">storage<"), rows[count - 1].several);
        assert_int_equal(occurrences(matrix, ">compact<") > 0, rows[count - 1].several);
        free(page);
        report_free(&report);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mismatches_are_shown_up_to_a_number_and_counted_behind_it),
        cmocka_unit_test(the_first_finding_is_opened),
        cmocka_unit_test(each_row_has_its_cell),
    };
    return cmocka_run_group_tests_name("report_lists", tests, NULL, NULL);
}
