/* Numbers that raydiff diff tells of two engines' pictures: no two are the same, and each is looked
 * for beside its own name. */
#define _GNU_SOURCE /* open_memstream */
#include "cmd/diff/cmd_diff.h"

#include "tests/commands/told.h"

#define WIDTH 100

static struct diff_run run;
static char scene_name[] = "s";

/* A pixel whose light is wrong, and one on the border of two values. */
static void fill_pair(struct pair *pair)
{
    *pair = (struct pair){
        .diff = {.paths = 11,
                 .segments = 12,
                 .hits = 13,
                 .paths_apart = 14,
                 .field = {15, 16, 17, 18, 19},
                 .first = {20, 21, 22, 23, 24},
                 .colours = 25,
                 .allowed = 26,
                 .excess = 27,
                 .largest = 28},
        .bounded = true,
        .asked = 29,
        .over = 30.5,
        .border = {{.pixel = 31 * WIDTH + 32, .value = {0x030201, 0x060504}, .bound = 0.25f}},
        .border_count = 1};
    pair->why[WHY_WRONG] = 1;
    pair->why[WHY_SAME] = 0;
    for (size_t v = 0; v < VERDICT_COUNT; v++)
        pair->verdict[v] = 40 + v;
    pair->example[WHY_WRONG][0] = (struct pixel_why){
        .pixel = 51 * WIDTH + 52,
        .apart = 53,
        .field = PATH_T,
        .segment = 54,
        .why = {.why = WHY_WRONG,
                .segment = 55,
                .light = 56,
                .answer = {{.judged = true,
                            .ray = {.org = {0.25f, 0.25f, 1}, .dir = {0, 0, -1}, .tmax = 9},
                            .hit = {.prim = 61, .t = 62, .u = 63, .v = 64},
                            .judgement = {.expected = 65, .t_lo = 66, .t_hi = 67}}}}};
}

static void fill_run(const struct diff_options *options)
{
    run.options = options;
    run.stage.scene.tri_count = 71;
    run.stage.job.width = WIDTH;
    run.stage.job.height = 72;
    run.stage.job.look.bounces = 73;
    run.stage.job.light_count = 74;
    run.member[0].engine = engine_find("cpu");
    run.member[1].engine = engine_find("brute");
    run.count = 2;
    snprintf(run.command, sizeof run.command, "look");
    fill_pair(&run.member[1].pair);
}

static const struct told_number numbers[] = {
    {"exit", 1},
    {"triangles", 71},
    {"width", WIDTH},
    {"height", 72},
    {"bounces", 73},
    {"lights", 74},
    {"pairs.0.same_bits_demanded", 0},
    {"pairs.0.agrees", 0},
    {"pairs.0.vacuous", 0},
    {"pairs.0.paths", 11},
    {"pairs.0.paths_different", 14},
    {"pairs.0.segments", 12},
    {"pairs.0.triangle", 16},
    {"pairs.0.t", 17},
    {"pairs.0.asked", 18},
    {"pairs.0.shadowed", 19},
    {"pairs.0.values_different", 25},
    {"pairs.0.largest", 28},
    {"pairs.0.at_a_border", 26},
    {"pairs.0.beyond_the_bound", 27},
    {"pairs.0.to_explain", 29},
    {"pairs.0.why.same", 0},
    {"pairs.0.why.rounding", 0},
    {"pairs.0.why.allowed", 0},
    {"pairs.0.why.drift", 0},
    {"pairs.0.why.published", 0},
    {"pairs.0.why.renderer", 0},
    {"pairs.0.why.wrong", 1},
    {"pairs.0.why.unexplained", 0},
    {"pairs.0.allowed.tie", 41},
    {"pairs.0.allowed.near_tie", 42},
    {"pairs.0.allowed.boundary", 43},
    {"pairs.0.allowed.border", 44},
    {"pairs.0.allowed.in_plane", 45},
    {"pairs.0.allowed.slab", 46},
    {"pairs.0.allowed.noise", 47},
    {"pairs.0.allowed.out_of_contract", 48},
    {"pairs.0.err_over_bound", 30.5},
    {"pairs.0.borders.0.x", 32},
    {"pairs.0.borders.0.y", 31},
    {"pairs.0.borders.0.values.0", 0x030201},
    {"pairs.0.borders.0.values.1", 0x060504},
    {"pairs.0.borders.0.bound", 0.25},
    {"pairs.0.pixels.wrong.0.x", 52},
    {"pairs.0.pixels.wrong.0.y", 51},
    {"pairs.0.pixels.wrong.0.value_difference", 53},
    {"pairs.0.pixels.wrong.0.picture_segment", 54},
    {"pairs.0.pixels.wrong.0.segment", 55},
    {"pairs.0.pixels.wrong.0.light", 56},
    {"pairs.0.pixels.wrong.0.answers.0.answer.prim", 61},
    {"pairs.0.pixels.wrong.0.answers.0.answer.t.value", 62},
    {"pairs.0.pixels.wrong.0.answers.0.answer.u.value", 63},
    {"pairs.0.pixels.wrong.0.answers.0.answer.v.value", 64},
    {"pairs.0.pixels.wrong.0.answers.0.expected", 65},
    {"pairs.0.pixels.wrong.0.answers.0.t_lo", 66},
    {"pairs.0.pixels.wrong.0.answers.0.t_hi", 67},
};

static struct diff_options options_made(void)
{
    return (struct diff_options){.settings = {.scene = scene_name,
                                              .builder = builders_all[0],
                                              .box = box_tests[0],
                                              .tri = tri_tests[0]},
                                 .list = 1,
                                 .json = told_file()};
}

static void the_json_of_two_pictures(void **state)
{
    (void)state;
    const struct diff_options options = options_made();
    struct reason reason;
    fill_run(&options);
    assert_int_equal(diff_write_json(&run, 1, &reason), STATUS_OK);
    told_json(told_file_json(), numbers, ARRAY_COUNT(numbers));
}

/* With pixels; and with as many of each reason as no other has, those of faults last. */
static void the_text_of_two_pictures(void **state)
{
    (void)state;
    const char *const head[] = {
        "s: 71 triangles; 100 x 72 pixels, profile repaired, 73 bounces, 74 lights\n",
        "paths 14 of 11 differ\n",
        "segments 12, different in triangle 16, t 17, lights asked 18, shadows 19\n",
        "values 25 of 11 pixels differ, by 28 at most; same path: 26 within the bound of a "
        "rounding "
        "border, 27 not\n",
    };
    const char *const pixels[] = {
        head[0],
        head[1],
        head[2],
        head[3],
        "explained 0 of 29 pixels: same path 0, rounding 0, drift 0, tie 41, near_tie 42, "
        "boundary 43, border 44, in_plane 45, slab 46, noise 47, out_of_contract 48, wrong as "
        "published 0\n",
        "faults wrong answer 1, picture not of its rays 0, unexplained 0; err/E at most 30.5\n",
        "pixel 32,31 border: rgb 1 2 3 and 4 5 6, bound 0.25 of a step\n",
        "pixel 52,51 wrong: values differ by 53; pictures part at segment 54 (t); rays at segment "
        "55, light 56, of cpu",
        "--pixel 52,51",
    };
    const char *const reasons[] = {
        head[0],
        head[1],
        head[2],
        head[3],
        "explained 503 of 29 pixels: same path 80, rounding 81, drift 83, tie 41,",
        " near_tie 42, boundary 43, border 44, in_plane 45, slab 46, noise 47, out_of_contract 48, "
        "wrong as published 84\n",
        "faults wrong answer 86, picture not of its rays 85, unexplained 87; err/E at most 30.5\n",
    };
    struct diff_options options = options_made();
    fill_run(&options);
    told_begin(&stdout);
    diff_print(&run);
    told_text(told_end(), pixels, ARRAY_COUNT(pixels));
    options.list = 0;
    for (enum why why = WHY_SAME; why < WHY_COUNT; why++)
        run.member[1].pair.why[why] = 80 + why;
    run.member[1].pair.why[WHY_ALLOWED] = 503 - 80 - 81 - 83 - 84;
    told_begin(&stdout);
    diff_print(&run);
    told_text(told_end(), reasons, ARRAY_COUNT(reasons));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_json_of_two_pictures),
        cmocka_unit_test(the_text_of_two_pictures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
