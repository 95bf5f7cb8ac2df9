/* Engine "pipe:COMMAND" on peers that fail later: in a request behind the first, or one after
 * another. */
#define _GNU_SOURCE /* setenv, usleep */
#include "tests/outside/peers.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <cmocka.h>

#include "tests/outside/peer_engine.h"

#define RAYS 200

#include "tests/outside/pipe_stand.h"

/* Rays are sent in several requests; what a later one fails at is told by its place among all. */
static void places_are_counted_over_all_requests(void **state)
{
    (void)state;
    const size_t count = ((size_t)1 << 18) + RAYS, at = ((size_t)1 << 18) + 16;
    struct ray *many = calloc(count, sizeof *many);
    struct hit *hit = calloc(count, sizeof *hit);
    struct scene one;
    assert_true(many && hit);
    for (size_t i = 0; i < count; i++)
        many[i] = rays[i % RAYS];
    assert_int_equal(scene_make(3, 1, &one), STATUS_OK);
    for (uint32_t c = 0; c < 3; c++) {
        one.index[c] = c;
        one.vertex[4 * c] = 1;
    }
    static const struct {
        const char *what, *said;
        enum engine_fault fault;
    } later[] = {{"exits_again", "after the answer to ray 262160", ENGINE_ENDED},
                 {"range_again", "to ray 262161 names triangle 1 of 1", ENGINE_NONSENSE}};
    for (size_t i = 0; i < ARRAY_COUNT(later); i++) {
        const struct engine *engine = peer_engine(later[i].what);
        struct engine_options options = {.peer_ms = 60000, .peer_mb = UINT32_MAX};
        struct job job = job_of(QUERY_CLOSEST);
        struct trace_report report;
        struct reason reason = {""};
        size_t told = 0;
        void *self;
        job.scene = &one;
        assert_int_equal(engine_open(engine, &options, &self, &reason), STATUS_OK);
        assert_int_equal(engine->prepare(self, &job, &reason), STATUS_OK);
        assert_int_equal(engine->trace(self, many, count, hit, &report, &reason), STATUS_DEVICE);
        if (!strstr(reason.text, later[i].said))
            fail_msg("%s: '%s'", later[i].what, reason.text);
        assert_int_equal(engine->fault(self, &told), later[i].fault);
        assert_int_equal(told, at + 1);
        engine->close(self);
    }
    scene_free(&one);
    free(many);
    free(hit);
}

/* How a call failed is told of the last one, whatever those before did. */
static void a_fault_is_that_of_the_last_call(void **state)
{
    (void)state;
    static const struct {
        const char *what;
        enum engine_fault fault;
    } turns[] = {{"hangs", ENGINE_LATE},   {"range", ENGINE_NONSENSE}, {"exits", ENGINE_ENDED},
                 {"hangs", ENGINE_LATE},   {"exits", ENGINE_ENDED},    {"range", ENGINE_NONSENSE},
                 {"exits", ENGINE_ENDED},  {"long", ENGINE_NONSENSE},  {"hangs", ENGINE_LATE},
                 {"long", ENGINE_NONSENSE}};
    const struct engine *engine = peer_engine(turns[0].what);
    struct engine_options options = {.peer_ms = 400, .peer_mb = UINT32_MAX};
    struct job job = job_of(QUERY_CLOSEST);
    struct trace_report report;
    struct reason reason = {""};
    struct hit hit[RAYS];
    size_t ray;
    void *self;
    assert_int_equal(engine_open(engine, &options, &self, &reason), STATUS_OK);
    assert_int_equal(engine->prepare(self, &job, &reason), STATUS_OK);
    for (size_t i = 0; i < ARRAY_COUNT(turns); i++) { /* each ends the process: another begins */
        assert_int_equal(setenv("PEER", turns[i].what, 1), 0);
        assert_int_equal(engine->trace(self, rays, RAYS, hit, &report, &reason), STATUS_DEVICE);
        if (engine->fault(self, &ray) != turns[i].fault)
            fail_msg("turn %zu, %s: %s", i, turns[i].what, reason.text);
    }
    engine->close(self);
    must_have_no_children();
}

int main(int argc, char **argv)
{
    if (argc == 3 && strcmp(argv[1], "--peer") == 0)
        return peer_main(argv[2]);
    program = argv[0];
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places_are_counted_over_all_requests),
        cmocka_unit_test(a_fault_is_that_of_the_last_call),
    };
    return cmocka_run_group_tests_name("pipe_later", tests, make_scene, free_scene);
}
