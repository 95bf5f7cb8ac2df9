/* Painters of measured frames, by engines that need no GPU. */
#include "bench/frames/painter.h"
#include "scenes/scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

static const struct engine_options options = {.threads = 1, .device = -1};

static struct painter_plan plan_of(const char *engine, const char *layout)
{
    return (struct painter_plan){.handler = engine,
                                 .engine = engine_find(engine),
                                 .layout = layout ? layout_find(layout) : NULL,
                                 .builder = builder_find("rtrs"),
                                 .build = {.leaf = 4, .eps = 0.02f},
                                 .box = box_test_find("rtrs"),
                                 .tri = tri_test_find("mt_rtrs"),
                                 .look = {.profile = PROFILE_RTRS, .bounces = 3},
                                 .width = 40,
                                 .height = 30};
}

static struct scene opened(void)
{
    struct scene scene;
    assert_int_equal(scene_open("rtrs", 1, &scene, NULL), STATUS_OK);
    return scene;
}

static void open_painter(const struct painter_plan *plan, const struct scene *scene,
                         struct painter *out)
{
    struct reason reason = {""};
    if (painter_open(plan, scene, &options, out, &reason))
        fail_msg("%s: %s", plan->handler, reason.text);
}

static void draw_sheet(struct painter *painter, double angle, struct sheet *out)
{
    struct frames_sample sample;
    assert_int_equal(sheet_make(&painter->plan, out, NULL), STATUS_OK);
    assert_int_equal(painter_sheet(painter, angle, out, &sample, NULL), STATUS_OK);
    assert_true(sample.ms >= 0);
}

static size_t lit(const struct sheet *sheet)
{
    size_t count = 0;
    for (size_t i = 0; i < (size_t)sheet->width * sheet->height; i++)
        count += (sheet->frame.pixel[i] & 0xFFFFFFu) != 0;
    return count;
}

static void bytes_are_the_handlers(void **state)
{
    (void)state;
    struct scene scene = opened();
    static const struct {
        const char *layout;
        uint32_t leaf;
        uint64_t bytes;
    } known[] = {{"rtrs_direct", 2, 2448}, {"rtrs_rf", 4, 656}, {"f32", 4, 27 * 32 + 40 * 4}};
    for (size_t i = 0; i < ARRAY_COUNT(known); i++) {
        struct painter painter;
        struct painter_plan plan = plan_of("cpu", known[i].layout);
        plan.build.leaf = known[i].leaf;
        open_painter(&plan, &scene, &painter);
        assert_int_equal(painter_bytes(&painter), known[i].bytes);
        assert_true(painter.by_waves && painter.tree.largest_leaf <= known[i].leaf);
        painter_close(&painter);
    }
    struct painter none;
    struct painter_plan plan = plan_of("brute", NULL);
    open_painter(&plan, &scene, &none);
    assert_int_equal(painter_bytes(&none), 0);
    painter_close(&none);
    scene_free(&scene);
}

/* A frame takes no longer than drawing it did, and is told in ms. */
static void frames_are_told_in_milliseconds(void **state)
{
    (void)state;
    struct scene scene = opened();
    struct painter painter;
    struct painter_plan plan = plan_of("cpu", "f32");
    plan.width = 160;
    plan.height = 120;
    open_painter(&plan, &scene, &painter);
    for (int i = 0; i < 3; i++) {
        struct frames_sample sample;
        const uint64_t start = time_ns();
        assert_int_equal(painter_draw(&painter, 0.1 * i, &sample, NULL), STATUS_OK);
        const double ms = 1e-6 * (double)(time_ns() - start);
        print_message("%.3f of %.3f ms\n", sample.ms, ms);
        assert_true(sample.ms <= ms);
        assert_true(sample.ms > 2e-3 * ms);
    }
    painter_close(&painter);
    scene_free(&scene);
}

/* What the pipeline for every scene has no room for is refused, so the flag has reached it. */
static void general_is_handed_on(void **state)
{
    (void)state;
    struct scene scene = opened();
    struct painter painter;
    struct reason reason = {""};
    struct painter_plan plan = plan_of("vulkan", "f32");
    plan.look.bounces = 9;
    plan.general = true;
    enum status status = painter_open(&plan, &scene, &options, &painter, &reason);
    scene_free(&scene);
    if (status == STATUS_UNSUPPORTED) {
        print_message("SKIP %s\n", reason.text);
        skip();
    }
    assert_int_equal(status, STATUS_LIMIT);
}

/* The same tree in two layouts gives the same frame; turning changes it; a turn brings it back. */
static void frames_follow_the_angle(void **state)
{
    (void)state;
    struct scene scene = opened();
    struct painter a, b;
    struct painter_plan plan = plan_of("cpu", "f32");
    open_painter(&plan, &scene, &a);
    plan.layout = layout_find("rf16");
    open_painter(&plan, &scene, &b);
    struct sheet first, same, turned, round;
    draw_sheet(&a, 0, &first);
    draw_sheet(&b, 0, &same);
    draw_sheet(&a, 0.5, &turned);
    draw_sheet(&a, 8 * atan(1), &round);
    assert_true(lit(&first) > 10);
    assert_true(sheet_equal(&first, &same));
    assert_int_equal(sheet_pixels_apart(&first, &same), 0);
    assert_true(sheet_pixels_apart(&first, &turned) > 5);
    assert_true(sheet_pixels_apart(&first, &round) < 5);
    sheet_free(&first);
    sheet_free(&same);
    sheet_free(&turned);
    sheet_free(&round);
    painter_close(&a);
    painter_close(&b);
    scene_free(&scene);
}

/* Whatever the layout, also where a tree of the scene is given. */
static void a_blank_frame_hits_nothing(void **state)
{
    (void)state;
    struct scene scene = opened();
    struct painter_plan plan = plan_of("cpu", "f32");
    struct bvh tree;
    struct reason reason = {""};
    plan.blank = true;
    assert_int_equal(bvh_build(plan.builder, &scene, &plan.build, &tree, &reason), STATUS_OK);
    for (size_t l = 0; layouts_all[l]; l++)
        for (int given = 0; given < 2; given++) {
            struct painter painter;
            struct sheet sheet;
            plan.layout = layouts_all[l];
            plan.tree = given ? &tree : NULL;
            open_painter(&plan, &scene, &painter);
            assert_int_equal(painter_bytes(&painter), 0);
            assert_int_equal(painter.tree.node_count, 0);
            draw_sheet(&painter, 0, &sheet);
            assert_int_equal(lit(&sheet), 0);
            sheet_free(&sheet);
            painter_close(&painter);
        }
    bvh_free(&tree);
    scene_free(&scene);
}

/* One bit of a pixel, a colour or a segment is a difference. */
static void sheets_are_compared_to_the_bit(void **state)
{
    (void)state;
    struct scene scene = opened();
    struct painter painter;
    struct painter_plan plan = plan_of("cpu", "f32");
    open_painter(&plan, &scene, &painter);
    struct sheet a, b;
    draw_sheet(&painter, 0, &a);
    draw_sheet(&painter, 0, &b);
    size_t hit = 0; /* a pixel whose first segment hit something */
    while (a.frame.segment[hit * a.bounces].prim == ABI_NO_PRIM)
        hit++;
    uint32_t *words[] = {&b.frame.pixel[hit], (uint32_t *)&b.frame.color[3 * hit + 2],
                         (uint32_t *)&b.frame.segment[hit * b.bounces].t};
    assert_true(sheet_equal(&a, &b));
    for (size_t i = 0; i < ARRAY_COUNT(words); i++) {
        *words[i] ^= 1;
        assert_false(sheet_equal(&a, &b));
        *words[i] ^= 1;
    }
    b.frame.bound[hit] = 7; /* of no picture */
    assert_true(sheet_equal(&a, &b));
    sheet_free(&a);
    sheet_free(&b);
    painter_close(&painter);
    scene_free(&scene);
}

static void who_cannot_draw_says_why(void **state)
{
    (void)state;
    struct scene scene = opened();
    struct painter painter;
    struct reason reason = {""};
    struct painter_plan plan = plan_of("cpu", "rf16");
    plan.build.leaf = 40; /* more than a record has slots */
    assert_int_equal(painter_open(&plan, &scene, &options, &painter, &reason), STATUS_LIMIT);
    assert_true(reason.text[0] && !painter.renderer && !painter.pixel);
    plan = plan_of("cpu", "f32");
    plan.width = 0;
    assert_int_equal(painter_open(&plan, &scene, &options, &painter, &reason), STATUS_INPUT);
    painter_close(&painter);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bytes_are_the_handlers),
        cmocka_unit_test(frames_are_told_in_milliseconds),
        cmocka_unit_test(general_is_handed_on),
        cmocka_unit_test(frames_follow_the_angle),
        cmocka_unit_test(a_blank_frame_hits_nothing),
        cmocka_unit_test(sheets_are_compared_to_the_bit),
        cmocka_unit_test(who_cannot_draw_says_why),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
