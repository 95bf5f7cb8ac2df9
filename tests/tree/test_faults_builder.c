/* The faults of RTRS's builder, each from the input that shows it, and that builder median does
 * not have it. */
#include "ref/layout.h"
#include "ref/base/rng.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/faults.h"

#include <math.h>

/* How many of the rays that meet something are answered with another triangle, or with none. */
static uint32_t hits_lost(const struct subject *s, const char *box, const struct ray *ray,
                          uint32_t count, uint32_t *hits)
{
    uint32_t lost = 0;
    *hits = 0;
    for (uint32_t i = 0; i < count; i++) {
        struct hit expected;
        trace_brute(s->scene, tri_test_find("mt"), QUERY_CLOSEST, &ray[i], &expected);
        if (expected.prim == ABI_NO_PRIM)
            continue;
        ++*hits;
        lost += subject_hit(s, box, "mt", ray[i], NULL).t != expected.t;
    }
    return lost;
}

/* (c + c + c) / 3 in RTRS's arithmetic is above 31 of the heights 0.1, 0.2, .. 10.0: then no
 * centroid lies in any half of the flat box. */
static void f4_floors_at_31_of_100_heights_are_never_split(void **state)
{
    (void)state;
    uint32_t whole = 0;
    for (int i = 1; i <= 100; i++) {
        struct scene scene = flat(3, 1, (float)((double)i / 10));
        struct subject s = subject_make(&scene, "rtrs", SEED_LEAF, SEED_EPS, "f32");
        struct subject repaired = subject_repaired(&scene, "f32");
        whole += s.stats.node_count == 1;
        assert_true(s.stats.node_count == 1 || s.stats.largest_leaf <= SEED_LEAF);
        assert_true(repaired.stats.largest_leaf <= SEED_LEAF);
        subject_free(&repaired);
        subject_free(&s);
        scene_free(&scene);
    }
    assert_int_equal(whole, 31);
}

/* Does a triangle with these x go to the first child of a node from x = 0 to 2 middle? */
static bool goes_first(const float x[3], float middle)
{
    const float at[3][3] = {{x[0], x[1], x[2]}, {0, 0, 0}, {2 * middle, 2 * middle, 2 * middle}};
    struct scene scene = trees_grid(3);
    for (uint32_t i = 0; i < 27; i++)
        scene.vertex[i] = i % 3 == 0 ? at[i / 9][i % 9 / 3] : 0;
    struct subject s = subject_make(&scene, "rtrs", 1, 0, "f32");
    uint32_t first = s.bvh.node[s.bvh.node[0].snd].item_first;
    subject_free(&s);
    scene_free(&scene);
    return first == 2;
}

static void f4_a_centroid_is_the_rounded_sum_of_edge_middles(void **state)
{
    (void)state;
    struct rng rng = rng_make(4, 0);
    uint32_t otherwise = 0;
    for (int i = 0; i < 3000; i++) {
        float x[3];
        for (int k = 0; k < 3; k++)
            x[k] = 1 + 0.25f * rng_float(&rng);
        float ab = (x[0] + x[1]) * 0.5f, bc = (x[1] + x[2]) * 0.5f, ca = (x[2] + x[0]) * 0.5f;
        float centroid = ((ab + bc) + ca) * (1.0f / 3.0f);
        otherwise += centroid != (ab + (bc + ca)) * (1.0f / 3.0f);
        otherwise += centroid != ((ab + bc) + ca) / 3;
        assert_true(goes_first(x, centroid));
        assert_false(goes_first(x, nextafterf(centroid, 0)));
    }
    assert_true(otherwise > 300); /* the order of operations shows */
}

static void f4_a_floor_at_a_tenth_is_one_leaf_that_the_seed_cannot_pack(void **state)
{
    (void)state;
    struct scene scene = flat(3, 1, 0.1f);
    struct subject s = subject_make(&scene, "rtrs", SEED_LEAF, SEED_EPS, "rtrs_rf");
    assert_int_equal(s.stats.node_count, 1);
    assert_int_equal(s.bvh.node[0].item_count, 18);
    assert_refused(&s, "RTRS panics");
    static const float lo[3] = {2.994f, 0.1f, 2.994f}, hi[3] = {3, 0.1f, 3};
    for (int k = 0; k < 3; k++) {
        assert_true(fabsf(s.bvh.node[0].bounds.lo[k] - lo[k]) < 0.0005f);
        assert_true(s.bvh.node[0].bounds.hi[k] == hi[k]);
    }
    subject_free(&s);
    scene_free(&scene);

    scene = flat(2, 1, 0.1f); /* 8 triangles: one more way to panic, F6 */
    s = subject_make(&scene, "rtrs", SEED_LEAF, SEED_EPS, "rtrs_rf");
    assert_int_equal(s.bvh.node[0].item_count, 8);
    assert_refused(&s, "RTRS panics (fault F6,");
    subject_free(&s);
    scene_free(&scene);
}

static void f4_a_correct_box_test_loses_the_whole_floor(void **state)
{
    (void)state;
    struct scene scene = flat(3, 1, 0.1f);
    struct subject s = subject_make(&scene, "rtrs", SEED_LEAF, SEED_EPS, "f32");
    struct subject repaired = subject_repaired(&scene, "rf16");
    for (uint32_t prim = 0; prim < 18; prim++) {
        struct ray ray = ray_at_triangle(&scene, prim);
        ray.org[1] += 5; /* from above; the ray is in no triangle's plane */
        ray.dir[1] -= 5;
        assert_int_equal(subject_hit(&s, "rtrs", "mt", ray, NULL).prim, prim);
        assert_int_equal(subject_hit(&s, "robust", "mt", ray, NULL).prim, ABI_NO_PRIM);
        assert_int_equal(subject_hit(&repaired, "robust", "mt", ray, NULL).prim, prim);
    }
    subject_free(&repaired);
    subject_free(&s);
    scene_free(&scene);
}

static const float one[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

static void f5_five_copies_get_a_leaf_box_of_a_128th(void **state)
{
    (void)state;
    struct scene scene = trees_copies(5, one);
    struct subject s = subject_make(&scene, "rtrs", SEED_LEAF, SEED_EPS, "f32");
    struct subject repaired = subject_repaired(&scene, "rf16");
    static const float lo[3] = {0.328f, 0.328f, 0}, hi[3] = {0.336f, 0.336f, 0};
    assert_int_equal(s.bvh.node[0].item_count, 5);
    for (int k = 0; k < 3; k++) {
        assert_true(fabsf(s.bvh.node[0].bounds.lo[k] - lo[k]) < 0.0005f);
        assert_true(fabsf(s.bvh.node[0].bounds.hi[k] - hi[k]) < 0.0005f);
    }
    struct ray inside = {{0.332f, 0.332f, -5}, 0, {0, 0, 1}, 1000};
    struct ray beside = {{0.1f, 0.1f, -5}, 0, {0.001f, 0, 1}, 1000};
    assert_int_not_equal(subject_hit(&s, "robust", "mt", inside, NULL).prim, ABI_NO_PRIM);
    assert_int_equal(subject_hit(&s, "robust", "mt", beside, NULL).prim, ABI_NO_PRIM);
    assert_int_not_equal(subject_hit(&s, "rtrs", "mt", beside, NULL).prim, ABI_NO_PRIM); /* F1 */
    assert_int_not_equal(subject_hit(&repaired, "robust", "mt", beside, NULL).prim, ABI_NO_PRIM);
    subject_free(&repaired);
    subject_free(&s);
    scene_free(&scene);
}

/* Three triangles that are points at 0, and two at `size` along an axis. */
static struct scene points(int axis, float size)
{
    struct scene scene = trees_grid(5);
    for (uint32_t i = 0; i < 45; i++)
        scene.vertex[i] = i >= 27 && (int)(i % 3) == axis ? size : 0;
    return scene;
}

/* Whether five triangles, of which four fit, are one leaf. */
static bool is_a_leaf(const struct scene *scene, float eps)
{
    struct subject s = subject_make(scene, "rtrs", SEED_LEAF, eps, "f32");
    const bool leaf = s.stats.node_count == 1;
    assert_true(leaf || s.stats.node_count == 3);
    subject_free(&s);
    return leaf;
}

/* A leaf is what is shorter than eps / 2 along each axis, and nothing that is as long: neither a
 * box of triangles nor one that was cut by halves. */
static void f5_what_is_as_long_as_half_of_eps_is_split(void **state)
{
    (void)state;
    static const float sizes[] = {1, 0.3f, 12345, 0x1p-149f, 0x1p-126f, 1e30f};
    for (size_t i = 0; i < ARRAY_COUNT(sizes); i++)
        for (int axis = 0; axis < 3; axis++) {
            struct scene scene = points(axis, sizes[i]);
            assert_false(is_a_leaf(&scene, 2 * nextafterf(sizes[i], 0)));
            assert_false(is_a_leaf(&scene, 2 * sizes[i]));
            assert_true(is_a_leaf(&scene, 2 * nextafterf(sizes[i], INFINITY)));
            scene_free(&scene);
        }
    for (int power = 1; power < 12; power++) {
        struct scene scene = trees_copies(5, one);
        struct subject s = subject_make(&scene, "rtrs", SEED_LEAF, ldexpf(1, 1 - power), "f32");
        const struct box *box = &s.bvh.node[0].bounds;
        assert_int_equal(s.stats.node_count, 1);
        for (int k = 0; k < 2; k++)
            assert_true(box->hi[k] - box->lo[k] == ldexpf(1, -power - 1));
        subject_free(&s);
        scene_free(&scene);
    }
}

#define RANDOM_RAYS 20000

/* Cut inner boxes of RTRS's scene: 2 of 25 with leaves of 2, none with leaves of 4. */
static void f5_cut_inner_boxes_of_the_seeds_scene_lose_hits(void **state)
{
    (void)state;
    static struct ray ray[RANDOM_RAYS];
    struct scene scene = seed_scene();
    struct reason reason;
    uint32_t hits;
    assert_int_equal(ray_set_make(ray_set_find("random"), &scene, 1, RANDOM_RAYS, ray, &reason),
                     STATUS_OK);
    struct subject two = subject_make(&scene, "rtrs", 2, SEED_EPS, "f32");
    assert_int_equal(two.stats.node_count - two.stats.leaf_count, 25);
    assert_int_equal(two.stats.loose_count, 2);
    uint32_t lost = hits_lost(&two, "robust", ray, RANDOM_RAYS, &hits);
    assert_true(lost > hits / 20 && lost < hits / 5); /* RTRS's own study: 703 of 7349 */
    assert_int_equal(hits_lost(&two, "rtrs", ray, RANDOM_RAYS, &hits), 0); /* F1 hides it */
    struct subject four = subject_make(&scene, "rtrs", 4, SEED_EPS, "f32");
    assert_int_equal(four.stats.loose_count, 0);
    assert_int_equal(hits_lost(&four, "robust", ray, RANDOM_RAYS, &hits), 0);
    struct subject repaired = subject_make(&scene, "median", 2, SEED_EPS, "rf16");
    assert_int_equal(repaired.stats.loose_count, 0);
    assert_int_equal(hits_lost(&repaired, "robust", ray, RANDOM_RAYS, &hits), 0);
    subject_free(&repaired);
    subject_free(&four);
    subject_free(&two);
    scene_free(&scene);
}

/* Eight small triangles and one that reaches from x = 2 to 100 with its centroid at 35: the half
 * beyond 51 is cut off, then the node splits. */
static void f5_a_cut_box_that_splits_later_keeps_its_cut(void **state)
{
    (void)state;
    struct scene scene = trees_grid(9);
    scene.vertex[9 * 8 + 3] = 100;
    struct subject s = subject_make(&scene, "rtrs", SEED_LEAF, SEED_EPS, "f32");
    struct subject repaired = subject_repaired(&scene, "rf16");
    assert_int_equal(s.stats.loose_count, 1);
    assert_int_equal(repaired.stats.loose_count, 0);
    assert_true(s.bvh.node[0].item_count == 0 && s.bvh.node[0].bounds.hi[0] == 50);
    struct ray ray = {{60, 0.01f, -5}, 0, {0.001f, 0, 1}, 1000};
    assert_int_equal(subject_hit(&s, "rtrs", "mt", ray, NULL).prim, 8);
    assert_int_equal(subject_hit(&s, "robust", "mt", ray, NULL).prim, ABI_NO_PRIM);
    assert_int_equal(subject_hit(&repaired, "robust", "mt", ray, NULL).prim, 8);
    subject_free(&repaired);
    subject_free(&s);
    scene_free(&scene);
}

/* Returns whether builder rtrs ends on five copies of a right triangle; median always does, and its
 * tree is hit. */
static bool rtrs_ends(float at, float size, float eps)
{
    const float v[3][3] = {{at, at, 0}, {at + size, at, 0}, {at, at + size, 0}};
    struct scene scene = trees_copies(5, v);
    struct build_options options = {.leaf = SEED_LEAF, .eps = eps};
    struct bvh bvh;
    struct reason reason = {""};
    enum status status = builder_find("rtrs")->build(&scene, &options, &bvh, &reason);
    bvh_free(&bvh);
    if (status) {
        assert_int_equal(status, STATUS_LIMIT);
        assert_non_null(strstr(reason.text, "F19"));
    }
    struct subject repaired = subject_make(&scene, "median", SEED_LEAF, eps, "f32");
    struct ray ray = {{at + size / 4, at + size / 4, -5}, 0, {0, 0, 1}, 1000};
    bool has_area = v[1][0] > v[0][0]; /* at 1e7 nothing is left of 0.25 */
    bool hit = subject_hit(&repaired, "robust", "mt", ray, NULL).prim != ABI_NO_PRIM;
    assert_int_equal(hit, has_area);
    subject_free(&repaired);
    scene_free(&scene);
    return status == STATUS_OK;
}

static void f19_the_builder_never_ends(void **state)
{
    (void)state;
    assert_true(rtrs_ends(0, 1, SEED_EPS));
    assert_false(rtrs_ends(0, 1, 0));
    assert_false(rtrs_ends(0, 1, -1));
    assert_false(rtrs_ends(0, 1, NAN));
    assert_false(rtrs_ends(0, 0, 0)); /* a point is not shorter than nothing */
    assert_false(rtrs_ends(3, 0, -0.0f));
    assert_false(rtrs_ends(3, 0, 0x1p-149f)); /* whose half is 0 */
    assert_true(rtrs_ends(3, 0, 0x1p-148f));
    assert_true(rtrs_ends(1e5f, 0.25f, SEED_EPS));
    assert_false(rtrs_ends(1e6f, 0.25f, SEED_EPS));
    assert_true(rtrs_ends(1e7f, 0.25f, SEED_EPS));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(f4_floors_at_31_of_100_heights_are_never_split),
        cmocka_unit_test(f4_a_centroid_is_the_rounded_sum_of_edge_middles),
        cmocka_unit_test(f4_a_floor_at_a_tenth_is_one_leaf_that_the_seed_cannot_pack),
        cmocka_unit_test(f4_a_correct_box_test_loses_the_whole_floor),
        cmocka_unit_test(f5_five_copies_get_a_leaf_box_of_a_128th),
        cmocka_unit_test(f5_what_is_as_long_as_half_of_eps_is_split),
        cmocka_unit_test(f5_cut_inner_boxes_of_the_seeds_scene_lose_hits),
        cmocka_unit_test(f5_a_cut_box_that_splits_later_keeps_its_cut),
        cmocka_unit_test(f19_the_builder_never_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
