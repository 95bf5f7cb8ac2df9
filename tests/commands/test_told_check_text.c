/* The tables of raydiff check: each number under its own title. */
#define _GNU_SOURCE /* open_memstream */
#include "tests/commands/told_check.h"

static char *printed(const struct check_scene *scene, bool wide)
{
    const struct screen screen = {.width = 4000, .wide = wide};
    told_begin(&stdout);
    if (wide)
        check_print_wide(scene);
    else
        check_print_table(scene, &screen);
    check_print_moved(scene, &screen);
    return told_end();
}

static const char wrong[] =
    " missed 302, phantom 303, triangle 304, distance 305, barycentric 306, not_finite 307, "
    "not_repeatable 308, any_disagrees 309, twice 310, order 311, masked 312, culled 313, opacity "
    "314, instance 315, facing 316";
static const char displaced[] =
    "; displacement p50 52 p99 53 max 54 uM, 55 lost in closed fans; allowed are 56 uM, not 32; "
    "lost beside edges ";
static const char fans[] = "; watertight: 58 lost in closed fans";
static const char compiled[] =
    "; 999 of 1082 float operations without NoContraction, 85 of open rounding";
static const char moved[] =
    "; 87 answers with other bits than brute's: both right 91, it alone 92, brute alone 93, "
    "neither 94";
static const char hits_listed[] = "; 61 triangles listed, 62 double hits, parity off in 64 of 63";
static const char costs[] = "vertices moved by up to 503 extents: SAH cost of the tree of median "
                            "101.0 before, 102.0 refitted";
static const char times[] = "f32: refitted in 2.0 ns a triangle; built in 103.0 and packed in "
                            "104.1: 103.5 times as long";

/* Bytes are thousands of bytes in the one, a triangle's in the other; verdicts are those that are
 * allowed, without the WRONG, and their sum. */
static void the_tables_of_rows(void **state)
{
    (void)state;
    const struct engine engine = engine_made();
    static struct row row;
    row = row_made(&engine);
    row.layout = layout_find("f32");
    const struct check_scene scene = scene_made(&row);
    char edges[MATCH_EDGES_TEXT], line[200];
    match_edges_text(row.edges, edges);
    snprintf(line, sizeof line, "%d 87 42 %.1f - 97.000 96.000-98.000",
             202 + 203 + 204 + 205 + 206 + 207 + 208 + 209, (31000 + 32100 + 33200) / 100.0);
    const char *lines[] = {
        "wrong allowed bits hits B/tri err/E Mray/s least-most",
        " 210 ",
        line,
        wrong,
        displaced,
        edges,
        fans,
        compiled,
        moved,
        hits_listed,
        costs,
        times,
    };
    told_text(printed(&scene, false), lines, ARRAY_COUNT(lines));
    lines[1] = "nodes kB items kB hits tie near bound bordr plane slab noise out err/E WRONG bits "
               "Mray/s (least-most)";
    lines[2] = " 31.0 32.1 42 202 203 204 205 206 207 208 209 - 210 73 97.000 (96.000-98.000)";
    told_text(printed(&scene, true), lines + 1, ARRAY_COUNT(lines) - 1);
}

/* The error of t where there is no displacement, and bits that must be equal. */
static void the_tables_of_rows_with_bits(void **state)
{
    (void)state;
    const struct engine engine = engine_made();
    static struct row row;
    row = row_made(&engine);
    row.displacement.count = row.edges_beyond = row.fans_lost = row.moved = 0;
    row.compiled.free = row.compiled.translates = false;
    row.compiled.kept = row.compiled.ops;
    row.compiled.foreign = 0;
    row.bits = true;
    const struct check_scene scene = scene_made(&row);
    const char *const table[] = {" 210 1644 73 42 963.0 45.50 97.000 96.000-98.000", wrong,
                                 hits_listed, costs, times};
    const char *const wide[] = {
        " 31.0 32.1 42 202 203 204 205 206 207 208 209 45.50 210 73 97.000 (96.000-98.000)", wrong,
        hits_listed, costs, times};
    told_text(printed(&scene, false), table, ARRAY_COUNT(table));
    told_text(printed(&scene, true), wide, ARRAY_COUNT(wide));
}

/* Members that a row has, and '-' for those of trees where it walks none; columns of what is the
 * same in all rows are left out. */
static void the_words_of_rows(void **state)
{
    (void)state;
    const struct screen screen = {.width = 4000};
    static struct row row[3];
    const struct engine engine = engine_made();
    for (size_t i = 0; i < 3; i++) {
        row[i] = row_made(&engine);
        row[i].layout = layout_find("f32");
        row[i].options.builder = builder_find("median");
        row[i].options.box = box_tests[0];
        row[i].options.tri = tri_tests[0];
    }
    row[1].layout = NULL;
    row[1].engine = engine_find("brute");
    row[1].options.tri = tri_tests[1];
    row[2].options.builder = builder_find("lbvh");
    row[2].options.box = box_tests[1];
    struct check_scene scene = scene_made(row);
    scene.row_count = 3;
    char lines[3][160];
    snprintf(lines[0], sizeof lines[0], "f32 cpu median %s %s ", box_tests[0]->name,
             tri_tests[0]->name);
    snprintf(lines[1], sizeof lines[1], "- brute - - %s ", tri_tests[1]->name);
    snprintf(lines[2], sizeof lines[2], "f32 cpu lbvh %s %s ", box_tests[1]->name,
             tri_tests[0]->name);
    told_begin(&stdout);
    check_print_table(&scene, &screen);
    char *text = told_end();
    told_squeeze(text);
    for (size_t i = 0; i < 3; i++)
        if (!strstr(text, lines[i]))
            fail_msg("no '%s' in\n%s", lines[i], text);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_tables_of_rows),
        cmocka_unit_test(the_tables_of_rows_with_bits),
        cmocka_unit_test(the_words_of_rows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
