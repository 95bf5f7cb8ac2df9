/* Many small jobs for engine.trace_tasks and what each gives alone. Includes cmocka.h, whose macros
 * must come last. */
#ifndef TESTS_MANY_JOBS_H
#define TESTS_MANY_JOBS_H

#include "tests/support/fuzz_trials.h"

#define JOBS 60u
#define RAYS 130u /* no multiple of a workgroup */

struct one_job {
    struct fuzz_trial trial;
    struct bvh bvh;
    struct packed packed;
    struct hit hit[RAYS];
    uint32_t flag[RAYS], work[RAYS], expected[RAYS];
};

static struct one_job jobs[JOBS];
static struct engine_task tasks[JOBS];

static inline struct job job_of(const struct one_job *from)
{
    return (struct job){.scene = &from->trial.scene,
                        .packed = &from->packed,
                        .box = from->trial.box,
                        .tri = from->trial.tri,
                        .query = from->trial.query};
}

/* Jobs of all kinds: layouts, tests and queries by turns; some without a triangle or a ray. */
static inline void make_jobs(void)
{
    struct reason reason;
    for (size_t i = 0; i < JOBS; i++) {
        struct one_job *made = &jobs[i];
        trial_make(5, i, 1, 100, RAYS, &made->trial);
        if (i % 16 == 9) /* empty */
            made->trial.scene.tri_count = 0;
        made->trial.ray_count = i % 16 == 11 ? 0 : RAYS - (uint32_t)(i % 3);
        const struct layout *layout = layout_find(i % 2 ? "f32" : "rf16");
        if (made->trial.builder->build(&made->trial.scene, &made->trial.build, &made->bvh,
                                       &reason) ||
            packed_make(layout, &made->bvh, &made->trial.scene, &made->packed, &reason))
            fail_msg("%s", reason.text);
    }
}

static inline void free_jobs(void)
{
    for (size_t i = 0; i < JOBS; i++) {
        fuzz_trial_free(&jobs[i].trial);
        bvh_free(&jobs[i].bvh);
        packed_free(&jobs[i].packed);
    }
}

static inline void make_tasks(void)
{
    for (size_t i = 0; i < JOBS; i++) {
        memset(jobs[i].hit, 0xAB, sizeof jobs[i].hit);
        memset(jobs[i].flag, 0xAB, sizeof jobs[i].flag);
        for (uint32_t r = 0; r < RAYS; r++) /* nothing that is true: it must not matter */
            jobs[i].expected[r] = (r * 7919u) % 131u << (i % 3) * 8;
        tasks[i] = (struct engine_task){.job = job_of(&jobs[i]),
                                        .ray = jobs[i].trial.ray,
                                        .ray_count = jobs[i].trial.ray_count,
                                        .hit = jobs[i].hit,
                                        .flag = jobs[i].flag,
                                        .work = i % 4 == 0 ? NULL : jobs[i].work,
                                        .expected = i % 5 == 0 ? NULL : jobs[i].expected,
                                        .status = STATUS_INTERNAL};
    }
}

static inline void *open_engine(const struct engine *engine)
{
    const struct engine_options options = {.device = -1, .threads = 2};
    struct reason reason;
    void *self;
    enum status status = engine_open(engine, &options, &self, &reason);
    if (status == STATUS_UNSUPPORTED)
        return NULL;
    if (status)
        fail_msg("%s", reason.text);
    return self;
}

/* Job `i` alone has the same hits. */
static inline void assert_alone(const struct engine *engine, void *self, size_t i)
{
    struct hit hit[RAYS];
    struct trace_report report;
    struct reason reason = {""};
    const struct job job = job_of(&jobs[i]);
    if (engine->prepare(self, &job, &reason) ||
        engine->trace(self, jobs[i].trial.ray, jobs[i].trial.ray_count, hit, &report, &reason))
        fail_msg("%s: job %zu: %s", engine->name, i, reason.text);
    assert_memory_equal(hit, jobs[i].hit, jobs[i].trial.ray_count * sizeof hit[0]);
    for (uint32_t r = 0; r < jobs[i].trial.ray_count; r++)
        assert_int_equal(jobs[i].flag[r], ABI_FLAG_DONE);
}

#endif
