/* The plot of raydiff bench traffic. */
#include "bench/chart/plot.h"
#include "cmd/traffic/cmd_traffic.h"

#include <stdlib.h>
#include <string.h>

#define FIGURES 16

/* A scene's figure and what it points to. */
struct traffic_page {
    const char *scene;
    struct plot_series series[TRAFFIC_SCHEDULERS_MOST];
    uint32_t depth[PLOT_PANELS];
    char title[PLOT_PANELS][80];
    struct plot_point *point[PLOT_PANELS];
};

static const char *text_of(const json_t *row, const char *name)
{
    const char *text = json_string_value(json_object_get(row, name));
    return text ? text : "";
}

static double number_of(const json_t *row, const char *name)
{
    return json_number_value(json_object_get(row, name));
}

/* The panel of a depth, a new one if there is room; else PLOT_PANELS. */
static size_t panel_of(struct traffic_page *page, struct plot_figure *figure, uint32_t depth)
{
    size_t p = 0;
    while (p < figure->panel_count && page->depth[p] != depth)
        p++;
    if (p < figure->panel_count || p == PLOT_PANELS)
        return p;
    page->depth[p] = depth;
    snprintf(page->title[p], sizeof page->title[p], "paths of up to %u ray%s", depth,
             depth == 1 ? "" : "s");
    figure->panel[p] = (struct plot_panel){.title = page->title[p],
                                           .x_label = "bytes of nodes and items per triangle",
                                           .y_label = "bytes of DRAM per ray",
                                           .point = page->point[p]};
    figure->panel_count++;
    return p;
}

static size_t series_of(struct traffic_page *page, struct plot_figure *figure, const char *name)
{
    size_t s = 0;
    while (s < figure->series_count && strcmp(page->series[s].name, name) != 0)
        s++;
    if (s == figure->series_count && s < TRAFFIC_SCHEDULERS_MOST)
        page->series[figure->series_count++] = (struct plot_series){
            .name = name, .colour = (unsigned)s, .shape = (unsigned)s, .fill = 0};
    return s;
}

static void draw(struct traffic_page *page, struct plot_figure *figure, const json_t *row)
{
    size_t p = panel_of(page, figure, (uint32_t)number_of(row, "depth"));
    double x = (number_of(row, "node_bytes") + number_of(row, "item_bytes")) /
               number_of(row, "triangles"),
           y = number_of(row, "dram_per_ray");
    if (p == PLOT_PANELS || !(x > 0) || !(y > 0))
        return;
    page->point[p][figure->panel[p].count++] =
        (struct plot_point){.series = series_of(page, figure, text_of(row, "scheduler")),
                            .x = x,
                            .x_lo = x,
                            .x_hi = x,
                            .y = y,
                            .y_lo = y,
                            .y_hi = y};
}

static enum status open_page(struct traffic_page *page, struct plot_figure *figure,
                             const char *scene, size_t rows, struct reason *reason)
{
    page->scene = scene;
    *figure = (struct plot_figure){
        .title = scene, .subtitle = "a point for each layout and storage", .series = page->series};
    for (size_t p = 0; p < PLOT_PANELS; p++) {
        page->point[p] = alloc_zeroed(rows, sizeof *page->point[p]);
        if (!page->point[p])
            return fail(reason, STATUS_MEMORY, "no memory for the figures");
    }
    return STATUS_OK;
}

enum status traffic_plot(const char *path, const json_t *rows, struct reason *reason)
{
    static struct traffic_page page[FIGURES];
    static struct plot_figure figure[FIGURES];
    size_t count = 0, i;
    json_t *row;
    enum status status = STATUS_OK;
    json_array_foreach(rows, i, row)
    {
        size_t f = 0;
        if (strcmp(text_of(row, "benchmark"), "traffic") != 0 || status)
            continue;
        while (f < count && strcmp(page[f].scene, text_of(row, "scene")) != 0)
            f++;
        if (f == FIGURES)
            continue;
        if (f == count) {
            count++;
            status = open_page(&page[f], &figure[f], text_of(row, "scene"), json_array_size(rows),
                               reason);
        }
        if (!status)
            draw(&page[f], &figure[f], row);
    }
    if (!status && count > 0)
        status = plot_write_file(path, figure, count, reason);
    for (size_t f = 0; f < count; f++)
        for (size_t p = 0; p < PLOT_PANELS; p++)
            free(page[f].point[p]);
    return status;
}
