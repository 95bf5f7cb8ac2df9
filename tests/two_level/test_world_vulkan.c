/* Engine vulkan traces worlds to the bits of engine cpu, in every layout. Where no device can be
 * opened the tests are skipped. */
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

#include "tests/two_level/braid_stand.h"
#include "tests/two_level/world_stand.h"

#define RAYS     400
#define CAPACITY 4

static const struct engine *vulkan, *cpu;
static void *on_gpu, *on_cpu;
static struct ray rays[RAYS];
static struct ray_mode modes[RAYS];

static int open_engines(void **state)
{
    (void)state;
    struct engine_options options = {.threads = 1, .device = -1};
    struct reason reason = {""};
    vulkan = engine_find("vulkan");
    cpu = engine_find("cpu");
    if (vulkan->open(&options, &on_gpu, &reason)) {
        print_message("SKIP %s\n", reason.text);
        on_gpu = NULL;
        return 0;
    }
    return cpu->open(&options, &on_cpu, NULL) != STATUS_OK;
}

static int close_engines(void **state)
{
    (void)state;
    if (on_gpu) {
        vulkan->close(on_gpu);
        cpu->close(on_cpu);
    }
    return 0;
}

/* Several meshes, one of them empty, several geometries, all flags; some instances not active. */
static struct world mixed_world(enum filter_kind filter, float spread)
{
    struct world world = fixture_room(3, 24);
    fixture_mesh(&world, 0, "soup:n=40,size=0.6", 5);
    fixture_mesh(&world, 1, "soup:n=0", 1);
    fixture_mesh(&world, 2, "sphere:n=3", 3);
    for (uint32_t i = 0; i < 24; i++) {
        struct rng rng = rng_make(4, i);
        struct instance *instance = &world.instance[i];
        enum world_kind kind = i % 4 == 0 ? WORLD_MIRRORED : i % 4 == 1 ? WORLD_SAME : WORLD_TURNED;
        fixture_transform(kind, 100 + i, instance->m);
        for (int k = 0; k < 3; k++)
            instance->m[k][3] *= spread;
        instance->mesh = i % 2 * 2;
        instance->mask = 1 + rng_below(&rng, 255);
        instance->flags = rng_below(&rng, 12);
        if (i % 6 == 5)
            instance->mesh = i % 12 == 5 ? 1 : WORLD_NO_MESH;
    }
    world.instance[3].mask = 0;
    world.filter = (struct filter_rule){filter, 99, 128};
    fixture_finish(&world);
    return world;
}

static void make_rays(const struct packed_world *packed)
{
    static const uint32_t flags[] = {0,
                                     ABI_RAY_FIRST,
                                     ABI_RAY_CULL_BACK,
                                     ABI_RAY_CULL_FRONT | ABI_RAY_NO_OPAQUE,
                                     ABI_RAY_OPAQUE | ABI_RAY_FIRST,
                                     ABI_RAY_CULL_OPAQUE,
                                     ABI_RAY_CULL_NO_OPAQUE | ABI_RAY_CULL_BACK,
                                     ABI_RAY_SKIP_CLOSEST,
                                     ABI_RAY_SKIP_TRIANGLES};
    for (uint32_t i = 0; i < RAYS; i++) {
        rays[i] = stand_aim(packed, 12, i);
        modes[i] = (struct ray_mode){i % 5 ? 0xFF : i % 256, flags[i % ARRAY_COUNT(flags)]};
    }
}

/* Both engines with one job: hits and tags of all rays. */
static uint32_t assert_same(const struct world_job *job, bool with_modes)
{
    static struct hit hit[2][RAYS];
    static uint32_t tag[2][RAYS];
    struct reason reason = {""};
    struct trace_report report;
    uint32_t hits = 0;
    const struct ray_mode *mode = with_modes ? modes : NULL;
    if (vulkan->worlds->prepare_world(on_gpu, job, &reason) ||
        vulkan->worlds->trace_world(on_gpu, rays, mode, RAYS, hit[0], tag[0], &report, &reason) ||
        cpu->worlds->prepare_world(on_cpu, job, &reason) ||
        cpu->worlds->trace_world(on_cpu, rays, mode, RAYS, hit[1], tag[1], &report, &reason))
        fail_msg("%s: %s", job->packed->top.layout->name, reason.text);
    for (uint32_t i = 0; i < RAYS; i++) {
        if (memcmp(&hit[0][i], &hit[1][i], sizeof **hit) != 0 || tag[0][i] != tag[1][i])
            fail_msg("%s, %s, %s, %s: ray %u: %u at %a, tag %x; cpu %u at %a, tag %x",
                     job->packed->top.layout->name, job->box->name, job->tri->name,
                     query_name(job->query), i, hit[0][i].prim, (double)hit[0][i].t, tag[0][i],
                     hit[1][i].prim, (double)hit[1][i].t, tag[1][i]);
        hits += hit[0][i].prim != ABI_NO_PRIM;
    }
    return hits;
}

/* Lists in the order of finding, and nothing behind them. */
static void assert_same_lists(struct world_job job, uint32_t capacity)
{
    static struct hit hit[2][RAYS * CAPACITY];
    static uint32_t tag[2][RAYS * CAPACITY], count[2][RAYS];
    struct reason reason = {""};
    job.query = QUERY_ALL;
    memset(hit, 0x5A, sizeof hit);
    memset(tag, 0x5A, sizeof tag);
    if (vulkan->worlds->prepare_world(on_gpu, &job, &reason) ||
        vulkan->worlds->trace_world_all(on_gpu, rays, modes, RAYS, capacity, hit[0], tag[0],
                                        count[0], &reason) ||
        cpu->worlds->prepare_world(on_cpu, &job, &reason) ||
        cpu->worlds->trace_world_all(on_cpu, rays, modes, RAYS, capacity, hit[1], tag[1], count[1],
                                     &reason))
        fail_msg("%s", reason.text);
    assert_memory_equal(count[0], count[1], sizeof count[0]);
    assert_memory_equal(hit[0], hit[1], sizeof hit[0]);
    assert_memory_equal(tag[0], tag[1], sizeof tag[0]);
}

static void every_layout_has_the_bits_of_cpu(void **state)
{
    (void)state;
    if (!on_gpu)
        skip();
    uint32_t count = 0;
    for (size_t i = 0; layouts_all[i]; i++) {
        struct world world = mixed_world((enum filter_kind)(i % 4), 1);
        struct world_trees trees = stand_trees(&world, "median", 3);
        struct packed_world packed;
        struct reason reason = {""};
        if (packed_world_make(&world, &trees, layouts_all[i], layouts_all[i], tri_stores[0],
                              &packed, &reason))
            fail_msg("%s: %s", layouts_all[i]->name, reason.text);
        make_rays(&packed);
        struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
        assert_true(assert_same(&job, true) > (layouts_all[i]->faithful ? 0 : RAYS / 8));
        if (i % 3 == 0)
            assert_same_lists(job, CAPACITY);
        count++;
        packed_world_free(&packed);
        world_trees_free(&trees);
        world_free(&world);
    }
    assert_true(count > 50);
}

/* Tops with parts of instances: the shader reads their records, trees and instances, and tests its
 * boxes as wide. */
static void parts_of_instances_have_the_bits_of_cpu(void **state)
{
    (void)state;
    if (!on_gpu)
        skip();
    uint32_t count = 0;
    for (uint32_t i = 0; layouts_all[i]; i++) {
        if (i % 5)
            continue;
        struct world world = mixed_world((enum filter_kind)((i + 2) % 4), 1);
        struct world_build build = stand_build("sah_sweep", 1 + i % 3);
        struct world_trees trees;
        struct packed_world packed;
        struct reason reason = {""};
        build.braid = 3 + i % 5;
        if (world_trees_make(&world, &build, &trees, &reason) ||
            packed_world_make(&world, &trees, layouts_all[i], layouts_all[i], tri_stores[0],
                              &packed, &reason))
            fail_msg("%s: %s", layouts_all[i]->name, reason.text);
        assert_true(packed.entry_count > 50 && packed.share > 0);
        make_rays(&packed);
        struct world_job job = stand_job(&world, &packed, i % 2 ? QUERY_CLOSEST : QUERY_ANY);
        job.box = box_tests[i % 3];
        assert_true(assert_same(&job, true) > (layouts_all[i]->faithful ? 0 : RAYS / 8));
        assert_same_lists(job, CAPACITY);
        count++;
        packed_world_free(&packed);
        world_trees_free(&trees);
        world_free(&world);
    }
    assert_true(count > 10);
}

/* Two parts an instance, and a filter that reads the instance's number. */
static void parts_are_filtered_as_their_instances(void **state)
{
    (void)state;
    if (!on_gpu)
        skip();
    struct world world = bars_world(40, 2);
    world.mesh[0].geometry[0].opaque = false;
    world.filter = (struct filter_rule){FILTER_TRIANGLES, 3, 128};
    struct packed_world packed = braid_world(&world, "sah_sweep", "f32", 2);
    for (uint32_t i = 0; i < packed.entry_count - 40; i++)
        assert_int_equal(packed.instance[40 + i], i / 2);
    make_rays(&packed);
    const struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    assert_true(assert_same(&job, false) > RAYS / 8);
    assert_same_lists(job, CAPACITY);
    packed_world_free(&packed);
    world_free(&world);
}

static void every_test_and_query(void **state)
{
    (void)state;
    if (!on_gpu)
        skip();
    struct world world = mixed_world(FILTER_CELLS, 1);
    struct packed_world packed = stand_world(&world, "f32");
    make_rays(&packed);
    for (size_t b = 0; box_tests[b]; b++)
        for (size_t t = 0; tri_tests[t]; t++) {
            const struct world_job job = {.world = &world,
                                          .packed = &packed,
                                          .box = box_tests[b],
                                          .tri = tri_tests[t],
                                          .query = t % 2 ? QUERY_ANY : QUERY_CLOSEST};
            assert_true(assert_same(&job, true) > RAYS / 8);
        }
    struct world_job job = stand_job(&world, &packed, QUERY_ANY);
    assert_true(assert_same(&job, false) > RAYS / 4);
    for (uint32_t capacity = 0; capacity <= CAPACITY; capacity++)
        assert_same_lists(job, capacity);
    packed_world_free(&packed);
    world_free(&world);
}

static void every_storage_of_meshes(void **state)
{
    (void)state;
    if (!on_gpu)
        skip();
    struct world world = fixture_room(1, 12);
    fixture_mesh(&world, 0, "grid:n=5", 3);
    for (uint32_t i = 0; i < 12; i++)
        fixture_transform(WORLD_TURNED, 30 + i, world.instance[i].m);
    fixture_finish(&world);
    struct world_trees trees = stand_trees(&world, "median", 3);
    uint32_t count = 0;
    for (size_t s = 0; tri_stores[s]; s++) {
        struct packed_world packed;
        struct reason reason = {""};
        const char *layout = s % 2 ? "half4" : "f32";
        if (packed_world_make(&world, &trees, layout_find(layout), layout_find(layout),
                              tri_stores[s], &packed, &reason))
            continue;
        struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
        for (size_t t = 0; !tri_store_answers(tri_stores[s], job.tri->id); t++)
            job.tri = tri_tests[t];
        make_rays(&packed);
        assert_true(assert_same(&job, false) > RAYS / 8);
        count++;
        packed_world_free(&packed);
    }
    assert_true(count >= 5);
    world_trees_free(&trees);
    world_free(&world);
}

static void worlds_without_anything(void **state)
{
    (void)state;
    if (!on_gpu)
        skip();
    struct world world = {0};
    fixture_finish(&world);
    struct packed_world packed = stand_world(&world, "f32");
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    assert_int_equal(assert_same(&job, false), 0);
    packed_world_free(&packed);
    world = fixture_world("soup:n=0", WORLD_SAME, 3, 1);
    packed = stand_world(&world, "cwbvh80");
    job = stand_job(&world, &packed, QUERY_CLOSEST);
    assert_int_equal(assert_same(&job, false), 0);
    packed_world_free(&packed);
    world_free(&world);
}

static void what_cannot_be_traced_is_refused(void **state)
{
    (void)state;
    if (!on_gpu)
        skip();
    struct world world = mixed_world(FILTER_ALL, 1);
    struct world_trees trees = stand_trees(&world, "median", 2);
    struct packed_world packed = stand_packed(&world, &trees, "f32", "cwbvh80");
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    struct reason reason = {""};
    struct trace_report report;
    struct hit hit;
    uint32_t tag;
    assert_int_equal(vulkan->worlds->prepare_world(on_gpu, &job, &reason), STATUS_UNSUPPORTED);
    assert_non_null(strstr(reason.text, "the top is in f32 and mesh 0 in cwbvh80"));
    assert_int_equal(
        vulkan->worlds->trace_world(on_gpu, rays, NULL, 1, &hit, &tag, &report, &reason),
        STATUS_DEVICE);
    packed_world_free(&packed);
    /* A stack that is too short is noticed, and nothing beyond it is written. */
    packed = stand_packed(&world, &trees, "f32", "f32");
    make_rays(&packed);
    packed.stack_need = ABI_STACK_MAX + 1;
    assert_int_equal(vulkan->worlds->prepare_world(on_gpu, &job, &reason), STATUS_LIMIT);
    packed_world_free(&packed);
    world_trees_free(&trees);
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_layout_has_the_bits_of_cpu),
        cmocka_unit_test(parts_of_instances_have_the_bits_of_cpu),
        cmocka_unit_test(parts_are_filtered_as_their_instances),
        cmocka_unit_test(every_test_and_query),
        cmocka_unit_test(every_storage_of_meshes),
        cmocka_unit_test(worlds_without_anything),
        cmocka_unit_test(what_cannot_be_traced_is_refused),
    };
    return cmocka_run_group_tests_name("world_vulkan", tests, open_engines, close_engines);
}
