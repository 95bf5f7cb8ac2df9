/* The faults of RTRS's box test and triangle test, each from the input that shows it, and that
 * the repaired member does not have it. The builder's: test_faults_builder.c; the layouts':
 * test_faults_layout.c and test_faults_bits.c. */
#include "ref/layout.h"
#include "ref/base/rng.h"
#include "scenes/scenes.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/faults.h"
#include "ref/primitives/test_run.h"

#include <math.h>

static bool box_accepts(const char *box_test, struct ray ray, struct box box)
{
    struct slab_ray r = slab_ray_make(&ray);
    float entry;
    return box_test_run(box_test_find(box_test)->id, &r, &box, ray.tmax, &entry);
}

static const struct ray far_up = {{0, 100, 0}, 0.01f, {0.8f, 0.6f, 0}, 1000};

static void f1_y_and_z_take_no_part_in_the_box_test(void **state)
{
    (void)state;
    const struct box unit = {{1, 1, 1}, {2, 2, 2}};
    assert_true(box_accepts("rtrs", far_up, unit));
    assert_false(box_accepts("robust", far_up, unit));
    struct rng rng = rng_make(1, 0);
    for (int i = 0; i < 1000; i++) {
        struct ray ray = {.tmax = 1000};
        for (int k = 0; k < 3; k++) {
            ray.org[k] = rng_range(&rng, -60, 60);
            ray.dir[k] = rng_range(&rng, -1, 1);
        }
        if (ray.dir[0] != 0)
            assert_true(box_accepts("rtrs", ray, unit));
    }
}

static void f1_every_ray_visits_every_node(void **state)
{
    (void)state;
    static const char *const seeds[] = {"rtrs_direct", "rtrs_rf", "rtrs_rf_paper"};
    struct scene scene = trees_grid(300);
    for (size_t i = 0; i < ARRAY_COUNT(seeds); i++) {
        struct subject s = subject_make(&scene, "rtrs", SEED_LEAF, SEED_EPS, seeds[i]);
        struct trace_counts counts = {0, 0};
        struct hit hit = subject_hit(&s, "rtrs", "mt_rtrs", far_up, &counts);
        assert_int_equal(hit.prim, ABI_NO_PRIM);
        assert_int_equal(counts.boxes, s.stats.node_count);
        assert_int_equal(counts.tris, 299); /* all but one: F2 */
        subject_free(&s);
    }
    struct subject s = subject_repaired(&scene, "rf16");
    struct trace_counts counts = {0, 0};
    subject_hit(&s, "robust", "mt", far_up, &counts);
    assert_int_equal(counts.boxes, 1);
    assert_int_equal(counts.tris, 0);
    subject_free(&s);
    scene_free(&scene);
}

static void f1_a_ray_in_the_seeds_scene_costs_27_boxes_and_39_triangles(void **state)
{
    (void)state;
    struct scene scene = seed_scene();
    struct subject s = subject_make(&scene, "rtrs", SEED_LEAF, SEED_EPS, "rtrs_rf");
    struct trace_counts counts = {0, 0};
    subject_hit(&s, "rtrs", "mt_rtrs", far_up, &counts);
    assert_int_equal(counts.boxes, 27);
    assert_int_equal(counts.tris, 39);
    subject_free(&s);
    scene_free(&scene);
}

static void f14_walls_in_x_farther_than_64_are_never_entered(void **state)
{
    (void)state;
    static const float far_wall[3][3] = {{-100, -50, -50}, {-100, 50, -50}, {-100, 0, 50}};
    struct scene scene = trees_copies(2, far_wall);
    struct subject s = subject_make(&scene, "rtrs", SEED_LEAF, SEED_EPS, "f32");
    uint32_t robust_hits = 0;
    for (int y = -20; y <= 20; y++)
        for (int z = -20; z <= 20; z++) {
            struct ray ray = {{0, 0, 0}, 0.01f, {-1, 0.02f * (float)y, 0.02f * (float)z}, 1000};
            struct hit expected;
            trace_brute(&scene, tri_test_find("mt_rtrs"), QUERY_CLOSEST, &ray, &expected);
            struct hit robust = subject_hit(&s, "robust", "mt_rtrs", ray, NULL);
            assert_int_equal(subject_hit(&s, "rtrs", "mt_rtrs", ray, NULL).prim, ABI_NO_PRIM);
            assert_memory_equal(&robust, &expected, sizeof expected);
            robust_hits += robust.prim != ABI_NO_PRIM;
        }
    assert_true(robust_hits > 500);
    subject_free(&s);
    scene_free(&scene);

    const struct ray along = {{0, 0, 0}, 0, {-1, 0.3f, -0.2f}, 1000};
    static const float reach[] = {1, 63, 64};
    for (size_t i = 0; i < ARRAY_COUNT(reach); i++)
        assert_true(box_accepts("rtrs", along, (struct box){{-reach[i], 0, 0}, {-reach[i], 9, 9}}));
    float beyond = -nextafterf(64, 65);
    assert_false(box_accepts("rtrs", along, (struct box){{beyond, 0, -99}, {beyond, 99, 0}}));
    assert_true(box_accepts("robust", along, (struct box){{beyond, 0, -99}, {beyond, 99, 0}}));
}

/* The only rays that the published test culls. */
static void f15_only_rays_across_x_are_culled(void **state)
{
    (void)state;
    const struct box box = {{1, 1, 1}, {2, 2, 2}};
    for (int sign = -1; sign <= 1; sign += 2) {
        float zero = sign < 0 ? -0.0f : 0.0f;
        struct ray beside = {{0, 1.5f, -5}, 0, {zero, 0, 1}, 1000};
        struct ray through = {{1.5f, 1.5f, -5}, 0, {zero, 0, 1}, 1000};
        struct ray above = {{1.5f, 7, -5}, 0, {zero, 0, 1}, 1000};
        assert_false(box_accepts("rtrs", beside, box));
        assert_true(box_accepts("rtrs", through, box));
        assert_true(box_accepts("rtrs", above, box)); /* F1 */
        assert_false(box_accepts("robust", beside, box));
        assert_true(box_accepts("robust", through, box));
        assert_false(box_accepts("robust", above, box));
        for (int k = 1; k < 3; k++) { /* a zero in y or z culls nothing */
            struct ray other = {{0, 7, 7}, 0, {1, 1, 1}, 1000};
            other.dir[k] = zero;
            assert_true(box_accepts("rtrs", other, box));
            assert_false(box_accepts("robust", other, box));
        }
    }
}

/* 0 / 0 where the origin lies on the widened face: a NaN, and with `a < b ? a : b` a miss, though
 * the same ray is accepted a little farther in and on the unwidened face. */
static void f15_a_ray_in_the_widened_face_gives_nan(void **state)
{
    (void)state;
    const struct box box = {{0, 0, 0}, {2, 2, 2}};
    struct ray ray = {{-SLAB_RTRS_EPS, 1, -5}, 0, {0, 0, 1}, 1000};
    assert_true(isnan((box.lo[0] - SLAB_RTRS_EPS - ray.org[0]) / ray.dir[0]));
    assert_false(box_accepts("rtrs", ray, box));
    ray.org[0] = -0.5f * SLAB_RTRS_EPS;
    assert_true(box_accepts("rtrs", ray, box));
    ray.org[0] = 2 + SLAB_RTRS_EPS;
    assert_false(box_accepts("rtrs", ray, box));
    static const float face[] = {0, -0.0f, 2};
    for (size_t i = 0; i < ARRAY_COUNT(face); i++) {
        ray.org[0] = face[i];
        assert_true(box_accepts("rtrs", ray, box));
        assert_true(box_accepts("robust", ray, box));
    }
}

static void f16_a_triangle_of_3e_4_is_never_hit(void **state)
{
    (void)state;
    const float tiny[3][3] = {{0, 0, 0}, {3e-4f, 0, 0}, {0, 3e-4f, 0}};
    const float small[3][3] = {{0, 0, 0}, {4e-4f, 0, 0}, {0, 4e-4f, 0}};
    struct scene scene = trees_copies(1, tiny), larger = trees_copies(1, small);
    struct rng rng = rng_make(16, 0);
    uint32_t slanted = 0;
    for (int i = 0; i < 2000; i++) {
        float d[3] = {rng_range(&rng, -1, 1), rng_range(&rng, -1, 1), rng_range(&rng, 0.1f, 1)};
        if (i == 0)
            d[0] = d[1] = 0; /* head-on */
        float length = sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        struct ray ray = {.tmax = 1000};
        for (int k = 0; k < 3; k++) {
            ray.dir[k] = d[k] / length;
            ray.org[k] = (k < 2 ? 1e-4f : 0) - ray.dir[k];
        }
        struct hit hit;
        trace_brute(&scene, tri_test_find("mt_rtrs"), QUERY_CLOSEST, &ray, &hit);
        assert_int_equal(hit.prim, ABI_NO_PRIM);
        trace_brute(&scene, tri_test_find("mt"), QUERY_CLOSEST, &ray, &hit);
        assert_int_equal(hit.prim, 0);
        trace_brute(&scene, tri_test_find("woop"), QUERY_CLOSEST, &ray, &hit);
        assert_int_equal(hit.prim, 0);
        trace_brute(&larger, tri_test_find("mt_rtrs"), QUERY_CLOSEST, &ray, &hit);
        if (i == 0)
            assert_int_equal(hit.prim, 0);
        slanted += hit.prim == ABI_NO_PRIM;
    }
    assert_true(slanted > 500); /* 1.6e-7 |cos| <= 1e-7 */
    scene_free(&scene);
    scene_free(&larger);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(f1_y_and_z_take_no_part_in_the_box_test),
        cmocka_unit_test(f1_every_ray_visits_every_node),
        cmocka_unit_test(f1_a_ray_in_the_seeds_scene_costs_27_boxes_and_39_triangles),
        cmocka_unit_test(f14_walls_in_x_farther_than_64_are_never_entered),
        cmocka_unit_test(f15_only_rays_across_x_are_culled),
        cmocka_unit_test(f15_a_ray_in_the_widened_face_gives_nan),
        cmocka_unit_test(f16_a_triangle_of_3e_4_is_never_hit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
