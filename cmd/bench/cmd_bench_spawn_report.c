/* Output of raydiff bench spawn: tables, and rows for machines. */
#include "cmd/bench/cmd_bench_spawn.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"

#include <string.h>

const char *spawn_rule_name(enum spawn_rule rule)
{
    static const char *const names[SPAWN_RULES] = {"none",  "1e-5",    "1e-4", "1e-3",
                                                   "bound", "integer", "least"};
    return names[rule];
}

static void print_count(const struct spawn_count *count, size_t hits)
{
    printf("  ");
    bench_rate(7, count->self, hits);
    bench_rate(7, count->beside, hits);
    bench_rate(7, count->skipped, hits);
}

static void print_head(const struct spawn_block *block)
{
    printf("%-5s %-8s %9s %9s   %-24s", "", "", "moved", "", "exact");
    for (size_t i = 0; i < block->judge_count; i++)
        printf("  %-24s", block->judge[i]);
    printf("\n%-5s %-8s %9s %9s  ", "point", "rule", "p50", "max");
    for (size_t i = 0; i <= block->judge_count; i++)
        printf(" %7s %7s %7s  ", "self", "beside", "skip");
    putchar('\n');
}

static void print_row(const struct spawn_block *block, const struct spawn_row *row)
{
    printf("%-5s %-8s %9.2g %9.2g", spawn_point_name(row->point), spawn_rule_name(row->rule),
           row->offset.p50, row->offset.most);
    print_count(&row->exact, block->hit_count);
    for (size_t i = 0; i < block->judge_count; i++)
        print_count(&row->engine[i], block->hit_count);
    putchar('\n');
}

static void print_wide(const struct spawn_block *block)
{
    print_head(block);
    for (size_t i = 0; i < ARRAY_COUNT(block->row); i++)
        print_row(block, &block->row[i]);
}

/* The table that fits the screen: a row for each judge. */
static void print_table(const struct spawn_block *block, const struct screen *screen)
{
    static const struct column columns[] = {{"point", .left = true}, {"rule", .left = true},
                                            {"judge", .left = true}, {.title = "moved-p50"},
                                            {.title = "moved-max"},  {.title = "self"},
                                            {.title = "beside"},     {.title = "skip"}};
    struct row_grid grid = {.column = columns, .column_count = ARRAY_COUNT(columns)};
    for (size_t i = 0; i < ARRAY_COUNT(block->row); i++)
        for (size_t k = 0; k <= block->judge_count; k++) {
            const struct spawn_row *row = &block->row[i];
            const struct spawn_count *count = k ? &row->engine[k - 1] : &row->exact;
            char self[32], beside[32], skip[32];
            error_rate_text(count->self, block->hit_count, self, sizeof self);
            error_rate_text(count->beside, block->hit_count, beside, sizeof beside);
            error_rate_text(count->skipped, block->hit_count, skip, sizeof skip);
            grid_add(&grid, PAINT_PLAIN, "%s\t%s\t%s\t%.2g\t%.2g\t%s\t%s\t%s",
                     spawn_point_name(row->point), spawn_rule_name(row->rule),
                     k ? block->judge[k - 1] : "exact", row->offset.p50, row->offset.most, self,
                     beside, skip);
        }
    grid_print(&grid, screen);
}

static void print_least(const struct spawn_row *row)
{
    if (row->rule == RULE_LEAST)
        printf("%s: %.0f steps suffice for 50 %% of the rays, %.0f for 99 %%, %.0f for all%s",
               spawn_point_name(row->point), row->steps.p50, row->steps.p99, row->steps.most,
               row->never ? "" : "\n");
    if (row->never)
        printf(" but %zu, which no step frees\n", row->never);
}

static json_t *row_json(const struct bench *bench, const struct spawn_block *block,
                        const struct spawn_row *row, const char *judge,
                        const struct spawn_count *count)
{
    json_t *out = json_record(
        "scene=%s rays=%s scale=%g far=%g triangles=%u seed=%zu point=%s rule=%s engine=%s "
        "hits=%zu undecided=%zu near=%zu self=%zu beside=%zu skipped=%zu",
        block->scene, block->rays, block->scale, block->far, block->tri_count, bench->seed,
        spawn_point_name(row->point), spawn_rule_name(row->rule), judge, block->hit_count,
        block->undecided, row->near, count->self, count->beside, count->skipped);
    if (!out)
        return NULL;
    json_add(
        out,
        "moved_p50=%g moved_p99=%g moved_max=%g steps_p50=%g steps_p99=%g steps_max=%g never=%zu",
        row->offset.p50, row->offset.p99, row->offset.most, row->steps.p50, row->steps.p99,
        row->steps.most, row->never);
    return out;
}

void spawn_print(struct bench *bench, const struct spawn_block *block)
{
    size_t near = 0;
    for (size_t i = 0; i < ARRAY_COUNT(block->row); i++)
        near = block->row[i].near > near ? block->row[i].near : near;
    putchar('\n');
    screen_text(
        &bench->screen_is,
        "%s, scale %g, far %g: %s; %zu %s %s, seed %llu, %s; a surface nearer than they are moved: "
        "up to %zu (%zu undecided)\n",
        block->scene, block->scale, block->far, COUNTED(block->tri_count, "triangle"),
        block->ray_count, block->rays, block->ray_count == 1 ? "ray" : "rays",
        (unsigned long long)bench->seed, COUNTED(block->hit_count, "hit"), near, block->undecided);
    if (bench->screen_is.wide)
        print_wide(block);
    else
        print_table(block, &bench->screen_is);
    for (size_t i = 0; i < ARRAY_COUNT(block->row); i++) {
        const struct spawn_row *row = &block->row[i];
        print_least(row);
        bench_row(bench, &bench_spawn, row_json(bench, block, row, "exact", &row->exact));
        for (size_t k = 0; k < block->judge_count; k++)
            bench_row(bench, &bench_spawn,
                      row_json(bench, block, row, block->judge[k], &row->engine[k]));
    }
}
