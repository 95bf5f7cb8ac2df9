/* The numbers of a ray: what they count is what the traversal counts, on every layout and test;
 * depth, boxes around the hit and inflation against what was counted another way or by hand. */
#include "ref/look/around.h"
#include "ref/look/numbers.h"
#include "ref/packed/packed_walk.h"
#include "ref/base/rng.h"
#include "scenes/rays/rays.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/faults.h"
#include "tests/support/trace_fixture.h"

#include <math.h>

#define RAYS 300

static struct numbers *made(const struct subject *s, const char *box, const char *tri)
{
    struct numbers *numbers;
    struct reason reason = {""};
    if (numbers_make(s->scene, &s->bvh, &s->packed, box_test_find(box), tri_test_find(tri),
                     &numbers, &reason))
        fail_msg("%s", reason.text);
    return numbers;
}

/* --- counts ---------------------------------------------------------------------------------- */

/* One ray, and the sums over all of them. */
static void counts_as_the_traversal(const struct subject *s, const struct box_test *box,
                                    const struct tri_test *tri, const struct ray *ray, size_t count)
{
    struct numbers *numbers = made(s, box->name, tri->name);
    struct trace_counts all = {0, 0};
    uint64_t boxes = 0, tris = 0;
    for (size_t i = 0; i < count; i++) {
        struct ray_numbers got;
        struct hit hit;
        struct trace_counts one = {0, 0};
        enum status status = trace_ray(&(struct job){.scene = s->scene,
                                                     .packed = &s->packed,
                                                     .box = box,
                                                     .tri = tri,
                                                     .query = QUERY_CLOSEST},
                                       &ray[i], &hit, &one);
        (void)!trace_ray(&(struct job){.scene = s->scene,
                                       .packed = &s->packed,
                                       .box = box,
                                       .tri = tri,
                                       .query = QUERY_CLOSEST},
                         &ray[i], &hit, &all);
        numbers_of_ray(numbers, &ray[i], &got);
        assert_int_equal(got.finished, status == STATUS_OK);
        assert_memory_equal(&got.hit, &hit, sizeof hit);
        assert_int_equal(got.boxes, one.boxes);
        assert_int_equal(got.tris, one.tris);
        assert_true(got.depth <= s->packed.stack_need);
        boxes += got.boxes;
        tris += got.tris;
    }
    assert_int_equal(boxes, all.boxes);
    assert_int_equal(tris, all.tris);
    assert_true(boxes >= count); /* the root's */
    numbers_free(numbers);
}

static void every_layout_and_test_is_counted_as_it_is_traversed(void **state)
{
    (void)state;
    static const char *const specs[] = {"soup:n=300", "terrain:k=4", "platonic"};
    static struct ray ray[RAYS];
    size_t subjects = 0;
    for (size_t i = 0; i < ARRAY_COUNT(specs); i++) {
        struct scene scene = generated(specs[i]);
        assert_int_equal(ray_set_make(ray_set_find("mixed"), &scene, 5, RAYS, ray, NULL),
                         STATUS_OK);
        for (size_t b = 0; builders[b]; b++)
            for (size_t l = 0; layouts[l]; l++) {
                struct subject s =
                    subject_make(&scene, builders[b]->name, 4, SEED_EPS, layouts[l]->name);
                for (size_t x = 0; box_tests[x] && s.status == STATUS_OK; x++)
                    for (size_t t = 0; tri_tests[t]; t++)
                        counts_as_the_traversal(&s, box_tests[x], tri_tests[t], ray, RAYS);
                subjects += s.status == STATUS_OK;
                subject_free(&s);
            }
        scene_free(&scene);
    }
    assert_true(subjects >= 12);
}

/* Also where the traversal gives up: references that lead anywhere. */
static void a_broken_tree_is_counted_up_to_where_the_traversal_gives_up(void **state)
{
    (void)state;
    struct rng rng = rng_make(17, 0);
    struct scene scene = trees_grid(64);
    struct ray ray[20];
    size_t unfinished = 0;
    for (size_t i = 0; i < ARRAY_COUNT(ray); i++)
        ray[i] = (struct ray){{rng_range(&rng, 0, 16), 0.05f, -5}, 0, {0.001f, 0.002f, 1}, TMAX};
    for (int round = 0; round < 60; round++) {
        struct subject s = subject_of(&scene, trees_make(&scene, 2, TREES_BALANCED), "f32");
        for (uint32_t n = 0; n < s.packed.node_count; n++) {
            struct node_f32 node;
            memcpy(&node, s.packed.word + 8 * (size_t)n, sizeof node);
            node.lo[2] = -9; /* in every box of the way from the start on: none is passed over */
            if (node.count == 0 && rng_below(&rng, 4) == 0)
                node.first = rng_below(&rng, s.packed.node_count + 4);
            memcpy(s.packed.word + 8 * (size_t)n, &node, sizeof node);
        }
        struct numbers *numbers = made(&s, "robust", "mt");
        for (size_t i = 0; i < ARRAY_COUNT(ray); i++) {
            struct ray_numbers got;
            struct hit hit;
            struct trace_counts counts = {0, 0};
            enum status status = trace_ray(&(struct job){.scene = &scene,
                                                         .packed = &s.packed,
                                                         .box = box_test_find("robust"),
                                                         .tri = tri_test_find("mt"),
                                                         .query = QUERY_CLOSEST},
                                           &ray[i], &hit, &counts);
            numbers_of_ray(numbers, &ray[i], &got);
            assert_int_equal(got.finished, status == STATUS_OK);
            assert_memory_equal(&got.hit, &hit, sizeof hit);
            assert_int_equal(got.boxes, counts.boxes);
            assert_int_equal(got.tris, counts.tris);
            unfinished += !got.finished;
        }
        numbers_free(numbers);
        subject_free(&s);
    }
    assert_true(unfinished > 0);
    scene_free(&scene);
}

static void an_empty_tree_has_no_numbers(void **state)
{
    (void)state;
    struct scene scene;
    assert_int_equal(scene_make(0, 0, &scene), STATUS_OK);
    struct subject s = subject_make(&scene, "median", 4, SEED_EPS, "f32");
    struct numbers *numbers = made(&s, "robust", "mt");
    struct ray ray = {{0, 0, -5}, 0, {0, 0, 1}, TMAX};
    struct ray_numbers got;
    numbers_of_ray(numbers, &ray, &got);
    assert_true(got.finished);
    assert_int_equal(got.hit.prim, ABI_NO_PRIM);
    assert_int_equal(got.boxes + got.tris + got.depth + got.around + got.around_leaves, 0);
    assert_true(isnan(got.inflation));
    numbers_free(numbers);
    subject_free(&s);
    scene_free(&scene);
}

/* --- depth ----------------------------------------------------------------------------------- */

/* 2^levels copies of one triangle: at every level both children are hit, so that the first descent
 * fills the stack, and what follows fills it less and less. */
static void depth_is_the_most_and_not_the_last(void **state)
{
    (void)state;
    static const float v[3][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    struct ray ray = {{1, 1, -5}, 0, {0, 0, 1}, TMAX};
    for (uint32_t levels = 0; levels <= 6; levels++) {
        struct scene scene = trees_copies(1u << levels, v);
        struct subject s = subject_make(&scene, "median", 1, SEED_EPS, "rf16");
        struct numbers *numbers = made(&s, "robust", "mt");
        struct ray_numbers got;
        numbers_of_ray(numbers, &ray, &got);
        assert_int_equal(got.depth, levels);
        assert_int_equal(got.tris, 1u << levels);
        assert_int_equal(got.boxes, (2u << levels) - 1);
        numbers_free(numbers);
        subject_free(&s);
        scene_free(&scene);
    }
}

/* --- boxes around the hit ------------------------------------------------------------------- */

static bool lies_in(const struct box *box, const double p[3])
{
    bool in = true;
    for (int k = 0; k < 3; k++)
        in = in && (double)box->lo[k] <= p[k] && p[k] <= (double)box->hi[k];
    return in;
}

/* By looking at every node; all the boxes of a sound tree lie in their parents'. */
static void all_boxes(const struct packed *packed, const double p[3], uint32_t *boxes,
                      uint32_t *leaves)
{
    struct packed_walk walk;
    *boxes = *leaves = 0;
    assert_int_equal(packed_walk_make(packed, &walk), STATUS_OK);
    for (uint32_t i = 0; i < walk.visit_count; i++) {
        struct wide node;
        packed->layout->load(packed, walk.visit[i].ref, &node);
        bool in = lies_in(&walk.visit[i].box, p);
        *boxes += in;
        *leaves += in && node.child_count == 0;
    }
    packed_walk_free(&walk);
}

static void around_finds_every_box_of_a_sound_tree(void **state)
{
    (void)state;
    static const char *const specs[] = {"soup:n=400", "grid", "terrain:k=4"};
    struct rng rng = rng_make(5, 0);
    uint64_t found = 0;
    for (size_t i = 0; i < ARRAY_COUNT(specs); i++) {
        struct scene scene = generated(specs[i]);
        for (size_t l = 0; l < ARRAY_COUNT(repaired); l++) {
            struct subject s = subject_make(&scene, "median", 2, SEED_EPS, repaired[l]);
            struct around *around;
            assert_int_equal(around_make(&s.packed, &around), STATUS_OK);
            for (int n = 0; n < 200; n++) {
                /* A vertex: on the bounds of many boxes. */
                const float *vertex =
                    scene.vertex + 3 * (size_t)rng_below(&rng, scene.vertex_count);
                double p[3];
                for (int k = 0; k < 3; k++)
                    p[k] = (double)vertex[k] + (n % 2 ? 0.0 : 0x1p-4 * (double)(n % 7));
                uint32_t boxes, leaves, expected, expected_leaves;
                all_boxes(&s.packed, p, &expected, &expected_leaves);
                around_count(around, p, &boxes, &leaves);
                assert_int_equal(boxes, expected);
                assert_int_equal(leaves, expected_leaves);
                found += leaves;
            }
            around_free(around);
            subject_free(&s);
        }
        scene_free(&scene);
    }
    assert_true(found > 1000);
}

/* The point of a hit lies at least in the boxes above its own triangle, however flat they are. */
static void a_hit_lies_in_its_own_leaf(void **state)
{
    (void)state;
    static const char *const specs[] = {"grid:height=0", "terrain:k=5", "sphere:n=12"};
    static struct ray ray[2000];
    for (size_t i = 0; i < ARRAY_COUNT(specs); i++) {
        struct scene scene = generated(specs[i]);
        assert_int_equal(
            ray_set_make(ray_set_find("mixed"), &scene, 9, ARRAY_COUNT(ray), ray, NULL), STATUS_OK);
        for (size_t l = 0; l < ARRAY_COUNT(repaired); l++) {
            struct subject s = subject_make(&scene, "median", 4, SEED_EPS, repaired[l]);
            struct numbers *numbers = made(&s, "watertight", "woop");
            size_t hits = 0;
            for (size_t r = 0; r < ARRAY_COUNT(ray); r++) {
                struct ray_numbers got;
                numbers_of_ray(numbers, &ray[r], &got);
                if (got.hit.prim == ABI_NO_PRIM) {
                    assert_int_equal(got.around + got.around_leaves, 0);
                    continue;
                }
                hits++;
                assert_true(got.around_leaves >= 1);
                assert_true(got.around > got.around_leaves || s.bvh.node_count == 1);
            }
            assert_true(hits > 200);
            numbers_free(numbers);
            subject_free(&s);
        }
        scene_free(&scene);
    }
}

/* --- inflation ------------------------------------------------------------------------------- */

static void growth_is_a_ratio_of_areas_then_of_sides(void **state)
{
    (void)state;
    static const struct {
        struct box box, exact;
        double growth;
    } known[] = {
        {{{0, 0, 0}, {1, 1, 1}}, {{0, 0, 0}, {1, 1, 1}}, 1.0},
        {{{0, 0, 0}, {2, 2, 2}}, {{0, 0, 0}, {1, 1, 1}}, 4.0},
        {{{0, 0, 0}, {1, 1, 1}}, {{0, 0, 0}, {2, 2, 2}}, 0.25},
        {{{0, -0.5f, 0}, {1, 0.5f, 1}}, {{0, 0, 0}, {1, 0, 1}}, 3.0}, /* flat: 1 to 1 + 1 + 1 */
        {{{0, 0, 0}, {3, 0, 0}}, {{0, 0, 0}, {2, 0, 0}}, 1.5},        /* a line */
        {{{0, 0, 0}, {2, 1, 1}}, {{0, 0, 0}, {2, 0, 0}}, 2.0},        /* 4 to 2, not 5 to 0 */
        {{{2, 0, 0}, {1, 1, 1}}, {{0, 0, 0}, {1, 1, 1}}, 1.0 / 3.0},  /* inside out in x */
        {{{0, 0, 0}, {INFINITY, 1, 1}}, {{0, 0, 0}, {1, 1, 1}}, INFINITY},
        {{{0, 0, 0}, {INFINITY, 0, 0}}, {{0, 0, 0}, {1, 1, 1}}, INFINITY},
    };
    for (size_t i = 0; i < ARRAY_COUNT(known); i++)
        assert_true(box_growth(&known[i].box, &known[i].exact) == known[i].growth);
    const struct box point = {{1, 1, 1}, {1, 1, 1}}, cube = {{0, 0, 0}, {1, 1, 1}};
    const struct box beyond = {{INFINITY, 0, 0}, {INFINITY, 1, 1}}, empty = box_empty();
    assert_true(isnan(box_growth(&cube, &point)));
    assert_true(isnan(box_growth(&beyond, &cube)));
    assert_true(isnan(box_growth(&cube, &empty)));
}

/* float32 keeps the boxes of the median builder as they are, 16 bits never shrink one. */
static void only_quantisation_inflates(void **state)
{
    (void)state;
    static struct ray ray[RAYS];
    struct scene scene = generated("terrain:k=4");
    double worst = 1.0;
    assert_int_equal(ray_set_make(ray_set_find("primary"), &scene, 1, RAYS, ray, NULL), STATUS_OK);
    for (size_t l = 0; l < ARRAY_COUNT(repaired); l++) {
        struct subject s = subject_make(&scene, "median", 4, SEED_EPS, repaired[l]);
        struct numbers *numbers = made(&s, "robust", "mt");
        for (size_t i = 0; i < RAYS; i++) {
            struct ray_numbers got;
            numbers_of_ray(numbers, &ray[i], &got);
            assert_true(l == 0 ? got.inflation == 1.0 : got.inflation >= 1.0);
            worst = got.inflation > worst ? got.inflation : worst;
        }
        numbers_free(numbers);
        subject_free(&s);
    }
    assert_true(worst > 1.0);
    scene_free(&scene);
}

/* One triangle, its only box grown by hand: the mean is of what was tested. */
static void inflation_is_the_mean_over_the_boxes_tested(void **state)
{
    (void)state;
    struct scene scene = trees_grid(2); /* two boxes of 1/8 by 1/8, 1/8 apart */
    struct subject s = subject_of(&scene, trees_make(&scene, 1, TREES_BALANCED), "f32");
    struct numbers *numbers;
    float high = 0.25f; /* the first triangle's box twice as long: its area, too */
    struct node_f32 node;
    memcpy(&node, s.packed.word + 8, sizeof node);
    assert_int_equal(node.count, 1);
    node.hi[1] = high;
    memcpy(s.packed.word + 8, &node, sizeof node);
    numbers = made(&s, "robust", "mt");
    struct ray through = {{0.0625f, 0.03125f, -1}, 0, {0, 0, 1}, TMAX};
    struct ray beside = {{5, 5, -1}, 0, {0, 0, 1}, TMAX};
    struct ray_numbers got;
    numbers_of_ray(numbers, &through, &got);
    assert_int_equal(got.boxes, 3);
    assert_true(got.inflation == (1.0 + 2.0 + 1.0) / 3.0);
    numbers_of_ray(numbers, &beside, &got);
    assert_int_equal(got.boxes, 1);
    assert_true(got.inflation == 1.0);
    numbers_free(numbers);
    subject_free(&s);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_layout_and_test_is_counted_as_it_is_traversed),
        cmocka_unit_test(a_broken_tree_is_counted_up_to_where_the_traversal_gives_up),
        cmocka_unit_test(an_empty_tree_has_no_numbers),
        cmocka_unit_test(depth_is_the_most_and_not_the_last),
        cmocka_unit_test(around_finds_every_box_of_a_sound_tree),
        cmocka_unit_test(a_hit_lies_in_its_own_leaf),
        cmocka_unit_test(growth_is_a_ratio_of_areas_then_of_sides),
        cmocka_unit_test(only_quantisation_inflates),
        cmocka_unit_test(inflation_is_the_mean_over_the_boxes_tested),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
