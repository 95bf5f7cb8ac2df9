#include "bench/chart/row_plot.h"

#include "bench/chart/json_value.h"
#include "ref/engine.h"
#include "ref/layout.h"
#include "ref/primitives/primitives.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PANEL_WRONG, PANEL_LEAKS, PANEL_FORWARD };

/* What the figure of one page points to. */
struct row_plot_page {
    const json_t *first; /* row */
    char title[200], subtitle[200];
    char panel[PLOT_PANELS][96];
    char (*name)[96]; /* of series */
    struct plot_series *series;
    struct plot_point *point[PLOT_PANELS];
};

/* --- rows --------------------------------------------------------------------------------- */

/* "-" stands for none in rows of benchmark layouts. */
static const char *member_name(const json_t *row, const char *member)
{
    const char *name = value_text(row, member);
    return strcmp(name, "-") == 0 ? "" : name;
}

static bool same_series(const json_t *a, const json_t *b)
{
    return value_same(a, b, "engine") && value_same(a, b, "layout") && value_same(a, b, "box") &&
           value_same(a, b, "tri");
}

/* Place of a name in a table whose members begin with their name, for a colour or a shape; `none`
 * if it is not there. */
static unsigned place_in(const void *const *table, const char *name, unsigned none)
{
    for (unsigned i = 0; table[i]; i++)
        if (strcmp(*(const char *const *)table[i], name) == 0)
            return i;
    return none;
}

static struct plot_series series_of(const json_t *row, char *text, size_t text_bytes)
{
    const char *engine = value_text(row, "engine"), *layout = member_name(row, "layout"),
               *box = member_name(row, "box"), *tri = member_name(row, "tri");
    bool shown = box[0] && strcmp(box, box_tests[0]->name) != 0; /* the first is the usual one */
    snprintf(text, text_bytes, "%.40s%s%.20s%s%.16s%s%.12s", engine, layout[0] ? " " : "", layout,
             shown ? " " : "", shown ? box : "", tri[0] ? " " : "", tri);
    return (struct plot_series){text, place_in((const void *const *)engines, engine, 6),
                                place_in((const void *const *)tri_tests, tri, 3),
                                place_in((const void *const *)layouts, layout, 2)};
}

/* --- pages -------------------------------------------------------------------------------- */

/* The page of a row among those that are there, by scene and, if `sets`, ray set. */
static bool has_page(const struct row_plots *out, const json_t *row, bool sets)
{
    for (size_t i = 0; i < out->count; i++)
        if (value_same(out->page[i].first, row, "scene") &&
            (!sets || value_same(out->page[i].first, row, "rays")))
            return true;
    return false;
}

static enum status add_page(struct row_plots *out, const json_t *first, size_t rows,
                            struct reason *reason)
{
    struct row_plot_page *made = &out->page[out->count];
    out->figure[out->count] = (struct plot_figure){.title = made->title};
    out->count++;
    made->first = first;
    made->name = alloc_zeroed(rows, sizeof *made->name);
    made->series = alloc_zeroed(rows, sizeof *made->series);
    bool all = made->name && made->series;
    for (size_t p = 0; p < PLOT_PANELS; p++) {
        made->point[p] = alloc_zeroed(rows, sizeof *made->point[p]);
        all = all && made->point[p];
    }
    out->figure[out->count - 1].series = made->series;
    return all ? STATUS_OK : fail(reason, STATUS_MEMORY, "no memory for the figures");
}

static size_t rows_of(const json_t *rows)
{
    size_t all = json_array_size(rows);
    return all < ROW_PLOT_ROWS ? all : ROW_PLOT_ROWS;
}

static enum status make(struct row_plots *out, struct reason *reason)
{
    *out = (struct row_plots){.figure = alloc_zeroed(ROW_PLOT_FIGURES, sizeof *out->figure),
                              .page = alloc_zeroed(ROW_PLOT_FIGURES, sizeof *out->page)};
    if (out->figure && out->page)
        return STATUS_OK;
    row_plots_free(out);
    return fail(reason, STATUS_MEMORY, "no memory for the figures");
}

void row_plots_free(struct row_plots *plots)
{
    for (size_t i = 0; i < plots->count; i++) {
        free(plots->page[i].name);
        free(plots->page[i].series);
        for (size_t p = 0; p < PLOT_PANELS; p++)
            free(plots->page[i].point[p]);
    }
    free(plots->figure);
    free(plots->page);
    *plots = (struct row_plots){0};
}

/* A median with the least and the most of the rounds; what is missing is the median. */
static void set_speed(struct plot_point *point, const json_t *row)
{
    double least = value_number(row, "mrays_min"), most = value_number(row, "mrays_max");
    point->x = value_number(row, "mrays_median");
    point->x_lo = isfinite(least) ? least : point->x;
    point->x_hi = isfinite(most) ? most : point->x;
}

/* A rate per million; of none, its upper limit. */
static void set_rate(struct plot_point *point, size_t events, size_t count)
{
    point->below = count > 0 && events == 0;
    point->y = count ? 1e6 * (double)(events ? events : 3) / (double)count : NAN;
    point->y_lo = point->y_hi = point->y;
}

/* --- speed against error ------------------------------------------------------------------ */

static void draw_error(const json_t *row, size_t series, size_t at, struct row_plot_page *page)
{
    for (int panel = 0; panel < PLOT_PANELS; panel++) {
        page->point[panel][at] = (struct plot_point){.series = series};
        set_speed(&page->point[panel][at], row);
    }
    set_rate(&page->point[PANEL_WRONG][at],
             value_count(row, "lost") + value_count(row, "phantom") + value_count(row, "wrong_id"),
             value_count(row, "compared"));
    set_rate(&page->point[PANEL_LEAKS][at],
             value_count(row, "edge_leaks") + value_count(row, "vertex_leaks"),
             value_count(row, "edge_rays") + value_count(row, "vertex_rays"));
    struct plot_point *forward = &page->point[PANEL_FORWARD][at];
    double least = value_number(row, "forward_p50"), most = value_number(row, "forward_max");
    forward->y = value_number(row, "forward_p99");
    forward->y_lo = isfinite(least) ? least : forward->y;
    forward->y_hi = isfinite(most) ? most : forward->y;
}

static void describe_error(const json_t *first, const char *driver, struct row_plot_page *page,
                           struct plot_figure *figure)
{
    snprintf(page->title, sizeof page->title, "%.90s: %zu triangles, %zu %.40s rays",
             value_text(first, "scene"), value_count(first, "triangles"),
             value_count(first, "count"), value_text(first, "rays"));
    snprintf(page->subtitle, sizeof page->subtitle,
             "right is faster, down is more exact; bars: least to most of the rounds%s%.80s",
             driver[0] ? "; vulkan is " : "", driver);
    figure->subtitle = page->subtitle;
}

static void add_error_panels(const json_t *first, size_t points, struct row_plot_page *page,
                             struct plot_figure *figure)
{
    static const char *const title[PLOT_PANELS] = {"answers that are not the exact one",
                                                   "leaks out of the closed mesh",
                                                   "error of t: 50 %, 99 % (mark), largest"};
    static const char *const label[PLOT_PANELS] = {"per million rays, <3/N: arrow",
                                                   "per million rays, <3/N: arrow",
                                                   "|t - exact t| |d| / (u M)"};
    for (int panel = 0; panel < PLOT_PANELS; panel++) {
        if (panel == PANEL_LEAKS && value_count(first, "vertex_rays") == 0)
            continue;
        figure->panel[figure->panel_count++] =
            (struct plot_panel){.title = title[panel],
                                .x_label = "speed, million rays/s",
                                .y_label = label[panel],
                                .point = page->point[panel],
                                .count = points};
    }
}

enum status row_plots_error(const json_t *rows, const char *driver, struct row_plots *out,
                            struct reason *reason)
{
    size_t all = rows_of(rows);
    enum status status = make(out, reason);
    for (size_t i = 0; i < all && status == STATUS_OK; i++) {
        const json_t *first = json_array_get(rows, i);
        if (has_page(out, first, true))
            continue;
        if (out->count == ROW_PLOT_FIGURES) {
            out->more = true;
            break;
        }
        status = add_page(out, first, all - i, reason);
        struct row_plot_page *page = &out->page[out->count - 1];
        struct plot_figure *figure = &out->figure[out->count - 1];
        describe_error(first, driver, page, figure);
        for (size_t k = i; k < all && status == STATUS_OK; k++) {
            const json_t *row = json_array_get(rows, k);
            if (!value_same(first, row, "scene") || !value_same(first, row, "rays"))
                continue;
            size_t at = figure->series_count++;
            page->series[at] = series_of(row, page->name[at], sizeof page->name[at]);
            draw_error(row, at, at, page);
        }
        add_error_panels(first, figure->series_count, page, figure);
    }
    if (status)
        row_plots_free(out);
    return status;
}

/* --- size against speed ------------------------------------------------------------------- */

/* Bytes per triangle, or NAN if the row has none. */
static double bytes_of(const json_t *row, bool memory)
{
    size_t tris = value_count(row, "triangles");
    size_t items = value_count(row, "item_bytes");
    size_t bytes =
        memory ? value_count(row, "memory_bytes") : value_count(row, "node_bytes") + items;
    return tris && bytes ? (double)bytes / (double)tris : NAN;
}

static bool has_size(const json_t *row, bool memory)
{
    return isfinite(bytes_of(row, memory)) && value_number(row, "mrays_median") > 0.0;
}

/* The panel of the row's ray set, made if it is not there; PLOT_PANELS: there are too many. */
static size_t panel_of(const json_t *row, bool memory, struct row_plot_page *page,
                       struct plot_figure *figure)
{
    char title[sizeof page->panel[0]];
    snprintf(title, sizeof title, "%.40s rays", value_text(row, "rays"));
    size_t p = 0;
    while (p < figure->panel_count && strcmp(page->panel[p], title) != 0)
        p++;
    if (p == PLOT_PANELS || p < figure->panel_count)
        return p;
    snprintf(page->panel[p], sizeof page->panel[p], "%s", title);
    figure->panel_count++;
    figure->panel[p] = (struct plot_panel){
        .title = page->panel[p],
        .x_label = "speed, million rays/s",
        .y_label = memory ? "memory, bytes per triangle" : "nodes and items, bytes per triangle",
        .point = page->point[p]};
    return p;
}

/* The series of a row, made if it is not there; `shown` has the first row of each. */
static size_t series_at(const json_t *row, const json_t **shown, struct row_plot_page *page,
                        struct plot_figure *figure)
{
    size_t s = 0;
    while (s < figure->series_count && !same_series(shown[s], row))
        s++;
    if (s < figure->series_count)
        return s;
    shown[s] = row;
    page->series[s] = series_of(row, page->name[s], sizeof page->name[s]);
    figure->series_count++;
    return s;
}

static enum status draw_size(const json_t *rows, size_t i, bool memory, struct row_plots *out,
                             struct reason *reason)
{
    struct row_plot_page *page = &out->page[out->count - 1];
    struct plot_figure *figure = &out->figure[out->count - 1];
    const json_t **shown = alloc_zeroed(rows_of(rows), sizeof *shown);
    if (!shown)
        return fail(reason, STATUS_MEMORY, "no memory for the figures");
    snprintf(page->title, sizeof page->title, "%.90s: %zu triangles",
             value_text(page->first, "scene"), value_count(page->first, "triangles"));
    figure->subtitle = memory
                           ? "right is faster, down is smaller; all that the engine holds on the "
                             "device or in memory, scene and rays of a dispatch included"
                           : "right is faster, down is smaller; the tree alone, without triangles";
    for (size_t k = i; k < rows_of(rows); k++) {
        const json_t *row = json_array_get(rows, k);
        size_t p = PLOT_PANELS;
        if (value_same(page->first, row, "scene") && has_size(row, memory))
            p = panel_of(row, memory, page, figure);
        if (p == PLOT_PANELS)
            continue;
        struct plot_point *point = &page->point[p][figure->panel[p].count++];
        *point = (struct plot_point){.series = series_at(row, shown, page, figure),
                                     .y = bytes_of(row, memory)};
        point->y_lo = point->y_hi = point->y;
        set_speed(point, row);
    }
    free(shown);
    return STATUS_OK;
}

enum status row_plots_size(const json_t *rows, bool memory, struct row_plots *out,
                           struct reason *reason)
{
    size_t all = rows_of(rows);
    enum status status = make(out, reason);
    for (size_t i = 0; i < all && status == STATUS_OK; i++) {
        const json_t *first = json_array_get(rows, i);
        if (!has_size(first, memory) || has_page(out, first, false))
            continue;
        if (out->count == ROW_PLOT_FIGURES) {
            out->more = true;
            break;
        }
        status = add_page(out, first, all - i, reason);
        if (status == STATUS_OK)
            status = draw_size(rows, i, memory, out, reason);
    }
    if (status)
        row_plots_free(out);
    return status;
}
