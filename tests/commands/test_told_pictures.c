/* Numbers that raydiff render tells of pictures: no two are the same, and each is looked for beside
 * its own name. */
#define _GNU_SOURCE /* open_memstream */
#include "cmd/render/cmd_render_out.h"
#include "cmd/render/cmd_render_show.h"
#include "ref/base/float_word.h"

#include "tests/commands/told.h"

#define WIDTH 3
#define SIZE  9

static char scene_name[] = "s";

/* Three pixels have more in the second layer, two have less, three as much; the last has no value
 * in either. */
static double first[SIZE] = {11, 12, 13, 14, 15, 16, 17, 18, NAN};
static double second[SIZE] = {12, 13, 14, 13.5, 14.25, 16, 17, 18, NAN};
static double apart[SIZE] = {1, 1, 1, -0.5, -0.75, 0, 0, 0, NAN};

static struct show_layer layer_made(const char *name, double *value, double at)
{
    struct show_layer layer = {
        .name = name,
        .value = value,
        .counts = {.boxes = (uint64_t)at + 1, .tris = (uint64_t)at + 2},
        .sum = {.pixels = (size_t)at + 3,
                .sum = at + 4.5,
                .least = at + 5.5,
                .most = at + 6.5,
                .mean = at + 7.5,
                .most_at = 5},
        .quantiles = {
            .count = (size_t)at + 8, .p50 = at + 9.5, .p99 = at + 10.5, .most = at + 11.5}};
    for (size_t v = 0; v < VERDICT_COUNT; v++)
        layer.verdict[v] = (size_t)at + 20 + v;
    return layer;
}

static struct render_settings settings_made(void)
{
    return (struct render_settings){.scene = scene_name,
                                    .width = WIDTH,
                                    .height = 2,
                                    .box = box_tests[0],
                                    .tri = tri_tests[0],
                                    .builder = builders_all[0],
                                    .out = "o"};
}

static struct showing showing_made(const struct render_settings *settings)
{
    return (struct showing){
        .show = show_find("boxes"),
        .settings = settings,
        .engine = engine_find("cpu"),
        .csv = told_file(),
        .pixels = SIZE,
        .layer = {layer_made("a", first, 100), layer_made("b", second, 200)},
        .layer_count = 2,
        .difference = layer_made("", apart, 300),
        .alone = 17,
        .judged = true,
    };
}

#define VALUES(path, at)                                                                           \
    {path ".pixels", (at) + 3}, {path ".sum", (at) + 4.5}, {path ".least", (at) + 5.5},            \
        {path ".mean", (at) + 7.5}, {path ".median", (at) + 9.5}, {path ".p99", (at) + 10.5},      \
    {                                                                                              \
        path ".most", (at) + 6.5                                                                   \
    }

static const struct told_number show_numbers[] = {
    {"width", WIDTH},
    {"height", 2},
    {"layers.0.counted.boxes", 101},
    {"layers.0.counted.triangles", 102},
    VALUES("layers.0.values", 100),
    {"layers.1.counted.boxes", 201},
    {"layers.1.counted.triangles", 202},
    VALUES("layers.1.values", 200),
    {"difference.only_one", 17},
    {"difference.more", 3},
    {"difference.less", 2},
    VALUES("difference.values", 300),
};

static void what_two_layers_show(void **state)
{
    (void)state;
    const struct render_settings settings = settings_made();
    const struct showing showing = showing_made(&settings);
    const struct image image = {.width = 33, .height = 34};
    struct reason reason;
    const char *const lines[] = {
        "boxes sum least mean median 99 % most\n",
        "a 104 106 107.5 110 110 106 at 2,1; 103 of 9 pixels",
        "b 204 206 207.5 210 210 206 at 2,1; 203 of 9 pixels",
        "b - a 304 306 307.5 310 310 306 at 2,1; 303 of 9 pixels",
        "b: more in 3 pixels, less in 2",
        "only one of them has a value in 17 pixels",
        "a: engine cpu counted 101 boxes, 102 triangles for these rays",
        "b: engine cpu counted 201 boxes, 202 triangles for these rays",
        "o: 33 x 34",
    };
    told_begin(&stdout);
    showing_print(&showing, &image);
    told_text(told_end(), lines, ARRAY_COUNT(lines));
    assert_int_equal(showing_json(&showing, told_file(), &reason), STATUS_OK);
    told_json(told_file_json(), show_numbers, ARRAY_COUNT(show_numbers));
}

/* Each pixel's line: its place, both values, their difference. */
static void the_csv_of_two_layers(void **state)
{
    (void)state;
    const struct render_settings settings = settings_made();
    const struct showing showing = showing_made(&settings);
    struct reason reason;
    char line[200];
    assert_int_equal(showing_csv(&showing, &reason), STATUS_OK);
    FILE *file = fopen(told_file(), "r");
    assert_true(file && fgets(line, sizeof line, file));
    assert_string_equal(line, "x,y,a,b,difference\n");
    for (size_t i = 0; i < SIZE; i++) {
        unsigned x, y;
        double a, b, difference;
        assert_non_null(fgets(line, sizeof line, file));
        if (isnan(first[i])) {
            assert_string_equal(line, "2,2,,,\n");
            continue;
        }
        assert_int_equal(sscanf(line, "%u,%u,%lf,%lf,%lf", &x, &y, &a, &b, &difference), 5);
        assert_true(x == i % WIDTH && y == i / WIDTH);
        assert_true(a == round(first[i]) && fabs(b - second[i]) <= 0.5 && difference == apart[i]);
    }
    assert_null(fgets(line, sizeof line, file));
    fclose(file);
    unlink(told_file());
}

static void verdicts_that_layers_show(void **state)
{
    (void)state;
    const struct render_settings settings = settings_made();
    struct showing showing = showing_made(&settings);
    const struct image image = {.width = 33, .height = 34};
    struct told_number numbers[5 + 2 * VERDICT_COUNT] = {
        {"width", WIDTH}, {"height", 2}, {"difference.only_one", 17}, {"difference.different", 3}};
    char path[2 * VERDICT_COUNT][60], line[VERDICT_COUNT][60];
    const char *lines[VERDICT_COUNT + 5];
    size_t count = 4;
    struct reason reason;
    showing.show = show_find("class");
    for (size_t i = 0; i < SIZE; i++)
        first[i] = second[i] = VERDICT_RIGHT;
    for (size_t v = 0; v < VERDICT_COUNT; v++) {
        snprintf(line[v], sizeof line[v], "%s %zu %zu\n", verdict_name((enum verdict)v), 120 + v,
                 220 + v);
        lines[v] = line[v];
        for (size_t l = 0; l < 2; l++, count++) {
            snprintf(path[2 * v + l], sizeof path[0], "layers.%zu.verdicts.%s", l,
                     verdict_name((enum verdict)v));
            numbers[count] =
                (struct told_number){path[2 * v + l], (double)(100 * (l + 1) + 20 + v)};
        }
    }
    lines[VERDICT_COUNT] = "verdict a b\n";
    lines[VERDICT_COUNT + 1] = "b and a: different in 3 of 9 pixels";
    lines[VERDICT_COUNT + 2] = "pixels 0,0, 1,0, 2,0, 0,1, 1,1, ...";
    lines[VERDICT_COUNT + 3] = "o: 33 x 34";
    told_begin(&stdout);
    showing_print(&showing, &image);
    told_text(told_end(), lines, VERDICT_COUNT + 4);
    assert_int_equal(showing_json(&showing, told_file(), &reason), STATUS_OK);
    told_json(told_file_json(), numbers, count);
}

/* --- pictures --------------------------------------------------------------------------------- */

static const struct told_number picture_numbers[] = {
    {"triangles", 41},
    {"width", 42},
    {"height", 43},
    {"workgroup_size", 44},
    {"bounces", 45},
    {"ambience", 46.5},
    {"camera_light_strength", 47.5},
    {"lights", 48},
    {"materials", 49},
    {"frames.0.angle", 51.5},
    {"frames.0.pos.0", 52},
    {"frames.0.pos.1", 53},
    {"frames.0.pos.2", 54},
    {"frames.0.forward.0", 55},
    {"frames.0.forward.1", 56},
    {"frames.0.forward.2", 57},
    {"frames.0.trace_ns", 58},
    {"frames.0.wall_ns", 59},
    {"frames.0.box_tests", 60},
    {"frames.0.triangle_tests", 61},
    {"frames.0.memory_bytes", 62},
    {"frames.0.rays.closest", 63},
    {"frames.0.rays.shadow", 64},
    {"frames.0.rays.hit_pixels", 65},
};

static void the_json_of_a_picture(void **state)
{
    (void)state;
    static struct render_stage stage;
    const struct render_settings empty = settings_made();
    struct render_settings settings = empty;
    const struct render_handler handler = {.name = "h"};
    struct reason reason;
    settings.handler = &handler;
    settings.engine = engine_find("cpu");
    stage = (struct render_stage){
        .name = "s",
        .tri_count = 41,
        .job = {.job = {.box = box_tests[0], .tri = tri_tests[0]},
                .look = {.bounces = 45, .ambience = 46.5f, .camera_light = 47.5f},
                .width = 42,
                .height = 43,
                .material_count = 49,
                .light_count = 48,
                .tile = 44}};
    const struct frame_record record = {
        .path = "p",
        .angle = 51.5,
        .view = {.pos = {52, 53, 54}, .forward = {55, 56, 57}},
        .report = {.ns = 58, .boxes = 60, .tris = 61, .memory_bytes = 62},
        .wall_ns = 59,
        .counted = true,
        .rays = {.closest = 63, .shadow = 64, .hit_pixels = 65}};
    assert_int_equal(render_json(told_file(), &settings, &stage, &record, 1, &reason), STATUS_OK);
    told_json(told_file_json(), picture_numbers, ARRAY_COUNT(picture_numbers));
}

/* A ray is one, that hits or not; shadow rays are those of hits, one for each light; pixels count
 * by their first segment. */
static void rays_of_a_picture(void **state)
{
    (void)state;
    const struct segment segment[] = {
        {.prim = 3, .asked = 7},           {.prim = 4, .asked = 1}, {.prim = 5, .asked = 9},
        {.prim = ABI_NO_PRIM, .asked = 3}, {.prim = ABI_NO_PRIM},   {.prim = ABI_NO_SEGMENT},
    };
    const struct frame_rays rays = frame_count(segment, 3, 2);
    assert_int_equal(rays.closest, 5);
    assert_int_equal(rays.shadow, 3 + 1 + 2);
    assert_int_equal(rays.hit_pixels, 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_two_layers_show),      cmocka_unit_test(the_csv_of_two_layers),
        cmocka_unit_test(verdicts_that_layers_show), cmocka_unit_test(the_json_of_a_picture),
        cmocka_unit_test(rays_of_a_picture),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
