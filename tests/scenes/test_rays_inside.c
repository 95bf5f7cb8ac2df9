/* Rays from inside closed meshes: the points are inside, the rays come near edges, and bad meshes
 * are refused. */
#include "scenes/rays/rays_inside.h"
#include "ref/primitives/primitives.h"
#include "scenes/rays/rays.h"
#include "tests/support/all_hits_fixture.h"
#include "tests/support/opened.h"

#include <math.h>

#define RAYS 4000

static struct oracle *oracle_of(const struct scene *scene)
{
    struct oracle *oracle;
    struct reason reason = {""};
    stand_must(oracle_make(scene, &oracle, &reason), &reason);
    return oracle;
}

static struct topology topology_of(const struct scene *scene)
{
    struct topology topology;
    assert_int_equal(topology_make(scene, &topology, NULL), STATUS_OK);
    return topology;
}

static bool inside(const struct oracle *oracle, float x, float y, float z)
{
    struct rng rng = rng_make(3, 0);
    const float point[3] = {x, y, z};
    bool is;
    assert_int_equal(point_is_inside(oracle, point, &rng, &is, NULL), STATUS_OK);
    return is;
}

static void inside_is_odd_and_off_the_surface(void **state)
{
    (void)state;
    struct scene scene = opened("sphere", 1);
    struct oracle *oracle = oracle_of(&scene);
    const float *v = scene.vertex;
    assert_true(inside(oracle, 0, 0, 0));
    assert_true(inside(oracle, 0.5f * v[0], 0.5f * v[1], 0.5f * v[2]));
    assert_true(inside(oracle, 0.999f * v[0], 0.999f * v[1], 0.999f * v[2]));
    assert_false(inside(oracle, 1.001f * v[0], 1.001f * v[1], 1.001f * v[2]));
    assert_false(inside(oracle, v[0], v[1], v[2])); /* a vertex */
    assert_false(inside(oracle, 100, 0, 0));
    oracle_free(oracle);
    scene_free(&scene);
}

/* By the oracle, from every origin that was used: a ray leaves what surrounds it. */
static void every_ray_leaves_the_mesh(void **state)
{
    (void)state;
    static const char *const specs[] = {"sphere", "flake", "platonic"};
    for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
        struct scene scene = opened(specs[s], 1);
        struct oracle *oracle = oracle_of(&scene);
        struct topology topology = topology_of(&scene);
        struct ray ray[RAYS];
        uint8_t aim[RAYS];
        struct oracle_answer answer[RAYS];
        struct inside made;
        struct reason reason = {""};
        stand_must(rays_inside_make(&scene, &topology, oracle, 5, RAYS, ray, aim, &made, &reason),
                   &reason);
        stand_must(
            oracle_closest(oracle, ORACLE_AUTO, ORACLE_CLOSED, ray, RAYS, 1, answer, NULL, &reason),
            &reason);
        for (size_t i = 0; i < RAYS; i++) {
            assert_true(ray_in_contract(&ray[i]));
            assert_true(ray[i].tmin == 0 && ray[i].tmax == RAY_TMAX);
            assert_int_equal(aim[i], i % LEAK_AIMS);
            assert_int_not_equal(answer[i].prim, ABI_NO_PRIM);
        }
        assert_int_equal(made.origins, INSIDE_ORIGINS);
        /* Those at silhouettes may pass beside all triangles. */
        assert_true(made.sampled >= 500 && made.near > made.sampled * 3 / 4);
        assert_true(made.exact > RAYS / 10 && made.exact < RAYS);
        topology_free(&topology);
        oracle_free(oracle);
        scene_free(&scene);
    }
}

/* The target lies at t = 1, or at a power of two: the aim is what it says. */
static void rays_go_where_they_are_aimed(void **state)
{
    (void)state;
    struct scene scene = opened("platonic", 1);
    struct oracle *oracle = oracle_of(&scene);
    struct topology topology = topology_of(&scene);
    struct ray ray[RAYS];
    uint8_t aim[RAYS];
    struct inside made;
    struct reason reason = {""};
    size_t beside = 0;
    stand_must(rays_inside_make(&scene, &topology, oracle, 6, RAYS, ray, aim, &made, &reason),
               &reason);
    for (size_t i = 0; i < RAYS; i++) {
        double target[3], nearest = INFINITY;
        for (int k = 0; k < 3; k++)
            target[k] = (double)ray[i].org[k] + (double)ray[i].dir[k];
        for (uint32_t e = 0; e < topology.edge_count; e++) {
            const float *a = scene.vertex + 3 * (size_t)topology.vertex[topology.edge[e].a];
            const float *b = scene.vertex + 3 * (size_t)topology.vertex[topology.edge[e].b];
            double along = 0, length = 0, away = 0;
            for (int k = 0; k < 3; k++) {
                along += (target[k] - (double)a[k]) * ((double)b[k] - (double)a[k]);
                length += ((double)b[k] - (double)a[k]) * ((double)b[k] - (double)a[k]);
            }
            double s = fmin(fmax(along / length, 0), 1);
            if (aim[i] == LEAK_VERTEX)
                s = s < 0.5 ? 0 : 1;
            if (aim[i] == LEAK_MIDPOINT)
                s = 0.5;
            for (int k = 0; k < 3; k++)
                away += pow((double)a[k] + s * ((double)b[k] - (double)a[k]) - target[k], 2);
            nearest = fmin(nearest, sqrt(away));
        }
        if (aim[i] != LEAK_BESIDE)
            assert_true(nearest < 1e-5);
        else
            beside += nearest > 1e-5;
        assert_true(nearest < 0.1);
    }
    assert_true(beside > RAYS / 8);
    topology_free(&topology);
    oracle_free(oracle);
    scene_free(&scene);
}

static void rays_depend_on_the_seed_alone(void **state)
{
    (void)state;
    struct scene scene = opened("sphere:n=4", 1);
    struct oracle *oracle = oracle_of(&scene);
    struct topology topology = topology_of(&scene);
    struct ray ray[3][100];
    uint8_t aim[100];
    struct inside made;
    static const uint64_t seed[3] = {1, 1, 2};
    for (int i = 0; i < 3; i++)
        assert_int_equal(
            rays_inside_make(&scene, &topology, oracle, seed[i], 100, ray[i], aim, &made, NULL),
            STATUS_OK);
    assert_memory_equal(ray[0], ray[1], sizeof ray[0]);
    assert_memory_not_equal(ray[0], ray[2], sizeof ray[0]);
    topology_free(&topology);
    oracle_free(oracle);
    scene_free(&scene);
}

/* Two triangles back to back are closed and have no inside. */
static void a_flat_mesh_has_no_inside(void **state)
{
    (void)state;
    static const float at[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    static const uint32_t index[6] = {0, 1, 2, 0, 2, 1};
    struct scene scene;
    struct reason reason = {""};
    assert_int_equal(scene_make(3, 2, &scene), STATUS_OK);
    memcpy(scene.vertex, at, sizeof at);
    memcpy(scene.index, index, sizeof index);
    struct oracle *oracle = oracle_of(&scene);
    struct topology topology = topology_of(&scene);
    struct ray ray[10];
    uint8_t aim[10];
    struct inside made;
    assert_int_equal(topology_is_closed(&topology, &scene, &reason), STATUS_OK);
    assert_int_equal(rays_inside_make(&scene, &topology, oracle, 1, 10, ray, aim, &made, &reason),
                     STATUS_INPUT);
    assert_non_null(strstr(reason.text, "no point inside"));
    topology_free(&topology);
    oracle_free(oracle);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(inside_is_odd_and_off_the_surface),
        cmocka_unit_test(every_ray_leaves_the_mesh),
        cmocka_unit_test(rays_go_where_they_are_aimed),
        cmocka_unit_test(rays_depend_on_the_seed_alone),
        cmocka_unit_test(a_flat_mesh_has_no_inside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
