/* Slivers and tiny meshes in instances, as a tracer whose formula is not known may answer them. */
#include "ref/base/rng.h"
#include "ref/judge/judge_inner.h"
#include "ref/primitives/test_run.h"
#include "ref/two_level/packed_world.h"
#include "ref/world/object_ray.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* One triangle in one instance. */
struct alone {
    float vertex[9];
    uint32_t index[3];
    struct scene scene;
    struct world world;
};

static void alone_make(struct alone *a, const float vertex[9])
{
    *a = (struct alone){.index = {0, 1, 2}};
    memcpy(a->vertex, vertex, sizeof a->vertex);
    a->scene =
        (struct scene){.vertex = a->vertex, .vertex_count = 3, .index = a->index, .tri_count = 1};
    assert_int_equal(world_of_scene(&a->scene, &a->world, NULL), STATUS_OK);
}

/* How an answer of a tracer whose formula is not known is judged. Frees the world. */
static struct judgement judged_alone(struct alone *a, const struct ray *ray, struct ray_mode mode,
                                     const struct hit *hit, uint32_t tag)
{
    const struct model unknown = {.formula = TWIN_UNKNOWN, .rounding = ROUNDING_IEEE};
    struct oracle *oracle;
    struct judge *judge;
    struct oracle_answer truth;
    struct judgement j;
    assert_int_equal(world_finish(&a->world, NULL), STATUS_OK);
    assert_int_equal(oracle_make_world(&a->world, &oracle, NULL), STATUS_OK);
    assert_int_equal(judge_make(oracle, &unknown, QUERY_CLOSEST, &judge, NULL), STATUS_OK);
    assert_int_equal(oracle_closest_world(oracle, ORACLE_AUTO, ORACLE_CLOSED, ray, &mode, 1, 1,
                                          &truth, NULL, NULL),
                     STATUS_OK);
    assert_int_equal(judge_world_answer(judge, ray, mode, &truth, hit, tag, &j), STATUS_OK);
    judge_free(judge);
    oracle_free(oracle);
    world_free(&a->world);
    return j;
}

/* A sliver of width `width` in units of the displacement that is allowed, 32 u times the distance
 * of its farthest vertex, in a world of its own; the ray meets it at a right angle, through the
 * middle. Returns what a tracer is found to do that says the other side. */
static enum wrong of_the_other_side(double width, bool turned, uint32_t flags)
{
    const float far = 8, top = (float)(width * 32 * 0x1p-24 * (double)far);
    const float vertex[9] = {-far, 0, 3, far, 0, 3, 0, top, 3};
    const struct ray ray = {.org = {0, top / 4, 0}, .dir = {0, 0, 1}, .tmax = 100};
    /* Vertices run counterclockwise along d, so that the back is seen. */
    const struct hit hit = {.t = 3, .u = 0.375f, .v = 0.25f, .prim = 0};
    struct alone alone;
    alone_make(&alone, vertex);
    alone.world.instance[0].flags = turned ? ABI_INSTANCE_FLIP_FACING : 0;
    return judged_alone(&alone, &ray, (struct ray_mode){0xFF, flags}, &hit,
                        turned ? 0 : ABI_TAG_FRONT)
        .wrong;
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

/* Whether the front of a triangle is seen along d. */
static bool sees_front(float v[3][3], const float d[3])
{
    double side = 0;
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        side += (double)d[k] *
                (((double)v[1][a] - (double)v[0][a]) * ((double)v[2][b] - (double)v[0][b]) -
                 ((double)v[1][b] - (double)v[0][b]) * ((double)v[2][a] - (double)v[0][a]));
    }
    return side < 0;
}

/* How a tracer is judged that takes the ray into the mesh, and answers what its test has there. */
static struct judgement of_flat_case(uint64_t seed, const char *tri)
{
    struct rng rng = rng_make(seed, 77);
    struct alone alone;
    struct instance_record *record;
    struct ray ray;
    float vertex[9], m[3][4], v[3][3];
    flat_case(&rng, m, vertex, &ray);
    alone_make(&alone, vertex);
    memcpy(alone.world.instance[0].m, m, sizeof m);
    assert_int_equal(world_finish(&alone.world, NULL), STATUS_OK);
    assert_int_equal(world_records_make(&alone.world, &record, NULL), STATUS_OK);
    const struct ray placed = transform_ray(record, &ray);
    const struct tri_ray r = tri_ray_make(&placed);
    struct hit hit;
    scene_tri(&alone.scene, 0, v);
    bool found = tri_test_run(tri_test_find(tri)->id, &r, v, &hit);
    hit.prim = 0;
    if (!found)
        hit = hit_none();
    free(record);
    return judged_alone(&alone, &ray, ray_mode_all(), &hit,
                        found && sees_front(v, placed.dir) ? ABI_TAG_FRONT : 0);
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
            const struct judgement j = of_flat_case(i, tests[t]);
            judged += j.verdict != VERDICT_OUT_OF_CONTRACT;
            wrong += j.verdict == VERDICT_WRONG;
            if (j.verdict == VERDICT_WRONG && wrong < 10)
                print_message("case %llu, %s: %s\n", (unsigned long long)i, tests[t],
                              wrong_name(j.wrong));
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
    const struct ray ray = {.org = {0x1p-36f, 0, 0x1.4p-37f}, .dir = {0, 0, -1}, .tmax = INFINITY};
    const struct hit hit = {.t = 0x1.555556p-37f, .u = 0, .v = 1, .prim = 0};
    struct alone alone;
    for (int i = 0; i < 9; i++)
        vertex[i] = ldexpf(vertex[i], up);
    alone_make(&alone, vertex);
    for (int k = 0; k < 3; k++)
        alone.world.instance[0].m[k][k] = ldexpf(k == 1 ? 0x1p3f : 0x1p12f, -up);
    const struct judgement j = judged_alone(&alone, &ray, ray_mode_all(), &hit, ABI_TAG_FRONT);
    assert_int_equal(j.expected, 0);
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
    unsigned wrong[2] = {0, 0};
    for (int huge = 0; huge < 2; huge++)
        for (uint32_t seed = 0; seed < 16; seed++) {
            const float a = huge ? 0x1p63f : 1, vertex[9] = {a, 0, 0, 0, a, 0, a, a, 2 * a};
            const struct ray ray = {.org = {0, 0, a}, .dir = {1, 1, -1}, .tmax = INFINITY};
            const struct hit hit = {.t = 0.6f * a, .u = 0, .v = 0, .prim = 0};
            struct alone alone;
            alone_make(&alone, vertex);
            alone.world.mesh[0].geometry[0].opaque = false;
            alone.world.filter =
                (struct filter_rule){.kind = FILTER_CELLS, .seed = seed, .share = 128};
            wrong[huge] +=
                judged_alone(&alone, &ray, ray_mode_all(), &hit, 0).wrong == WRONG_OPACITY;
        }
    assert_true(wrong[0] > 3);
    assert_int_equal(wrong[1], 0);
}

/* M is a product of shears by whole numbers and of powers of two, M^-1 therefore as exact as the
 * ray in the mesh, whose coordinates are whole, too. */
static void whole_shear(struct rng *rng, float m[3][4], double inverse[9], double *det)
{
    float power[3];
    for (int k = 0; k < 3; k++)
        power[k] = ldexpf(1, (int)rng_below(rng, 9) - 4);
    const int axis = (int)rng_below(rng, 3), along = (axis + 1 + (int)rng_below(rng, 2)) % 3;
    const float by = (float)rng_below(rng, 40) - 20;
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 3; j++) { /* (1 + by e_axis e_along^T) diag(power) */
            float shear = k == j ? 1.0f : k == axis && j == along ? by : 0.0f;
            m[k][j] = shear * power[j];
            double back = k == j ? 1 : k == axis && j == along ? -(double)by : 0;
            inverse[3 * k + j] = back / (double)power[k];
        }
    *det = (double)power[0] * (double)power[1] * (double)power[2];
}

static void whole_point(struct rng *rng, float out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (float)rng_below(rng, 64) - 32;
}

static void assert_near(double a, double b, const char *what)
{
    if (!(fabs(a - b) <= 1e-9 * (fabs(a) + fabs(b))))
        fail_msg("%s: %a, not %a", what, a, b);
}

/* In a placed triangle every bound of the classical test is that of the world or of the mesh times
 * |det M|, whichever is wider, and the determinant's has what the transform moves besides. */
static void bounds_are_the_wider_of_world_and_mesh(void **state)
{
    (void)state;
    struct rng rng = rng_make(8, 8);
    uint32_t of_mesh[3] = {0, 0, 0};
    for (int turn = 0; turn < 2000; turn++) {
        const struct model unknown = {.formula = TWIN_UNKNOWN, .rounding = ROUNDING_IEEE};
        struct alone alone;
        struct oracle *oracle;
        struct judge *judge;
        struct ray ray = {.tmax = INFINITY}, inside = {.tmax = INFINITY};
        float vertex[9], m[3][4] = {{0}}, v[3][3], placed[3][3];
        double inverse[9], det;
        whole_shear(&rng, m, inverse, &det);
        for (int c = 0; c < 3; c++)
            whole_point(&rng, vertex + 3 * c);
        whole_point(&rng, ray.org);
        whole_point(&rng, ray.dir);
        alone_make(&alone, vertex);
        memcpy(alone.world.instance[0].m, m, sizeof m);
        assert_int_equal(world_finish(&alone.world, NULL), STATUS_OK);
        scene_tri(&alone.scene, 0, v);
        for (int k = 0; k < 3; k++) {
            double o = 0, d = 0;
            for (int j = 0; j < 3; j++) {
                o += inverse[3 * k + j] * (double)ray.org[j];
                d += inverse[3 * k + j] * (double)ray.dir[j];
            }
            inside.org[k] = (float)o;
            inside.dir[k] = (float)d;
            for (int c = 0; c < 3; c++)
                placed[c][k] = m[k][0] * v[c][0] + m[k][1] * v[c][1] + m[k][2] * v[c][2];
        }
        assert_int_equal(oracle_make_world(&alone.world, &oracle, NULL), STATUS_OK);
        assert_int_equal(judge_make(oracle, &unknown, QUERY_CLOSEST, &judge, NULL), STATUS_OK);
        const struct judge_rounding at = judge_rounding_at(judge, &ray, 0);
        const struct judge_rounding world = judge_rounding_of(&ray, placed);
        const struct judge_rounding mesh = judge_rounding_of(&inside, v);
        const double moved =
            2 * at.extra * at.tri.unit * (at.across[0] + at.across[1] + at.across[2]);
        if (!instance_is_identity(&alone.world.instance[0])) {
            for (int c = 0; c < 3; c++)
                assert_near(at.edge_most[c], fmax(world.edge_most[c], det * mesh.edge_most[c]),
                            "edge");
            assert_near(at.det_most, fmax(world.det_most, det * mesh.det_most) + moved, "det");
            assert_near(at.t_most, fmax(world.t_most, det * mesh.t_most), "t");
            of_mesh[0] += det * mesh.edge_most[0] > 1.5 * world.edge_most[0];
            of_mesh[1] += det * mesh.det_most > 1.5 * world.det_most;
            of_mesh[2] += det * mesh.t_most > 1.5 * world.t_most;
        }
        judge_free(judge);
        oracle_free(oracle);
        world_free(&alone.world);
    }
    for (int i = 0; i < 3; i++)
        assert_true(of_mesh[i] > 50);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slivers_of_sheared_instances_are_judged_as_their_meshes_see_them),
        cmocka_unit_test(what_is_flushed_in_a_mesh_may_be_lost),
        cmocka_unit_test(bounds_are_the_wider_of_world_and_mesh),
        cmocka_unit_test(a_filter_reads_no_cells_beyond_the_contract),
        cmocka_unit_test(a_side_is_known_where_no_displacement_turns_it),
    };
    return cmocka_run_group_tests_name("world_slivers", tests, NULL, NULL);
}
