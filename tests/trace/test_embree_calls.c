/* What the engines of Embree call: with what devices, scenes and geometries are made, that all of
 * them are released, what comes of it if Embree has no memory, and what rays are in packets. */
#include <stdio.h>

#include "tests/support/world_laws.h"

#if HAVE_EMBREE

#include "ref/engines/embree_modes.h"
#include "tests/support/embree_calls.h"

#include <omp.h>

#define MODES 4 /* embree, embree_robust, embree_16, embree_high */

static const struct engine_options one = {.threads = 1, .device = -1};

static const struct engine *mode_at(size_t which)
{
    static const char *const names[] = {"embree", "embree_robust"};
    return which < 2 ? engine_find(names[which]) : embree_modes[which - 2];
}

static void *opened(const struct engine *engine, const struct engine_options *options)
{
    struct reason reason = {""};
    void *self = NULL;
    if (engine_open(engine, options, &self, &reason))
        fail_msg("%s: %s", engine->name, reason.text);
    return self;
}

static void expect_alive(int devices, int scenes)
{
    assert_int_equal(calls.devices, devices);
    assert_int_equal(calls.scenes, scenes);
    assert_int_equal(calls.geometries + calls.buffers, 0); /* scenes hold theirs */
}

/* A mesh of two geometries, an empty one, one of one geometry; all are placed. */
static struct world three_meshes(void)
{
    struct world world = laws_room(3, 5);
    laws_mesh(&world.mesh[0], (const uint32_t[]){1, 0, 2}, 3);
    laws_mesh(&world.mesh[1], (const uint32_t[]){0}, 1);
    laws_mesh(&world.mesh[2], (const uint32_t[]){4}, 1);
    for (uint32_t i = 0; i < 5; i++)
        world.instance[i].mesh = i % 3;
    laws_finish(&world);
    return world;
}

/* --- devices ---------------------------------------------------------------------------------- */

static void a_device_has_the_threads_that_are_wanted(void **state)
{
    (void)state;
    for (size_t which = 0; which < MODES; which++)
        for (unsigned threads = 0; threads < 12; threads++)
            for (int avx512 = 0; avx512 < 2; avx512++) {
                const struct engine_options options = {
                    .threads = threads, .device = -1, .avx512 = avx512};
                char text[64];
                calls_forget();
                void *self = opened(mode_at(which), &options);
                snprintf(text, sizeof text, "threads=%u%s",
                         threads ? threads : (unsigned)omp_get_max_threads(),
                         avx512 ? ",frequency_level=simd512" : "");
                assert_string_equal(calls.config, text);
                expect_alive(1, 0);
                mode_at(which)->close(self);
                expect_alive(0, 0);
            }
}

static void without_a_device_there_is_no_engine(void **state)
{
    (void)state;
    for (size_t which = 0; which < MODES; which++) {
        struct reason reason = {""};
        char text[200];
        void *self = &reason;
        calls_forget();
        calls.no_device = true;
        calls.error = RTC_ERROR_UNSUPPORTED_CPU;
        assert_int_equal(engine_open(mode_at(which), &one, &self, &reason), STATUS_UNSUPPORTED);
        assert_null(self);
        assert_string_equal(reason.text, "Embree: no device for this processor (error 5)");
        mode_at(which)->close(self);
        engine_describe(mode_at(which), &one, text, sizeof text);
        assert_string_equal(text, "no device for this processor");
        assert_int_equal(calls.made, 0);
        expect_alive(0, 0);
    }
}

static void what_it_is_is_described(void **state)
{
    (void)state;
    for (size_t which = 0; which < MODES; which++)
        for (unsigned threads = 1; threads < 4; threads++)
            for (int without = 0; without < 2; without++) {
                const struct engine_options options = {.threads = threads, .device = -1};
                char text[200], want[200];
                calls_forget();
                calls.no_ray_masks = without;
                calls.version[0] = 7, calls.version[1] = 11, calls.version[2] = 13;
                engine_describe(mode_at(which), &options, text, sizeof text);
                snprintf(want, sizeof want, "Embree 7.11.13, %u threads%s", threads,
                         without ? ", without masks of rays" : "");
                assert_string_equal(text, want);
                assert_int_equal(calls.made, 1);
                expect_alive(0, 0);
            }
}

/* --- scenes ----------------------------------------------------------------------------------- */

static struct job job_of(const struct scene *scene, enum query query)
{
    return (struct job){.scene = scene, .box = box_tests[0], .tri = tri_tests[0], .query = query};
}

static struct world_job world_job_of(const struct world *world, enum query query)
{
    return (struct world_job){
        .world = world, .box = box_tests[0], .tri = tri_tests[0], .query = query};
}

/* Jobs of scenes and worlds follow each other, each for every query. */
static void what_was_prepared_before_is_released(void **state)
{
    (void)state;
    struct world world = three_meshes();
    for (size_t which = 0; which < MODES; which++) {
        const struct engine *engine = mode_at(which);
        struct reason reason = {""};
        calls_forget();
        void *self = opened(engine, &one);
        for (int round = 0; round < 12; round++) {
            const enum query query = (enum query)(round % 3);
            const struct job job = job_of(world.mesh[round / 3 % 3].scene, query);
            const struct world_job of_world = world_job_of(&world, query);
            assert_int_equal(engine->prepare(self, &job, &reason), STATUS_OK);
            expect_alive(1, 1);
            if (!engine->worlds || round % 2)
                continue;
            for (int again = 0; again < 2; again++) {
                assert_int_equal(engine->worlds->prepare_world(self, &of_world, &reason),
                                 STATUS_OK);
                expect_alive(1, 3); /* the top, and meshes that have triangles */
            }
        }
        engine->close(self);
        expect_alive(0, 0);
    }
    world_free(&world);
}

static void scenes_have_the_flags_of_their_engine(void **state)
{
    (void)state;
    struct world world = three_meshes();
    for (size_t which = 0; which < MODES; which++)
        for (int compact = 0; compact < 2; compact++) {
            const struct engine_options options = {.threads = 1, .device = -1, .compact = compact};
            const struct engine *engine = mode_at(which);
            const unsigned flag = (which == 1 ? 1u : 0u) | (compact ? 2u : 0u);
            struct reason reason = {""};
            calls_forget();
            void *self = opened(engine, &options);
            const struct job job = job_of(world.mesh[0].scene, QUERY_CLOSEST);
            const struct world_job of_world = world_job_of(&world, QUERY_CLOSEST);
            unsigned scenes = 1;
            assert_int_equal(engine->prepare(self, &job, &reason), STATUS_OK);
            if (engine->worlds) {
                scenes += 3;
                assert_int_equal(engine->worlds->prepare_world(self, &of_world, &reason),
                                 STATUS_OK);
            }
            for (unsigned f = 0; f < 4; f++)
                assert_int_equal(calls.flags[f], f == flag ? scenes : 0);
            assert_true(calls.qualities[0] + calls.qualities[1] == 0);
            assert_int_equal(calls.qualities[RTC_BUILD_QUALITY_HIGH], which == 3 ? scenes : 0);
            engine->close(self);
        }
    world_free(&world);
}

/* Filters cost time: scenes have one for lists alone, worlds unless they are bare. */
static void geometries_have_a_filter_where_it_is_needed(void **state)
{
    (void)state;
    struct world world = three_meshes();
    for (size_t which = 0; which < 2; which++)
        for (int query = QUERY_CLOSEST; query <= QUERY_ALL; query++)
            for (int kind = FILTER_ALL; kind <= FILTER_NONE; kind++)
                for (int bare = 0; bare < 2; bare++) {
                    const struct engine *engine = mode_at(which);
                    const struct job job = job_of(world.mesh[0].scene, (enum query)query);
                    struct world_job of_world = world_job_of(&world, (enum query)query);
                    struct reason reason = {""};
                    void *self = opened(engine, &one);
                    calls_forget();
                    assert_int_equal(engine->prepare(self, &job, &reason), STATUS_OK);
                    assert_int_equal(calls.filters[0], query == QUERY_ALL);
                    assert_int_equal(calls.filters[1], 0);
                    calls_forget();
                    world.filter.kind = (enum filter_kind)kind;
                    of_world.bare = bare;
                    assert_int_equal(engine->worlds->prepare_world(self, &of_world, &reason),
                                     STATUS_OK);
                    const unsigned count = bare && kind == FILTER_ALL ? 0 : 3;
                    assert_int_equal(calls.filters[0], count);
                    assert_int_equal(calls.filters[1], count);
                    assert_int_equal(calls.bytes, 12 * 4 + 16); /* indices, and room behind */
                    engine->close(self);
                }
    world_free(&world);
}

/* --- failures --------------------------------------------------------------------------------- */

static void no_memory_of_embree_is_no_memory(void **state)
{
    (void)state;
    struct world world = three_meshes();
    for (size_t which = 0; which < MODES; which++) {
        const struct engine *engine = mode_at(which);
        const struct job job = job_of(world.mesh[2].scene, QUERY_CLOSEST);
        const struct world_job of_world = world_job_of(&world, QUERY_CLOSEST);
        calls_forget();
        void *self = opened(engine, &one);
        for (unsigned at = 1; at <= 3; at++) {
            struct reason reason = {""};
            calls.no_memory = at;
            enum status status = engine->prepare(self, &job, &reason);
            assert_int_equal(status, at < 3 ? STATUS_MEMORY : STATUS_OK);
            assert_string_equal(reason.text, at < 3 ? "Embree: no memory for 4 triangles" : "");
            expect_alive(1, 1);
        }
        for (unsigned at = 1; engine->worlds && at <= 9; at++) {
            struct reason reason = {""};
            char text[64] = "";
            calls.no_memory = at;
            enum status status = engine->worlds->prepare_world(self, &of_world, &reason);
            assert_int_equal(status, at < 9 ? STATUS_MEMORY : STATUS_OK);
            if (at < 9)
                snprintf(text, sizeof text, "Embree: no memory for %d triangles", at < 5 ? 3 : 4);
            assert_string_equal(reason.text, text);
            assert_int_equal(calls.geometries + calls.buffers, 0);
        }
        engine->close(self);
        expect_alive(0, 0);
    }
    world_free(&world);
}

static void expect_error(enum status status, const char *doing, struct reason *reason)
{
    char text[64];
    bool memory = calls.error == RTC_ERROR_OUT_OF_MEMORY;
    snprintf(text, sizeof text, "Embree: error %d while %s", (int)calls.error, doing);
    assert_int_equal(status, memory ? STATUS_MEMORY : STATUS_DEVICE);
    assert_string_equal(reason->text, text);
    *reason = (struct reason){""};
}

/* Each error of Embree's, after each thing that can have it. */
static void errors_are_those_of_the_device(void **state)
{
    (void)state;
    const struct ray ray = {.org = {0.25f, 0.25f, 1}, .dir = {0, 0, -1}, .tmax = 9};
    struct world world = three_meshes();
    for (size_t which = 0; which < MODES; which++)
        for (int error = RTC_ERROR_UNKNOWN; error <= RTC_ERROR_CANCELLED; error++) {
            const struct engine *engine = mode_at(which);
            const struct world_tracer *worlds = engine->worlds;
            const struct job job = job_of(world.mesh[0].scene, QUERY_CLOSEST);
            const struct world_job of_world = world_job_of(&world, QUERY_CLOSEST);
            struct trace_report report;
            struct reason reason = {""};
            struct hit hit;
            uint32_t count, tag;
            calls_forget();
            void *self = opened(engine, &one);
            assert_int_equal(engine->prepare(self, &job, &reason), STATUS_OK);
            calls.error = (enum RTCError)error;
            expect_error(engine->trace(self, &ray, 1, &hit, &report, &reason), "tracing", &reason);
            if (engine->trace_all)
                expect_error(engine->trace_all(self, &ray, 1, 1, &hit, &count, &reason), "tracing",
                             &reason);
            expect_error(engine->prepare(self, &job, &reason), "building", &reason);
            if (worlds) {
                expect_error(worlds->prepare_world(self, &of_world, &reason), "building", &reason);
                calls.error = RTC_ERROR_NONE;
                assert_int_equal(worlds->prepare_world(self, &of_world, &reason), STATUS_OK);
                calls.error = (enum RTCError)error;
                expect_error(worlds->trace_world(self, &ray, NULL, 1, &hit, &tag, &report, &reason),
                             "tracing", &reason);
                expect_error(
                    worlds->trace_world_all(self, &ray, NULL, 1, 1, &hit, &tag, &count, &reason),
                    "tracing", &reason);
            }
            engine->close(self);
            expect_alive(0, 0);
        }
    world_free(&world);
}

/* --- rays ------------------------------------------------------------------------------------- */

static struct ray ray_number(uint32_t i)
{
    const float x = (float)i;
    return (struct ray){.org = {0.25f + x, 1 + x, 2 + x},
                        .tmin = 0.125f * x,
                        .dir = {3 + x, 4 + x, -5 - x},
                        .tmax = 100 + x};
}

static void expect_lane(const struct RTCRay16 *packet, uint32_t i, const struct ray *ray)
{
    const float got[8] = {packet->org_x[i], packet->org_y[i], packet->org_z[i], packet->tnear[i],
                          packet->dir_x[i], packet->dir_y[i], packet->dir_z[i], packet->tfar[i]};
    assert_memory_equal(got, ray, sizeof got);
    assert_true(packet->time[i] == 0 && packet->mask[i] == 0xFFFFFFFFu);
    assert_true(packet->id[i] == i && packet->flags[i] == 0);
}

/* The last packet has what is left; rays that Embree aborts on are switched off, and so are lanes
 * behind the last. What is switched off is a ray that harms nothing. */
static void packets_have_every_ray_in_its_lane(void **state)
{
    (void)state;
    enum { RAYS = 70 };
    const struct engine *engine = mode_at(2);
    const struct ray nothing = {.dir = {0, 0, 1}};
    struct world world = three_meshes();
    struct ray ray[RAYS];
    struct hit hit[RAYS + 1];
    for (uint32_t bad = 0; bad < 3; bad++)
        for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++)
            for (uint32_t count = 0; count <= RAYS; count++) {
                const struct job job = job_of(world.mesh[0].scene, (enum query)query);
                struct trace_report report;
                struct reason reason = {""};
                calls_forget();
                void *self = opened(engine, &one);
                for (uint32_t i = 0; i < RAYS; i++) {
                    ray[i] = ray_number(i);
                    if (bad && i % (bad + 1) == 0)
                        ray[i].tmin = -1;
                }
                memset(hit, 0x5A, sizeof hit);
                assert_int_equal(engine->prepare(self, &job, &reason), STATUS_OK);
                assert_int_equal(engine->trace(self, ray, count, hit, &report, &reason), STATUS_OK);
                assert_int_equal(calls.packets[query == QUERY_ANY], (count + 15) / 16);
                assert_int_equal(calls.packets[query != QUERY_ANY], 0);
                assert_int_equal(calls.closest + calls.any, 0);
                for (uint32_t lane = 0; count && lane < 16; lane++) {
                    uint32_t i = (count - 1) / 16 * 16 + lane;
                    bool on = i < count && !(bad && i % (bad + 1) == 0);
                    assert_int_equal(calls.valid[lane], on ? -1 : 0);
                    expect_lane(&calls.packet, lane, on ? &ray[i] : &nothing);
                }
                for (uint32_t i = 0; i < count; i++)
                    assert_int_equal(hit[i].prim, ABI_NO_PRIM);
                assert_int_equal(hit[count].prim, 0x5A5A5A5A);
                engine->close(self);
            }
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_device_has_the_threads_that_are_wanted),
        cmocka_unit_test(without_a_device_there_is_no_engine),
        cmocka_unit_test(what_it_is_is_described),
        cmocka_unit_test(what_was_prepared_before_is_released),
        cmocka_unit_test(scenes_have_the_flags_of_their_engine),
        cmocka_unit_test(geometries_have_a_filter_where_it_is_needed),
        cmocka_unit_test(no_memory_of_embree_is_no_memory),
        cmocka_unit_test(errors_are_those_of_the_device),
        cmocka_unit_test(packets_have_every_ray_in_its_lane),
    };
    return calls_can_run() ? cmocka_run_group_tests_name("embree_calls", tests, NULL, NULL) : 0;
}

#else

int main(void)
{
    puts("SKIP built without Embree");
    return 0;
}

#endif
