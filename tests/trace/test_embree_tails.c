/* Rays in any number, which packets of Embree hold in part: answers are those of the rays that were
 * given, and nothing is written behind them. */
#include "ref/engines/embree_named.h"
#include "ref/primitives/primitives.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <string.h>

#if HAVE_EMBREE

#define ROOM     40u
#define CAPACITY 3u

static struct scene scene;
static struct ray ray[ROOM];

/* What there is room for; filled all over before each trace. */
struct tail_answers {
    struct hit hit[ROOM * CAPACITY];
    uint32_t count[ROOM];
};

static void trace(const struct engine *engine, void *self, enum query query, size_t count,
                  struct tail_answers *out)
{
    struct reason reason = {""};
    struct trace_report report;
    memset(out, 0x5A, sizeof *out);
    const enum status status =
        query == QUERY_ALL
            ? engine->trace_all(self, ray, count, CAPACITY, out->hit, out->count, &reason)
            : engine->trace(self, ray, count, out->hit, &report, &reason);
    if (status)
        fail_msg("%s: %s", engine->name, reason.text);
}

static void nothing_is_written_behind_the_last(void **state)
{
    (void)state;
    static const char *const names[] = {"embree:low", "embree:4", "embree:8", "embree:16"};
    struct tail_answers clean;
    memset(&clean, 0x5A, sizeof clean);
    for (size_t i = 0; i < 12; i++) {
        const struct engine_options options = {.threads = 1, .device = -1};
        const enum query query = (enum query)(i % 3);
        const struct job job = {
            .scene = &scene, .box = box_tests[0], .tri = tri_tests[0], .query = query};
        const size_t each = query == QUERY_ALL ? CAPACITY : 1;
        const struct engine *engine;
        struct reason reason = {""};
        struct tail_answers all, some;
        void *self;
        if (embree_named(names[i / 3], &engine, &reason) == STATUS_UNSUPPORTED)
            continue;
        assert_int_equal(engine_open(engine, &options, &self, &reason), STATUS_OK);
        assert_int_equal(engine->prepare(self, &job, &reason), STATUS_OK);
        trace(engine, self, query, ROOM, &all);
        for (size_t count = 0; count < ROOM; count++) {
            trace(engine, self, query, count, &some);
            for (size_t k = 0; k < count; k++) {
                assert_int_equal(some.count[k], all.count[k]);
                assert_true(some.hit[each * k].prim == all.hit[each * k].prim);
            }
            assert_memory_equal(&some.hit[each * count], &clean.hit[each * count],
                                (ROOM * CAPACITY - each * count) * sizeof *some.hit);
            assert_memory_equal(&some.count[count], &clean.count[count],
                                (ROOM - count) * sizeof *some.count);
        }
        engine->close(self);
    }
}

#endif

int main(void)
{
#if HAVE_EMBREE
    const struct CMUnitTest tests[] = {cmocka_unit_test(nothing_is_written_behind_the_last)};
    struct reason reason;
    if (scene_open("soup:n=200", 1, &scene, &reason) ||
        ray_set_make(ray_sets[0], &scene, 5, ROOM, ray, NULL))
        return 4;
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    scene_free(&scene);
    return failed;
#else
    puts("SKIP built without Embree");
    return 0;
#endif
}
