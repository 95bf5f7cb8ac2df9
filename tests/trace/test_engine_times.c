/* Times that engines of the processor report: some time, and no more than has passed. */
#include "ref/engine.h"
#include "ref/store.h"
#include "ref/two_level/packed_world.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "tests/support/built.h"

#define RAYS 2000u

struct timed {
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    struct world world;
    struct world_trees trees;
    struct packed_world packed_world;
    struct ray ray[RAYS];
    struct hit hit[RAYS];
    uint32_t tag[RAYS];
};

static void make(struct timed *t)
{
    const struct build_options options = {.leaf = 4, .eps = BUILD_EPS_DEFAULT};
    const struct world_build how = {.top = builder_find("median"),
                                    .bottom = builder_find("median"),
                                    .top_options = options,
                                    .bottom_options = options};
    struct rng rng = rng_make(1, 2);
    t->scene = built_soup(3000, 1);
    assert_int_equal(bvh_build(builder_find("median"), &t->scene, &options, &t->bvh, NULL), 0);
    assert_int_equal(packed_make(layout_find("f32"), &t->bvh, &t->scene, &t->packed, NULL), 0);
    assert_int_equal(world_of_scene(&t->scene, &t->world, NULL), 0);
    assert_int_equal(world_finish(&t->world, NULL), 0);
    assert_int_equal(world_trees_make(&t->world, &how, &t->trees, NULL), 0);
    assert_int_equal(packed_world_make(&t->world, &t->trees, layout_find("f32"), layout_find("f32"),
                                       tri_stores[0], &t->packed_world, NULL),
                     0);
    for (uint32_t i = 0; i < RAYS; i++) {
        t->ray[i] = (struct ray){.tmax = INFINITY};
        for (int k = 0; k < 3; k++) {
            t->ray[i].org[k] = 4 * rng_float(&rng) - 2;
            t->ray[i].dir[k] = rng_float(&rng) - 0.5f;
        }
    }
}

/* Traces a scene, or a world. */
static void expect_time(const struct engine *engine, struct timed *t, bool world)
{
    const struct engine_options options = {.threads = 1, .device = -1};
    const struct job job = {.scene = &t->scene,
                            .packed = &t->packed,
                            .box = box_test_find("robust"),
                            .tri = tri_test_find("woop")};
    const struct world_job world_job = {
        .world = &t->world, .packed = &t->packed_world, .box = job.box, .tri = job.tri};
    struct trace_report report = {0};
    struct reason reason = {""};
    void *self = NULL;
    if (engine_open(engine, &options, &self, &reason))
        return;
    enum status status = world ? engine->worlds->prepare_world(self, &world_job, &reason)
                               : engine->prepare(self, &job, &reason);
    if (status)
        fail_msg("%s: %s", engine->name, reason.text);
    /* Tracing is nearly all that passes, in a scene of that size also beside the filling of a
     * library's rays; but another program may take its turn after it. */
    double most = 0;
    for (int i = 0; i < 12; i++) {
        uint64_t start = time_ns();
        status = world ? engine->worlds->trace_world(self, t->ray, NULL, RAYS, t->hit, t->tag,
                                                     &report, &reason)
                       : engine->trace(self, t->ray, RAYS, t->hit, &report, &reason);
        uint64_t passed = time_ns() - start;
        if (status)
            fail_msg("%s: %s", engine->name, reason.text);
        assert_true(report.ns <= passed);
        most = fmax(most, (double)report.ns / (double)passed);
    }
    if (most < 0.9)
        fail_msg("%s, %s: at most %g of the time that passes is reported", engine->name,
                 world ? "a world" : "a scene", most);
    engine->close(self);
}

static void times_are_what_has_passed(void **state)
{
    (void)state;
    static struct timed t;
    uint32_t scenes = 0, worlds = 0;
    make(&t);
    for (size_t e = 0; engines[e]; e++) {
        if (engines[e]->gpu)
            continue;
        expect_time(engines[e], &t, false);
        scenes++;
        if (engines[e]->worlds) {
            expect_time(engines[e], &t, true);
            worlds++;
        }
    }
    assert_true(scenes >= 4 && worlds >= 3);
    packed_world_free(&t.packed_world);
    world_trees_free(&t.trees);
    world_free(&t.world);
    packed_free(&t.packed);
    bvh_free(&t.bvh);
    scene_free(&t.scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(times_are_what_has_passed),
    };
    return cmocka_run_group_tests_name("engine_times", tests, NULL, NULL);
}
