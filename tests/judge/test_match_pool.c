/* Laws of ref/match/match.h about engines: opened once, failures kept apart. The engine here is
 * made up: it does what the test tells it. */
#include "ref/match/match.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/judge/made_up.h"

#include <stdio.h>
#include <string.h>

static void an_engine_is_opened_once_and_closed_once(void **state)
{
    (void)state;
    struct fixture *f = begin();
    for (unsigned i = 1; i <= 3; i++) {
        match_run(&f->match, &made_up, &f->row);
        assert_agrees(f);
        assert_int_equal(script.opened, 1);
        assert_int_equal(script.prepared, i); /* another layout could be packed by now */
    }
    assert_int_equal(f->row.memory_bytes, 77);
    assert_true(f->row.device_clock);
    assert_int_equal(script.closed, 0);
    pool_free(&f->pool);
    assert_int_equal(script.closed, 1);
    assert_int_equal(f->pool.count, 0);
    done(f);
    assert_int_equal(script.closed, 1);
}

static void a_pool_remembers_that_an_engine_cannot_run(void **state)
{
    (void)state;
    static const struct {
        enum status open;
        enum row_status row;
    } failures[] = {{STATUS_UNSUPPORTED, ROW_SKIPPED},
                    {STATUS_DEVICE, ROW_FAILED},
                    {STATUS_MEMORY, ROW_FAILED}};
    for (size_t i = 0; i < ARRAY_COUNT(failures); i++) {
        struct fixture *f = begin();
        script.open = failures[i].open;
        for (int again = 0; again < 3; again++) {
            match_run(&f->match, &made_up, &f->row);
            assert_int_equal(f->row.status, failures[i].row);
            assert_int_equal(f->row.cause, failures[i].open);
            assert_string_equal(f->row.reason.text, "made up: open");
            assert_int_equal(f->row.hits + f->row.compared + f->row.differences, 0);
        }
        assert_int_equal(script.opened, 1);
        assert_int_equal(script.prepared, 0);
        run(f, "cpu"); /* the others go on */
        assert_agrees(f);
        done(f);
        assert_int_equal(script.closed, 0);
    }
}

static void what_fails_later_is_told_apart(void **state)
{
    (void)state;
    static const struct {
        enum status prepare, trace;
        enum row_status row;
        const char *reason;
    } failures[] = {{STATUS_LIMIT, STATUS_OK, ROW_REFUSED, "made up: prepare"},
                    {STATUS_UNSUPPORTED, STATUS_OK, ROW_SKIPPED, "made up: prepare"},
                    {STATUS_DEVICE, STATUS_OK, ROW_FAILED, "made up: prepare"},
                    {STATUS_MEMORY, STATUS_OK, ROW_FAILED, "made up: prepare"},
                    {STATUS_OK, STATUS_DEVICE, ROW_FAILED, "made up: trace"},
                    {STATUS_OK, STATUS_MEMORY, ROW_FAILED, "made up: trace"}};
    struct fixture *f = begin();
    for (size_t i = 0; i < ARRAY_COUNT(failures); i++) {
        script.prepare = failures[i].prepare;
        script.trace = failures[i].trace;
        match_run(&f->match, &made_up, &f->row);
        assert_int_equal(f->row.status, failures[i].row);
        assert_int_equal(f->row.cause, failures[i].prepare | failures[i].trace);
        assert_string_equal(f->row.reason.text, failures[i].reason);
        assert_int_equal(f->row.differences + f->row.compared, 0);
    }
    script.prepare = script.trace = STATUS_OK; /* a failure is of its row only */
    match_run(&f->match, &made_up, &f->row);
    assert_agrees(f);
    done(f);
}

static void a_pool_holds_every_engine(void **state)
{
    (void)state;
    static struct engine many[POOL_MOST + 1];
    struct fixture *f = begin();
    enum status status;
    for (size_t i = 0; i < ARRAY_COUNT(many); i++) {
        many[i] = made_up;
        void *self = pool_get(&f->pool, &many[i], &status, &f->reason);
        assert_int_equal(status, i < POOL_MOST ? STATUS_OK : STATUS_LIMIT);
        assert_int_equal(self != NULL, i < POOL_MOST);
    }
    char most[40];
    snprintf(most, sizeof most, "more than %u engines", (unsigned)POOL_MOST);
    assert_non_null(strstr(f->reason.text, most));
    done(f);
    assert_int_equal(script.closed, POOL_MOST);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_engine_is_opened_once_and_closed_once),
        cmocka_unit_test(a_pool_remembers_that_an_engine_cannot_run),
        cmocka_unit_test(what_fails_later_is_told_apart),
        cmocka_unit_test(a_pool_holds_every_engine),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
