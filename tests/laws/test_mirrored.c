/* What depends on magnitudes is the same for what is mirrored: every coordinate with the other
 * sign, every triangle the other way round. Where a sign is forgotten it is so on one side
 * alone. */
#define _POSIX_C_SOURCE 200809L /* open_memstream */
#include "ref/build/presplit.h"
#include "ref/build/room.h"
#include "ref/packed/packed_file.h"
#include "ref/packed/tree_file.h"
#include "ref/scene/quantise.h"
#include "ref/store.h"
#include "ref/tree/tree_quality.h"
#include "ref/two_level/braid.h"
#include "scenes/scenes.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/support/opened.h"

static void mirror(struct scene *scene)
{
    for (uint32_t i = 0; i < 3 * scene->vertex_count; i++)
        scene->vertex[i] = 0.0f - scene->vertex[i];
}

/* --- grids ------------------------------------------------------------------------------------ */

/* A coordinate that is too large is so on either side of every axis. */
static void grids_end_on_both_sides(void **state)
{
    (void)state;
    const float half = FLT_MAX / 2;
    const float sizes[] = {half / 4, nextafterf(half, 0), half, nextafterf(half, INFINITY),
                           FLT_MAX};
    struct scene scene = opened("soup:n=4", 2), out;
    struct quantised q;
    for (uint32_t n = 0; n < ARRAY_COUNT(sizes) * 2 * 3 * 2; n++) {
        const float size = sizes[n / 12];
        float *at = &scene.vertex[3 * 5 + n / 2 % 3], was = *at;
        *at = n % 2 ? -size : size;
        const enum status status =
            (n / 6 % 2 ? scene_quantise_even : scene_quantise)(&scene, 12, &out, &q, NULL);
        assert_int_equal(status, size > half ? STATUS_LIMIT : STATUS_OK);
        scene_free(&out);
        *at = was;
    }
    scene_free(&scene);
}

/* The numbers of an even grid have the same end below 0 as above. */
static void numbers_of_even_grids_end_on_both_sides(void **state)
{
    (void)state;
    for (int32_t more = -2; more <= 2; more++)
        for (uint32_t n = 0; n < 6; n++) {
            struct scene scene = opened("soup:n=4", 2);
            struct grid grid;
            for (uint32_t i = 0; i < 3 * scene.vertex_count; i++)
                scene.vertex[i] = (float)(i % 7 + 1);
            const float size = (float)(EVEN_MOST + more);
            scene.vertex[3 * 5 + n / 2] = n % 2 ? -size : size;
            assert_int_equal(grid_even_of_scene(&scene, &grid, NULL),
                             more > 0 ? STATUS_LIMIT : STATUS_OK);
            scene_free(&scene);
        }
}

/* --- trees ------------------------------------------------------------------------------------ */

static double cost_of(const struct builder *builder, const struct scene *scene)
{
    const struct build_options options = {.leaf = 2, .eps = BUILD_EPS_DEFAULT};
    struct bvh bvh;
    struct reason reason = {""};
    if (bvh_build(builder, scene, &options, &bvh, &reason))
        fail_msg("%s: %s", builder->name, reason.text);
    const double cost = tree_sah(&bvh);
    bvh_free(&bvh);
    return cost;
}

/* Scenes that lie on one side of 0, of ordinary size and up to the ends of float32. */
static void trees_cost_the_same(void **state)
{
    (void)state;
    static const float scale[] = {1, 0x1p120f, 0x1p-120f};
    for (size_t s = 0; s < ARRAY_COUNT(scale); s++) {
        struct scene scene = opened("soup:n=300", 2);
        for (uint32_t i = 0; i < 3 * scene.vertex_count; i++)
            scene.vertex[i] = (scene.vertex[i] + 3) * scale[s];
        double cost[2][32];
        for (int turn = 0; turn < 2; turn++, mirror(&scene))
            for (size_t b = 0; builders_all[b] && b < 32; b++)
                cost[turn][b] = cost_of(builders_all[b], &scene);
        for (size_t b = 0; builders_all[b] && b < 32; b++)
            if (!(cost[0][b] < 1.2 * cost[1][b] && cost[1][b] < 1.2 * cost[0][b]))
                fail_msg("%s, times %g: costs %g and, mirrored, %g", builders_all[b]->name,
                         (double)scale[s], cost[0][b], cost[1][b]);
        scene_free(&scene);
    }
}

/* Swaps two vertices of every triangle; six times, by turns, all their orders come. */
static void turn_round(struct scene *scene, uint32_t a)
{
    for (uint32_t i = 0; i < scene->tri_count; i++) {
        uint32_t *v = scene->index + 3 * (size_t)i, was = v[a];
        v[a] = v[a + 1];
        v[a + 1] = was;
    }
}

static void must_part_alike(const char *spec)
{
    const struct build_options options = {.leaf = 1, .eps = BUILD_EPS_DEFAULT, .presplit = 0.5f};
    struct scene scene = opened(spec, 2);
    struct part *part[2];
    uint32_t count[2];
    assert_int_equal(presplit_make(&scene, &options, 1, &part[0], &count[0], NULL), STATUS_OK);
    assert_true(count[0] > scene.tri_count);
    for (uint32_t turn = 0; turn < 6; turn++) {
        turn_round(&scene, turn % 2);
        assert_int_equal(presplit_make(&scene, &options, 1, &part[1], &count[1], NULL), STATUS_OK);
        assert_int_equal(count[0], count[1]);
        for (uint32_t i = 0; i < count[0]; i++)
            assert_int_equal(part[0][i].prim, part[1][i].prim);
        room_free(part[1]);
    }
    room_free(part[0]);
    scene_free(&scene);
}

/* Parts of triangles: in whatever order their vertices stand. */
static void parts_are_the_same_the_other_way_round(void **state)
{
    (void)state;
    must_part_alike("needles:n=200");
    must_part_alike("soup:n=200");
    must_part_alike("sphere:n=6");
}

/* A packed tree is read for its scene, and doubted or not, alike if both are mirrored. Triangles
 * are flat along an axis and far out: what layouts round is all the room that their boxes have. */
static void packed_trees_are_read_alike(void **state)
{
    (void)state;
    const struct build_options options = {.leaf = 2, .eps = BUILD_EPS_DEFAULT};
    size_t read = 0;
    for (size_t l = 0; layouts_all[l]; l++)
        for (uint32_t axis = 0; axis < 3; axis++) {
            struct scene scene = opened("soup:n=40", 2);
            enum status status[2];
            for (uint32_t i = 0; i < scene.vertex_count; i++)
                scene.vertex[3 * (size_t)i + axis] = 1000.3f + 0.0625f * (float)(i / 3 % 5);
            for (int turn = 0; turn < 2; turn++, mirror(&scene)) {
                struct bvh bvh;
                struct packed packed;
                struct tree_file file;
                char *bytes;
                size_t size;
                FILE *stream = open_memstream(&bytes, &size);
                assert_int_equal(builder_find("median")->build(&scene, &options, &bvh, NULL), 0);
                status[turn] = packed_make(layouts_all[l], &bvh, &scene, &packed, NULL);
                if (!status[turn])
                    packed_file_write(&packed, stream);
                assert_int_equal(fclose(stream), 0);
                if (!status[turn]) {
                    status[turn] = tree_file_read("f", bytes, size, &scene, &file, NULL);
                    packed_free(&packed);
                    tree_file_free(&file);
                    read += !status[turn];
                }
                free(bytes);
                bvh_free(&bvh);
            }
            if (status[0] != status[1])
                fail_msg("%s, axis %u: %s, mirrored %s", layouts_all[l]->name, axis,
                         status_text(status[0]), status_text(status[1]));
            scene_free(&scene);
        }
    assert_true(read > 60);
}

/* --- instances -------------------------------------------------------------------------------- */

/* What an opened instance needs, at all scales: the signs of its matrix and of where it lies are
 * nothing to it. */
static void instances_need_the_same(void **state)
{
    (void)state;
    struct scene scene = opened("sphere:n=3", 2);
    struct geometry geometry = {.count = scene.tri_count, .opaque = true};
    struct world_mesh mesh = {.scene = &scene, .geometry = &geometry, .geometry_count = 1};
    struct instance instance = {.mask = 255};
    struct world world = {
        .mesh = &mesh, .mesh_count = 1, .instance = &instance, .instance_count = 1};
    size_t opens = 0, whole = 0;
    for (int exponent = -45; exponent <= 45; exponent++)
        for (uint32_t n = 0; n < 64; n++) {
            const bool far_away = n & 8, uneven = n & 16, below = n & 32;
            float share[2], reach[2];
            bool may[2];
            for (int turn = 0; turn < 2; turn++) {
                struct box box;
                memset(instance.m, 0, sizeof instance.m);
                for (uint32_t k = 0; k < 3; k++) {
                    const float sign = turn && (n >> k & 1) ? -1.0f : 1.0f;
                    const float size = ldexpf(uneven ? 1.0f + (float)k : 1.0f, exponent);
                    const float at = far_away ? ldexpf(3, exponent + 3) : size / 4;
                    instance.m[k][k] = sign * size;
                    instance.m[k][3] = below && turn ? -at : at;
                    box.lo[k] = instance.m[k][3] - 2 * size;
                    box.hi[k] = instance.m[k][3] + 2 * size;
                }
                may[turn] = braid_needs(&world, 0, &box, &share[turn], &reach[turn]);
            }
            if (may[0] != may[1] || share[0] != share[1] || reach[0] != reach[1])
                fail_msg("2^%d, signs %u: %d %a %a and %d %a %a", exponent, n, may[0],
                         (double)share[0], (double)reach[0], may[1], (double)share[1],
                         (double)reach[1]);
            opens += may[0];
            whole += !may[0];
        }
    assert_true(opens > 1000 && whole > 100);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grids_end_on_both_sides),
        cmocka_unit_test(numbers_of_even_grids_end_on_both_sides),
        cmocka_unit_test(trees_cost_the_same),
        cmocka_unit_test(parts_are_the_same_the_other_way_round),
        cmocka_unit_test(packed_trees_are_read_alike),
        cmocka_unit_test(instances_need_the_same),
    };
    return cmocka_run_group_tests_name("mirrored", tests, NULL, NULL);
}
