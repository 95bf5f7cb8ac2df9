/* Numbers that raydiff bench matrix tells: no two are the same, and each is
 * looked for beside its own name. */
#define _GNU_SOURCE /* open_memstream */
#include "cmd/bench/cmd_bench_matrix.h"
#include "ref/store.h"

#include "tests/commands/told_bench.h"

static struct matrix_row matrix_row_made(const struct matrix_entry *entry)
{
    struct matrix_row row = {
        .entry = entry,
        .threads = 11,
        .rays = 12,
        .mean = 13,
        .mean_warm = 14,
        .node_bytes = 1500,
        .item_bytes = 1610,
        .scene_bytes = 1720,
        .held_bytes = 1830,
        .asked = 21,
        .lost = 22,
        .wrong = 23,
        .leak_rays = 24,
        .leaks = 25,
        .judged = true,
        .verdicts = {.compared = 26, .allowed = 27, .wrong = 28},
        .timed = {.compared = 29, .allowed = 30, .wrong = 31},
        .touched = true,
    };
    for (size_t k = 0; k < MATRIX_KINDS; k++) {
        const double at = 100.0 * (double)(k + 1);
        row.mrays[k] = (struct spread){at + 2, at + 1, at + 3};
        row.ratio[k] = (struct spread){at + 5, at + 4, at + 6};
        row.warm[k] = (struct spread){at + 8, at + 7, at + 9};
    }
    for (size_t k = 0; k < MATRIX_CLOSEST; k++) {
        const double at = 100.0 * (double)(k + 1);
        row.touch[k] = (struct matrix_touch){at + 11, {at + 12, at + 13}};
    }
    return row;
}

#define KIND(name, at)                                                                             \
    {"0." name "_mrays", (at) + 2}, {"0." name "_ratio", (at) + 5},                                \
        {"0." name "_ratio_min", (at) + 4}, {"0." name "_ratio_max", (at) + 6},                    \
        {"0." name "_warm", (at) + 8}, {"0." name "_warm_min", (at) + 7},                          \
    {                                                                                              \
        "0." name "_warm_max", (at) + 9                                                            \
    }
#define LINES(name, at)                                                                            \
    {"0." name "_line_bytes", (at) + 11}, {"0." name "_beyond_l1", (at) + 12},                     \
    {                                                                                              \
        "0." name "_beyond_l2", (at) + 13                                                          \
    }

static const struct told_number matrix_numbers[] = {
    {"0.triangles", 100},
    {"0.threads", 11},
    {"0.reinsert", 33},
    {"0.rays", 12},
    {"0.rounds", 3},
    KIND("prim", 100),
    KIND("rand", 200),
    KIND("diff", 300),
    KIND("o-shad", 400),
    KIND("o-rand", 500),
    {"0.mean_ratio", 13},
    {"0.mean_warm", 14},
    {"0.node_bytes", 1500},
    {"0.item_bytes", 1610},
    {"0.scene_bytes", 1720},
    {"0.held_bytes", 1830},
    {"0.bytes_per_triangle", 48.3},
    LINES("prim", 100),
    LINES("rand", 200),
    LINES("diff", 300),
    {"0.asked", 21},
    {"0.lost", 22},
    {"0.wrong", 23},
    {"0.leak_rays", 24},
    {"0.leaks", 25},
    {"0.judged", 1},
    {"0.compared", 26},
    {"0.allowed", 27},
    {"0.judged_wrong", 28},
    {"0.front", 1},
};

static const char matrix_head[] = "s: 100 triangles, 34 rays of each kind, 3 rounds interleaved, "
                                  "11 threads";

static void the_rows_and_tables_of_the_matrix(void **state)
{
    (void)state;
    static struct matrix matrix;
    const struct scene scene = {.tri_count = 100};
    const struct matrix_entry entry = {.name = "e",
                                       .engine = engine_find("cpu"),
                                       .layout = layout_find("f32"),
                                       .store = tri_stores[0],
                                       .builder = builders_all[0],
                                       .passes = 33};
    struct matrix_row row = matrix_row_made(&entry);
    const char *const table[] = {
        matrix_head, "lost of 21 rays, leaks of 24;",
        "contestant WRONG allowed lost leaks B/tri prim rand diff o-shad o-rand mean warm Mray/s",
        "e 28 27 22 25 48.3 105.00 205.00 305.00 405.00 505.00 13.00 14.00 102.000"};
    const char *const wide[] = {
        matrix_head,
        "speed, least-most prim rand diff o-shad o-rand mean warm prim Mr/s",
        "e 105.00 (104.00-106.00) 205.00 (204.00-206.00) 305.00 (304.00-306.00) 405.00 "
        "(404.00-406.00) 505.00 (504.00-506.00) 13.00 14.00 102.000",
        "bytes per triangle nodes items scene all lines prim L1 L2 rand diff lost wrong leaks "
        "allowed WRONG",
        "e 15.0 16.1 17.2 48.3 111 112 113 211 212 213 311 312 313 22 of 21 23 of 21 25 of 24 27 "
        "28",
    };
    for (int is_wide = 0; is_wide < 2; is_wide++) {
        struct bench bench = bench_made(is_wide);
        matrix.bench = &bench;
        matrix.spec = "s";
        matrix.scene = &scene;
        matrix.count = 34;
        matrix.row = &row;
        matrix.row_count = 1;
        told_begin(&stdout);
        matrix_print(&matrix, true);
        if (is_wide)
            told_text(told_end(), wide, ARRAY_COUNT(wide));
        else
            told_text(told_end(), table, ARRAY_COUNT(table));
        told_json(bench.rows, matrix_numbers, ARRAY_COUNT(matrix_numbers));
    }
}

/* The CSV has the names and numbers of the JSON, in its order. */
static void the_csv_of_a_row(void **state)
{
    (void)state;
    struct bench bench = {.quick = false};
    char *text = NULL;
    size_t size;
    bench.csv.stream = open_memstream(&text, &size);
    assert_non_null(bench.csv.stream);
    for (int i = 0; i < 2; i++)
        bench_row(
            &bench, &bench_matrix,
            json_pack("{s:i, s:s, s:f, s:n, s:b}", "a", 3 + i, "b", "x,y", "c", 0.5, "d", "e", 1));
    fclose(bench.csv.stream);
    assert_string_equal(text, "benchmark,a,b,c,d,e\nmatrix,3,\"x,y\",0.5,,true\n"
                              "matrix,4,\"x,y\",0.5,,true\n");
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_rows_and_tables_of_the_matrix),
        cmocka_unit_test(the_csv_of_a_row),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
