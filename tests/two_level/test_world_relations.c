/* Relations between worlds: transforms baked into vertices, instances exchanged, opacity by other
 * means. Numbers are small whole ones, so that placed vertices and moved rays are exact. */
#include "ref/store.h"
#include "ref/trace/trace_world.h"
#include "ref/two_level/world_check.h"
#include "tests/two_level/two_level_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "tests/two_level/world_stand.h"

#define TRIS 24

/* Triangles with coordinates -8 .. 8. */
static struct scene whole_scene(uint64_t seed)
{
    struct scene scene;
    struct rng rng = rng_make(seed, 1);
    assert_int_equal(scene_make(3 * TRIS, TRIS, &scene), STATUS_OK);
    for (uint32_t i = 0; i < 9 * TRIS; i++)
        scene.vertex[i] = (float)rng_below(&rng, 17) - 8;
    for (uint32_t i = 0; i < 3 * TRIS; i++)
        scene.index[i] = i;
    return scene;
}

/* What a transform does to axes. */
enum bake_kind { BAKE_MOVED, BAKE_SCALED, BAKE_MIRRORED, BAKE_EXCHANGED, BAKE_KINDS };

static void bake_transform(enum bake_kind kind, uint64_t seed, float m[3][4])
{
    struct rng rng = rng_make(seed, 9 + kind);
    float scale = kind == BAKE_MOVED ? 1 : ldexpf(1, (int)rng_below(&rng, 7) - 3);
    int first = kind == BAKE_EXCHANGED ? (int)rng_below(&rng, 3) : 0;
    int turn = kind == BAKE_EXCHANGED ? 1 + (int)rng_below(&rng, 2) : 1;
    for (int k = 0; k < 3; k++) {
        for (int j = 0; j < 4; j++)
            m[k][j] = 0;
        bool mirror = rng_below(&rng, 2) && kind >= BAKE_MIRRORED;
        m[k][(first + turn * k) % 3] = mirror ? -scale : scale;
        m[k][3] = (float)rng_below(&rng, 65) - 32;
    }
}

static void bake(const float m[3][4], const struct scene *from, struct scene *out)
{
    assert_int_equal(scene_make(from->vertex_count, from->tri_count, out), STATUS_OK);
    memcpy(out->index, from->index, 3 * (size_t)from->tri_count * sizeof *out->index);
    for (uint32_t i = 0; i < from->vertex_count; i++)
        for (int k = 0; k < 3; k++) {
            const float *p = from->vertex + 3 * (size_t)i;
            out->vertex[3 * i + (uint32_t)k] =
                m[k][0] * p[0] + m[k][1] * p[1] + m[k][2] * p[2] + m[k][3];
        }
}

/* A ray of whole numbers towards one of the baked triangles; |d| has one largest component, so that
 * exchanged axes are chosen alike. */
static struct ray whole_ray(const struct scene *baked, uint64_t seed, uint64_t number)
{
    struct rng rng = rng_make(seed, 100 + number);
    struct ray ray = {.tmin = 0, .tmax = STAND_TMAX};
    const float *p = baked->vertex + 9 * (size_t)rng_below(&rng, TRIS);
    float size[3];
    do {
        for (int k = 0; k < 3; k++) {
            float inside = (p[k] + p[3 + k]) / 2;
            ray.dir[k] = (float)rng_below(&rng, 31) - 15;
            ray.org[k] = rintf(inside) - ray.dir[k];
            size[k] = fabsf(ray.dir[k]);
        }
    } while (size[0] == size[1] || size[1] == size[2] || size[2] == size[0]);
    return ray;
}

/* The same numbers: a mirror changes signs of zeros. */
static void assert_same_hits(const struct hit *a, const struct hit *b, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        assert_true(a[i].t == b[i].t && a[i].u == b[i].u && a[i].v == b[i].v &&
                    a[i].prim == b[i].prim);
}

static uint32_t assert_baked(const struct world *world, const struct scene *baked,
                             const struct packed_world *packed, const struct tri_test *tri,
                             const struct ray *ray)
{
    static struct hit hits[TRIS], placed[TRIS];
    static uint32_t tags[TRIS];
    static struct tagged_list all;
    struct instance_record *record = packed->record;
    uint32_t count = trace_brute_all(baked, tri, ray, TRIS, hits);
    uint32_t same =
        trace_world_brute_all(world, record, tri, ray, ray_mode_all(), TRIS, placed, tags);
    assert_int_equal(same, count);
    assert_same_hits(placed, hits, count);
    struct world_job job = stand_job(world, packed, QUERY_CLOSEST);
    job.tri = tri;
    stand_all(&job, ray, ray_mode_all(), &all);
    assert_int_equal(all.count, count);
    int det = instance_det_sign(world->instance->m);
    for (uint32_t i = 0; i < count; i++) { /* baked, a mirror does turn triangles round */
        double a[3], b[3], side = 0;
        float v[3][3];
        scene_tri(baked, hits[i].prim, v);
        for (int k = 0; k < 3; k++) {
            a[k] = (double)(v[1][k] - v[0][k]);
            b[k] = (double)(v[2][k] - v[0][k]);
        }
        for (int k = 0; k < 3; k++)
            side += (double)ray->dir[k] *
                    (a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
        assert_true(side != 0);
        assert_int_equal(tags[i] >> 31, (side < 0) == (det > 0));
    }
    return count;
}

static void baked_transforms_give_the_same_bits(void **state)
{
    (void)state;
    for (uint32_t kind = 0; kind < BAKE_KINDS; kind++) {
        uint32_t hits = 0;
        for (uint64_t seed = 0; seed < 12; seed++) {
            struct scene scene = whole_scene(seed), baked;
            struct world world;
            assert_int_equal(world_of_scene(&scene, &world, NULL), STATUS_OK);
            bake_transform((enum bake_kind)kind, seed, world.instance->m);
            fixture_finish(&world);
            bake(world.instance->m, &scene, &baked);
            struct packed_world packed = stand_world(&world, "f32");
            for (size_t t = 0; tri_tests[t]; t++)
                /* The rows of Baldwin and Weber's test depend on where the origin is. */
                for (uint64_t i = 0; i < 80 && tri_tests[t]->id != ABI_TRI_BALDWIN_WEBBER; i++) {
                    struct ray ray = whole_ray(&baked, seed, i);
                    hits += assert_baked(&world, &baked, &packed, tri_tests[t], &ray);
                }
            packed_world_free(&packed);
            world_free(&world);
            scene_free(&scene);
            scene_free(&baked);
        }
        assert_true(hits > 500);
    }
}

/* One placed triangle under another order of instances. */
static uint32_t renumbered(const struct world *world, const struct world *other,
                           const uint32_t *place_of, uint32_t prim)
{
    uint32_t instance = world_instance_of(world, prim);
    return other->first[place_of[instance]] + prim - world->first[instance];
}

static void exchanged_instances_are_met_alike(void **state)
{
    (void)state;
    static struct tagged_list all, exchanged;
    struct world world = fixture_room(2, 40), other = fixture_room(0, 40);
    uint32_t place_of[40];
    fixture_mesh(&world, 0, "soup:n=30,size=0.5", 2);
    fixture_mesh(&world, 1, "sphere:n=3", 1);
    for (uint32_t i = 0; i < 40; i++) {
        fixture_transform(WORLD_TURNED, 300 + i, world.instance[i].m);
        world.instance[i].mesh = i % 2;
        place_of[i] = (i * 23 + 7) % 40;
        other.instance[place_of[i]] = world.instance[i];
    }
    free(other.mesh);
    other.mesh = world.mesh;
    other.mesh_count = world.mesh_count;
    fixture_finish(&world);
    fixture_finish(&other);
    struct packed_world packed = stand_world(&world, "f32"), shuffled = stand_world(&other, "f32");
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    struct world_job again = stand_job(&other, &shuffled, QUERY_CLOSEST);
    uint32_t hits = 0;
    for (uint64_t i = 0; i < 300; i++) {
        struct ray ray = stand_aim(&packed, 4, i);
        stand_all(&job, &ray, ray_mode_all(), &all);
        stand_all(&again, &ray, ray_mode_all(), &exchanged);
        assert_int_equal(all.count, exchanged.count);
        for (uint32_t h = 0; h < all.count; h++)
            all.entry[h].hit.prim = renumbered(&world, &other, place_of, all.entry[h].hit.prim);
        qsort(all.entry, all.count, sizeof *all.entry, tagged_order);
        assert_memory_equal(all.entry, exchanged.entry, all.count * sizeof *all.entry);
        hits += all.count;
    }
    assert_true(hits > 300);
    packed_world_free(&packed);
    packed_world_free(&shuffled);
    free(other.instance);
    free(other.first);
    world_free(&world);
}

/* A filter that accepts all is opacity; one that accepts none is no geometry that is not opaque. */
static void filters_at_their_ends(void **state)
{
    (void)state;
    struct world world = fixture_room(1, 20);
    fixture_mesh(&world, 0, "soup:n=60,size=0.6", 4);
    for (uint32_t i = 0; i < 20; i++)
        fixture_transform(WORLD_TURNED, 700 + i, world.instance[i].m);
    fixture_finish(&world);
    struct packed_world packed = stand_world(&world, "f32");
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    const struct ray_mode opaque = {0xFF, ABI_RAY_OPAQUE}, culled = {0xFF, ABI_RAY_CULL_NO_OPAQUE};
    uint32_t differences = 0;
    for (uint64_t i = 0; i < 300; i++) {
        struct ray ray = stand_aim(&packed, 8, i);
        world.filter = (struct filter_rule){FILTER_ALL, 1, 0};
        struct tagged all = stand_trace(&job, &ray, ray_mode_all());
        world.filter.kind = FILTER_NONE;
        struct tagged none = stand_trace(&job, &ray, ray_mode_all());
        struct tagged as_opaque = stand_trace(&job, &ray, opaque);
        struct tagged as_culled = stand_trace(&job, &ray, culled);
        assert_memory_equal(&all, &as_opaque, sizeof all);
        assert_memory_equal(&none, &as_culled, sizeof none);
        world.filter = (struct filter_rule){FILTER_TRIANGLES, 1, 256};
        struct tagged same = stand_trace(&job, &ray, ray_mode_all());
        assert_memory_equal(&all, &same, sizeof all);
        world.filter.share = 0;
        same = stand_trace(&job, &ray, ray_mode_all());
        assert_memory_equal(&none, &same, sizeof none);
        differences += memcmp(&all, &none, sizeof all) != 0;
    }
    assert_true(differences > 50);
    packed_world_free(&packed);
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(baked_transforms_give_the_same_bits),
        cmocka_unit_test(exchanged_instances_are_met_alike),
        cmocka_unit_test(filters_at_their_ends),
    };
    return cmocka_run_group_tests_name("world_relations", tests, NULL, NULL);
}
