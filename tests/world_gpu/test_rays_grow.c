/* Rays in any number after any other, as hits and as lists: each dispatch has buffers that hold
 * what it is told to read and to write, and the pipeline of its query. The device is that of
 * tests/gpu/fake_vulkan.h. */
#define _DEFAULT_SOURCE /* setenv */
#include "tests/gpu/fake_engines.h"

#include "ref/base/rng.h"

#define CALLS     60
#define RAYS_MOST 700u
#define CAPACITY  4u

static struct job job; /* what is traced now */
static bool lists;
static uint32_t workgroup; /* that was asked for; 0: none */
static size_t dispatched;

static void holds(const struct fake_dispatch *dispatch, uint32_t binding, uint64_t bytes,
                  const char *what)
{
    if (dispatch->part[binding].bytes < bytes)
        fail_msg("%s: %llu bytes of %llu", what, (unsigned long long)dispatch->part[binding].bytes,
                 (unsigned long long)bytes);
}

static void holds_all(const struct fake_dispatch *dispatch)
{
    struct push push;
    memcpy(&push, dispatch->push, sizeof push);
    const uint64_t rays = push.ray_count;
    assert_in_range(rays, 1, RAYS_MOST);
    assert_true(lists || push.capacity == 1);
    holds(dispatch, ABI_BIND_RAYS, rays * sizeof(struct ray), "rays");
    holds(dispatch, ABI_BIND_HITS, rays * push.capacity * sizeof(struct hit), "hits");
    holds(dispatch, ABI_BIND_FLAGS, rays * sizeof(uint32_t), "flags");
    if (lists)
        holds(dispatch, ABI_BIND_FOUND, rays * sizeof(uint32_t), "counts of lists");
    /* The pipeline is that of the query, whatever was prepared before. */
    assert_int_equal(dispatch->constant[ABI_SPEC_QUERY], job.query);
    /* So are the workgroups, as many as hold the rays. */
    const uint32_t size = workgroup ? workgroup : ABI_WORKGROUP;
    assert_int_equal(dispatch->constant[ABI_SPEC_WORKGROUP], size);
    assert_int_equal(dispatch->groups, (rays + size - 1) / size);
    dispatched++;
    all_done(dispatch);
}

/* Prepares at times, always for another query; then as many rays as may be. */
static void trace_by_turns(const struct engine *engine, const struct fake_stage *s)
{
    static struct ray ray[RAYS_MOST];
    static struct hit hit[RAYS_MOST * CAPACITY];
    static uint32_t count[RAYS_MOST];
    const struct engine_options options = {.device = -1, .workgroup = workgroup};
    struct rng rng = rng_make(9, 0);
    struct reason reason = {""};
    struct trace_report report;
    void *self;
    job = (struct job){.scene = &s->scene,
                       .packed = engine->needs_packed ? &s->packed : NULL,
                       .box = box_test_find("robust"),
                       .tri = tri_test_find("mt")};
    fake_reset();
    fake.run = holds_all;
    for (uint32_t i = 0; i < RAYS_MOST; i++)
        ray[i] = s->ray[i % RAYS];
    gpu_must(engine_open(engine, &options, &self, &reason), &reason);
    for (int i = 0; i < CALLS; i++) {
        const uint32_t rays = 1 + rng_below(&rng, 1u << rng_below(&rng, 10)) % RAYS_MOST;
        if (i % 6 == 0) {
            lists = engine->trace_all && i % 12;
            job.query = lists ? QUERY_ALL : i % 24 ? QUERY_ANY : QUERY_CLOSEST;
            gpu_must(engine->prepare(self, &job, &reason), &reason);
        }
        dispatched = 0;
        gpu_must(lists ? engine->trace_all(self, ray, rays, 1 + rng_below(&rng, CAPACITY), hit,
                                           count, &reason)
                       : engine->trace(self, ray, rays, hit, &report, &reason),
                 &reason);
        assert_true(dispatched > 0);
    }
    engine->close(self);
    must_be_clean(engine->name);
}

static void buffers_hold_what_is_traced(void **state)
{
    (void)state;
    struct fake_stage s = stage_make();
    assert_int_equal(setenv("RAYDIFF_VULKAN_LIBRARY", "", 1), 0);
    static const uint32_t asked[] = {0, 1, 17, 64, 100};
    for (size_t i = 0; i < ARRAY_COUNT(engine_names); i++)
        for (size_t k = 0; k < ARRAY_COUNT(asked); k++) {
            workgroup = asked[k];
            trace_by_turns(engine_find(engine_names[i]), &s);
        }
    workgroup = 0;
    assert_int_equal(unsetenv("RAYDIFF_VULKAN_LIBRARY"), 0);
    stage_free(&s);
}

/* A job that could not be prepared, whichever call of the device failed, is not traced, and neither
 * is the one before it; the next one is. */
static void what_was_not_prepared_is_not_traced(void **state)
{
    (void)state;
    struct fake_stage s = stage_make();
    assert_int_equal(setenv("RAYDIFF_VULKAN_LIBRARY", "", 1), 0);
    for (size_t i = 0; i < ARRAY_COUNT(engine_names); i++) {
        const struct engine *engine = engine_find(engine_names[i]);
        const struct engine_options options = {.device = -1};
        bool failed = true;
        for (uint32_t at = 1; failed; at++) {
            struct reason reason = {""};
            struct trace_report report;
            struct hit hit[RAYS];
            void *self;
            lists = false;
            job = (struct job){.scene = &s.scene,
                               .packed = engine->needs_packed ? &s.packed : NULL,
                               .box = box_test_find("robust"),
                               .tri = tri_test_find("mt"),
                               .query = QUERY_CLOSEST};
            fake_reset();
            fake.run = holds_all;
            gpu_must(engine_open(engine, &options, &self, &reason), &reason);
            gpu_must(engine->prepare(self, &job, &reason), &reason);
            job.query = QUERY_ANY;
            fake.fail_at = fake.calls + at;
            fake.result = VK_ERROR_OUT_OF_DEVICE_MEMORY;
            const enum status status = engine->prepare(self, &job, &reason);
            failed = fake.failed != NULL;
            assert_int_equal(status != STATUS_OK, failed);
            fake.fail_at = 0;
            dispatched = 0;
            assert_int_equal(engine->trace(self, s.ray, RAYS, hit, &report, &reason),
                             failed ? STATUS_DEVICE : STATUS_OK);
            assert_int_equal(dispatched > 0, !failed);
            gpu_must(engine->prepare(self, &job, &reason), &reason);
            gpu_must(engine->trace(self, s.ray, RAYS, hit, &report, &reason), &reason);
            engine->close(self);
            must_be_clean(engine->name);
        }
    }
    assert_int_equal(unsetenv("RAYDIFF_VULKAN_LIBRARY"), 0);
    stage_free(&s);
}

/* A device by its name, and behind it the driver. */
static void engines_tell_their_device_and_its_driver(void **state)
{
    (void)state;
    assert_int_equal(setenv("RAYDIFF_VULKAN_LIBRARY", "", 1), 0);
    for (size_t i = 0; i < ARRAY_COUNT(engine_names); i++) {
        const struct engine_options options = {.device = -1};
        char text[400];
        fake_reset();
        (void)strcpy(fake.device[0].base.deviceName, "Card 7");
        fake.device[0].driver_name = "Driver X";
        fake.device[0].driver_info = "12.5";
        engine_describe(engine_find(engine_names[i]), &options, text, sizeof text);
        if (!strstr(text, "Card 7 (Driver X 12.5"))
            fail_msg("%s: %s", engine_names[i], text);
        must_be_clean(engine_names[i]);
    }
    assert_int_equal(unsetenv("RAYDIFF_VULKAN_LIBRARY"), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(buffers_hold_what_is_traced),
        cmocka_unit_test(what_was_not_prepared_is_not_traced),
        cmocka_unit_test(engines_tell_their_device_and_its_driver),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
