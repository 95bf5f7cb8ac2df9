/* Laws of tracers from outside as engines (ref/guest/): in a process of its own and inside a guest
 * is given the same bytes and gives the same bits; whatever else it does is told in one line, and
 * in a process of its own ends that and nothing else. This program is the host. */
#define _GNU_SOURCE /* setenv */
#include "tests/guest/guest_scene.h"

#include "scenes/rays/world_rays.h"
#include "scenes/worlds.h"

#include <errno.h>
#include <sys/wait.h>

struct guest_play {
    const char *file;
    bool inside;
    enum query query;
    uint32_t ms, mb;
};

struct guest_played {
    struct hit hit[RAYS];
    struct model model;
    struct trace_report report;
    enum engine_fault fault;
    size_t ray;
    struct reason reason;
};

/* Opens, prepares and traces; the first status that is not OK. */
static enum status play(const struct guest_play *how, struct guest_played *out)
{
    const struct engine *engine = engine_way(how->file, how->inside);
    const struct engine_options options = {
        .threads = 3, .peer_ms = how->ms ? how->ms : 20000, .peer_mb = how->mb};
    const struct job job = {.scene = &scene, .tri = tri_test_find("mt"), .query = how->query};
    void *self;
    *out = (struct guest_played){.ray = 0};
    enum status status = engine_open(engine, &options, &self, &out->reason);
    if (status)
        return status;
    out->model = engine_model(engine, self, job.tri);
    status = engine->prepare(self, &job, &out->reason);
    if (!status)
        status = engine->trace(self, rays, RAYS, out->hit, &out->report, &out->reason);
    if (engine->fault)
        out->fault = engine->fault(self, &out->ray);
    engine->close(self);
    return status;
}

static void a_sample_gives_the_same_bits_in_both_ways(void **state)
{
    (void)state;
    for (enum query query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
        struct guest_played apart, inside;
        size_t hits = 0;
        assert_int_equal(play(&(struct guest_play){"guest_brute.so", false, query, 0, 0}, &apart),
                         0);
        assert_int_equal(play(&(struct guest_play){"guest_brute.so", true, query, 0, 0}, &inside),
                         0);
        assert_memory_equal(apart.hit, inside.hit, sizeof apart.hit);
        assert_int_equal(apart.model.formula, TWIN_UNKNOWN);
        for (size_t i = 0; i < RAYS; i++)
            hits += apart.hit[i].prim != ABI_NO_PRIM;
        assert_true(hits > RAYS / 4 && hits < RAYS);
    }
}

/* The guest "good" answers with what it was given. */
static void must_hold_what_was_given(const struct guest_played *played, enum query query)
{
    for (uint32_t i = 0; i < RAYS; i++) {
        const uint32_t tri = i % scene.tri_count;
        struct hit want = {scene.vertex[3 * scene.index[3 * tri]] + rays[i].org[0],
                           rays[i].dir[2] + (float)scene.vertex_count + 1000 * (float)query,
                           rays[i].tmax + 3.0f, tri};
        if (i % 3 == 1)
            want = (struct hit){.prim = ABI_NO_PRIM};
        assert_memory_equal(&want, &played->hit[i], sizeof want);
    }
}

static void a_guest_is_given_scene_rays_query_and_threads(void **state)
{
    (void)state;
    struct guest_played played;
    behave("good");
    for (enum query query = QUERY_CLOSEST; query <= QUERY_ANY; query++)
        for (int inside = 0; inside < 2; inside++) {
            assert_int_equal(
                play(&(struct guest_play){"guest_bad.so", inside, query, 0, 0}, &played), 0);
            must_hold_what_was_given(&played, query);
            assert_true(played.report.core_ns > 0);
        }
    behave("only_closest"); /* the nearest hit is any hit */
    for (int inside = 0; inside < 2; inside++) {
        assert_int_equal(
            play(&(struct guest_play){"guest_bad.so", inside, QUERY_ANY, 0, 0}, &played), 0);
        must_hold_what_was_given(&played, QUERY_CLOSEST);
    }
}

/* Making and reading take 20 ms each. Beside tracing of 200 ms they are conversions, which are not
 * timed; where nothing is left to tracing they are what is timed. */
static void conversions_are_not_timed_and_tracing_in_them_is(void **state)
{
    (void)state;
    struct guest_played played;
    for (int early = 0; early < 2; early++) {
        behave(early ? "slow_rays" : "slow_rays_and_trace");
        const uint64_t start = time_ns();
        assert_int_equal(
            play(&(struct guest_play){"guest_bad.so", true, QUERY_CLOSEST, 0, 0}, &played), 0);
        const uint64_t all = time_ns() - start, ms = 1000000u;
        assert_true(all >= (early ? 40 : 240) * ms);
        if (early)
            assert_true(played.report.ns >= 39 * ms);
        else
            assert_true(played.report.ns >= 200 * ms && played.report.ns <= all - 39 * ms);
    }
}

static void models_are_taken_or_refused(void **state)
{
    (void)state;
    static const struct {
        const char *what, *text;
    } bad[] = {{"model_formula", "formula 8 is not one of 0 to 7"},
               {"model_flags", "have more than"},
               {"model_both", "displacement 7 beside a formula"},
               {"model_endless", "displacement 1e+30 is not above 0"},
               {"model_generous", "displacement 8193 is not above 0, at most 8192"}};
    struct guest_played played;
    for (int inside = 0; inside < 2; inside++) {
        const struct guest_play how = {"guest_bad.so", inside, QUERY_ANY, 0, 0};
        behave("model");
        assert_int_equal(play(&how, &played), STATUS_OK);
        assert_int_equal(played.model.formula, TWIN_WOOP);
        assert_true(played.model.watertight && !played.model.open);
        assert_true(played.model.rounding.tiny == 0x1p-126);
        behave("model_displacement");
        assert_int_equal(play(&how, &played), STATUS_OK);
        assert_true(played.model.displacement == 7.0);
        behave("model_unnamed");
        assert_int_equal(play(&how, &played), STATUS_OK);
        assert_true(played.model.any_unnamed);
        assert_memory_equal(&played.hit[3], &(struct hit){.prim = 0}, sizeof(struct hit));
        for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
            behave(bad[i].what);
            assert_int_equal(play(&how, &played), STATUS_DEVICE);
            if (!strstr(played.reason.text, bad[i].text))
                fail_msg("%s: %s", bad[i].what, played.reason.text);
        }
    }
}

struct guest_fate {
    const char *what;
    enum status status, inside; /* inside: STATUS_OK where it is not played */
    enum engine_fault fault;
    const char *text; /* "|": what stands behind it is of the process of its own alone */
};

static const struct guest_fate fates[] = {
    {"open_refuses", STATUS_UNSUPPORTED, STATUS_UNSUPPORTED, ENGINE_FINE, "refused: no such card"},
    {"open_memory", STATUS_DEVICE, STATUS_MEMORY, ENGINE_FINE, "open() has no memory: of the card"},
    {"open_fails", STATUS_DEVICE, STATUS_DEVICE, ENGINE_FINE, "open() failed: the card is hot"},
    {"open_nothing", STATUS_DEVICE, STATUS_DEVICE, ENGINE_FINE, "open() succeeded and gave no"},
    {"build_refuses", STATUS_REFUSED, STATUS_REFUSED, ENGINE_NONSENSE, "bad.so refused: more than"},
    {"build_fails", STATUS_DEVICE, STATUS_DEVICE, ENGINE_ENDED, "build() failed: the tree fell"},
    {"build_99", STATUS_DEVICE, STATUS_DEVICE, ENGINE_ENDED, "build() returned 99, which is no"},
    {"trace_memory", STATUS_DEVICE, STATUS_MEMORY, ENGINE_ENDED, "has no memory: for a stack"},
    {"trace_fails", STATUS_DEVICE, STATUS_DEVICE, ENGINE_ENDED, "failed: without a reason"},
    {"beyond", STATUS_DEVICE, STATUS_DEVICE, ENGINE_NONSENSE, "its answer to ray 5 names triangle"},
    {"lazy", STATUS_DEVICE, STATUS_OK, ENGINE_NONSENSE, "its answer to ray 0 names triangle"},
    {"crash", STATUS_DEVICE, STATUS_OK, ENGINE_ENDED,
     "it was ended by signal 11 before the answer"},
    {"exit", STATUS_DEVICE, STATUS_OK, ENGINE_ENDED, "it ended with exit code 9 before the answer"},
#ifndef __SANITIZE_ADDRESS__ /* which has no memory left to tell so, and hangs */
    {"memory", STATUS_DEVICE, STATUS_OK, ENGINE_ENDED,
     "it was ended by signal 6 before the answer"},
#endif
    {"hang", STATUS_DEVICE, STATUS_OK, ENGINE_LATE, "late: not done within "},
    {"complains", STATUS_DEVICE, STATUS_OK, ENGINE_NONSENSE, "standard error: something is odd"},
    {"talks", STATUS_OK, STATUS_OK, ENGINE_NONSENSE, ""},
    {"good", STATUS_OK, STATUS_OK, ENGINE_NONSENSE, ""},
};

/* Each is followed by others, which are not disturbed by it. */
static void whatever_a_guest_does_is_told(void **state)
{
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(fates); i++)
        for (int inside = 0; inside < 2; inside++) {
            const struct guest_fate *fate = &fates[i];
            const struct guest_play how = {"guest_bad.so", inside, QUERY_CLOSEST,
                                           fate->fault == ENGINE_LATE ? 500 : 0, 64};
            struct guest_played played;
            if (inside && !fate->inside)
                continue;
            behave(fate->what);
            enum status status = play(&how, &played);
            if (status != (inside ? fate->inside : fate->status) ||
                !strstr(played.reason.text, fate->text) ||
                (status && !strstr(played.reason.text, "guest_bad.so")))
                fail_msg("%s, %s: status %d, '%s'", fate->what, inside ? "inside" : "apart", status,
                         played.reason.text);
            if (!inside && status == STATUS_DEVICE && fate->fault != ENGINE_FINE) {
                assert_int_equal(played.fault, fate->fault);
                assert_int_equal(played.ray, strcmp(fate->what, "beyond") == 0 ? 5 : 0);
            }
            if (!inside) { /* no process is left */
                assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
                assert_int_equal(errno, ECHILD);
            }
        }
}

static void an_engine_lives_on_after_a_crash(void **state)
{
    (void)state;
    const struct engine *engine = engine_way("guest_bad.so", false);
    const struct engine_options options = {.peer_ms = 20000, .peer_mb = UINT32_MAX};
    const struct job job = {.scene = &scene, .tri = tri_test_find("mt")};
    struct hit hit[RAYS];
    struct trace_report report;
    struct reason reason = {""};
    void *self;
    behave("crash");
    assert_int_equal(engine_open(engine, &options, &self, &reason), STATUS_OK);
    assert_int_equal(engine->prepare(self, &job, &reason), STATUS_OK);
    assert_int_equal(engine->trace(self, rays, RAYS, hit, &report, &reason), STATUS_DEVICE);
    behave("good");
    assert_int_equal(engine->trace(self, rays, RAYS, hit, &report, &reason), STATUS_OK);
    assert_int_equal(hit[3].prim, 3 % scene.tri_count);
    engine->close(self);
}

/* What it refuses is that scene alone, whatever it was given before. */
static void a_refusal_is_of_one_scene(void **state)
{
    (void)state;
    static const struct {
        bool large;
        const char *text;
    } turns[] = {{false, ""}, {true, "over 100 triangles"}, {true, "over 100 triangles"},
                 {false, ""}, {true, "over 100 triangles"}, {false, ""}};
    struct scene small;
    struct reason reason = {""};
    if (scene_open("sphere:n=2", 1, &small, &reason))
        fail_msg("%s", reason.text);
    assert_true(small.tri_count <= 100 && scene.tri_count > 100);
    behave("build_bounded");
    for (int inside = 0; inside < 2; inside++) {
        const struct engine *engine = engine_way("guest_bad.so", inside);
        const struct engine_options options = {.peer_ms = 20000, .peer_mb = UINT32_MAX};
        void *self;
        assert_int_equal(engine_open(engine, &options, &self, &reason), STATUS_OK);
        for (size_t i = 0; i < ARRAY_COUNT(turns); i++) {
            const struct scene *of = turns[i].large ? &scene : &small;
            const struct job job = {.scene = of, .tri = tri_test_find("mt")};
            struct hit hit[RAYS];
            struct trace_report report;
            enum status status = engine->prepare(self, &job, &reason);
            assert_int_equal(status, turns[i].large ? STATUS_REFUSED : STATUS_OK);
            if (turns[i].large) {
                assert_non_null(strstr(reason.text, turns[i].text));
                continue;
            }
            assert_int_equal(engine->trace(self, rays, RAYS, hit, &report, &reason), STATUS_OK);
            for (uint32_t k = 0; k < RAYS; k++)
                assert_int_equal(hit[k].prim, k % 3 == 1 ? ABI_NO_PRIM : k % of->tri_count);
        }
        engine->close(self);
    }
    scene_free(&small);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sample_gives_the_same_bits_in_both_ways),
        cmocka_unit_test(a_guest_is_given_scene_rays_query_and_threads),
        cmocka_unit_test(conversions_are_not_timed_and_tracing_in_them_is),
        cmocka_unit_test(models_are_taken_or_refused),
        cmocka_unit_test(whatever_a_guest_does_is_told),
        cmocka_unit_test(an_engine_lives_on_after_a_crash),
        cmocka_unit_test(a_refusal_is_of_one_scene),
    };
    if (guest_host_is_meant(argc, argv))
        return guest_host_main(argv);
    find_folder(argv[0]);
    return cmocka_run_group_tests(tests, make_scene, free_scene);
}
