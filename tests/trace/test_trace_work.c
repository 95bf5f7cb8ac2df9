/* Laws of ref/trace/trace.h: how little a ray visits, what the stack must hold, and that no words
 * make it hang. */
#include "ref/base/rng.h"
#include "ref/trace/trace.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/trace_fixture.h"

#define RAYS 2000

/* --- work ------------------------------------------------------------------------------------ */

/* Boxes and triangles per ray of a set, with closest hits. */
static struct trace_counts work(const struct packed *packed, const struct scene *scene,
                                const char *set)
{
    static struct ray ray[RAYS];
    struct trace_counts counts = {0, 0};
    assert_int_equal(ray_set_make(ray_set_find(set), scene, 1, RAYS, ray, NULL), STATUS_OK);
    for (uint32_t i = 0; i < RAYS; i++)
        closest(packed, scene, &ray[i], &counts);
    return (struct trace_counts){counts.boxes / RAYS, counts.tris / RAYS};
}

/* Where a box test lets everything through, answers stay right: only the work shows it. Rays along
 * axes, with zeros of both signs, must not cost more. */
static void a_ray_visits_a_small_part_of_the_nodes(void **state)
{
    (void)state;
    static const char *const sets[] = {"random", "primary", "axis", "vertices"};
    static const struct {
        const char *scene;
        uint32_t boxes, tris;
    } budget[] = {{"grid:n=100", 150, 20}, {"sphere:n=40", 150, 20}, {"soup:n=10000", 400, 60}};
    for (size_t s = 0; s < ARRAY_COUNT(budget); s++) {
        struct scene scene = generated(budget[s].scene);
        struct bvh bvh = median(&scene, 4);
        for (size_t l = 0; l < ARRAY_COUNT(repaired); l++) {
            struct packed packed = pack(repaired[l], &bvh, &scene);
            for (size_t r = 0; r < ARRAY_COUNT(sets); r++) {
                struct trace_counts counts = work(&packed, &scene, sets[r]);
                if (counts.boxes > budget[s].boxes || counts.tris > budget[s].tris)
                    fail_msg("%s %s %s: %llu boxes, %llu triangles of %u", budget[s].scene,
                             repaired[l], sets[r], (unsigned long long)counts.boxes,
                             (unsigned long long)counts.tris, scene.tri_count);
            }
            packed_free(&packed);
        }
        bvh_free(&bvh);
        scene_free(&scene);
    }
}

/* A stack of walls across the ray: once the first is hit, no box behind it is entered. */
static void what_lies_behind_the_best_hit_is_not_tested(void **state)
{
    (void)state;
    struct scene scene = trees_grid(256);
    for (uint32_t i = 0; i < 256; i++)
        for (uint32_t c = 0; c < 3; c++) {
            float *p = scene.vertex + 9 * (size_t)i + 3 * (size_t)c;
            p[0] = c == 1 ? 4 : 0;
            p[1] = c == 2 ? 4 : 0;
            p[2] = (float)i;
        }
    struct bvh bvh = median(&scene, 1);
    struct packed packed = pack("f32", &bvh, &scene);
    for (int up = 0; up < 2; up++) {
        struct ray ray = {{1, 1, up ? -1 : 256}, 0, {0, 0, up ? 1 : -1}, TMAX};
        struct trace_counts counts = {0, 0};
        assert_int_equal(closest(&packed, &scene, &ray, &counts).prim, up ? 0 : 255);
        assert_int_equal(counts.tris, 1);
        assert_int_equal(counts.boxes, 1 + 2 * 8);
    }
    packed_free(&packed);
    bvh_free(&bvh);
    scene_free(&scene);
}

static void an_any_hit_stops_at_the_first_triangle(void **state)
{
    (void)state;
    static const float v[3][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    struct scene scene = trees_copies(64, v);
    struct bvh bvh = median(&scene, 4);
    struct packed packed = pack("rf16", &bvh, &scene);
    struct ray ray = {{1, 1, -5}, 0, {0, 0, 1}, TMAX};
    struct trace_counts counts = {0, 0};
    struct hit hit;
    assert_int_equal(trace_ray(&(struct job){.scene = &scene,
                                             .packed = &packed,
                                             .box = box_tests[0],
                                             .tri = tri_tests[0],
                                             .query = QUERY_ANY},
                               &ray, &hit, &counts),
                     STATUS_OK);
    assert_int_not_equal(hit.prim, ABI_NO_PRIM);
    assert_int_equal(counts.tris, 1);
    closest(&packed, &scene, &ray, &counts);
    assert_int_equal(counts.tris, 1 + 64); /* all at equal t */
    packed_free(&packed);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* --- stack ----------------------------------------------------------------------------------- */

/* 2^levels copies of one triangle: at every level both children are hit. */
static void exactly_stack_need_entries_are_enough(void **state)
{
    (void)state;
    static const float v[3][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    struct ray ray = {{1, 1, -5}, 0, {0, 0, 1}, TMAX};
    for (uint32_t levels = 0; levels <= 10; levels++) {
        struct scene scene = trees_copies(1u << levels, v);
        struct bvh bvh = median(&scene, 1);
        for (size_t l = 0; l < ARRAY_COUNT(repaired); l++) {
            struct packed packed = pack(repaired[l], &bvh, &scene);
            struct trace_counts counts = {0, 0};
            assert_int_equal(packed.stack_need, levels);
            assert_int_equal(closest(&packed, &scene, &ray, &counts).prim, 0);
            assert_int_equal(counts.tris, 1u << levels);
            if (levels > 0) {
                struct hit hit = {1, 1, 1, 1};
                packed.stack_need--;
                assert_int_equal(trace_ray(&(struct job){.scene = &scene,
                                                         .packed = &packed,
                                                         .box = box_tests[0],
                                                         .tri = tri_tests[0],
                                                         .query = QUERY_CLOSEST},
                                           &ray, &hit, NULL),
                                 STATUS_LIMIT);
                assert_int_equal(hit.prim, ABI_NO_PRIM);
            }
            packed_free(&packed);
        }
        bvh_free(&bvh);
        scene_free(&scene);
    }
}

/* Whatever the stack, a cycle visits more nodes than there are. */
static void a_cyclic_tree_is_reported_and_does_not_hang(void **state)
{
    (void)state;
    static const uint32_t link[][2] = {{1, 0}, {1, 1}, {2, 0}, {2, 1}, {2, 2}};
    for (size_t i = 0; i < ARRAY_COUNT(link); i++)
        for (int large = 0; large < 2; large++) {
            struct held h = hold("f32", trees_grid(64), 2, TREES_BALANCED);
            struct node_f32 node;
            for (uint32_t n = 0; n < h.packed.node_count; n++) { /* all boxes are hit */
                memcpy(&node, h.packed.word + 8 * (size_t)n, sizeof node);
                for (int k = 0; k < 3; k++) {
                    node.lo[k] = -9;
                    node.hi[k] = 99;
                }
                if (n == link[i][0])
                    node.first = link[i][1];
                memcpy(h.packed.word + 8 * (size_t)n, &node, sizeof node);
            }
            h.packed.stack_need = large ? ABI_STACK_MAX : h.packed.stack_need;
            struct ray ray = {{1, 1, -5}, 0, {0, 0, 1}, TMAX};
            struct hit hit;
            assert_int_equal(trace_ray(&(struct job){.scene = &h.scene,
                                                     .packed = &h.packed,
                                                     .box = box_tests[0],
                                                     .tri = tri_tests[0],
                                                     .query = QUERY_CLOSEST},
                                       &ray, &hit, NULL),
                             STATUS_LIMIT);
            assert_int_equal(hit.prim, ABI_NO_PRIM);
            release(&h);
        }
}

static void garbage_words_end_without_reading_outside(void **state)
{
    (void)state;
    struct rng rng = rng_make(13, 0);
    struct ray ray = {{1, 1, -5}, 0, {0.01f, 0.02f, 1}, TMAX};
    for (size_t l = 0; layouts[l]; l++)
        for (int round = 0; round < 300; round++) {
            struct held h = hold(layouts[l]->name, trees_grid(40), 4, TREES_BALANCED);
            for (uint32_t i = 0; i < h.packed.word_count; i++)
                if (rng_below(&rng, 4) == 0)
                    h.packed.word[i] = (uint32_t)rng_u64(&rng) & (round % 2 ? 0x803F003F : ~0u);
            for (uint32_t n = 0; n < h.packed.node_count; n++) /* these believe their counts */
                if (strcmp(layouts[l]->name, "f32") == 0)
                    h.packed.word[8 * n + 7] &= 7;
                else if (strcmp(layouts[l]->name, "rtrs_direct") == 0)
                    h.packed.word[12 * n + 3] &= 7;
            struct hit hit;
            enum status status = trace_ray(&(struct job){.scene = &h.scene,
                                                         .packed = &h.packed,
                                                         .box = box_tests[round % 2],
                                                         .tri = tri_tests[0],
                                                         .query = QUERY_CLOSEST},
                                           &ray, &hit, NULL);
            assert_true(status == STATUS_OK || status == STATUS_LIMIT);
            assert_true(hit.prim == ABI_NO_PRIM || hit.prim < 40);
            release(&h);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ray_visits_a_small_part_of_the_nodes),
        cmocka_unit_test(what_lies_behind_the_best_hit_is_not_tested),
        cmocka_unit_test(an_any_hit_stops_at_the_first_triangle),
        cmocka_unit_test(exactly_stack_need_entries_are_enough),
        cmocka_unit_test(a_cyclic_tree_is_reported_and_does_not_hang),
        cmocka_unit_test(garbage_words_end_without_reading_outside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
