/* Engines that trace worlds, used as all engines are. */
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
#include <cmocka.h>

#include "tests/two_level/world_stand.h"

#define RAYS     500
#define CAPACITY 3

static struct world world;
static struct packed_world packed;
static struct ray rays[RAYS];
static struct ray_mode modes[RAYS];

static int make(void **state)
{
    (void)state;
    world = fixture_room(1, 12);
    fixture_mesh(&world, 0, "soup:n=60,size=0.6", 3);
    for (uint32_t i = 0; i < 12; i++) {
        fixture_transform(WORLD_TURNED, 60 + i, world.instance[i].m);
        world.instance[i].mask = 1u << i % 8;
        world.instance[i].flags = i % 4;
    }
    world.filter = (struct filter_rule){FILTER_TRIANGLES, 5, 128};
    fixture_finish(&world);
    packed = stand_world(&world, "f32");
    for (uint32_t i = 0; i < RAYS; i++) {
        rays[i] = stand_aim(&packed, 1, i);
        modes[i] = (struct ray_mode){i % 256, i % 3 ? 0 : ABI_RAY_CULL_BACK};
    }
    return 0;
}

static int drop(void **state)
{
    (void)state;
    packed_world_free(&packed);
    world_free(&world);
    return 0;
}

static void *opened(const struct engine *engine, uint32_t threads)
{
    void *self;
    struct engine_options options = {.threads = threads, .device = -1};
    struct reason reason = {""};
    if (engine_open(engine, &options, &self, &reason))
        fail_msg("%s", reason.text);
    return self;
}

static struct world_job job_for(const struct engine *engine, enum query query)
{
    struct world_job job = stand_job(&world, &packed, query);
    if (!engine->needs_packed)
        job.packed = NULL;
    return job;
}

/* One ray by the function that the engine is made of. */
static struct tagged alone(const struct engine *engine, uint32_t ray, struct ray_mode mode,
                           enum query query)
{
    struct world_job job = stand_job(&world, &packed, query);
    struct tagged out;
    if (engine->needs_packed)
        return stand_trace(&job, &rays[ray], mode);
    trace_world_brute(&world, packed.record, job.tri, query, &rays[ray], mode, &out.hit, &out.tag);
    return out;
}

static const char *const names[] = {"cpu", "brute"};

static void every_ray_is_answered_in_its_place(void **state)
{
    (void)state;
    for (size_t e = 0; e < ARRAY_COUNT(names); e++)
        for (uint32_t threads = 1; threads <= 3; threads += 2)
            for (int q = QUERY_CLOSEST; q <= QUERY_ANY; q++)
                for (int with = 0; with < 2; with++) {
                    const struct engine *engine = engine_find(names[e]);
                    static struct hit hit[RAYS];
                    static uint32_t tag[RAYS];
                    struct trace_report report;
                    struct world_job job = job_for(engine, (enum query)q);
                    void *self = opened(engine, threads);
                    uint32_t hits = 0;
                    assert_int_equal(engine->worlds->prepare_world(self, &job, NULL), STATUS_OK);
                    memset(hit, 0x5A, sizeof hit);
                    memset(tag, 0x5A, sizeof tag);
                    assert_int_equal(engine->worlds->trace_world(self, rays, with ? modes : NULL,
                                                                 RAYS, hit, tag, &report, NULL),
                                     STATUS_OK);
                    for (uint32_t i = 0; i < RAYS; i++) {
                        struct tagged expected =
                            alone(engine, i, with ? modes[i] : ray_mode_all(), (enum query)q);
                        assert_memory_equal(&hit[i], &expected.hit, sizeof *hit);
                        assert_int_equal(tag[i], expected.tag);
                        hits += hit[i].prim != ABI_NO_PRIM;
                    }
                    assert_true(hits > RAYS / 10 && hits < RAYS);
                    assert_true(report.tris > RAYS && report.memory_bytes > 60 * 36);
                    assert_int_equal(report.boxes > RAYS, engine->needs_packed);
                    engine->close(self);
                }
}

static void all_hits_are_listed_with_their_tags(void **state)
{
    (void)state;
    for (size_t e = 0; e < ARRAY_COUNT(names); e++) {
        const struct engine *engine = engine_find(names[e]);
        static struct hit hit[RAYS * CAPACITY];
        static uint32_t tag[RAYS * CAPACITY], count[RAYS];
        struct world_job job = job_for(engine, QUERY_ALL);
        void *self = opened(engine, 2);
        uint32_t over = 0;
        assert_int_equal(engine->worlds->prepare_world(self, &job, NULL), STATUS_OK);
        memset(tag, 0x5A, sizeof tag);
        assert_int_equal(engine->worlds->trace_world_all(self, rays, modes, RAYS, CAPACITY, hit,
                                                         tag, count, NULL),
                         STATUS_OK);
        for (uint32_t i = 0; i < RAYS; i++) {
            struct world_job own = stand_job(&world, &packed, QUERY_ALL);
            static struct hit all[STAND_LIST];
            static uint32_t tags[STAND_LIST];
            uint32_t expected;
            if (engine->needs_packed)
                assert_int_equal(trace_world_ray_all(&own, &rays[i], modes[i], STAND_LIST, all,
                                                     tags, &expected, NULL),
                                 STATUS_OK);
            else
                expected = trace_world_brute_all(&world, packed.record, own.tri, &rays[i], modes[i],
                                                 STAND_LIST, all, tags);
            assert_int_equal(count[i], expected);
            uint32_t kept = expected < CAPACITY ? expected : CAPACITY;
            assert_memory_equal(hit + (size_t)CAPACITY * i, all, kept * sizeof *hit);
            assert_memory_equal(tag + (size_t)CAPACITY * i, tags, kept * sizeof *tag);
            for (uint32_t k = kept; k < CAPACITY; k++)
                assert_int_equal(tag[CAPACITY * i + k], 0x5A5A5A5A);
            over += expected > CAPACITY;
        }
        assert_true(over > 0);
        /* With no room there are only counts. */
        assert_int_equal(
            engine->worlds->trace_world_all(self, rays, NULL, 1, 0, NULL, NULL, count, NULL),
            STATUS_OK);
        engine->close(self);
    }
}

/* Another world, a scene, and the first world again. */
static void engines_are_prepared_anew(void **state)
{
    (void)state;
    struct world other = fixture_world("sphere:n=3", WORLD_TURNED, 3, 1);
    struct packed_world other_packed = stand_world(&other, "cwbvh80");
    struct bvh bvh;
    struct packed scene_packed;
    struct build_options options = {.leaf = 2};
    const struct scene *scene = world.mesh->scene;
    assert_int_equal(bvh_build(builder_find("median"), scene, &options, &bvh, NULL), STATUS_OK);
    assert_int_equal(packed_make(layout_find("f32"), &bvh, scene, &scene_packed, NULL), STATUS_OK);
    for (size_t e = 0; e < ARRAY_COUNT(names); e++) {
        const struct engine *engine = engine_find(names[e]);
        void *self = opened(engine, 1);
        static struct hit hit[RAYS], again[RAYS];
        static uint32_t tag[RAYS];
        struct trace_report report;
        struct world_job first = job_for(engine, QUERY_CLOSEST), second = first;
        struct job plain = {.scene = scene,
                            .packed = engine->needs_packed ? &scene_packed : NULL,
                            .box = first.box,
                            .tri = first.tri};
        second.world = &other;
        second.packed = engine->needs_packed ? &other_packed : NULL;
        for (int round = 0; round < 2; round++) {
            assert_int_equal(engine->worlds->prepare_world(self, &first, NULL), STATUS_OK);
            assert_int_equal(engine->worlds->trace_world(self, rays, NULL, RAYS,
                                                         round ? again : hit, tag, &report, NULL),
                             STATUS_OK);
            struct hit some;
            assert_int_equal(engine->worlds->prepare_world(self, &second, NULL), STATUS_OK);
            assert_int_equal(
                engine->worlds->trace_world(self, rays, NULL, 1, &some, tag, &report, NULL),
                STATUS_OK);
            assert_int_equal(engine->prepare(self, &plain, NULL), STATUS_OK);
            assert_int_equal(engine->trace(self, rays, 1, &some, &report, NULL), STATUS_OK);
        }
        assert_memory_equal(hit, again, sizeof hit);
        engine->close(self);
    }
    packed_free(&scene_packed);
    bvh_free(&bvh);
    packed_world_free(&other_packed);
    world_free(&other);
}

static void what_cannot_be_traced_is_refused(void **state)
{
    (void)state;
    struct world_trees trees = stand_trees(&world, "median", 2);
    struct packed_world edges;
    struct reason reason = {""};
    const struct engine *engine = engine_find("cpu");
    void *self = opened(engine, 1);
    assert_int_equal(packed_world_make(&world, &trees, layout_find("f32"), layout_find("f32"),
                                       tri_store_find("edges"), &edges, &reason),
                     STATUS_OK);
    struct world_job job = stand_job(&world, &edges, QUERY_CLOSEST);
    assert_int_equal(engine->worlds->prepare_world(self, &job, &reason), STATUS_OK);
    job.tri = tri_test_find("woop");
    assert_int_equal(engine->worlds->prepare_world(self, &job, &reason), STATUS_UNSUPPORTED);
    assert_non_null(strstr(reason.text, "woop"));
    /* A stack that is too short: the rays are told. */
    static struct hit hit[RAYS];
    static uint32_t tag[RAYS], count[RAYS];
    struct trace_report report;
    packed.top.stack_need = 0;
    job = stand_job(&world, &packed, QUERY_CLOSEST);
    assert_int_equal(engine->worlds->prepare_world(self, &job, &reason), STATUS_OK);
    assert_int_equal(
        engine->worlds->trace_world(self, rays, NULL, RAYS, hit, tag, &report, &reason),
        STATUS_DEVICE);
    assert_non_null(strstr(reason.text, "of 500 rays not finished"));
    assert_int_equal(
        engine->worlds->trace_world_all(self, rays, NULL, RAYS, 0, NULL, NULL, count, &reason),
        STATUS_DEVICE);
    packed.top.stack_need = packed.stack_need;
    engine->close(self);
    engine = engine_find("brute");
    self = opened(engine, 1);
    struct world bad = fixture_world("sphere:n=1", WORLD_SAME, 1, 1);
    bad.instance->m[0][0] = 0x1p-149f;
    fixture_finish(&bad);
    job = (struct world_job){.world = &bad, .tri = tri_tests[0]};
    assert_int_equal(engine->worlds->prepare_world(self, &job, &reason), STATUS_LIMIT);
    assert_non_null(strstr(reason.text, "instance 0"));
    engine->close(self);
    world_free(&bad);
    packed_world_free(&edges);
    world_trees_free(&trees);
}

/* No rays, no world: no answers. */
static void nothing_to_trace(void **state)
{
    (void)state;
    struct world empty = {0};
    fixture_finish(&empty);
    struct packed_world none = stand_world(&empty, "f32");
    for (size_t e = 0; e < ARRAY_COUNT(names); e++) {
        const struct engine *engine = engine_find(names[e]);
        void *self = opened(engine, 2);
        struct trace_report report;
        struct hit hit;
        uint32_t tag = 7;
        struct world_job job = stand_job(&empty, engine->needs_packed ? &none : NULL, QUERY_ANY);
        assert_int_equal(engine->worlds->prepare_world(self, &job, NULL), STATUS_OK);
        assert_int_equal(
            engine->worlds->trace_world(self, NULL, NULL, 0, NULL, NULL, &report, NULL), STATUS_OK);
        assert_int_equal(
            engine->worlds->trace_world(self, rays, NULL, 1, &hit, &tag, &report, NULL), STATUS_OK);
        assert_int_equal(hit.prim, ABI_NO_PRIM);
        assert_int_equal(tag, 0);
        engine->close(self);
    }
    packed_world_free(&none);
    world_free(&empty);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_ray_is_answered_in_its_place),
        cmocka_unit_test(all_hits_are_listed_with_their_tags),
        cmocka_unit_test(engines_are_prepared_anew),
        cmocka_unit_test(what_cannot_be_traced_is_refused),
        cmocka_unit_test(nothing_to_trace),
    };
    return cmocka_run_group_tests_name("world_engines", tests, make, drop);
}
