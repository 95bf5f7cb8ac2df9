/* Output of raydiff bench error: tables, rows for machines, plots. */
#include "cmd/bench/cmd_bench_error.h"
#include "bench/chart/json_value.h"
#include "bench/chart/row_plot.h"
#include "ref/base/command.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"

#include <math.h>
#include <string.h>

static void print_name(const struct error_row *row)
{
    printf("%-13s %-13s %-10s %-7s ", row->engine->name, row->layout ? row->layout->name : "-",
           row->box ? row->box->name : "-", row->tri ? row->tri->name : "own");
}

static void print_speeds(const struct error_page *page)
{
    puts("per million:                                                                             "
         "                                        leaks    leaks");
    puts("engine        nodes         box        tri     Mray/s (least-most)     ratio "
         "(least-most)              lost  phantom wrong id     edge   vertex  named  WRONG  err/E");
    for (size_t i = 0; i < page->row_count; i++) {
        const struct error_row *row = &page->row[i];
        char speed[48], ratio[64];
        snprintf(speed, sizeof speed, "%.3f (%.3f-%.3f)", row->mrays.median, row->mrays.least,
                 row->mrays.most);
        snprintf(ratio, sizeof ratio, "%.2f (%.2f-%.2f) of %s", row->ratio.median, row->ratio.least,
                 row->ratio.most, row->base);
        print_name(row);
        printf("%-23s %-27s", speed, ratio);
        bench_rate(8, row->sum.kind[ERROR_LOST], row->sum.rays);
        bench_rate(8, row->sum.kind[ERROR_PHANTOM], row->sum.rays);
        bench_rate(8, row->sum.kind[ERROR_WRONG], row->sum.rays);
        for (int target = 0; target < LEAK_TARGETS; target++)
            bench_rate(8, row->leak[target], page->leak_rays[target]);
        printf(row->judged ? " %6zu %6zu %6.3f\n" : " %6zu (%4zu) %6.3f\n", row->verdicts.allowed,
               row->verdicts.wrong, row->verdicts.over);
    }
}

static void print_quantiles(const struct quantiles *q)
{
    const double value[3] = {q->p50, q->p99, q->most};
    for (int k = 0; k < 3; k++)
        printf(" %8.3g", value[k]);
}

/* Prints a factor, or "-" if it is not finite. */
static void print_factor(double value)
{
    if (isfinite(value))
        printf(" %6.3f", value);
    else
        printf(" %6s", "-");
}

static void print_accuracy(const struct error_page *page)
{
    puts("in u x size:                                                      forward                "
         "      plane                      point  boxes   tris  bytes   bytes");
    puts("engine        nodes         box        tri          p50      p99      max      p50      "
         "p99      max      p50      p99      max   /f32   /f32  /node    /tri");
    for (size_t i = 0; i < page->row_count; i++) {
        const struct error_row *row = &page->row[i];
        print_name(row);
        print_quantiles(&row->sum.forward);
        print_quantiles(&row->sum.plane);
        print_quantiles(&row->sum.point);
        print_factor(row->boxes_to_f32);
        print_factor(row->tris_to_f32);
        if (row->layout)
            printf(" %6u %7.1f\n", row->layout->node_bytes,
                   (double)(row->node_bytes + row->item_bytes) / (double)page->tri_count);
        else if (row->node_bytes)
            printf("      - %7.1f\n", (double)row->node_bytes / (double)page->tri_count);
        else
            puts("      -       -");
    }
}

/* --- tables that fit the screen ------------------------------------------------------------ */

static const struct column error_columns[] = {
    {"verdict", .left = true},
    {"engine", .left = true},
    {"layout", .left = true},
    {"box", .left = true, .varies = true, .rank = 1},
    {"tri", .left = true, .varies = true, .rank = 2},
    {.title = "WRONG"},
    {"allowed", .rank = 7},
    {.title = "lost"},
    {.title = "phantom"},
    {"wrong-id", .rank = 6},
    {"edge", .rank = 3},
    {"vertex", .rank = 4},
    {"Mray/s", .rank = 5},
    {"ratio", .rank = 8},
    {"of", .left = true, .rank = 8},
    {"err/E", .rank = 9},
};

static void print_errors(const struct error_page *page, const struct screen *screen)
{
    struct row_grid grid = {.column = error_columns, .column_count = ARRAY_COUNT(error_columns)};
    for (size_t i = 0; i < page->row_count; i++) {
        const struct error_row *row = &page->row[i];
        const bool wrong = row->verdicts.wrong > 0;
        const size_t kind[] = {row->sum.kind[ERROR_LOST], row->sum.kind[ERROR_PHANTOM],
                               row->sum.kind[ERROR_WRONG]};
        char rate[3 + LEAK_TARGETS][32];
        for (int k = 0; k < 3; k++)
            error_rate_text(kind[k], row->sum.rays, rate[k], sizeof rate[k]);
        for (int k = 0; k < LEAK_TARGETS; k++)
            error_rate_text(row->leak[k], page->leak_rays[k], rate[3 + k], sizeof rate[3 + k]);
        grid_add(&grid,
                 !row->judged ? PAINT_DIM
                 : wrong      ? PAINT_BAD
                              : PAINT_GOOD,
                 "%s\t%s\t%s\t%s\t%s\t%zu\t%zu\t%s\t%s\t%s\t%s\t%s\t%.3f\t%.2f\t%s\t%.3f",
                 !row->judged ? "counted"
                 : wrong      ? "WRONG"
                              : "agrees",
                 row->engine->name, row->layout ? row->layout->name : "-",
                 row->box ? row->box->name : "-", row->tri ? row->tri->name : "own",
                 row->verdicts.wrong, row->verdicts.allowed, rate[0], rate[1], rate[2],
                 rate[3 + LEAK_EDGE], rate[3 + LEAK_VERTEX], row->mrays.median, row->ratio.median,
                 row->base, row->verdicts.over);
    }
    screen_text(screen, "lost, phantom, wrong triangle, and leaks at edges and vertices: per "
                        "million\n");
    grid_print(&grid, screen);
}

static json_t *row_json(const struct bench *bench, const struct error_page *page,
                        const struct error_row *row)
{
    const struct error_sum *sum = &row->sum;
    const struct known_verdicts *verdicts = &row->verdicts;
    const struct quantiles *forward = &sum->forward, *plane = &sum->plane, *point = &sum->point;
    return json_record(
        "scene=%s triangles=%u rays=%s seed=%zu engine=%s layout=%p box=%p tri=%p count=%zu "
        "rounds=%zu mrays_median=%g mrays_min=%g mrays_max=%g base=%s ratio_median=%g ratio_min=%g "
        "ratio_max=%g exact_hits=%zu compared=%zu hits=%zu lost=%zu phantom=%zu wrong_id=%zu "
        "in_plane=%zu edge_rays=%zu edge_leaks=%zu vertex_rays=%zu vertex_leaks=%zu judged=%i "
        "named=%zu wrong=%zu err_over_bound=%g displacement=%g forward_p50=%g forward_p99=%g "
        "forward_max=%g plane_p50=%g plane_p99=%g plane_max=%g point_p50=%g point_p99=%g "
        "point_max=%g boxes_per_ray=%g tris_per_ray=%g boxes_to_f32=%g tris_to_f32=%g "
        "bytes_per_node=%p node_bytes=%p item_bytes=%p memory_bytes=%p",
        page->scene, page->tri_count, page->rays, bench->seed, row->engine->name,
        json_text(row->layout ? row->layout->name : NULL),
        json_text(row->box ? row->box->name : NULL), json_text(row->tri ? row->tri->name : NULL),
        page->ray_count, bench->rounds, row->mrays.median, row->mrays.least, row->mrays.most,
        row->base, row->ratio.median, row->ratio.least, row->ratio.most, page->exact_hits,
        sum->rays, sum->hits, sum->kind[ERROR_LOST], sum->kind[ERROR_PHANTOM],
        sum->kind[ERROR_WRONG], sum->kind[ERROR_FREE], page->leak_rays[LEAK_EDGE],
        row->leak[LEAK_EDGE], page->leak_rays[LEAK_VERTEX], row->leak[LEAK_VERTEX], row->judged,
        verdicts->allowed, verdicts->wrong, verdicts->over, verdicts->displacement, forward->p50,
        forward->p99, forward->most, plane->p50, plane->p99, plane->most, point->p50, point->p99,
        point->most, row->boxes, row->tris, row->boxes_to_f32, row->tris_to_f32,
        row->layout ? json_integer((json_int_t)row->layout->node_bytes) : json_null(),
        row->layout ? json_integer((json_int_t)row->node_bytes) : json_known(row->node_bytes),
        row->layout ? json_integer((json_int_t)row->item_bytes) : json_null(),
        json_known(row->memory_bytes));
}

void error_print(struct bench *bench, const struct error_page *page)
{
    char name[BENCH_TREE_NAME];
    putchar('\n');
    screen_text(&bench->screen_is,
                "%s: %s; %zu %s %s, seed %llu, of which exactly %zu hit; %s; %s interleaved\n",
                page->scene, COUNTED(page->tri_count, "triangle"), page->ray_count, page->rays,
                page->ray_count == 1 ? "ray" : "rays", (unsigned long long)bench->seed,
                page->exact_hits, bench_tree_name(bench, name), COUNTED(bench->rounds, "round"));
    if (page->leak_rays[LEAK_VERTEX])
        printf("closed: %s from inside aimed at edges, %zu at vertices\n",
               COUNTED(page->leak_rays[LEAK_EDGE], "ray"), page->leak_rays[LEAK_VERTEX]);
    else
        screen_text(&bench->screen_is, "no leaks counted: %s\n", page->no_leaks.text);
    if (bench->screen_is.wide) {
        print_speeds(page);
        print_accuracy(page);
    } else {
        print_errors(page, &bench->screen_is);
    }
    for (size_t i = 0; i < page->row_count; i++)
        bench_row(bench, &bench_error, row_json(bench, page, &page->row[i]));
}

void error_driver(const struct engine_options *options, char *text, size_t text_bytes)
{
    const struct engine *vulkan = engine_find("vulkan");
    char line[1024];
    snprintf(text, text_bytes, "%s", "");
    if (!vulkan)
        return;
    engine_describe(vulkan, options, line, sizeof line);
    line[strcspn(line, "\n")] = '\0';
    /* The line is "0: DEVICE (DRIVER)": DRIVER is the last pair of parentheses. Parentheses inside
     * it depend on the machine, so the text ends there. */
    size_t end = strlen(line), at = end;
    int depth = 0;
    if (end == 0 || line[end - 1] != ')')
        return;
    while (at > 0) {
        at--;
        depth += line[at] == ')' ? 1 : line[at] == '(' ? -1 : 0;
        if (depth == 0)
            break;
    }
    char *driver = line + at + 1;
    driver[strcspn(driver, "()")] = '\0';
    size_t length = strlen(driver);
    while (length > 0 && driver[length - 1] == ' ')
        driver[--length] = '\0';
    snprintf(text, text_bytes, "%s", driver);
}

/* --- the plot ----------------------------------------------------------------------------- */

enum status error_plot(const struct bench *bench, const char *driver, struct reason *reason)
{
    struct row_plots plots = {0};
    json_t *rows = value_where(bench->rows, "benchmark", bench_error.name);
    enum status status = row_plots_error(rows, driver, &plots, reason);
    if (status == STATUS_OK && plots.count > 0)
        status = plot_write_file(bench->svg_path, plots.figure, plots.count, reason);
    row_plots_free(&plots);
    json_decref(rows);
    return status;
}
