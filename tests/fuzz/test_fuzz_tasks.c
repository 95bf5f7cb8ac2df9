/* Laws of engine.trace_tasks: many jobs in one call have the bits of each alone, and what happens
 * in one keeps to it. */
#include "ref/trace/trace.h"

#include <stdio.h>

#include "tests/support/many_jobs.h"

static const char *const names[] = {"cpu", "vulkan"};

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
    static bool is_open[RAYS]; /* of the cycle, on engine cpu */
    char first[24] = "";
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
        for (uint32_t r = jobs[CYCLE].trial.ray_count; r-- > 0;) {
            const bool open = jobs[CYCLE].flag[r] != ABI_FLAG_DONE;
            unfinished += open;
            if (cpu)
                is_open[r] = open;
            assert_int_equal(open, is_open[r]); /* the same rays on all, in whatever order */
            if (open)
                snprintf(first, sizeof first, "ray %u ", r);
        }
        assert_int_equal(tasks[CYCLE].status, STATUS_DEVICE);
        if (!cpu && !strstr(tasks[CYCLE].reason.text, first))
            fail_msg("%s: '%s' has no %s", engine->name, tasks[CYCLE].reason.text, first);
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

/* What engine cpu says that a ray took is what trace_ray counts. */
static void work_is_what_was_counted(void **state)
{
    (void)state;
    const struct engine *engine = engine_find("cpu");
    struct reason reason = {""};
    size_t most = 0;
    void *self = open_engine(engine);
    assert_true(engine->tells_work);
    make_jobs();
    make_tasks();
    assert_int_equal(engine->trace_tasks(self, tasks, JOBS, &reason), STATUS_OK);
    for (size_t i = 0; i < JOBS; i++)
        for (uint32_t r = 0; r < jobs[i].trial.ray_count && tasks[i].work; r++) {
            const struct job job = job_of(&jobs[i]);
            struct trace_counts counts = {0};
            struct hit hit;
            assert_int_equal(trace_ray(&job, &tasks[i].ray[r], &hit, &counts), STATUS_OK);
            assert_int_equal(tasks[i].work[r], counts.boxes << 16 | counts.tris);
            most = counts.boxes > most ? counts.boxes : most;
        }
    assert_true(most > 10);
    engine->close(self);
    free_jobs();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(many_jobs_have_the_bits_of_each_alone),
        cmocka_unit_test(a_broken_job_keeps_to_itself),
        cmocka_unit_test(work_is_what_was_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
