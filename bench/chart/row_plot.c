#include "bench/chart/row_plot.h"

#include "bench/chart/json_value.h"
#include "ref/engine.h"
#include "ref/layout.h"
#include "ref/primitives/primitives.h"
#include "ref/base/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PANEL_WRONG, PANEL_LEAKS, PANEL_FORWARD };

struct row_kind;

/* Memory that a figure points to. */
struct row_plot_page {
    const struct row_kind *kind;
    const json_t *first; /* the figure's first row */
    char title[200], subtitle[200];
    char panel[PLOT_PANELS][120];
    char (*name)[96];     /* names of the series */
    const json_t **shown; /* first row of each series */
    struct plot_series *series;
    struct plot_point *point[PLOT_PANELS];
};

/* How rows are turned into figures. */
struct row_kind {
    bool (*fits)(const json_t *row, bool memory); /* true if the row has a point; NULL: all */
    bool (*same_figure)(const json_t *a, const json_t *b);
    void (*describe)(struct row_plot_page *page, struct plot_figure *figure, const char *driver);
    void (*draw)(const json_t *row, struct row_plot_page *page, struct plot_figure *figure);
    bool memory;
};

/* --- pages -------------------------------------------------------------------------------- */

static enum status make_page(struct row_plot_page *page, size_t rows, struct reason *reason)
{
    page->name = alloc_zeroed(rows, sizeof *page->name);
    page->shown = alloc_zeroed(rows, sizeof *page->shown);
    page->series = alloc_zeroed(rows, sizeof *page->series);
    bool all = page->name && page->shown && page->series;
    for (size_t p = 0; p < PLOT_PANELS; p++) {
        page->point[p] = alloc_zeroed(rows, sizeof *page->point[p]);
        all = all && page->point[p];
    }
    return all ? STATUS_OK : fail(reason, STATUS_MEMORY, "no memory for the figures");
}

void row_plots_free(struct row_plots *plots)
{
    for (size_t i = 0; i < plots->count; i++) {
        free(plots->page[i].name);
        free(plots->page[i].shown);
        free(plots->page[i].series);
        for (size_t p = 0; p < PLOT_PANELS; p++)
            free(plots->page[i].point[p]);
    }
    free(plots->figure);
    free(plots->page);
    *plots = (struct row_plots){0};
}

static bool is_drawn(const struct row_plots *plots, const json_t *row)
{
    for (size_t i = 0; i < plots->count; i++)
        if (plots->page[i].kind->same_figure(plots->page[i].first, row))
            return true;
    return false;
}

/* Makes a figure for each row that begins one. */
static enum status make(const json_t *rows, const struct row_kind *kind, const char *driver,
                        struct row_plots *out, struct reason *reason)
{
    size_t all = json_array_size(rows) < ROW_PLOT_ROWS ? json_array_size(rows) : ROW_PLOT_ROWS;
    enum status status = STATUS_OK;
    *out = (struct row_plots){.figure = alloc_zeroed(ROW_PLOT_FIGURES, sizeof *out->figure),
                              .page = alloc_zeroed(ROW_PLOT_FIGURES, sizeof *out->page)};
    if (!out->figure || !out->page)
        status = fail(reason, STATUS_MEMORY, "no memory for the figures");
    for (size_t i = 0; i < all && status == STATUS_OK; i++) {
        const json_t *first = json_array_get(rows, i);
        if ((kind->fits && !kind->fits(first, kind->memory)) || is_drawn(out, first))
            continue;
        if (out->count == ROW_PLOT_FIGURES) {
            out->more = true;
            break;
        }
        struct row_plot_page *page = &out->page[out->count];
        struct plot_figure *figure = &out->figure[out->count++];
        page->kind = kind;
        page->first = first;
        status = make_page(page, all - i, reason);
        *figure = (struct plot_figure){
            .title = page->title, .subtitle = page->subtitle, .series = page->series};
        kind->describe(page, figure, driver);
        for (size_t k = i; k < all && status == STATUS_OK; k++) {
            const json_t *row = json_array_get(rows, k);
            if (kind->same_figure(first, row) && (!kind->fits || kind->fits(row, kind->memory)))
                kind->draw(row, page, figure);
        }
        plot_tell_apart(page->series, figure->series_count);
    }
    if (status)
        row_plots_free(out);
    return status;
}

/* Finds the panel with a title, or adds it. Returns PLOT_PANELS if there is no room. */
static size_t panel_of(const char *title, const char *x_label, const char *y_label,
                       struct row_plot_page *page, struct plot_figure *figure)
{
    size_t p = 0;
    while (p < figure->panel_count && strcmp(page->panel[p], title) != 0)
        p++;
    if (p == PLOT_PANELS || p < figure->panel_count)
        return p;
    snprintf(page->panel[p], sizeof page->panel[p], "%s", title);
    figure->panel[figure->panel_count++] = (struct plot_panel){
        .title = page->panel[p], .x_label = x_label, .y_label = y_label, .point = page->point[p]};
    return p;
}

/* Finds the series of a row with `same`. If there is none, adds one with this as its first row and
 * sets *made. */
static size_t series_of(const json_t *row, bool (*same)(const json_t *a, const json_t *b),
                        struct row_plot_page *page, struct plot_figure *figure, bool *made)
{
    size_t s = 0;
    while (s < figure->series_count && !same(page->shown[s], row))
        s++;
    *made = s == figure->series_count;
    page->shown[s] = *made ? row : page->shown[s];
    figure->series_count += *made;
    return s;
}

/* A point without bars. */
static struct plot_point point_at(size_t series, double x, double y)
{
    return (struct plot_point){
        .series = series, .x = x, .x_lo = x, .x_hi = x, .y = y, .y_lo = y, .y_hi = y};
}

/* --- members ------------------------------------------------------------------------------ */

/* In rows of benchmark layouts "-" means none. */
static const char *member_name(const json_t *row, const char *member)
{
    const char *name = value_text(row, member);
    return strcmp(name, "-") == 0 ? "" : name;
}

static bool same_members(const json_t *a, const json_t *b)
{
    return value_same(a, b, "engine") && value_same(a, b, "layout") && value_same(a, b, "box") &&
           value_same(a, b, "tri");
}

/* Index of a name in a table whose members begin with their name, used for a colour or a shape.
 * Returns `none` if it is missing. */
static unsigned place_in(const void *const *table, const char *name, unsigned none)
{
    for (unsigned i = 0; table[i]; i++)
        if (strcmp(*(const char *const *)table[i], name) == 0)
            return i;
    return none;
}

static void name_members(const json_t *row, size_t s, struct row_plot_page *page)
{
    const char *engine = value_text(row, "engine"), *layout = member_name(row, "layout"),
               *box = member_name(row, "box"), *tri = member_name(row, "tri");
    bool shown = box[0] && strcmp(box, box_tests[0]->name) != 0; /* the first is the default */
    snprintf(page->name[s], sizeof page->name[s], "%.40s%s%.20s%s%.16s%s%.12s", engine,
             layout[0] ? " " : "", layout, shown ? " " : "", shown ? box : "", tri[0] ? " " : "",
             tri);
    page->series[s] =
        (struct plot_series){page->name[s], place_in((const void *const *)engines, engine, 6),
                             place_in((const void *const *)tri_tests, tri, 3),
                             place_in((const void *const *)layouts, layout, 2)};
}

/* A point at the median speed, with a bar from the slowest to the fastest round if they are
 * known. */
static struct plot_point speed_of(const json_t *row, size_t series)
{
    double least = value_number(row, "mrays_min"), most = value_number(row, "mrays_max");
    struct plot_point point = point_at(series, value_number(row, "mrays_median"), NAN);
    point.x_lo = isfinite(least) ? least : point.x;
    point.x_hi = isfinite(most) ? most : point.x;
    return point;
}

/* Sets a rate per million. Without events it is the upper limit. */
static void set_rate(struct plot_point *point, size_t events, size_t count)
{
    point->below = count > 0 && events == 0;
    point->y = count ? 1e6 * (double)(events ? events : 3) / (double)count : NAN;
    point->y_lo = point->y_hi = point->y;
}

/* --- speed against error ------------------------------------------------------------------ */

static bool same_rays(const json_t *a, const json_t *b)
{
    return value_same(a, b, "scene") && value_same(a, b, "rays");
}

static void describe_error(struct row_plot_page *page, struct plot_figure *figure,
                           const char *driver)
{
    static const char *const title[PLOT_PANELS] = {"answers that are not the exact one",
                                                   "leaks out of the closed mesh",
                                                   "error of t: 50 %, 99 % (mark), largest"};
    static const char *const label[PLOT_PANELS] = {"per million rays, <3/N: arrow",
                                                   "per million rays, <3/N: arrow",
                                                   "|t - exact t| |d| / (u M)"};
    const json_t *first = page->first;
    snprintf(page->title, sizeof page->title, "%.90s: %s, %zu %.40s rays",
             value_text(first, "scene"), COUNTED(value_count(first, "triangles"), "triangle"),
             value_count(first, "count"), value_text(first, "rays"));
    snprintf(page->subtitle, sizeof page->subtitle,
             "right is faster, down is more exact; bars: least to most of the rounds%s%.80s",
             driver[0] ? "; vulkan is " : "", driver);
    for (int panel = 0; panel < PLOT_PANELS; panel++)
        if (panel != PANEL_LEAKS || value_count(first, "vertex_rays") > 0)
            figure->panel[figure->panel_count++] =
                (struct plot_panel){.title = title[panel],
                                    .x_label = "speed, million rays/s",
                                    .y_label = label[panel],
                                    .point = page->point[panel]};
}

static void draw_error(const json_t *row, struct row_plot_page *page, struct plot_figure *figure)
{
    size_t at = figure->series_count++;
    name_members(row, at, page);
    for (int panel = 0; panel < PLOT_PANELS; panel++)
        page->point[panel][at] = speed_of(row, at);
    for (size_t p = 0; p < figure->panel_count; p++)
        figure->panel[p].count++;
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

enum status row_plots_error(const json_t *rows, const char *driver, struct row_plots *out,
                            struct reason *reason)
{
    static const struct row_kind kind = {
        .same_figure = same_rays, .describe = describe_error, .draw = draw_error};
    return make(rows, &kind, driver, out, reason);
}

/* --- size against speed ------------------------------------------------------------------- */

/* Bytes per triangle; NAN if the row has none. */
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

static bool same_scene(const json_t *a, const json_t *b)
{
    return value_same(a, b, "scene");
}

static void describe_size(struct row_plot_page *page, struct plot_figure *figure,
                          const char *driver)
{
    (void)driver;
    snprintf(page->title, sizeof page->title, "%.90s: %s", value_text(page->first, "scene"),
             COUNTED(value_count(page->first, "triangles"), "triangle"));
    figure->subtitle = page->kind->memory
                           ? "right is faster, down is smaller; all that the engine holds on the "
                             "device or in memory, scene and rays of a dispatch included"
                           : "right is faster, down is smaller; the tree alone, without triangles";
}

static void draw_size(const json_t *row, struct row_plot_page *page, struct plot_figure *figure)
{
    bool memory = page->kind->memory, made;
    char title[64];
    snprintf(title, sizeof title, "%.40s rays", value_text(row, "rays"));
    size_t p =
        panel_of(title, "speed, million rays/s",
                 memory ? "memory, bytes per triangle" : "nodes and items, bytes per triangle",
                 page, figure);
    if (p == PLOT_PANELS)
        return;
    size_t s = series_of(row, same_members, page, figure, &made);
    if (made)
        name_members(row, s, page);
    struct plot_point *point = &page->point[p][figure->panel[p].count++];
    *point = speed_of(row, s);
    point->y = point->y_lo = point->y_hi = bytes_of(row, memory);
}

enum status row_plots_size(const json_t *rows, bool memory, struct row_plots *out,
                           struct reason *reason)
{
    static const struct row_kind kinds[] = {
        {has_size, same_scene, describe_size, draw_size, .memory = false},
        {has_size, same_scene, describe_size, draw_size, .memory = true}};
    return make(rows, &kinds[memory], "", out, reason);
}

/* --- the matrix --------------------------------------------------------------------------- */

static bool in_one_figure(const json_t *a, const json_t *b)
{
    (void)a;
    (void)b;
    return true;
}

static bool same_name(const json_t *a, const json_t *b)
{
    return value_same(a, b, "name");
}

static void describe_matrix(struct row_plot_page *page, struct plot_figure *figure,
                            const char *driver)
{
    (void)page;
    (void)driver;
    figure->title = "raydiff bench matrix: size and speed";
    figure->subtitle = "right is faster, down is smaller; one thread, or as many as were named";
}

/* The colour shows the engine; shape and fill distinguish its contestants. Only a contestant's
 * first row in a scene is drawn. */
static void draw_matrix(const json_t *row, struct row_plot_page *page, struct plot_figure *figure)
{
    static const char *const engine[] = {"embree", "fast", "cpu", "vulkan"};
    char title[120];
    bool made;
    snprintf(title, sizeof title, "%.60s, %s", value_text(row, "scene"),
             COUNTED(value_count(row, "triangles"), "triangle"));
    size_t p = panel_of(title, "speed, geometric mean of ratios",
                        "bytes per triangle, all that is read", page, figure);
    if (p == PLOT_PANELS)
        return;
    size_t s = series_of(row, same_name, page, figure, &made);
    if (made) {
        page->series[s] = (struct plot_series){
            .name = value_text(row, "name"), .shape = (unsigned)s, .fill = (unsigned)(s / 4)};
        for (unsigned i = 0; i < ARRAY_COUNT(engine); i++)
            if (strncmp(value_text(row, "engine"), engine[i], strlen(engine[i])) == 0)
                page->series[s].colour = i;
    }
    for (size_t i = 0; i < figure->panel[p].count; i++)
        if (page->point[p][i].series == s)
            return;
    page->point[p][figure->panel[p].count++] =
        point_at(s, value_number(row, "mean_ratio"), value_number(row, "bytes_per_triangle"));
}

enum status row_plots_matrix(const json_t *rows, struct row_plots *out, struct reason *reason)
{
    static const struct row_kind kind = {
        .same_figure = in_one_figure, .describe = describe_matrix, .draw = draw_matrix};
    return make(rows, &kind, "", out, reason);
}
