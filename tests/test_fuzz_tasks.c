/* Laws of engine.trace_tasks: many jobs in one call have the bits of each alone, and what happens
 * in one keeps to it. */
#include "ref/trace.h"

#include "tests/fuzz_trials.h"
#include "tests/gpu.h"

#define JOBS 60u
#define RAYS 130u /* no multiple of a workgroup */

static const char *const names[] = {"cpu", "vulkan"};

struct bench_job {
    struct fuzz_trial trial;
    struct bvh bvh;
    struct packed packed;
    struct hit hit[RAYS];
    uint32_t flag[RAYS];
};

static struct bench_job jobs[JOBS];
static struct engine_task tasks[JOBS];

static struct job job_of(const struct bench_job *from)
{
    return (struct job){.scene = &from->trial.scene,
                        .packed = &from->packed,
                        .box = from->trial.box,
                        .tri = from->trial.tri,
                        .query = from->trial.query};
}

/* Jobs of all kinds: layouts, tests and queries by turns; some without a triangle or a ray. */
static void make_jobs(void)
{
    struct reason reason;
    for (size_t i = 0; i < JOBS; i++) {
        struct bench_job *made = &jobs[i];
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

static void free_jobs(void)
{
    for (size_t i = 0; i < JOBS; i++) {
        fuzz_trial_free(&jobs[i].trial);
        bvh_free(&jobs[i].bvh);
        packed_free(&jobs[i].packed);
    }
}

static void make_tasks(void)
{
    for (size_t i = 0; i < JOBS; i++) {
        memset(jobs[i].hit, 0xAB, sizeof jobs[i].hit);
        memset(jobs[i].flag, 0xAB, sizeof jobs[i].flag);
        tasks[i] = (struct engine_task){.job = job_of(&jobs[i]),
                                        .ray = jobs[i].trial.ray,
                                        .ray_count = jobs[i].trial.ray_count,
                                        .hit = jobs[i].hit,
                                        .flag = jobs[i].flag,
                                        .status = STATUS_INTERNAL};
    }
}

static void *open_engine(const struct engine *engine)
{
    const struct engine_options options = {.device = -1, .threads = 2};
    struct reason reason;
    void *self;
    enum status status = engine->open(&options, &self, &reason);
    if (status == STATUS_UNSUPPORTED)
        return NULL;
    if (status)
        fail_msg("%s", reason.text);
    return self;
}

/* Job `i` alone has the same hits. */
static void assert_alone(const struct engine *engine, void *self, size_t i)
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

static void many_jobs_have_the_bits_of_each_alone(void **state)
{
    (void)state;
    make_jobs();
    for (size_t e = 0; e < ARRAY_COUNT(names); e++) {
        const struct engine *engine = engine_find(names[e]);
        void *self = open_engine(engine);
        size_t hits = 0;
        if (!self)
            continue;
        for (int again = 0; again < 2; again++) {
            struct reason reason = {""};
            make_tasks();
            if (engine->trace_tasks(self, tasks, again ? JOBS / 2 : JOBS, &reason))
                fail_msg("%s: %s", engine->name, reason.text);
            for (size_t i = 0; i < (again ? JOBS / 2 : JOBS); i++) {
                assert_int_equal(tasks[i].status, STATUS_OK);
                assert_alone(engine, self, i);
                for (uint32_t r = 0; r < jobs[i].trial.ray_count; r++)
                    hits += jobs[i].hit[r].prim != ABI_NO_PRIM;
            }
        }
        assert_true(hits > JOBS * RAYS / 4);
        engine->close(self);
    }
    free_jobs();
}

/* Trees that are broken between others that are not: a cycle that never ends, a stack that is too
 * small, a tree that is too deep for the engine, references far out of range. */
static void a_broken_job_keeps_to_itself(void **state)
{
    (void)state;
    enum { CYCLE = 7, SHORT = 21, DEEP = 33, WILD = 45 };
    static const size_t broken[] = {CYCLE, SHORT, DEEP, WILD};
    make_jobs();
    /* f32: the second child of the root is the root. */
    struct node_f32 *node = (struct node_f32 *)jobs[CYCLE].packed.word;
    assert_true(node[0].count == 0);
    node[0].first = 0;
    jobs[SHORT].packed.stack_need = 0;
    jobs[DEEP].packed.stack_need = ABI_STACK_MAX + 1;
    for (uint32_t i = 0; i < jobs[WILD].packed.item_count; i++)
        jobs[WILD].packed.item[i] = 0x40000000u;
    for (size_t e = 0; e < ARRAY_COUNT(names); e++) {
        const struct engine *engine = engine_find(names[e]);
        bool cpu = strcmp(names[e], "cpu") == 0;
        struct reason reason = {""};
        void *self = open_engine(engine);
        if (!self)
            continue;
        make_tasks();
        if (engine->trace_tasks(self, tasks, JOBS, &reason))
            fail_msg("%s: %s", engine->name, reason.text);
        for (size_t i = 0; i < JOBS; i++) {
            bool is_broken = false;
            for (size_t b = 0; b < ARRAY_COUNT(broken); b++)
                is_broken = is_broken || i == broken[b];
            if (!is_broken) {
                assert_int_equal(tasks[i].status, STATUS_OK);
                assert_alone(engine, self, i);
            }
        }
        size_t unfinished = 0;
        for (uint32_t r = 0; r < jobs[CYCLE].trial.ray_count; r++)
            unfinished += jobs[CYCLE].flag[r] != ABI_FLAG_DONE;
        assert_int_equal(tasks[CYCLE].status, STATUS_DEVICE);
        assert_true(unfinished > 0 && unfinished < jobs[CYCLE].trial.ray_count);
        assert_true(strlen(tasks[CYCLE].reason.text) > 0);
        if (cpu) /* the shader's smallest stack has 16 entries */
            assert_int_equal(tasks[SHORT].status, STATUS_DEVICE);
        else
            assert_int_equal(tasks[DEEP].status, STATUS_LIMIT);
        assert_int_equal(tasks[WILD].status, STATUS_OK);
        for (uint32_t r = 0; r < jobs[WILD].trial.ray_count; r++)
            assert_int_equal(jobs[WILD].hit[r].prim, ABI_NO_PRIM);
        engine->close(self);
    }
    free_jobs();
}

/* Also where memory is not shared; under RAYDIFF_VALIDATE the layer says nothing. */
static void a_device_takes_many_jobs_through_staging(void **state)
{
    (void)state;
    const struct engine *cpu = engine_find("cpu");
    void *self = open_engine(cpu);
    make_jobs();
    for (int staging = 0; staging < 2; staging++) {
        struct vk_options options = gpu_options();
        struct reason reason = {""};
        options.staging = staging;
        struct tracer *tracer = gpu_tracer(&options, staging ? 32 : 0);
        make_tasks();
        gpu_must(tracer_trace_tasks(tracer, tasks, JOBS, &reason), &reason);
        struct arithmetic arithmetic = tracer_arithmetic(tracer);
        uint32_t pipelines = tracer_pipelines(tracer);
        for (size_t i = 0; i < JOBS; i++) {
            assert_int_equal(tasks[i].status, STATUS_OK);
            if (arithmetic.bits)
                assert_alone(cpu, self, i);
        }
        make_tasks();
        gpu_must(tracer_trace_tasks(tracer, tasks, JOBS, &reason), &reason);
        assert_int_equal(tracer_pipelines(tracer), pipelines);
        gpu_close_tracer(tracer);
    }
    cpu->close(self);
    free_jobs();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(many_jobs_have_the_bits_of_each_alone),
        cmocka_unit_test(a_broken_job_keeps_to_itself),
        cmocka_unit_test(a_device_takes_many_jobs_through_staging),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
