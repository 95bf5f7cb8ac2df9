/* Worlds in Embree: instances, masks, flags and filters arrive, and answers are read rightly. How
 * exact its geometry is, test_embree_world_truth.c finds out. Skipped with the reason where Embree
 * cannot run. */
#include "tests/support/world_more_laws.h"

#include "ref/base/rng.h"
#include "ref/world/world_boxes.h"
#include "scenes/worlds.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define RAYS 400

static const char *const names[] = {"embree", "embree_robust"};
static const struct engine_options options = {.threads = 2, .device = -1};

static struct laws open_named(size_t which)
{
    struct laws laws = {.engine = engine_find(names[which]), .unnamed = true};
    struct reason reason = {""};
    assert_non_null(laws.engine);
    assert_non_null(laws.engine->worlds);
    enum status status = engine_open(laws.engine, &options, &laws.self, &reason);
    if (status == STATUS_UNSUPPORTED) {
        printf("SKIP %s\n", reason.text);
        skip();
    }
    assert_int_equal(status, STATUS_OK);
    return laws;
}

static void each(void (*law)(const struct laws *laws))
{
    for (size_t which = 0; which < ARRAY_COUNT(names); which++) {
        struct laws laws = open_named(which);
        law(&laws);
        laws.engine->close(laws.self);
    }
}

/* Engine brute obeys the same laws, so that they are true. */
static void the_laws_are_those_of_brute(void **state)
{
    (void)state;
    struct laws laws = {.engine = engine_find("brute")};
    assert_int_equal(engine_open(laws.engine, &options, &laws.self, NULL), STATUS_OK);
    laws_of_names(&laws);
    laws_of_masks(&laws);
    laws_of_flags(&laws);
    laws_of_filters(&laws);
    laws_of_piles(&laws);
    laws_of_lists(&laws);
    laws_of_nothing(&laws);
    laws.engine->close(laws.self);
}

static void every_placed_triangle_has_its_number_and_tag(void **state)
{
    (void)state;
    each(laws_of_names);
}

static void masks_are_those_of_the_instances(void **state)
{
    (void)state;
    each(laws_of_masks);
}

static void flags_cull_and_decide_opacity(void **state)
{
    (void)state;
    each(laws_of_flags);
}

static void filters_decide_every_query(void **state)
{
    (void)state;
    each(laws_of_filters);
}

static void what_is_passed_over_ends_nothing(void **state)
{
    (void)state;
    each(laws_of_piles);
}

static void lists_have_every_hit_that_counts(void **state)
{
    (void)state;
    each(laws_of_lists);
}

static void worlds_and_scenes_follow_each_other(void **state)
{
    (void)state;
    each(laws_of_nothing);
}

static void bad_rays_are_misses(void **state)
{
    (void)state;
    each(laws_of_bad_rays);
}

/* --- rays that Embree aborts on --------------------------------------------------------------- */

/* A plate of instance 1, another of instance 0 that is `scale` times as large. */
static struct world two_sizes(float scale)
{
    struct world world = laws_room(1, 2);
    laws_mesh(world.mesh, (const uint32_t[]){1}, 1);
    world.instance[1].m[0][3] = LAWS_GAP;
    for (int k = 0; k < 3; k++)
        world.instance[0].m[k][k] = scale;
    laws_place(&world.instance[1], 2);
    laws_finish(&world);
    return world;
}

/* Without them the library cannot keep a ray from one instance alone. */
static bool has_masks(const struct engine *engine)
{
    char text[200];
    engine_describe(engine, &options, text, sizeof text);
    return !strstr(text, "without masks");
}

/* Rays onto both plates, whose origin is `far` away from the one of instance 0 and whose direction
 * is `length` long. */
static void fire_long(const struct laws *laws, const struct world *world, float scale, float far,
                      float length)
{
    uint32_t tag;
    struct ray small = {
        .org = {scale * 0.25f, scale * 0.25f, far}, .dir = {0, 0, -length}, .tmax = 1e30f};
    struct ray other = laws_aim(world, 1, 0, 0.25f, 0.25f, true, ray_mode_all()).ray;
    other.dir[2] *= length;
    uint32_t hit = laws_single(laws, small, &tag);
    if (length < 1e15f * scale && far < 1e15f * scale)
        assert_int_equal(hit, 0);
    else if (length > 1e19f * scale || far > 1e19f * scale) /* not given to Embree, which may */
        assert_int_equal(hit, ABI_NO_PRIM);                 /* abort or not, as it was built */
    else
        assert_true(hit == 0 || hit == ABI_NO_PRIM);
    uint32_t beside = laws_single(laws, other, &tag);
    if (length < 1e12f && has_masks(laws->engine))
        assert_int_equal(beside, 1);
}

/* A length of 1 in the world is one of 1e11 in the space of a mesh of 1e-11, where rays of 1e7
 * would abort. They do not meet that instance, but every other one. */
static void a_ray_too_long_for_one_instance_meets_the_others(void **state)
{
    (void)state;
    static const float scales[] = {1, 0x1p-10f, 0x1p-22f, 0x1p-34f, 1e-11f};
    for (size_t which = 0; which < ARRAY_COUNT(names); which++)
        for (size_t s = 0; s < ARRAY_COUNT(scales); s++) {
            struct laws laws = open_named(which);
            struct world world = two_sizes(scales[s]);
            laws_prepare(&laws, &world, QUERY_CLOSEST);
            for (float length = 1; length < 1e18f; length *= 32) {
                fire_long(&laws, &world, scales[s], 1, length);
                fire_long(&laws, &world, scales[s], length, 1);
                fire_long(&laws, &world, scales[s], length, length);
            }
            laws.engine->close(laws.self);
            world_free(&world);
        }
}

/* A hit whose t is NaN, of a determinant that is subnormal, ends the ray: Embree would abort in the
 * next instance. */
static void a_hit_without_a_number_ends_the_ray(void **state)
{
    (void)state;
    const struct ray ray = {.dir = {0, 0x1p-29f, 0}, .tmax = INFINITY};
    for (size_t which = 0; which < ARRAY_COUNT(names); which++) {
        struct laws laws = open_named(which);
        struct world world = laws_room(1, 2);
        struct trace_report report;
        struct hit hit = {.prim = 7};
        uint32_t tag;
        laws_mesh(&world.mesh[0], (const uint32_t[]){1}, 1);
        const float vertex[9] = {0x1p-53f, 0, 0, 0, 1, 0, 0, 0, 0x1p-48f};
        memcpy(world.mesh[0].scene->vertex, vertex, sizeof vertex);
        memcpy(world.instance[1].m, world.instance[0].m, sizeof world.instance[0].m);
        laws_finish(&world);
        laws_prepare(&laws, &world, QUERY_CLOSEST);
        assert_int_equal(
            laws.engine->worlds->trace_world(laws.self, &ray, NULL, 1, &hit, &tag, &report, NULL),
            STATUS_OK);
        assert_true(hit.prim < 2 || hit.prim == ABI_NO_PRIM);
        laws.engine->close(laws.self);
        world_free(&world);
    }
}

/* Transforms whose inverse Embree cannot compute are refused by the instance's number. */
static void near_singular_transforms_are_refused(void **state)
{
    (void)state;
    static const float tiny[] = {0x1p-42f, 1e-20f, 1e-30f, 1e-38f, 1e20f, 1e37f};
    for (size_t which = 0; which < ARRAY_COUNT(names); which++)
        for (size_t s = 0; s <= ARRAY_COUNT(tiny); s++) {
            struct laws laws = open_named(which);
            struct world world = two_sizes(s < ARRAY_COUNT(tiny) ? tiny[s] : 1);
            const struct world_job job = {.world = &world, .box = box_tests[0]};
            struct reason reason = {""};
            if (s == ARRAY_COUNT(tiny)) { /* columns 1 and 2 are neighbours */
                world.instance[0].m[0][1] = 1, world.instance[0].m[1][1] = 1 + 0x1p-23f;
                world.instance[0].m[1][0] = 1;
                laws_finish(&world);
            }
            assert_int_equal(laws.engine->worlds->prepare_world(laws.self, &job, &reason),
                             STATUS_UNSUPPORTED);
            assert_non_null(strstr(reason.text, "instance 0"));
            /* An instance that no ray meets is not in the way. */
            world.instance[0].mask = 0;
            laws_prepare(&laws, &world, QUERY_CLOSEST);
            laws.engine->close(laws.self);
            world_free(&world);
        }
}

/* Rays from all sides to a world; one in 13 is out of contract. */
static void make_rays_around(const struct world *world, uint64_t seed, struct ray ray[RAYS])
{
    struct box *box, all = box_empty();
    assert_int_equal(world_boxes_make(world, WORLD_BOXES_AUTO, &box, NULL), STATUS_OK);
    for (uint32_t i = 0; i < world->instance_count; i++)
        if (world_is_active(world, i))
            box_add_box(&all, &box[i]);
    free(box);
    for (uint32_t i = 0; i < RAYS; i++) {
        struct rng rng = rng_make(seed, i);
        ray[i] = (struct ray){.tmin = i % 13 ? 0.0f : -1.0f, .tmax = INFINITY};
        for (int k = 0; k < 3; k++) {
            ray[i].org[k] = rng_range(&rng, 2 * all.lo[k], 2 * all.hi[k]);
            ray[i].dir[k] = rng_range(&rng, all.lo[k], all.hi[k]) - ray[i].org[k];
        }
    }
}

static void trace_bare(const struct laws *laws, const struct world *world, bool bare,
                       enum query query, const struct ray *ray, size_t count, struct hit *hit,
                       uint32_t *tag)
{
    const struct world_job job = {
        .world = world, .box = box_tests[0], .query = query, .bare = bare};
    struct trace_report report;
    struct reason reason = {""};
    if (laws->engine->worlds->prepare_world(laws->self, &job, &reason) ||
        laws->engine->worlds->trace_world(laws->self, ray, NULL, count, hit, tag, &report, &reason))
        fail_msg("%s", reason.text);
    assert_true(report.ns >= count / 4); /* two threads; no ray takes half a nanosecond */
}

/* Without filter functions the answers are the same; what needs them has them. Embree's structures
 * are filled with 2^17 rays at a time: in a second batch a ray has the answer of the first. */
static void bare_worlds_have_the_same_answers(void **state)
{
    (void)state;
    enum { MANY = (1 << 17) + RAYS };
    static const char *const specs[] = {"placed-mirrored", "placed-turned", "nest:count=5",
                                        "mixed"};
    struct ray *ray = calloc(MANY, sizeof *ray);
    struct hit *many = calloc(MANY, sizeof *many), hit[2][RAYS];
    uint32_t *tags = calloc(MANY, sizeof *tags), tag[2][RAYS], count;
    assert_true(ray && many && tags);
    for (size_t i = 0; i < 2 * ARRAY_COUNT(names) * ARRAY_COUNT(specs); i++) {
        struct laws laws = open_named(i % 2);
        const enum query query = i / 2 % 2 ? QUERY_ANY : QUERY_CLOSEST;
        struct world world;
        struct reason reason = {""};
        size_t hits = 0;
        if (world_open(specs[i / 4], 1, &world, &reason))
            fail_msg("%s", reason.text);
        make_rays_around(&world, i / 4, ray);
        for (size_t k = RAYS; k < MANY; k++)
            ray[k] = ray[k % RAYS];
        for (int bare = 0; bare < 2; bare++)
            trace_bare(&laws, &world, bare, query, ray, RAYS, hit[bare], tag[bare]);
        assert_memory_equal(hit[0], hit[1], sizeof hit[0]);
        assert_memory_equal(tag[0], tag[1], sizeof tag[0]);
        for (uint32_t k = 0; k < RAYS; k++)
            hits += hit[0][k].prim != ABI_NO_PRIM;
        assert_in_range(hits, RAYS / 16, RAYS - RAYS / 13);
        trace_bare(&laws, &world, true, query, ray, MANY, many, tags);
        for (size_t k = 0; k < MANY; k++)
            assert_true(memcmp(&many[k], &hit[0][k % RAYS], sizeof *many) == 0 &&
                        tags[k] == tag[0][k % RAYS]);
        assert_int_equal(laws.engine->worlds->trace_world_all(laws.self, ray, NULL, 1, 1, hit[0],
                                                              tag[0], &count, &reason),
                         world.filter.kind == FILTER_ALL ? STATUS_UNSUPPORTED : STATUS_OK);
        laws.engine->close(laws.self);
        world_free(&world);
    }
    free(ray);
    free(many);
    free(tags);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_laws_are_those_of_brute),
        cmocka_unit_test(every_placed_triangle_has_its_number_and_tag),
        cmocka_unit_test(masks_are_those_of_the_instances),
        cmocka_unit_test(flags_cull_and_decide_opacity),
        cmocka_unit_test(filters_decide_every_query),
        cmocka_unit_test(what_is_passed_over_ends_nothing),
        cmocka_unit_test(lists_have_every_hit_that_counts),
        cmocka_unit_test(worlds_and_scenes_follow_each_other),
        cmocka_unit_test(bad_rays_are_misses),
        cmocka_unit_test(a_ray_too_long_for_one_instance_meets_the_others),
        cmocka_unit_test(a_hit_without_a_number_ends_the_ray),
        cmocka_unit_test(near_singular_transforms_are_refused),
        cmocka_unit_test(bare_worlds_have_the_same_answers),
    };
    return cmocka_run_group_tests_name("embree_world", tests, NULL, NULL);
}
