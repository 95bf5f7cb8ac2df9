/* A report shows as many of each list as it promises, from the first on, whatever a file holds. */
#define _GNU_SOURCE /* open_memstream, mkdtemp */
#include "tests/bench/report_fixture.h"

/* What a page shows at most. */
#define LINES      64u /* of a card; and operations */
#define DRIVERS    16u
#define LEVELS     4u
#define ROWS       2048u /* of a scene */
#define BOXES      8u    /* box tests of a matrix */
#define HANDLERS   16u
#define SAMPLES    5000u
#define COLUMNS    64u
#define TABLE_ROWS 400u
#define BENCHMARKS 16u
#define PAIRS      64u /* of a part */

/* The page of that part alone. Takes `json`. */
static char *page_of_part(enum report_kind kind, json_t *json)
{
    struct report report = empty();
    add(&report, kind, json, 0);
    char *page = page_of(&report);
    report_free(&report);
    return page;
}

/* Whether `page` has "NAME-NUMBER" between `before` and `after`: each of the first `most` so many
 * times, and no other of `count`. */
static void first_are_shown(const char *page, const char *before, const char *after, size_t count,
                            size_t most, size_t times)
{
    for (size_t i = 0; i < count; i++) {
        char text[100];
        snprintf(text, sizeof text, "%s%zu%s", before, i, after);
        if (occurrences(page, text) != (i < most ? times : 0))
            fail_msg("%zu times %s, of %zu", occurrences(page, text), text, count);
    }
}

/* A card of `lines` lines, of which the one at `at` is that of `ops` operations. */
static json_t *card_of(size_t lines, size_t at, size_t ops)
{
    json_t *card = json_object();
    for (size_t i = 0; i < lines; i++) {
        char name[32];
        snprintf(name, sizeof name, "line-%zu", i);
        if (i != at)
            assert_int_equal(json_object_set_new(card, name, json_sprintf("value-%zu", i)), 0);
        json_t *list = json_array();
        for (size_t k = 0; i == at && k < ops; k++)
            json_array_append_new(list,
                                  json_pack("{s:o, s:i, s:i}", "op", json_sprintf("op-%zu", k),
                                            "ordinary_differs", 1000 + (int)k, "ordinary", 9000));
        if (i == at)
            assert_int_equal(json_object_set(card, "ops", list), 0);
        json_decref(list);
    }
    return card;
}

static void a_card_has_its_first_lines(void **state)
{
    (void)state;
    for (size_t lines = LINES - 1; lines < LINES + 4; lines++)
        for (size_t at = lines - 1; at < lines + 1; at++) {
            json_t *card = card_of(lines, at, 2);
            char *page = page_of_part(
                REPORT_MACHINE, json_pack("{s:[], s:[{s:s, s:s, s:O}, {s:s, s:s, s:o}]}", "engines",
                                          "drivers", "name", "one", "packages", "p", "card", card,
                                          "name", "two", "packages", "p", "card", card));
            size_t plain = lines - (at < lines); /* the operations stand last, if at all */
            first_are_shown(page, "<th>line-", "</th>", plain, LINES, 1);
            first_are_shown(page, "<td>value-", "</td>", plain, LINES, 2);
            first_are_shown(page, "<th>op-", "</th>", 2, at < lines && at < LINES ? 2 : 0, 1);
            free(page);
        }
}

static void a_card_has_its_first_operations(void **state)
{
    (void)state;
    for (size_t ops = LINES - 1; ops < LINES + 3; ops++) {
        char *page = page_of_part(
            REPORT_MACHINE, json_pack("{s:[], s:[{s:s, s:s, s:o}]}", "engines", "drivers", "name",
                                      "one", "packages", "p", "card", card_of(2, 0, ops)));
        first_are_shown(page, "<th>op-", "</th>", ops, LINES, 1);
        for (size_t i = 0; i < ops; i++) {
            char text[40];
            snprintf(text, sizeof text, "<td>%zu of 9000 differ", 1000 + i);
            assert_int_equal(occurrences(page, text), i < LINES);
        }
        has(page, "<th>line-1</th>");
        free(page);
    }
}

/* Of `drivers` every third does not run. */
static void the_first_drivers_are_shown(void **state)
{
    (void)state;
    for (size_t count = DRIVERS - 1; count < DRIVERS + 4; count++) {
        json_t *drivers = json_array();
        for (size_t i = 0; i < count; i++) {
            json_t *driver = i % 3 == 2 ? json_pack("{s:s}", "why", "none")
                                        : json_pack("{s:{s:i}}", "card", "line", (int)i);
            json_object_set_new(driver, "name", json_sprintf("driver-%zu", i));
            json_object_set_new(driver, "packages", json_sprintf("package-%zu", i));
            json_array_append_new(drivers, driver);
        }
        char *page =
            page_of_part(REPORT_MACHINE, json_pack("{s:[], s:o}", "engines", "drivers", drivers));
        for (size_t i = 0; i < count; i++) {
            const bool runs = i % 3 != 2, shown = i < DRIVERS;
            char text[60];
            snprintf(text, sizeof text, "<th>driver-%zu</th>", i);
            assert_int_equal(occurrences(page, text), shown && runs);
            snprintf(text, sizeof text, "<td>%zu</td>", i);
            assert_int_equal(occurrences(page, text), shown && runs);
            snprintf(text, sizeof text, "<td>package-%zu</td>", i);
            assert_int_equal(occurrences(page, text), shown && runs);
            snprintf(text, sizeof text, ">Driver driver-%zu does not run: none<", i);
            assert_int_equal(occurrences(page, text), shown && !runs);
        }
        free(page);
    }
}

/* What lies deeper in a card than its levels is left out, in objects and in lists. */
static void a_card_is_shown_to_its_depth(void **state)
{
    (void)state;
    for (size_t depth = 0; depth < LEVELS + 2; depth++)
        for (int lists = 0; lists < 2; lists++) {
            json_t *value = json_string("the-ground");
            for (size_t i = 0; i < depth; i++)
                value = lists ? json_pack("[o]", value) : json_pack("{s:o}", "in", value);
            char *page = page_of_part(
                REPORT_MACHINE, json_pack("{s:[], s:[{s:s, s:s, s:{s:o}}]}", "engines", "drivers",
                                          "name", "one", "packages", "p", "card", "top", value));
            assert_int_equal(occurrences(page, "the-ground"), depth < LEVELS);
            free(page);
        }
}

/* Of a scene so many rows count, and those of other scenes between them do not. */
static void a_scene_has_its_first_rows(void **state)
{
    (void)state;
    for (size_t count = ROWS - 1; count < ROWS + 2; count++) {
        char text[60];
        json_t *check = check_of("0", "0", "true", "0", "ok"),
               *rows = json_object_get(check, "rows");
        json_t *like = json_deep_copy(json_array_get(rows, 0));
        assert_int_equal(json_array_clear(rows), 0);
        for (size_t i = 0; i < count + 20; i++) {
            json_t *row = json_deep_copy(like);
            if (i % 5 == 4 && i < 100)
                json_object_set_new(row, "scene", json_string("another"));
            if (i + 3 > count + 20)
                json_object_set_new(row, "builder", json_sprintf("last-%zu", count + 20 - i));
            json_array_append_new(rows, row);
        }
        json_decref(like);
        char *page = page_of_part(REPORT_CHECK, check);
        size_t shown = count < ROWS ? count : ROWS;
        snprintf(text, sizeof text, "<summary>all %zu rows: ", shown);
        assert_int_equal(occurrences(page, text), 1);
        assert_int_equal(occurrences(page, "<summary>all "), 1);
        for (size_t last = 1; last < 3; last++) {
            snprintf(text, sizeof text, "<td>last-%zu</td>", last);
            assert_int_equal(occurrences(page, text) > 0, count - last < shown);
        }
        free(page);
    }
}

/* Each row stands below its own box test, or in no cell: never below another. */
static void a_matrix_has_its_first_box_tests(void **state)
{
    (void)state;
    for (size_t count = BOXES - 1; count < BOXES + 3; count++)
        for (int lines = 1; lines < 3; lines++) {
            json_t *check = check_of("0", "0", "true", "0", "ok");
            json_t *rows = json_object_get(check, "rows");
            json_t *like = json_deep_copy(json_array_get(rows, 0));
            assert_int_equal(json_array_clear(rows), 0);
            for (size_t i = 0; i < count; i++) {
                json_t *row = json_deep_copy(like);
                json_object_set_new(row, "box", json_sprintf("box-%zu", i));
                if (lines > 1 && i >= BOXES) /* a line of its own, with no row of the first */
                    json_object_set_new(row, "layout", json_string("another"));
                json_object_set_new(json_object_get(row, "counts"), "tie",
                                    json_integer(300 + (json_int_t)i));
                json_array_append_new(rows, row);
            }
            json_decref(like);
            char *page = page_of_part(REPORT_CHECK, check);
            first_are_shown(page, "box box-", "</th>", count, BOXES, 1);
            for (size_t i = 0; i < count; i++) {
                char text[60];
                snprintf(text, sizeof text, "<small>%zu allowed</small>", 300 + i);
                assert_int_equal(occurrences(page, text), i < BOXES);
            }
            free(page);
        }
}

/* Runs of frames: `count` handlers of the samples 1, 2, ... `samples` ms. */
static json_t *frames_of(size_t count, size_t samples, double last)
{
    json_t *handlers = json_array();
    for (size_t i = 0; i < count; i++) {
        json_t *times = json_array();
        for (size_t k = 0; k < samples; k++)
            json_array_append_new(times, json_real(k + 1 < samples ? 1.0 + (double)(k % 7) : last));
        json_array_append_new(handlers,
                              json_pack("{s:o, s:i, s:f, s:f, s:f, s:f, s:o}", "handler",
                                        json_sprintf("handler-%zu", i), "bytes", 7000 + (int)i,
                                        "average_ms", 2.0, "min_ms", 1.0, "max_ms", 7.0,
                                        "median_ms", 2.0, "samples_ms", times));
    }
    return json_pack("{s:s, s:o}", "title", "t", "handlers", handlers);
}

static void the_first_handlers_are_shown(void **state)
{
    (void)state;
    for (size_t count = HANDLERS - 1; count < HANDLERS + 3; count++) {
        char *page = page_of_part(REPORT_BENCH, frames_of(count, 3, 1));
        first_are_shown(page, "<th>handler-", "</th>", count, HANDLERS, 1);
        first_are_shown(strstr(page, "<svg"), /* and the table */
                        ">handler-", "<", count, HANDLERS, 2);
        free(page);
    }
}

/* A chart has its first samples: one behind them changes nothing, and the last of them much. */
static void a_chart_has_its_first_samples(void **state)
{
    (void)state;
    for (size_t samples = SAMPLES - 1; samples < SAMPLES + 2; samples++) {
        char *low = page_of_part(REPORT_BENCH, frames_of(1, samples, 1.0));
        char *high = page_of_part(REPORT_BENCH, frames_of(1, samples, 90.0));
        assert_int_equal(strcmp(low, high) == 0, samples > SAMPLES);
        free(low);
        free(high);
    }
}

/* Rows of `benchmarks` benchmarks by turns, each with columns and a number of its own. */
static json_t *bench_of(size_t rows, size_t benchmarks, size_t columns)
{
    json_t *all = json_array();
    for (size_t i = 0; i < rows; i++) {
        json_t *row =
            json_pack("{s:o}", "benchmark", json_sprintf("benchmark-%zu", i % benchmarks));
        for (size_t k = 0; k < columns; k++) {
            char name[32];
            snprintf(name, sizeof name, "column-%zu", k);
            json_object_set_new(row, name, json_sprintf("%zu-of-%zu", i, k));
        }
        json_array_append_new(all, row);
    }
    return json_pack("{s:o}", "rows", all);
}

static void a_table_has_its_first_columns_and_rows(void **state)
{
    (void)state;
    for (size_t columns = COLUMNS - 1; columns < COLUMNS + 3; columns++) {
        char *page = page_of_part(REPORT_BENCH, bench_of(2, 1, columns));
        first_are_shown(page, "<th>column-", "</th>", columns, COLUMNS, 1);
        first_are_shown(page, "<td>0-of-", "</td>", columns, COLUMNS, 1);
        first_are_shown(page, "<td>1-of-", "</td>", columns, COLUMNS, 1);
        free(page);
    }
    for (size_t rows = TABLE_ROWS - 1; rows < TABLE_ROWS + 3; rows++) {
        char text[60], *page = page_of_part(REPORT_BENCH, bench_of(rows, 1, 1));
        first_are_shown(page, "<td>", "-of-0</td>", rows, TABLE_ROWS, 1);
        snprintf(text, sizeof text, ">%zu more rows are left out.<", rows - TABLE_ROWS);
        assert_int_equal(occurrences(page, text), rows > TABLE_ROWS);
        assert_int_equal(occurrences(page, "more rows are left out."), rows > TABLE_ROWS);
        free(page);
    }
}

/* The first row has the columns; another row has those of its own that are among them. */
static void the_first_row_has_the_columns(void **state)
{
    (void)state;
    for (size_t of = 0; of < 3; of++) {
        json_t *bench = bench_of(3, 1, 2), *rows = json_object_get(bench, "rows");
        json_object_set_new(json_array_get(rows, of), "its-own", json_string("its-value"));
        json_object_del(json_array_get(rows, (of + 1) % 3), "column-1");
        char *page = page_of_part(REPORT_BENCH, bench);
        assert_int_equal(occurrences(page, "<th>its-own</th>"), of == 0);
        assert_int_equal(occurrences(page, "<td>its-value</td>"), of == 0);
        assert_int_equal(occurrences(page, "<th>column-1</th>"), of != 2);
        assert_int_equal(occurrences(page, "-of-1</td>"), of != 2 ? 2 : 0);
        free(page);
    }
}

/* The title is that of the document and that of its heading. */
static void the_document_has_the_title(void **state)
{
    (void)state;
    struct report report = empty();
    char *page = page_of(&report);
    assert_int_equal(occurrences(page, "<title>title &lt;&amp;&gt;</title>"), 1);
    assert_int_equal(occurrences(page, ">title &lt;&amp;&gt;</h1>"), 1);
    free(page);
    report_free(&report);
}

static void a_part_has_its_first_benchmarks(void **state)
{
    (void)state;
    for (size_t count = BENCHMARKS - 1; count < BENCHMARKS + 3; count++) {
        char *page = page_of_part(REPORT_BENCH, bench_of(2 * count, count, 1));
        first_are_shown(page, "<h3>benchmark-", "</h3>", count, BENCHMARKS, 1);
        first_are_shown(page, "<summary>all 2 rows of benchmark-", "</summary>", count, BENCHMARKS,
                        1);
        for (size_t i = 0; i < 2 * count; i++) {
            char text[40];
            snprintf(text, sizeof text, "<td>%zu-of-0</td>", i);
            assert_int_equal(occurrences(page, text), i % count < BENCHMARKS);
        }
        free(page);
    }
}

/* Each part has so many pairs, and the parts stand in one table. */
static void a_part_has_its_first_pairs(void **state)
{
    (void)state;
    for (size_t count = PAIRS - 1; count < PAIRS + 3; count++) {
        struct report report = empty();
        for (size_t part = 0; part < 2; part++) {
            json_t *diff = json_of(diff_text, NULL, 0), *pairs = json_object_get(diff, "pairs");
            json_t *like = json_deep_copy(json_array_get(pairs, 0));
            assert_int_equal(json_array_clear(pairs), 0);
            for (size_t i = 0; i < count; i++) {
                json_t *pair = json_deep_copy(like);
                json_object_set_new(pair, "engine", json_sprintf("part-%zu-pair-%zu-", part, i));
                json_array_append_new(pairs, pair);
            }
            json_decref(like);
            add(&report, REPORT_PICTURES, diff, 0);
        }
        char *page = page_of(&report);
        first_are_shown(page, "part-0-pair-", "-", count, PAIRS, 1);
        first_are_shown(page, "part-1-pair-", "-", count, PAIRS, 1);
        assert_int_equal(occurrences(page, "<th>demanded</th>"), 1);
        free(page);
        report_free(&report);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_card_has_its_first_lines),
        cmocka_unit_test(a_card_has_its_first_operations),
        cmocka_unit_test(the_first_drivers_are_shown),
        cmocka_unit_test(a_card_is_shown_to_its_depth),
        cmocka_unit_test(a_scene_has_its_first_rows),
        cmocka_unit_test(a_matrix_has_its_first_box_tests),
        cmocka_unit_test(the_first_handlers_are_shown),
        cmocka_unit_test(a_chart_has_its_first_samples),
        cmocka_unit_test(a_table_has_its_first_columns_and_rows),
        cmocka_unit_test(the_first_row_has_the_columns),
        cmocka_unit_test(the_document_has_the_title),
        cmocka_unit_test(a_part_has_its_first_benchmarks),
        cmocka_unit_test(a_part_has_its_first_pairs),
    };
    return cmocka_run_group_tests_name("report_borders", tests, NULL, NULL);
}
