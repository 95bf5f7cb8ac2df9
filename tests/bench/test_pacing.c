/* Frame pacing under a clock that the tests tell. */
#include "bench/frames/pacing.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

#define MS 1000000u /* ns */

/* 50 frames a second: 20 ms each. */
static struct pacing made(uint64_t now_ns)
{
    return pacing_make(50, now_ns);
}

static void the_first_frame_is_drawn(void **state)
{
    (void)state;
    struct pacing pacing = made(7);
    assert_true(pacing_begin(&pacing));
    pacing_end(&pacing);
    assert_false(pacing_begin(&pacing));
    assert_int_equal(pacing.frames, 1);
}

static void nothing_is_drawn_unless_something_changed(void **state)
{
    (void)state;
    struct pacing pacing = made(0);
    assert_true(pacing_begin(&pacing));
    pacing_end(&pacing);
    for (uint64_t now = 0; now < 1000u * MS; now += 5 * MS) {
        (void)pacing_tick(&pacing, now);
        assert_false(pacing_begin(&pacing));
    }
    pacing_touch(&pacing);
    assert_true(pacing_begin(&pacing));
    assert_int_equal(pacing.frames, 2);
}

/* What changes while a pass is in flight is drawn once it has ended, as one frame. */
static void one_pass_is_in_flight(void **state)
{
    (void)state;
    struct pacing pacing = made(0);
    assert_true(pacing_begin(&pacing));
    for (int i = 0; i < 5; i++) {
        pacing_touch(&pacing);
        assert_false(pacing_begin(&pacing));
    }
    pacing_end(&pacing);
    assert_true(pacing_begin(&pacing));
    pacing_end(&pacing);
    assert_false(pacing_begin(&pacing));
    assert_int_equal(pacing.frames, 2);
}

static void updates_come_at_the_frame_rate_and_lose_no_time(void **state)
{
    (void)state;
    struct pacing pacing = made(1000);
    double moved = 0;
    unsigned updates = 0;
    for (uint64_t now = 0; now <= 3000u * MS; now += 3 * MS) {
        double ms = pacing_tick(&pacing, 1000 + now);
        assert_true(ms == 0 || (ms >= 20 && ms < 20 + 3));
        updates += ms > 0;
        moved += ms;
    }
    assert_int_equal(updates, 3000 / 21); /* 7 ticks of 3 ms are the first beyond 20 */
    assert_true(fabs(moved - 21 * (double)updates) < 1e-6);
}

static void a_stall_counts_as_one_frame(void **state)
{
    (void)state;
    struct pacing pacing = made(0);
    assert_true(fabs(pacing_tick(&pacing, 200u * MS) - 200) < 1e-9); /* 10 frames: all of it */
    assert_true(fabs(pacing_tick(&pacing, 401u * MS) - 20) < 1e-9);  /* more: one */
    assert_true(fabs(pacing_tick(&pacing, 421u * MS) - 20) < 1e-9);  /* and nothing is owed */
}

/* However long it took, and whatever was owed before: an update pays all, and the next one is a
 * whole frame away. Without one all that has passed is owed. */
static void nothing_is_owed_after_an_update(void **state)
{
    (void)state;
    for (uint64_t before = 0; before < 20; before += 3)
        for (uint64_t passed = 0; passed < 700; passed++) {
            struct pacing pacing = made(9);
            const uint64_t now = 9 + (before + passed) * MS, all = before + passed;
            assert_true(pacing_tick(&pacing, 9 + before * MS) == 0);
            const double ms = pacing_tick(&pacing, now);
            const double whole = all < 20 ? 0 : all > 200 ? 20 : (double)all;
            assert_true(fabs(ms - whole) < 1e-9);
            assert_int_equal(pacing_idle_ns(&pacing, now), (all < 20 ? 20 - all : 20) * MS);
            assert_true(pacing_tick(&pacing, now) == 0);
            assert_int_equal(pacing_tick(&pacing, now + 19 * MS) > 0, all > 0 && all < 20);
        }
}

static void a_clock_that_goes_back_stands_still(void **state)
{
    (void)state;
    struct pacing pacing = made(100u * MS);
    assert_true(pacing_tick(&pacing, 50u * MS) == 0);
    assert_true(pacing_tick(&pacing, 60u * MS) == 0);
    assert_true(fabs(pacing_tick(&pacing, 71u * MS) - 21) < 1e-9);
}

static void idle_time_ends_with_the_frame(void **state)
{
    (void)state;
    struct pacing pacing = made(0);
    assert_int_equal(pacing_idle_ns(&pacing, 0), 20 * MS);
    (void)pacing_tick(&pacing, 5 * MS);
    assert_int_equal(pacing_idle_ns(&pacing, 12 * MS), 8 * MS);
    assert_int_equal(pacing_idle_ns(&pacing, 25 * MS), 0);
    assert_true(pacing_tick(&pacing, 12 * MS + pacing_idle_ns(&pacing, 12 * MS)) > 0);
}

static void any_rate_is_taken(void **state)
{
    (void)state;
    const double odd[] = {0, -1, (double)NAN};
    for (size_t i = 0; i < ARRAY_COUNT(odd); i++)
        assert_true(fabs(pacing_make(odd[i], 0).period_ns - 1e9 / 60) < 1e-6);
    assert_true(fabs(pacing_make(INFINITY, 0).period_ns - 1e9 / PACING_FPS_MOST) < 1e-6);
    for (double fps = 1; fps < 4 * PACING_FPS_MOST; fps += 9.5)
        assert_true(fabs(pacing_make(fps, 0).period_ns - 1e9 / fmin(fps, PACING_FPS_MOST)) < 1e-6);
    assert_true(fabs(pacing_make(0.5, 0).period_ns - 2e9) < 1e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_frame_is_drawn),
        cmocka_unit_test(nothing_is_drawn_unless_something_changed),
        cmocka_unit_test(one_pass_is_in_flight),
        cmocka_unit_test(updates_come_at_the_frame_rate_and_lose_no_time),
        cmocka_unit_test(a_stall_counts_as_one_frame),
        cmocka_unit_test(nothing_is_owed_after_an_update),
        cmocka_unit_test(a_clock_that_goes_back_stands_still),
        cmocka_unit_test(idle_time_ends_with_the_frame),
        cmocka_unit_test(any_rate_is_taken),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
