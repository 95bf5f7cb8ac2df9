/* Names of trials: each field that nothing has is refused by its own name, whatever the others are;
 * a name that is right is printed again as it was. */
#include "cmd/conform/cmd_trial.h"
#include "cmd/conform/cmd_world_trial.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

/* A field of a name, what it is called, and what stands in its place there. */
struct wrong_field {
    size_t field;
    const char *text, *told;
};

typedef enum status parse(const char *name, char again[TRIAL_NAME_MOST], struct reason *reason);

static enum status parse_scene(const char *name, char again[TRIAL_NAME_MOST], struct reason *reason)
{
    struct trial trial;
    const enum status status = trial_parse(name, &trial, reason);
    if (!status)
        trial_print(&trial, again);
    return status;
}

static enum status parse_world(const char *name, char again[TRIAL_NAME_MOST], struct reason *reason)
{
    struct world_trial trial;
    const enum status status = world_trial_parse(name, &trial, reason);
    if (!status)
        world_trial_print(&trial, again);
    return status;
}

/* Puts `text` in the place of field `at`. */
static void with(const char *name, size_t at, const char *text, char out[TRIAL_NAME_MOST])
{
    size_t used = 0, field = 0;
    for (const char *from = name; from; field++) {
        const char *dot = strchr(from, '.');
        const int length = (int)(dot ? dot - from : (ptrdiff_t)strlen(from));
        used +=
            (size_t)snprintf(out + used, TRIAL_NAME_MOST - used, "%s%.*s", field ? "." : "",
                             field == at ? (int)strlen(text) : length, field == at ? text : from);
        from = dot ? dot + 1 : NULL;
    }
    assert_true(at < field);
}

static void check(parse *parsed, const char *name, const struct wrong_field *spoilt, size_t count)
{
    char again[TRIAL_NAME_MOST], wrong[TRIAL_NAME_MOST];
    struct reason reason = {""};
    assert_int_equal(parsed(name, again, &reason), STATUS_OK);
    assert_string_equal(again, name);
    for (size_t i = 0; i < count; i++) {
        with(name, spoilt[i].field, spoilt[i].text, wrong);
        assert_int_equal(parsed(wrong, again, &reason), STATUS_INPUT);
        assert_string_equal(reason.text, spoilt[i].told);
    }
}

static void a_wrong_field_of_a_scene_is_named(void **state)
{
    (void)state;
    static const struct wrong_field packed[] = {{0, "far", "trial: unknown query 'far'"},
                                                {1, "cpo", "trial: unknown engine 'cpo'"},
                                                {2, "f31", "trial: unknown layout 'f31'"},
                                                {2, "f32:tape", "trial: unknown storage 'tape'"},
                                                {3, "mode", "trial: unknown builder 'mode'"},
                                                {4, "slack", "trial: unknown box test 'slack'"},
                                                {5, "mm", "trial: unknown triangle test 'mm'"},
                                                {7, "dim", "trial: unknown ray set 'dim'"},
                                                {8, "1x", "trial: seed '1x' is not a number"},
                                                {8, "x", "trial: seed 'x' is not a number"},
                                                {8, "", "trial: seed '' is not a number"}};
    static const struct wrong_field bare[] = {
        {2, "f32", "trial: engine brute takes '-', not 'f32'"},
        {3, "median", "trial: engine brute takes '-', not 'median'"},
        {4, "rtrs", "trial: engine brute takes '-', not 'rtrs'"},
        {5, "-", "trial: unknown triangle test '-'"}};
    check(parse_scene, "any.cpu.f32:compact.sbvh.robust.mt.soup:n=9,size=0.5.random.7", NULL, 0);
    check(parse_scene, "closest.cpu.f32.median.robust.mt.soup.random.1", packed,
          sizeof packed / sizeof packed[0]);
    check(parse_scene, "closest.brute.-.-.-.mt.soup.random.1", bare, sizeof bare / sizeof bare[0]);
}

static void a_wrong_field_of_a_world_is_named(void **state)
{
    (void)state;
    static const struct wrong_field packed[] = {{1, "far", "trial: unknown query 'far'"},
                                                {2, "cpo", "trial: unknown engine 'cpo'"},
                                                {3, "f31", "trial: unknown layout 'f31'"},
                                                {3, "f31/f32", "trial: unknown layout 'f31'"},
                                                {3, "f32/f31", "trial: unknown layout 'f31'"},
                                                {4, "mode", "trial: unknown builder 'mode'"},
                                                {4, "mode/rtrs", "trial: unknown builder 'mode'"},
                                                {4, "rtrs/mode", "trial: unknown builder 'mode'"},
                                                {5, "slack", "trial: unknown box test 'slack'"},
                                                {6, "mm", "trial: unknown triangle test 'mm'"},
                                                {14, "1x", "trial: seed '1x' is not a number"},
                                                {14, "", "trial: seed '' is not a number"}};
    static const struct wrong_field bare[] = {
        {3, "f32", "trial: engine brute takes '-', not 'f32'"},
        {4, "rtrs", "trial: engine brute takes '-', not 'rtrs'"},
        {5, "rtrs", "trial: engine brute takes '-', not 'rtrs'"}};
    check(parse_world,
          "world.any.cpu.f32/rf16.median.robust.mt.identity.all.none.opaque.all.none.1.3", NULL, 0);
    check(parse_world,
          "world.closest.cpu.f32.median.robust.mt.identity.all.none.opaque.all.none.1.1", packed,
          sizeof packed / sizeof packed[0]);
    check(parse_world, "world.closest.brute.-.-.-.mt.identity.all.none.opaque.all.none.1.1", bare,
          sizeof bare / sizeof bare[0]);
}

/* Nothing is cut: the longest name is read to its end, and the next is refused for its length. */
static void a_name_too_long_is_refused_for_that(void **state)
{
    (void)state;
    char name[TRIAL_NAME_MOST + 1], told[80];
    struct reason reason = {""};
    char again[TRIAL_NAME_MOST];
    parse *const each[] = {parse_scene, parse_world};
    snprintf(told, sizeof told, "trial: a name has at most %d characters", TRIAL_NAME_MOST - 1);
    for (size_t i = 0; i < sizeof each / sizeof each[0]; i++) {
        memset(name, 'a', sizeof name);
        name[TRIAL_NAME_MOST] = '\0';
        assert_int_equal(each[i](name, again, &reason), STATUS_INPUT);
        assert_string_equal(reason.text, told);
        name[TRIAL_NAME_MOST - 1] = '\0';
        assert_int_equal(each[i](name, again, &reason), STATUS_INPUT);
        assert_string_not_equal(reason.text, told);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_wrong_field_of_a_scene_is_named),
        cmocka_unit_test(a_wrong_field_of_a_world_is_named),
        cmocka_unit_test(a_name_too_long_is_refused_for_that),
    };
    return cmocka_run_group_tests_name("names of trials", tests, NULL, NULL);
}
