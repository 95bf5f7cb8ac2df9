/* What raydiff bench error shows: tables, rows for machines, a plot. */
#include "cmd/bench/cmd_bench_error.h"
#include "bench/chart/row_plot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void print_name(const struct error_row *row)
{
    printf("%-13s %-13s %-10s %-7s ", row->engine->name, row->layout ? row->layout->name : "-",
           row->box ? row->box->name : "-", row->tri ? row->tri->name : "own");
}

static void print_rate(size_t events, size_t count)
{
    char text[32];
    error_rate_text(events, count, text, sizeof text);
    printf(" %8s", text);
}

static void print_speeds(const struct error_page *page)
{
    printf("%-13s %-13s %-10s %-7s %-23s %-27s %8s %8s %8s %8s %8s\n", "per million:", "", "", "",
           "", "", "", "", "", "leaks", "leaks");
    printf("%-13s %-13s %-10s %-7s %-23s %-27s %8s %8s %8s %8s %8s %6s %6s %6s\n", "engine",
           "nodes", "box", "tri", "Mray/s (least-most)", "ratio (least-most)", "lost", "phantom",
           "wrong id", "edge", "vertex", "named", "WRONG", "err/E");
    for (size_t i = 0; i < page->row_count; i++) {
        const struct error_row *row = &page->row[i];
        char speed[48], ratio[64];
        snprintf(speed, sizeof speed, "%.3f (%.3f-%.3f)", row->mrays.median, row->mrays.least,
                 row->mrays.most);
        snprintf(ratio, sizeof ratio, "%.2f (%.2f-%.2f) of %s", row->ratio.median, row->ratio.least,
                 row->ratio.most, row->base);
        print_name(row);
        printf("%-23s %-27s", speed, ratio);
        print_rate(row->sum.kind[ERROR_LOST], row->sum.rays);
        print_rate(row->sum.kind[ERROR_PHANTOM], row->sum.rays);
        print_rate(row->sum.kind[ERROR_WRONG], row->sum.rays);
        for (int target = 0; target < LEAK_TARGETS; target++)
            print_rate(row->leak[target], page->leak_rays[target]);
        if (isnan(row->over))
            printf(" %6s %6s %6s\n", "-", "-", "-");
        else if (row->judged)
            printf(" %6zu %6zu %6.3f\n", row->named, row->wrong, row->over);
        else
            printf(" %6zu (%4zu) %6.3f\n", row->named, row->wrong, row->over);
    }
}

static void print_quantiles(const struct quantiles *q)
{
    const double value[3] = {q->p50, q->p99, q->most};
    for (int k = 0; k < 3; k++)
        printf(" %8.3g", value[k]);
}

/* A factor, or that there is none. */
static void print_factor(double value)
{
    if (isfinite(value))
        printf(" %6.3f", value);
    else
        printf(" %6s", "-");
}

static void print_accuracy(const struct error_page *page)
{
    printf("%-13s %-13s %-10s %-7s %26s %26s %26s %6s %6s %6s %7s\n", "in u x size:", "", "", "",
           "forward", "plane", "point", "boxes", "tris", "bytes", "bytes");
    printf("%-13s %-13s %-10s %-7s", "engine", "nodes", "box", "tri");
    for (int k = 0; k < 3; k++)
        printf(" %8s %8s %8s", "p50", "p99", "max");
    printf(" %6s %6s %6s %7s\n", "/f32", "/f32", "/node", "/tri");
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
        else
            printf(" %6s %7s\n", "-", "-");
    }
}

static void set(json_t *row, const char *name, json_t *value)
{
    json_object_set_new(row, name, value);
}

static void set_count(json_t *row, const char *name, uint64_t value)
{
    set(row, name, json_integer((json_int_t)value));
}

/* NAME_a, NAME_b and NAME_c. */
static void set_three(json_t *row, const char *name, const char *const part[3],
                      const double value[3])
{
    for (int k = 0; k < 3; k++) {
        char full[48];
        snprintf(full, sizeof full, "%s_%s", name, part[k]);
        set(row, full, bench_number(value[k]));
    }
}

static void set_spread(json_t *row, const char *name, const struct spread *s)
{
    static const char *const part[3] = {"median", "min", "max"};
    set_three(row, name, part, (const double[3]){s->median, s->least, s->most});
}

static void set_quantiles(json_t *row, const char *name, const struct quantiles *q)
{
    static const char *const part[3] = {"p50", "p99", "max"};
    set_three(row, name, part, (const double[3]){q->p50, q->p99, q->most});
}

static json_t *row_json(const struct bench *bench, const struct error_page *page,
                        const struct error_row *row)
{
    const struct error_sum *sum = &row->sum;
    json_t *out = json_object();
    if (!out)
        return NULL;
    set(out, "scene", json_string(page->scene));
    set_count(out, "triangles", page->tri_count);
    set(out, "rays", json_string(page->rays));
    set_count(out, "seed", bench->seed);
    set(out, "engine", json_string(row->engine->name));
    set(out, "layout", row->layout ? json_string(row->layout->name) : json_null());
    set(out, "box", row->box ? json_string(row->box->name) : json_null());
    set(out, "tri", row->tri ? json_string(row->tri->name) : json_null());
    set_count(out, "count", page->ray_count);
    set_count(out, "rounds", bench->rounds);
    set_spread(out, "mrays", &row->mrays);
    set(out, "base", json_string(row->base));
    set_spread(out, "ratio", &row->ratio);
    set_count(out, "exact_hits", page->exact_hits);
    set_count(out, "compared", sum->rays);
    set_count(out, "hits", sum->hits);
    set_count(out, "lost", sum->kind[ERROR_LOST]);
    set_count(out, "phantom", sum->kind[ERROR_PHANTOM]);
    set_count(out, "wrong_id", sum->kind[ERROR_WRONG]);
    set_count(out, "in_plane", sum->kind[ERROR_FREE]);
    set_count(out, "edge_rays", page->leak_rays[LEAK_EDGE]);
    set_count(out, "edge_leaks", row->leak[LEAK_EDGE]);
    set_count(out, "vertex_rays", page->leak_rays[LEAK_VERTEX]);
    set_count(out, "vertex_leaks", row->leak[LEAK_VERTEX]);
    set(out, "judged", json_boolean(row->judged));
    set_count(out, "named", row->named);
    set_count(out, "wrong", row->wrong);
    set(out, "err_over_bound", bench_number(row->over));
    set(out, "displacement", bench_number(row->displacement));
    set_quantiles(out, "forward", &sum->forward);
    set_quantiles(out, "plane", &sum->plane);
    set_quantiles(out, "point", &sum->point);
    set(out, "boxes_per_ray", bench_number(row->boxes));
    set(out, "tris_per_ray", bench_number(row->tris));
    set(out, "boxes_to_f32", bench_number(row->boxes_to_f32));
    set(out, "tris_to_f32", bench_number(row->tris_to_f32));
    set(out, "bytes_per_node",
        row->layout ? json_integer((json_int_t)row->layout->node_bytes) : json_null());
    set_count(out, "node_bytes", row->node_bytes);
    set_count(out, "item_bytes", row->item_bytes);
    set_count(out, "memory_bytes", row->memory_bytes);
    return out;
}

void error_print(struct bench *bench, const struct error_page *page)
{
    char name[BENCH_TREE_NAME];
    printf("\n%s: %u triangles; %zu %s rays, seed %llu, of which exactly %zu hit; %s; %llu rounds "
           "interleaved\n",
           page->scene, page->tri_count, page->ray_count, page->rays,
           (unsigned long long)bench->seed, page->exact_hits, bench_tree_name(bench, name),
           (unsigned long long)bench->rounds);
    if (page->leak_rays[LEAK_VERTEX])
        printf("closed: %zu rays from inside aimed at edges, %zu at vertices\n",
               page->leak_rays[LEAK_EDGE], page->leak_rays[LEAK_VERTEX]);
    else
        printf("no leaks counted: %s\n", page->no_leaks.text);
    print_speeds(page);
    print_accuracy(page);
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
    vulkan->describe(options, line, sizeof line);
    line[strcspn(line, "\n")] = '\0';
    /* "0: DEVICE (DRIVER)": DRIVER is the last parenthesis; what it holds in parentheses is of the
     * machine. */
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

enum status error_plot(const char *path, const struct bench *bench, const struct error_page *page,
                       size_t count, const char *driver, struct reason *reason)
{
    struct row_plots plots = {0};
    struct file_out out;
    json_t *rows = json_array();
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < page[i].row_count; k++)
            (void)json_array_append_new(rows, row_json(bench, &page[i], &page[i].row[k]));
    enum status status = row_plots_error(rows, driver, &plots, reason);
    if (status == STATUS_OK && plots.count == 0)
        status = fail(reason, STATUS_MEMORY, "no memory for the plot");
    if (status == STATUS_OK)
        status = file_out_open(path, &out, reason);
    if (status == STATUS_OK) {
        plot_write(out.stream, plots.figure, plots.count);
        status = file_out_commit(&out, reason);
    }
    row_plots_free(&plots);
    json_decref(rows);
    return status;
}
