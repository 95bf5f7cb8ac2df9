/* Masks, culling, opacity, filters and early ends against a list of all hits that is sifted here by
 * the rules as the Vulkan specification states them. */
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

/* Several meshes and geometries, instances of all flags and masks. */
static struct world mixed_world(uint64_t seed, enum filter_kind filter)
{
    struct world world = fixture_room(2, 30);
    fixture_mesh(&world, 0, "soup:n=40,size=0.6", 5);
    fixture_mesh(&world, 1, "sphere:n=3", 3);
    for (uint32_t i = 0; i < 30; i++) {
        struct rng rng = rng_make(seed, i);
        struct instance *instance = &world.instance[i];
        instance->mesh = i % 2;
        instance->mask = 1 + rng_below(&rng, 255);
        instance->flags = rng_below(&rng, 12); /* not both force flags */
        instance->custom = 0xFFFF00 + i;
        fixture_transform(i % 3 ? WORLD_TURNED : WORLD_MIRRORED, seed * 100 + i, instance->m);
    }
    world.filter = (struct filter_rule){filter, 77, 100};
    fixture_finish(&world);
    return world;
}

/* Facing by doubles; false if they cannot tell. */
static bool seen_front(const struct world *world, uint32_t prim, const struct ray *ray, bool *front)
{
    struct place place = world_place(world, prim);
    const struct instance *instance = &world->instance[place.instance];
    struct instance_record *record;
    double a[3], b[3], sum = 0, size = 0;
    float v[3][3];
    assert_int_equal(world_records_make(world, &record, NULL), STATUS_OK);
    struct ray inside = transform_ray(&record[place.instance], ray);
    free(record);
    scene_tri(world->mesh[place.mesh].scene, place.prim, v);
    for (int k = 0; k < 3; k++) {
        a[k] = (double)v[1][k] - (double)v[0][k];
        b[k] = (double)v[2][k] - (double)v[0][k];
    }
    for (int k = 0; k < 3; k++) {
        int l = (k + 1) % 3, m = (k + 2) % 3;
        double n = a[l] * b[m] - a[m] * b[l];
        sum += (double)inside.dir[k] * n;
        size += (fabs(a[l] * b[m]) + fabs(a[m] * b[l])) * fabs((double)inside.dir[k]);
    }
    *front = sum < 0;
    if (instance->flags & ABI_INSTANCE_FLIP_FACING)
        *front = !*front;
    return fabs(sum) > 1e-5 * size;
}

/* Whether a hit counts; `front` is what its tag has. */
static bool counts(const struct world *world, const struct hit *hit, bool front,
                   struct ray_mode mode)
{
    struct place place = world_place(world, hit->prim);
    const struct instance *instance = &world->instance[place.instance];
    bool opaque = world->mesh[place.mesh].geometry[place.geometry].opaque;
    if (instance->flags & 4)
        opaque = true;
    if (instance->flags & 8)
        opaque = false;
    if (mode.flags & 1)
        opaque = true;
    if (mode.flags & 2)
        opaque = false;
    if (!(instance->mask & mode.mask) || (mode.flags & 0x100))
        return false;
    if (!(instance->flags & 1) &&
        ((front && (mode.flags & 0x20)) || (!front && (mode.flags & 0x10))))
        return false;
    if ((opaque && (mode.flags & 0x40)) || (!opaque && (mode.flags & 0x80)))
        return false;
    return opaque || filter_passes(&world->filter, &place, hit->u, hit->v);
}

static struct ray_mode any_mode(struct rng *rng)
{
    static const uint32_t opacity[] = {0, 0, 1, 2, 0x40, 0x80};
    static const uint32_t facing[] = {0, 0, 0, 0x10, 0x20};
    struct ray_mode mode = {.mask = rng_below(rng, 256)};
    mode.flags = opacity[rng_below(rng, 6)];
    mode.flags |= facing[rng_below(rng, 5)];
    mode.flags |= rng_below(rng, 2) ? ABI_RAY_SKIP_CLOSEST : 0;
    if (rng_below(rng, 50) == 0)
        mode.flags = ABI_RAY_SKIP_TRIANGLES;
    assert_int_equal(ray_mode_check(mode, NULL), STATUS_OK);
    return mode;
}

/* How often something was seen. */
struct flags_seen {
    uint32_t hits, sifted, passed_over, fronts, backs;
};

static bool is_listed(const struct tagged_list *all, const struct tagged *hit)
{
    for (uint32_t i = 0; i < all->count; i++)
        if (memcmp(&all->entry[i], hit, sizeof *hit) == 0)
            return true;
    return false;
}

/* One ray with its mode: all hits, the nearest, the first, by trees and without. */
static void assert_sifted(struct world_job job, const struct instance_record *record,
                          const struct ray *ray, struct ray_mode mode,
                          const struct tagged_list *everything, struct flags_seen *seen)
{
    static struct tagged_list expected, all;
    static struct hit hits[STAND_LIST];
    static uint32_t tags[STAND_LIST];
    const struct world *world = job.world;
    struct tagged hit, brute;
    expected.count = 0;
    for (uint32_t i = 0; i < everything->count; i++) {
        const struct tagged *entry = &everything->entry[i];
        if (counts(world, &entry->hit, entry->tag >> 31, mode))
            expected.entry[expected.count++] = *entry;
    }
    seen->hits += everything->count;
    seen->sifted += expected.count;
    stand_all(&job, ray, mode, &all);
    assert_int_equal(all.count, expected.count);
    assert_memory_equal(all.entry, expected.entry, all.count * sizeof *all.entry);
    all.count = trace_world_brute_all(world, record, job.tri, ray, mode, STAND_LIST, hits, tags);
    tagged_fill(&all, hits, tags, false);
    assert_int_equal(all.count, expected.count);
    assert_memory_equal(all.entry, expected.entry, all.count * sizeof *all.entry);
    for (uint32_t flags = 0; flags <= ABI_RAY_FIRST; flags += ABI_RAY_FIRST)
        for (int q = QUERY_CLOSEST; q <= QUERY_ANY; q++) {
            struct ray_mode now = {mode.mask, mode.flags | flags};
            job.query = (enum query)q;
            hit = stand_trace(&job, ray, now);
            trace_world_brute(world, record, job.tri, job.query, ray, now, &brute.hit, &brute.tag);
            assert_int_equal(hit.hit.prim == ABI_NO_PRIM, expected.count == 0);
            assert_int_equal(brute.hit.prim == ABI_NO_PRIM, expected.count == 0);
            if (expected.count == 0)
                continue;
            assert_true(is_listed(&expected, &hit) && is_listed(&expected, &brute));
            if (q == QUERY_CLOSEST && !flags) {
                assert_true(hit.hit.t == expected.entry->hit.t);
                assert_true(brute.hit.t == expected.entry->hit.t);
            }
            seen->passed_over += hit.hit.t != everything->entry->hit.t;
        }
}

/* The list of all hits of the same world when nothing is sifted. */
static void everything_of(struct world *world, struct world_job job, const struct ray *ray,
                          struct tagged_list *out)
{
    struct filter_rule filter = world->filter;
    world->filter.kind = FILTER_ALL;
    stand_all(&job, ray, ray_mode_all(), out);
    world->filter = filter;
}

static void assert_world(uint64_t seed, enum filter_kind filter, const char *layout,
                         struct flags_seen *seen)
{
    static struct tagged_list everything;
    struct world world = mixed_world(seed, filter);
    struct packed_world packed = stand_world(&world, layout);
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    struct instance_record *record;
    assert_int_equal(world_records_make(&world, &record, NULL), STATUS_OK);
    for (uint64_t i = 0; i < 150; i++) {
        struct rng rng = rng_make(seed + 50, i);
        struct ray ray = stand_aim(&packed, seed, i);
        everything_of(&world, job, &ray, &everything);
        for (uint32_t h = 0; h < everything.count; h++) {
            const struct tagged *entry = &everything.entry[h];
            bool front;
            if (seen_front(&world, entry->hit.prim, &ray, &front)) {
                assert_int_equal(entry->tag >> 31, front);
                *(front ? &seen->fronts : &seen->backs) += 1;
            }
            assert_int_equal(entry->tag & 0x7FFFFFFF,
                             world.instance[world_instance_of(&world, entry->hit.prim)].custom);
        }
        for (int m = 0; m < 8; m++)
            assert_sifted(job, record, &ray, any_mode(&rng), &everything, seen);
    }
    free(record);
    packed_world_free(&packed);
    world_free(&world);
}

static void modes_and_filters_sift_hits(void **state)
{
    (void)state;
    static const char *const layouts_of[] = {"f32", "rf16", "cwbvh80", "half4"};
    for (int filter = FILTER_ALL; filter <= FILTER_CELLS; filter++) {
        struct flags_seen seen = {0};
        assert_world(10 + (uint64_t)filter, (enum filter_kind)filter, layouts_of[filter], &seen);
        assert_true(seen.hits > 1000 && seen.sifted > 200 && seen.sifted < seen.hits);
        assert_true(seen.fronts > 50 && seen.backs > 50);
        assert_true(seen.passed_over > 50);
    }
}

/* --- relations -------------------------------------------------------------------------------- */

/* Every hit is culled by one of both sides, unless culling is disabled for its instance. */
static void both_sides_are_all(void **state)
{
    (void)state;
    static struct tagged_list all, front, back;
    struct world world = mixed_world(3, FILTER_CELLS);
    struct packed_world packed = stand_world(&world, "f32");
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    uint32_t both = 0, one = 0;
    for (uint64_t i = 0; i < 300; i++) {
        struct ray ray = stand_aim(&packed, 3, i);
        stand_all(&job, &ray, ray_mode_all(), &all);
        stand_all(&job, &ray, (struct ray_mode){0xFF, ABI_RAY_CULL_BACK}, &front);
        stand_all(&job, &ray, (struct ray_mode){0xFF, ABI_RAY_CULL_FRONT}, &back);
        for (uint32_t h = 0; h < all.count; h++) {
            const struct tagged *hit = &all.entry[h];
            bool disabled = world.instance[world_instance_of(&world, hit->hit.prim)].flags &
                            ABI_INSTANCE_CULL_DISABLE;
            bool in_front = is_listed(&front, hit), in_back = is_listed(&back, hit);
            assert_int_equal(in_front, disabled || (hit->tag & ABI_TAG_FRONT));
            assert_int_equal(in_back, disabled || !(hit->tag & ABI_TAG_FRONT));
            both += in_front && in_back;
            one += in_front != in_back;
        }
        assert_true(front.count <= all.count && back.count <= all.count);
    }
    assert_true(both > 50 && one > 50);
    packed_world_free(&packed);
    world_free(&world);
}

/* A mirror changes no facing, FLIP_FACING does. */
static void mirrors_change_no_facing(void **state)
{
    (void)state;
    struct world world = fixture_room(1, 4);
    fixture_mesh(&world, 0, "sphere:n=4", 1);
    for (uint32_t i = 0; i < 4; i++) {
        world.instance[i].m[0][3] = 10 * (float)i;
        world.instance[i].m[0][0] = i % 2 ? -1 : 1;
        world.instance[i].flags = i / 2 ? ABI_INSTANCE_FLIP_FACING : 0;
    }
    fixture_finish(&world);
    struct packed_world packed = stand_world(&world, "f32");
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    uint32_t first = 0;
    for (uint32_t i = 0; i < 4; i++) {
        struct ray ray = {
            .org = {10 * (float)i + 0.1f, 0.2f, 5}, .dir = {0, 0, -1}, .tmax = STAND_TMAX};
        struct tagged hit = stand_trace(&job, &ray, ray_mode_all());
        assert_int_equal(world_instance_of(&world, hit.hit.prim), i);
        if (i == 0)
            first = hit.tag & ABI_TAG_FRONT;
        assert_int_equal(hit.tag & ABI_TAG_FRONT, i / 2 ? first ^ ABI_TAG_FRONT : first);
        /* From inside the other side is seen. */
        ray.org[2] = 0;
        hit = stand_trace(&job, &ray, ray_mode_all());
        assert_int_equal(hit.tag & ABI_TAG_FRONT, i / 2 ? first : first ^ ABI_TAG_FRONT);
    }
    packed_world_free(&packed);
    world_free(&world);
}

/* Which side is the front: vertices counterclockwise as seen from the origin. */
static void the_front_is_counterclockwise(void **state)
{
    (void)state;
    float vertex[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    uint32_t index[3] = {0, 1, 2};
    struct scene scene = {.vertex = vertex, .index = index, .vertex_count = 3, .tri_count = 1};
    struct world world;
    assert_int_equal(world_of_scene(&scene, &world, NULL), STATUS_OK);
    struct packed_world packed = stand_world(&world, "f32");
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    struct ray ray = {.org = {0.25f, 0.25f, 2}, .dir = {0, 0, -1}, .tmax = STAND_TMAX};
    for (size_t t = 0; tri_tests[t]; t++) {
        job.tri = tri_tests[t];
        assert_int_equal(stand_trace(&job, &ray, ray_mode_all()).tag, ABI_TAG_FRONT);
        ray.org[2] = -2, ray.dir[2] = 1;
        assert_int_equal(stand_trace(&job, &ray, ray_mode_all()).tag, 0);
        assert_int_equal(stand_trace(&job, &ray, (struct ray_mode){1, ABI_RAY_CULL_BACK}).hit.prim,
                         ABI_NO_PRIM);
        ray.org[2] = 2, ray.dir[2] = -1;
    }
    packed_world_free(&packed);
    world_free(&world);
}

/* A cleared bit of the mask removes the instance, and nothing else. */
static void a_cleared_mask_removes_the_instance(void **state)
{
    (void)state;
    static struct tagged_list masked, removed;
    struct world world = mixed_world(5, FILTER_CELLS);
    for (uint32_t bit = 0; bit < 8; bit++) {
        struct packed_world packed = stand_world(&world, "f32");
        struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
        struct world without = world;
        without.instance = alloc_copy(world.instance, 30, sizeof *world.instance);
        without.first = NULL;
        assert_non_null(without.instance);
        for (uint32_t i = 0; i < 30; i++)
            if (!(world.instance[i].mask >> bit & 1))
                without.instance[i].mask = 0;
        fixture_finish(&without);
        struct packed_world less = stand_world(&without, "f32");
        struct world_job other = stand_job(&without, &less, QUERY_CLOSEST);
        for (uint64_t i = 0; i < 40; i++) {
            struct ray ray = stand_aim(&packed, bit, i);
            stand_all(&job, &ray, (struct ray_mode){1u << bit, 0}, &masked);
            stand_all(&other, &ray, ray_mode_all(), &removed);
            assert_int_equal(masked.count, removed.count);
            assert_memory_equal(masked.entry, removed.entry, masked.count * sizeof *masked.entry);
        }
        free(without.instance);
        free(without.first);
        packed_world_free(&less);
        packed_world_free(&packed);
    }
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(modes_and_filters_sift_hits),
        cmocka_unit_test(both_sides_are_all),
        cmocka_unit_test(mirrors_change_no_facing),
        cmocka_unit_test(the_front_is_counterclockwise),
        cmocka_unit_test(a_cleared_mask_removes_the_instance),
    };
    return cmocka_run_group_tests_name("world_flags", tests, NULL, NULL);
}
