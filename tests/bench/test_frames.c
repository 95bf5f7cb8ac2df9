/* Measured runs of frames, with a renderer that takes as long as the test says. */
#define _GNU_SOURCE
#include "bench/frames/frames_files.h"
#include "ref/files/file.h"
#include "scenes/picture/image.h"
#include "tests/support/root.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <jansson.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MOST 512

/* cmocka.h takes the name of fail(). */
static enum status lost(struct reason *reason)
{
    snprintf(reason->text, sizeof reason->text, "lost");
    return STATUS_DEVICE;
}

/* Contestant 0 takes 2 ms, contestant 1 takes 3; the frames listed take 100 more. */
struct drawer {
    unsigned calls;
    size_t who[MOST];
    double angle[MOST];
    unsigned slow_call; /* 100 ms more, from 1; 0: none */
    unsigned stop_call; /* sets `stop` */
    unsigned fail_call; /* the device is lost */
    unsigned host_call; /* no timestamps */
    volatile sig_atomic_t stop;
    unsigned told;
    uint32_t told_done[MOST];
    const char *base; /* NULL, or files are written */
};

static enum status draw(void *user, size_t contestant, double angle, struct frames_sample *out,
                        struct reason *reason)
{
    struct drawer *drawer = user;
    assert_true(drawer->calls < MOST);
    drawer->who[drawer->calls] = contestant;
    drawer->angle[drawer->calls] = angle;
    drawer->calls++;
    if (drawer->calls == drawer->fail_call)
        return lost(reason);
    drawer->stop = drawer->stop || drawer->calls == drawer->stop_call;
    *out = (struct frames_sample){.ms = contestant == 0 ? 2 : 3,
                                  .device_clock = drawer->calls != drawer->host_call};
    if (drawer->calls == drawer->slow_call)
        out->ms += 100;
    return STATUS_OK;
}

static const struct frames_about about = {
    .title = "a <scene>", .note = {{"device", "none, \"made\""}}, .base = 0};

static enum status tell(void *user, const struct frames_run *run, struct reason *reason)
{
    struct drawer *drawer = user;
    drawer->told_done[drawer->told++] = run->done;
    return drawer->base ? frames_write(run, &about, drawer->base, reason) : STATUS_OK;
}

static struct frames_run made(struct drawer *drawer, uint32_t frames, uint32_t turns,
                              uint32_t warm_up)
{
    struct frames_run run;
    struct frames_settings settings = {frames, turns, warm_up, &drawer->stop};
    assert_int_equal(frames_make(&settings, &run, NULL), STATUS_OK);
    assert_int_equal(frames_enter(&run, "RF-BVH", 656, NULL), STATUS_OK);
    assert_int_equal(frames_enter(&run, "BVH, 48 \"bytes\"", 2448, NULL), STATUS_OK);
    return run;
}

static void angles_are_fixed_and_go_round(void **state)
{
    (void)state;
    struct frames_settings settings = {200, 5, 3, NULL};
    assert_true(fabs(frames_angle(&settings, 40) - 2 * acos(-1)) < 1e-12);
    assert_true(fabs(frames_angle(&settings, 200) - 10 * acos(-1)) < 1e-12);
    assert_true(frames_angle(&settings, 0) == 0 && frames_angle(&settings, -1) < 0);
    settings.turns = 0;
    assert_true(frames_angle(&settings, 7) == 0);
}

static void contestants_take_turns_at_the_same_angles(void **state)
{
    (void)state;
    struct drawer drawer = {0};
    struct frames_run run = made(&drawer, 20, 1, 2);
    assert_int_equal(frames_measure(&run, draw, NULL, &drawer, NULL), STATUS_OK);
    assert_int_equal(drawer.calls, 2 * 22);
    assert_true(run.done == 20 && run.dropped == 2 && !run.stopped);
    for (unsigned i = 0; i < drawer.calls; i++) {
        assert_int_equal(drawer.who[i], i < 4 ? i % 2 : (i + i / 2) % 2);
        assert_true(drawer.angle[i] == frames_angle(&run.settings, (int64_t)(i / 2) - 2));
    }
    frames_free(&run);
}

static void warm_up_is_dropped(void **state)
{
    (void)state;
    for (unsigned call = 1; call <= 7; call += 2) { /* the first contestant's */
        struct drawer drawer = {.slow_call = call};
        struct frames_run run = made(&drawer, 5, 1, 3);
        assert_int_equal(frames_measure(&run, draw, NULL, &drawer, NULL), STATUS_OK);
        assert_true(frames_stats_of(&run, 0).most == (call <= 6 ? 2 : 102));
        frames_free(&run);
    }
}

static void a_slow_frame_is_in_the_statistics(void **state)
{
    (void)state;
    struct drawer drawer = {.slow_call = 2 * 4 + 2}; /* frame 4 of the second */
    struct frames_run run = made(&drawer, 10, 1, 0);
    assert_int_equal(frames_measure(&run, draw, NULL, &drawer, NULL), STATUS_OK);
    struct frames_stats fast = frames_stats_of(&run, 0), slow = frames_stats_of(&run, 1);
    assert_true(fast.average == 2 && fast.least == 2 && fast.most == 2 && fast.median == 2);
    assert_true(slow.average == 13 && slow.least == 3 && slow.most == 103 && slow.median == 3);
    assert_true(run.contestant[1].ms[4] == 103 && run.contestant[1].ms[5] == 3);
    struct spread ratio = frames_ratio(&run, 1, 0);
    assert_true(ratio.median == 1.5 && ratio.least == 1.5 && ratio.most == 51.5);
    ratio = frames_ratio(&run, 0, 1);
    assert_true(ratio.least == 2.0 / 103 && ratio.most == 2.0 / 3);
    frames_free(&run);
}

/* Of 9 values the 8th largest, of 200 the 114th; the interval is narrower the more there are. */
static void the_median_is_known_within_ranks(void **state)
{
    (void)state;
    double value[200];
    static const size_t counts[] = {1, 4, 5, 9, 200};
    static const double expected[] = {INFINITY, INFINITY, 5, 8, 114};
    for (size_t i = 0; i < ARRAY_COUNT(counts); i++) {
        for (size_t k = 0; k < counts[i]; k++)
            value[k] = (double)(counts[i] - k);
        assert_true(spread_median_most(value, counts[i]) == expected[i]);
        assert_true(spread_of(value, counts[i]).median == 0.5 * (double)(counts[i] + 1));
    }
}

static void one_sample_of_the_host_clock_names_it(void **state)
{
    (void)state;
    struct drawer drawer = {.host_call = 6};
    struct frames_run run = made(&drawer, 10, 1, 0);
    assert_int_equal(frames_measure(&run, draw, NULL, &drawer, NULL), STATUS_OK);
    assert_string_equal(frames_clock(&run.contestant[0]), "GPU timestamps");
    assert_string_equal(frames_clock(&run.contestant[1]), "host clock");
    frames_free(&run);
}

static void files_are_told_of_every_ten_frames_and_at_the_end(void **state)
{
    (void)state;
    static const uint32_t expected[2][4] = {{10, 20, 25, 0}, {10, 20, 0, 0}};
    for (int i = 0; i < 2; i++) {
        struct drawer drawer = {0};
        struct frames_run run = made(&drawer, i == 0 ? 25 : 20, 1, 1);
        assert_int_equal(frames_measure(&run, draw, tell, &drawer, NULL), STATUS_OK);
        assert_memory_equal(drawer.told_done, expected[i], sizeof expected[i]);
        frames_free(&run);
    }
}

static void a_stopped_run_keeps_whole_frames(void **state)
{
    (void)state;
    struct drawer drawer = {.stop_call = 2 * 5 + 1}; /* within frame 5: the second draws it not */
    struct frames_run run = made(&drawer, 30, 1, 0);
    assert_int_equal(frames_measure(&run, draw, tell, &drawer, NULL), STATUS_OK);
    assert_true(run.stopped && run.done == 5);
    assert_int_equal(drawer.told, 1);
    assert_int_equal(drawer.told_done[0], 5);
    frames_free(&run);
    struct drawer early = {.stop_call = 1};
    run = made(&early, 30, 1, 3);
    assert_int_equal(frames_measure(&run, draw, tell, &early, NULL), STATUS_OK);
    assert_true(run.stopped && run.done == 0 && run.dropped == 0);
    assert_true(frames_stats_of(&run, 0).average == 0 && frames_ratio(&run, 0, 1).median == 0);
    frames_free(&run);
}

/* Frame f of the first contestant takes f * f + 1 ms, of the second twice as long and f more. */
static enum status draw_longer(void *user, size_t contestant, double angle,
                               struct frames_sample *out, struct reason *reason)
{
    enum status status = draw(user, contestant, angle, out, reason);
    double f = round(angle * 30 / (2 * acos(-1)));
    out->ms = contestant == 0 ? f * f + 1 : 2 * (f * f + 1) + f;
    return status;
}

/* Of frames 0 to n - 1 the average is (n - 1)(2n - 1) / 6 + 1, the median of an even count between
 * the two in the middle: nothing is of the frames that were not drawn. */
static void a_stopped_run_has_the_statistics_of_its_frames(void **state)
{
    (void)state;
    for (unsigned n = 1; n <= 30; n++) {
        struct drawer drawer = {.stop_call = n < 30 ? 2 * n + 1 : 0};
        struct frames_run run = made(&drawer, 30, 1, 0);
        double last = n - 1.0, low = floor(last / 2), high = ceil(last / 2);
        assert_int_equal(frames_measure(&run, draw_longer, NULL, &drawer, NULL), STATUS_OK);
        assert_int_equal(run.done, n);
        struct frames_stats a = frames_stats_of(&run, 0), b = frames_stats_of(&run, 1);
        double middle = 0.5 * (low * low + high * high) + 1;
        assert_true(fabs(a.average - (last * (2 * last + 1) / 6 + 1)) < 1e-9);
        assert_true(fabs(b.average - (2 * a.average + last / 2)) < 1e-9);
        assert_true(a.least == 1 && b.least == 2);
        assert_true(fabs(a.most - (last * last + 1)) < 1e-9);
        assert_true(fabs(b.most - (2 * a.most + last)) < 1e-9);
        assert_true(fabs(a.median - middle) < 1e-9);
        assert_true(fabs(b.median - (2 * middle + last / 2)) < 1e-9);
        /* 2 + f / (f * f + 1): least at 0, most at 1 */
        struct spread ratio = frames_ratio(&run, 1, 0);
        assert_true(ratio.least == 2 && ratio.most == (n > 1 ? 2.5 : 2));
        frames_free(&run);
    }
}

static void a_failing_frame_ends_the_run_and_is_told(void **state)
{
    (void)state;
    struct drawer drawer = {.fail_call = 2 * 12 + 2};
    struct reason reason = {""};
    struct frames_run run = made(&drawer, 30, 1, 0);
    assert_int_equal(frames_measure(&run, draw, tell, &drawer, &reason), STATUS_DEVICE);
    assert_string_equal(reason.text, "lost");
    assert_int_equal(run.done, 12);
    assert_int_equal(drawer.told_done[drawer.told - 1], 12);
    frames_free(&run);
}

static void settings_out_of_range_are_refused(void **state)
{
    (void)state;
    static const struct frames_settings bad[] = {{0, 5, 3, NULL},
                                                 {FRAMES_MOST + 1, 5, 3, NULL},
                                                 {1, UINT32_MAX, 0, NULL},
                                                 {1, 0, UINT32_MAX, NULL}};
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
        struct frames_run run;
        struct reason reason = {""};
        assert_int_equal(frames_make(&bad[i], &run, &reason), STATUS_INPUT);
        assert_true(strlen(reason.text) > 0);
        frames_free(&run);
    }
    struct frames_run run;
    struct frames_settings settings = {1, 0, 0, NULL};
    assert_int_equal(frames_make(&settings, &run, NULL), STATUS_OK);
    for (int i = 0; i < FRAMES_CONTESTANTS; i++)
        assert_int_equal(frames_enter(&run, "x", 0, NULL), STATUS_OK);
    assert_int_equal(frames_enter(&run, "x", 0, NULL), STATUS_LIMIT);
    frames_free(&run);
}

static char *read_text(const char *ending)
{
    char path[256], *text;
    size_t size;
    struct reason reason;
    snprintf(path, sizeof path, "%s/run.%s", root, ending);
    if (file_read(path, &text, &size, &reason))
        fail_msg("%s", reason.text);
    return text;
}

/* The files of a run with a planted slow frame, stopped in its 13th. */
static void files_hold_the_run(void **state)
{
    (void)state;
    char base[256];
    snprintf(base, sizeof base, "%s/run", root);
    /* the second contestant begins an odd frame */
    struct drawer drawer = {.slow_call = 2 * 6 + 1, .stop_call = 2 * 13 + 1, .base = base};
    struct frames_run run = made(&drawer, 40, 5, 1);
    assert_int_equal(frames_measure(&run, draw, tell, &drawer, NULL), STATUS_OK);
    assert_int_equal(run.done, 12);
    frames_free(&run);

    char *text = read_text("csv");
    assert_int_equal(strncmp(text, "handler,bytes,clock,frame,angle_deg,ms,average_ms,", 50), 0);
    size_t lines = 0;
    for (const char *at = text; (at = strchr(at, '\n')); at++)
        lines++;
    assert_int_equal(lines, 1 + 2 * 12);
    assert_non_null(strstr(text, "\nRF-BVH,656,GPU timestamps,11,495,2,2,2,2,2\n"));
    assert_non_null(
        strstr(text, "\n\"BVH, 48 \"\"bytes\"\"\",2448,GPU timestamps,5,225,103,11.3333333,3,"));
    free(text);

    text = read_text("json");
    json_error_t error;
    json_t *json = json_loads(text, 0, &error);
    assert_non_null(json);
    assert_int_equal(json_integer_value(json_object_get(json, "frames")), 12);
    assert_int_equal(json_integer_value(json_object_get(json, "warm_up_dropped")), 1);
    assert_true(json_is_true(json_object_get(json, "stopped")));
    json_t *second = json_array_get(json_object_get(json, "handlers"), 1);
    assert_true(json_real_value(json_object_get(second, "max_ms")) == 103);
    assert_int_equal(json_integer_value(json_object_get(second, "bytes")), 2448);
    assert_int_equal(json_array_size(json_object_get(second, "samples_ms")), 12);
    assert_true(json_real_value(json_object_get(json_object_get(second, "ratio"), "median")) ==
                1.5);
    json_decref(json);
    free(text);

    text = read_text("svg");
    assert_non_null(strstr(text, "RF-BVH"));
    assert_non_null(strstr(text, "656 bytes"));
    assert_non_null(strstr(text, "a &lt;scene&gt;"));
    assert_non_null(strstr(text, "average 11.33, 3 to 103 ms")); /* of the second */
    free(text);
    struct image image;
    struct reason reason = {""};
    snprintf(base, sizeof base, "%s/run.png", root);
    if (image_read(base, &image, &reason))
        fail_msg("%s", reason.text);
    assert_true(image.width > 300 && image.height > 100);
    image_free(&image);
}

static void files_that_cannot_be_written_are_named(void **state)
{
    (void)state;
    struct drawer drawer = {.base = "/nowhere/at/all"};
    struct reason reason = {""};
    struct frames_run run = made(&drawer, 40, 5, 1);
    assert_int_equal(frames_measure(&run, draw, tell, &drawer, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "/nowhere/at/all.csv"));
    assert_int_equal(run.done, 10);
    frames_free(&run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(angles_are_fixed_and_go_round),
        cmocka_unit_test(contestants_take_turns_at_the_same_angles),
        cmocka_unit_test(warm_up_is_dropped),
        cmocka_unit_test(a_slow_frame_is_in_the_statistics),
        cmocka_unit_test(the_median_is_known_within_ranks),
        cmocka_unit_test(one_sample_of_the_host_clock_names_it),
        cmocka_unit_test(files_are_told_of_every_ten_frames_and_at_the_end),
        cmocka_unit_test(a_stopped_run_keeps_whole_frames),
        cmocka_unit_test(a_stopped_run_has_the_statistics_of_its_frames),
        cmocka_unit_test(a_failing_frame_ends_the_run_and_is_told),
        cmocka_unit_test(settings_out_of_range_are_refused),
        cmocka_unit_test(files_hold_the_run),
        cmocka_unit_test(files_that_cannot_be_written_are_named),
    };
    return cmocka_run_group_tests(tests, make_root, remove_root);
}
