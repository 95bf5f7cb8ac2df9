/* RTRS's faults that a traversal can show, each explained from its rays alone. F1 and F38 make
 * every ray visit every node and F8 ends RTRS: no answer is wrong. F6 garbles slots that F7
 * does not read. F13 is the paper's, in no layout: tests/explain/test_explain_imitate.c. */
#include "ref/explain/explain.h"
#include "ref/base/rng.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/explain/explained.h"
#include "tests/support/faults.h"

#include <math.h>

/* Rays at triangles first .. last. Caller frees. */
static struct ray *rays_at(const struct scene *scene, uint32_t first, uint32_t last)
{
    struct ray *ray = calloc(last - first + 1, sizeof *ray);
    assert_non_null(ray);
    for (uint32_t prim = first; prim <= last; prim++)
        ray[prim - first] = ray_at_triangle(scene, prim);
    return ray;
}

/* All rays at triangles first .. last: what is wrong has this cause, at least `least` rays are. */
static void at_triangles(const struct subject *s, const struct bvh *meant, const char *box,
                         const char *tri, uint32_t first, uint32_t last, enum cause cause,
                         size_t least)
{
    struct suspect suspect = suspect_make(s->scene, meant, &s->packed, box, tri);
    struct ray *ray = rays_at(s->scene, first, last);
    assert_int_equal(s->status, STATUS_OK);
    assert_cause(&suspect, ray, last - first + 1, cause, least);
    free(ray);
    suspect_free(&suspect);
}

static void f2_items_are_numbered_one_off(void **state)
{
    (void)state;
    struct scene scene = trees_grid(300);
    struct subject s = subject_make(&scene, "rtrs", SEED_LEAF, SEED_EPS, "rtrs_rf");
    at_triangles(&s, &s.bvh, "robust", "mt", 0, 299, CAUSE_INDEX_SHIFTED, 60);
    at_triangles(&s, &s.bvh, "rtrs", "mt", 0, 299, CAUSE_INDEX_SHIFTED, 1);
    subject_free(&s);
    scene_free(&scene);
}

static void f2_the_papers_record_takes_triangle_0_for_empty(void **state)
{
    (void)state;
    struct scene scene = trees_grid(300);
    struct subject s = subject_make(&scene, "rtrs", SEED_LEAF, SEED_EPS, "rtrs_rf_paper");
    at_triangles(&s, &s.bvh, "robust", "mt", 0, 299, CAUSE_SENTINEL, 1);
    subject_free(&s);
    scene_free(&scene);
}

static void f3_a_leaf_tests_other_triangles_than_its_own(void **state)
{
    (void)state;
    struct scene scene = trees_grid(300);
    struct subject s = subject_make(&scene, "rtrs", 2, SEED_EPS, "rtrs_direct");
    struct suspect suspect = suspect_make(&scene, &s.bvh, &s.packed, "robust", "mt");
    struct ray *ray = rays_at(&scene, 0, 299);
    size_t causes[CAUSE_COUNT];
    count_causes(&suspect, ray, 300, causes);
    /* Slot 0 is the null triangle: that one reads as empty. Slots whose triangle is by chance one
     * less than their own cannot be told from F2. */
    assert_true(causes[CAUSE_WRONG_ITEM] > 270);
    assert_true(causes[CAUSE_SENTINEL] <= 1 && causes[CAUSE_INDEX_SHIFTED] <= 10);
    assert_int_equal(causes[CAUSE_WRONG_ITEM] + causes[CAUSE_SENTINEL] +
                         causes[CAUSE_INDEX_SHIFTED] + causes[CAUSE_NONE],
                     300);
    free(ray);
    suspect_free(&suspect);
    subject_free(&s);
    scene_free(&scene);
}

static void f4_a_floor_that_cannot_be_split_has_a_cut_box(void **state)
{
    (void)state;
    struct scene scene = flat(3, 1, 0.1f);
    struct subject s = subject_make(&scene, "rtrs", SEED_LEAF, SEED_EPS, "f32");
    assert_int_equal(s.stats.node_count, 1);
    at_triangles(&s, &s.bvh, "robust", "mt", 0, 17, CAUSE_CUT_BOX, 15);
    subject_free(&s);
    scene_free(&scene);
}

static void f5_boxes_are_cut(void **state)
{
    (void)state;
    static const float one[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    struct scene scene = trees_copies(5, one);
    struct subject s = subject_make(&scene, "rtrs", SEED_LEAF, SEED_EPS, "f32");
    struct suspect suspect = suspect_make(&scene, &s.bvh, &s.packed, "robust", "mt");
    struct ray ray = {{0.1f, 0.2f, -1}, 0, {0, 0, 1}, 1000};
    struct explanation out = explained(&suspect, &ray);
    assert_int_equal(out.cause, CAUSE_CUT_BOX);
    assert_int_equal(out.end, END_BOX);
    assert_int_equal(out.step[out.last].lo[0].fault, BOUND_CUT);
    assert_true(out.step[out.last].lo[0].float_steps < 0);
    explain_free(&out);
    suspect_free(&suspect);
    subject_free(&s);
    scene_free(&scene);
}

/* A leaf of eight with F2 made up for, as in test_faults_layout.c. */
static void f7_six_of_eight_slots_are_read(void **state)
{
    (void)state;
    struct scene few = trees_grid(32), scene = with_a_stranger(&few, false);
    struct bvh bvh = trees_make(&few, 6, TREES_BALANCED);
    struct bvh_node *parent = &bvh.node[bvh.node_count - 3];
    parent->fst = parent->snd = 0;
    parent->item_count = 8;
    bvh.node_count -= 2;
    for (uint32_t k = 0; k < 32; k++)
        bvh.prim[k] = (k + 8) % 32;
    trees_fit(&bvh, &few);
    struct bvh meant = bvh;
    meant.prim = calloc(32, sizeof *meant.prim);
    memcpy(meant.prim, bvh.prim, 32 * sizeof *meant.prim);
    compensate_f2(&bvh, &scene);
    struct subject s = subject_of(&scene, bvh, "rtrs_rf");
    at_triangles(&s, &meant, "robust", "mt", 0, 31, CAUSE_SLOT_NOT_READ, 2);
    at_triangles(&s, &meant, "rtrs", "mt", 0, 31, CAUSE_SLOT_NOT_READ, 2);
    free(meant.prim);
    subject_free(&s);
    scene_free(&scene);
    scene_free(&few);
}

static void f9_inner_nodes_read_as_leaves(void **state)
{
    (void)state;
    struct scene grid = flat(150, 2, 0), scene = with_a_stranger(&grid, false);
    struct subject s = subject_make(&grid, "rtrs", SEED_LEAF, SEED_EPS, "rtrs_rf");
    struct bvh meant = s.bvh;
    meant.prim = calloc(meant.prim_count, sizeof *meant.prim);
    memcpy(meant.prim, s.bvh.prim, meant.prim_count * sizeof *meant.prim);
    s.scene = &scene;
    compensate_f2(&s.bvh, &scene);
    subject_pack(&s, "rtrs_rf");
    struct suspect suspect = suspect_make(&grid, &meant, &s.packed, "robust", "mt");
    size_t wrong = 0;
    for (uint32_t prim = 0; prim < grid.tri_count; prim += 449) {
        struct ray ray = ray_at_triangle(&grid, prim);
        struct explanation out = explained(&suspect, &ray);
        wrong += out.cause != CAUSE_NONE;
        if (out.cause != CAUSE_NONE)
            assert_int_equal(out.cause, CAUSE_REFERENCE_TRUNCATED);
        explain_free(&out);
    }
    assert_true(wrong > 20 && wrong < 100);
    suspect_free(&suspect);
    free(meant.prim);
    subject_free(&s);
    scene_free(&scene);
    scene_free(&grid);
}

/* Items 65536 and 65537 are stored as 0 and 1; in the paper's first two slots 15 bits are kept. */
static void f10_items_are_cut_to_16_and_15_bits(void **state)
{
    (void)state;
    struct scene scene = trees_grid(65538);
    struct subject s = subject_of(&scene, trees_make(&scene, 6, TREES_BALANCED), "rtrs_rf");
    struct suspect suspect = suspect_make(&scene, &s.bvh, &s.packed, "rtrs", "mt");
    struct ray *ray = rays_at(&scene, 65535, 65537);
    assert_int_equal(cause_of(&suspect, &ray[0]), CAUSE_INDEX_SHIFTED);
    assert_int_equal(cause_of(&suspect, &ray[1]), CAUSE_INDEX_TRUNCATED);
    assert_int_equal(cause_of(&suspect, &ray[2]), CAUSE_INDEX_TRUNCATED);
    free(ray);
    suspect_free(&suspect);
    subject_free(&s);
    scene_free(&scene);

    scene = trees_grid(33000);
    s = subject_of(&scene, trees_make(&scene, 8, TREES_BALANCED), "rtrs_rf_paper");
    at_triangles(&s, &s.bvh, "robust", "mt", 32767, 32999, CAUSE_INDEX_TRUNCATED, 50);
    subject_free(&s);
    scene_free(&scene);
}

/* Rays aimed 1e-3 beside vertices, from 10 away. */
static void make_vertex_rays(const struct scene *scene, struct ray *ray, size_t count)
{
    struct rng rng = rng_make(11, 0);
    for (size_t i = 0; i < count; i++) {
        float v[3][3], org[3], length = 0;
        scene_tri(scene, 1 + rng_below(&rng, scene->tri_count - 2), v);
        uint32_t c = rng_below(&rng, 3);
        ray[i] = (struct ray){.tmax = 1000};
        for (int k = 0; k < 3; k++) {
            org[k] = rng_range(&rng, -1, 1);
            length += org[k] * org[k];
        }
        for (int k = 0; k < 3; k++) {
            float target =
                0.998f * v[c][k] + 0.001f * v[(c + 1) % 3][k] + 0.001f * v[(c + 2) % 3][k];
            ray[i].org[k] = 10 * org[k] / sqrtf(length);
            ray[i].dir[k] = target - ray[i].org[k];
        }
    }
}

#define VERTEX_RAYS 4000

static void f11_bounds_are_rounded_to_nearest(void **state)
{
    (void)state;
    static struct ray ray[VERTEX_RAYS];
    const double values[GENERATOR_PARAMS] = {8, 1};
    struct scene inside;
    assert_int_equal(generator_make(generator_find("sphere"), values, 1, &inside, NULL), STATUS_OK);
    struct scene scene = with_a_stranger(&inside, true);
    struct subject s = subject_make(&scene, "median", SEED_LEAF, SEED_EPS, "rtrs_rf_paper");
    struct suspect suspect = suspect_make(&scene, &s.bvh, &s.packed, "robust", "mt");
    make_vertex_rays(&scene, ray, VERTEX_RAYS);
    assert_cause(&suspect, ray, VERTEX_RAYS, CAUSE_ROUNDED_INWARD, 10);
    for (size_t i = 0, told = 0; i < VERTEX_RAYS && told < 5; i++) {
        struct explanation out = explained(&suspect, &ray[i]);
        if (out.cause != CAUSE_NONE) {
            double least = 0;
            assert_int_equal(out.end, END_BOX);
            for (int k = 0; k < 3; k++) {
                least = fmin(least, out.step[out.last].lo[k].half_steps);
                least = fmin(least, out.step[out.last].hi[k].half_steps);
            }
            assert_true(least < 0 && least >= -0.5); /* nearest: half a step at most */
            told++;
        }
        explain_free(&out);
    }
    suspect_free(&suspect);
    subject_pack(&s, "rf16"); /* the very same tree */
    suspect = suspect_make(&scene, &s.bvh, &s.packed, "robust", "mt");
    assert_cause(&suspect, ray, VERTEX_RAYS, CAUSE_NONE, 0);
    suspect_free(&suspect);
    subject_free(&s);
    scene_free(&scene);
    scene_free(&inside);
}

static void f12_bounds_overflow_from_65520_on(void **state)
{
    (void)state;
    const float v[3][3] = {{65520, -1, -1}, {65524, 1, -1}, {65522, 0, 1}};
    struct scene scene = trees_copies(2, v);
    struct subject s = subject_make(&scene, "rtrs", SEED_LEAF, SEED_EPS, "rtrs_rf");
    struct suspect suspect = suspect_make(&scene, &s.bvh, &s.packed, "rtrs", "mt");
    struct ray ray = {{65000, 0, 0}, 0.01f, {1, 0, 0}, 1000};
    struct explanation out = explained(&suspect, &ray);
    assert_int_equal(out.cause, CAUSE_HALF_OVERFLOW);
    assert_int_equal(out.step[out.last].lo[0].fault, BOUND_OVERFLOW);
    explain_free(&out);
    suspect_free(&suspect);
    subject_free(&s);
    scene_free(&scene);
}

static void f14_boxes_flat_in_x_beyond_64_need_a_closed_comparison(void **state)
{
    (void)state;
    static const float far_wall[3][3] = {{-100, -50, -50}, {-100, 50, -50}, {-100, 0, 50}};
    struct scene scene = trees_copies(2, far_wall);
    struct subject s = subject_make(&scene, "rtrs", SEED_LEAF, SEED_EPS, "f32");
    struct suspect suspect = suspect_make(&scene, &s.bvh, &s.packed, "rtrs", "mt");
    struct ray ray[41];
    for (int y = 0; y < 41; y++)
        ray[y] = (struct ray){{0, 0, 0}, 0.01f, {-1, 0.02f * (float)(y - 20), 0.01f}, 1000};
    assert_cause(&suspect, ray, 41, CAUSE_STRICT_COMPARISON, 20);
    suspect.box = "robust";
    assert_cause(&suspect, ray, 41, CAUSE_NONE, 0);
    suspect_free(&suspect);
    subject_free(&s);
    scene_free(&scene);
}

/* Beyond 64 the widening vanishes, so that a ray in the face of a box divides 0 by 0. */
static void f15_a_direction_of_0_divides_by_zero(void **state)
{
    (void)state;
    static const float v[3][3] = {{100, -1, -1}, {100, 1, -1}, {103, 0, 2}};
    struct scene scene = trees_copies(1, v);
    struct subject s = subject_make(&scene, "median", SEED_LEAF, SEED_EPS, "f32");
    struct suspect suspect = suspect_make(&scene, &s.bvh, &s.packed, "rtrs", "mt");
    const struct ray ray = {{100, 0, -5}, 0, {0, 0, 1}, 1000};
    assert_int_equal(cause_of(&suspect, &ray), CAUSE_PARALLEL_AXIS);
    suspect.box = "robust";
    assert_int_equal(cause_of(&suspect, &ray), CAUSE_NONE);
    suspect_free(&suspect);
    subject_free(&s);
    scene_free(&scene);
}

static void f16_small_triangles_are_under_the_threshold(void **state)
{
    (void)state;
    static const float v[3][3] = {{0, 0, 0}, {3e-4f, 0, 0}, {0, 3e-4f, 0}};
    struct scene scene = trees_copies(1, v);
    struct subject s = subject_make(&scene, "median", SEED_LEAF, SEED_EPS, "f32");
    struct suspect suspect = suspect_make(&scene, &s.bvh, &s.packed, "robust", "mt_rtrs");
    const struct ray ray = {{1e-4f, 1e-4f, -1}, 0, {0, 0, 1}, 1000};
    struct explanation out = explained(&suspect, &ray);
    assert_int_equal(out.cause, CAUSE_DETERMINANT_THRESHOLD);
    assert_int_equal(out.end, END_TRIANGLE);
    explain_free(&out);
    suspect.tri = "mt";
    out = explained(&suspect, &ray);
    assert_int_equal(out.cause, CAUSE_NONE);
    assert_int_equal(out.end, END_HIT);
    explain_free(&out);
    suspect_free(&suspect);
    subject_free(&s);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(f2_items_are_numbered_one_off),
        cmocka_unit_test(f2_the_papers_record_takes_triangle_0_for_empty),
        cmocka_unit_test(f3_a_leaf_tests_other_triangles_than_its_own),
        cmocka_unit_test(f4_a_floor_that_cannot_be_split_has_a_cut_box),
        cmocka_unit_test(f5_boxes_are_cut),
        cmocka_unit_test(f7_six_of_eight_slots_are_read),
        cmocka_unit_test(f9_inner_nodes_read_as_leaves),
        cmocka_unit_test(f10_items_are_cut_to_16_and_15_bits),
        cmocka_unit_test(f11_bounds_are_rounded_to_nearest),
        cmocka_unit_test(f12_bounds_overflow_from_65520_on),
        cmocka_unit_test(f14_boxes_flat_in_x_beyond_64_need_a_closed_comparison),
        cmocka_unit_test(f15_a_direction_of_0_divides_by_zero),
        cmocka_unit_test(f16_small_triangles_are_under_the_threshold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
