/* Laws of fuzz_shrink_apart: an engine that dies, hangs or takes all memory on some trials takes
 * no other along, and the trial that makes it do so is shrunk like any other. The engines are made
 * here. */
#define _GNU_SOURCE /* usleep */
#include "fuzz/shrink/shrink.h"

#include <setjmp.h>
#include <stdarg.h>
#include <cmocka.h>

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MIB ((size_t)1 << 20)

/* What the engine does with a trial of two or more triangles and a ray downwards. */
static enum apart_plan { PLAN_DIE, PLAN_EXIT, PLAN_HANG, PLAN_EAT, PLAN_MISS } plan;
static bool openable = true;
static struct job planned;

static enum status planned_open(const struct engine *engine, const struct engine_options *options,
                                void **self, struct reason *reason)
{
    (void)engine, (void)options;
    *self = &planned;
    return openable ? STATUS_OK : (fail)(reason, STATUS_UNSUPPORTED, "not here");
}

static enum status planned_prepare(void *self, const struct job *job, struct reason *reason)
{
    (void)self, (void)reason;
    planned = *job;
    return STATUS_OK;
}

static void eat(void)
{
    for (int i = 0; i < 64; i++) {
        volatile char *bytes = malloc(8 * MIB); /* otherwise clang takes nothing */
        for (size_t at = 0; bytes && at < 8 * MIB; at += 4096)
            bytes[at] = 1;
        usleep(10000);
    }
    pause();
}

static enum status planned_trace(void *self, const struct ray *ray, size_t count, struct hit *hit,
                                 struct trace_report *report, struct reason *reason)
{
    bool down = false;
    (void)self, (void)report, (void)reason;
    for (size_t i = 0; i < count; i++) {
        hit[i] = (struct hit){.prim = ABI_NO_PRIM};
        down = down || ray[i].dir[2] < 0;
    }
    uint32_t triangles = planned.scene->tri_count;
    if (plan == PLAN_MISS && triangles < 3 && triangles > 0)
        raise(SIGKILL); /* in the way of the shrinker, who looks for something else */
    if (!down || triangles < 2)
        return STATUS_OK;
    switch (plan) {
    case PLAN_DIE:
        raise(SIGKILL);
        break;
    case PLAN_EXIT:
        _exit(3);
    case PLAN_HANG:
        pause();
        break;
    case PLAN_EAT:
        eat();
        break;
    case PLAN_MISS:
        break;
    }
    return STATUS_OK;
}

static struct model planned_model(const struct engine *engine, void *self,
                                  const struct tri_test *tri)
{
    (void)engine, (void)self, (void)tri;
    return (struct model){.formula = TWIN_MT, .rounding = ROUNDING_IEEE};
}

static void planned_close(void *self)
{
    (void)self;
}

static void planned_describe(const struct engine *engine, const struct engine_options *options,
                             char *text, size_t bytes)
{
    (void)engine, (void)options;
    snprintf(text, bytes, "made for this test");
}

static const struct engine planned_engine = {.name = "planned",
                                             .open = planned_open,
                                             .prepare = planned_prepare,
                                             .trace = planned_trace,
                                             .model = planned_model,
                                             .close = planned_close,
                                             .describe = planned_describe};

static const char trial_text[] = "raydiff trial 1\n"
                                 "expect planned.-.%s\n"
                                 "with raydiff 0.0.1\n"
                                 "builder rtrs leaf 3 eps 0\n"
                                 "box watertight\ntri mt\nquery any\n"
                                 "vertices 5\n0 0 0\n3 0 0\n0 5 0\n0 0 7\n1 2 3\n"
                                 "triangles 5\n0 1 2\n1 2 3\n2 3 4\n0 1 4\n0 1 3\n"
                                 "rays 4\n"
                                 "1 1 9 0 0 1 0 100\n"
                                 "0.5 0.5 9 0 0 -3 0.5 100\n"
                                 "0.25 0.5 9 0 0 -3 0.5 1\n"
                                 "1 2 9 3 -2 1 0 100\nend\n";

static struct finding_file file_of(const char *expected)
{
    char text[1024];
    struct finding_file file;
    struct reason reason;
    int size = snprintf(text, sizeof text, trial_text, expected);
    if (finding_file_parse("made", text, (size_t)size, &file, &reason))
        fail_msg("%s", reason.text);
    return file;
}

static struct finding_file shrink(const struct shrink_apart *how, const struct finding_file *file,
                                  uint64_t asks, struct shrink_stats *stats)
{
    const struct shrink_options options = {.asks = asks};
    struct finding_file out;
    struct reason reason;
    if (fuzz_shrink_apart(how, file, &options, &out, stats, &reason))
        fail_msg("%s", reason.text);
    return out;
}

static void what_kills_an_engine_is_shrunk(void **state)
{
    (void)state;
    static const enum apart_plan plans[] = {PLAN_DIE, PLAN_EXIT};
    const struct shrink_apart how = {.who = {&planned_engine, NULL}, .ms = 20000};
    for (size_t i = 0; i < ARRAY_COUNT(plans); i++) {
        struct finding_file file = file_of("crash.unexplained");
        struct shrink_stats stats, again;
        plan = plans[i];
        struct finding_file out = shrink(&how, &file, 0, &stats);
        if (stats.end != SHRINK_FIXPOINT || stats.after.triangles != 2 || stats.after.rays != 1 ||
            stats.after.vertices != 1 || stats.after.bits > 2)
            fail_msg("case %zu: %s, %u triangles, %u rays, %u vertices, %u bits", i,
                     shrink_end_name(stats.end), stats.after.triangles, stats.after.rays,
                     stats.after.vertices, (unsigned)stats.after.bits);
        assert_true(out.trial.ray[0].dir[2] == -1.0f);
        assert_true(fuzz_signature_same(&stats.finding.signature, &file.signature));
        assert_non_null(strstr(out.versions, "planned: made for this test"));
        struct finding_file same = shrink(&how, &out, 0, &again);
        assert_int_equal(fuzz_trial_hash(&same.trial), fuzz_trial_hash(&out.trial));
        assert_int_equal(again.end, SHRINK_FIXPOINT);
        finding_file_free(&same);
        finding_file_free(&out);
        finding_file_free(&file);
    }
}

/* These take their time: a few asks tell. */
static void hanging_and_taking_all_memory_are_shrunk(void **state)
{
    (void)state;
    static const struct {
        enum apart_plan plan;
        const char *expected;
        uint32_t ms;
        uint64_t memory;
    } cases[] = {{PLAN_EAT, "crash.unexplained", 20000, 256 * MIB},
                 {PLAN_HANG, "hang.unexplained", 500, 0}};
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        const struct shrink_apart how = {
            .who = {&planned_engine, NULL}, .ms = cases[i].ms, .memory = cases[i].memory};
        struct finding_file file = file_of(cases[i].expected);
        struct shrink_stats stats;
        plan = cases[i].plan;
        struct finding_file out = shrink(&how, &file, 14, &stats);
        assert_int_equal(stats.end, SHRINK_OUT_OF_ASKS);
        assert_true(stats.accepted >= 2);
        assert_true(stats.after.rays < 4 || stats.after.triangles < 5);
        assert_true(stats.after.triangles >= 2);
        bool down = false;
        for (uint32_t k = 0; k < out.trial.ray_count; k++)
            down = down || out.trial.ray[k].dir[2] < 0;
        assert_true(down);
        assert_true(fuzz_signature_same(&stats.finding.signature, &file.signature));
        finding_file_free(&out);
        finding_file_free(&file);
    }
}

/* One triangle would do, but of those the engine dies. */
static void deadly_candidates_are_stepped_over(void **state)
{
    (void)state;
    const struct shrink_apart how = {.who = {&planned_engine, NULL}, .ms = 20000};
    struct finding_file file = file_of("missed.outside");
    struct shrink_stats stats;
    plan = PLAN_MISS;
    struct finding_file out = shrink(&how, &file, 0, &stats);
    assert_int_equal(stats.end, SHRINK_FIXPOINT);
    assert_int_equal(stats.after.triangles, 3);
    assert_int_equal(stats.after.rays, 1);
    assert_true(stats.after.bits < 20);
    assert_true(fuzz_signature_same(&stats.finding.signature, &file.signature));
    assert_int_equal(stats.finding.ray, 0);
    finding_file_free(&out);
    finding_file_free(&file);
}

static void what_does_not_happen_here_is_left_alone(void **state)
{
    (void)state;
    const struct shrink_apart how = {.who = {&planned_engine, NULL}, .ms = 20000};
    static const char *const others[] = {"hang.unexplained", "missed.outside", "crash.outside"};
    struct reason reason;
    plan = PLAN_DIE; /* a crash is no hang, and none that has a cause */
    for (size_t i = 0; i < ARRAY_COUNT(others); i++) {
        struct finding_file file = file_of(others[i]);
        struct shrink_stats stats;
        struct finding_file out = shrink(&how, &file, 0, &stats);
        assert_int_equal(stats.end, SHRINK_NOT_SHOWN);
        assert_int_equal(fuzz_trial_hash(&out.trial), fuzz_trial_hash(&file.trial));
        finding_file_free(&out);
        finding_file_free(&file);
    }
    struct finding_file file = file_of("crash.unexplained"), out;
    struct shrink_stats stats;
    const struct shrink_options options = {0};
    openable = false;
    assert_int_equal(fuzz_shrink_apart(&how, &file, &options, &out, &stats, &reason),
                     STATUS_UNSUPPORTED);
    assert_string_equal(reason.text, "not here");
    openable = true;
    const struct shrink_apart other = {.who = {engine_find("brute"), NULL}, .ms = 20000};
    assert_int_equal(fuzz_shrink_apart(&other, &file, &options, &out, &stats, &reason),
                     STATUS_INPUT);
    finding_file_free(&file);
}

/* The child's answers are those of a player in this process. */
static void apart_is_as_here(void **state)
{
    (void)state;
    static const char *const paths[] = {"fuzz/corpus/rounded-inward.trial",
                                        "fuzz/corpus/slot-not-read.trial",
                                        "fuzz/corpus/wrong-item.trial"};
    for (size_t i = 0; i < ARRAY_COUNT(paths); i++) {
        struct finding_file file, here;
        struct reason reason;
        const struct shrink_options options = {.asks = 500};
        struct shrink_stats stats[2];
        if (finding_file_read(paths[i], &file, &reason))
            fail_msg("%s", reason.text);
        const struct shrink_apart how = {.who = {engine_find("cpu"), file.signature.layout},
                                         .engines = {.device = -1, .threads = 1},
                                         .ms = 20000};
        const struct fuzz_field field = {.who = {how.who}, .count = 1, .options = how.engines};
        struct fuzz_player *player;
        struct finding_file out;
        if (fuzz_player_open(&field, &player, &reason) ||
            fuzz_shrink_finding(player, &file, &options, &here, &stats[0], &reason) ||
            fuzz_shrink_apart(&how, &file, &options, &out, &stats[1], &reason))
            fail_msg("%s", reason.text);
        assert_true(stats[0].accepted > 0);
        assert_int_equal(stats[0].asks, stats[1].asks);
        assert_int_equal(stats[0].accepted, stats[1].accepted);
        assert_int_equal(fuzz_trial_hash(&here.trial), fuzz_trial_hash(&out.trial));
        assert_int_equal(stats[0].finding.ray, stats[1].finding.ray);
        assert_memory_equal(&stats[0].finding.answer, &stats[1].finding.answer, sizeof(struct hit));
        fuzz_player_close(player);
        finding_file_free(&here);
        finding_file_free(&out);
        finding_file_free(&file);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_kills_an_engine_is_shrunk),
        cmocka_unit_test(hanging_and_taking_all_memory_are_shrunk),
        cmocka_unit_test(deadly_candidates_are_stepped_over),
        cmocka_unit_test(what_does_not_happen_here_is_left_alone),
        cmocka_unit_test(apart_is_as_here),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
