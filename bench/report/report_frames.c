/* Runs of frames (raydiff render --benchmark, bench frames): a chart and a table of handlers. */
#include "bench/report/report_inner.h"

#include "bench/chart/chart.h"

#include <math.h>
#include <stdlib.h>

#define HANDLERS_MOST 16u
#define FRAMES_MOST   5000u /* per handler */

bool report_is_frames(const json_t *json)
{
    return json_is_array(json_object_get(json, "handlers"));
}

static size_t handlers_of(const json_t *json)
{
    size_t count = json_array_size(json_object_get(json, "handlers"));
    return count < HANDLERS_MOST ? count : HANDLERS_MOST;
}

static size_t samples_of(const json_t *handler)
{
    size_t count = json_array_size(json_object_get(handler, "samples_ms"));
    return count < FRAMES_MOST ? count : FRAMES_MOST;
}

size_t report_charts(const json_t *json)
{
    size_t samples = 0;
    for (size_t i = 0; i < handlers_of(json); i++)
        samples += samples_of(json_array_get(json_object_get(json, "handlers"), i));
    return samples > 0;
}

static void set_series(const json_t *handler, double *value, struct chart_series *series)
{
    *series = (struct chart_series){.name = value_text(handler, "handler"),
                                    .bytes = value_count(handler, "bytes"),
                                    .average = value_number(handler, "average_ms"),
                                    .least = value_number(handler, "min_ms"),
                                    .most = value_number(handler, "max_ms"),
                                    .value = value,
                                    .count = samples_of(handler)};
    for (size_t k = 0; k < series->count; k++) {
        const json_t *one = json_array_get(json_object_get(handler, "samples_ms"), k);
        value[k] = json_is_number(one) ? json_number_value(one) : NAN;
    }
}

static enum status put_chart(struct html *html, const json_t *json, struct reason *reason)
{
    const json_t *handlers = json_object_get(json, "handlers");
    struct chart_series series[HANDLERS_MOST];
    struct chart chart = {.title = value_text(json, "title"),
                          .x_label = "frame",
                          .y_label = CHART_DURATION,
                          .unit = "ms",
                          .series = series,
                          .series_count = handlers_of(json)};
    double *value = alloc_zeroed((size_t)HANDLERS_MOST * FRAMES_MOST, sizeof *value);
    if (!value)
        return fail(reason, STATUS_MEMORY, "no memory for a chart");
    for (size_t i = 0; i < chart.series_count; i++)
        set_series(json_array_get(handlers, i), value + i * FRAMES_MOST, &series[i]);
    html_begin(html, "figure", NULL);
    chart_svg(html->out, &chart);
    html_end(html, "figure");
    free(value);
    return STATUS_OK;
}

static void put_handler(struct html *html, const json_t *handler)
{
    static const char *const times[] = {"average_ms", "min_ms", "max_ms", "median_ms"};
    static const char *const parts[] = {"median", "min", "max"};
    const json_t *ratio = json_object_get(handler, "ratio");
    html_begin(html, "tr", NULL);
    html_element(html, "th", NULL, value_text(handler, "handler"));
    html_element_format(html, "td", "n", "%zu", value_count(handler, "bytes"));
    for (size_t i = 0; i < ARRAY_COUNT(times); i++)
        report_number(html, "%.3f", value_number(handler, times[i]));
    for (size_t i = 0; i < ARRAY_COUNT(parts); i++)
        report_number(html, "%.3f", value_number(ratio, parts[i]));
    html_element(html, "td", NULL, value_text(ratio, "to"));
    html_element(html, "td", NULL, value_text(handler, "clock"));
    html_end(html, "tr");
}

static void put_table(struct html *html, const json_t *json)
{
    html_table(html, NULL, NULL);
    html_heads(html, "handler;#bytes;#average ms;#min;#max;#median ms;#ratio;#min;#max;to;clock");
    html_body(html);
    for (size_t i = 0; i < handlers_of(json); i++)
        put_handler(html, json_array_get(json_object_get(json, "handlers"), i));
    html_table_end(html);
}

enum status report_frames(struct html *html, const json_t *json, struct reason *reason)
{
    html_element_format(html, "h3", NULL, "Frames: %s", value_text(json, "title"));
    html_element_format(html, "p", "dim", "%zu frames measured, %zu before them dropped%s",
                        value_count(json, "frames"), value_count(json, "warm_up_dropped"),
                        value_bool(json, "stopped") ? "; the run was ended early" : "");
    enum status status = report_charts(json) ? put_chart(html, json, reason) : STATUS_OK;
    put_table(html, json);
    return status;
}
