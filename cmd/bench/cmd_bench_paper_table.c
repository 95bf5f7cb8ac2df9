/* Output of the paper's performance table: text, rows, summary and plots. */
#include "cmd/bench/cmd_bench_paper.h"

#include "bench/chart/chart.h"
#include "bench/chart/plot.h"
#include "cmd/common/cmd_grid.h"
#include "ref/base/command.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"

#include <math.h>
#include <stdlib.h>

static const struct benchmark paper_frames = {.name = "paper_frames"};

/* Writes the cells of a ratio. Ratios are near 1 or far below. */
static void put_ratio(char text[80], struct spread ratio, const char *other)
{
    if (ratio.median < 0.1)
        snprintf(text, 80, "%.2g\t%s\t%.2g-%.2g", ratio.median, other, ratio.least, ratio.most);
    else
        snprintf(text, 80, "%.3f\t%s\t%.3f-%.3f", ratio.median, other, ratio.least, ratio.most);
}

static bool has(const struct paper_table *table, enum paper_line_id id)
{
    return table->session.run.done > 0 && table->line[id].contestant < table->session.run.count;
}

static struct spread ratio_of(const struct paper_table *table, enum paper_line_id a,
                              enum paper_line_id b)
{
    return frames_ratio(&table->session.run, table->line[a].contestant, table->line[b].contestant);
}

/* True if the line's frame equals its peer's (peer_of): paths to the bit, pixels as far as rounding
 * allows. */
static bool is_right(const struct paper_line *line)
{
    return !line->checked || (line->diff.paths_apart == 0 && line->diff.excess == 0);
}

static json_t *count(bool known, uint64_t value)
{
    return known ? json_integer((json_int_t)value) : json_null();
}

/* Adds the row of a line. A line that was left out gets the reason. */
static void add_row(struct paper_table *table, enum paper_line_id id)
{
    const struct frames_run *run = &table->session.run;
    const struct paper_line *line = &table->line[id];
    const struct painter_plan plan = paper_plan(table, id);
    bool in = has(table, id), checked = in && line->checked;
    const struct frames_contestant *c = in ? &run->contestant[line->contestant] : NULL;
    struct frames_stats stats = {NAN, NAN, NAN, NAN};
    struct spread ratio = {NAN, NAN, NAN};
    if (in)
        stats = frames_stats_of(run, line->contestant);
    if (in && has(table, paper_line_other(id)))
        ratio = ratio_of(table, id, paper_line_other(id));
    json_t *row = json_record(
        "scene=%s line=%s look=%s engine=%s layout=%s box=%s tri=%s plan=%s leaf=%u nodes=%p "
        "bytes=%p clock=%p frames=%p average_ms=%g min_ms=%g max_ms=%g median_ms=%g ratio_to=%s "
        "ratio_median=%g ratio_min=%g ratio_max=%g pixels=%p pixels_wrong=%p cpu_paths_apart=%p "
        "cpu_pixels_apart=%p cpu_pixels_beyond_rounding=%p left_out=%p",
        table->scene->spec, plan.handler, paper_line_published(id) ? "published" : "repaired",
        plan.engine->name, plan.layout ? plan.layout->name : "", plan.box->name, plan.tri->name,
        plan.plan == FRAME_WHOLE ? "whole" : "steps", plan.build.leaf,
        count(in, line->tree.node_count), count(in, in ? c->bytes : 0),
        json_text(in ? frames_clock(c) : NULL), count(in, run->done), stats.average, stats.least,
        stats.most, stats.median, paper_line_name(paper_line_other(id)), ratio.median, ratio.least,
        ratio.most, count(true, (uint64_t)table->width * table->height), count(in, line->wrong),
        count(checked, line->diff.paths_apart), count(checked, line->diff.colours),
        count(checked, line->diff.excess), json_text(in ? NULL : line->why));
    bench_row(table->bench, &paper_frames, row);
}

static void print_line(const struct paper_table *table, enum paper_line_id id,
                       struct row_grid *grid)
{
    const struct paper_line *line = &table->line[id];
    if (line->contestant == SIZE_MAX) {
        screen_text(&table->bench->screen_is, "  %s: left out: %s\n", paper_line_name(id),
                    line->why);
        return;
    }
    const struct frames_run *run = &table->session.run;
    const struct frames_contestant *c = &run->contestant[line->contestant];
    struct frames_stats stats = frames_stats_of(run, line->contestant);
    char ratio[80] = "-\t-\t-", apart[40] = "-";
    if (paper_line_other(id) != id && has(table, paper_line_other(id)))
        put_ratio(ratio, ratio_of(table, id, paper_line_other(id)),
                  paper_line_name(paper_line_other(id)));
    if (line->checked)
        snprintf(apart, sizeof apart, "%zu/%zu", line->diff.paths_apart, line->diff.colours);
    grid_add(grid,
             !line->checked   ? PAINT_PLAIN
             : is_right(line) ? PAINT_GOOD
                              : PAINT_BAD,
             "%s\t%s\t%.3f\t%s\t%llu\t%s\t%zu\t%.3f\t%.3f\t%.3f\t%s",
             !line->checked   ? "-"
             : is_right(line) ? "agrees"
                              : "WRONG",
             c->handler, stats.average, ratio, (unsigned long long)c->bytes, apart, line->wrong,
             stats.median, stats.least, stats.most, frames_clock(c));
}

static void print_head(const struct paper_table *table)
{
    const struct screen *screen = &table->bench->screen_is;
    const struct frames_run *run = &table->session.run;
    const struct paper_figure *figure = table->scene->figure;
    puts("");
    screen_text(screen,
                "%s, %u x %u pixels, 4 bounces, workgroups of 16 x 16: %s over %s, "
                "all lines by turns%s\n",
                table->scene->spec, table->width, table->height, COUNTED(run->done, "frame"),
                COUNTED(run->settings.turns, "turn"), run->stopped ? "; stopped by a signal" : "");
    screen_text(screen,
                "vulkan: one ray of each path per invocation and dispatch, the arithmetic "
                "unchanged, but where whole paths are named; a ray that was cut short would have "
                "ended the line. First frames (2 to check, %u to warm up) dropped.\n",
                run->dropped);
    if (table->scene->furnished)
        screen_text(screen, "The mesh has no lights: two, and the default red with a tenth of "
                            "reflection, were put there.\n");
    if (!table->scene->same)
        printf("ANOTHER MESH than the paper's, of %u triangles to its %u.\n",
               table->scene->scene.tri_count, figure->tri_count);
    printf("The paper, average ms: direct %.3f, RF %.3f, ratio %.3f\n", figure->direct_ms,
           figure->rf_ms, figure->direct_ms / figure->rf_ms);
    puts("ms per frame, and the ratio of the times of one frame:");
}

/* Printed before these lines. */
static const char *const headings[LINE_COUNT] = {
    [LINE_DIRECT] = " published shader",
    [LINE_DIRECT_WHOLE] = " published shader, whole paths in one dispatch, unmodified",
    [LINE_DIRECT_CULLS] = " published shader, its box test alone replaced by one that culls: the "
                          "pictures break (faults F2 and F3, docs/rtrs-faults.md)",
    [LINE_F32_2] = " repaired: builder median, box test robust, triangle test mt",
    [LINE_F32_2_WHOLE] = " repaired, whole paths in one dispatch",
};

void paper_print_table(struct paper_table *table)
{
    static const struct column columns[] = {{"verdict", .left = true},
                                            {"line", .left = true},
                                            {.title = "average", .least = TIME_WIDTH},
                                            {.title = "ratio", .least = 6},
                                            {"of", .left = true},
                                            {"least-most", .rank = 1, .least = SPAN_WIDTH},
                                            {"bytes", .rank = 2},
                                            {"cpu", .rank = 4},
                                            {.title = "wrong"},
                                            {"median", .rank = 5, .least = TIME_WIDTH},
                                            {"least", .rank = 6, .least = TIME_WIDTH},
                                            {"most", .rank = 7, .least = TIME_WIDTH},
                                            {"clock", .left = true, .rank = 8}};
    const struct screen *screen = &table->bench->screen_is;
    struct row_grid grid = {.column = columns, .column_count = ARRAY_COUNT(columns)};
    if (table->session.run.count == 0)
        return;
    print_head(table);
    for (enum paper_line_id id = 0; id < LINE_COUNT; id++) {
        if (headings[id]) {
            if (grid.row_count > 0)
                grid_print(&grid, screen);
            screen_text(screen, "%s\n", headings[id]);
        }
        print_line(table, id, &grid);
        add_row(table, id);
        if (!is_right(&table->line[id]))
            bench_worse(table->bench, EXIT_MISMATCH);
    }
    grid_print(&grid, screen);
    screen_text(screen,
                "verdict and cpu: paths/pixels that differ from engine cpu's with the same members "
                "(pixels alone: pow, within rounding)\n");
    screen_text(screen, "wrong: pixels of %u that differ from brute force's, of the first frame\n",
                table->width * table->height);
}

/* The summary of a scene: the time of `to` against that of `from`; or only a text, if both are
 * equal. */
static const struct {
    const char *text;
    enum paper_line_id from, to;
} words[] = {
    {.text = " as published, where every ray visits every node and no box culls,"},
    {"RF (leaf 4) against direct (leaf 2):        ", LINE_DIRECT, LINE_RF},
    {"the layout alone, same tree, leaf 4:        ", LINE_DIRECT_4, LINE_RF},
    {"direct alone, leaf 4 against leaf 2:        ", LINE_DIRECT, LINE_DIRECT_4},
    {"RF against direct, whole paths:             ", LINE_DIRECT_WHOLE, LINE_RF_WHOLE},
    {"the naive handler, never timed, against RF: ", LINE_RF, LINE_NAIVE},
    {.text = " once the box test culls, and all that it had hidden is repaired,"},
    {"rf16, leaf 4, against f32, leaf 2:          ", LINE_F32_2, LINE_RF16_4},
    {"the layout alone, same tree, leaf 4:        ", LINE_F32_4, LINE_RF16_4},
    {"the layout alone, same tree, leaf 2:        ", LINE_F32_2, LINE_RF16_2},
    {"whole paths: rf16, leaf 4, to f32, leaf 2:  ", LINE_F32_2_WHOLE, LINE_RF16_4_WHOLE},
    {"whole paths: the layout alone, leaf 4:      ", LINE_F32_4_WHOLE, LINE_RF16_4_WHOLE},
    {"whole paths: the layout alone, leaf 2:      ", LINE_F32_2_WHOLE, LINE_RF16_2_WHOLE},
    {.text = " and, the look being another,"},
    {"repaired rf16 against published RF:         ", LINE_RF, LINE_RF16_4},
    {"the same, whole paths against published RF: ", LINE_RF, LINE_RF16_4_WHOLE},
};

/* Prints the summary, "TEXT 12.3 % less (1.14, 1.12-1.16)" for each pair that was measured. */
static void say_scene(const struct paper_table *table)
{
    printf("%s%s: less or more time, and the ratio of times (median, least-most)\n",
           table->scene->spec, table->scene->same ? "" : " (another mesh)");
    for (size_t i = 0; i < ARRAY_COUNT(words); i++) {
        if (words[i].from == words[i].to)
            puts(words[i].text);
        else if (has(table, words[i].from) && has(table, words[i].to)) {
            struct spread ratio = ratio_of(table, words[i].from, words[i].to);
            double saved = 100.0 * (1.0 - 1.0 / ratio.median);
            const int digits = ratio.most < 99.995 ? 2 : 0; /* the line has 80 columns at most */
            printf("  %s%.1f %% %s (%.*f, %.*f-%.*f)\n", words[i].text, fabs(saved),
                   saved >= 0 ? "less" : "more", digits, ratio.median, digits, ratio.least, digits,
                   ratio.most);
        }
    }
}

void paper_print_words(struct paper_table *const *table, size_t count)
{
    bool any = false;
    for (size_t i = 0; i < count; i++)
        any = any || (table[i] && table[i]->session.run.done > 0);
    if (!any)
        return;
    const struct paper_figure *small = &paper_figures[PAPER_DEFAULT];
    const struct paper_figure *large = &paper_figures[PAPER_TEAPOT];
    puts("\nThe paper's 19 %. It is 2 (a - b) / (a + b) of");
    printf("  %.3f and %.3f ms: %.1f %% of the time saved;\n", small->direct_ms, small->rf_ms,
           100.0 * (1.0 - small->rf_ms / small->direct_ms));
    printf("  %.3f and %.3f ms: %.1f %% of the time saved;\n", large->direct_ms, large->rf_ms,
           100.0 * (1.0 - large->rf_ms / large->direct_ms));
    puts("and the two have other leaf sizes.");
    for (size_t i = 0; i < count; i++)
        if (table[i] && table[i]->session.run.done > 0)
            say_scene(table[i]);
}

/* One panel per scene: every line is a point with a bar from its fastest to its slowest frame. */
enum status paper_write_plot(struct paper_table *const *table, size_t count, const char *path,
                             struct reason *reason)
{
    struct plot_series series[LINE_COUNT];
    struct plot_point point[PAPER_FIGURES][LINE_COUNT];
    struct plot_figure figure = {.title = "The paper's performance table",
                                 .subtitle = "median ms per frame, bars from least to most; bytes "
                                             "of the tree, 1 where there is none",
                                 .series = series,
                                 .series_count = LINE_COUNT};
    for (enum paper_line_id id = 0; id < LINE_COUNT; id++)
        series[id] = (struct plot_series){paper_line_name(id), (unsigned)id, (unsigned)id / 4,
                                          paper_line_published(id)};
    for (size_t i = 0; i < count && figure.panel_count < PLOT_PANELS; i++) {
        size_t points = 0;
        for (enum paper_line_id id = 0; id < LINE_COUNT && table[i]; id++) {
            if (!has(table[i], id))
                continue;
            const struct frames_run *run = &table[i]->session.run;
            size_t c = table[i]->line[id].contestant;
            struct frames_stats stats = frames_stats_of(run, c);
            double bytes = fmax(1.0, (double)run->contestant[c].bytes);
            point[i][points++] = (struct plot_point){id,           bytes,       bytes,      bytes,
                                                     stats.median, stats.least, stats.most, false};
        }
        if (points > 0)
            figure.panel[figure.panel_count++] = (struct plot_panel){
                table[i]->scene->spec, "bytes of the tree", "ms per frame", point[i], points};
    }
    return figure.panel_count ? plot_write_file(path, &figure, 1, reason) : STATUS_OK;
}

/* Plots direct and RF over the frames, like the paper's own charts. */
enum status paper_write_chart(const struct paper_table *table, const char *base,
                              struct reason *reason)
{
    static const enum paper_line_id shown[] = {LINE_DIRECT, LINE_RF};
    const struct frames_run *run = &table->session.run;
    struct chart_series series[ARRAY_COUNT(shown)];
    char svg[4096], png[4096], title[160];
    size_t count = 0;
    for (size_t i = 0; i < ARRAY_COUNT(shown); i++) {
        if (has(table, shown[i]))
            series[count++] = frames_series(run, table->line[shown[i]].contestant);
    }
    if (count == 0)
        return STATUS_OK;
    snprintf(title, sizeof title, "%.60s, published shader, %u x %u", table->scene->spec,
             table->width, table->height);
    if (snprintf(svg, sizeof svg, "%s-%s.svg", base, table->scene->figure->scene) >=
            (int)sizeof svg ||
        snprintf(png, sizeof png, "%s-%s.png", base, table->scene->figure->scene) >=
            (int)sizeof png)
        return fail(reason, STATUS_INPUT, "--out: too long a name");
    const struct chart chart = frames_chart(run, title, series, count);
    return chart_write(&chart, svg, png, reason);
}
