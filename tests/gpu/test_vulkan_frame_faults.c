/* Pictures on a device that fails, each call and some pixels in turn (tests/gpu/fake_vulkan.h). */
#include "tests/gpu/fake_engines.h"

static const enum frame_plan plans[] = {FRAME_WHOLE, FRAME_STEPS};

static void reset(bool shared, void (*run)(const struct fake_dispatch *))
{
    fake_reset();
    fake.run = run;
    if (!shared)
        fake.device[0].base.deviceType = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
}

static void every_call_of_a_picture_that_fails_is_a_status(void **state)
{
    (void)state;
    struct picture p = frame_picture(false);
    struct reason reason;
    for (int kind = 0; kind < 8; kind++) {
        const enum frame_plan plan = plans[kind & 1];
        uint32_t calls = 0;
        for (uint32_t at = 0; at <= calls; at++) {
            reset(kind & 2, all_drawn);
            fake.fail_at = at;
            fake.result = at % 2 ? VK_ERROR_OUT_OF_DEVICE_MEMORY : VK_ERROR_DEVICE_LOST;
            enum status status = frame_play(&p, kind & 4, plan, &reason);
            must_be_clean(fake.failed ? fake.failed : "a picture");
            calls = at ? calls : fake.calls;
            if (status != (at == 0 ? STATUS_OK : at % 2 ? STATUS_MEMORY : STATUS_DEVICE))
                fail_msg("call %u of %u, %s: status %d, '%s'", at, calls, fake.failed, (int)status,
                         reason.text);
        }
        assert_true(calls > 30);
    }
    picture_free(&p);
}

/* The colours are those of the device, and all opaque. */
static void pixels_are_those_of_the_device(void **state)
{
    (void)state;
    struct picture p = frame_picture(false);
    struct reason reason;
    for (int kind = 0; kind < 4; kind++) {
        reset(kind & 2, all_drawn);
        gpu_must(frame_play(&p, false, plans[kind & 1], &reason), &reason);
        for (size_t i = 0; i < FRAME_WIDTH * FRAME_HEIGHT; i++)
            assert_int_equal(p.frame.pixel[i], 0xFF030201u);
        assert_true(p.report.device_clock);
        assert_int_equal(p.report.flags, 0);
        assert_int_equal(p.report.ns % 4000, 0);
        assert_true(p.report.ns > 0);
    }
    picture_free(&p);
}

/* Submissions of the last frame. A batch of tiles begins one, and so many dispatches another. */
static struct {
    struct frame_push push; /* of the last dispatch */
    uint32_t in_batch, begun, batches, indirect;
} seen;

static void counted(const struct fake_dispatch *dispatch)
{
    struct frame_push push;
    memcpy(&push, dispatch->push, sizeof push);
    all_drawn(dispatch);
    if (push.serial != seen.push.serial)
        memset(&seen, 0, sizeof seen);
    if (seen.begun == 0 || push.first_tile != seen.push.first_tile ||
        push.first_row != seen.push.first_row) {
        seen.in_batch = 0;
        seen.batches++;
    }
    seen.begun += seen.in_batch++ % VK_SERIES_MAX == 0;
    /* Whoever draws a later ray has written how many groups have one: four numbers for each ray. */
    assert_int_equal(dispatch->groups == UINT32_MAX, push.ray > 0);
    assert_int_equal(push.ray > 0 ? dispatch->at : 0, 16 * push.ray);
    seen.indirect += push.ray > 0;
    seen.push = push;
}

/* However many tiles are drawn at once: 2000 ticks of 2 ns each. Where the device has no ticks, the
 * time is told as another clock's. */
static void a_frame_takes_what_its_submissions_take(void **state)
{
    (void)state;
    struct picture p = frame_picture(false);
    struct reason reason;
    for (uint32_t groups = 1; groups <= 64; groups *= 4)
        for (int kind = 0; kind < 4; kind++) {
            reset(kind & 2, counted);
            memset(&seen, 0, sizeof seen);
            fake.device[0].base.limits.maxComputeWorkGroupCount[0] = groups;
            gpu_must(frame_play(&p, false, plans[kind & 1], &reason), &reason);
            assert_true(groups > 16 || seen.batches > 1);
            assert_true(p.report.device_clock);
            assert_int_equal(p.report.ns, 4000 * seen.begun);
            assert_int_equal(seen.indirect > 0, plans[kind & 1] == FRAME_STEPS);
            fake.device[0].family[0].timestampValidBits = 0;
            gpu_must(frame_play(&p, false, plans[kind & 1], &reason), &reason);
            assert_false(p.report.device_clock);
        }
    picture_free(&p);
}

static uint32_t left_out, its_flags;
static bool of_before; /* it has the serial of the frame before */

static void all_but_one(const struct fake_dispatch *dispatch)
{
    struct frame_push push;
    memcpy(&push, dispatch->push, sizeof push);
    all_drawn(dispatch);
    const uint32_t serial = of_before ? push.serial - 1 : push.serial;
    const uint32_t pixel = (its_flags | serial << ABI_FLAG_BITS) << 24;
    const struct fake_part *pixels = &dispatch->part[ABI_BIND_PIXELS];
    memcpy(pixels->byte + pixels->offset + 4 * left_out, &pixel, 4);
}

/* In the corners and between, with the reason that it gives. One that is old gives none. */
static void pixel_that_is_not_done_is_named(void **state)
{
    (void)state;
    static const struct {
        uint32_t flags;
        const char *why;
    } causes[] = {{ABI_FLAG_EXHAUSTED | ABI_FLAG_STACK, "its traversal stack overran"},
                  {ABI_FLAG_EXHAUSTED | ABI_FLAG_VISITS, "it visited more nodes"},
                  {ABI_FLAG_EXHAUSTED | ABI_FLAG_LOOP, "the driver ended its loop"},
                  {0, "its invocation did not run to the end"}};
    static const uint32_t at[][2] = {{0, 0}, {39, 0}, {0, 49}, {39, 49}, {7, 20}};
    struct picture p = frame_picture(false);
    struct reason reason;
    for (size_t i = 0; i < ARRAY_COUNT(at); i++)
        for (size_t c = 0; c < ARRAY_COUNT(causes); c++)
            for (int old = 0; old < 2; old++) {
                char text[160];
                reset(true, all_but_one);
                left_out = FRAME_WIDTH * at[i][1] + at[i][0];
                its_flags = causes[c].flags;
                of_before = old;
                (void)snprintf(text, sizeof text, "the path of pixel %u,%u was not finished: %s",
                               at[i][0], at[i][1], causes[old ? 3 : c].why);
                assert_int_equal(frame_play(&p, false, FRAME_STEPS, &reason), STATUS_DEVICE);
                if (!strstr(reason.text, text))
                    fail_msg("'%s' is not '%s'", reason.text, text);
                assert_int_equal(p.report.flags, old ? 0 : its_flags);
                must_be_clean("a pixel");
            }
    picture_free(&p);
}

/* A loop that is cut in whole paths: they are drawn in steps, if the plan is the framer's. */
static void all_whole_ones_fail(const struct fake_dispatch *dispatch)
{
    if (fake.updates)
        all_drawn(dispatch);
    else
        all_but_one(dispatch);
}

static void paths_whose_loops_are_cut_are_drawn_in_steps(void **state)
{
    (void)state;
    struct picture p = frame_picture(false);
    struct reason reason;
    left_out = 17;
    of_before = false;
    for (int i = 0; i < 3; i++) {
        reset(true, all_whole_ones_fail);
        its_flags = ABI_FLAG_EXHAUSTED | (i == 1 ? ABI_FLAG_VISITS : ABI_FLAG_LOOP);
        enum status status = frame_play(&p, false, i == 2 ? FRAME_WHOLE : FRAME_AUTO, &reason);
        assert_int_equal(status, i ? STATUS_DEVICE : STATUS_OK);
        assert_int_equal(fake.updates > 0, i == 0);
        must_be_clean("steps");
    }
    picture_free(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_call_of_a_picture_that_fails_is_a_status),
        cmocka_unit_test(pixels_are_those_of_the_device),
        cmocka_unit_test(a_frame_takes_what_its_submissions_take),
        cmocka_unit_test(pixel_that_is_not_done_is_named),
        cmocka_unit_test(paths_whose_loops_are_cut_are_drawn_in_steps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
