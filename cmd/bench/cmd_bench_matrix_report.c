/* Output of the matrix: tables, rows for machines, the Pareto front, a plot. */
#include "cmd/bench/cmd_bench_matrix.h"

#include "bench/chart/pareto.h"
#include "bench/chart/row_plot.h"
#include "ref/base/command.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"
#include "ref/store.h"

#include <math.h>

static double per_tri(const struct matrix *m, uint64_t bytes)
{
    return (double)bytes / (double)m->scene->tri_count;
}

/* All that the traversal reads; NAN: not known. */
static double bytes_of(const struct matrix *m, const struct matrix_row *row)
{
    return row->told && row->node_bytes == 0
               ? (double)NAN
               : per_tri(m, row->node_bytes + row->item_bytes + row->scene_bytes);
}

/* --- the front -------------------------------------------------------------------------------- */

static const char *const worth_text[PARETO_WORTH] = {"fastest", "smallest", "balanced"};

/* True if another row with the same engine, layout and storage is faster because of a better
 * tree. */
static bool has_better_tree(const struct matrix *m, const struct matrix_row *row)
{
    for (size_t i = 0; i < m->row_count; i++) {
        const struct matrix_entry *a = m->row[i].entry, *b = row->entry;
        if (a->engine == b->engine && a->layout == b->layout && a->store == b->store &&
            m->row[i].mean > row->mean)
            return true;
    }
    return false;
}

/* Marks the front of the GPU rows, or of the others. Only our own layouts can be worth using, each
 * on its best tree. */
static void mark_front(struct matrix *m, bool gpu)
{
    struct pareto_point point[CONTESTANTS] = {{0}}, own[CONTESTANTS] = {{0}};
    struct matrix_row *row[CONTESTANTS];
    bool on[CONTESTANTS];
    size_t count = 0, worth[PARETO_WORTH];
    for (size_t i = 0; i < m->row_count; i++) {
        struct matrix_row *r = &m->row[i];
        if (matrix_entry_is_gpu(r->entry) != gpu)
            continue;
        double asked = (double)(r->asked + r->leak_rays);
        row[count] = r;
        point[count] = own[count] =
            (struct pareto_point){.size = bytes_of(m, r),
                                  .speed = r->mean,
                                  .error = (double)(r->lost + r->leaks) / (asked > 0 ? asked : 1)};
        if (!r->entry->layout || has_better_tree(m, r) || r->verdicts.wrong > 0)
            own[count].size = NAN;
        count++;
    }
    pareto_front(point, count, on);
    pareto_worth(own, count, worth);
    for (size_t i = 0; i < count; i++) {
        row[i]->on_front = on[i];
        row[i]->worth = NULL;
    }
    for (int what = 0; what < PARETO_WORTH; what++)
        if (worth[what] < count)
            row[worth[what]]->worth = worth_text[what];
}

static void print_front(const struct matrix *m)
{
    char text[2000] = "";
    const char *before = "  front of size, speed and lost hits: ";
    for (size_t i = 0; i < m->row_count; i++)
        if (m->row[i].on_front) {
            text_append(text, sizeof text, "%s%s", before, m->row[i].entry->name);
            before = "; ";
        }
    screen_text(&m->bench->screen_is, "%s\n", text);
    before = "  worth using, nothing lost: ";
    text[0] = '\0';
    for (int what = 0; what < PARETO_WORTH; what++)
        for (size_t i = 0; i < m->row_count; i++)
            if (m->row[i].worth == worth_text[what]) {
                text_append(text, sizeof text, "%s%s (%s)", before, m->row[i].entry->name,
                            worth_text[what]);
                before = ", ";
            }
    screen_text(&m->bench->screen_is, "%s\n", text);
    putchar('\n');
}

/* --- tables ----------------------------------------------------------------------------------- */

static void print_speeds(const struct matrix *m)
{
    unsigned threads = m->row_count ? m->row[0].threads : 1;
    putchar('\n');
    screen_text(&m->bench->screen_is, "%s: %s, %s of each kind, %s interleaved, %s\n", m->spec,
                COUNTED(m->scene->tri_count, "triangle"), COUNTED(m->count, "ray"),
                COUNTED(m->bench->rounds, "round"), COUNTED(threads, "thread"));
    if (!m->bench->screen_is.wide)
        return;
    printf("  %-30s", "speed, least-most");
    for (int kind = 0; kind < MATRIX_KINDS; kind++)
        printf(" %-16s", matrix_kinds[kind]);
    puts("   mean   warm  prim Mr/s");
    for (size_t i = 0; i < m->row_count; i++) {
        const struct matrix_row *r = &m->row[i];
        printf("  %-30s", r->entry->name);
        for (int kind = 0; kind < MATRIX_KINDS; kind++) {
            char text[40];
            snprintf(text, sizeof text, "%.2f (%.2f-%.2f)", r->ratio[kind].median,
                     r->ratio[kind].least, r->ratio[kind].most);
            printf(" %-16s", text);
        }
        printf(" %6.2f %6.2f %10.3f\n", r->mean, r->mean_warm, r->mrays[KIND_PRIM].median);
    }
}

static void print_part(double bytes, bool known)
{
    if (known)
        printf(" %6.1f", bytes);
    else
        printf(" %6s", "-");
}

/* Prints "0 of 8192". */
static void print_of(size_t events, size_t count)
{
    char text[48];
    snprintf(text, sizeof text, "%zu of %zu", events, count);
    printf(" %12s", count ? text : "-");
}

static void print_sizes(const struct matrix *m)
{
    puts("  bytes per triangle              nodes  items  scene    all  lines prim L1 L2   rand    "
         "           diff                       lost        wrong        leaks allowed   "
         "WRONG");
    for (size_t i = 0; i < m->row_count; i++) {
        const struct matrix_row *r = &m->row[i];
        printf("  %-30s", r->entry->name);
        print_part(per_tri(m, r->node_bytes), r->told ? r->node_bytes : r->touched);
        print_part(per_tri(m, r->item_bytes), r->touched);
        print_part(per_tri(m, r->scene_bytes), !r->told || r->scene_bytes);
        print_part(bytes_of(m, r), isfinite(bytes_of(m, r)));
        putchar(' ');
        for (int kind = 0; kind < MATRIX_CLOSEST; kind++) {
            char text[64] = "-";
            if (r->touched)
                snprintf(text, sizeof text, "%.0f %.0f %.0f", r->touch[kind].looked,
                         r->touch[kind].beyond[0], r->touch[kind].beyond[1]);
            printf(" %-18s", text);
        }
        print_of(r->lost, r->asked);
        print_of(r->wrong, r->asked);
        print_of(r->leaks, r->leak_rays);
        char text[24];
        snprintf(text, sizeof text, r->judged ? "%zu" : "(%zu)", r->verdicts.wrong);
        printf(" %7zu %7s\n", r->verdicts.allowed, text);
    }
}

/* --- a table that fits the screen --------------------------------------------------------- */

static const struct column columns[] = {
    {"verdict", .left = true},
    {"contestant", .left = true},
    {.title = "WRONG"},
    {"allowed", .rank = 3},
    {.title = "lost"},
    {"leaks", .rank = 1},
    {.title = "B/tri"},
    {"prim", .rank = 4, .least = 5},
    {"rand", .rank = 5, .least = 5},
    {"diff", .rank = 6, .least = 5},
    {"o-shad", .rank = 8},
    {"o-rand", .rank = 7},
    {.title = "mean", .least = 5},
    {.title = "warm", .least = 5},
    {"Mray/s", .rank = 2, .least = TIME_WIDTH},
};

static void print_table(const struct matrix *m, bool full)
{
    struct row_grid grid = {.column = columns, .column_count = ARRAY_COUNT(columns)};
    const struct screen *screen = &m->bench->screen_is;
    for (size_t i = 0; i < m->row_count; i++) {
        const struct matrix_row *r = &m->row[i];
        const bool wrong = r->verdicts.wrong > 0;
        char bytes[32] = "-";
        if (isfinite(bytes_of(m, r)))
            snprintf(bytes, sizeof bytes, "%.1f", bytes_of(m, r));
        grid_add(&grid,
                 !r->judged ? PAINT_DIM
                 : wrong    ? PAINT_BAD
                            : PAINT_GOOD,
                 "%s\t%s\t%zu\t%zu\t%zu\t%zu\t%s\t%.2f\t%.2f\t%.2f\t%.2f\t%.2f\t%.2f\t%.2f\t"
                 "%.3f",
                 !r->judged ? "counted"
                 : wrong    ? "WRONG"
                            : "agrees",
                 r->entry->name, r->verdicts.wrong, r->verdicts.allowed, r->lost, r->leaks, bytes,
                 r->ratio[0].median, r->ratio[1].median, r->ratio[2].median, r->ratio[3].median,
                 r->ratio[4].median, r->mean, r->mean_warm, r->mrays[KIND_PRIM].median);
    }
    if (m->row_count && full)
        screen_text(screen, "lost of %s, leaks of %zu; speeds are ratios to the first\n",
                    COUNTED(m->row[0].asked, "ray"), m->row[0].leak_rays);
    grid_print(&grid, screen);
}

/* --- rows ------------------------------------------------------------------------------------- */

static json_t *part_json(const struct matrix_row *row, uint64_t bytes)
{
    return row->told ? json_known(bytes) : json_integer((json_int_t)bytes);
}

static json_t *row_json(const struct matrix *m, const struct matrix_row *r)
{
    const struct matrix_entry *e = r->entry;
    json_t *row =
        json_record("scene=%s triangles=%u threads=%u name=%s engine=%s layout=%s store=%s "
                    "builder=%s reinsert=%u rays=%zu rounds=%zu",
                    m->spec, m->scene->tri_count, r->threads, e->name, e->engine->name,
                    e->layout ? e->layout->name : "-", e->store ? e->store->name : "-",
                    e->builder ? e->builder->name : "-", e->passes, r->rays, m->bench->rounds);
    for (int kind = 0; kind < MATRIX_KINDS; kind++) {
        const char *name = matrix_kinds[kind];
        const struct spread *ratio = &r->ratio[kind], *warm = &r->warm[kind];
        json_add(row, "%s_mrays=%g %s_ratio=%g %s_ratio_min=%g %s_ratio_max=%g", name,
                 r->mrays[kind].median, name, ratio->median, name, ratio->least, name, ratio->most);
        json_add(row, "%s_warm=%g %s_warm_min=%g %s_warm_max=%g", name, warm->median, name,
                 warm->least, name, warm->most);
    }
    json_add(row,
             "mean_ratio=%g mean_warm=%g node_bytes=%p item_bytes=%p scene_bytes=%p "
             "held_bytes=%p bytes_per_triangle=%g",
             r->mean, r->mean_warm, part_json(r, r->node_bytes), part_json(r, r->item_bytes),
             part_json(r, r->scene_bytes), json_known(r->held_bytes), bytes_of(m, r));
    for (int kind = 0; kind < MATRIX_CLOSEST; kind++) {
        const char *name = matrix_kinds[kind];
        const struct matrix_touch *t = &r->touch[kind];
        json_add(row, "%s_line_bytes=%g %s_beyond_l1=%g %s_beyond_l2=%g", name,
                 r->touched ? t->looked : (double)NAN, name,
                 r->touched ? t->beyond[0] : (double)NAN, name,
                 r->touched ? t->beyond[1] : (double)NAN);
    }
    json_add(row,
             "asked=%zu lost=%zu wrong=%zu leak_rays=%zu leaks=%zu judged=%i compared=%zu "
             "allowed=%zu judged_wrong=%zu front=%i worth=%s",
             r->asked, r->lost, r->wrong, r->leak_rays, r->leaks, r->judged, r->verdicts.compared,
             r->verdicts.allowed, r->verdicts.wrong, r->on_front, r->worth ? r->worth : "-");
    return row;
}

void matrix_print(struct matrix *matrix, bool full)
{
    mark_front(matrix, false);
    mark_front(matrix, true);
    print_speeds(matrix);
    if (!matrix->bench->screen_is.wide)
        print_table(matrix, full);
    else if (full)
        print_sizes(matrix);
    print_front(matrix);
    for (size_t i = 0; i < matrix->row_count; i++)
        bench_row(matrix->bench, &bench_matrix, row_json(matrix, &matrix->row[i]));
}

enum status matrix_plot(const char *path, const json_t *rows, struct reason *reason)
{
    struct row_plots plots;
    enum status status = row_plots_matrix(rows, &plots, reason);
    if (!status && plots.count == 0)
        status = fail(reason, STATUS_INPUT, "%s: nothing was measured to plot", path);
    if (!status)
        status = plot_write_file(path, plots.figure, plots.count, reason);
    row_plots_free(&plots);
    return status;
}
