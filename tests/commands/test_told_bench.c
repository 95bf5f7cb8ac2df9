/* Numbers that raydiff bench error and spawn tell: no two are the same, and each is
 * looked for beside its own name. */
#define _GNU_SOURCE /* open_memstream */
#include "cmd/bench/cmd_bench_error.h"
#include "cmd/bench/cmd_bench_spawn.h"

#include "tests/commands/told_bench.h"

/* --- bench error ------------------------------------------------------------------------------ */

static struct error_row error_row_made(void)
{
    struct error_row row = {
        .engine = engine_find("cpu"),
        .layout = layout_find("f32"),
        .tri = tri_tests[0],
        .box = box_tests[0],
        .mrays = {.median = 11, .least = 10, .most = 12},
        .ratio = {.median = 14, .least = 13, .most = 15},
        .base = "b",
        .sum = {.rays = 2000,
                .hits = 17,
                .forward = {.count = 1, .p50 = 101, .p99 = 102, .most = 103},
                .plane = {.count = 2, .p50 = 104, .p99 = 105, .most = 106},
                .point = {.count = 3, .p50 = 107, .p99 = 108, .most = 109}},
        .leak = {[LEAK_EDGE] = 21, [LEAK_VERTEX] = 22},
        .judged = true,
        .verdicts =
            {.compared = 23, .allowed = 24, .wrong = 25, .over = 26.5, .displacement = 27.5},
        .boxes = 31.5,
        .tris = 32.5,
        .boxes_to_f32 = 33.5,
        .tris_to_f32 = 34.5,
        .node_bytes = 3500,
        .item_bytes = 3610,
        .memory_bytes = 37,
    };
    for (size_t k = 0; k < ERROR_KINDS; k++)
        row.sum.kind[k] = 41 + k;
    return row;
}

static const struct told_number error_numbers[] = {
    {"0.triangles", 100},
    {"0.seed", 5},
    {"0.count", 51},
    {"0.rounds", 3},
    {"0.mrays_median", 11},
    {"0.mrays_min", 10},
    {"0.mrays_max", 12},
    {"0.ratio_median", 14},
    {"0.ratio_min", 13},
    {"0.ratio_max", 15},
    {"0.exact_hits", 52},
    {"0.compared", 2000},
    {"0.hits", 17},
    {"0.lost", 41 + ERROR_LOST},
    {"0.phantom", 41 + ERROR_PHANTOM},
    {"0.wrong_id", 41 + ERROR_WRONG},
    {"0.in_plane", 41 + ERROR_FREE},
    {"0.edge_rays", 1000},
    {"0.edge_leaks", 21},
    {"0.vertex_rays", 4000},
    {"0.vertex_leaks", 22},
    {"0.judged", 1},
    {"0.named", 24},
    {"0.wrong", 25},
    {"0.err_over_bound", 26.5},
    {"0.displacement", 27.5},
    {"0.forward_p50", 101},
    {"0.forward_p99", 102},
    {"0.forward_max", 103},
    {"0.plane_p50", 104},
    {"0.plane_p99", 105},
    {"0.plane_max", 106},
    {"0.point_p50", 107},
    {"0.point_p99", 108},
    {"0.point_max", 109},
    {"0.boxes_per_ray", 31.5},
    {"0.tris_per_ray", 32.5},
    {"0.boxes_to_f32", 33.5},
    {"0.tris_to_f32", 34.5},
    {"0.bytes_per_node", 32},
    {"0.node_bytes", 3500},
    {"0.item_bytes", 3610},
    {"0.memory_bytes", 37},
};

static const char error_head[] = "s: 100 triangles; 51 r rays, seed 5, of which exactly 52 hit; "
                                 "builder median, leaf 4; 3 rounds interleaved";
static const char error_closed[] = "closed: 1000 rays from inside aimed at edges, 4000 at vertices";

static void the_rows_and_tables_of_errors(void **state)
{
    (void)state;
    static struct error_page page;
    page = (struct error_page){.scene = "s",
                               .rays = "r",
                               .tri_count = 100,
                               .ray_count = 51,
                               .exact_hits = 52,
                               .leak_rays = {[LEAK_EDGE] = 1000, [LEAK_VERTEX] = 4000},
                               .row = {error_row_made()},
                               .row_count = 1};
    assert_int_equal(page.row[0].layout->node_bytes, 32);
    /* Rates of 42, 43 and 44 of 2000, of 21 of 1000, and of 22 of 4000. */
    const char *const table[] = {
        error_head, error_closed,
        "WRONG allowed lost phantom wrong-id edge vertex Mray/s ratio of err/E",
        " 25 24 21000 21500 22000 21000 5500 11.000 14.00 b 26.500"};
    const char *const wide[] = {
        error_head,
        error_closed,
        "Mray/s (least-most) ratio (least-most) lost phantom wrong id edge vertex named WRONG "
        "err/E",
        " 11.000 (10.000-12.000) 14.00 (13.00-15.00) of b 21000 21500 22000 21000 5500 "
        "24 25 26.500",
        "in u x size: forward plane point boxes tris bytes bytes\n",
        "p50 p99 max p50 p99 max p50 p99 max /f32 /f32 /node /tri\n",
        " 101 102 103 104 105 106 107 108 109 33.500 34.500 32 71.1",
    };
    for (int is_wide = 0; is_wide < 2; is_wide++) {
        struct bench bench = bench_made(is_wide);
        told_begin(&stdout);
        error_print(&bench, &page);
        if (is_wide)
            told_text(told_end(), wide, ARRAY_COUNT(wide));
        else
            told_text(told_end(), table, ARRAY_COUNT(table));
        told_json(bench.rows, error_numbers, ARRAY_COUNT(error_numbers));
    }
}

/* --- bench spawn ------------------------------------------------------------------------------ */

#define SPAWNED ((size_t)SPAWN_POINTS * SPAWN_RULES)

/* Rates per million of 1000 hits are these, and three zeros. */
static struct spawn_block *spawn_made(void)
{
    static struct spawn_block block;
    block = (struct spawn_block){.scene = "s",
                                 .rays = "r",
                                 .scale = 2,
                                 .far = 3,
                                 .tri_count = 7,
                                 .ray_count = 11,
                                 .hit_count = 1000,
                                 .undecided = 13,
                                 .judge = {"j"},
                                 .judge_count = 1};
    for (size_t i = 0; i < SPAWNED; i++) {
        const double at = 20.0 * (double)(i + 1);
        block.row[i] = (struct spawn_row){.point = (enum spawn_point)(i / SPAWN_RULES),
                                          .rule = (enum spawn_rule)(i % SPAWN_RULES),
                                          .near = 500 + i,
                                          .offset = {.p50 = at, .p99 = at + 1, .most = at + 20},
                                          .steps = {.p50 = at + 3, .p99 = at + 4, .most = at + 5},
                                          .never = 600 + i,
                                          .exact = {700 + i, 720 + i, 740 + i},
                                          .engine = {{800 + i, 820 + i, 840 + i}}};
    }
    return &block;
}

static void must_be_spawned(json_t *rows)
{
    assert_int_equal(json_array_size(rows), 2 * SPAWNED);
    for (size_t i = 0; i < 2 * SPAWNED; i++) {
        const double row = (double)(i / 2), at = 20 * (row + 1), count = i % 2 ? 800 : 700;
        const struct told_number numbers[] = {
            {"scale", 2},
            {"far", 3},
            {"triangles", 7},
            {"seed", 5},
            {"hits", 1000},
            {"undecided", 13},
            {"near", 500 + row},
            {"self", count + row},
            {"beside", count + 20 + row},
            {"skipped", count + 40 + row},
            {"moved_p50", at},
            {"moved_p99", at + 1},
            {"moved_max", at + 20},
            {"steps_p50", at + 3},
            {"steps_p99", at + 4},
            {"steps_max", at + 5},
            {"never", 600 + row},
        };
        told_json(json_incref(json_array_get(rows, i)), numbers, ARRAY_COUNT(numbers));
    }
    json_decref(rows);
}

static void the_rows_and_tables_of_spawned_rays(void **state)
{
    (void)state;
    const struct spawn_block *block = spawn_made();
    for (int wide = 0; wide < 2; wide++) {
        struct bench bench = bench_made(wide);
        char line[5 * SPAWNED][200];
        const char *expected[5 * SPAWNED + 3];
        size_t count = 0;
        expected[count++] = "s, scale 2, far 3: 7 triangles; 11 r rays, seed 5, 1000 hits; a "
                            "surface nearer than they are moved: up to 513 (13 undecided)";
        expected[count++] = wide ? "point rule p50 max self beside skip self beside skip"
                                 : "judge moved-p50 moved-max self beside skip";
        for (size_t i = 0; i < SPAWNED; i++) {
            const struct spawn_row *row = &block->row[i];
            char moved[40], rule[40];
            snprintf(moved, sizeof moved, "%.2g %.2g", row->offset.p50, row->offset.most);
            snprintf(rule, sizeof rule, "%s %s", spawn_point_name(row->point),
                     spawn_rule_name(row->rule));
            if (wide)
                snprintf(line[count], sizeof line[0],
                         "%s %s %zu000 %zu000 %zu000 %zu000 %zu000 %zu000", rule, moved, 700 + i,
                         720 + i, 740 + i, 800 + i, 820 + i, 840 + i);
            for (size_t k = 0; k < 2 && !wide; k++) {
                const size_t of = k ? 800 + i : 700 + i;
                snprintf(line[count], sizeof line[0], "%s %s %s %zu000 %zu000 %zu000", rule,
                         k ? "j" : "exact", moved, of, of + 20, of + 40);
                expected[count] = line[count];
                count += k == 0;
            }
            expected[count] = line[count];
            count++;
            snprintf(line[count], sizeof line[0], "but %zu, which no step frees", 600 + i);
            expected[count] = line[count];
            count++;
            if (row->rule == RULE_LEAST) {
                snprintf(line[count], sizeof line[0],
                         "%s: %.0f steps suffice for 50 %% of the rays, %.0f for 99 %%, %.0f for "
                         "all",
                         spawn_point_name(row->point), row->steps.p50, row->steps.p99,
                         row->steps.most);
                expected[count] = line[count];
                count++;
            }
        }
        told_begin(&stdout);
        spawn_print(&bench, block);
        told_text(told_end(), expected, count);
        must_be_spawned(bench.rows);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_rows_and_tables_of_errors),
        cmocka_unit_test(the_rows_and_tables_of_spawned_rays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
