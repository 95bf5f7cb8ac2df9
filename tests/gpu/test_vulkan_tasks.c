/* Laws of gpu/trace/tracer.h's tracer_trace_tasks on the running driver. */
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_device_takes_many_jobs_through_staging),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
