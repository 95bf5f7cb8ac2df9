/* Figures from rows of benchmarks: every number where its row says, for every scene and ray set. */
#define _GNU_SOURCE /* open_memstream */
#include "bench/chart/row_plot.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/readers/well_formed.h"

static json_t *row_of(const char *scene, const char *rays, const char *engine, const char *layout)
{
    json_t *row = json_pack("{s:s, s:s, s:s, s:s, s:s, s:s}", "scene", scene, "rays", rays,
                            "engine", engine, "layout", layout, "box", "robust", "tri", "mt");
    static const struct {
        const char *name;
        double value;
    } number[] = {{"mrays_median", 2.5}, {"mrays_min", 2.0},   {"mrays_max", 4.0},
                  {"forward_p50", 0.5},  {"forward_p99", 3.0}, {"forward_max", 9.0}};
    static const struct {
        const char *name;
        int value;
    } count[] = {{"triangles", 10},    {"count", 1000},     {"compared", 1000},  {"lost", 1},
                 {"phantom", 2},       {"wrong_id", 3},     {"edge_rays", 50},   {"edge_leaks", 0},
                 {"vertex_rays", 50},  {"vertex_leaks", 0}, {"node_bytes", 160}, {"item_bytes", 40},
                 {"memory_bytes", 900}};
    for (size_t i = 0; i < ARRAY_COUNT(number); i++)
        json_object_set_new(row, number[i].name, json_real(number[i].value));
    for (size_t i = 0; i < ARRAY_COUNT(count); i++)
        json_object_set_new(row, count[i].name, json_integer(count[i].value));
    return row;
}

static json_t *rows_of(void)
{
    json_t *rows = json_array();
    json_array_append_new(rows, row_of("one", "random", "cpu", "f32"));
    json_array_append_new(rows, row_of("one", "edges", "cpu", "f32"));
    json_array_append_new(rows, row_of("two", "random", "cpu", "f32"));
    json_array_append_new(rows, row_of("one", "random", "vulkan", "rf16"));
    return rows;
}

static void errors_stand_where_the_row_says(void **state)
{
    (void)state;
    struct row_plots plots;
    struct reason reason;
    json_t *rows = rows_of();
    assert_int_equal(row_plots_error(rows, "driver", &plots, &reason), STATUS_OK);
    assert_int_equal(plots.count, 3); /* one random, one edges, two random */
    const struct plot_figure *figure = &plots.figure[0];
    assert_string_equal(figure->title, "one: 10 triangles, 1000 random rays");
    assert_int_equal(figure->series_count, 2);
    assert_string_equal(figure->series[0].name, "cpu f32 mt");
    assert_string_equal(figure->series[1].name, "vulkan rf16 mt");
    assert_true(figure->series[0].colour != figure->series[1].colour);
    assert_int_equal(figure->panel_count, 3);
    const struct plot_point *wrong = &figure->panel[0].point[1], *leak = &figure->panel[1].point[1],
                            *forward = &figure->panel[2].point[1];
    assert_int_equal(figure->panel[0].count, 2);
    assert_int_equal(wrong->series, 1);
    assert_true(wrong->x == 2.5 && wrong->x_lo == 2.0 && wrong->x_hi == 4.0);
    assert_true(wrong->y == 6000.0 && !wrong->below); /* 6 of 1000 */
    assert_true(leak->y == 30000.0 && leak->below);   /* none of 100: at most 3 of them */
    assert_true(forward->y == 3.0 && forward->y_lo == 0.5 && forward->y_hi == 9.0);
    row_plots_free(&plots);
    json_decref(rows);
}

static void no_leaks_no_panel(void **state)
{
    (void)state;
    struct row_plots plots;
    struct reason reason;
    json_t *rows = rows_of();
    json_object_set_new(json_array_get(rows, 2), "vertex_rays", json_integer(0));
    assert_int_equal(row_plots_error(rows, "", &plots, &reason), STATUS_OK);
    assert_int_equal(plots.figure[0].panel_count, 3);
    assert_int_equal(plots.figure[2].panel_count, 2);
    row_plots_free(&plots);
    json_decref(rows);
}

static void sizes_are_bytes_per_triangle(void **state)
{
    (void)state;
    struct row_plots plots;
    struct reason reason;
    json_t *rows = rows_of();
    json_object_set_new(json_array_get(rows, 3), "node_bytes", json_integer(0));
    json_object_set_new(json_array_get(rows, 3), "item_bytes", json_integer(0));
    assert_int_equal(row_plots_size(rows, false, &plots, &reason), STATUS_OK);
    assert_int_equal(plots.count, 2); /* one, two */
    assert_int_equal(plots.figure[0].panel_count, 2);
    assert_string_equal(plots.figure[0].panel[0].title, "random rays");
    assert_string_equal(plots.figure[0].panel[1].title, "edges rays");
    assert_int_equal(plots.figure[0].panel[0].count, 1); /* without the row that has no tree */
    assert_true(plots.figure[0].panel[0].point[0].y == 20.0);
    row_plots_free(&plots);
    assert_int_equal(row_plots_size(rows, true, &plots, &reason), STATUS_OK);
    assert_int_equal(plots.figure[0].panel[0].count, 2);
    assert_true(plots.figure[0].panel[0].point[1].y == 90.0);
    assert_int_equal(plots.figure[0].panel[0].point[1].series, 1);
    row_plots_free(&plots);
    json_decref(rows);
}

/* Engines that test the same triangles in the same layout have marks of their own. */
static void engines_have_marks_of_their_own(void **state)
{
    (void)state;
    static const char *const engine[] = {"cpu", "vulkan", "fast", "cpu_stackless",
                                         "vulkan_stackless"};
    struct row_plots plots;
    struct reason reason;
    json_t *rows = json_array();
    for (size_t i = 0; i < ARRAY_COUNT(engine); i++)
        json_array_append_new(rows, row_of("one", "random", engine[i], "f32"));
    assert_int_equal(row_plots_size(rows, true, &plots, &reason), STATUS_OK);
    const struct plot_figure *figure = &plots.figure[0];
    assert_int_equal(figure->series_count, ARRAY_COUNT(engine));
    for (size_t i = 0; i < figure->series_count; i++)
        for (size_t k = 0; k < i; k++)
            assert_false(figure->series[i].shape == figure->series[k].shape &&
                         figure->series[i].fill == figure->series[k].fill);
    row_plots_free(&plots);
    json_decref(rows);
}

/* More scenes than there are figures, more ray sets than panels: the first ones, and it is said. */
static void too_many_are_left_out(void **state)
{
    (void)state;
    struct row_plots plots;
    struct reason reason;
    json_t *rows = json_array();
    for (int i = 0; i < 40; i++) {
        char name[16];
        snprintf(name, sizeof name, "%d", i);
        json_array_append_new(rows, row_of(name, "random", "cpu", "f32"));
        json_array_append_new(rows, row_of("0", name, "cpu", "f32"));
    }
    assert_int_equal(row_plots_error(rows, "", &plots, &reason), STATUS_OK);
    assert_int_equal(plots.count, ROW_PLOT_FIGURES);
    assert_true(plots.more);
    row_plots_free(&plots);
    assert_int_equal(row_plots_size(rows, false, &plots, &reason), STATUS_OK);
    assert_int_equal(plots.count, ROW_PLOT_FIGURES);
    assert_int_equal(plots.figure[0].panel_count, PLOT_PANELS);
    row_plots_free(&plots);
    json_decref(rows);
}

/* Members of other types are no points, and the figures can still be drawn. */
static void strange_rows_can_be_drawn(void **state)
{
    (void)state;
    static const char *const rows_text[] = {"[]", "[1]", "[{}]", "[{\"scene\": 3, \"count\": -1}]",
                                            "[{\"scene\": \"<&>\", \"mrays_median\": \"x\"}]"};
    for (size_t i = 0; i < ARRAY_COUNT(rows_text); i++)
        for (int kind = 0; kind < 3; kind++) {
            struct row_plots plots;
            struct reason reason;
            json_t *rows = json_loads(rows_text[i], 0, NULL);
            assert_non_null(rows);
            enum status status = kind == 0 ? row_plots_error(rows, "<>", &plots, &reason)
                                           : row_plots_size(rows, kind == 1, &plots, &reason);
            assert_int_equal(status, STATUS_OK);
            char *text = NULL;
            size_t size;
            FILE *out = open_memstream(&text, &size);
            if (plots.count > 0) {
                plot_write(out, plots.figure, plots.count);
                fclose(out);
                assert_true(well_formed(text));
            } else {
                fclose(out);
            }
            free(text);
            row_plots_free(&plots);
            json_decref(rows);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_stand_where_the_row_says),
        cmocka_unit_test(no_leaks_no_panel),
        cmocka_unit_test(sizes_are_bytes_per_triangle),
        cmocka_unit_test(too_many_are_left_out),
        cmocka_unit_test(strange_rows_can_be_drawn),
        cmocka_unit_test(engines_have_marks_of_their_own),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
