/* A mesh placed many times: what world_crowd_of promises of sizes, places and numbers, and rays
 * that leave what is hit there. */
#include "bench/measure/bounce_rays.h"
#include "ref/world/world_boxes.h"
#include "scenes/scenes.h"
#include "scenes/worlds/crowd.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include <math.h>

enum { COUNT = 500 };

static struct scene mesh_of(const char *spec)
{
    struct scene mesh;
    assert_int_equal(scene_open(spec, 1, &mesh, NULL), STATUS_OK);
    return mesh;
}

/* By the exact boxes of a mesh that has all sides alike and stands far from its own origin. */
static void instances_have_their_size_place_and_number(void **state)
{
    (void)state;
    struct scene mesh = mesh_of("soup:n=200,offset=40");
    struct world world, again;
    struct box *box;
    double mean = 0, most[3] = {0}, least[3] = {0}, smallest = 1e9, largest = 0;
    assert_int_equal(world_crowd_of(&mesh, COUNT, 0.125, 7, &world, NULL), STATUS_OK);
    assert_int_equal(world_crowd_of(&mesh, COUNT, 0.125, 7, &again, NULL), STATUS_OK);
    assert_memory_equal(world.instance, again.instance, COUNT * sizeof *world.instance);
    assert_int_equal(world_boxes_make(&world, WORLD_BOXES_OF_VERTICES, &box, NULL), STATUS_OK);
    struct box own = scene_bounds(&mesh);
    for (uint32_t i = 0; i < COUNT; i++) {
        const struct instance *instance = &world.instance[i];
        double det = 0, side = 0;
        assert_int_equal(instance->custom, i);
        assert_int_equal(instance->mask, 0xFF);
        assert_int_equal(instance->flags, 0);
        for (int k = 0; k < 3; k++) {
            double row = 0, centre = (double)instance->m[k][3];
            for (int j = 0; j < 3; j++) {
                row += (double)instance->m[k][j] * (double)instance->m[k][j];
                centre += (double)instance->m[k][j] * ((double)own.lo[j] + (double)own.hi[j]) / 2;
            }
            det = fmax(det, row); /* of a turned and scaled cube all rows have its scale */
            side = fmax(side, (double)own.hi[k] - (double)own.lo[k]);
            assert_true(fabs(centre) < 1 + 1e-4);
            most[k] = fmax(most[k], centre);
            least[k] = fmin(least[k], centre);
            assert_true((double)box[i].lo[k] < centre && centre < (double)box[i].hi[k]);
        }
        double size = sqrt(det) * side / 0.125;
        smallest = fmin(smallest, size);
        largest = fmax(largest, size);
        mean += size / COUNT;
    }
    assert_true(smallest > 0.499 && smallest < 0.55 && largest > 1.45 && largest < 1.501);
    assert_true(fabs(mean - 1) < 0.05);
    for (int k = 0; k < 3; k++)
        assert_true(most[k] > 0.95 && least[k] < -0.95);
    free(box);
    world_free(&world);
    world_free(&again);
    assert_int_equal(mesh.tri_count, 200); /* borrowed */
    scene_free(&mesh);
}

static void what_has_no_size_is_refused(void **state)
{
    (void)state;
    static const char *const rule[] = {"a mesh of no size cannot be placed", "1048577 instances"};
    struct scene point = mesh_of("soup:n=1"), none = {.vertex = NULL};
    for (int i = 0; i < 9; i++)
        point.vertex[i] = 3;
    for (int i = 0; i < 3; i++) {
        struct world world;
        struct reason reason = {""};
        memset(&world, 0xAA, sizeof world);
        assert_int_equal(world_crowd_of(i == 1 ? &none : &point, i == 2 ? (1u << 20) + 1 : 5, 1, 1,
                                        &world, &reason),
                         i == 2 ? STATUS_LIMIT : STATUS_INPUT);
        assert_non_null(strstr(reason.text, rule[i / 2]));
        assert_null(world.instance);
        assert_null(world.mesh);
    }
    scene_free(&point);
}

/* Each ray begins a hair before its hit on the side it came from, and goes away from the triangle;
 * the mean of the cosines is 2/3, as of a cosine's distribution. */
static void bounces_leave_the_side_that_was_hit(void **state)
{
    (void)state;
    struct scene mesh = mesh_of("soup:n=64");
    struct world world;
    static struct ray ray[4 * COUNT], out[4 * COUNT], again[4 * COUNT];
    static struct hit hit[4 * COUNT];
    double cosines = 0;
    size_t hits = 0;
    assert_int_equal(world_crowd_of(&mesh, 20, 0.5, 3, &world, NULL), STATUS_OK);
    for (uint32_t i = 0; i < 4 * COUNT; i++) {
        ray[i] = (struct ray){
            .org = {0.1f, -3, 0.2f}, .dir = {0.01f * (float)(i % 7), 1, 0.1f}, .tmax = 10};
        hit[i] = (struct hit){.t = 2 + 0.001f * (float)i,
                              .prim = i % 4 == 1 ? ABI_NO_PRIM : i % (20 * 64)};
    }
    assert_int_equal(bounce_rays_make(&world, 2, 5, ray, hit, 4 * COUNT, out, NULL), STATUS_OK);
    assert_int_equal(bounce_rays_make(&world, 2, 5, ray, hit, 4 * COUNT, again, NULL), STATUS_OK);
    assert_memory_equal(out, again, sizeof out);
    for (uint32_t i = 0; i < 4 * COUNT; i++) {
        if (hit[i].prim == ABI_NO_PRIM)
            continue;
        const struct ray *to = &out[hits++];
        double lift[3], length = 0, along = 0, cosine = 0, size = 0, flat[2] = {0, 0};
        const struct instance *instance = &world.instance[hit[i].prim / 64];
        float v[3][3];
        scene_tri(&mesh, hit[i].prim % 64, v);
        for (int k = 0; k < 3; k++) {
            lift[k] = (double)to->org[k] -
                      ((double)ray[i].org[k] + (double)hit[i].t * (double)ray[i].dir[k]);
            length += lift[k] * lift[k];
            along += lift[k] * (double)ray[i].dir[k];
            cosine += lift[k] * (double)to->dir[k];
            size += (double)to->dir[k] * (double)to->dir[k];
            for (int e = 0; e < 2; e++)
                for (int j = 0; j < 3; j++)
                    flat[e] +=
                        lift[k] * (double)instance->m[k][j] * (double)(v[e + 1][j] - v[0][j]);
        }
        assert_true(fabs(sqrt(length) - 2e-4) < 2e-6);
        assert_true(along < 2e-6);
        assert_true(fabs(flat[0]) < 2e-6 && fabs(flat[1]) < 2e-6); /* along the normal */
        cosine /= sqrt(length * size);
        assert_true(cosine > -0.05 && to->tmin == 0 && isinf(to->tmax));
        cosines += cosine;
    }
    assert_int_equal(hits, 3 * COUNT);
    assert_true(fabs(cosines / (double)hits - 2.0 / 3) < 0.03);
    for (size_t i = hits; i < 4 * COUNT; i++)
        assert_memory_equal(&out[i], &out[i - hits], sizeof *out);
    for (uint32_t i = 0; i < 4 * COUNT; i++)
        hit[i].prim = ABI_NO_PRIM;
    assert_int_equal(bounce_rays_make(&world, 2, 5, ray, hit, 4 * COUNT, out, NULL), STATUS_INPUT);
    world_free(&world);
    scene_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(instances_have_their_size_place_and_number),
        cmocka_unit_test(what_has_no_size_is_refused),
        cmocka_unit_test(bounces_leave_the_side_that_was_hit),
    };
    return cmocka_run_group_tests_name("crowd", tests, NULL, NULL);
}
