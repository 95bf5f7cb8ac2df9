/* What a report says of mismatches, cells and lists that are cut: the right answer of each, the
 * numbers of each cell, and how many scenes and figures are shown. */
#define _GNU_SOURCE /* open_memstream, mkdtemp */
#include "tests/bench/report_fixture.h"

#include "bench/chart/row_plot.h"

#define SCENES_SHOWN 64u

/* Adds the answer `prim` (negative: a miss) as "got" or "expected". */
static void set_answer(json_t *finding, const char *key, int prim)
{
    json_t *hit = prim < 0 ? json_null() : json_pack("{s:i, s:f}", "prim", prim, "t", 0.25 * prim);
    assert_int_equal(json_object_set_new(finding, key, hit), 0);
}

static void print_answer(char text[60], int prim)
{
    if (prim < 0)
        snprintf(text, 60, "a miss");
    else
        snprintf(text, 60, "triangle %d at t = %.9g", prim, 0.25 * prim);
}

/* The page of one mismatch. */
static char *page_with(json_t *finding)
{
    struct report report = empty();
    json_t *check = check_of("2", "0", "true", "2", "ok");
    json_t *row = json_array_get(json_object_get(check, "rows"), 0);
    assert_int_equal(json_object_set_new(row, "findings", json_pack("[o]", finding)), 0);
    add(&report, REPORT_CHECK, check, EXIT_MISMATCH);
    char *page = page_of(&report);
    report_free(&report);
    return page;
}

static void a_mismatch_of_bits_has_both_answers(void **state)
{
    (void)state;
    for (int got = -1; got < 3; got++)
        for (int expected = -1; expected < 3; expected++) {
            char text[3][60], line[200];
            json_t *finding = json_pack("{s:i, s:s}", "ray", 70 + got, "against", "cpu");
            set_answer(finding, "got", got);
            set_answer(finding, "expected", expected);
            print_answer(text[0], got);
            print_answer(text[1], expected);
            snprintf(line, sizeof line, ", ray %d: %s; engine cpu: %s</p>", 70 + got, text[0],
                     text[1]);
            char *page = page_with(finding);
            has(page, line);
            free(page);
        }
}

static void a_wrong_answer_has_the_right_one(void **state)
{
    (void)state;
    static const char *const wrong[] = {"missed", "phantom", "lost"};
    for (int right = -1; right < 3; right++)
        for (int lost = -1; lost < 3; lost++)
            for (size_t w = 0; w < ARRAY_COUNT(wrong); w++) {
                char line[300];
                json_t *finding = json_pack("{s:i, s:s, s:n, s:{s:s}}", "ray", 5, "against",
                                            "truth", "got", "judgement", "wrong", wrong[w]);
                json_t *judgement = json_object_get(finding, "judgement");
                if (right >= 0)
                    json_object_update_new(judgement,
                                           json_pack("{s:i, s:f, s:f}", "expected", right, "t_lo",
                                                     right + 0.5, "t_hi", right + 0.75));
                else
                    json_object_set_new(judgement, "expected", json_null());
                json_object_set_new(judgement, "lost", lost < 0 ? json_null() : json_integer(lost));
                int used = snprintf(line, sizeof line, ", ray 5: a miss; %s, right is ", wrong[w]);
                used += right < 0 ? snprintf(line + used, 40, "a miss")
                                  : snprintf(line + used, 80, "triangle %d at t from %d.5 to %d.75",
                                             right, right, right);
                if (lost >= 0)
                    used += snprintf(line + used, 60, ", and triangle %d behind it was lost", lost);
                snprintf(line + used, 10, "</p>");
                char *page = page_with(finding);
                has(page, line);
                free(page);
            }
}

/* What stands in the cell of a row of those numbers. */
static void print_cell(char *text, size_t size, int wrong, int bits, bool differs, bool vacuous)
{
    int used;
    if (!differs && !vacuous && wrong > 0)
        used = snprintf(text, size, ">%d wrong<", wrong);
    else if (!differs && !vacuous)
        used = snprintf(text, size, ">agrees<");
    else if (wrong > 0)
        used = snprintf(text, size, ">%d WRONG<", wrong);
    else if (bits > 0)
        used = snprintf(text, size, ">%d other bits<", bits);
    else
        used = snprintf(text, size, ">proves nothing<");
    used += snprintf(text + used, size - (size_t)used, "small>7 allowed");
    if (wrong > 0 && bits > 0)
        used += snprintf(text + used, size - (size_t)used, ", %d bits", bits);
    snprintf(text + used, size - (size_t)used, "</small></td>");
}

static void a_cell_has_the_numbers_of_its_row(void **state)
{
    (void)state;
    for (int wrong = 0; wrong < 3; wrong++)
        for (int bits = 0; bits < 9; bits += 4)
            for (int kind = 0; kind < 4; kind++) {
                bool differs = kind % 2, vacuous = kind / 2;
                char number[2][8], cell[200];
                struct report report = empty();
                snprintf(number[0], 8, "%d", wrong);
                snprintf(number[1], 8, "%d", bits);
                add(&report, REPORT_CHECK,
                    check_of(number[0], number[1], "true", differs ? "3" : "0",
                             vacuous ? "vacuous" : "ok"),
                    0);
                print_cell(cell, sizeof cell, wrong, bits, differs, vacuous);
                char *page = page_of(&report);
                has(page, cell);
                free(page);
                report_free(&report);
            }
}

static void scenes_are_shown_up_to_a_number(void **state)
{
    (void)state;
    for (size_t count = SCENES_SHOWN - 1; count < SCENES_SHOWN + 3; count++) {
        struct report report = empty();
        json_t *check = check_of("0", "0", "true", "0", "ok");
        json_t *scenes = json_object_get(check, "scenes");
        assert_int_equal(json_array_clear(scenes), 0);
        for (size_t i = 0; i < count; i++) {
            char name[20];
            snprintf(name, sizeof name, "scene-%zu", i);
            json_array_append_new(scenes, json_pack("{s:s}", "scene", name));
        }
        add(&report, REPORT_CHECK, check, 0);
        char *page = page_of(&report);
        for (size_t i = 0; i < count; i++) {
            char head[40];
            snprintf(head, sizeof head, "<h3>scene-%zu</h3>", i);
            assert_int_equal(occurrences(page, head), i < SCENES_SHOWN);
        }
        assert_int_equal(occurrences(page, ">Only the first 64 scenes are shown.<"),
                         count > SCENES_SHOWN);
        free(page);
        report_free(&report);
    }
}

static void figures_are_shown_up_to_a_number(void **state)
{
    (void)state;
    for (size_t count = ROW_PLOT_FIGURES - 1; count < ROW_PLOT_FIGURES + 3; count++) {
        struct report report = empty();
        json_t *error = json_of(error_text, NULL, 0), *rows = json_object_get(error, "rows");
        json_t *like = json_deep_copy(json_array_get(rows, 0));
        assert_int_equal(json_array_clear(rows), 0);
        for (size_t i = 0; i < count; i++) {
            json_t *row = json_deep_copy(like);
            json_object_set_new(row, "scene", json_sprintf("scene-%zu", i));
            json_array_append_new(rows, row);
        }
        json_decref(like);
        add(&report, REPORT_BENCH, error, 0);
        char *page = page_of(&report);
        size_t notes = occurrences(page, ">Only the first 16 figures are shown.<");
        size_t kinds = occurrences(page, ">Speed against error<") +
                       occurrences(page, ">Size against speed<") +
                       occurrences(page, ">Memory against speed<");
        assert_true(kinds > 0);
        assert_int_equal(notes, count > ROW_PLOT_FIGURES ? kinds : 0);
        assert_int_equal(occurrences(page, "<figure>"),
                         kinds * (count < ROW_PLOT_FIGURES ? count : ROW_PLOT_FIGURES));
        free(page);
        report_free(&report);
    }
}

/* A matrix of more than 5000 cells is left out; the page tells so. */
static void a_matrix_is_readable_or_left_out(void **state)
{
    (void)state;
    for (int lines = 70; lines < 73; lines++) {
        const int groups = 71;
        struct report report = empty();
        json_t *check = check_of("0", "0", "true", "0", "ok");
        json_t *rows = json_object_get(check, "rows");
        json_t *like = json_deep_copy(json_array_get(rows, 0));
        assert_int_equal(json_array_clear(rows), 0);
        for (int i = 0; i < (lines > groups ? lines : groups); i++) {
            json_t *row = json_deep_copy(like);
            json_object_set_new(row, "layout", json_sprintf("layout-%d", i % lines));
            json_object_set_new(row, "tri", json_sprintf("tri-%d", i % groups));
            json_array_append_new(rows, row);
        }
        json_decref(like);
        add(&report, REPORT_CHECK, check, 0);
        char *page = page_of(&report);
        bool shown = lines * groups <= 5000;
        assert_int_equal(occurrences(page, "class=\"matrix\""), shown);
        assert_int_equal(occurrences(page, ">The matrix is left out: it is too large.<"), !shown);
        free(page);
        report_free(&report);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_mismatch_of_bits_has_both_answers),
        cmocka_unit_test(a_wrong_answer_has_the_right_one),
        cmocka_unit_test(a_cell_has_the_numbers_of_its_row),
        cmocka_unit_test(scenes_are_shown_up_to_a_number),
        cmocka_unit_test(figures_are_shown_up_to_a_number),
        cmocka_unit_test(a_matrix_is_readable_or_left_out),
    };
    return cmocka_run_group_tests_name("report_right", tests, NULL, NULL);
}
