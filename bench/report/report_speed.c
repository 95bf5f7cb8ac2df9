/* Section 3: measurements. Benchmarks error and layouts are drawn; all others are tables. */
#include "bench/report/report_inner.h"

#include "bench/chart/row_plot.h"

#include <string.h>

#define TABLE_ROWS      400u /* per benchmark */
#define COLUMNS_MOST    64u
#define BENCHMARKS_MOST 16 /* per part */

/* The rows of one benchmark, in a new array owned by the caller; NULL if out of memory. */
static json_t *rows_of(const json_t *json, const char *benchmark)
{
    return value_where(json_object_get(json, "rows"), "benchmark", benchmark);
}

/* The driver of engine vulkan, from the machine's card: the first driver that runs. */
static const char *driver_of(const struct report *report)
{
    for (size_t p = 0; p < report->part_count; p++) {
        const json_t *drivers = json_object_get(report->part[p].json, "drivers");
        for (size_t i = 0; i < json_array_size(drivers); i++)
            if (value_bool(json_array_get(drivers, i), "runs"))
                return value_text(json_object_get(json_array_get(drivers, i), "card"), "driver");
    }
    return "";
}

static void put_figure(struct html *html, const struct plot_figure *figure)
{
    html_begin(html, "figure", NULL);
    plot_write(html->out, figure, 1);
    html_end(html, "figure");
}

/* --- tables ------------------------------------------------------------------------------- */

static void put_value(struct html *html, const json_t *value)
{
    if (json_is_string(value))
        html_element(html, "td", NULL, json_string_value(value));
    else if (json_is_integer(value))
        html_element_format(html, "td", json_integer_value(value) ? "n" : "n z", "%lld",
                            (long long)json_integer_value(value));
    else if (json_is_real(value))
        html_element_format(html, "td", "n", "%.4g", json_real_value(value));
    else if (json_is_boolean(value))
        html_element(html, "td", NULL, json_is_true(value) ? "yes" : "no");
    else
        html_element(html, "td", "n z", "\xE2\x80\x93");
}

/* Prints the heads (row NULL) or the values of a row. */
static void put_line(struct html *html, const json_t *first, const json_t *row)
{
    const char *name;
    const json_t *value;
    size_t columns = 0;
    json_object_foreach((json_t *)(uintptr_t)first, name, value)
    {
        if (strcmp(name, "benchmark") == 0 || ++columns > COLUMNS_MOST)
            continue; /* the benchmark's name is the same in all rows */
        if (row)
            put_value(html, json_object_get(row, name));
        else
            html_element(html, "th", json_is_number(value) ? "n" : NULL, name);
    }
}

/* Prints a table of flat rows. The members of the first row are the columns; numbers are
 * right-aligned. */
static void put_rows(struct html *html, const json_t *rows)
{
    const json_t *first = json_array_get(rows, 0);
    html_table(html, "wide", NULL);
    put_line(html, first, NULL);
    html_body(html);
    for (size_t i = 0; i < json_array_size(rows) && i < TABLE_ROWS; i++) {
        html_begin(html, "tr", NULL);
        put_line(html, first, json_array_get(rows, i));
        html_end(html, "tr");
    }
    html_table_end(html);
    if (json_array_size(rows) > TABLE_ROWS)
        html_element_format(html, "p", "note", "%zu more rows are left out.",
                            json_array_size(rows) - TABLE_ROWS);
}

static void put_details(struct html *html, const json_t *rows, const char *benchmark)
{
    html_begin(html, "details", NULL);
    html_element_format(html, "summary", NULL, "all %zu rows of %s", json_array_size(rows),
                        benchmark[0] ? benchmark : "the benchmark");
    html_begin(html, "div", "class", "roll", NULL);
    put_rows(html, rows);
    html_end(html, "div");
    html_end(html, "details");
}

/* --- figures ------------------------------------------------------------------------------ */

enum { ERROR_FIGURES, SIZE_FIGURES, MEMORY_FIGURES, FIGURE_KINDS };

static enum status make_plots(const json_t *rows, int kind, const char *driver,
                              struct row_plots *out, struct reason *reason)
{
    if (kind == ERROR_FIGURES)
        return row_plots_error(rows, driver, out, reason);
    return row_plots_size(rows, kind == MEMORY_FIGURES, out, reason);
}

static enum status put_plots(struct html *html, const json_t *rows, int kind, const char *driver,
                             struct reason *reason)
{
    static const char *const title[FIGURE_KINDS] = {"Speed against error", "Size against speed",
                                                    "Memory against speed"};
    struct row_plots plots;
    enum status status = make_plots(rows, kind, driver, &plots, reason);
    if (status)
        return status;
    if (plots.count > 0)
        html_element(html, "h3", NULL, title[kind]);
    for (size_t i = 0; i < plots.count; i++)
        put_figure(html, &plots.figure[i]);
    if (plots.more)
        html_element_format(html, "p", "note", "Only the first %u figures are shown.",
                            ROW_PLOT_FIGURES);
    row_plots_free(&plots);
    return STATUS_OK;
}

/* Returns whether a benchmark has figures of a kind. Sizes are drawn from layouts, and from error
 * only if no part has layouts. */
static bool is_drawn(const char *benchmark, int kind, bool layouts)
{
    if (strcmp(benchmark, "error") == 0)
        return kind == ERROR_FIGURES || !layouts;
    return strcmp(benchmark, "layouts") == 0 && kind != ERROR_FIGURES;
}

static bool has_layouts(const struct report *report)
{
    for (size_t p = 0; p < report->part_count; p++) {
        const json_t *rows = json_object_get(report->part[p].json, "rows");
        for (size_t i = 0; i < json_array_size(rows); i++)
            if (strcmp(value_text(json_array_get(rows, i), "benchmark"), "layouts") == 0)
                return true;
    }
    return false;
}

size_t report_figures(const struct report *report)
{
    static const char *const drawn[] = {"error", "layouts"};
    bool layouts = has_layouts(report);
    size_t figures = report->picture_count;
    for (size_t p = 0; p < report->part_count; p++) {
        const struct report_part *part = &report->part[p];
        figures += part->drawing != NULL;
        if (part->kind != REPORT_BENCH)
            continue;
        figures += report_charts(part->json);
        for (size_t d = 0; d < ARRAY_COUNT(drawn); d++) {
            json_t *rows = rows_of(part->json, drawn[d]);
            for (int kind = 0; kind < FIGURE_KINDS; kind++) {
                struct row_plots plots = {0};
                struct reason reason;
                if (!is_drawn(drawn[d], kind, layouts) ||
                    make_plots(rows, kind, "", &plots, &reason))
                    continue;
                figures += plots.count;
                row_plots_free(&plots);
            }
            json_decref(rows);
        }
    }
    return figures;
}

/* --- the section -------------------------------------------------------------------------- */

static enum status put_benchmark(struct html *html, const struct report *report,
                                 const struct report_part *part, const char *benchmark,
                                 struct reason *reason)
{
    json_t *rows = rows_of(part->json, benchmark);
    enum status status = STATUS_OK;
    bool drawn = false;
    for (int kind = 0; kind < FIGURE_KINDS && !status; kind++)
        if (is_drawn(benchmark, kind, has_layouts(report))) {
            status = put_plots(html, rows, kind, driver_of(report), reason);
            drawn = true;
        }
    if (!drawn)
        html_element(html, "h3", NULL, benchmark[0] ? benchmark : part->name);
    put_details(html, rows, benchmark);
    json_decref(rows);
    return status;
}

/* Shows the benchmarks of a part in the order of their first rows. */
static enum status put_part(struct html *html, const struct report *report,
                            const struct report_part *part, struct reason *reason)
{
    const char *done[BENCHMARKS_MOST];
    enum status status =
        report_is_frames(part->json) ? report_frames(html, part->json, reason) : STATUS_OK;
    size_t i, count = 0;
    const json_t *row;
    json_array_foreach(json_object_get(part->json, "rows"), i, row)
    {
        const char *benchmark = value_text(row, "benchmark");
        size_t k = 0;
        while (k < count && strcmp(done[k], benchmark) != 0)
            k++;
        if (status || k < count || count == BENCHMARKS_MOST)
            continue;
        done[count++] = benchmark;
        status = put_benchmark(html, report, part, benchmark, reason);
    }
    return status;
}

enum status report_speed(struct html *html, const struct report *report, struct reason *reason)
{
    enum status status = STATUS_OK;
    section_begin(html, "speed", "3 Speed, error and size");
    if (section_reasons(html, report, REPORT_BENCH,
                        "raydiff report SCENE... measures; --bench FILE takes what raydiff bench "
                        "--json wrote."))
        html_element(html, "p", NULL,
                     "Speeds were taken in one run with all contestants interleaved: median of the "
                     "rounds, bars from the least to the most. Errors are measured against the "
                     "exact truth, on the same rays.");
    for (size_t p = 0; p < report->part_count && !status; p++)
        if (report->part[p].kind == REPORT_BENCH)
            status = put_part(html, report, &report->part[p], reason);
    section_end(html);
    return status;
}
