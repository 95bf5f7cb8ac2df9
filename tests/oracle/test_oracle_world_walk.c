/* The walk of a world: the first look and the boxes of a mesh, whose rays are known to a bound
 * alone, and worlds at their ends: empty ones, refused rays, 10^5 instances. */
#include "ref/oracle/early.h"
#include "ref/oracle/internal.h"
#include "ref/oracle/placed_walk.h"
#include "tests/exact/oracle_batch.h"
#include "tests/exact/pair_fault.h"
#include "tests/exact/world_cases.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

static struct reason reason;

/* One instance, triangle and ray. */
struct exact_trial {
    struct instance at;
    struct ray ray;
    float v[3][3];
};

/* --- the first look --------------------------------------------------------------------------- */

/* An instance of whole numbers whose inverse is not exact, a triangle of whole numbers, and a ray
 * that meets a placed edge or vertex exactly. */
static bool draw_exact(struct rng *rng, struct exact_trial *out)
{
    int feature = (int)rng_below(rng, 3), bits = 3 + (int)rng_below(rng, 7);
    *out = (struct exact_trial){0};
    do
        for (int i = 0; i < 12; i++)
            out->at.m[i / 4][i % 4] = (float)((int)rng_below(rng, 31) - 15);
    while (instance_det_sign(out->at.m) == 0);
    bool any = false;
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            out->v[c][k] = (float)(2 * ((int)rng_below(rng, 1u << bits) - (1 << (bits - 1))));
    for (int k = 0; k < 3; k++) {
        float at = out->at.m[k][3];
        for (int j = 0; j < 3; j++)
            at += out->at.m[k][j] * (feature ? 0.5f * (out->v[0][j] + out->v[1][j]) : out->v[0][j]);
        out->ray.org[k] = (float)((int)rng_below(rng, 1u << (bits + 4)) - (1 << (bits + 3)));
        out->ray.dir[k] = at - out->ray.org[k];
        any |= out->ray.dir[k] != 0;
    }
    out->ray.tmax = INFINITY;
    return any;
}

/* Does the first look drop the triangle, with its bounds times `factor`, of products, and its root,
 * of places? */
static bool dropped(const struct exact_trial *trial, double factor)
{
    double v[3][3][1 + EARLY_PAD] = {0}, most = 0;
    struct early_soup soup;
    struct inverse inverse;
    struct sight sight;
    placing_invert(trial->at.m, &inverse);
    sight_make(&inverse, &trial->at, &trial->ray, &sight);
    struct early_ray ray = early_ray_about(sight.o, sight.d, sight.o_err, sight.d_err);
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++) {
            v[c][k][0] = (double)trial->v[c][k];
            soup.v[c][k] = v[c][k];
            most = fmax(most, fabs(v[c][k][0] - sight.o[k]));
        }
    return early_kernels[0].look(&soup, &ray, 0, 1, (most + ray.more) * sqrt(factor)) == 0;
}

static void the_first_look_has_this_much_slack(void **state)
{
    (void)state;
    double broke = 0;
    uint64_t trials = 0;
    struct rng rng = far_rng(41);
    for (uint64_t n = 0; n < (getenv("RAYDIFF_SLOW") ? 10000000 : 200000); n++) {
        struct exact_trial trial;
        if (!draw_exact(&rng, &trial))
            continue;
        trials++;
        assert_false(dropped(&trial, 1));
        while (broke < 1 && dropped(&trial, broke + 1.0 / 512))
            broke += 1.0 / 512;
    }
    print_message(
        "first look in a mesh: dropped an exact hit at %.3f of its bound of products, %.3f "
        "of places, of %llu\n",
        broke, sqrt(broke), (unsigned long long)trials);
    assert_true(broke > 0); /* else the search sees nothing */
}

/* Of a ray that is hardly known, it drops nothing; of one known exactly, it is the scene's. */
static void the_first_look_knows_what_it_may(void **state)
{
    (void)state;
    const struct ray ray = {{1, 2, 3}, 0, {1, -2, 0.5f}, INFINITY};
    const double o[3] = {1, 2, 3}, d[3] = {1, -2, 0.5}, none[3] = {0, 0, 0};
    struct early_ray want = early_ray_make(&ray), got = early_ray_about(o, d, none, none);
    assert_true(got.bound == want.bound && got.beside == want.beside && got.more == 0);
    assert_true(got.s[0] == want.s[0] && got.s[1] == want.s[1] && got.kz == want.kz);
    for (int p = 1; p < 60; p++) {
        const double err[3] = {ldexp(1, -p), ldexp(2, -p), ldexp(0.5, -p)};
        double h = (err[1] + err[0]) / (2 - err[1]); /* z is axis 1, x axis 2 and y axis 0 */
        got = early_ray_about(o, d, none, err);
        assert_int_equal(got.bound < INFINITY, h < 0x1p-10);
        assert_int_equal(got.beside < INFINITY, h < 0x1p-10);
        if (h < 0x1p-10)
            assert_true(got.bound == EARLY_BOUND * (1 + h / EARLY_SHARE) &&
                        got.beside == EARLY_BESIDE * (1 + h / EARLY_SHARE));
        if (h < 0x1p-10)
            assert_true(got.bound >= 65.3 * 0x1p-53 + 8.04 * h && got.beside >= 6.1 * 0x1p-53 + h);
        got = early_ray_about(o, d, err, none);
        assert_true(got.more * 6.1 * 0x1p-53 >= err[1] + err[0]);
    }
}

/* --- the walk where bounds are extreme -------------------------------------------------------- */

/* Whether a walk of the tree of one triangle visits it. */
static bool visits(const struct tree *tree, const struct sight *sight, bool back, double tmin,
                   double reach)
{
    struct placed_walk walk;
    struct tree_leaf leaf;
    placed_walk_start(&walk, tree, sight, back, tmin, reach);
    if (!placed_walk_next(&walk, reach, &leaf))
        return false;
    assert_int_equal(leaf.count, 1);
    assert_false(placed_walk_next(&walk, reach, &leaf)); /* once, and no end of it */
    return true;
}

/* The tree of one triangle in the box [1, 2]^3, times a scale. */
static struct tree box_tree(float scale)
{
    float vertex[9] = {1, 1, 1, 2, 2, 2, 1, 2, 1.5f};
    uint32_t index[3] = {0, 1, 2};
    struct scene scene = {.vertex = vertex, .index = index, .vertex_count = 3, .tri_count = 1};
    struct tree tree;
    for (int i = 0; i < 9; i++)
        vertex[i] *= scale;
    assert_int_equal(tree_make(&scene, &tree, &reason), STATUS_OK);
    return tree;
}

static void walks_end_and_lose_nothing(void **state)
{
    (void)state;
    struct tree tree = box_tree(1), large = box_tree(0x1p110f);
    struct sight sight = {.d = {1, 1, 1}};
    assert_true(visits(&tree, &sight, false, 0, INFINITY));
    assert_true(visits(&tree, &sight, false, 0, 1));
    assert_false(visits(&tree, &sight, false, 0, 0.9));
    assert_true(visits(&tree, &sight, false, 2, INFINITY));
    assert_false(visits(&tree, &sight, false, 2.1, INFINITY));
    assert_false(visits(&tree, &sight, true, 0, INFINITY));
    /* t is about 2^1050, beyond double */
    sight = (struct sight){.d = {0x1p-940, 0x1p-940, 0x1p-940}};
    assert_true(visits(&large, &sight, false, 0, INFINITY));
    assert_false(visits(&large, &sight, false, 0, 0x1p990));
    tree_free(&large);
    /* An error beyond everything: all is visited, forth and back, and the empty side of the root
     * is not. */
    sight = (struct sight){.o_err = {1e60, 1e60, 1e60}, .d_err = {1e9, 1e9, 1e9}};
    assert_true(visits(&tree, &sight, false, 0, INFINITY));
    assert_true(visits(&tree, &sight, true, 0, INFINITY));
    sight = (struct sight){.o = {-1e60, -1e60, -1e60}, .d = {1, 1, 1}, .d_err = {0.5, 0.5, 0.5}};
    assert_true(visits(&tree, &sight, false, 0, INFINITY));
    tree_free(&tree);
}

/* Where the direction may have either sign along an axis, while the others are in the box from t =
 * 1 to 2: in the slab or beside it, by less than the errors or by more. */
static void level_rays_drift_into_slabs(void **state)
{
    (void)state;
    struct tree tree = box_tree(1);
    static const struct {
        double o, o_err, d, d_err;
        bool visited;
    } level[] = {
        {0.5, 0, 0, 0, false},
        {1, 0, 0, 0, true},
        {2, 0, 0, 0, true},
        {2.25, 0, 0, 0, false},
        {0.5, 0.5, 0, 0, true},
        {0.5, 0.25, 0, 0, false},
        {2.5, 0.5, 0, 0, true},
        {2.5, 0.25, 0, 0, false},
        {0.5, 0, 0, 0.25, true},
        {0.5, 0, 0, 0.125, false},
        {2.5, 0, 0, 0.25, true},
        {2.5, 0, 0, 0.125, false},
        {0.5, 0, 0.125, 0.125, true},
        {0.5, 0, -0.125, 0.25, false},
        {2.5, 0, -0.125, 0.125, true},
        {2.5, 0, 0.125, 0.25, false},
        {0.5, 0, 0.5, 0.25, true},
        {0.5, 0, -0.5, 0.25, false},
    };
    for (size_t i = 0; i < ARRAY_COUNT(level); i++) {
        struct sight sight = {.d = {level[i].d, 1, 1}, .d_err = {level[i].d_err, 0, 0}};
        sight.o[0] = level[i].o;
        sight.o_err[0] = level[i].o_err;
        if (visits(&tree, &sight, false, 0, INFINITY) != level[i].visited)
            fail_msg("row %zu", i);
    }
    tree_free(&tree);
}

/* --- worlds at their ends --------------------------------------------------------------------- */

static void closest(const struct oracle *oracle, enum oracle_path path, const struct ray *ray,
                    const struct ray_mode *mode, size_t count, unsigned threads,
                    struct oracle_answer *out)
{
    assert_int_equal(oracle_closest_world(oracle, path, ORACLE_CLOSED, ray, mode, count, threads,
                                          out, NULL, &reason),
                     STATUS_OK);
}

static void expect_nothing(const struct oracle *oracle, const struct ray *ray)
{
    struct oracle_crossing *list = NULL;
    size_t capacity = 0, count;
    for (int path = 0; path < 2; path++) {
        struct oracle_answer answer;
        closest(oracle, path ? ORACLE_TREE : ORACLE_BRUTE, ray, NULL, 1, 1, &answer);
        assert_int_equal(answer.prim, ABI_NO_PRIM);
        assert_int_equal(answer.class, ORACLE_MISS);
        assert_int_equal(answer.tie_count, 0);
    }
    assert_int_equal(oracle_crossings_world(oracle, ray, ray_mode_all(), INFINITY, &list, &capacity,
                                            &count, &reason),
                     STATUS_OK);
    assert_int_equal(count, 0);
    free(list);
}

/* No instance, no mesh, empty meshes, only inactive instances. */
static void empty_worlds_are_missed(void **state)
{
    (void)state;
    const struct ray ray = {{0, 0, 0}, -1, {1, 2, 3}, INFINITY};
    struct scene scene;
    struct geometry geometry = {0, 0, true};
    struct instance instance[2] = {{.m = {{1, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 1, 0}}, .mask = 0xFF},
                                   {.m = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}, .mask = 0xFF}};
    assert_int_equal(scene_make(0, 0, &scene), STATUS_OK);
    struct world_mesh mesh = {&scene, &geometry, 1};
    for (uint32_t n = 0; n < 4; n++) {
        struct world world = {.mesh = &mesh, .instance = instance, .borrows = true};
        struct oracle *oracle;
        world.mesh_count = n > 0;
        world.instance_count = n > 1 ? 2 : 0;
        for (int i = 0; i < 2; i++)
            instance[i].mesh = n == 3 ? WORLD_NO_MESH : 0;
        assert_int_equal(world_finish(&world, &reason), STATUS_OK);
        assert_int_equal(oracle_make_world(&world, &oracle, &reason), STATUS_OK);
        expect_nothing(oracle, &ray);
        oracle_free(oracle);
        free(world.first);
    }
    scene_free(&scene);
}

/* Rays that oracle_closest refuses are refused here, and a still one misses. */
static void rays_are_refused_as_of_scenes(void **state)
{
    (void)state;
    struct world_case c;
    struct oracle_answer answer;
    world_case_make(&world_turns[2], 1, &c);
    for (int n = 0; n < 10; n++) {
        struct ray ray = {{1, 2, 3}, 0, {1, 1, 1}, INFINITY};
        if (n < 3)
            ray.org[n] = n ? NAN : INFINITY;
        else if (n < 6)
            ray.dir[n - 3] = n == 3 ? NAN : -INFINITY;
        else if (n == 6)
            ray.tmin = INFINITY;
        else if (n == 7)
            ray.tmax = NAN;
        else if (n == 8)
            ray.tmax = -1;
        else
            ray.dir[0] = ray.dir[1] = ray.dir[2] = 0;
        for (int path = 0; path < 2; path++) {
            closest(c.oracle, path ? ORACLE_TREE : ORACLE_BRUTE, &ray, NULL, 1, 1, &answer);
            assert_int_equal(answer.flags, n < 9 ? ORACLE_REFUSED : 0);
            assert_int_equal(answer.prim, ABI_NO_PRIM);
        }
        expect_nothing(c.oracle, &ray);
    }
    world_case_free(&c);
}

/* 10^5 instances of a few triangles, in a grid and turned: rays straight at one of them. */
static void many_instances_are_found(void **state)
{
    (void)state;
    enum { COUNT = 100000, RAYS = 400 };
    static struct ray ray[RAYS];
    static struct oracle_answer one[RAYS], two[RAYS];
    struct rng rng = far_rng(5);
    float vertex[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    uint32_t index[12] = {0, 1, 2, 0, 1, 3, 0, 2, 3, 1, 2, 3};
    struct scene scene = {.vertex = vertex, .index = index, .vertex_count = 4, .tri_count = 4};
    struct geometry geometry = {0, 4, true};
    struct world_mesh mesh = {&scene, &geometry, 1};
    struct world world = {.mesh = &mesh, .mesh_count = 1, .instance_count = COUNT, .borrows = true};
    struct oracle *oracle;
    world.instance = alloc_zeroed(COUNT, sizeof *world.instance);
    for (uint32_t i = 0; i < COUNT; i++) {
        world.instance[i].mask = 1u << i % 8;
        world_turn_draw(&world_turns[2 + i % 2 * 4], &rng, world.instance[i].m);
        for (int k = 0; k < 3; k++)
            world.instance[i].m[k][3] = rng_range(&rng, -60, 60);
    }
    assert_int_equal(world_finish(&world, &reason), STATUS_OK);
    assert_int_equal(oracle_make_world(&world, &oracle, &reason), STATUS_OK);
    uint32_t hits = 0;
    struct ray_mode mode[RAYS];
    for (int i = 0; i < RAYS; i++) {
        world_case_aim(&world, false, &rng, &ray[i]);
        mode[i] = (struct ray_mode){1u << i % 8 | 1, 0};
    }
    closest(oracle, ORACLE_TREE, ray, mode, RAYS, 1, one);
    closest(oracle, ORACLE_TREE, ray, mode, RAYS, 2, two);
    for (int i = 0; i < RAYS; i++) {
        assert_true(answer_same(&one[i], &two[i]));
        hits += one[i].prim != ABI_NO_PRIM;
        if (i % 40)
            continue;
        closest(oracle, ORACLE_BRUTE, &ray[i], &mode[i], 1, 1, &two[i]);
        assert_true(answer_same(&one[i], &two[i]));
    }
    assert_true(hits > RAYS / 4);
    oracle_free(oracle);
    free(world.instance);
    free(world.first);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_look_has_this_much_slack),
        cmocka_unit_test(the_first_look_knows_what_it_may),
        cmocka_unit_test(walks_end_and_lose_nothing),
        cmocka_unit_test(level_rays_drift_into_slabs),
        cmocka_unit_test(empty_worlds_are_missed),
        cmocka_unit_test(rays_are_refused_as_of_scenes),
        cmocka_unit_test(many_instances_are_found),
    };
    return cmocka_run_group_tests_name("oracle_world_walk", tests, NULL, NULL) ? 1 : 0;
}
