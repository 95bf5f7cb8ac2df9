/* Memory that runs out while rays are traced on a modelled machine: each allocation in turn fails,
 * of every scheduler, is told in one line, and leaves nothing behind. */
#include "tests/support/allocations.h"

#include "tests/traffic/traffic_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "tests/support/each_fails.h"

struct traffic_work {
    struct traffic_case *of;
    const struct scheduler *scheduler;
};

static enum status do_paths(const void *of, struct reason *reason)
{
    const struct traffic_work *work = of;
    struct traffic_paths paths;
    enum status status = traffic_paths_make(&work->of->job, 3, 12, 3, &paths, reason);
    assert_true(!status || (paths.depth == 0 && !paths.wave[0].ray));
    traffic_paths_free(&paths);
    return status;
}

static enum status do_walker(const void *of, struct reason *reason)
{
    const struct traffic_work *work = of;
    struct traffic_walker walker;
    enum status status = traffic_walker_make(&work->of->job, 600, &walker, reason);
    if (status)
        return status;
    status = treelets_runs(&walker.treelets, &walker.touch, reason);
    traffic_walker_free(&walker);
    return status;
}

static enum status do_play(const void *of, struct reason *reason)
{
    const struct traffic_work *work = of;
    const struct traffic_machine machine = traffic_small();
    struct traffic_result result;
    struct traffic_run run = {.machine = &machine,
                              .paths = &work->of->paths,
                              .depth = work->of->paths.depth,
                              .walker = &work->of->walker,
                              .kd = &work->of->kd};
    enum status status = traffic_play(work->scheduler, &run, &result, reason);
    assert_true(!run.memory.cache && !run.hit[0] && !run.answered[0]);
    assert_true(status || (result.wrong == 0 && result.rays > 12));
    return status;
}

static void each_allocation_may_fail(void **state)
{
    (void)state;
    struct traffic_case c;
    struct reason reason = {""};
    struct traffic_work work = {&c, NULL};
    assert_true(traffic_case_open("soup:n=300,size=0.5", "f32", "indexed", &c));
    assert_int_equal(kd_make(&c.scene, &c.kd, &reason), STATUS_OK);
    assert_true(each_fails("paths", do_paths, &work, 1) > 10);
    assert_true(each_fails("a walker", do_walker, &work, 1) > 15);
    traffic_case_start(&c, 12, 3, 600);
    for (size_t i = 0; schedulers[i]; i++) {
        work.scheduler = schedulers[i];
        assert_true(each_fails(schedulers[i]->name, do_play, &work, 1) > 10);
    }
    traffic_case_stop(&c);
    traffic_case_close(&c);
}

/* What cannot be walked leaves nothing behind, of any storage. */
static void what_is_refused_keeps_nothing(void **state)
{
    (void)state;
    uint32_t empty = 0, large = 0;
    for (size_t s = 0; tri_stores[s]; s++)
        for (int n = 0; n < 2; n++) {
            struct traffic_case c;
            struct traffic_walker walker;
            struct reason reason = {""};
            if (!traffic_case_open(n ? "soup:n=9" : "soup:n=0", "f32", tri_stores[s]->name, &c))
                continue;
            const long before = held;
            assert_int_equal(traffic_walker_make(&c.job, 16, &walker, &reason), STATUS_INPUT);
            assert_non_null(strstr(reason.text, n ? "treelets of 16 bytes" : "no triangles"));
            assert_int_equal(held, before);
            *(n ? &large : &empty) += 1;
            traffic_case_close(&c);
        }
    assert_true(empty > 2 && large > 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_allocation_may_fail),
                                       cmocka_unit_test(what_is_refused_keeps_nothing)};
    return cmocka_run_group_tests_name("traffic_no_memory", tests, NULL, NULL) ? 1 : 0;
}
