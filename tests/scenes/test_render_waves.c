/* What the renderer by waves hands to an engine and makes of its reports: an engine that counts,
 * reports what it is told to, and fails at any call. */
#include "scenes/render/render.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/support/pictures.h"

#include <math.h>
#include <stdio.h>

#define WIDTH  120u
#define HEIGHT 80u
#define MOST   4096 /* calls */

/* One instance of the engine. */
struct wave_instance {
    void *cpu;
    enum query query; /* that it was prepared for last */
};

/* What the engine does, and did. */
static struct {
    size_t fails_at;      /* of all calls of open, prepare and trace; SIZE_MAX: none */
    uint64_t ns;          /* of a call */
    size_t host_clock_at; /* the call that reports the host's clock */
    size_t calls, opened, closed, traced;
    size_t count[MOST];
    struct trace_report given[MOST];
    enum query query[MOST];
    double share[MOST];
    size_t shares;
    uint64_t rays[2];
} did;

static struct reason reason;

static enum status may_fail(struct reason *why)
{
    if (did.calls++ != did.fails_at)
        return STATUS_OK;
    return (fail)(why, STATUS_DEVICE, "call %zu fails", did.calls - 1);
}

static enum status counted_open(const struct engine *engine, const struct engine_options *options,
                                void **self, struct reason *why)
{
    (void)engine;
    enum status status = may_fail(why);
    if (status)
        return status;
    struct wave_instance *made = alloc_zeroed(1, sizeof *made);
    assert_non_null(made);
    assert_int_equal(engine_open(engine_find("cpu"), options, &made->cpu, why), STATUS_OK);
    did.opened++;
    *self = made;
    return STATUS_OK;
}

static enum status counted_prepare(void *self, const struct job *job, struct reason *why)
{
    struct wave_instance *it = self;
    it->query = job->query;
    enum status status = may_fail(why);
    return status ? status : engine_find("cpu")->prepare(it->cpu, job, why);
}

static enum status counted_trace(void *self, const struct ray *ray, size_t count, struct hit *hit,
                                 struct trace_report *report, struct reason *why)
{
    struct wave_instance *it = self;
    size_t call = did.traced;
    assert_true(call < MOST);
    enum status status = may_fail(why);
    if (status)
        return status;
    assert_int_equal(engine_find("cpu")->trace(it->cpu, ray, count, hit, report, why), STATUS_OK);
    report->ns = did.ns + call;
    report->device_clock = call != did.host_clock_at;
    report->memory_bytes = (it->query == QUERY_ANY ? 100000 : 1000) * (call * 7 % 11 + 1);
    report->flags = 1u << call % 5;
    did.count[call] = count;
    did.given[call] = *report;
    did.query[call] = it->query;
    did.rays[it->query == QUERY_ANY] += count;
    did.traced++;
    return STATUS_OK;
}

static void counted_close(void *self)
{
    struct wave_instance *it = self;
    engine_find("cpu")->close(it->cpu);
    free(it);
    did.closed++;
}

static void step(void *user, double share)
{
    assert_ptr_equal(user, &did);
    did.share[did.shares++] = share;
    assert_int_equal(did.shares, did.traced); /* once a call */
}

static struct engine counted(void)
{
    struct engine engine = *engine_find("cpu");
    engine.name = "counted";
    engine.open = counted_open;
    engine.prepare = counted_prepare;
    engine.trace = counted_trace;
    engine.close = counted_close;
    return engine;
}

static void begin(uint64_t ns)
{
    memset(&did, 0, sizeof did);
    did.fails_at = did.host_clock_at = SIZE_MAX;
    did.ns = ns;
}

static struct picture make(enum profile profile, uint32_t width, uint32_t height)
{
    const struct look look = {.profile = profile, .bounces = 3, .camera_light = 0.25f};
    struct scene scene;
    assert_int_equal(scene_open("rtrs", 1, &scene, NULL), STATUS_OK);
    picture_nearer(&scene, 0.4f);
    return picture_of(scene, look, false, width, height);
}

/* Draws as far as it goes. */
static enum status draw(struct picture *p, bool watched)
{
    const struct engine engine = counted();
    const struct engine_options options = {.threads = 2, .device = -1};
    struct renderer *renderer;
    picture_settle(p);
    enum status status = renderer_open(&engine, &options, true, &renderer, &reason);
    if (status) {
        assert_null(renderer);
        return status;
    }
    if (watched)
        renderer_watch(renderer, step, &did);
    status = renderer_prepare(renderer, &p->job, &reason);
    if (status) { /* nothing is drawn */
        struct reason why = {""};
        size_t traced = did.traced;
        assert_int_equal(renderer_frame(renderer, &p->view, &p->frame, NULL, &why), STATUS_INPUT);
        assert_string_equal(why.text, "engine counted: no picture was prepared");
        assert_int_equal(did.traced, traced);
    } else {
        status = renderer_frame(renderer, &p->view, &p->frame, &p->report, &reason);
    }
    renderer_close(renderer);
    assert_int_equal(did.opened, did.closed);
    return status;
}

static void reports_are_sums_and_mosts(void **state)
{
    (void)state;
    static const enum profile profiles[] = {PROFILE_REPAIRED, PROFILE_RTRS};
    for (size_t k = 0; k < ARRAY_COUNT(profiles); k++)
        for (int host = 0; host < 3; host++) {
            struct picture p = make(profiles[k], 32, 24);
            struct trace_report is = {.device_clock = host == 0};
            uint64_t most[2] = {0, 0};
            begin(1000);
            if (host > 0)
                did.host_clock_at = host == 1 ? 0 : 4;
            assert_int_equal(draw(&p, false), STATUS_OK);
            for (size_t i = 0; i < did.traced; i++) {
                const struct trace_report *one = &did.given[i];
                uint64_t *bytes = &most[did.query[i] == QUERY_ANY];
                is.ns += one->ns;
                is.boxes += one->boxes;
                is.tris += one->tris;
                is.flags |= one->flags;
                *bytes = *bytes > one->memory_bytes ? *bytes : one->memory_bytes;
            }
            assert_true(did.traced > 4 && is.boxes > 0 && is.tris > 0);
            assert_int_equal(p.report.ns, is.ns);
            assert_int_equal(p.report.boxes, is.boxes);
            assert_int_equal(p.report.tris, is.tris);
            assert_int_equal(p.report.flags, is.flags);
            assert_int_equal(p.report.device_clock, is.device_clock);
            assert_int_equal(p.report.memory_bytes, most[0] + most[1]);
            assert_int_equal(did.opened, profiles[k] == PROFILE_REPAIRED ? 2 : 1);
            assert_int_equal(did.rays[1] > 0, profiles[k] == PROFILE_REPAIRED);
            assert_int_equal(did.count[0], 32 * 24);
            picture_free(&p);
        }
}

/* Wherever it fails, the status and the reason are the engine's, and nothing is left open. */
static void failures_are_told(void **state)
{
    (void)state;
    static const enum profile profiles[] = {PROFILE_REPAIRED, PROFILE_RTRS};
    for (size_t k = 0; k < ARRAY_COUNT(profiles); k++) {
        struct picture p = make(profiles[k], 32, 24);
        begin(1000);
        assert_int_equal(draw(&p, false), STATUS_OK);
        size_t calls = did.calls;
        assert_int_equal(calls, did.traced + 2 * did.opened);
        for (size_t i = 0; i < calls; i++) {
            char text[32];
            begin(1000);
            did.fails_at = i;
            assert_int_equal(draw(&p, false), STATUS_DEVICE);
            snprintf(text, sizeof text, "call %zu fails", i);
            assert_string_equal(reason.text, text);
            assert_int_equal(did.calls, i + 1); /* and no call is made after it */
        }
        picture_free(&p);
    }
}

/* Parts are doubled after each call that was fast; the picture is the same, and shares grow. */
static void watched_pictures_are_drawn_in_parts(void **state)
{
    (void)state;
    static const uint64_t ns[] = {0, 100000000};
    struct picture plain = make(PROFILE_REPAIRED, WIDTH, HEIGHT);
    begin(0);
    assert_int_equal(draw(&plain, false), STATUS_OK);
    const uint64_t rays[2] = {did.rays[0], did.rays[1]};
    const size_t calls = did.traced;
    assert_int_equal(did.shares, 0);
    for (size_t k = 0; k < ARRAY_COUNT(ns); k++) {
        struct picture p = make(PROFILE_REPAIRED, WIDTH, HEIGHT);
        size_t pixels = (size_t)WIDTH * HEIGHT;
        begin(ns[k]);
        assert_int_equal(draw(&p, true), STATUS_OK);
        assert_int_equal(did.shares, did.traced);
        assert_true(did.traced > calls);
        assert_true(did.rays[0] == rays[0] && did.rays[1] == rays[1]);
        assert_memory_equal(p.frame.pixel, plain.frame.pixel, pixels * sizeof *p.frame.pixel);
        assert_memory_equal(p.frame.segment, plain.frame.segment,
                            3 * pixels * sizeof *p.frame.segment);
        uint32_t segment = 0;
        for (size_t i = 0, part = 4096; i < did.traced; i++) {
            segment += i > 0 && did.query[i] == QUERY_CLOSEST && did.query[i - 1] == QUERY_ANY;
            assert_true(fabs(did.share[i] - segment / 3.0) < 1e-12);
            assert_true(did.count[i] <= part);
            size_t first = i == 0 ? part : i == 1 ? pixels - 4096 : 0; /* of the first wave */
            assert_true(i > 1 || did.count[i] == (first < part ? first : part));
            part *= k == 0 ? 2 : 1;
        }
        assert_true(segment > 0);
        picture_free(&p);
    }
    picture_free(&plain);
}

/* Of many strips the share is that of the pixels before. */
static void shares_are_those_of_the_strips(void **state)
{
    (void)state;
    const struct look look = {.profile = PROFILE_RTRS, .bounces = 1};
    struct picture p = picture_make("rtrs", look, 512, 600);
    const struct engine engine = counted();
    const struct engine_options options = {.threads = 2, .device = -1};
    struct renderer *renderer;
    size_t strip = (((size_t)1 << 17) / 512 + 1) * 512, traced = 0, all = 512 * 600;
    picture_settle(&p);
    p.job.light_count = 0;
    begin(0);
    if (renderer_open(&engine, &options, true, &renderer, &reason))
        fail_msg("%s", reason.text);
    renderer_watch(renderer, step, &did);
    if (renderer_prepare(renderer, &p.job, &reason) ||
        renderer_frame(renderer, &p.view, &p.frame, NULL, &reason))
        fail_msg("%s", reason.text);
    for (size_t i = 0; i < did.traced; i++) {
        size_t first = traced / strip * strip;
        assert_true(fabs(did.share[i] - (double)first / (double)all) < 1e-12);
        traced += did.count[i];
        assert_true(traced <= first + strip); /* no call is of two strips */
    }
    assert_int_equal(traced, all);
    renderer_close(renderer);
    picture_free(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reports_are_sums_and_mosts),
        cmocka_unit_test(failures_are_told),
        cmocka_unit_test(watched_pictures_are_drawn_in_parts),
        cmocka_unit_test(shares_are_those_of_the_strips),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
