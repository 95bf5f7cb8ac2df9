/* Worlds as scenes for pictures: which triangles they have, in which colours. */
#define _GNU_SOURCE /* mkdtemp */
#include "scenes/worlds/placed_scene.h"

#include "ref/world/world_boxes.h"
#include "scenes/worlds.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "tests/support/root.h"

static void a_scene_stays_what_it_is(void **state)
{
    (void)state;
    struct scene own, drawn;
    uint64_t placed = 7;
    assert_int_equal(scene_open("cornell", 1, &own, NULL), STATUS_OK);
    assert_int_equal(placed_scene_open("cornell", 1, &drawn, &placed, NULL), STATUS_OK);
    assert_int_equal(placed, 0);
    assert_int_equal(own.tri_count, drawn.tri_count);
    assert_memory_equal(own.vertex, drawn.vertex, 12 * (size_t)own.vertex_count);
    assert_memory_equal(own.material_of, drawn.material_of, 4 * (size_t)own.tri_count);
    assert_int_equal(own.material_count, drawn.material_count);
    scene_free(&own);
    scene_free(&drawn);
}

/* Every active instance is there, whole, in its colour, which its neighbours do not have. */
static void each_instance_has_one_colour(void **state)
{
    (void)state;
    struct scene drawn;
    struct world world;
    uint64_t placed;
    uint32_t tri = 0, before = UINT32_MAX;
    assert_int_equal(world_open("mixed", 1, &world, NULL), STATUS_OK);
    assert_int_equal(placed_scene_open("mixed", 1, &drawn, &placed, NULL), STATUS_OK);
    assert_int_equal(placed, drawn.tri_count);
    for (uint32_t i = 0; i < world.instance_count; i++) {
        if (!world_is_active(&world, i))
            continue;
        const struct scene *mesh = world_scene(&world, i);
        int32_t colour = drawn.material_of[tri];
        assert_true(i == 0 || before != i - 1 || drawn.material_of[tri - 1] != colour);
        for (uint32_t k = 0; k < mesh->tri_count; k++, tri++) {
            float placed_v[3][3], v[3][3];
            assert_int_equal(drawn.material_of[tri], colour);
            scene_tri(mesh, k, v);
            scene_tri(&drawn, tri, placed_v);
            for (int a = 0; a < 3; a++) {
                const float *m = world.instance[i].m[a];
                double at = (double)m[0] * (double)v[0][0] + (double)m[1] * (double)v[0][1] +
                            (double)m[2] * (double)v[0][2] + (double)m[3];
                assert_true((float)at == placed_v[0][a]);
            }
        }
        before = i;
    }
    assert_int_equal(tri, drawn.tri_count);
    assert_true(drawn.material_count >= 8);
    for (uint32_t a = 0; a < drawn.material_count; a++)
        for (uint32_t b = 0; b < a; b++)
            assert_true(memcmp(drawn.material[a].color, drawn.material[b].color, 12) != 0);
    world_free(&world);
    scene_free(&drawn);
}

static void of_large_worlds_a_part_is_drawn(void **state)
{
    (void)state;
    struct scene drawn;
    uint64_t placed;
    uint32_t seen[8] = {0};
    assert_int_equal(placed_scene_open("crowd:n=600000", 1, &drawn, &placed, NULL), STATUS_OK);
    assert_int_equal(placed, 12 * 600000);
    assert_true(drawn.tri_count <= PLACED_MOST && drawn.tri_count > PLACED_MOST / 3);
    for (uint32_t i = 0; i < drawn.tri_count; i += 12) {
        for (uint32_t k = 1; k < 12; k++)
            assert_int_equal(drawn.material_of[i + k], drawn.material_of[i]);
        seen[drawn.material_of[i]]++;
    }
    assert_true(seen[0] > 0 && seen[2] > 0);
    scene_free(&drawn);
}

static void nothing_to_be_seen_is_refused(void **state)
{
    (void)state;
    struct scene drawn;
    uint64_t placed;
    struct reason reason = {""};
    assert_int_equal(placed_scene_open("no-such.gltf", 1, &drawn, &placed, &reason), STATUS_INPUT);
    assert_null(drawn.vertex);
    assert_int_equal(placed_scene_open("crowd:n=0", 1, &drawn, &placed, &reason), STATUS_INPUT);
    assert_null(drawn.vertex);
}

/* What no ray meets is not drawn; where that is all of a world, there is no picture of it. */
static void only_what_rays_meet_is_drawn(void **state)
{
    (void)state;
    static const char *const instance[] = {"{\"mesh\": 0}", "{\"mesh\": 0, \"mask\": 0}",
                                           "{\"mesh\": null}"};
    char path[100], why[160];
    snprintf(path, sizeof path, "%s/w.json", root);
    for (int i = 0; i < 27; i++) {
        const int of[] = {i % 3, i / 3 % 3, i / 9};
        uint64_t placed, wanted = 0;
        struct scene drawn;
        struct reason reason = {""};
        FILE *file = fopen(path, "w");
        assert_non_null(file);
        for (int k = 0; k < 3; k++)
            wanted += of[k] == 0;
        fprintf(file,
                "{\"raydiff_world\": 1, \"meshes\": [{\"vertices\": [0, 0, 0, 1, 0, 0, 0, 1, 0], "
                "\"indices\": [0, 1, 2]}], \"instances\": [%s, %s, %s]}",
                instance[of[0]], instance[of[1]], instance[of[2]]);
        assert_int_equal(fclose(file), 0);
        enum status status = placed_scene_open(path, 1, &drawn, &placed, &reason);
        snprintf(why, sizeof why, "%s: a world in which nothing can be hit", path);
        assert_string_equal(reason.text, wanted ? "" : why);
        assert_int_equal(status, wanted ? STATUS_OK : STATUS_INPUT);
        assert_int_equal(placed, wanted);
        assert_int_equal(drawn.tri_count, wanted);
        scene_free(&drawn);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_scene_stays_what_it_is),
        cmocka_unit_test(each_instance_has_one_colour),
        cmocka_unit_test(of_large_worlds_a_part_is_drawn),
        cmocka_unit_test(nothing_to_be_seen_is_refused),
        cmocka_unit_test(only_what_rays_meet_is_drawn),
    };
    return cmocka_run_group_tests_name("placed_scene", tests, make_root, remove_root);
}
