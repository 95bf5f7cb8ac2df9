/* How many rays of a world are dispatched at once, by value: limits of the device, of lists, and
 * dispatches that are quick or slow (tests/gpu/fake_vulkan.h); what the report sums up; and what
 * one part of the placed triangles leaves to the next. */
#define _POSIX_C_SOURCE 200809L /* setenv */
#include "tests/gpu/fake_engines.h"

#define PARTS_MOST 128u

/* A quick dispatch takes less than 0.1 s, a slow one more than 1 s. */
enum { QUICK = 99999998, EVEN = 100000000, LONG = 1000000000, SLOW = 1000000002 };

static struct {
    const uint32_t *takes;     /* ns of each dispatch; the last one is that of all others */
    uint32_t part[PARTS_MOST]; /* rays of each dispatch */
    uint32_t parts;
    uint32_t unclocked; /* the dispatch whose timestamps cannot be read; 0: none, 1: the first */
    uint64_t sum_ns;
} seen;

/* The hit of a ray is its number, which its origin has, and how many parts of the triangles were
 * tested. */
static void trace_part(const struct fake_dispatch *dispatch)
{
    struct world_push push;
    memcpy(&push, dispatch->push, sizeof push);
    all_done(dispatch);
    seen.part[seen.parts++ % PARTS_MOST] = push.ray_count;
    fake.ticks[0] = 5;
    fake.ticks[1] = 5 + *seen.takes / 2;
    fake.no_ticks = seen.parts == seen.unclocked;
    seen.sum_ns += *seen.takes;
    seen.takes += seen.takes[1] != 0;
    assert_int_equal(dispatch->groups, (push.ray_count + 63) / 64);
    const size_t ray_words = 4 * ABI_WORLD_RAY,
                 hit_words = 4 * (size_t)ABI_WORLD_HIT * push.capacity;
    const uint32_t *ray = (const void *)dispatch->part[ABI_BIND_RAYS].byte;
    uint32_t *hit = (void *)dispatch->part[ABI_BIND_HITS].byte;
    const uint32_t *hit_before = (const void *)dispatch->part[ABI_BIND_NODES].byte;
    uint32_t *found = (void *)dispatch->part[ABI_BIND_FOUND].byte;
    const uint32_t *found_before = (const void *)dispatch->part[ABI_BIND_ITEMS].byte;
    const bool lists = dispatch->constant[ABI_SPEC_QUERY] == ABI_QUERY_ALL;
    for (size_t i = 0; i < push.ray_count; i++) {
        float number;
        memcpy(&number, &ray[ray_words * i], sizeof number);
        uint32_t *out = hit + hit_words * i;
        out[3] = (uint32_t)number;
        out[4] = 1;
        if (lists)
            found[i] = push.first ? found_before[i] + 1 : 1;
        else
            out[4] += push.first ? hit_before[hit_words * i + 4] : 0;
    }
}

/* What is traced, and the dispatches that are to come of it, up to a 0. */
struct world_portion {
    const char *engine;
    uint32_t rays, capacity; /* capacity 0: closest hits */
    uint32_t takes[4];
    uint32_t groups; /* 0: as they are */
    uint64_t buffer_bytes;
    uint32_t want[20];
    uint32_t parts; /* of the placed triangles */
};

static void must_part(const struct world_portion *c, const struct world *world, uint32_t unclocked)
{
    const struct engine *engine = engine_find(c->engine);
    const struct engine_options options = {.device = -1};
    const struct world_job job = {.world = world,
                                  .box = box_test_find("robust"),
                                  .tri = tri_test_find("mt"),
                                  .query = c->capacity ? QUERY_ALL : QUERY_CLOSEST};
    const uint32_t capacity = c->capacity ? c->capacity : 1;
    const size_t hits = (size_t)c->rays * capacity;
    struct ray *ray = calloc(c->rays, sizeof *ray);
    struct hit *hit = calloc(hits, sizeof *hit);
    uint32_t *tag = calloc(hits, sizeof *tag), *found = calloc(c->rays, sizeof *found);
    struct reason reason = {""};
    struct trace_report report = {0};
    void *self;
    assert_true(ray && hit && tag && found);
    for (uint32_t i = 0; i < c->rays; i++)
        ray[i].org[0] = (float)i;
    fake_reset();
    fake.run = trace_part;
    if (c->groups)
        fake.device[0].base.limits.maxComputeWorkGroupCount[0] = c->groups;
    if (c->buffer_bytes)
        fake.device[0].allocation = c->buffer_bytes;
    memset(&seen, 0, sizeof seen);
    seen.takes = c->takes;
    seen.unclocked = unclocked;
    gpu_must(engine_open(engine, &options, &self, &reason), &reason);
    gpu_must(engine->worlds->prepare_world(self, &job, &reason), &reason);
    if (c->capacity)
        gpu_must(engine->worlds->trace_world_all(self, ray, NULL, c->rays, capacity, hit, tag,
                                                 found, &reason),
                 &reason);
    else
        gpu_must(engine->worlds->trace_world(self, ray, NULL, c->rays, hit, tag, &report, &reason),
                 &reason);
    engine->close(self);
    must_be_clean(c->engine);
    for (uint32_t i = 0; i <= seen.parts && !unclocked; i++) /* else its time is the host's */
        if (i < seen.parts ? seen.part[i] != c->want[i] : c->want[i] != 0)
            fail_msg("%s, %u rays, %u ns: dispatch %u of %u has %u rays, not %u", c->engine,
                     c->rays, c->takes[0], i, seen.parts, seen.part[i], c->want[i]);
    for (uint32_t i = 0; i < c->rays; i++) {
        assert_int_equal(hit[(size_t)i * capacity].prim, i);
        assert_int_equal(tag[(size_t)i * capacity], c->capacity ? 1 : c->parts);
        assert_int_equal(found[i], c->capacity ? c->parts : 0);
    }
    if (!c->capacity && !unclocked)
        assert_true(report.ns == seen.sum_ns);
    if (!c->capacity)
        assert_int_equal(report.device_clock, unclocked == 0 || unclocked > seen.parts);
    free(ray);
    free(hit);
    free(tag);
    free(found);
}

static void must_part_all(const char *spec, const struct world_portion *cases, size_t count)
{
    struct scene scene = generated(spec);
    struct world world;
    struct reason reason = {""};
    assert_int_equal(setenv("RAYDIFF_VULKAN_LIBRARY", "", 1), 0);
    gpu_must(world_of_scene(&scene, &world, &reason), &reason);
    for (size_t i = 0; i < count; i++)
        for (uint32_t unclocked = 0; unclocked < (cases[i].capacity ? 1 : 5); unclocked++)
            must_part(&cases[i], &world, unclocked);
    assert_int_equal(unsetenv("RAYDIFF_VULKAN_LIBRARY"), 0);
    world_free(&world);
    scene_free(&scene);
}

/* 4096 at first, then as they are quick or slow; as many as the device allows, and of lists 2^20
 * hits. A ray has 48 bytes, a hit 32. */
static void rays_of_a_world_come_in_parts(void **state)
{
    (void)state;
    static const struct world_portion cases[] = {
        {"vulkan_brute", 30000, 0, {EVEN, QUICK}, 0, 0, {4096, 4096, 8192, 13616}, 1},
        {"vulkan_brute", 9000, 0, {EVEN}, 0, 0, {4096, 4096, 808}, 1},
        {"vulkan_brute", 9000, 0, {LONG}, 0, 0, {4096, 4096, 808}, 1},
        {"vulkan_brute",
         8400,
         0,
         {SLOW},
         0,
         0,
         {4096, 2048, 1024, 512, 256, 128, 64, 64, 64, 64, 64, 16},
         1},
        {"vulkan_brute", 1400, 0, {QUICK}, 10, 0, {640, 640, 120}, 1},
        {"vulkan_brute", 2100, 0, {QUICK}, 0, 48000, {1000, 1000, 100}, 1},
        {"vulkan_brute", 450, 10, {EVEN}, 0, 64000, {200, 200, 50}, 1},
        {"vulkan_brute", 450, 10, {EVEN}, 0, 63999, {199, 199, 52}, 1},
        {"vulkan_brute", 3, 2000, {EVEN}, 0, 64000, {1, 1, 1}, 1},
        {"vulkan_brute", 2100, 1024, {QUICK}, 0, 0, {1024, 1024, 52}, 1},
        {"vulkan_brute", 3, (1u << 20) + 1, {QUICK}, 0, 0, {1, 1, 1}, 1},
        {"vulkan_brute", 2100, 1, {QUICK}, 0, 48000, {1000, 1000, 100}, 1},
        {"rayquery", 9000, 0, {EVEN}, 0, 0, {4096, 4096, 808}, 1},
        {"rayquery", 1400, 0, {QUICK}, 10, 0, {640, 640, 120}, 1},
        {"rayquery", 450, 10, {EVEN}, 0, 64000, {200, 200, 50}, 1},
    };
    must_part_all("soup:n=20", cases, ARRAY_COUNT(cases));
}

/* 16384 placed triangles a dispatch: each part reads what the part before wrote, and a batch
 * takes as long as all of its parts. */
static void all_placed_triangles_are_tested_in_parts(void **state)
{
    (void)state;
    static const struct world_portion two[] = {
        {"vulkan_brute", 5000, 0, {EVEN}, 0, 0, {4096, 4096, 904, 904}, 2},
        {"vulkan_brute", 9000, 0, {QUICK / 2 - 1}, 0, 0, {4096, 4096, 4904, 4904}, 2},
        {"vulkan_brute", 9000, 0, {QUICK}, 0, 0, {4096, 4096, 4096, 4096, 808, 808}, 2},
        {"vulkan_brute", 5000, 0, {SLOW / 2 - 1}, 0, 0, {4096, 4096, 904, 904}, 2},
        {"vulkan_brute", 8192, 0, {SLOW / 2 + 1, EVEN}, 0, 0, {4096, 4096, 4096, 4096}, 2},
        {"vulkan_brute", 450, 10, {EVEN}, 0, 960000, {450, 450}, 2},
    };
    static const struct world_portion three[] = {
        {"vulkan_brute", 50, 0, {EVEN, QUICK, LONG, EVEN}, 0, 0, {50, 50, 50}, 3},
        {"vulkan_brute", 50, 3, {EVEN}, 0, 0, {50, 50, 50}, 3},
    };
    must_part_all("soup:n=20000", two, ARRAY_COUNT(two));
    must_part_all("soup:n=32769", three, ARRAY_COUNT(three));
}

/* A ray whose list no buffer holds is refused, one that just fits is not. */
static void list_of_a_world_that_no_buffer_holds_is_refused(void **state)
{
    (void)state;
    struct fake_stage s = stage_make();
    struct world world;
    struct reason reason = {""};
    assert_int_equal(setenv("RAYDIFF_VULKAN_LIBRARY", "", 1), 0);
    gpu_must(world_of_scene(&s.scene, &world, &reason), &reason);
    for (size_t i = 0; i < ARRAY_COUNT(world_names); i++) {
        const struct engine *engine = engine_find(world_names[i]);
        const struct engine_options options = {.device = -1};
        const struct world_job job = {.world = &world,
                                      .box = box_test_find("robust"),
                                      .tri = tri_test_find("mt"),
                                      .query = QUERY_ALL};
        static struct hit hit[2001];
        static uint32_t tag[2001];
        uint32_t found;
        void *self;
        fake_reset();
        fake.run = all_done;
        fake.device[0].allocation = 64000;
        gpu_must(engine_open(engine, &options, &self, &reason), &reason);
        gpu_must(engine->worlds->prepare_world(self, &job, &reason), &reason);
        gpu_must(
            engine->worlds->trace_world_all(self, s.ray, NULL, 1, 2000, hit, tag, &found, &reason),
            &reason);
        assert_int_equal(
            engine->worlds->trace_world_all(self, s.ray, NULL, 1, 2001, hit, tag, &found, &reason),
            STATUS_LIMIT);
        assert_non_null(strstr(reason.text, "2001 hits of a ray are over fake device's buffers of "
                                            "64000 bytes"));
        engine->close(self);
        must_be_clean(world_names[i]);
    }
    assert_int_equal(unsetenv("RAYDIFF_VULKAN_LIBRARY"), 0);
    world_free(&world);
    stage_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_of_a_world_come_in_parts),
        cmocka_unit_test(all_placed_triangles_are_tested_in_parts),
        cmocka_unit_test(list_of_a_world_that_no_buffer_holds_is_refused),
    };
    assert_int_equal(unsetenv("RAYDIFF_VALIDATE"), 0); /* the layer is for drivers */
    return cmocka_run_group_tests_name("parts of worlds", tests, NULL, NULL);
}
