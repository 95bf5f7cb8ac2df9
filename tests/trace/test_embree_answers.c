/* How answers of Embree are read in worlds: this file answers in its place, with numbers that the
 * world has and with others, and calls the filter as Embree would. */
#include "ref/engine.h"

#include <stdio.h>

#include "tests/support/world_laws.h"

#if HAVE_EMBREE

#include "tests/support/embree_calls.h"

#define PHANTOM 0xFFFFFFFEu

static const struct engine *engine;
static void *self;
static struct world world;

/* What the next answer is made of. */
static struct RTCRayHit said;
static struct RTCRay inside; /* in the space of the mesh */
static int valid, valid_after;
static unsigned group;
static uint32_t repeats;

/* Instances 0, 3: a mesh of three geometries, the second empty; 1: none; 2, 4: one of one. */
static void prepare(bool bare, enum query query)
{
    const struct engine_options options = {.threads = 1, .device = -1};
    struct reason reason = {""};
    engine = engine_find("embree");
    world = laws_room(2, 5);
    laws_mesh(&world.mesh[0], (const uint32_t[]){2, 0, 3}, 3);
    laws_mesh(&world.mesh[1], (const uint32_t[]){1}, 1);
    for (uint32_t i = 0; i < 5; i++) {
        world.instance[i].mesh = i % 3 ? 1 : 0;
        world.instance[i].custom = 0x111 * (i + 1);
    }
    world.instance[1].mesh = WORLD_NO_MESH;
    laws_finish(&world);
    const struct world_job job = {
        .world = &world, .box = box_tests[0], .tri = tri_tests[0], .query = query, .bare = bare};
    calls_forget();
    assert_int_equal(engine_open(engine, &options, &self, &reason), STATUS_OK);
    assert_int_equal(engine->worlds->prepare_world(self, &job, &reason), STATUS_OK);
}

static void drop(void)
{
    engine->close(self);
    world_free(&world);
}

static struct hit traced(struct ray_mode mode, uint32_t *tag)
{
    const struct ray ray = {.dir = {0, 0, -1}, .tmax = 50};
    struct trace_report report;
    struct reason reason = {""};
    struct hit hit;
    if (engine->worlds->trace_world(self, &ray, &mode, 1, &hit, tag, &report, &reason))
        fail_msg("%s", reason.text);
    return hit;
}

/* The filter, for a group of `group` rays of which the first is valid or not. */
static void filtered(embree_context *context, struct RTCHit *hit)
{
    struct RTCFilterFunctionNArguments with = {.valid = &valid_after,
                                               .context = context,
                                               .ray = (struct RTCRayN *)&inside,
                                               .hit = (struct RTCHitN *)hit,
                                               .N = group};
    valid_after = valid;
    calls.filter(&with);
}

/* Writes the answer of `said`; no filter is called. */
static void answer_plainly(embree_context *context, struct RTCRayHit *query)
{
    (void)context;
    query->hit = said.hit;
    query->ray.tfar = said.ray.tfar;
}

/* Finds it `repeats` times, each as the filter has it. */
static void answer_filtered(embree_context *context, struct RTCRayHit *query)
{
    for (uint32_t i = 0; i < repeats; i++) {
        struct RTCHit hit = said.hit;
        filtered(context, &hit);
        if (valid_after == -1) {
            query->hit = hit;
            query->ray.tfar = inside.tfar;
        }
    }
}

static void say(uint32_t instance, uint32_t geometry, uint32_t tri, float side)
{
    said = (struct RTCRayHit){.ray = {.tfar = 5},
                              .hit = {.Ng_x = side,
                                      .u = 0.25f,
                                      .v = 0.5f,
                                      .primID = tri,
                                      .geomID = geometry,
                                      .instID = {instance}}};
    inside = (struct RTCRay){.dir_x = 1, .tfar = 5};
    valid = -1, group = 1, repeats = 1;
}

/* The number of that triangle; PHANTOM: there is none. */
static uint32_t number_of(uint32_t instance, uint32_t geometry, uint32_t tri)
{
    if (instance >= 5 || instance == 1)
        return PHANTOM;
    const struct world_mesh *mesh = &world.mesh[world.instance[instance].mesh];
    if (geometry >= mesh->geometry_count || tri >= mesh->geometry[geometry].count)
        return PHANTOM;
    return world.first[instance] + mesh->geometry[geometry].first + tri;
}

/* Every number of three, those just behind the last, and the greatest. */
static void numbers_that_no_world_has_are_a_phantom(void **state)
{
    (void)state;
    static const uint32_t number[] = {0, 1, 2, 3, 4, 5, 6, PHANTOM, 0xFFFFFFFFu};
    for (int with_filter = 0; with_filter < 2; with_filter++) {
        prepare(false, QUERY_CLOSEST);
        calls.answer = with_filter ? answer_filtered : answer_plainly;
        for (uint32_t n = 0; n < 9 * 9 * 9; n++)
            for (int front = 0; front < 2; front++) {
                const uint32_t i = number[n / 81], g = number[n / 9 % 9], t = number[n % 9];
                const uint32_t want = number_of(i, g, t);
                uint32_t tag = 7;
                /* Unfiltered it is the side; filtered the normal, against the ray in front. */
                say(i, g, t, (float)(with_filter ? 1 - 2 * front : front));
                struct hit hit = traced(ray_mode_all(), &tag);
                if (g == RTC_INVALID_GEOMETRY_ID) {
                    assert_true(hit.prim == ABI_NO_PRIM && tag == 0);
                    continue;
                }
                assert_int_equal(hit.prim, want);
                assert_true(hit.t == 5 && hit.u == 0.25f && hit.v == 0.5f);
                if (want == PHANTOM)
                    assert_int_equal(tag, 0);
                else
                    assert_int_equal(tag, 0x111 * (i + 1) | (front ? ABI_TAG_FRONT : 0));
            }
        drop();
    }
}

/* In lists, too; and what is listed is rejected, so that the ray goes on. */
static void lists_have_what_the_filter_is_given(void **state)
{
    (void)state;
    prepare(false, QUERY_ALL);
    calls.answer = answer_filtered;
    const struct ray ray = {.dir = {0, 0, -1}, .tmax = 50};
    for (uint32_t of = 0; of < 4; of++) /* a group of one alone, whose ray is valid */
        for (uint32_t room = 0; room < 5; room++)
            for (uint32_t times = 0; times < 7; times++)
                for (uint32_t instance = 0; instance < 7; instance++) {
                    struct reason reason = {""};
                    struct hit hit[6];
                    uint32_t tag[6], count;
                    memset(hit, 0x5A, sizeof hit);
                    memset(tag, 0x5A, sizeof tag);
                    say(instance, 0, 0, -1);
                    repeats = times;
                    group = of == 2 ? 0 : of == 3 ? 4 : 1;
                    valid = of == 1 ? 0 : -1;
                    assert_int_equal(engine->worlds->trace_world_all(self, &ray, NULL, 1, room, hit,
                                                                     tag, &count, &reason),
                                     STATUS_OK);
                    const uint32_t prim = number_of(instance, 0, 0);
                    assert_int_equal(count, of ? 0 : times);
                    if (times)
                        assert_int_equal(valid_after, of >= 2 ? -1 : 0);
                    for (uint32_t k = 0; k < 6; k++) {
                        bool written = k < count && k < room;
                        assert_int_equal(hit[k].prim, written ? prim : 0x5A5A5A5A);
                        if (written)
                            assert_int_equal(tag[k], prim == PHANTOM
                                                         ? 0
                                                         : 0x111 * (instance + 1) | ABI_TAG_FRONT);
                        else
                            assert_int_equal(tag[k], 0x5A5A5A5A);
                    }
                }
    drop();
}

/* A hit whose t is NaN ends the closest hit, whatever comes after it; a list goes on. */
static void a_hit_without_a_number_is_the_last(void **state)
{
    (void)state;
    for (uint32_t times = 1; times < 4; times++) {
        uint32_t tag = 7;
        prepare(false, QUERY_CLOSEST);
        calls.answer = answer_filtered;
        say(3, 2, 1, -1);
        inside.tfar = NAN;
        repeats = times;
        struct hit hit = traced(ray_mode_all(), &tag);
        assert_int_equal(valid_after, 0);
        assert_int_equal(hit.prim, number_of(3, 2, 1));
        assert_int_equal(tag, 0x444 | ABI_TAG_FRONT);
        assert_true(hit.t != hit.t && hit.u == 0.25f && hit.v == 0.5f);
        drop();
    }
}

/* After it every candidate is rejected, and changes nothing. */
static void answer_twice(embree_context *context, struct RTCRayHit *query)
{
    struct RTCHit hit = said.hit;
    inside.tfar = NAN;
    filtered(context, &hit);
    inside.tfar = 2;
    hit.instID[0] = 4, hit.geomID = 0, hit.primID = 0;
    filtered(context, &hit);
    assert_int_equal(valid_after, 0);
    query->hit = hit; /* as if it had not been */
    query->ray.tfar = 2;
}

static void what_follows_it_is_rejected(void **state)
{
    (void)state;
    uint32_t tag = 7;
    prepare(false, QUERY_CLOSEST);
    calls.answer = answer_twice;
    say(3, 2, 1, -1);
    struct hit hit = traced(ray_mode_all(), &tag);
    assert_int_equal(hit.prim, number_of(3, 2, 1));
    assert_int_equal(tag, 0x444 | ABI_TAG_FRONT);
    assert_true(hit.t != hit.t);
    drop();
}

/* --- sides ------------------------------------------------------------------------------------ */

/* Directions and normals of small whole numbers, all products of which are exact: what is seen is
 * the side that the ray comes from, and the back if it is in the plane. */
static void expect_sides(void)
{
    uint32_t level = 0;
    for (uint32_t at = 0; at < 6; at++)
        for (uint32_t n = 0; n < 27 * 27; n++)
            for (uint32_t flags = 0; flags <= ABI_INSTANCE_FLIP_FACING;
                 flags += ABI_INSTANCE_FLIP_FACING) {
                int d[3], normal[3], side = 0;
                uint32_t rest = n, tag;
                for (int k = 0; k < 3; k++, rest /= 3)
                    d[k] = (int)(rest % 3) - 1;
                for (int k = 0; k < 3; k++, rest /= 3)
                    normal[k] = (int)(rest % 3) * (k + 1) - 2;
                for (int k = 0; k < 3; k++)
                    side += d[k] * normal[k];
                laws_place(&world.instance[3], at);
                world.instance[3].flags = flags;
                say(3, 2, 1, (float)normal[0]);
                said.hit.Ng_y = (float)normal[1];
                said.hit.Ng_z = (float)normal[2];
                inside.dir_x = (float)d[0], inside.dir_y = (float)d[1], inside.dir_z = (float)d[2];
                struct ray ray = {.tmax = 50};
                for (int k = 0; k < 3; k++)
                    for (int j = 0; j < 3; j++)
                        ray.dir[k] += world.instance[3].m[k][j] * (float)d[j];
                struct trace_report report;
                struct hit hit;
                assert_int_equal(
                    engine->worlds->trace_world(self, &ray, NULL, 1, &hit, &tag, &report, NULL),
                    STATUS_OK);
                assert_int_equal(hit.prim, number_of(3, 2, 1));
                bool front = (side < 0) != (flags != 0);
                assert_int_equal(tag, 0x444 | (front ? ABI_TAG_FRONT : 0));
                level += side == 0;
            }
    assert_true(level > 100);
}

static void the_filter_sees_the_side_in_the_mesh(void **state)
{
    (void)state;
    prepare(false, QUERY_CLOSEST);
    calls.answer = answer_filtered;
    expect_sides();
    drop();
}

static void without_it_the_side_is_seen_from_the_world(void **state)
{
    (void)state;
    prepare(true, QUERY_CLOSEST);
    calls.answer = answer_plainly;
    expect_sides();
    drop();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_that_no_world_has_are_a_phantom),
        cmocka_unit_test(lists_have_what_the_filter_is_given),
        cmocka_unit_test(a_hit_without_a_number_is_the_last),
        cmocka_unit_test(what_follows_it_is_rejected),
        cmocka_unit_test(the_filter_sees_the_side_in_the_mesh),
        cmocka_unit_test(without_it_the_side_is_seen_from_the_world),
    };
    return calls_can_run() ? cmocka_run_group_tests_name("embree_answers", tests, NULL, NULL) : 0;
}

#else

int main(void)
{
    puts("SKIP built without Embree");
    return 0;
}

#endif
