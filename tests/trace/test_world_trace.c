/* Two levels against none: rays transformed here by the contract and traced through each mesh alone,
 * the brute traversal, and the trees, in all layouts of both levels. */
#include "ref/store.h"
#include "ref/trace/trace_world.h"
#include "ref/two_level/world_check.h"
#include "ref/world/object_ray.h"
#include "tests/trace/world_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "tests/trace/world_stand.h"

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

static struct instance_record *records(const struct world *world)
{
    struct instance_record *record;
    assert_int_equal(world_records_make(world, &record, NULL), STATUS_OK);
    return record;
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

/* --- trees against none ----------------------------------------------------------------------- */

/* What a world looks like without trees. */
struct brute_answers {
    struct tagged nearest;
    struct tagged_list all;
};

static void brute_answer(const struct world *world, const struct instance_record *record,
                         const struct tri_test *tri, const struct ray *ray,
                         struct brute_answers *out)
{
    static struct hit hit[STAND_LIST];
    static uint32_t tag[STAND_LIST];
    trace_world_brute(world, record, tri, QUERY_CLOSEST, ray, ray_mode_all(), &out->nearest.hit,
                      &out->nearest.tag);
    out->all.count =
        trace_world_brute_all(world, record, tri, ray, ray_mode_all(), STAND_LIST, hit, tag);
    assert_true(out->all.count <= STAND_LIST);
    tagged_fill(&out->all, hit, tag, false);
}

static bool is_listed(const struct tagged_list *all, const struct tagged *hit)
{
    for (uint32_t i = 0; i < all->count; i++)
        if (memcmp(&all->entry[i], hit, sizeof *hit) == 0)
            return true;
    return false;
}

/* The same answers but for the choice among equally near hits. */
static void assert_answers(struct world_job job, const struct ray *ray,
                           const struct brute_answers *expected)
{
    static struct tagged_list all;
    job.query = QUERY_CLOSEST;
    struct tagged hit = stand_trace(&job, ray, ray_mode_all());
    if (float_bits(hit.hit.t) != float_bits(expected->nearest.hit.t) ||
        (hit.hit.prim == ABI_NO_PRIM) != (expected->all.count == 0))
        fail_msg("%s over %s: triangle %u at %a, without trees %u at %a",
                 job.packed->top.layout->name, job.packed->bottom->layout->name, hit.hit.prim,
                 (double)hit.hit.t, expected->nearest.hit.prim, (double)expected->nearest.hit.t);
    assert_true(hit.hit.prim == ABI_NO_PRIM || is_listed(&expected->all, &hit));
    stand_all(&job, ray, ray_mode_all(), &all);
    assert_int_equal(all.count, expected->all.count);
    assert_memory_equal(all.entry, expected->all.entry, all.count * sizeof *all.entry);
    job.query = QUERY_ANY;
    hit = stand_trace(&job, ray, ray_mode_all());
    assert_int_equal(hit.hit.prim != ABI_NO_PRIM, expected->all.count > 0);
    assert_true(hit.hit.prim == ABI_NO_PRIM || is_listed(&expected->all, &hit));
}

static void assert_trees(const struct world *world, const char *builder, const char *top,
                         const char *bottom, uint64_t seed, uint32_t rays)
{
    static struct brute_answers expected;
    struct world_trees trees = stand_trees(world, builder, 2);
    struct packed_world packed = stand_packed(world, &trees, top, bottom);
    struct instance_record *record = records(world);
    struct world_job job = stand_job(world, &packed, QUERY_CLOSEST);
    uint32_t hits = 0;
    static const char *const tests[] = {"mt", "woop"};
    for (uint64_t i = 0; i < rays; i++) {
        struct ray ray = stand_aim(&packed, seed, i);
        job.tri = tri_test_find(tests[i % 2]);
        brute_answer(world, record, job.tri, &ray, &expected);
        assert_answers(job, &ray, &expected);
        hits += expected.all.count > 0;
    }
    assert_true(hits > rays / 8);
    free(record);
    packed_world_free(&packed);
    world_trees_free(&trees);
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

/* --- corners ---------------------------------------------------------------------------------- */

static void assert_misses(const struct world *world)
{
    struct packed_world packed = stand_world(world, "f32");
    struct world_job job = stand_job(world, &packed, QUERY_CLOSEST);
    struct instance_record *record = records(world);
    struct ray ray = {.org = {0.1f, 0.2f, 5}, .dir = {0, 0, -1}, .tmax = STAND_TMAX};
    struct tagged hit = stand_trace(&job, &ray, ray_mode_all());
    static struct tagged_list all;
    assert_int_equal(hit.hit.prim, ABI_NO_PRIM);
    assert_int_equal(hit.tag, 0);
    stand_all(&job, &ray, ray_mode_all(), &all);
    assert_int_equal(all.count, 0);
    trace_world_brute(world, record, job.tri, QUERY_ANY, &ray, ray_mode_all(), &hit.hit, &hit.tag);
    assert_int_equal(hit.hit.prim, ABI_NO_PRIM);
    assert_int_equal(packed.top.node_count, 0);
    free(record);
    packed_world_free(&packed);
}

static void nothing_is_met_where_nothing_is(void **state)
{
    (void)state;
    struct world world = {0};
    fixture_finish(&world);
    assert_misses(&world);
    world_free(&world);
    world = fixture_room(0, 3);
    for (uint32_t i = 0; i < 3; i++)
        world.instance[i].mesh = WORLD_NO_MESH;
    fixture_finish(&world);
    assert_misses(&world);
    world_free(&world);
    world = fixture_world("soup:n=0", WORLD_TURNED, 3, 1);
    assert_misses(&world);
    world_free(&world);
    world = fixture_world("sphere:n=2", WORLD_SAME, 3, 1);
    for (uint32_t i = 0; i < 3; i++)
        world.instance[i].mask = 0;
    assert_misses(&world);
    world_free(&world);
}

/* Every third instance has a mask of 0, none, or an empty mesh: the others keep their numbers. */
static void inactive_instances_keep_their_numbers(void **state)
{
    (void)state;
    struct world world = fixture_room(3, 40);
    fixture_mesh(&world, 0, "soup:n=20,size=0.5", 1);
    fixture_mesh(&world, 1, "soup:n=0", 1);
    fixture_mesh(&world, 2, "platonic:which=1", 2);
    for (uint32_t i = 0; i < 40; i++) {
        struct instance *instance = &world.instance[i];
        fixture_transform(WORLD_TURNED, 900 + i, instance->m);
        instance->mesh = i % 2 ? 2 : 0;
        if (i % 9 == 0)
            instance->mask = 0;
        else if (i % 9 == 3)
            instance->mesh = WORLD_NO_MESH;
        else if (i % 9 == 6)
            instance->mesh = 1;
    }
    fixture_finish(&world);
    assert_trees(&world, "median", "f32", "f32", 5, 200);
    assert_trees(&world, "sah_binned", "rf16", "cwbvh80", 6, 200);
    /* The hit lies in an instance that has its custom index. */
    struct packed_world packed = stand_world(&world, "f32");
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    uint32_t seen = 0;
    for (uint64_t i = 0; i < 200; i++) {
        struct ray ray = stand_aim(&packed, 7, i);
        struct tagged hit = stand_trace(&job, &ray, ray_mode_all());
        if (hit.hit.prim == ABI_NO_PRIM)
            continue;
        uint32_t instance = world_instance_of(&world, hit.hit.prim);
        assert_int_equal(hit.tag & ABI_TAG_CUSTOM, world.instance[instance].custom);
        assert_true(instance % 3 != 0);
        seen++;
    }
    assert_true(seen > 50);
    packed_world_free(&packed);
    world_free(&world);
}

static void many_small_instances(void **state)
{
    (void)state;
    struct world world = fixture_room(1, 100000);
    fixture_mesh(&world, 0, "platonic:which=1,radius=0.3", 1);
    for (uint32_t i = 0; i < 100000; i++) {
        fixture_transform(i % 2 ? WORLD_TURNED : WORLD_MIRRORED, i, world.instance[i].m);
        for (uint32_t k = 0; k < 3; k++) /* spread over a cube */
            world.instance[i].m[k][3] += 10 * (float)(i /
                                                      (k == 0   ? 1u
                                                       : k == 1 ? 46u
                                                                : 2116u) %
                                                      46);
    }
    fixture_finish(&world);
    assert_true(world_tri_count(&world) == 1200000);
    assert_trees(&world, "sah_binned", "cwbvh80", "f32", 8, 16);
    world_free(&world);
}

/* Two instances at one place tie exactly: the first found stays, and any-hit takes either. */
static void ties_of_instances(void **state)
{
    (void)state;
    struct world world = fixture_world("sphere:n=3", WORLD_SAME, 6, 1);
    assert_trees(&world, "median", "f32", "f32", 9, 64);
    struct packed_world packed = stand_world(&world, "f32");
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    struct ray ray = {.org = {0.1f, 0.2f, 5}, .dir = {0, 0, -1}, .tmax = STAND_TMAX};
    static struct tagged_list all;
    stand_all(&job, &ray, ray_mode_all(), &all);
    assert_int_equal(all.count, 12);
    for (uint32_t i = 1; i < 6; i++)
        assert_int_equal(all.entry[i].hit.prim - all.entry[i - 1].hit.prim, 72);
    packed_world_free(&packed);
    world_free(&world);
}

/* The range holds in the world and in every instance: t is that of the world's direction. */
static void ranges_are_those_of_the_world(void **state)
{
    (void)state;
    struct world world = fixture_room(1, 3);
    fixture_mesh(&world, 0, "sphere:n=4", 1);
    for (uint32_t i = 0; i < 3; i++) { /* at z = 0, 4, 8, of radius 1/4, 1, 2 */
        for (int k = 0; k < 3; k++)
            world.instance[i].m[k][k] = i == 0 ? 0.25f : (float)i;
        world.instance[i].m[2][3] = 4 * (float)i;
    }
    fixture_finish(&world);
    struct packed_world packed = stand_world(&world, "f32");
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    static const struct {
        float tmin, tmax, least, most;
        uint32_t instance;
    } expected[] = {
        {0, 100, 9.8f, 10.2f, 2},
        {10.5f, 100, 13.8f, 14.2f, 2},
        {14.5f, 100, 14.9f, 15.2f, 1},
        {15.5f, 100, 16.8f, 17.1f, 1},
        {17.2f, 100, 19.7f, 19.8f, 0},
        {19.9f, 100, 20.2f, 20.3f, 0},
        {0, 9.5f, 0, 0, 3},
        {20.6f, 100, 0, 0, 3},
        {14.3f, 14.8f, 0, 0, 3},
    };
    for (size_t i = 0; i < ARRAY_COUNT(expected); i++) {
        struct ray ray = {.org = {0.01f, 0.02f, 20},
                          .dir = {0, 0, -0.75f},
                          .tmin = expected[i].tmin / 0.75f,
                          .tmax = expected[i].tmax / 0.75f};
        struct tagged hit = stand_trace(&job, &ray, ray_mode_all());
        if (expected[i].instance == 3) {
            assert_int_equal(hit.hit.prim, ABI_NO_PRIM);
            continue;
        }
        float distance = hit.hit.t * 0.75f;
        assert_int_equal(world_instance_of(&world, hit.hit.prim), expected[i].instance);
        assert_true(distance >= expected[i].least && distance <= expected[i].most);
    }
    packed_world_free(&packed);
    world_free(&world);
}

/* What the trees claim is too little: the ray is given up, nothing is overwritten. */
static void short_stacks_are_noticed(void **state)
{
    (void)state;
    static const char *const layouts_of[] = {"f32", "cwbvh80"};
    for (size_t l = 0; l < 2; l++) {
        struct world world = fixture_world("soup:n=200,size=0.9", WORLD_TURNED, 60, 3);
        struct world_trees trees = stand_trees(&world, "median", 1);
        struct packed_world packed = stand_packed(&world, &trees, layouts_of[l], layouts_of[l]);
        struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
        uint32_t top = packed.top.stack_need, bottom = packed.bottom->stack_need, given_up[2] = {0};
        for (int which = 0; which < 2; which++) {
            packed.top.stack_need = which ? top : 1;
            packed.bottom->stack_need = which ? 1 : bottom;
            for (uint64_t i = 0; i < 64; i++) {
                struct ray ray = stand_aim(&packed, 3, i);
                struct tagged hit;
                static struct hit list[STAND_LIST];
                static uint32_t tag[STAND_LIST];
                uint32_t count = 7;
                enum status status =
                    trace_world_ray(&job, &ray, ray_mode_all(), &hit.hit, &hit.tag, NULL);
                assert_true(status == STATUS_OK || status == STATUS_LIMIT);
                if (status) {
                    given_up[which]++;
                    assert_int_equal(hit.hit.prim, ABI_NO_PRIM);
                    assert_int_equal(hit.tag, 0);
                }
                if (trace_world_ray_all(&job, &ray, ray_mode_all(), STAND_LIST, list, tag, &count,
                                        NULL))
                    assert_int_equal(count, 0);
            }
        }
        assert_true(given_up[0] > 0 && given_up[1] > 0);
        packed_world_free(&packed);
        world_trees_free(&trees);
        world_free(&world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(brute_is_each_mesh_alone),
        cmocka_unit_test(trees_of_every_builder_lose_nothing),
        cmocka_unit_test(every_layout_is_a_top_and_a_bottom),
        cmocka_unit_test(nothing_is_met_where_nothing_is),
        cmocka_unit_test(inactive_instances_keep_their_numbers),
        cmocka_unit_test(many_small_instances),
        cmocka_unit_test(ties_of_instances),
        cmocka_unit_test(ranges_are_those_of_the_world),
        cmocka_unit_test(short_stacks_are_noticed),
    };
    return cmocka_run_group_tests_name("world_trace", tests, NULL, NULL);
}
