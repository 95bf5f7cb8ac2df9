/* Pictures, measured frames, comparisons, measures and reports hold no more memory after each time
 * (tests/laws/in_use.h). */
#define _GNU_SOURCE /* open_memstream, mkdtemp */
#include "tests/bench/report_fixture.h"

#include "bench/frames/painter.h"
#include "bench/measure/error_measure.h"
#include "bench/measure/leak_rays.h"
#include "bench/measure/touch.h"
#include "scenes/rays/rays.h"
#include "scenes/render/diff_engines.h"
#include "scenes/scenes.h"
#include "tests/laws/in_use.h"
#include "tests/support/opened.h"
#include "tests/support/pictures.h"

#define RAYS 50u

static const struct engine_options options = {.threads = 1, .device = -1};

/* --- painters ------------------------------------------------------------------------------- */

static struct scene drawn;

static void paint(const void *what)
{
    struct painter painter;
    struct frames_sample sample;
    struct sheet sheet;
    struct reason reason = {""};
    if (painter_open(what, &drawn, &options, &painter, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(sheet_make(what, &sheet, &reason), STATUS_OK);
    assert_int_equal(painter_draw(&painter, 1, &sample, &reason), STATUS_OK);
    assert_int_equal(painter_sheet(&painter, 2, &sheet, &sample, &reason), STATUS_OK);
    sheet_free(&sheet);
    painter_close(&painter);
}

static void refuse_to_paint(const void *what)
{
    struct painter painter;
    struct reason reason;
    assert_int_not_equal(painter_open(what, &drawn, &options, &painter, &reason), STATUS_OK);
    painter_close(&painter);
}

static void painters_hold_no_more(void **state)
{
    (void)state;
    static const char *const names[] = {"cpu", "brute", "fast", "kd"};
    drawn = opened("rtrs", 1);
    for (size_t i = 0; i < ARRAY_COUNT(names); i++)
        for (int look = 0; look < 4; look++) {
            const struct engine *engine = engine_find(names[i]);
            struct painter_plan plan = {
                .handler = names[i],
                .engine = engine,
                .layout = engine->needs_packed ? layout_find("f32") : NULL,
                .builder = builder_find("median"),
                .build = {.leaf = 4},
                .box = box_test_find("robust"),
                .tri = tri_test_find("mt"),
                .look = {.profile = look & 1 ? PROFILE_RTRS : PROFILE_REPAIRED, .bounces = 2},
                .width = 12,
                .height = 9,
                .blank = look & 2};
            must_hold_no_more(names[i], look & 2 ? "a blank painter" : "a painter", paint, &plan);
            plan.look.bounces = 1000; /* that many a picture cannot have */
            must_hold_no_more(names[i], "a painter that is refused", refuse_to_paint, &plan);
        }
    scene_free(&drawn);
}

/* --- comparisons ---------------------------------------------------------------------------- */

static struct picture picture;
static struct oracle *oracle;

static void compare(const void *what)
{
    static struct pair pair;
    struct side side[2];
    struct reason reason = {""};
    struct frame_job other = picture.job;
    size_t *pixel, count;
    other.job.packed = NULL;
    other.job.tri = tri_test_find("mt");
    if (side_open(engine_find("cpu"), &options, &picture.job, what, &side[0], &reason) ||
        side_open(engine_find("brute"), &options, &other, what, &side[1], &reason) ||
        side_draw(&side[0], &picture.view, &reason) ||
        side_draw(&side[1], &picture.view, &reason) ||
        pair_compare(&side[0], &side[1], &pair, &pixel, &count, &reason) ||
        pair_explain(&side[0], &side[1], &picture.view, oracle, pixel, count, &pair, &reason))
        fail_msg("%s", reason.text);
    assert_true(count > 0);
    free(pixel);
    side_close(&side[0]);
    side_close(&side[1]);
}

static void comparisons_hold_no_more(void **state)
{
    (void)state;
    const struct look look = {.profile = PROFILE_RTRS, .bounces = 4};
    picture = picture_make("rtrs", look, 24, 18);
    picture_settle(&picture);
    assert_int_equal(oracle_make(&picture.scene, &oracle, NULL), STATUS_OK);
    must_hold_no_more("two sides", "by renderers", compare, NULL);
    must_hold_no_more("two sides", "by waves", compare, "waves");
    oracle_free(oracle);
    picture_free(&picture);
}

/* --- measures ------------------------------------------------------------------------------- */

static struct bvh bvh;

static void measure(const void *what)
{
    struct packed packed;
    struct touch touch;
    struct cache_sim cache;
    struct error_sum sum;
    struct ray ray[RAYS];
    struct hit hit[RAYS];
    struct oracle_answer truth[RAYS];
    struct reason reason = {""};
    const struct tri_store *store = tri_store_find(what);
    struct job job = {.scene = &drawn,
                      .packed = &packed,
                      .box = box_test_find("robust"),
                      .tri = tri_test_find("mt"),
                      .query = QUERY_CLOSEST};
    if (packed_make_stored(layout_find("f32"), store, &bvh, &drawn, &packed, &reason) ||
        cache_sim_make(cache_sim_usual, &cache, &reason) ||
        touch_make(&packed, &drawn, false, &cache, &touch, &reason) ||
        leak_rays_make(oracle, &drawn, LEAK_EDGE, 1, RAYS, ray, &reason) ||
        oracle_closest(oracle, ORACLE_TREE, ORACLE_CLOSED, ray, RAYS, 1, truth, NULL, &reason))
        fail_msg("%s", reason.text);
    for (size_t i = 0; i < RAYS; i++)
        assert_int_equal(touch_ray(&touch, &job, &ray[i], &hit[i]), STATUS_OK);
    assert_int_equal(error_sum_make(oracle, &drawn, ray, truth, hit, RAYS, &sum, &reason),
                     STATUS_OK);
    touch_free(&touch);
    cache_sim_free(&cache);
    packed_free(&packed);
}

static void measures_hold_no_more(void **state)
{
    (void)state;
    const struct build_options build = {.leaf = 4};
    drawn = opened("sphere:n=5", 1);
    assert_int_equal(bvh_build(builder_find("median"), &drawn, &build, &bvh, NULL), STATUS_OK);
    assert_int_equal(oracle_make(&drawn, &oracle, NULL), STATUS_OK);
    must_hold_no_more("measures", "of indices", measure, "indexed");
    must_hold_no_more("measures", "of vertices", measure, "gathered");
    oracle_free(oracle);
    bvh_free(&bvh);
    scene_free(&drawn);
}

/* --- reports -------------------------------------------------------------------------------- */

static void write_report(const void *what)
{
    struct report report = empty();
    (void)what;
    add(&report, REPORT_CHECK, check_of("2", "1", "true", "3", "ok"), EXIT_MISMATCH);
    add(&report, REPORT_BENCH, json_of(error_text, NULL, 0), 0);
    add(&report, REPORT_BENCH, json_of(frames_text, NULL, 0), 0);
    add(&report, REPORT_PICTURES, json_of(diff_text, NULL, 0), EXIT_MISMATCH);
    add(&report, REPORT_FINDING, json_of(replay_text, NULL, 0), EXIT_MISMATCH);
    add(&report, REPORT_MACHINE, json_of(doctor_text, NULL, 0), 0);
    free(page_of(&report));
    report_free(&report);
}

static void reports_hold_no_more(void **state)
{
    (void)state;
    must_hold_no_more("a report", "of every part", write_report, NULL);
}

int main(int argc, char **argv)
{
    keep_nothing(argc, argv);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_forgotten_is_seen), cmocka_unit_test(painters_hold_no_more),
        cmocka_unit_test(comparisons_hold_no_more),  cmocka_unit_test(measures_hold_no_more),
        cmocka_unit_test(reports_hold_no_more),
    };
    return cmocka_run_group_tests_name("freed_pictures", tests, NULL, NULL);
}
