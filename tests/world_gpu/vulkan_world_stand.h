/* Engines vulkan and cpu with one world. Includes cmocka.h, whose macros must come last. */
#ifndef VULKAN_WORLD_STAND_H
#define VULKAN_WORLD_STAND_H

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

static inline int open_engines(void **state)
{
    (void)state;
    struct engine_options options = {.threads = 1, .device = -1};
    struct reason reason = {""};
    vulkan = engine_find("vulkan");
    cpu = engine_find("cpu");
    if (engine_open(vulkan, &options, &on_gpu, &reason)) {
        print_message("SKIP %s\n", reason.text);
        on_gpu = NULL;
        return 0;
    }
    return engine_open(cpu, &options, &on_cpu, NULL) != STATUS_OK;
}

static inline int close_engines(void **state)
{
    (void)state;
    if (on_gpu) {
        vulkan->close(on_gpu);
        cpu->close(on_cpu);
    }
    return 0;
}

/* Several meshes, one of them empty, several geometries, all flags; some instances not active. */
static inline struct world mixed_world(enum filter_kind filter)
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

static inline void make_rays(const struct packed_world *packed)
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
static inline uint32_t assert_same(const struct world_job *job, bool with_modes)
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

/* A job of box test b and triangle test t, closest and any hits by turns. */
static inline struct world_job job_of_tests(const struct world *world,
                                            const struct packed_world *packed, size_t b, size_t t)
{
    return (struct world_job){.world = world,
                              .packed = packed,
                              .box = box_tests[b],
                              .tri = tri_tests[t],
                              .query = t % 2 ? QUERY_ANY : QUERY_CLOSEST};
}

/* Lists in the order of finding, and nothing behind them. */
static inline void assert_same_lists(struct world_job job, uint32_t capacity)
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

#endif
