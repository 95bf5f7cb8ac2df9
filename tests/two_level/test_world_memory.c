/* Memory that runs out between a world and its hits: each allocation in turn fails. It must be said
 * in one line, with nothing made and nothing kept. */
#include "tests/support/allocations.h"

#include "ref/engine.h"
#include "ref/store.h"
#include "ref/trace/trace_world.h"
#include "ref/two_level/world_check.h"
#include "tests/two_level/two_level_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "tests/support/each_fails.h"
#include "tests/two_level/braid_stand.h"
#include "tests/two_level/world_stand.h"

/* What steps need of those before. */
struct steps {
    struct world world;
    struct world_trees trees;
    struct packed_world packed;
    uint32_t braid;
};

typedef enum status step_fn(const struct steps *steps, struct reason *reason);

struct step_of {
    step_fn *step;
    const struct steps *steps;
};

static enum status do_step(const void *of, struct reason *reason)
{
    const struct step_of *s = of;
    return s->step(s->steps, reason);
}

/* As each_fails. */
static long fail_each(step_fn *step, const struct steps *steps)
{
    return each_fails("a step", do_step, &(struct step_of){step, steps}, 1);
}

static enum status do_trees(const struct steps *steps, struct reason *reason)
{
    struct world_build build = stand_build("median", 2);
    struct world_trees trees;
    build.top_options.threads = build.bottom_options.threads = 1;
    build.braid = steps->braid;
    enum status status = world_trees_make(&steps->world, &build, &trees, reason);
    const struct world_trees zero = {0};
    if (status)
        assert_memory_equal(&trees, &zero, sizeof zero);
    world_trees_free(&trees);
    return status;
}

static enum status do_pack(const struct steps *steps, struct reason *reason)
{
    struct packed_world packed;
    enum status status = packed_world_make(&steps->world, &steps->trees, layout_find("f32"),
                                           layout_find("cwbvh80"), tri_stores[0], &packed, reason);
    const struct packed_world zero = {0};
    if (status)
        assert_memory_equal(&packed, &zero, sizeof zero);
    packed_world_free(&packed);
    return status;
}

static enum status do_check(const struct steps *steps, struct reason *reason)
{
    struct world_faults faults;
    return world_pack_check(&steps->world, &steps->packed, &faults, reason);
}

/* An engine that cannot be opened for want of memory is none. */
static enum status do_engine(const char *name, const struct steps *steps, struct reason *reason)
{
    const struct engine *engine = engine_find(name);
    const struct engine_options options = {.threads = 1, .device = -1};
    const struct packed_world *packed = engine->needs_packed ? &steps->packed : NULL;
    struct world_job job = stand_job(&steps->world, packed, QUERY_CLOSEST);
    void *self = &job;
    enum status status = engine_open(engine, &options, &self, reason);
    if (status)
        assert_null(self);
    for (int time = 0; time < 2 && !status; time++) /* what the first made is given back */
        status = engine->worlds->prepare_world(self, &job, reason);
    engine->close(self);
    return status;
}

static enum status do_brute(const struct steps *steps, struct reason *reason)
{
    return do_engine("brute", steps, reason);
}

/* Its top is built anew if the world's has parts. */
static enum status do_fast(const struct steps *steps, struct reason *reason)
{
    return do_engine("fast", steps, reason);
}

/* Embree's own memory is not counted. */
static enum status do_embree(const struct steps *steps, struct reason *reason)
{
    return do_engine("embree", steps, reason);
}

static bool can_be_opened(const char *name)
{
    const struct engine *engine = engine_find(name);
    const struct engine_options options = {.threads = 1, .device = -1};
    struct reason reason = {""};
    void *self;
    enum status status = engine_open(engine, &options, &self, &reason);
    engine->close(self);
    return status == STATUS_OK;
}

static void each_allocation_may_fail(void **state)
{
    (void)state;
    struct steps steps = {.world = fixture_room(3, 12)};
    fixture_mesh(&steps.world, 0, "soup:n=9", 2);
    fixture_mesh(&steps.world, 1, "soup:n=0", 1);
    fixture_mesh(&steps.world, 2, "sphere:n=1", 1);
    for (uint32_t i = 0; i < 12; i++) {
        fixture_transform(WORLD_TURNED, i, steps.world.instance[i].m);
        steps.world.instance[i].mesh = i % 3;
    }
    fixture_finish(&steps.world);
    steps.trees = stand_trees(&steps.world, "median", 2);
    steps.packed = stand_packed(&steps.world, &steps.trees, "f32", "cwbvh80");
    const long trees = fail_each(do_trees, &steps), pack = fail_each(do_pack, &steps);
    const long check = fail_each(do_check, &steps);
    assert_true(trees > 20 && pack > 10 && check > 10);
    assert_true(fail_each(do_brute, &steps) == 3);
    if (can_be_opened("embree"))
        assert_true(fail_each(do_embree, &steps) == 7);
    packed_world_free(&steps.packed);
    world_trees_free(&steps.trees);
    /* The same with instances that are opened. */
    steps.braid = 4;
    steps.trees = braid_trees(&steps.world, "median", 2, 4);
    steps.packed = stand_packed(&steps.world, &steps.trees, "f32", "cwbvh80");
    assert_true(steps.trees.parts.count > 10);
    assert_true(fail_each(do_trees, &steps) > trees + 4);
    assert_true(fail_each(do_pack, &steps) > pack + 10);
    assert_true(fail_each(do_check, &steps) > check + 10);
    assert_true(fail_each(do_fast, &steps) > 10);
    packed_world_free(&steps.packed);
    world_trees_free(&steps.trees);
    world_free(&steps.world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_allocation_may_fail)};
    return cmocka_run_group_tests_name("world_memory", tests, NULL, NULL);
}
