/* What the walk of a world may not lose, in worlds made for it: flat meshes and rays from afar; and
 * that brute force loses nothing. */
#include "ref/oracle/exact.h"
#include "tests/exact/world_cases.h"

#include <math.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

static struct reason reason;

static void closest(const struct oracle *oracle, const struct ray *ray, struct oracle_answer *out)
{
    assert_int_equal(oracle_closest_world(oracle, ORACLE_TREE, ORACLE_CLOSED, ray, NULL, 1, 1, out,
                                          NULL, &reason),
                     STATUS_OK);
}

/* Brute force decides each triangle of the instances that a ray may meet, once. */
static void brute_force_counts_its_pairs(void **state)
{
    (void)state;
    for (int k = 0; k < WORLD_TURNS; k++) {
        struct world_case c;
        struct oracle_answer got[WORLD_RAYS];
        struct oracle_stats stats = {0};
        uint64_t want = 0;
        world_case_make(&world_turns[k], 5000, &c);
        assert_int_equal(oracle_closest_world(c.oracle, ORACLE_BRUTE, ORACLE_CLOSED, c.ray, c.mode,
                                              WORLD_RAYS, 1, got, &stats, &reason),
                         STATUS_OK);
        for (int i = 0; i < WORLD_RAYS; i++)
            for (uint32_t at = 0; at < c.world.instance_count; at++)
                if (!(got[i].flags & ORACLE_REFUSED) && !ray_is_still(&c.ray[i]) &&
                    world_meets(&c.world.instance[at], c.mode[i]))
                    want += c.world.first[at + 1] - c.world.first[at];
        assert_int_equal(stats.pairs, want);
        world_case_free(&c);
    }
}

/* A scene as a world in one instance. */
static struct oracle *placed(const struct scene *scene, const float m[3][4], struct world *out)
{
    struct oracle *oracle;
    assert_int_equal(world_of_scene(scene, out, &reason), STATUS_OK);
    memcpy(out->instance[0].m, m, sizeof out->instance[0].m);
    assert_int_equal(oracle_make_world(out, &oracle, &reason), STATUS_OK);
    return oracle;
}

/* A mesh of many nodes in a plane across an axis, whose boxes have no thickness: a ray straight at
 * each of its triangles hits it. */
static void flat_meshes_are_met(void **state)
{
    (void)state;
    enum { SIDE = 10, TRIS = SIDE * SIDE };
    static const float m[3][4] = {{2, 0, 0, 1}, {0, 4, 0, 2}, {0, 0, 2, -3}};
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        struct scene scene;
        struct world world;
        assert_int_equal(scene_make(3 * TRIS, TRIS, &scene), STATUS_OK);
        for (int n = 0; n < 3 * TRIS; n++) {
            scene.index[n] = (uint32_t)n;
            scene.vertex[3 * n + k] = 0.25f;
            scene.vertex[3 * n + i] = (float)(1 + 4 * (n / 3 % SIDE) + n % 3);
            scene.vertex[3 * n + j] = (float)(1 + 4 * (n / 3 / SIDE) + n % 3 % 2);
        }
        struct oracle *oracle = placed(&scene, m, &world);
        for (int n = 0; n < 2 * TRIS; n++) {
            struct ray ray = {{0}, 0, {0}, INFINITY};
            struct oracle_answer answer;
            ray.org[k] = m[k][k] * 0.25f + m[k][3] + (n % 2 ? 8 : -8);
            ray.dir[k] = n % 2 ? -1 : 1;
            ray.org[i] = m[i][i] * (float)(4 * (n / 2 % SIDE) + 2) + m[i][3];
            ray.org[j] = m[j][j] * ((float)(4 * (n / 2 / SIDE)) + 1.5f) + m[j][3];
            closest(oracle, &ray, &answer);
            assert_int_equal(answer.prim, n / 2);
        }
        oracle_free(oracle);
        world_free(&world);
        scene_free(&scene);
    }
}

/* In a mesh that is placed by a shear of extreme numbers the ray starts beyond 2^400, where the
 * first look has no proof. */
static void what_is_too_far_for_a_first_look_is_met(void **state)
{
    (void)state;
    static const float m[3][4] = {{0x1p-149f, 0x1p127f, 0, 0}, {0, 0x1p-149f, 0, 0}, {0, 0, 1, 0}};
    float vertex[9] = {-1, -1, 0, 1, -1, 0, 0, 1, 0};
    uint32_t index[3] = {0, 1, 2};
    struct scene scene = {.vertex = vertex, .index = index, .vertex_count = 3, .tri_count = 1};
    struct world world;
    struct oracle *oracle = placed(&scene, m, &world);
    for (int p = -140; p <= 100; p += 10) {
        const struct ray ray = {{0, ldexpf(1, p), 1}, 0, {0, -ldexpf(1, p), -1}, INFINITY};
        struct oracle_answer answer;
        closest(oracle, &ray, &answer);
        assert_int_equal(answer.prim, 0);
        assert_true(answer.t_lo == 1 && answer.t_hi == 1);
    }
    oracle_free(oracle);
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(brute_force_counts_its_pairs),
        cmocka_unit_test(flat_meshes_are_met),
        cmocka_unit_test(what_is_too_far_for_a_first_look_is_met),
    };
    return cmocka_run_group_tests_name("oracle_world_met", tests, NULL, NULL) ? 1 : 0;
}
