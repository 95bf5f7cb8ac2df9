/* What was named must have answered: counts, lines and exit codes. */
#include "fuzz/campaign/campaign.h"
#include "ref/base/command.h"
#include "ref/match/turnout.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

static struct turnout turnout;

static void put(enum turnout_end end, size_t count, const char *reason)
{
    turnout_add(&turnout, "engine", "x", end, count, reason);
}

static int code_of(size_t answered, size_t refused, size_t skipped, size_t absent, size_t failed)
{
    turnout = (struct turnout){.count = 0};
    turnout_name(&turnout, "engine", "x");
    put(TURNOUT_ANSWERED, answered, "");
    put(TURNOUT_REFUSED, refused, "too large");
    put(TURNOUT_SKIPPED, skipped, "not with this");
    put(TURNOUT_ABSENT, absent, "no device");
    put(TURNOUT_FAILED, failed, "it died");
    return turnout_exit(&turnout);
}

static void who_answers_nothing_is_vacuous_and_who_cannot_run_here_is_skipped(void **state)
{
    (void)state;
    assert_int_equal(code_of(0, 0, 0, 0, 0), EXIT_MISMATCH);
    assert_int_equal(code_of(0, 116, 0, 0, 0), EXIT_MISMATCH);
    assert_int_equal(code_of(0, 0, 3, 0, 0), EXIT_MISMATCH);
    assert_int_equal(code_of(0, 0, 0, 0, 2), EXIT_MISMATCH);
    assert_int_equal(code_of(0, 0, 0, 5, 0), EXIT_SKIPPED);
    assert_int_equal(code_of(0, 1, 0, 5, 0), EXIT_MISMATCH);
    assert_int_equal(code_of(1, 0, 0, 0, 0), EXIT_AGREE);
    assert_int_equal(code_of(1, 0, 1000, 0, 0), EXIT_AGREE);
}

static void an_engine_that_refuses_all_but_a_tenth_answers_next_to_nothing(void **state)
{
    (void)state;
    assert_int_equal(code_of(1, 9, 0, 0, 0), EXIT_AGREE);
    assert_int_equal(code_of(1, 10, 0, 0, 0), EXIT_MISMATCH);
    assert_int_equal(code_of(10, 90, 0, 0, 0), EXIT_AGREE);
    assert_int_equal(code_of(10, 91, 0, 0, 0), EXIT_MISMATCH);
    turnout = (struct turnout){.count = 0}; /* a layout's limits are documented */
    turnout_name(&turnout, "layout", "l");
    turnout_add(&turnout, "layout", "l", TURNOUT_ANSWERED, 1, "");
    turnout_add(&turnout, "layout", "l", TURNOUT_REFUSED, 1000, "too large");
    assert_int_equal(turnout_exit(&turnout), EXIT_AGREE);
}

static void the_worst_of_all_counts_and_none_unnamed(void **state)
{
    (void)state;
    assert_int_equal(code_of(5, 0, 0, 0, 0), EXIT_AGREE);
    turnout_add(&turnout, "engine", "y", TURNOUT_REFUSED, 9, "");
    assert_int_equal(turnout.count, 1);
    turnout_name(&turnout, "layout", "x"); /* of another kind, of the same name */
    assert_int_equal(turnout_exit(&turnout), EXIT_MISMATCH);
    turnout_name(&turnout, "engine", "x"); /* twice is once */
    assert_int_equal(turnout.count, 2);
}

static void a_line_has_every_count_and_the_first_reason(void **state)
{
    char line[400];
    (void)state;
    (void)code_of(0, 2, 1, 0, 1);
    turnout_line(&turnout.one[0], line, sizeof line);
    assert_string_equal(line,
                        "answered 0 of 4, refused 2, skipped 1, failed 1: too large; vacuous: "
                        "nothing of it is tested");
    (void)code_of(3, 0, 0, 0, 0);
    turnout_line(&turnout.one[0], line, sizeof line);
    assert_string_equal(line, "answered 3 of 3");
    (void)code_of(3, 0, 0, 0, 0);
    turnout_line(&turnout.one[0], line, 8);
    assert_string_equal(line, "answere");
}

static void rows_count_for_who_refused(void **state)
{
    static const struct engine engine = {.name = "x"};
    static const struct layout layout = {.name = "l"};
    struct row row = {.engine = &engine, .layout = &layout, .status = ROW_REFUSED};
    (void)state;
    turnout = (struct turnout){.count = 0};
    turnout_name(&turnout, "engine", "x");
    turnout_name(&turnout, "layout", "l");
    turnout_row(&turnout, &row); /* the layout refuses: the engine is not asked */
    assert_int_equal(turnout_asked(&turnout.one[0]), 0);
    assert_int_equal(turnout.one[1].end[TURNOUT_REFUSED], 1);
    row.declined = true; /* the engine does */
    turnout_row(&turnout, &row);
    assert_int_equal(turnout.one[0].end[TURNOUT_REFUSED], 1);
    assert_int_equal(turnout.one[1].end[TURNOUT_REFUSED], 1);
    row.status = ROW_SKIPPED;
    row.absent = true;
    turnout_row(&turnout, &row);
    assert_int_equal(turnout.one[0].end[TURNOUT_ABSENT], 1);
    row.status = ROW_OK;
    turnout_row(&turnout, &row);
    assert_int_equal(turnout.one[0].end[TURNOUT_ANSWERED], 1);
    assert_int_equal(turnout.one[1].end[TURNOUT_ANSWERED], 1);
}

static void a_campaign_counts_right_hits_and_not_misses_alone(void **state)
{
    struct campaign_view view = {.trials = 0};
    (void)state;
    view.turnout[0] = (struct campaign_turnout){.played = 100, .proved = 90};
    view.turnout[1] = (struct campaign_turnout){.declined = 100};
    view.turnout[2] = (struct campaign_turnout){.played = 3, .declined = 7};
    view.turnout[3] = (struct campaign_turnout){.played = 9, .declined = 91, .proved = 9};
    for (uint32_t before = 0; before <= 100; before++) { /* of the 100; all: nothing was left */
        view.before = before;
        view.trials = 100 - before;
        view.turnout_unknown = false;
        assert_null(campaign_vacuous(&view, 0));
        assert_string_equal(campaign_vacuous(&view, 1), "it answered none of the trials");
        assert_string_equal(campaign_vacuous(&view, 2), "it gave no right hit in any trial");
        assert_string_equal(campaign_vacuous(&view, 3), "it refused nearly all trials");
        view.turnout_unknown = true; /* earlier runs did not count */
        assert_null(campaign_vacuous(&view, 1));
    }
    view = (struct campaign_view){.trials = 0};
    assert_null(campaign_vacuous(&view, 1)); /* the campaign is vacuous, no member is */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(who_answers_nothing_is_vacuous_and_who_cannot_run_here_is_skipped),
        cmocka_unit_test(an_engine_that_refuses_all_but_a_tenth_answers_next_to_nothing),
        cmocka_unit_test(the_worst_of_all_counts_and_none_unnamed),
        cmocka_unit_test(a_line_has_every_count_and_the_first_reason),
        cmocka_unit_test(rows_count_for_who_refused),
        cmocka_unit_test(a_campaign_counts_right_hits_and_not_misses_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
