/* Slivers and tiny meshes in instances, as a tracer whose formula is not known may answer them. */
#include "ref/base/rng.h"
#include "ref/judge/judge_world.h"
#include "ref/primitives/test_run.h"
#include "ref/two_level/packed_world.h"
#include "ref/world/object_ray.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

/* A sliver of width `width` in units of the displacement that is allowed, 32 u times the distance
 * of its farthest vertex, in a world of its own; the ray meets it at a right angle, through the
 * middle. Returns what a tracer is found to do that says the other side. */
static enum wrong of_the_other_side(double width, bool turned, uint32_t flags)
{
    const float far = 8;
    float vertex[9] = {-far, 0, 3, far, 0, 3, 0, (float)(width * 32 * 0x1p-24 * (double)far), 3};
    uint32_t index[3] = {0, 1, 2};
    const struct scene scene = {
        .vertex = vertex, .vertex_count = 3, .index = index, .tri_count = 1};
    const struct model unknown = {.formula = TWIN_UNKNOWN, .rounding = ROUNDING_IEEE};
    const struct ray_mode mode = {.mask = 0xFF, .flags = flags};
    const struct ray ray = {.org = {0, vertex[7] / 4, 0}, .dir = {0, 0, 1}, .tmax = 100};
    struct world world;
    struct oracle *oracle;
    struct judge *judge;
    struct oracle_answer truth;
    struct judgement j;
    assert_int_equal(world_of_scene(&scene, &world, NULL), STATUS_OK);
    if (turned)
        world.instance[0].flags = ABI_INSTANCE_FLIP_FACING;
    assert_int_equal(world_finish(&world, NULL), STATUS_OK);
    assert_int_equal(oracle_make_world(&world, &oracle, NULL), STATUS_OK);
    assert_int_equal(judge_make(oracle, &unknown, QUERY_CLOSEST, &judge, NULL), STATUS_OK);
    assert_int_equal(oracle_closest_world(oracle, ORACLE_AUTO, ORACLE_CLOSED, &ray, &mode, 1, 1,
                                          &truth, NULL, NULL),
                     STATUS_OK);
    /* Vertices run counterclockwise along d, so that the back is seen. */
    const struct hit hit = {.t = 3, .u = 0.375f, .v = 0.25f, .prim = 0};
    assert_int_equal(
        judge_world_answer(judge, &ray, mode, &truth, &hit, turned ? 0 : ABI_TAG_FRONT, &j),
        STATUS_OK);
    judge_free(judge);
    oracle_free(oracle);
    world_free(&world);
    return j.wrong;
}

/* Its height shrinks by twice what each vertex moves. */
static void a_side_is_known_where_no_displacement_turns_it(void **state)
{
    (void)state;
    static const double open[] = {0.1, 0.5, 1, 1.9}, known[] = {2.2, 4, 100, 1e5};
    for (int turned = 0; turned < 2; turned++) {
        for (size_t i = 0; i < ARRAY_COUNT(open); i++) {
            assert_int_equal(of_the_other_side(open[i], turned, 0), WRONG_NOT);
            assert_int_equal(
                of_the_other_side(open[i], turned, turned ? ABI_RAY_CULL_FRONT : ABI_RAY_CULL_BACK),
                WRONG_NOT);
        }
        for (size_t i = 0; i < ARRAY_COUNT(known); i++) {
            assert_int_equal(of_the_other_side(known[i], turned, 0), WRONG_FACING);
            assert_int_equal(of_the_other_side(known[i], turned,
                                               turned ? ABI_RAY_CULL_FRONT : ABI_RAY_CULL_BACK),
                             WRONG_CULLED);
        }
    }
}

/* A sheared and stretched instance of a sliver, and a ray that meets it flatly, as the mesh sees
 * it. */
static void flat_case(struct rng *rng, float m[3][4], float vertex[9], struct ray *ray)
{
    double e[2][3], aim[3], d[3];
    for (int k = 0; k < 3; k++) {
        for (int j = 0; j < 3; j++)
            m[k][j] = rng_range(rng, -1, 1) * ldexpf(1, (int)rng_below(rng, 9));
        m[k][3] = rng_range(rng, -4, 4);
        vertex[k] = rng_range(rng, -1, 1);
        e[0][k] = (double)rng_range(rng, -1, 1);
        e[1][k] =
            e[0][k] * 0.6 + (double)rng_range(rng, -1, 1) * ldexp(1, -(int)rng_below(rng, 16));
        vertex[3 + k] = (float)((double)vertex[k] + e[0][k]);
        vertex[6 + k] = (float)((double)vertex[k] + e[1][k]);
    }
    const double u = 0.1 + 0.4 * (double)rng_float(rng), v = 0.1 + 0.4 * (double)rng_float(rng);
    const double lift = ldexp(1, -(int)rng_below(rng, 14));
    const double along[2] = {(double)rng_range(rng, -1, 1), (double)rng_range(rng, -1, 1)};
    for (int k = 0; k < 3; k++) {
        aim[k] = (double)vertex[k] + u * e[0][k] + v * e[1][k];
        d[k] = along[0] * e[0][k] + along[1] * e[1][k] + lift * (double)rng_range(rng, -1, 1);
    }
    *ray = (struct ray){.tmax = INFINITY};
    for (int k = 0; k < 3; k++) {
        double at = (double)m[k][3], to = 0;
        for (int j = 0; j < 3; j++) {
            at += (double)m[k][j] * aim[j];
            to += (double)m[k][j] * d[j];
        }
        ray->dir[k] = (float)to;
        ray->org[k] = (float)(at - 3 * to);
    }
}

/* What a tracer with one triangle answers that takes the ray into the mesh, and how it is judged.
 * */
static enum wrong of_flat_case(uint64_t seed, const char *tri, bool *judged)
{
    struct rng rng = rng_make(seed, 77);
    float vertex[9];
    uint32_t index[3] = {0, 1, 2};
    const struct scene scene = {
        .vertex = vertex, .vertex_count = 3, .index = index, .tri_count = 1};
    const struct model unknown = {.formula = TWIN_UNKNOWN, .rounding = ROUNDING_IEEE};
    const struct ray_mode mode = ray_mode_all();
    struct world world;
    struct instance_record *record;
    struct oracle *oracle;
    struct judge *judge;
    struct oracle_answer truth;
    struct judgement j = {.wrong = WRONG_NOT};
    struct ray ray;
    assert_int_equal(world_of_scene(&scene, &world, NULL), STATUS_OK);
    flat_case(&rng, world.instance[0].m, vertex, &ray);
    assert_int_equal(world_finish(&world, NULL), STATUS_OK);
    assert_int_equal(oracle_make_world(&world, &oracle, NULL), STATUS_OK);
    assert_int_equal(judge_make(oracle, &unknown, QUERY_CLOSEST, &judge, NULL), STATUS_OK);
    assert_int_equal(world_records_make(&world, &record, NULL), STATUS_OK);
    assert_int_equal(oracle_closest_world(oracle, ORACLE_AUTO, ORACLE_CLOSED, &ray, &mode, 1, 1,
                                          &truth, NULL, NULL),
                     STATUS_OK);
    struct ray placed = transform_ray(record, &ray);
    struct tri_ray r = tri_ray_make(&placed);
    struct hit hit;
    float v[3][3];
    uint32_t tag = 0;
    scene_tri(&scene, 0, v);
    if (tri_test_run(tri_test_find(tri)->id, &r, v, &hit)) {
        hit.prim = 0;
        double n[3], side = 0;
        for (int k = 0; k < 3; k++) {
            int a = (k + 1) % 3, b = (k + 2) % 3;
            n[k] = ((double)v[1][a] - (double)v[0][a]) * ((double)v[2][b] - (double)v[0][b]) -
                   ((double)v[1][b] - (double)v[0][b]) * ((double)v[2][a] - (double)v[0][a]);
            side += n[k] * (double)placed.dir[k];
        }
        tag = side < 0 ? ABI_TAG_FRONT : 0;
    } else {
        hit = hit_none();
    }
    assert_int_equal(judge_world_answer(judge, &ray, mode, &truth, &hit, tag, &j), STATUS_OK);
    *judged = j.verdict != VERDICT_OUT_OF_CONTRACT;
    free(record);
    judge_free(judge);
    oracle_free(oracle);
    world_free(&world);
    return j.wrong;
}

/* The test cancels in the space of the mesh, where other products do than in the world. */
static void slivers_of_sheared_instances_are_judged_as_their_meshes_see_them(void **state)
{
    (void)state;
    static const char *const tests[] = {"mt", "woop", "pluecker"};
    const uint64_t count = getenv("RAYDIFF_SLOW") ? 1000000 : 20000;
    uint64_t judged = 0, wrong = 0;
    for (uint64_t i = 0; i < count; i++)
        for (size_t t = 0; t < ARRAY_COUNT(tests); t++) {
            bool one;
            enum wrong kind = of_flat_case(i, tests[t], &one);
            judged += one;
            wrong += kind != WRONG_NOT;
            if (kind != WRONG_NOT && wrong < 10)
                print_message("case %llu, %s: %s\n", (unsigned long long)i, tests[t],
                              wrong_name(kind));
        }
    print_message("%llu of %llu judged answers are WRONG\n", (unsigned long long)wrong,
                  (unsigned long long)judged);
    assert_true(judged > count * 2);
    assert_int_equal(wrong, 0);
}

/* Found by a campaign: a mesh of size 2^-48 with vertices times 2^up, placed where it is. Its
 * edges' products with t's are near 2^-145, and Embree is a third off, as any test is that flushes
 * them. Returns what it is called. */
static enum wrong of_a_tiny_mesh(int up)
{
    float vertex[9] = {0x1p-48f, 0x1.8p-49f, 0, 0x1p-49f, 0, 0, 0x1p-48f, 0, 0};
    uint32_t index[3] = {0, 1, 2};
    for (int i = 0; i < 9; i++)
        vertex[i] = ldexpf(vertex[i], up);
    const struct scene scene = {
        .vertex = vertex, .vertex_count = 3, .index = index, .tri_count = 1};
    const struct model unknown = {.formula = TWIN_UNKNOWN, .rounding = ROUNDING_IEEE};
    const struct ray_mode mode = ray_mode_all();
    const struct ray ray = {.org = {0x1p-36f, 0, 0x1.4p-37f}, .dir = {0, 0, -1}, .tmax = INFINITY};
    const struct hit hit = {.t = 0x1.555556p-37f, .u = 0, .v = 1, .prim = 0};
    struct world world;
    struct oracle *oracle;
    struct judge *judge;
    struct oracle_answer truth;
    struct judgement j;
    assert_int_equal(world_of_scene(&scene, &world, NULL), STATUS_OK);
    for (int k = 0; k < 3; k++)
        world.instance[0].m[k][k] = ldexpf(k == 1 ? 0x1p3f : 0x1p12f, -up);
    assert_int_equal(world_finish(&world, NULL), STATUS_OK);
    assert_int_equal(oracle_make_world(&world, &oracle, NULL), STATUS_OK);
    assert_int_equal(judge_make(oracle, &unknown, QUERY_CLOSEST, &judge, NULL), STATUS_OK);
    assert_int_equal(oracle_closest_world(oracle, ORACLE_AUTO, ORACLE_CLOSED, &ray, &mode, 1, 1,
                                          &truth, NULL, NULL),
                     STATUS_OK);
    assert_int_equal(truth.prim, 0);
    assert_int_equal(judge_world_answer(judge, &ray, mode, &truth, &hit, ABI_TAG_FRONT, &j),
                     STATUS_OK);
    judge_free(judge);
    oracle_free(oracle);
    world_free(&world);
    return j.wrong;
}

static void what_is_flushed_in_a_mesh_may_be_lost(void **state)
{
    (void)state;
    assert_int_equal(of_a_tiny_mesh(0), WRONG_NOT);
    assert_int_equal(of_a_tiny_mesh(30), WRONG_DISTANCE);
    assert_int_equal(of_a_tiny_mesh(60), WRONG_DISTANCE);
}

/* Beyond the contract u and v may be any, and so may what a filter by cells makes of them; within
 * it they may not. Found by a campaign at 2^63. */
static void a_filter_reads_no_cells_beyond_the_contract(void **state)
{
    (void)state;
    const struct model unknown = {.formula = TWIN_UNKNOWN, .rounding = ROUNDING_IEEE};
    const struct ray_mode mode = ray_mode_all();
    unsigned wrong[2] = {0, 0};
    for (int huge = 0; huge < 2; huge++)
        for (uint32_t seed = 0; seed < 16; seed++) {
            const float a = huge ? 0x1p63f : 1;
            float vertex[9] = {a, 0, 0, 0, a, 0, a, a, 2 * a};
            uint32_t index[3] = {0, 1, 2};
            const struct scene scene = {
                .vertex = vertex, .vertex_count = 3, .index = index, .tri_count = 1};
            const struct ray ray = {.org = {0, 0, a}, .dir = {1, 1, -1}, .tmax = INFINITY};
            const struct hit hit = {.t = 0.6f * a, .u = 0, .v = 0, .prim = 0};
            struct world world;
            struct oracle *oracle;
            struct judge *judge;
            struct oracle_answer truth;
            struct judgement j;
            assert_int_equal(world_of_scene(&scene, &world, NULL), STATUS_OK);
            world.mesh[0].geometry[0].opaque = false;
            world.filter = (struct filter_rule){.kind = FILTER_CELLS, .seed = seed, .share = 128};
            assert_int_equal(world_finish(&world, NULL), STATUS_OK);
            assert_int_equal(oracle_make_world(&world, &oracle, NULL), STATUS_OK);
            assert_int_equal(judge_make(oracle, &unknown, QUERY_CLOSEST, &judge, NULL), STATUS_OK);
            assert_int_equal(oracle_closest_world(oracle, ORACLE_AUTO, ORACLE_CLOSED, &ray, &mode,
                                                  1, 1, &truth, NULL, NULL),
                             STATUS_OK);
            assert_int_equal(judge_world_answer(judge, &ray, mode, &truth, &hit, 0, &j), STATUS_OK);
            wrong[huge] += j.wrong == WRONG_OPACITY;
            judge_free(judge);
            oracle_free(oracle);
            world_free(&world);
        }
    assert_true(wrong[0] > 3);
    assert_int_equal(wrong[1], 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slivers_of_sheared_instances_are_judged_as_their_meshes_see_them),
        cmocka_unit_test(what_is_flushed_in_a_mesh_may_be_lost),
        cmocka_unit_test(a_filter_reads_no_cells_beyond_the_contract),
        cmocka_unit_test(a_side_is_known_where_no_displacement_turns_it),
    };
    return cmocka_run_group_tests_name("world_slivers", tests, NULL, NULL);
}
