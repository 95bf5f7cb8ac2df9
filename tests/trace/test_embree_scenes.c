/* Engine embree on a scene of three triangles: which rays are traced, how lists are read, and that
 * a build leaves the thread's floating-point mode as it was. */
#include "ref/engine.h"

#include <fenv.h>
#include <stdio.h>

#include "tests/support/world_laws.h"

#if HAVE_EMBREE

#include "ref/engines/embree_modes.h"
#include "tests/support/embree_calls.h"

static const struct engine *engine;
static void *self;
static struct world_mesh mesh;

static void prepare(enum query query)
{
    const struct engine_options options = {.threads = 1, .device = -1};
    struct reason reason = {""};
    engine = engine_find("embree");
    laws_mesh(&mesh, (const uint32_t[]){3}, 1);
    const struct job job = {
        .scene = mesh.scene, .box = box_tests[0], .tri = tri_tests[0], .query = query};
    calls_forget();
    assert_int_equal(engine_open(engine, &options, &self, &reason), STATUS_OK);
    assert_int_equal(engine->prepare(self, &job, &reason), STATUS_OK);
}

static void drop(void)
{
    engine->close(self);
    scene_free(mesh.scene);
    free(mesh.scene);
    free(mesh.geometry);
}

/* --- rays ------------------------------------------------------------------------------------- */

static void rays_beside_the_contract_are_not_traced(void **state)
{
    (void)state;
    const float most = 1e18f, under = nextafterf(most, 0);
    for (int query = QUERY_CLOSEST; query <= QUERY_ALL; query++) {
        prepare((enum query)query);
        for (int word = 0; word < 8; word++)
            for (int end = 0; end < 6; end++) {
                const float range[6] = {0, nextafterf(0, -1), nextafterf(2, 1),
                                        2, nextafterf(2, 3),  NAN};
                const float wide[6] = {under, -under, most, -most, INFINITY, NAN};
                bool ends = word == 3 || word == 7, taken = end < 2;
                float words[8] = {0.25f, 0.25f, 1, 2, 0, 0, -1, 2};
                struct ray ray;
                struct hit hit;
                uint32_t count = 7;
                struct trace_report report;
                words[word] = ends ? range[end] : wide[end];
                if (word == 3)
                    taken = end == 0 || end == 2 || end == 3; /* not negative, not over 2 */
                if (word == 7)
                    taken = end == 3 || end == 4; /* not under 2 */
                memcpy(&ray, words, sizeof ray);
                calls.closest = calls.any = 0;
                enum status status = query == QUERY_ALL
                                         ? engine->trace_all(self, &ray, 1, 1, &hit, &count, NULL)
                                         : engine->trace(self, &ray, 1, &hit, &report, NULL);
                assert_int_equal(status, STATUS_OK);
                assert_int_equal(calls.closest, taken && query != QUERY_ANY);
                assert_int_equal(calls.any, taken && query == QUERY_ANY);
                if (!taken)
                    assert_true(query == QUERY_ALL ? count == 0 : hit.prim == ABI_NO_PRIM);
                if (taken) {
                    const float got[8] = {calls.ray.org_x, calls.ray.org_y, calls.ray.org_z,
                                          calls.ray.tnear, calls.ray.dir_x, calls.ray.dir_y,
                                          calls.ray.dir_z, calls.ray.tfar};
                    assert_memory_equal(got, words, sizeof got);
                    assert_int_equal(calls.ray.mask, 0xFFFFFFFFu);
                    assert_true(calls.ray.time == 0 && calls.ray.id + calls.ray.flags == 0);
                }
            }
        drop();
    }
}

/* --- lists ------------------------------------------------------------------------------------ */

static int valid;
static unsigned group;
static uint32_t repeats;

/* Finds `repeats` triangles, numbered from 5 on, for the last of a group of rays, of which Embree
 * has arrays of each number; the others are switched off, and their numbers mean nothing. */
static void answer_with_list(embree_context *context, struct RTCRayHit *query)
{
    (void)query;
    for (uint32_t i = 0; i < repeats; i++) {
        float ray[12][4], hit[8][4];
        float *ray_at = &ray[0][0], *hit_at = &hit[0][0];
        const unsigned last = group - 1, id = 0, prim = 5 + i;
        int of[4] = {0};
        memset(ray, 0x77, sizeof ray);
        memset(hit, 0x77, sizeof hit);
        ray_at[8 * group + last] = 2 + (float)i;
        memcpy(&ray_at[10 * group + last], &id, sizeof id);
        hit_at[3 * group + last] = 0.25f * (float)i;
        hit_at[4 * group + last] = 1;
        memcpy(&hit_at[5 * group + last], &prim, sizeof prim);
        of[last] = valid;
        struct RTCFilterFunctionNArguments with = {.valid = of,
                                                   .context = context,
                                                   .ray = (struct RTCRayN *)ray_at,
                                                   .hit = (struct RTCHitN *)hit_at,
                                                   .N = group};
        calls.filter(&with);
        for (unsigned k = 0; k < 4; k++)
            assert_int_equal(of[k], 0); /* what is listed is rejected */
    }
}

static void lists_have_what_the_filter_is_given(void **state)
{
    (void)state;
    const struct ray ray = {.dir = {0, 0, -1}, .tmax = 50};
    prepare(QUERY_ALL);
    calls.answer = answer_with_list;
    for (group = 1; group < 5; group++)
        for (valid = -1; valid < 1; valid++)
            for (uint32_t room = 0; room < 5; room++)
                for (repeats = 0; repeats < 7; repeats++) {
                    struct hit hit[6];
                    uint32_t count = 77;
                    memset(hit, 0x5A, sizeof hit);
                    assert_int_equal(engine->trace_all(self, &ray, 1, room, hit, &count, NULL),
                                     STATUS_OK);
                    assert_int_equal(count, valid ? repeats : 0);
                    for (uint32_t k = 0; k < 6; k++)
                        if (k < count && k < room)
                            assert_true(hit[k].prim == 5 + k && hit[k].t == 2 + (float)k &&
                                        hit[k].u == 0.25f * (float)k && hit[k].v == 1);
                        else
                            assert_int_equal(hit[k].prim, 0x5A5A5A5A);
                }
    drop();
}

/* Embree itself lists each of two triangles, one behind the other, for every ray in its place. */
static void lists_are_in_their_place(void **state)
{
    (void)state;
    enum { RAYS = 70 };
    struct ray ray[RAYS];
    struct hit hit[2 * RAYS + 1];
    uint32_t count[RAYS + 1];
    prepare(QUERY_ALL);
    for (int c = 0; c < 9; c++) /* triangle 1 behind triangle 0 */
        mesh.scene->vertex[9 + c] = mesh.scene->vertex[c] - (c % 3 == 2 ? 1.0f : 0);
    const struct job job = {
        .scene = mesh.scene, .box = box_tests[0], .tri = tri_tests[0], .query = QUERY_ALL};
    assert_int_equal(engine->prepare(self, &job, NULL), STATUS_OK);
    for (uint32_t i = 0; i < RAYS; i++)
        ray[i] = (struct ray){.org = {i % 3 ? 0.25f : 7, 0.25f, 1 + (float)i},
                              .dir = {0, 0, -1},
                              .tmax = i % 5 ? 100 : 1.5f + (float)i};
    memset(hit, 0x5A, sizeof hit);
    memset(count, 0x5A, sizeof count);
    assert_int_equal(engine->trace_all(self, ray, RAYS, 2, hit, count, NULL), STATUS_OK);
    for (uint32_t i = 0; i < RAYS; i++) {
        assert_int_equal(count[i], i % 3 == 0 ? 0 : i % 5 == 0 ? 1 : 2);
        for (uint32_t k = 0; k < count[i]; k++) {
            const struct hit *one = &hit[2 * i + k];
            assert_true(one->prim < 2 && fabsf(one->t - (float)(1 + i + one->prim)) < 1e-4f);
            assert_true(k == 0 || one->prim != hit[2 * i].prim);
        }
        assert_true(count[i] > 0 || hit[2 * i].prim == 0x5A5A5A5A);
    }
    assert_true(count[RAYS] == 0x5A5A5A5A && hit[2 * RAYS].prim == 0x5A5A5A5A);
    drop();
}

/* --- packets ---------------------------------------------------------------------------------- */

static const float told[16] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};

/* Every third lane has no hit; what is in each lane is in no other. */
static void answer_lanes(struct RTCRayHit16 *query)
{
    for (uint32_t i = 0; i < 16; i++) {
        query->ray.tfar[i] = told[i];
        query->hit.u[i] = told[i] / 32;
        query->hit.v[i] = told[i] / 64;
        query->hit.primID[i] = 100 + i;
        query->hit.geomID[i] = i % 3 ? i : RTC_INVALID_GEOMETRY_ID;
    }
}

static void hits_are_those_of_their_lanes(void **state)
{
    (void)state;
    const struct engine_options options = {.threads = 1, .device = -1};
    struct ray ray[40];
    struct hit hit[41];
    struct trace_report report;
    prepare(QUERY_CLOSEST);
    const struct job job = {.scene = mesh.scene, .box = box_tests[0], .tri = tri_tests[0]};
    void *packets;
    assert_int_equal(engine_open(embree_modes[0], &options, &packets, NULL), STATUS_OK);
    assert_int_equal(embree_modes[0]->prepare(packets, &job, NULL), STATUS_OK);
    calls.answer16 = answer_lanes;
    for (uint32_t i = 0; i < 40; i++)
        ray[i] = (struct ray){.tmin = i % 7 ? 0 : -1.0f, .dir = {0, 0, -1}, .tmax = 9};
    for (uint32_t rays = 0; rays <= 40; rays++) {
        memset(hit, 0x5A, sizeof hit);
        assert_int_equal(embree_modes[0]->trace(packets, ray, rays, hit, &report, NULL), STATUS_OK);
        for (uint32_t i = 0; i < rays; i++) {
            const uint32_t lane = i % 16;
            const struct hit want = {told[lane], told[lane] / 32, told[lane] / 64, 100 + lane},
                             miss = {.prim = ABI_NO_PRIM};
            assert_memory_equal(&hit[i], i % 7 && lane % 3 ? &want : &miss, sizeof want);
        }
        assert_int_equal(hit[rays].prim, 0x5A5A5A5A);
    }
    embree_modes[0]->close(packets);
    drop();
}

/* --- the thread ------------------------------------------------------------------------------- */

static void a_build_leaves_the_thread_as_it_was(void **state)
{
    (void)state;
    struct world world = laws_room(1, 1);
    laws_mesh(&world.mesh[0], (const uint32_t[]){1}, 1);
    laws_finish(&world);
    for (int of_world = 0; of_world < 2; of_world++) {
        prepare(QUERY_CLOSEST);
        const struct job job = {.scene = mesh.scene, .box = box_tests[0], .tri = tri_tests[0]};
        const struct world_job of = {.world = &world, .box = box_tests[0], .tri = tri_tests[0]};
        calls.rude = true;
        enum status status = of_world ? engine->worlds->prepare_world(self, &of, NULL)
                                      : engine->prepare(self, &job, NULL);
        assert_int_equal(status, STATUS_OK);
        assert_int_equal(fegetround(), FE_TONEAREST);
        drop();
    }
    world_free(&world);
}

/* --- batches ---------------------------------------------------------------------------------- */

/* Engines fill Embree's structures with 2^17 rays at a time: each ray of two batches and one more
 * has the answer that it has in a call of its own, the rejected ones have none, and the time is
 * that of all. No ray takes less than a nanosecond on one thread. */
static void every_ray_of_several_batches_has_its_answer(void **state)
{
    (void)state;
    enum { COUNT = (2 << 17) + 1 };
    const struct engine_options options = {.threads = 1, .device = -1};
    struct ray *ray = calloc(COUNT, sizeof *ray);
    struct hit *hit = calloc(COUNT, sizeof *hit), alone;
    struct trace_report report;
    assert_true(ray && hit);
    for (size_t mode = 0; mode < 3; mode++)
        for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            size_t hits = 0, none = 0;
            prepare((enum query)query);
            if (mode > 0) {
                const struct job job = {.scene = mesh.scene, .query = (enum query)query};
                engine->close(self);
                engine = embree_modes[mode - 1];
                assert_int_equal(engine_open(engine, &options, &self, NULL), STATUS_OK);
                assert_int_equal(engine->prepare(self, &job, NULL), STATUS_OK);
            }
            for (size_t i = 0; i < COUNT; i++)
                ray[i] = (struct ray){{(float)(i % 97) / 64, (float)(i % 89) / 64, 1 + (float)i},
                                      i % 11 ? 0.0f : -1.0f,
                                      {0, 0, -1},
                                      INFINITY};
            assert_int_equal(engine->trace(self, ray, COUNT, hit, &report, NULL), STATUS_OK);
            assert_true(report.ns >= COUNT && report.core_ns >= COUNT);
            for (size_t i = 0; i < COUNT; i++) {
                hits += hit[i].prim != ABI_NO_PRIM;
                none += i % 11 == 0;
                assert_true(i % 11 != 0 || hit[i].prim == ABI_NO_PRIM);
                if (i % 64 != 0 && i < COUNT - 100)
                    continue;
                assert_int_equal(engine->trace(self, &ray[i], 1, &alone, &report, NULL), STATUS_OK);
                assert_memory_equal(&alone, &hit[i], sizeof alone);
            }
            assert_in_range(hits, COUNT / 8, COUNT - none - COUNT / 8);
            drop();
        }
    free(ray);
    free(hit);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_ray_of_several_batches_has_its_answer),
        cmocka_unit_test(rays_beside_the_contract_are_not_traced),
        cmocka_unit_test(lists_have_what_the_filter_is_given),
        cmocka_unit_test(lists_are_in_their_place),
        cmocka_unit_test(hits_are_those_of_their_lanes),
        cmocka_unit_test(a_build_leaves_the_thread_as_it_was),
    };
    return calls_can_run() ? cmocka_run_group_tests_name("embree_scenes", tests, NULL, NULL) : 0;
}

#else

int main(void)
{
    puts("SKIP built without Embree");
    return 0;
}

#endif
