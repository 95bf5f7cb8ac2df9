/* Laws of gpu/trace/tracer.h's tracer_trace_tasks on the running driver. */
#include "ref/trace/trace.h"

#include "tests/support/gpu.h"
#include "tests/support/many_jobs.h"

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

/* Small tasks without number: a dispatch takes 128 of them (gpu/trace/tracer_tasks.c), and whether
 * they are fewer, as many or more, each has its own answers. */
enum { GROUP = 128, MANY = 2 * GROUP + 3, FEW = 5 };
static struct hit many_hit[MANY][FEW];
static uint32_t many_flag[MANY][FEW];

static void make_many(struct engine_task task[MANY])
{
    make_tasks();
    memset(many_hit, 0xAB, sizeof many_hit);
    memset(many_flag, 0xAB, sizeof many_flag);
    for (size_t k = 0; k < MANY; k++) {
        task[k] = tasks[k % JOBS];
        task[k].ray_count = task[k].ray_count < FEW ? task[k].ray_count : FEW;
        task[k].hit = many_hit[k];
        task[k].flag = many_flag[k];
        task[k].work = NULL;
        task[k].expected = NULL;
    }
}

static void as_many_tasks_as_there_are_are_taken(void **state)
{
    (void)state;
    static const size_t counts[] = {1, GROUP - 1, GROUP, GROUP + 1, MANY};
    static struct engine_task task[MANY];
    static struct hit alone[JOBS][FEW];
    const struct vk_options options = gpu_options();
    struct tracer *tracer = gpu_tracer(&options, 0);
    struct reason reason = {""};
    make_jobs();
    make_many(task);
    gpu_must(tracer_trace_tasks(tracer, task, JOBS, &reason), &reason);
    memcpy(alone, many_hit, sizeof alone);
    for (size_t i = 0; i < ARRAY_COUNT(counts); i++) {
        make_many(task);
        gpu_must(tracer_trace_tasks(tracer, task, counts[i], &reason), &reason);
        for (size_t k = 0; k < MANY; k++) {
            assert_int_equal(task[k].status, k < counts[i] ? STATUS_OK : STATUS_INTERNAL);
            for (size_t r = 0; r < task[k].ray_count && k < counts[i]; r++)
                assert_int_equal(many_flag[k][r], ABI_FLAG_DONE);
            if (k < counts[i])
                assert_memory_equal(many_hit[k], alone[k % JOBS], sizeof alone[0]);
        }
    }
    gpu_close_tracer(tracer);
    free_jobs();
}

/* A task of more rays than workgroups of one a driver takes: it goes alone, and neither its answers
 * nor its broken tree are those of the tasks around it. Large ones have the rays of small ones over
 * and over. Where a driver takes as many, all go together, with the same answers. */
enum { LARGE = 66000, CYCLE = 7, TURN = 5 };
static const size_t turn[TURN] = {1, 3, CYCLE, 3, CYCLE}; /* jobs; the fourth and the last large */
static struct ray large_ray[2][LARGE];
static struct hit large_hit[2][LARGE];
static uint32_t large_flag[2][LARGE];

static void make_turn(struct engine_task task[TURN])
{
    make_tasks();
    for (size_t k = 0; k < TURN; k++) {
        task[k] = tasks[turn[k]];
        if (k < 3)
            continue;
        const size_t to = k - 3;
        for (size_t i = 0; i < LARGE; i++)
            large_ray[to][i] = task[k].ray[i % task[k].ray_count];
        memset(large_hit[to], 0xAB, sizeof large_hit[to]);
        memset(large_flag[to], 0xAB, sizeof large_flag[to]);
        task[k].ray = large_ray[to];
        task[k].ray_count = LARGE;
        task[k].hit = large_hit[to];
        task[k].flag = large_flag[to];
        task[k].work = NULL;
        task[k].expected = NULL;
    }
}

static void a_large_task_keeps_to_itself(void **state)
{
    (void)state;
    const struct vk_options options = gpu_options();
    make_jobs();
    struct node_f32 *node = (struct node_f32 *)jobs[CYCLE].packed.word;
    node[0].first = 0; /* the second child of the root is the root */
    struct tracer *tracer = gpu_tracer(&options, 1);
    for (size_t first = 0; first < TURN; first += 3) { /* a small or a large one goes first */
        struct engine_task task[TURN], given[TURN];
        struct reason reason = {""};
        make_turn(task);
        for (size_t k = 0; k < TURN; k++)
            given[k] = task[(first + k) % TURN];
        gpu_must(tracer_trace_tasks(tracer, given, TURN, &reason), &reason);
        for (size_t k = 0; k < TURN; k++) {
            const bool broken = given[k].job.packed == &jobs[CYCLE].packed;
            size_t unfinished = 0;
            for (size_t i = 0; i < given[k].ray_count; i++)
                unfinished += given[k].flag[i] != ABI_FLAG_DONE;
            assert_int_equal(given[k].status, broken ? STATUS_DEVICE : STATUS_OK);
            assert_int_equal(unfinished > 0, broken);
            if (broken)
                assert_non_null(strstr(given[k].reason.text, " was not finished: "));
        }
        const size_t rays = jobs[3].trial.ray_count;
        for (size_t i = 0; i < LARGE; i++)
            assert_memory_equal(&large_hit[0][i], &jobs[3].hit[i % rays], sizeof(struct hit));
    }
    gpu_close_tracer(tracer);
    free_jobs();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_device_takes_many_jobs_through_staging),
        cmocka_unit_test(as_many_tasks_as_there_are_are_taken),
        cmocka_unit_test(a_large_task_keeps_to_itself),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
