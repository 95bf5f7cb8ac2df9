/* What the oracle looks at, seen by a kernel (ref/oracle/early.h) that keeps a list: brute force
 * looks at every triangle once a ray, a walk at the leaves that lie within the reach alone, each
 * with a bound that is the largest distance along an axis to the bit; on as many threads as there
 * is work for. Answers do not show any of this. */
#include "ref/base/rng.h"
#include "ref/oracle/internal.h"
#include "ref/oracle/oracle_world.h"
#include "tests/exact/pair_fault.h"
#include "tests/support/tree_fixture.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

static struct reason reason;

/* --- the kernel that keeps a list ------------------------------------------------------------- */

#define LOOKS_MOST 8192

struct looked_at {
    double o[3];
    uint32_t first, count;
    double largest;
    int threads;
};

static struct looked_at looked[LOOKS_MOST];
static size_t looks;

static uint64_t keep(const struct early_soup *soup, const struct early_ray *ray, uint32_t first,
                     uint32_t count, double largest)
{
#pragma omp critical
    {
        assert_true(looks < LOOKS_MOST);
        looked[looks] = (struct looked_at){
            {ray->o[0], ray->o[1], ray->o[2]}, first, count, largest, omp_get_num_threads()};
        looks++;
    }
    return early_kernels[0].look(soup, ray, first, count, largest);
}

static bool always(void)
{
    return true;
}

static const struct early_kernel keeping = {"keeping", keep, always};

static struct oracle *watched(const struct scene *scene)
{
    struct oracle *oracle;
    assert_int_equal(oracle_make(scene, &oracle, &reason), STATUS_OK);
    oracle->kernel = &keeping;
    return oracle;
}

/* --- scenes ----------------------------------------------------------------------------------- */

/* Small triangles in a cube of this size. */
static struct scene draw_scene(struct rng *rng, uint32_t count, float size)
{
    struct scene scene;
    assert_int_equal(scene_make(3 * count, count, &scene), STATUS_OK);
    for (uint32_t i = 0; i < 3 * count; i++) {
        scene.index[i] = i;
        for (uint32_t k = 0; k < 3; k++)
            scene.vertex[3 * i + k] = i % 3 ? scene.vertex[9 * (i / 3) + k] : 0;
        for (uint32_t k = 0; k < 3; k++)
            scene.vertex[3 * i + k] += size * rng_range(rng, -1, 1) * (i % 3 ? 0.5f : 1.0f);
    }
    return scene;
}

/* The largest distance along an axis from o to a vertex of a run of the tree's order. */
static double largest_of(const struct oracle *oracle, const struct looked_at *look)
{
    double most = 0;
    for (uint32_t n = 0; n < look->count; n++) {
        float v[3][3];
        scene_tri(oracle->scene, oracle->tree.order[look->first + n], v);
        for (int i = 0; i < 9; i++)
            most = fmax(most, fabs((double)v[i / 3][i % 3] - look->o[i % 3]));
    }
    return most;
}

/* Rays of which some are refused and some have no direction; each starts somewhere else. */
static void draw_rays(struct rng *rng, uint32_t count, float size, struct ray *ray)
{
    for (uint32_t i = 0; i < count; i++) {
        ray[i] = (struct ray){.tmax = INFINITY};
        for (int k = 0; k < 3; k++) {
            ray[i].org[k] = 2 * size * rng_range(rng, -1, 1);
            ray[i].dir[k] = size * rng_range(rng, -0.5f, 0.5f) - ray[i].org[k];
        }
        if (rng_below(rng, 4) == 0)
            ray[i].tmin = INFINITY;
        else if (rng_below(rng, 4) == 0)
            ray[i].dir[0] = ray[i].dir[1] = ray[i].dir[2] = 0;
    }
}

static bool is_walked(const struct ray *ray)
{
    return ray->tmin < INFINITY && (ray->dir[0] != 0 || ray->dir[1] != 0 || ray->dir[2] != 0);
}

static bool starts_at(const struct looked_at *look, const struct ray *ray)
{
    return look->o[0] == (double)ray->org[0] && look->o[1] == (double)ray->org[1] &&
           look->o[2] == (double)ray->org[2];
}

/* How often each triangle was looked at by a ray. */
static void count_looks(const struct oracle *oracle, const struct ray *ray, uint32_t *times)
{
    memset(times, 0, oracle->scene->tri_count * sizeof *times);
    for (size_t n = 0; n < looks; n++)
        for (uint32_t i = 0; i < looked[n].count && starts_at(&looked[n], ray); i++)
            times[oracle->tree.order[looked[n].first + i]]++;
}

static void every_triangle_is_looked_at_once(void **state)
{
    (void)state;
    enum { RAYS = 50, TRIS = 200 };
    static const uint32_t counts[] = {1, 5, 63, 64, 65, 128, 129, TRIS};
    struct rng rng = rng_make(31, 0);
    uint32_t times[TRIS], hits = 0;
    struct ray ray[RAYS];
    struct oracle_answer answer[RAYS], alone;
    for (size_t s = 0; s < ARRAY_COUNT(counts); s++)
        for (int brute = 0; brute < 2; brute++) {
            const float size = s % 2 ? 0.125f : 100;
            const enum oracle_path path = brute ? ORACLE_BRUTE : ORACLE_TREE;
            struct scene scene = draw_scene(&rng, counts[s], size);
            struct oracle *oracle = watched(&scene);
            struct oracle_stats stats = {0};
            uint64_t sum = 0;
            draw_rays(&rng, RAYS, size, ray);
            looks = 0;
            assert_int_equal(
                oracle_closest(oracle, path, ORACLE_CLOSED, ray, RAYS, 1, answer, &stats, &reason),
                STATUS_OK);
            for (size_t n = 0; n < looks; n++) {
                assert_true(looked[n].largest == largest_of(oracle, &looked[n]));
                sum += looked[n].count;
            }
            assert_int_equal(stats.pairs, sum);
            for (uint32_t i = 0; i < RAYS; i++) {
                count_looks(oracle, &ray[i], times);
                for (uint32_t p = 0; p < counts[s]; p++)
                    if (brute)
                        assert_int_equal(times[p], is_walked(&ray[i]));
                    else
                        assert_in_range(times[p], 0, is_walked(&ray[i]));
                hits += answer[i].prim != ABI_NO_PRIM;
            }
            for (uint32_t i = 0; i < RAYS; i++) { /* not on its neighbours either */
                assert_int_equal(oracle_closest(oracle, path, ORACLE_CLOSED, &ray[i], 1, 1, &alone,
                                                NULL, &reason),
                                 STATUS_OK);
                assert_true(answer_same(&answer[i], &alone));
                looks = 0;
            }
            oracle_free(oracle);
            scene_free(&scene);
        }
    assert_true(hits > 100);
}

/* Up to ORACLE_BRUTE_MOST triangles by brute force, from there on by the tree. */
static void few_triangles_take_no_tree(void **state)
{
    (void)state;
    const struct ray ray = {{0, 0, -9}, 0, {0, 0, 1}, INFINITY};
    for (uint32_t more = 0; more < 2; more++) {
        struct rng rng = rng_make(32, 0);
        const uint32_t count = ORACLE_BRUTE_MOST + more;
        struct scene scene = draw_scene(&rng, count, 1);
        struct oracle *oracle = watched(&scene);
        struct oracle_answer answer;
        struct oracle_stats stats = {0};
        looks = 0;
        assert_int_equal(oracle_closest(oracle, ORACLE_AUTO, ORACLE_CLOSED, &ray, 1, 1, &answer,
                                        &stats, &reason),
                         STATUS_OK);
        assert_int_equal(stats.pairs == count, more == 0);
        oracle_free(oracle);
        scene_free(&scene);
    }
}

/* As many threads as are asked for, but no more than parts of 16 rays. */
static void a_thread_has_rays(void **state)
{
    (void)state;
    enum { RAYS = 64 };
    struct rng rng = rng_make(33, 0);
    struct scene scene = draw_scene(&rng, 40, 1);
    struct world world;
    struct oracle *oracle = watched(&scene), *placed;
    struct ray ray[RAYS];
    struct oracle_answer answer[RAYS];
    assert_int_equal(world_of_scene(&scene, &world, &reason), STATUS_OK);
    assert_int_equal(oracle_make_world(&world, &placed, &reason), STATUS_OK);
    placed->placing->mesh[0]->kernel = &keeping;
    for (size_t i = 0; i < RAYS; i++)
        ray[i] = (struct ray){{0, 0, -3}, 0, {0, 0, 1}, INFINITY};
    for (unsigned asked = 1; asked <= 4; asked++)
        for (size_t count = 1; count <= RAYS; count += 7)
            for (int placing = 0; placing < 2; placing++) {
                const size_t parts = (count + 15) / 16;
                looks = 0;
                if (placing)
                    assert_int_equal(oracle_closest_world(placed, ORACLE_TREE, ORACLE_CLOSED, ray,
                                                          NULL, count, asked, answer, NULL,
                                                          &reason),
                                     STATUS_OK);
                else
                    assert_int_equal(oracle_closest(oracle, ORACLE_TREE, ORACLE_CLOSED, ray, count,
                                                    asked, answer, NULL, &reason),
                                     STATUS_OK);
                assert_int_equal(looks, count);
                for (size_t n = 0; n < looks; n++)
                    assert_int_equal(looked[n].threads, parts < asked ? parts : asked);
            }
    oracle_free(oracle);
    oracle_free(placed);
    world_free(&world);
    scene_free(&scene);
}

/* --- reach ------------------------------------------------------------------------------------ */

#define ROW 200

/* Of a row whose triangle i is met at t = at + i each, exactly the leaves are looked at that reach
 * into `least` to `most`; `twice`: those at 0 forth and back. */
static void expect_reached(const struct oracle *mesh, double at, double each, double least,
                           double most, bool twice)
{
    uint32_t want = 0, got = 0;
    for (uint32_t n = 0; n < mesh->tree.node_count; n++)
        for (int side = 0; side < 2; side++) {
            const struct tree_node *node = &mesh->tree.node[n];
            double one = at + each * ((double)node->lo[2][side] - 1);
            double two = at + each * ((double)node->hi[2][side] - 1);
            if (node->count[side] && fmax(one, two) >= least && fmin(one, two) <= most)
                want +=
                    node->count[side] * (twice && one * two <= 0 && least < 0 && most >= 0 ? 2 : 1);
        }
    for (size_t n = 0; n < looks; n++)
        got += looked[n].count;
    assert_int_equal(got, want);
}

/* Whether the row is met forth or back, from before it or from within, by a ray whose own range
 * ends it or whose t_most does; as a scene, in a world, and placed at double size. */
static void crossings_are_looked_for_within_reach(void **state)
{
    (void)state;
    struct scene scene = trees_row(ROW);
    struct oracle_crossing *list = NULL;
    size_t capacity = 0, count;
    for (int kind = 0; kind < 3; kind++) {
        struct world world;
        struct oracle *oracle = NULL, *mesh;
        const double scale = kind == 2 ? 2 : 1;
        assert_int_equal(world_of_scene(&scene, &world, &reason), STATUS_OK);
        for (int k = 0; k < 3; k++)
            world.instance[0].m[k][k] = (float)scale;
        if (kind)
            assert_int_equal(oracle_make_world(&world, &oracle, &reason), STATUS_OK);
        mesh = kind ? oracle->placing->mesh[0] : watched(&scene);
        oracle = kind ? oracle : mesh;
        mesh->kernel = &keeping;
        for (int n = 0; n < 160; n++) {
            const double from = n % 4 == 0 ? 0 : n % 4 == 1 ? ROW + 1 : ROW / 2;
            const double way = n % 4 == 1 || n % 4 == 3 ? -1 : 1;
            const double tmin = n / 4 % 2 ? -1000.25 : -20.25;
            const double most = n / 16 * 11 + 0.25 - (n % 4 > 1 ? 60 : 0);
            const bool by_range = n / 8 % 2;
            const struct ray ray = {{0, 0, (float)(scale * from)},
                                    (float)tmin,
                                    {0, 0, (float)(way * scale)},
                                    by_range ? (float)fmax(most, tmin) : 2000};
            const double t_most = by_range ? INFINITY : most;
            looks = 0;
            assert_int_equal(
                kind ? oracle_crossings_world(oracle, &ray, ray_mode_all(), t_most, &list,
                                              &capacity, &count, &reason)
                     : oracle_crossings(oracle, &ray, t_most, &list, &capacity, &count, &reason),
                STATUS_OK);
            expect_reached(mesh, (1 - from) * way, way, tmin, by_range ? fmax(most, tmin) : most,
                           kind == 2);
            for (size_t i = 0; i < count; i++)
                assert_true(list[i].pair.t_lo <= most && list[i].pair.t_lo >= tmin);
        }
        oracle_free(oracle);
        world_free(&world);
    }
    free(list);
    scene_free(&scene);
}

/* The reach is 2^-38 of t_most beyond it, whatever its sign: a triangle a little nearer is looked
 * at, one a little farther is not. */
static void the_reach_is_known_to_its_bits(void **state)
{
    (void)state;
    float vertex[9] = {-1, -1, 3, 1, -1, 3, 0, 1, 3};
    uint32_t index[3] = {0, 1, 2};
    struct scene scene = {.vertex = vertex, .index = index, .vertex_count = 3, .tri_count = 1};
    struct oracle *oracle = watched(&scene);
    struct oracle_crossing *list = NULL;
    size_t capacity = 0, count;
    for (int sense = -1; sense <= 1; sense += 2)
        for (int n = 0; n < 8; n++) {
            const struct ray ray = {{0, 0, 0}, -9, {0, 0, (float)sense}, 9};
            const double t = 3 * sense, off = (n - 4 + 0.5) * 0x1p-41;
            const double t_most = t - fabs(t) * (0x1p-38 + off);
            looks = 0;
            assert_int_equal(
                oracle_crossings(oracle, &ray, t_most, &list, &capacity, &count, &reason),
                STATUS_OK);
            assert_int_equal(looks, off < 0);
            assert_int_equal(count, 0);
        }
    free(list);
    oracle_free(oracle);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_triangle_is_looked_at_once),
        cmocka_unit_test(few_triangles_take_no_tree),
        cmocka_unit_test(a_thread_has_rays),
        cmocka_unit_test(crossings_are_looked_for_within_reach),
        cmocka_unit_test(the_reach_is_known_to_its_bits),
    };
    return cmocka_run_group_tests_name("oracle_looks", tests, NULL, NULL);
}
