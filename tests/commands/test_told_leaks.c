/* Numbers that raydiff leaks tells: no two are the same, and each is looked for beside its own
 * name. */
#define _GNU_SOURCE /* open_memstream */
#include "cmd/leaks/cmd_leaks.h"
#include "ref/store.h"

#include "tests/commands/told.h"

/* Counters of aim a are 1000 a + 10 .. 18, so that sums are of all aims. */
static struct leak_tally tally_of(size_t a)
{
    const size_t at = 1000 * a;
    return (struct leak_tally){.rays = 1000000 * (a + 1),
                               .misses = at + 11,
                               .empty = at + 12,
                               .doubles = at + 13,
                               .even = at + 14,
                               .lost = at + 15,
                               .phantoms = at + 16,
                               .repeated = at + 17};
}

static struct leak_row row_made(void)
{
    struct leak_row row = {.engine = engine_find("cpu"),
                           .layout = layout_find("f32"),
                           .store = tri_stores[0],
                           .builder = builders_all[0],
                           .box = box_tests[0],
                           .tri = tri_tests[0],
                           .leaks = {.lists = true, .finding_count = 1, .ns = 71},
                           .compared = true,
                           .bit_differences = 73,
                           .broken = "so"};
    for (size_t a = 0; a < LEAK_AIMS; a++)
        row.leaks.tally[a] = tally_of(a);
    row.leaks.finding[0] = (struct leak_finding){.is_double = true,
                                                 .aim = LEAK_EDGE,
                                                 .ray_index = 79,
                                                 .ray = {.org = {1, 2, 3}, .dir = {4, 5, 6}},
                                                 .prim = {83, 89}};
    return row;
}

static struct leak_scene scene_made(struct leak_row *row)
{
    return (struct leak_scene){.spec = "s",
                               .profile = leak_profiles[0],
                               .tri_count = 101,
                               .point_count = 103,
                               .edge_count = 107,
                               .ray_count = 200,
                               .seed = 109,
                               .instances = 113,
                               .inside = {.origins = 127, .exact = 131},
                               .row = row,
                               .row_count = 1};
}

static json_t *written(const struct leak_scene *scene)
{
    static const struct turnout none;
    struct reason reason;
    assert_int_equal(leaks_write_json(told_file(), scene, 1, &none, 1, &reason), STATUS_OK);
    return told_file_json();
}

#define AIM(name, a)                                                                               \
    {"rows.0.aims." name ".rays", 1e6 * ((a) + 1)},                                                \
        {"rows.0.aims." name ".misses", 1e3 * (a) + 11},                                           \
        {"rows.0.aims." name ".empty", 1e3 * (a) + 12},                                            \
        {"rows.0.aims." name ".double_hits", 1e3 * (a) + 13},                                      \
        {"rows.0.aims." name ".even", 1e3 * (a) + 14},                                             \
        {"rows.0.aims." name ".lost", 1e3 * (a) + 15},                                             \
        {"rows.0.aims." name ".phantoms", 1e3 * (a) + 16},                                         \
    {                                                                                              \
        "rows.0.aims." name ".repeated", 1e3 * (a) + 17                                            \
    }

static const struct told_number numbers[] = {
    {"exit", 1},
    {"scenes.0.triangles", 101},
    {"scenes.0.points", 103},
    {"scenes.0.edges", 107},
    {"scenes.0.rays", 200},
    {"scenes.0.origins", 127},
    {"scenes.0.aimed_exactly", 131},
    {"scenes.0.instances", 1},
    {"scenes.0.seams", 0},
    {"rows.0.promises", 0},
    {"rows.0.total.rays", 10e6},
    {"rows.0.total.misses", 6000 + 4 * 11},
    {"rows.0.total.empty", 6000 + 4 * 12},
    {"rows.0.total.double_hits", 6000 + 4 * 13},
    {"rows.0.total.even", 6000 + 4 * 14},
    {"rows.0.total.lost", 6000 + 4 * 15},
    {"rows.0.total.phantoms", 6000 + 4 * 16},
    {"rows.0.total.repeated", 6000 + 4 * 17},
    AIM("vertex", 0),
    AIM("midpoint", 1),
    AIM("edge", 2),
    AIM("beside", 3),
    {"rows.0.bit_differences", 73},
    {"rows.0.ns", 71},
    {"rows.0.findings.0.ray", 79},
    {"rows.0.findings.0.triangles.0", 83},
    {"rows.0.findings.0.triangles.1", 89},
};

static void the_json_of_leaks(void **state)
{
    (void)state;
    struct leak_row row = row_made();
    struct leak_scene scene = scene_made(&row);
    static const char *const flags[] = {"scenes.0.seams", "rows.0.promises"};
    told_json(written(&scene), numbers, ARRAY_COUNT(numbers));
    row.promises = true;
    told_flag(written(&scene), flags[1], flags, ARRAY_COUNT(flags));
    row.promises = false;
    scene.seams = scene.is_world = true;
    json_t *json = written(&scene);
    assert_true(number_at(json, "scenes.0.instances") == 113);
    told_flag(json, flags[0], flags, ARRAY_COUNT(flags));
}

static char *printed(const struct leak_scene *scene, bool wide)
{
    const struct screen screen = {.width = 4000, .wide = wide};
    told_begin(&stdout);
    leaks_print(scene, &screen);
    return told_end();
}

static const char head[] =
    "s: 101 triangles, 103 points, 107 edges, closed; 200 rays from 127 points inside, seed 109; "
    "65.5 % of them aimed without rounding";
static const char finding[] =
    "ray 79 at edge: org 0x1p+0 0x1p+1 0x1.8p+1 dir 0x1p+2 0x1.4p+2 0x1.8p+2, triangles 83 and 89";

static void the_table_of_leaks(void **state)
{
    (void)state;
    struct leak_row row = row_made();
    const struct leak_scene scene = scene_made(&row);
    const char *const lines[] = {
        head,
        "misses vertex midpoint edge beside doubles lost phantom even repeat bits",
        " 6044 11 1011 2011 3011 6052 6060 6064 6056 6068 73",
        finding,
        "0 of 1 rows promise",
    };
    told_text(printed(&scene, false), lines, ARRAY_COUNT(lines));
}

/* Rates per million, of all rays. */
static void the_wide_table_of_leaks(void **state)
{
    (void)state;
    struct leak_row row = row_made();
    const struct leak_scene scene = scene_made(&row);
    char line[200];
    snprintf(line, sizeof line,
             " %.1f 11 1011 2011 3011 %.1f 13 1013 2013 3013 6056 6060 6064 6068 73 BROKEN",
             6044 / 10.0, 6052 / 10.0);
    const char *const lines[] = {
        head,
        "per 10^6 vertex midpoint edge beside per 10^6 vertex midpoint edge beside even lost "
        "phantom repeat bits word",
        line,
        finding,
        "0 of 1 rows promise",
    };
    told_text(printed(&scene, true), lines, ARRAY_COUNT(lines));
}

/* Of a world other words, and the same numbers. */
static void the_text_of_a_leaking_world(void **state)
{
    (void)state;
    struct leak_row row = row_made();
    struct leak_scene scene = scene_made(&row);
    scene.is_world = row.promises = true;
    row.broken[0] = '\0';
    const char *const lines[] = {
        ("s: 101 placed triangles, 113 instances, each closed, that rays start in; 200 rays from "
         "127 points inside, seed 109"),
        " 6044 11 1011 2011 3011 6052 6060 6064 6056 6068 73",
        "1 of 1 rows promise",
    };
    told_text(printed(&scene, false), lines, ARRAY_COUNT(lines));
}

/* What is only told from a list stands nowhere, in no sum, where the engine makes none. */
static void what_needs_lists_is_not_told_without(void **state)
{
    (void)state;
    for (int lists = 0; lists < 2; lists++) {
        struct leak_row row = row_made();
        const struct leak_scene scene = scene_made(&row);
        const char *name;
        json_t *sum;
        size_t sums = 0;
        row.leaks.lists = lists == 1;
        json_t *root = written(&scene), *told = json_array_get(json_object_get(root, "rows"), 0),
               *of = json_deep_copy(json_object_get(told, "aims"));
        json_object_set(of, "total", json_object_get(told, "total"));
        json_object_foreach(of, name, sum)
        {
            assert_true(json_is_integer(json_object_get(sum, "rays")));
            assert_true(json_is_integer(json_object_get(sum, "misses")));
            assert_int_equal(json_object_size(sum), lists ? 8 : 2);
            sums++;
        }
        assert_int_equal(sums, LEAK_AIMS + 1);
        json_decref(of);
        json_decref(root);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_json_of_leaks),
        cmocka_unit_test(the_table_of_leaks),
        cmocka_unit_test(the_wide_table_of_leaks),
        cmocka_unit_test(the_text_of_a_leaking_world),
        cmocka_unit_test(what_needs_lists_is_not_told_without),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
