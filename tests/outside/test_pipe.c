/* Laws of engines "pipe:COMMAND" (ref/outside/pipe.h): a peer that keeps the protocol is an engine
 * like any other; whatever else it does is told in one line, ends the peer and nothing else, and
 * leaves no process behind. The peers are this program, run as `test_pipe --peer WHAT`. */
#define _GNU_SOURCE /* environ, usleep */
#include "ref/outside/pipe.h"
#include "ref/base/rng.h"
#include "ref/trace/trace.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"
#include "tests/outside/peers.h"
#include "ref/twin/model.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <cmocka.h>

#include "tests/outside/peer_engine.h"

#define RAYS 200

#include "tests/outside/pipe_stand.h"

/* Opens the peer, prepares and traces once; the first status that is not OK. */
static enum status play(const char *what, enum query query, uint32_t ms, struct hit hit[RAYS],
                        struct model *model, struct reason *reason)
{
    const struct engine *engine = peer_engine(what);
    struct engine_options options = {.peer_ms = ms, .peer_mb = UINT32_MAX};
    struct job job = job_of(query);
    struct trace_report report;
    void *self;
    enum status status = engine_open(engine, &options, &self, reason);
    if (status)
        return status;
    if (model)
        *model = engine_model(engine, self, job.tri);
    status = engine->prepare(self, &job, reason);
    if (!status)
        status = engine->trace(self, rays, RAYS, hit, &report, reason);
    if (!status && strcmp(what, "chatty") == 0)
        usleep(300000); /* so that it is there before the next request, not after it */
    if (!status)        /* again: what was left over is seen now */
        status = engine->trace(self, rays, RAYS, hit, &report, reason);
    engine->close(self);
    return status;
}

static void an_honest_peer_gives_the_bits_of_its_formula(void **state)
{
    (void)state;
    struct hit hit[RAYS], own;
    struct model model;
    struct reason reason = {""};
    size_t hits = 0;
    assert_int_equal(play("honest", QUERY_CLOSEST, 20000, hit, &model, &reason), STATUS_OK);
    assert_int_equal(model.formula, TWIN_UNKNOWN);
    for (size_t i = 0; i < RAYS; i++) {
        trace_brute(&scene, tri_test_find("mt"), QUERY_CLOSEST, &rays[i], &own);
        assert_memory_equal(&own, &hit[i], sizeof own);
        hits += own.prim != ABI_NO_PRIM;
    }
    assert_true(hits > RAYS / 4);
    must_have_no_children();
}

static void what_a_peer_says_of_itself_is_its_model(void **state)
{
    (void)state;
    struct hit hit[RAYS];
    struct model model;
    struct reason reason = {""};
    assert_int_equal(play("declared", QUERY_CLOSEST, 20000, hit, &model, &reason), STATUS_OK);
    assert_int_equal(model.formula, TWIN_MT);
    assert_true(model.rounding.tiny == 0x1p-126 && model.rounding.div == 1.0);
    assert_true(model.open && !model.watertight && model.any_unnamed);
    assert_int_equal(play("declared", QUERY_ANY, 20000, hit, &model, &reason), STATUS_OK);
    for (size_t i = 0; i < RAYS; i++) /* does not name its triangles */
        assert_true(hit[i].prim == 0 || hit[i].prim == ABI_NO_PRIM);
}

/* Every way to break the protocol, and its error. */
static const struct hostile {
    const char *what;
    enum status status;
    const char *said;
} hostile[] = {
    {"nothing", STATUS_DEVICE, "it ended with exit code 0 at a request without rays"},
    {"dies", STATUS_DEVICE, "it was ended by signal 9 after the answer to ray 16"},
    {"crashes", STATUS_DEVICE, "it was ended by signal 6 before the answer to ray 0"},
    {"exits", STATUS_DEVICE, "it ended with exit code 3 after the answer to ray 16"},
    {"closes", STATUS_DEVICE, "it closed its output after the answer to ray 16"},
    {"hangs", STATUS_DEVICE, "late: not done within 0.3 s, after the answer to ray 16"},
    {"sleeps", STATUS_DEVICE, "late: not done within 0.3 s, at a request without rays"},
    {"deaf", STATUS_DEVICE, "late: not done within 0.3 s, at a request without rays"},
    {"short", STATUS_DEVICE, "its answer is about 199 rays, not 200, from ray 0 on"},
    {"long", STATUS_DEVICE, "its answer is longer than 200 rays"},
    {"chatty", STATUS_DEVICE, "wrote more bytes after its previous answer"},
    {"endless", STATUS_DEVICE, "its answer begins with 'yes?', not with 'RDRA'"},
    {"endless_hits", STATUS_DEVICE, "its answer is longer than 200 rays"},
    {"text", STATUS_DEVICE, "its answer begins with 'Hell', not with 'RDRA'"},
    {"version", STATUS_DEVICE, "its answer is of version 7, not 1"},
    {"neither", STATUS_DEVICE, "status 5, not 0 (given) or 1 (refused)"},
    {"range", STATUS_DEVICE, "its answer to ray 17 names triangle 2048 of 2048"},
    {"nan_id", STATUS_DEVICE, "its answer to ray 17 names triangle 2143289344 of 2048"},
    {"stderr", STATUS_DEVICE, "must not write to its standard error; its standard error: oops"},
    {"stderr_dies", STATUS_DEVICE,
     "exit code 2 before the answer to ray 0; its standard error: no"},
    {"stderr_endless", STATUS_DEVICE, "its standard error: xxxxxx"},
    {"refuses", STATUS_REFUSED, "refused: only teapots"},
    {"refuses_long", STATUS_DEVICE, "its refusal is longer than 256 bytes"},
    {"formula", STATUS_DEVICE, "says of itself: formula 99 is not one of 0 to 7"},
    {"rounding", STATUS_DEVICE, "says of itself: rounding 5 is not one of 0 to 4"},
    {"flags", STATUS_DEVICE, "says of itself: flags 0x80 have more than"},
    {"fickle", STATUS_DEVICE, "now declares another formula, rounding or flags"},
};

static void whatever_a_peer_does_is_said_and_ends_only_the_peer(void **state)
{
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(hostile); i++) {
        const struct hostile *one = &hostile[i];
        struct hit hit[RAYS];
        struct reason reason = {""};
        bool late = strncmp(one->said, "late", 4) == 0;
        /* that is read until its time is over */
        bool endless = strcmp(one->what, "stderr_endless") == 0;
        uint32_t ms = late ? 300 : endless ? 1000 : 20000;
        enum status status = play(one->what, QUERY_CLOSEST, ms, hit, NULL, &reason);
        if (status != one->status || !strstr(reason.text, one->said) || strchr(reason.text, '\n'))
            fail_msg("%s: status %s, '%s'; not '%s'", one->what, status_text(status), reason.text,
                     one->said);
        must_have_no_children();
    }
    struct hit hit[RAYS]; /* and the next one is an engine as before */
    struct reason reason = {""};
    assert_int_equal(play("honest", QUERY_CLOSEST, 20000, hit, NULL, &reason), STATUS_OK);
}

/* t, u and v are for the judge: he has names for what is wrong with them. */
static void numbers_that_are_none_are_answers(void **state)
{
    (void)state;
    struct hit hit[RAYS];
    struct reason reason = {""};
    assert_int_equal(play("nan_t", QUERY_CLOSEST, 20000, hit, NULL, &reason), STATUS_OK);
    assert_int_equal(hit[17].prim, 0);
    assert_false(float_is_finite(hit[17].t));
    assert_int_equal(hit[16].prim, ABI_NO_PRIM); /* a miss with numbers in it */
    assert_true(hit[16].t == 0.0f && hit[16].u == 0.0f && hit[16].v == 0.0f);
}

static void a_peer_that_died_is_started_again(void **state)
{
    (void)state;
    const struct engine *engine = peer_engine("dies");
    struct engine_options options = {.peer_ms = 20000, .peer_mb = UINT32_MAX};
    struct job job = job_of(QUERY_CLOSEST);
    struct trace_report report;
    struct reason reason = {""};
    struct hit hit[RAYS];
    void *self;
    assert_int_equal(engine_open(engine, &options, &self, &reason), STATUS_OK);
    assert_int_equal(engine->prepare(self, &job, &reason), STATUS_OK);
    assert_int_equal(engine->trace(self, rays, RAYS, hit, &report, &reason), STATUS_DEVICE);
    assert_int_equal(setenv("PEER", "honest", 1), 0);
    assert_int_equal(engine->trace(self, rays, RAYS, hit, &report, &reason), STATUS_OK);
    assert_int_equal(engine->trace(self, rays, 0, hit, &report, &reason), STATUS_OK);
    engine->close(self);
    must_have_no_children();
}

/* A grandchild goes with its group: it would hold the pipe open for good. */
static void the_whole_group_is_killed(void **state)
{
    (void)state;
    struct hit hit[RAYS];
    struct reason reason = {""};
    char path[] = "/tmp/test_pipe_XXXXXX", line[32] = "";
    int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(setenv("PEER_FILE", path, 1), 0);
    assert_int_equal(play("forks", QUERY_CLOSEST, 300, hit, NULL, &reason), STATUS_DEVICE);
    assert_true(read(file, line, sizeof line - 1) > 0);
    pid_t grandchild = (pid_t)atol(line);
    assert_true(grandchild > 1);
    int tries = 0; /* whoever adopts it must reap it first */
    while (kill(grandchild, 0) == 0 && tries++ < 200) {
        char stat[64], text[256] = "";
        snprintf(stat, sizeof stat, "/proc/%ld/stat", (long)grandchild);
        FILE *from = fopen(stat, "r");
        if (from && fgets(text, sizeof text, from) && strstr(text, ") Z"))
            tries = 1000;
        if (from)
            fclose(from);
        usleep(10000);
    }
    assert_true(tries != 201);
    close(file);
    unlink(path);
    must_have_no_children();
}

static void sigpipe_stays_as_it_was(void **state)
{
    (void)state;
    struct sigaction action;
    sigset_t blocked, pending;
    struct hit hit[RAYS];
    struct reason reason = {""};
    assert_int_equal(play("nothing", QUERY_CLOSEST, 20000, hit, NULL, &reason), STATUS_DEVICE);
    assert_int_equal(sigaction(SIGPIPE, NULL, &action), 0);
    assert_true(action.sa_handler == SIG_DFL);
    assert_int_equal(sigprocmask(SIG_SETMASK, NULL, &blocked), 0);
    assert_int_equal(sigpending(&pending), 0);
    assert_false(sigismember(&blocked, SIGPIPE));
    assert_false(sigismember(&pending, SIGPIPE));
}

static void commands_that_are_not_there_cannot_run_here(void **state)
{
    (void)state;
    const struct engine *engine;
    struct reason reason = {""};
    void *self;
    assert_int_equal(pipe_engine("pipe:no-such-tracer-here", &engine, &reason), STATUS_OK);
    assert_int_equal(engine_open(engine, &(struct engine_options){0}, &self, &reason),
                     STATUS_UNSUPPORTED);
    assert_non_null(strstr(reason.text, "exit code 127"));
    assert_non_null(strstr(reason.text, "not found"));
    assert_null(self);
    must_have_no_children();
}

static void memory_is_limited(void **state)
{
    (void)state;
    const struct engine *engine;
    struct reason reason = {""};
    void *self;
    /* tail keeps its last line, and all of this is one */
    assert_int_equal(pipe_engine("pipe:head -c 999999999 /dev/zero | tail", &engine, &reason),
                     STATUS_OK);
    struct engine_options options = {.peer_ms = 60000, .peer_mb = 64};
    assert_int_equal(engine_open(engine, &options, &self, &reason), STATUS_DEVICE);
    assert_non_null(strstr(reason.text, "memory"));
}

static void names_are_checked_and_places_counted(void **state)
{
    (void)state;
    const struct engine *engine, *same;
    struct reason reason;
    char name[PIPE_NAME_MOST + 8];
    memset(name, 'x', sizeof name);
    memcpy(name, PIPE_PREFIX, strlen(PIPE_PREFIX));
    name[PIPE_NAME_MOST] = '\0';
    assert_int_equal(pipe_engine(name, &engine, &reason), STATUS_INPUT);
    assert_null(engine);
    assert_int_equal(pipe_engine("pipe:", &engine, &reason), STATUS_INPUT);
    assert_int_equal(pipe_engine("pip:x", &engine, &reason), STATUS_INPUT);
    name[PIPE_NAME_MOST - 1] = '\0';
    assert_int_equal(pipe_engine(name, &engine, &reason), STATUS_OK); /* the fourth */
    assert_int_equal(pipe_engine(name, &same, &reason), STATUS_OK);
    assert_ptr_equal(engine, same);
    assert_ptr_equal(engine_find(name), engine);
    assert_int_equal(pipe_engine("pipe:fifth", &engine, &reason), STATUS_LIMIT);
    assert_int_equal(pipe_engine("cpu", &engine, &reason), STATUS_OK);
}

/* Where the engines begin that stand behind a command: a list of them alone, whatever words the
 * command has. */
static void engines_behind_a_command_are_found(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        int at; /* of the comma, or -1 */
    } known[] = {
        {"pipe:./tracer", -1},
        {"pipe:./tracer,cpu", 13},
        {"pipe:./tracer -f 1,cpu", 18},
        {"pipe:./tracer -f 1,cpu,brute", 18},
        {"pipe:./tracer -f 1,2,brute", 20},
        {"pipe:./tracer cpu,x", -1},
        {"pipe:./tracer --on 'x,cpu'", -1},
        {"pipe:awk -F, -f t.awk", -1},
    };
    for (size_t i = 0; i < ARRAY_COUNT(known); i++) {
        const char *found = pipe_engines_behind(known[i].name);
        if ((found ? (int)(found - known[i].name) : -1) != known[i].at)
            fail_msg("%s", known[i].name);
    }
}

int main(int argc, char **argv)
{
    if (argc == 3 && strcmp(argv[1], "--peer") == 0)
        return peer_main(argv[2]);
    program = argv[0];
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_honest_peer_gives_the_bits_of_its_formula),
        cmocka_unit_test(what_a_peer_says_of_itself_is_its_model),
        cmocka_unit_test(whatever_a_peer_does_is_said_and_ends_only_the_peer),
        cmocka_unit_test(numbers_that_are_none_are_answers),
        cmocka_unit_test(a_peer_that_died_is_started_again),
        cmocka_unit_test(the_whole_group_is_killed),
        cmocka_unit_test(sigpipe_stays_as_it_was),
        cmocka_unit_test(commands_that_are_not_there_cannot_run_here),
        cmocka_unit_test(memory_is_limited),
        cmocka_unit_test(names_are_checked_and_places_counted),
        cmocka_unit_test(engines_behind_a_command_are_found),
    };
    return cmocka_run_group_tests(tests, make_scene, free_scene);
}
