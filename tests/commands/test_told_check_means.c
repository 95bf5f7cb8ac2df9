/* What raydiff check prints of all its rows: ratios, bytes a triangle, sums, each computed anew
 * from rows of which no two numbers are the same. */
#define _GNU_SOURCE /* open_memstream */
#include "tests/commands/told_check.h"

#define ROWS 3

/* f32, rf16 on the same engine, and a library without a layout. */
struct means {
    struct engine library;
    struct row row[ROWS];
    struct check_scene scene;
};

static struct means *means_made(void)
{
    static struct means m;
    const struct engine *cpu = engine_find("cpu");
    const uint64_t bytes[ROWS][3] = {{4000, 500, 600}, {1000, 250, 700}, {0}};
    const double mrays[ROWS][3] = {{20, 19, 21}, {50, 49, 51}, {40, 39, 41}};
    m.library = *cpu;
    m.library.name = "lib";
    m.library.library = true;
    m.library.reference = false;
    for (size_t i = 0; i < ROWS; i++) {
        struct row *row = &m.row[i];
        *row = (struct row){.options = {.builder = builders_all[0],
                                        .build = {.leaf = 21},
                                        .store = tri_stores[i == 1],
                                        .box = box_tests[0],
                                        .tri = tri_tests[0]},
                            .stats = {23, 24, 25, 26, 0},
                            .engine = i == 2 ? &m.library : cpu,
                            .layout = i == 0   ? layout_find("f32")
                                      : i == 1 ? layout_find("rf16")
                                               : NULL,
                            .node_bytes = bytes[i][0],
                            .item_bytes = bytes[i][1],
                            .scene_bytes = bytes[i][2],
                            .rays = 1000 * (i + 1),
                            .compared = 31,
                            .brute = 32,
                            .against = cpu,
                            .bit_differences = 33 + i,
                            .bits = i == 2,
                            .judged = i != 1,
                            .mrays = {mrays[i][0], mrays[i][1], mrays[i][2]}};
        for (size_t v = 0; v < VERDICT_COUNT; v++)
            row->count[v] = 100 * (i + 1) + v;
        for (size_t w = 0; w < WRONG_COUNT; w++)
            row->wrong[w] = 200 * (i + 1) + w;
    }
    m.scene = (struct check_scene){.spec = "s",
                                   .tri_count = 100,
                                   .vertex_count = 41,
                                   .rays = "r",
                                   .ray_count = 42,
                                   .seed = 43,
                                   .row = m.row,
                                   .row_count = ROWS};
    return &m;
}

/* All that check_print prints but for the table. */
static void what_rows_mean(void **state)
{
    (void)state;
    struct means *m = means_made();
    const struct screen screen = {.width = 4000, .wide = true};
    char stored[2][200], verdicts[2][600];
    snprintf(stored[0], sizeof stored[0],
             "f32: %.2f bytes a triangle: 40.00 nodes, 5.00 storage, 6.00 the scene's arrays\n",
             51.0);
    snprintf(stored[1], sizeof stored[1],
             ": %.2f bytes a triangle: 10.00 nodes, 2.50 storage, 7.00 the scene's arrays\n", 19.5);
    /* Of the judged rows, the first and the last. */
    int at = snprintf(verdicts[0], sizeof verdicts[0], "%d of %d answers WRONG (", 109 + 309,
                      1000 + 3000);
    for (int w = WRONG_MISSED; w < WRONG_COUNT; w++)
        at += snprintf(verdicts[0] + at, sizeof verdicts[0] - (size_t)at, "%s%s %d",
                       w > WRONG_MISSED ? ", " : "", wrong_name((enum wrong)w), 800 + 2 * w);
    at = snprintf(verdicts[1], sizeof verdicts[1], "right %d; allowed:", 400);
    for (int v = VERDICT_RIGHT + 1; v < VERDICT_WRONG; v++)
        at += snprintf(verdicts[1] + at, sizeof verdicts[1] - (size_t)at, "%s%s %d",
                       v > VERDICT_RIGHT + 1 ? ", " : " ", verdict_name((enum verdict)v),
                       400 + 2 * v);
    const char *const lines[] = {
        "s: 100 triangles, 41 vertices; 42 rays, set r, seed 43\n",
        "leaf 21: 23 nodes, 24 leaves, depth 25, largest leaf 26\n",
        "32 of 31 rays by brute force too\n",
        " on cpu: 0.25 of f32's node bytes (0.28 with f32's item array), 2.50 times its speed\n",
        "cpu on f32: 0.50 times the speed of lib\n",
        stored[0],
        stored[1],
        "bit for bit against cpu: 35 of 3000 answers differ\n",
        verdicts[0],
        verdicts[1],
        "members as published are wrong in 209 answers",
    };
    told_begin(&stdout);
    check_print(&m->scene, &screen);
    char *text = told_end(), *table = strstr(text, "layout  "),
         *end = strstr(text, "what it means");
    assert_true(table && end > table);
    memset(table, ' ', (size_t)(end - table));
    told_text(text, lines, ARRAY_COUNT(lines));
}

/* Counts of a million of those that were judged. */
static void what_a_decoded_scene_means(void **state)
{
    (void)state;
    static const struct lossy lossy = {.told = "bits"};
    struct means *m = means_made();
    const struct screen screen = {.width = 4000, .wide = true};
    m->scene.row_count = 1;
    m->scene.lossy = &lossy;
    m->scene.flat = 44;
    m->scene.quantised.grid.bits = 12;
    m->scene.quantised.distance = 0.5;
    m->row[0].original.judged = 2000;
    m->row[0].original.beyond = 45;
    m->row[0].original.lost = 46;
    m->row[0].original.phantom = 47;
    m->row[0].original.other = 48;
    m->row[0].original.most = 49;
    m->row[0].original.most_decoded = 50;
    told_begin(&stdout);
    check_print(&m->scene, &screen);
    char *text = told_end();
    assert_non_null(strstr(text, "decoded from 12 bits: vertices moved by 0.5"));
    assert_non_null(strstr(text, "certified; 44 triangles without area"));
    assert_non_null(strstr(text, "WRONG decoded 109, beyond what moved 45; for the original, of a "
                                 "million 23000.0 lost, 23500.0 phantom, 24000.0 other triangle; "
                                 "displacement needed 49 (decoded: 50)"));
    free(text);
}

/* Of modes all rows beside an engine are summed. */
static void what_rows_of_modes_mean(void **state)
{
    (void)state;
    struct means *m = means_made();
    const struct screen screen = {.width = 4000, .wide = true};
    struct engine mode = *engine_find("cpu");
    mode.plain = engine_find("cpu");
    for (size_t i = 0; i < ROWS; i++) {
        const size_t at = i + 1;
        m->row[i].engine = &mode;
        m->row[i].moved = 10 * at;
        m->row[i].beside.both = 100 * at;
        m->row[i].beside.own = 200 * at;
        m->row[i].beside.plain = 300 * at;
        m->row[i].beside.neither = 400 * at;
    }
    const char *const lines[] = {"60 of 6000 answers differ; right are both in 600, the mode alone "
                                 "in 1200, cpu alone in 1800, neither in 2400\n"};
    told_begin(&stdout);
    check_print_modes(&m->scene, &screen);
    told_text(told_end(), lines, ARRAY_COUNT(lines));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_rows_mean),
        cmocka_unit_test(what_a_decoded_scene_means),
        cmocka_unit_test(what_rows_of_modes_mean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
