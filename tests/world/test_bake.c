/* A world as one scene of placed triangles. */
#include "tests/world/world_fixture.h"

#include "ref/world/bake.h"

#include <math.h>

/* Three instances of a mesh of two: moved, mirrored and doubled, inactive. */
static struct world placed(void)
{
    struct world w = fixture_world((const uint32_t[]){2}, 1, 4);
    w.instance[0].m[0][3] = 10;
    w.instance[1].mask = 0;
    w.instance[2].mesh = WORLD_NO_MESH;
    const float doubled[3][4] = {{0, -2, 0, 1}, {2, 0, 0, 2}, {0, 0, 0.5f, 3}};
    memcpy(w.instance[3].m, doubled, sizeof doubled);
    fixture_finish(&w);
    return w;
}

static void active_instances_are_placed_in_order(void **state)
{
    (void)state;
    struct world w = placed();
    struct scene scene;
    struct reason reason;
    assert_int_equal(world_bake(&w, 100, &scene, &reason), STATUS_OK);
    assert_int_equal(scene_check(&scene, &reason), STATUS_OK);
    assert_int_equal(scene.tri_count, 4);
    for (uint32_t i = 0; i < 2; i++)
        for (uint32_t prim = 0; prim < 2; prim++) {
            float from[3][3], at[3][3];
            scene_tri(w.mesh[0].scene, prim, from);
            scene_tri(&scene, 2 * i + prim, at);
            for (int c = 0; c < 3; c++) {
                const float x = from[c][0], y = from[c][1], z = from[c][2];
                const float first[3] = {x + 10, y, z};
                const float last[3] = {1 - 2 * y, 2 + 2 * x, 3 + z / 2};
                assert_memory_equal(at[c], i ? last : first, sizeof first);
            }
        }
    scene_free(&scene);
    world_free(&w);
}

/* Over `most`, whole instances are left out, evenly; never all. */
static void large_worlds_are_thinned_by_whole_instances(void **state)
{
    (void)state;
    static const uint32_t most[] = {0, 1, 5, 299, 300, 600, 1000, 2999, 3000};
    struct world w = fixture_world((const uint32_t[]){3}, 1, 1000);
    for (uint32_t i = 0; i < 1000; i++)
        w.instance[i].m[1][3] = (float)i;
    fixture_finish(&w);
    for (size_t k = 0; k < ARRAY_COUNT(most); k++) {
        struct scene scene;
        struct reason reason;
        assert_int_equal(world_bake(&w, most[k] ? most[k] : 1, &scene, &reason), STATUS_OK);
        uint32_t left = scene.tri_count / 3;
        assert_int_equal(scene.tri_count % 3, 0);
        assert_true(left >= 1);
        assert_true(scene.tri_count <= most[k] || left == 1);
        assert_true(4 * scene.tri_count >= most[k]);
        float step = left > 1 ? scene.vertex[3 * 9 + 1] - scene.vertex[1] : 0;
        for (uint32_t i = 0; i < left; i++) {
            assert_true(scene.vertex[27 * (size_t)i + 1] == (float)i * step);
            assert_int_equal(scene.index[9 * (size_t)i + 8], 9 * i + 8);
        }
        scene_free(&scene);
    }
    world_free(&w);
}

static void what_is_placed_beyond_float32_is_refused(void **state)
{
    (void)state;
    struct world w = placed();
    struct scene scene;
    struct reason reason;
    w.instance[3].m[0][1] = 0x1p127f;
    w.mesh[0].scene->vertex[3 * 5 + 1] = 2;
    assert_int_equal(world_bake(&w, 100, &scene, &reason), STATUS_LIMIT);
    assert_string_equal(reason.text, "instance 3: its vertex 5 is placed beyond float32");
    assert_null(scene.vertex);
    world_free(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(active_instances_are_placed_in_order),
        cmocka_unit_test(large_worlds_are_thinned_by_whole_instances),
        cmocka_unit_test(what_is_placed_beyond_float32_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
