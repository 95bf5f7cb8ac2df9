/* Tasks of engine cpu, each a job of its own, and what engines of the processor are judged by. */
#include "ref/engine.h"
#include "ref/engines/cpu_rays.h"
#include "ref/store.h"
#include "ref/trace/trace.h"
#include "ref/twin/twin.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include <omp.h>
#include <stdio.h>

#include "tests/support/built.h"

#define TASKS 9u
#define RAYS  20u

static struct scene scene;
static struct bvh bvh;
static struct packed whole, edges, poor;
static struct ray ray[TASKS][RAYS];

static int make(void **state)
{
    (void)state;
    const struct build_options options = {.leaf = 2, .eps = BUILD_EPS_DEFAULT};
    struct rng rng = rng_make(4, 2);
    scene = built_soup(100, 1);
    if (bvh_build(builder_find("median"), &scene, &options, &bvh, NULL) ||
        packed_make(layout_find("f32"), &bvh, &scene, &whole, NULL) ||
        packed_make_stored(layout_find("f32"), tri_store_find("edges"), &bvh, &scene, &edges, NULL))
        return 1;
    poor = whole;
    poor.stack_need = 1;
    for (uint32_t i = 0; i < TASKS * RAYS; i++) {
        const float *at = scene.vertex + 9 * (size_t)(i % 100);
        struct ray *one = &ray[i / RAYS][i % RAYS];
        *one = (struct ray){.tmax = INFINITY};
        for (int k = 0; k < 3; k++) {
            one->org[k] = rng_range(&rng, -20, 20);
            one->dir[k] = (at[k] + at[k + 3] + at[k + 6]) / 3 - one->org[k];
        }
    }
    return 0;
}

static int drop(void **state)
{
    (void)state;
    packed_free(&edges);
    packed_free(&whole);
    bvh_free(&bvh);
    scene_free(&scene);
    return 0;
}

struct tasked {
    struct hit hit[RAYS + 1];
    uint32_t flag[RAYS + 1], work[RAYS + 1];
};

/* Task i: what is wrong with it, how many rays, which query, and whether work is wanted. */
static struct engine_task task_of(uint32_t i, struct tasked *to)
{
    memset(to, 0x5A, sizeof *to);
    return (struct engine_task){.job = {.scene = &scene,
                                        .packed = i % 3 == 1   ? &edges
                                                  : i % 3 == 2 ? &poor
                                                               : &whole,
                                        .box = box_test_find("robust"),
                                        .tri = tri_test_find(i % 6 == 4 ? "mt" : "woop"),
                                        .query = i % 2 ? QUERY_ANY : QUERY_CLOSEST},
                                .ray = ray[i],
                                .ray_count = RAYS - i,
                                .hit = to->hit,
                                .flag = to->flag,
                                .work = i % 4 == 3 ? NULL : to->work};
}

static void expect_task(const struct engine_task *task, const struct tasked *got)
{
    struct tasked want;
    const struct job *job = &task->job;
    const uint32_t rays = (uint32_t)task->ray_count;
    char text[200] = "";
    enum status status = STATUS_OK;
    memset(&want, 0x5A, sizeof want);
    if (job->packed == &edges && strcmp(job->tri->name, "woop") == 0) {
        assert_int_equal(task->status, STATUS_UNSUPPORTED);
        assert_non_null(strstr(task->reason.text, "woop"));
        assert_memory_equal(got, &want, sizeof want);
        return;
    }
    if (trace_rays(job, task->ray, rays, want.hit, want.flag, task->work ? want.work : NULL)) {
        status = STATUS_DEVICE;
        snprintf(text, sizeof text, "rays not finished: stack of 1 or %u nodes exhausted",
                 whole.node_count);
    }
    assert_int_equal(status != STATUS_OK, job->packed == &poor);
    assert_int_equal(task->status, status);
    assert_string_equal(task->reason.text, text);
    assert_memory_equal(got, &want, sizeof want);
}

static void each_task_has_its_own_job_and_answers(void **state)
{
    (void)state;
    const struct engine *engine = engine_find("cpu");
    static struct tasked got[TASKS];
    for (unsigned threads = 1; threads <= 3; threads += 2)
        for (uint32_t count = 0; count <= TASKS; count++) {
            const struct engine_options options = {.threads = threads, .device = -1};
            struct engine_task task[TASKS];
            struct reason reason = {""};
            void *self;
            assert_int_equal(engine_open(engine, &options, &self, &reason), STATUS_OK);
            for (uint32_t i = 0; i < TASKS; i++)
                task[i] = task_of(i, &got[i]);
            assert_int_equal(engine->trace_tasks(self, task, count, &reason), STATUS_OK);
            for (uint32_t i = 0; i < count; i++)
                expect_task(&task[i], &got[i]);
            for (uint32_t i = count; i < TASKS; i++)
                assert_int_equal(got[i].flag[0], 0x5A5A5A5A);
            assert_string_equal(reason.text, "");
            engine->close(self);
        }
}

/* --- threads ---------------------------------------------------------------------------------- */

static int team; /* threads that a ray or a task was traced among */

static enum status note_team(const struct job *job, const struct ray *one, struct hit *hit,
                             struct trace_counts *work)
{
    (void)job, (void)one, (void)work;
    team = omp_get_num_threads();
    *hit = hit_none();
    return STATUS_OK;
}

static enum status note_team_all(const struct job *job, const struct ray *one, uint32_t capacity,
                                 struct hit *hit, uint32_t *count)
{
    (void)job, (void)one, (void)capacity, (void)hit;
    team = omp_get_num_threads();
    *count = 0;
    return STATUS_OK;
}

static void note_team_of_task(struct engine_task *task)
{
    (void)task;
    team = omp_get_num_threads();
}

/* Unless there are few rays, or one task. */
static void as_many_threads_trace_as_are_wanted(void **state)
{
    (void)state;
    omp_set_dynamic(0);
    const int most = omp_get_thread_limit();
    for (unsigned want = 0; want < 5; want++) {
        const struct engine_options options = {.threads = want, .device = -1};
        const struct job job = {.scene = &scene, .tri = tri_tests[0]};
        int all = want ? (int)want : omp_get_max_threads();
        all = all < most ? all : most;
        struct trace_report report;
        struct hit hit[100];
        uint32_t found[100];
        void *self;
        assert_int_equal(cpu_rays_open(&options, note_team, note_team_all, &self, NULL), STATUS_OK);
        assert_int_equal(cpu_rays_prepare(self, &job, NULL), STATUS_OK);
        for (uint32_t rays = 64; rays < 67; rays++) {
            assert_int_equal(cpu_rays_trace(self, ray[0], rays, hit, &report, NULL), STATUS_OK);
            assert_int_equal(team, rays > 64 ? all : 1);
            assert_int_equal(cpu_rays_trace_all(self, ray[0], rays, 0, NULL, found, NULL),
                             STATUS_OK);
            assert_int_equal(team, rays > 64 ? all : 1);
        }
        for (size_t tasks = 1; tasks < 4; tasks++) {
            struct engine_task task[3] = {{.ray = NULL}};
            cpu_rays_tasks(self, note_team_of_task, task, tasks);
            assert_int_equal(team, tasks > 1 ? all : 1);
        }
        cpu_rays_close(self);
    }
}

/* --- models ---------------------------------------------------------------------------------- */

static void expect_model(const struct model *got, struct model want)
{
    assert_int_equal(got->formula, want.formula);
    assert_memory_equal(&got->rounding, &want.rounding, sizeof want.rounding);
    assert_int_equal(got->bits, want.bits);
    assert_int_equal(got->watertight, want.watertight);
    assert_int_equal(got->open, want.open);
    assert_int_equal(got->slab, want.slab);
    assert_int_equal(got->any_unnamed, want.any_unnamed);
    assert_true(got->displacement == want.displacement);
}

/* Engines on trees are held to the bits of cpu; fast and fast_small have one triangle test of their
 * own. */
static void engines_are_judged_by_their_triangle_test(void **state)
{
    (void)state;
    static const char *const names[] = {"brute", "fast", "fast_small", "cpu", "cpu_stackless"};
    const struct engine_options options = {.threads = 1, .device = -1};
    for (size_t e = 0; e < ARRAY_COUNT(names); e++)
        for (size_t t = 0; tri_tests[t]; t++) {
            const struct engine *engine = engine_find(names[e]);
            const struct tri_test *tri = engine->own_tri ? tri_test_find("woop") : tri_tests[t];
            void *self;
            assert_int_equal(engine_open(engine, &options, &self, NULL), STATUS_OK);
            struct model got = engine_model(engine, self, tri_tests[t]);
            struct model want = model_of_tri(tri, ROUNDING_IEEE, false);
            want.bits = e >= 3;
            expect_model(&got, want);
            engine->close(self);
        }
}

static void embree_is_judged_by_its_mode(void **state)
{
    (void)state;
    for (size_t t = 0; tri_tests[t]; t++) {
        struct model plain = engine_model(engine_find("embree"), NULL, tri_tests[t]);
        struct model robust = engine_model(engine_find("embree_robust"), NULL, tri_tests[t]);
        expect_model(&plain, (struct model){.formula = TWIN_EMBREE,
                                            .rounding = ROUNDING_EMBREE,
                                            .slab = true,
                                            .any_unnamed = true});
        expect_model(&robust, (struct model){.formula = TWIN_EMBREE_ROBUST,
                                             .rounding = ROUNDING_EMBREE,
                                             .any_unnamed = true});
    }
}

/* Its boxes would keep hits that a layout as published loses. */
static void check_refused(const char *name)
{
    const struct engine_options options = {.threads = 1, .device = -1};
    const struct engine *engine = engine_find(name);
    uint32_t refused = 0, taken = 0;
    void *self;
    assert_int_equal(engine_open(engine, &options, &self, NULL), STATUS_OK);
    for (size_t l = 0; layouts_all[l]; l++) {
        struct packed packed;
        struct reason reason = {""};
        char text[120];
        if (packed_make(layouts_all[l], &bvh, &scene, &packed, NULL))
            continue;
        const struct job job = {.scene = &scene, .packed = &packed};
        snprintf(text, sizeof text, "%s has no layout that loses hits, as %s", name,
                 layouts_all[l]->name);
        enum status status = engine->prepare(self, &job, &reason);
        assert_int_equal(status, layouts_all[l]->faithful ? STATUS_UNSUPPORTED : STATUS_OK);
        assert_string_equal(reason.text, layouts_all[l]->faithful ? text : "");
        refused += layouts_all[l]->faithful;
        taken += !layouts_all[l]->faithful;
        packed_free(&packed);
    }
    assert_true(refused > 0 && taken > 2);
    engine->close(self);
}

static void fast_refuses_layouts_that_lose_hits(void **state)
{
    (void)state;
    check_refused("fast");
    check_refused("fast_small");
}

static void engines_say_what_they_are(void **state)
{
    (void)state;
    static const char *const what[][2] = {
        {"brute", "7 threads, every triangle for every ray"},
        {"cpu", "7 threads, reference traversal over any layout"},
        {"cpu_stackless", "7 threads, reference traversal over binary layouts, no stack"},
    };
    for (size_t e = 0; e < ARRAY_COUNT(what); e++) {
        const struct engine_options options = {.threads = 7, .device = -1}, all = {.device = -1};
        char text[200] = "", cut[6] = "";
        engine_describe(engine_find(what[e][0]), &options, text, sizeof text);
        assert_string_equal(text, what[e][1]);
        engine_describe(engine_find(what[e][0]), &options, cut, sizeof cut);
        assert_string_equal(cut, "7 thr");
        engine_describe(engine_find(what[e][0]), &all, text, sizeof text);
        assert_int_equal(atoi(text), omp_get_max_threads());
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_task_has_its_own_job_and_answers),
        cmocka_unit_test(as_many_threads_trace_as_are_wanted),
        cmocka_unit_test(engines_are_judged_by_their_triangle_test),
        cmocka_unit_test(embree_is_judged_by_its_mode),
        cmocka_unit_test(fast_refuses_layouts_that_lose_hits),
        cmocka_unit_test(engines_say_what_they_are),
    };
    return cmocka_run_group_tests_name("engine_tasks", tests, make, drop);
}
