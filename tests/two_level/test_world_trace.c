/* Two levels against none: rays transformed here by the contract and traced through each mesh
 * alone, the brute traversal, and the trees, in all layouts of both levels. */
#include "ref/store.h"
#include "ref/trace/trace_world.h"
#include "ref/two_level/world_check.h"
#include "ref/world/object_ray.h"
#include "tests/two_level/two_level_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "tests/two_level/world_stand.h"
#include "tests/two_level/world_against_brute.h"

/* The ray in the space of a mesh, as ref/world/object_ray.h has it, written once more. */
static struct ray moved(const struct instance *instance, const struct ray *ray)
{
    struct ray out = *ray;
    float w[9];
    if (instance_is_identity(instance))
        return out;
    assert_int_equal(transform_inverse(instance->m, w, NULL), STATUS_OK);
    const float x = ray->org[0] - instance->m[0][3], y = ray->org[1] - instance->m[1][3],
                z = ray->org[2] - instance->m[2][3];
    for (int k = 0; k < 3; k++) {
        const float *row = w + 3 * k;
        float a = row[0] * x, b = row[1] * y, c = row[2] * z;
        out.org[k] = (a + b) + c;
        a = row[0] * ray->dir[0], b = row[1] * ray->dir[1], c = row[2] * ray->dir[2];
        out.dir[k] = (a + b) + c;
    }
    return out;
}

/* The nearest hit of all instances, each traced alone; the first of equal ones. */
static struct hit nearest(const struct world *world, const struct tri_test *tri,
                          const struct ray *ray)
{
    struct hit best = hit_none();
    for (uint32_t i = 0; i < world->instance_count; i++) {
        struct ray inside = moved(&world->instance[i], ray);
        struct hit hit;
        trace_brute(world_scene(world, i), tri, QUERY_CLOSEST, &inside, &hit);
        if (hit.prim == ABI_NO_PRIM || (best.prim != ABI_NO_PRIM && !(hit.t < best.t)))
            continue;
        best = hit;
        best.prim += world->first[i];
    }
    return best;
}

static void brute_is_each_mesh_alone(void **state)
{
    (void)state;
    for (uint32_t kind = 0; kind < WORLD_KINDS; kind++) {
        struct world world = fixture_world("soup:n=12,size=0.5", kind, 9, kind);
        struct packed_world packed = stand_world(&world, "f32");
        struct instance_record *record = records(&world);
        uint32_t hits = 0, later = 0;
        for (size_t t = 0; tri_tests[t]; t++)
            for (uint64_t i = 0; i < STAND_RAYS; i++) {
                struct ray ray = stand_aim(&packed, kind, i);
                struct hit expected = nearest(&world, tri_tests[t], &ray);
                struct tagged hit;
                trace_world_brute(&world, record, tri_tests[t], QUERY_CLOSEST, &ray, ray_mode_all(),
                                  &hit.hit, &hit.tag);
                assert_memory_equal(&hit.hit, &expected, sizeof expected);
                hits += hit.hit.prim != ABI_NO_PRIM;
                later += hit.hit.prim != ABI_NO_PRIM && hit.hit.prim >= 12;
                if (hit.hit.prim == ABI_NO_PRIM)
                    assert_int_equal(hit.tag, 0);
                else
                    assert_int_equal(hit.tag & ABI_TAG_CUSTOM,
                                     world.instance[hit.hit.prim / 12].custom);
            }
        assert_true(hits > 100);
        assert_true(kind == WORLD_SAME || later > 50);
        free(record);
        packed_world_free(&packed);
        world_free(&world);
    }
}

/* The published builder cuts boxes, so that its trees lose hits. */
static void trees_of_every_builder_lose_nothing(void **state)
{
    (void)state;
    for (uint32_t kind = 0; kind < WORLD_KINDS; kind++) {
        struct world world = fixture_world("soup:n=30,size=0.4", kind, 25, 40 + kind);
        for (size_t b = 0; builders_all[b]; b++)
            if (!builders_all[b]->faithful)
                assert_trees(&world, builders_all[b]->name, "f32", "f32", 100 + kind, 64);
        world_free(&world);
    }
}

/* More than 10 bits can number: the custom index tells which one was hit. */
static void instances_are_told_apart_however_many(void **state)
{
    (void)state;
    struct world world = fixture_world("soup:n=2,size=0.5", WORLD_TURNED, 1500, 90);
    struct packed_world packed = stand_world(&world, "f32");
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    uint32_t high = 0;
    for (uint64_t i = 0; i < STAND_RAYS; i++) {
        struct ray ray = stand_aim(&packed, 300, i);
        struct tagged hit = stand_trace(&job, &ray, ray_mode_all());
        if (hit.hit.prim == ABI_NO_PRIM)
            continue;
        uint32_t at = world_instance_of(&world, hit.hit.prim);
        assert_int_equal(hit.tag & ABI_TAG_CUSTOM, world.instance[at].custom);
        high += at > 1023;
    }
    assert_true(high > 10);
    packed_world_free(&packed);
    world_free(&world);
}

static void every_layout_is_a_top_and_a_bottom(void **state)
{
    (void)state;
    struct world world = fixture_world("soup:n=30,size=0.4", WORLD_TURNED, 25, 3);
    uint32_t count = 0;
    for (size_t i = 0; layouts_all[i]; i++) {
        const char *name = layouts_all[i]->name;
        if (layouts_all[i]->faithful)
            continue;
        assert_trees(&world, "median", name, "f32", 200, 32);
        assert_trees(&world, "median", "f32", name, 201, 32);
        assert_trees(&world, "median", name, name, 202, 32);
        assert_trees(&world, "median", name,
                     layouts_all[i / 2]->faithful ? "cwbvh80" : layouts_all[i / 2]->name, 203, 32);
        count++;
    }
    assert_true(count > 50);
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(brute_is_each_mesh_alone),
        cmocka_unit_test(trees_of_every_builder_lose_nothing),
        cmocka_unit_test(instances_are_told_apart_however_many),
        cmocka_unit_test(every_layout_is_a_top_and_a_bottom),
    };
    return cmocka_run_group_tests_name("world_trace", tests, NULL, NULL);
}
