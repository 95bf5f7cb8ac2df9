/* How many rays or tiles are dispatched at once, by value: limits of the device, and dispatches
 * that are quick or slow (tests/gpu/fake_vulkan.h); and how a ray of any part is named. */
#define _POSIX_C_SOURCE 200809L /* setenv */
#include "tests/gpu/fake_engines.h"

#define PARTS_MOST 128u

/* A quick dispatch takes less than 0.1 s, a slow one more than 1 s. */
enum { QUICK = 99999998, EVEN = 100000000, LONG = 1000000000, SLOW = 1000000002 };

static const uint32_t *takes;     /* ns of each dispatch; the last one is that of all others */
static uint32_t part[PARTS_MOST]; /* rays or workgroups of each */
static uint32_t parts;
static uint64_t sum_ns;

static void take_time(uint32_t amount)
{
    part[parts++ % PARTS_MOST] = amount;
    fake.ticks[0] = 5;
    fake.ticks[1] = 5 + *takes / 2;
    sum_ns += *takes;
    takes += takes[1] != 0;
}

/* The hit of a ray is its number, which its origin has. */
static void trace_part(const struct fake_dispatch *dispatch)
{
    struct push push;
    memcpy(&push, dispatch->push, sizeof push);
    all_done(dispatch);
    take_time(push.ray_count);
    assert_int_equal(dispatch->groups, (push.ray_count + 63) / 64);
    const struct ray *ray = (const void *)dispatch->part[ABI_BIND_RAYS].byte;
    struct hit *hit = (void *)dispatch->part[ABI_BIND_HITS].byte;
    uint32_t *found = (void *)dispatch->part[ABI_BIND_FOUND].byte;
    const bool lists = dispatch->constant[ABI_SPEC_QUERY] == ABI_QUERY_ALL;
    for (uint32_t i = 0; i < push.ray_count; i++) {
        hit[(size_t)i * push.capacity].prim = (uint32_t)ray[i].org[0];
        if (lists)
            found[i] = (uint32_t)ray[i].org[0] + 1;
    }
}

/* What is traced, and the parts that are to come of it, up to a 0. */
struct portion_case {
    const char *engine;
    uint32_t rays, capacity; /* capacity 0: closest hits */
    uint32_t takes[4];
    uint32_t nodes, groups; /* 0: as they are */
    uint64_t buffer_bytes;
    uint32_t want[20];
};

static void must_part(const struct portion_case *c, const struct scene *scene,
                      struct packed *packed)
{
    const struct engine *engine = engine_find(c->engine);
    const struct engine_options options = {.device = -1};
    const struct job job = {.scene = scene,
                            .packed = engine->needs_packed ? packed : NULL,
                            .box = box_test_find("robust"),
                            .tri = tri_test_find("mt"),
                            .query = c->capacity ? QUERY_ALL : QUERY_CLOSEST};
    const uint32_t capacity = c->capacity ? c->capacity : 1, nodes = packed->ref_count;
    struct ray *ray = calloc(c->rays, sizeof *ray);
    struct hit *hit = calloc((size_t)c->rays * capacity, sizeof *hit);
    uint32_t *found = calloc(c->rays, sizeof *found);
    struct reason reason = {""};
    struct trace_report report = {0};
    void *self;
    assert_true(ray && hit && found);
    for (uint32_t i = 0; i < c->rays; i++)
        ray[i].org[0] = (float)i;
    fake_reset();
    fake.run = trace_part;
    if (c->groups)
        fake.device[0].base.limits.maxComputeWorkGroupCount[0] = c->groups;
    if (c->buffer_bytes)
        fake.device[0].allocation = c->buffer_bytes;
    packed->ref_count = c->nodes ? c->nodes : nodes;
    takes = c->takes;
    parts = 0;
    sum_ns = 0;
    gpu_must(engine_open(engine, &options, &self, &reason), &reason);
    gpu_must(engine->prepare(self, &job, &reason), &reason);
    if (c->capacity)
        gpu_must(engine->trace_all(self, ray, c->rays, capacity, hit, found, &reason), &reason);
    else
        gpu_must(engine->trace(self, ray, c->rays, hit, &report, &reason), &reason);
    engine->close(self);
    must_be_clean(c->engine);
    packed->ref_count = nodes;
    for (uint32_t i = 0; i <= parts; i++)
        if (i < parts ? part[i] != c->want[i] : c->want[i] != 0)
            fail_msg("%s, %u rays, %u ns: part %u of %u has %u, not %u", c->engine, c->rays,
                     c->takes[0], i, parts, part[i], c->want[i]);
    for (uint32_t i = 0; i < c->rays; i++) {
        assert_int_equal(hit[(size_t)i * capacity].prim, i);
        assert_int_equal(found[i], c->capacity ? i + 1 : 0);
    }
    if (!c->capacity)
        assert_true(report.ns == sum_ns && report.device_clock);
    free(ray);
    free(hit);
    free(found);
}

static void must_part_all(const char *spec, const struct portion_case *cases, size_t count)
{
    struct scene scene = generated(spec);
    struct bvh bvh = median(&scene, 2);
    struct packed packed = pack("f32", &bvh, &scene);
    assert_int_equal(setenv("RAYDIFF_VULKAN_LIBRARY", "", 1), 0);
    for (size_t i = 0; i < count; i++)
        must_part(&cases[i], &scene, &packed);
    assert_int_equal(unsetenv("RAYDIFF_VULKAN_LIBRARY"), 0);
    packed_free(&packed);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* 16384 at first, or 2^25 visits of all nodes, or a workgroup; as many as the device allows. */
static void rays_of_a_tree_come_in_parts(void **state)
{
    (void)state;
    static const struct portion_case cases[] = {
        {"vulkan", 200000, 0, {QUICK}, 0, 0, 0, {16384, 32768, 65536, 85312}},
        {"vulkan", 40000, 0, {EVEN}, 0, 0, 0, {16384, 16384, 7232}},
        {"vulkan", 40000, 0, {LONG}, 0, 0, 0, {16384, 16384, 7232}},
        {"vulkan",
         33000,
         0,
         {SLOW},
         0,
         0,
         0,
         {16384, 8192, 4096, 2048, 1024, 512, 256, 128, 64, 64, 64, 64, 64, 40}},
        {"vulkan", 20000, 0, {EVEN}, 2046, 0, 0, {16384, 3616}},
        {"vulkan", 20000, 0, {EVEN}, 2047, 0, 0, {16384, 3616}},
        {"vulkan", 20000, 0, {EVEN}, 2048, 0, 0, {16376, 3624}},
        {"vulkan", 250, 0, {EVEN}, 335543, 0, 0, {100, 100, 50}},
        {"vulkan", 150, 0, {EVEN}, 1u << 20, 0, 0, {64, 64, 22}},
        {"vulkan", 1400, 0, {QUICK}, 0, 10, 0, {640, 640, 120}},
        {"vulkan", 2100, 0, {QUICK}, 0, 0, 32000, {1000, 1000, 100}},
        {"vulkan", 450, 10, {QUICK}, 0, 0, 32000, {200, 200, 50}},
        {"vulkan", 3, 2000, {QUICK}, 0, 0, 32000, {1, 1, 1}},
        {"vulkan", 16384, 0, {QUICK}, 0, 0, 0, {16384}},
    };
    must_part_all("soup:n=20", cases, ARRAY_COUNT(cases));
}

/* 2^18 of them, or as the device allows. */
static void rays_of_a_query_come_in_parts(void **state)
{
    (void)state;
    static const struct portion_case cases[] = {
        {"rayquery", 300000, 0, {QUICK}, 0, 0, 0, {262144, 37856}},
        {"rayquery", 1400, 0, {SLOW}, 0, 10, 0, {640, 640, 120}},
        {"rayquery", 2100, 0, {EVEN}, 0, 0, 32000, {1000, 1000, 100}},
        {"rayquery", 450, 10, {EVEN}, 0, 0, 32000, {200, 200, 50}},
        {"rayquery", 3, 2000, {EVEN}, 0, 0, 32000, {1, 1, 1}},
    };
    must_part_all("soup:n=20", cases, ARRAY_COUNT(cases));
}

/* 2^24 tests at first, of up to 16384 triangles in one dispatch. */
static void rays_against_all_triangles_come_in_parts(void **state)
{
    (void)state;
    static const struct portion_case few[] = {
        {"vulkan_brute", 2500, 0, {QUICK}, 0, 0, 0, {1024, 1024, 452}},
    };
    static const struct portion_case many[] = {
        {"vulkan_brute", 4000, 0, {EVEN}, 0, 0, 0, {1024, 1024, 1024, 1024, 1024, 1024, 928, 928}},
        {"vulkan_brute", 4000, 0, {QUICK}, 0, 0, 0, {1024, 1024, 2048, 2048, 928, 928}},
        {"vulkan_brute",
         4000,
         0,
         {QUICK, SLOW, EVEN},
         0,
         0,
         0,
         {1024, 1024, 1024, 1024, 1024, 1024, 928, 928}},
        {"vulkan_brute", 4000, 0, {QUICK, LONG, EVEN}, 0, 0, 0, {1024, 1024, 2048, 2048, 928, 928}},
        {"vulkan_brute", 3000, 0, {SLOW}, 0, 0, 0, {1024, 1024, 1024, 1024, 952, 952}},
    };
    must_part_all("soup:n=16383", few, ARRAY_COUNT(few));
    must_part_all("soup:n=20000", many, ARRAY_COUNT(many));
}

/* A ray whose list no buffer holds is refused, one that just fits is not. */
static void list_that_no_buffer_holds_is_refused(void **state)
{
    (void)state;
    static const char *const names[] = {"vulkan", "vulkan_brute", "rayquery"};
    struct fake_stage s = stage_make();
    assert_int_equal(setenv("RAYDIFF_VULKAN_LIBRARY", "", 1), 0);
    for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
        const struct engine *engine = engine_find(names[i]);
        const struct engine_options options = {.device = -1};
        const struct job job = {.scene = &s.scene,
                                .packed = engine->needs_packed ? &s.packed : NULL,
                                .box = box_test_find("robust"),
                                .tri = tri_test_find("mt"),
                                .query = QUERY_ALL};
        static struct hit hit[2001];
        uint32_t found;
        struct reason reason = {""};
        void *self;
        fake_reset();
        fake.run = all_done;
        fake.device[0].allocation = 32000;
        gpu_must(engine_open(engine, &options, &self, &reason), &reason);
        gpu_must(engine->prepare(self, &job, &reason), &reason);
        gpu_must(engine->trace_all(self, s.ray, 1, 2000, hit, &found, &reason), &reason);
        assert_int_equal(engine->trace_all(self, s.ray, 1, 2001, hit, &found, &reason),
                         STATUS_LIMIT);
        assert_non_null(strstr(reason.text, "2001 hits of a ray are over fake device's buffers of "
                                            "32000 bytes"));
        engine->close(self);
        must_be_clean(names[i]);
    }
    assert_int_equal(unsetenv("RAYDIFF_VULKAN_LIBRARY"), 0);
    stage_free(&s);
}

/* --- rays that are not done ------------------------------------------------------------------- */

#define NAMED 300u /* rays, 64 a dispatch */

enum way { CLOSEST, LISTS, WORLD_CLOSEST, WORLD_LISTS, TASKS, WAYS };
static float lost; /* what the ray that is not done begins at */
static uint64_t ray_bytes;

/* Every ray is done but one, which is known by its origin, wherever it stands. */
static void lose_one(const struct fake_dispatch *dispatch)
{
    const struct fake_part *rays = &dispatch->part[ABI_BIND_RAYS];
    const struct fake_part *flags = &dispatch->part[ABI_BIND_FLAGS];
    all_done(dispatch);
    for (uint64_t i = 0; (i + 1) * ray_bytes <= rays->bytes && 4 * (i + 1) <= flags->bytes; i++) {
        struct ray ray;
        memcpy(&ray, rays->byte + rays->offset + i * ray_bytes, sizeof ray);
        if (ray.org[0] == lost)
            memcpy(flags->byte + flags->offset + 4 * i, &(uint32_t){ABI_FLAG_LOOP}, 4);
    }
}

static enum status trace_world_in(const struct engine *engine, void *self,
                                  const struct world *world, bool lists, const struct ray *ray,
                                  struct reason *reason)
{
    static struct hit hit[NAMED];
    static uint32_t tag[NAMED], found[NAMED];
    struct trace_report report;
    const struct world_job job = {.world = world,
                                  .box = box_test_find("robust"),
                                  .tri = tri_test_find("mt"),
                                  .query = lists ? QUERY_ALL : QUERY_CLOSEST};
    gpu_must(engine->worlds->prepare_world(self, &job, reason), reason);
    return lists
               ? engine->worlds->trace_world_all(self, ray, NULL, NAMED, 1, hit, tag, found, reason)
               : engine->worlds->trace_world(self, ray, NULL, NAMED, hit, tag, &report, reason);
}

static enum status trace_in(const struct engine *engine, void *self, const struct fake_stage *s,
                            enum way way, const struct ray *ray, struct reason *reason)
{
    static struct hit hit[NAMED];
    static uint32_t found[NAMED];
    struct trace_report report;
    const struct job job = {.scene = &s->scene,
                            .packed = engine->needs_packed ? &s->packed : NULL,
                            .box = box_test_find("robust"),
                            .tri = tri_test_find("mt"),
                            .query = way == LISTS ? QUERY_ALL : QUERY_CLOSEST};
    if (way == TASKS) {
        struct engine_task task = {
            .job = job, .ray = ray, .ray_count = NAMED, .hit = hit, .flag = found};
        gpu_must(engine->trace_tasks(self, &task, 1, reason), reason);
        *reason = task.reason;
        return task.status;
    }
    gpu_must(engine->prepare(self, &job, reason), reason);
    return way == LISTS ? engine->trace_all(self, ray, NAMED, 1, hit, found, reason)
                        : engine->trace(self, ray, NAMED, hit, &report, reason);
}

/* Returns false where the engine has no such way. */
static bool must_name(const struct engine *engine, const struct fake_stage *s,
                      const struct world *world, enum way way, uint32_t number)
{
    const struct engine_options options = {.device = -1};
    const bool in_world = way == WORLD_CLOSEST || way == WORLD_LISTS;
    static struct ray ray[NAMED];
    char text[64];
    struct reason reason = {""};
    void *self;
    if ((in_world && (!engine->worlds || engine->needs_packed)) ||
        (way == LISTS && !engine->trace_all) || (way == TASKS && !engine->trace_tasks))
        return false;
    for (uint32_t i = 0; i < NAMED; i++)
        ray[i] = (struct ray){{(float)(7 * i), 0, 0}, 0, {1, 0, 0}, 1};
    lost = (float)(7 * number);
    ray_bytes = in_world ? ABI_WORLD_RAY * ABI_WORLD_QUAD_BYTES : sizeof(struct ray);
    fake_reset();
    fake.run = lose_one;
    if (way != TASKS)
        fake.device[0].base.limits.maxComputeWorkGroupCount[0] = 1;
    gpu_must(engine_open(engine, &options, &self, &reason), &reason);
    enum status status = in_world
                             ? trace_world_in(engine, self, world, way == WORLD_LISTS, ray, &reason)
                             : trace_in(engine, self, s, way, ray, &reason);
    engine->close(self);
    must_be_clean(engine->name);
    assert_int_equal(status, STATUS_DEVICE);
    (void)snprintf(text, sizeof text, ": ray %u was not finished: the driver ended", number);
    if (!strstr(reason.text, text))
        fail_msg("%s, way %d: '%s' is without '%s'", engine->name, (int)way, reason.text, text);
    return true;
}

/* By its number among all that were given, whatever part it comes in. */
static void ray_of_any_part_is_named_by_its_number(void **state)
{
    (void)state;
    static const uint32_t number[] = {0, 63, 64, 127, 128, 255, 256, NAMED - 1};
    struct fake_stage s = stage_make();
    struct reason reason;
    struct world world;
    assert_int_equal(setenv("RAYDIFF_VULKAN_LIBRARY", "", 1), 0);
    gpu_must(world_of_scene(&s.scene, &world, &reason), &reason);
    for (enum way way = CLOSEST; way < WAYS; way++) {
        size_t played = 0;
        for (size_t e = 0; e < ARRAY_COUNT(engine_names); e++)
            for (size_t i = 0; i < ARRAY_COUNT(number); i++)
                played += must_name(engine_find(engine_names[e]), &s, &world, way, number[i]);
        assert_true(played > 0);
    }
    assert_int_equal(unsetenv("RAYDIFF_VULKAN_LIBRARY"), 0);
    world_free(&world);
    stage_free(&s);
}

static void draw_part(const struct fake_dispatch *dispatch)
{
    all_drawn(dispatch);
    take_time(dispatch->groups);
}

/* 35 tiles, 5 at first: 2^25 visits. */
static void tiles_of_a_picture_come_in_parts(void **state)
{
    (void)state;
    static const struct {
        uint32_t takes[3], groups, want[20];
    } cases[] = {
        {{EVEN}, 0, {5, 5, 5, 5, 5, 5, 5}},
        {{LONG}, 0, {5, 5, 5, 5, 5, 5, 5}},
        {{QUICK}, 0, {5, 10, 20}},
        {{QUICK, SLOW, EVEN}, 0, {5, 10, 5, 5, 5, 5}},
        {{SLOW, SLOW, EVEN}, 0, {5, 2, 1}},
        {{QUICK}, 4, {4, 4, 4, 4, 4, 4, 4, 4, 3}},
        {{QUICK, SLOW, EVEN}, 4, {4, 4, 2, 2}},
        {{SLOW}, 0, {5, 2, 1, 1, 1}},
    };
    struct picture p = frame_picture(false);
    const uint32_t rays = p.job.look.bounces * (1 + p.job.light_count);
    p.job.tile = 8;
    p.packed.ref_count = 100000 / rays - 1;
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        struct reason reason;
        fake_reset();
        fake.run = draw_part;
        if (cases[i].groups)
            fake.device[0].base.limits.maxComputeWorkGroupCount[0] = cases[i].groups;
        takes = cases[i].takes;
        parts = 0;
        gpu_must(frame_play(&p, false, FRAME_WHOLE, &reason), &reason);
        must_be_clean("tiles");
        for (uint32_t k = 0; cases[i].want[k]; k++)
            if (part[k] != cases[i].want[k])
                fail_msg("case %zu: part %u has %u tiles, not %u", i, k, part[k], cases[i].want[k]);
    }
    picture_free(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_of_a_tree_come_in_parts),
        cmocka_unit_test(rays_of_a_query_come_in_parts),
        cmocka_unit_test(rays_against_all_triangles_come_in_parts),
        cmocka_unit_test(list_that_no_buffer_holds_is_refused),
        cmocka_unit_test(ray_of_any_part_is_named_by_its_number),
        cmocka_unit_test(tiles_of_a_picture_come_in_parts),
    };
    assert_int_equal(unsetenv("RAYDIFF_VALIDATE"), 0); /* the layer is for drivers */
    return cmocka_run_group_tests(tests, NULL, NULL);
}
