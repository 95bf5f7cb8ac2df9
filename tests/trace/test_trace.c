/* Laws of ref/trace/trace.h: what a tree answers is exactly true, in the layout's order. The
 * work it takes and the stack: test_trace_work.c. */
#include "ref/judge/judge.h"
#include "ref/trace/trace.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/trace_fixture.h"

#include <math.h>

/* --- agreement with the exact truth -------------------------------------------------------------
 */

#define RAYS 2000

static const char *const scenes[] = {"soup:n=600", "grid:n=16",  "grid:n=16,height=0",
                                     "sphere:n=8", "cornell",    "platonic",
                                     "flake",      "terrain:k=4"};

static void must_be_right(const struct judge *judge, const struct ray *ray,
                          const struct oracle_answer *truth, const struct hit *hit,
                          const char *what)
{
    struct judgement judgement;
    char line[400];
    assert_int_equal(judge_answer(judge, ray, truth, hit, &judgement), STATUS_OK);
    if (judgement.verdict != VERDICT_WRONG)
        return;
    judge_line(ray, &judgement, hit, line, sizeof line);
    fail_msg("%s %s: %s", what, wrong_name(judgement.wrong), line);
}

static void check_tree(const struct packed *packed, const struct scene *scene,
                       const struct ray *ray, const char *what)
{
    static struct oracle_answer truth[RAYS];
    struct reason reason;
    struct oracle *oracle;
    assert_int_equal(oracle_make(scene, &oracle, &reason), STATUS_OK);
    assert_int_equal(
        oracle_closest(oracle, ORACLE_BRUTE, ORACLE_CLOSED, ray, RAYS, 0, truth, NULL, &reason),
        STATUS_OK);
    for (size_t t = 0; tri_tests[t]; t++)
        for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            struct model model = {.formula = twin_of_tri(tri_tests[t]->id),
                                  .rounding = ROUNDING_IEEE,
                                  .open = tri_tests[t]->open};
            struct judge *judge;
            uint32_t hits = 0;
            assert_int_equal(judge_make(oracle, &model, (enum query)query, &judge, &reason),
                             STATUS_OK);
            for (uint32_t i = 0; i < RAYS; i++) {
                struct hit got;
                assert_int_equal(trace_ray(&(struct job){.scene = scene,
                                                         .packed = packed,
                                                         .box = box_tests[0],
                                                         .tri = tri_tests[t],
                                                         .query = (enum query)query},
                                           &ray[i], &got, NULL),
                                 STATUS_OK);
                hits += got.prim != ABI_NO_PRIM;
                must_be_right(judge, &ray[i], &truth[i], &got, what);
            }
            assert_true(hits > RAYS / 20);
            judge_free(judge);
        }
    oracle_free(oracle);
}

static void a_tree_answers_what_is_exactly_true(void **state)
{
    (void)state;
    static struct ray ray[RAYS];
    for (size_t s = 0; s < ARRAY_COUNT(scenes); s++) {
        struct scene scene = generated(scenes[s]);
        struct bvh bvh = median(&scene, 1 + (uint32_t)s);
        assert_int_equal(ray_set_make(ray_sets[0], &scene, s, RAYS, ray, NULL), STATUS_OK);
        for (size_t l = 0; l < ARRAY_COUNT(repaired); l++) {
            struct packed packed = pack(repaired[l], &bvh, &scene);
            check_tree(&packed, &scene, ray, scenes[s]);
            packed_free(&packed);
        }
        bvh_free(&bvh);
        scene_free(&scene);
    }
}

/* --- small scenes ---------------------------------------------------------------------------- */

static void an_empty_scene_is_a_miss(void **state)
{
    (void)state;
    struct scene scene;
    struct bvh bvh = {0};
    struct ray ray = {{0, 0, -1}, 0, {0, 0, 1}, TMAX};
    struct hit hit;
    assert_int_equal(scene_make(0, 0, &scene), STATUS_OK);
    for (size_t l = 0; layouts[l]; l++)
        for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            struct packed packed = pack(layouts[l]->name, &bvh, &scene);
            struct trace_counts counts = {0, 0};
            hit = (struct hit){1, 2, 3, 4};
            assert_int_equal(trace_ray(&(struct job){.scene = &scene,
                                                     .packed = &packed,
                                                     .box = box_tests[0],
                                                     .tri = tri_tests[0],
                                                     .query = (enum query)query},
                                       &ray, &hit, &counts),
                             STATUS_OK);
            assert_int_equal(hit.prim, ABI_NO_PRIM);
            assert_true(hit.t == 0 && hit.u == 0 && hit.v == 0);
            assert_int_equal(counts.boxes + counts.tris, 0);
            packed_free(&packed);
        }
    trace_brute(&scene, tri_tests[0], QUERY_CLOSEST, &ray, &hit);
    assert_int_equal(hit.prim, ABI_NO_PRIM);
    scene_free(&scene);
}

static void a_single_triangle_is_hit_through_the_root(void **state)
{
    (void)state;
    static const float v[3][3] = {{0, 0, 2}, {4, 0, 2}, {0, 4, 2}};
    struct scene scene = trees_copies(1, v);
    struct bvh bvh = median(&scene, 4);
    for (size_t l = 0; l < ARRAY_COUNT(repaired); l++) {
        struct packed packed = pack(repaired[l], &bvh, &scene);
        struct trace_counts counts = {0, 0};
        struct ray ray = {{1, 2, 0}, 0, {0, 0, 1}, TMAX}, beside = {{5, 5, 0}, 0, {0, 0, 1}, TMAX};
        struct hit hit = closest(&packed, &scene, &ray, &counts);
        assert_true(hit.prim == 0 && hit.t == 2 && hit.u == 0.25f && hit.v == 0.5f);
        assert_int_equal(closest(&packed, &scene, &beside, &counts).prim, ABI_NO_PRIM);
        assert_int_equal(counts.boxes, 2); /* the second ends at the root's box */
        assert_int_equal(counts.tris, 1);
        packed_free(&packed);
    }
    bvh_free(&bvh);
    scene_free(&scene);
}

/* A ray down at the middle of triangle `prim` of trees_grid. */
static struct ray down_at(const struct scene *scene, uint32_t prim)
{
    const float *p = scene->vertex + 9 * (size_t)prim;
    return (struct ray){{p[0] + 0.03f, p[1] + 0.03f, 5}, 0, {0, 0, -1}, TMAX};
}

static void every_item_of_a_leaf_of_1_to_8_is_hit_in_turn(void **state)
{
    (void)state;
    for (uint32_t n = 1; n <= 8; n++)
        for (uint32_t leaves = 1; leaves <= 3; leaves++)
            for (size_t l = 0; l < ARRAY_COUNT(repaired); l++) {
                struct held h = hold(repaired[l], trees_grid(n * leaves), n, TREES_BALANCED);
                for (uint32_t prim = 0; prim < n * leaves; prim++) {
                    struct ray ray = down_at(&h.scene, prim);
                    assert_int_equal(closest(&h.packed, &h.scene, &ray, NULL).prim, prim);
                }
                release(&h);
            }
}

static void triangle_0_can_be_the_only_hit(void **state)
{
    (void)state;
    for (uint32_t n = 1; n <= 40; n += 13)
        for (size_t l = 0; l < ARRAY_COUNT(repaired); l++)
            for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
                struct held h = hold(repaired[l], trees_grid(n), 4, TREES_BALANCED);
                struct ray ray = down_at(&h.scene, 0);
                struct hit hit;
                assert_int_equal(trace_ray(&(struct job){.scene = &h.scene,
                                                         .packed = &h.packed,
                                                         .box = box_tests[0],
                                                         .tri = tri_tests[0],
                                                         .query = (enum query)query},
                                           &ray, &hit, NULL),
                                 STATUS_OK);
                assert_int_equal(hit.prim, 0);
                release(&h);
            }
}

static void rays_out_of_contract_end(void **state)
{
    (void)state;
    static const float bad[] = {NAN, INFINITY, -INFINITY, 0x1p-140f, -0.0f};
    struct held h = hold("f32", trees_grid(300), 2, TREES_BALANCED);
    for (size_t b = 0; b < ARRAY_COUNT(bad); b++)
        for (int word = 0; word < 8; word++)
            for (size_t box = 0; box_tests[box]; box++) {
                float w[8] = {3, 0.2f, 5, 0, 0, 0, -1, TMAX};
                struct ray ray;
                struct hit hit;
                w[word] = bad[b];
                memcpy(&ray, w, sizeof ray);
                assert_int_equal(trace_ray(&(struct job){.scene = &h.scene,
                                                         .packed = &h.packed,
                                                         .box = box_tests[box],
                                                         .tri = tri_tests[0],
                                                         .query = QUERY_CLOSEST},
                                           &ray, &hit, NULL),
                                 STATUS_OK);
                if (isnan(bad[b]))
                    assert_int_equal(hit.prim, ABI_NO_PRIM);
            }
    release(&h);
}

/* --- order ----------------------------------------------------------------------------------- */

/* Two leaves with a copy of the same triangle each: at equal t the first found stays. rtrs_rf and
 * rtrs_direct name item k as triangle k - 1, so the tree holds items 1 and 2 behind a stranger 0 of
 * no consequence; the paper's record and the repaired ones then hit 1 or 2, those two 0 or 1. */
static uint32_t first_found(const char *layout, enum query query, bool fst_nearer, bool snd_nearer)
{
    static const float v[3][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    struct scene scene = trees_copies(3, v);
    struct bvh bvh = trees_make(&scene, 2, TREES_RIGHT); /* leaves {0, 1} and {2} */
    bvh.node[1].item_first = 1;
    bvh.node[1].item_count = 1;
    trees_fit(&bvh, &scene);
    if (fst_nearer)
        bvh.node[1].bounds.lo[2] = bvh.node[0].bounds.lo[2] = -1;
    if (snd_nearer)
        bvh.node[2].bounds.lo[2] = bvh.node[0].bounds.lo[2] = -1;
    struct packed packed = pack(layout, &bvh, &scene);
    struct ray ray = {{1, 1, -5}, 0, {0.001f, 0, 1}, TMAX};
    struct hit hit;
    assert_int_equal(trace_ray(&(struct job){.scene = &scene,
                                             .packed = &packed,
                                             .box = box_tests[0],
                                             .tri = tri_tests[0],
                                             .query = query},
                               &ray, &hit, NULL),
                     STATUS_OK);
    uint32_t item = hit.prim + (strcmp(layout, "rtrs_rf") == 0 ? 1 : 0);
    item += strcmp(layout, "rtrs_direct") == 0 ? 1 : 0;
    packed_free(&packed);
    bvh_free(&bvh);
    scene_free(&scene);
    return item; /* 1: of fst, 2: of snd */
}

static void children_are_visited_in_the_layouts_order(void **state)
{
    (void)state;
    for (size_t l = 0; layouts[l]; l++)
        for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            const char *name = layouts[l]->name;
            enum query q = (enum query)query;
            bool near = layouts[l]->order == VISIT_NEAR;
            uint32_t fixed = layouts[l]->order == VISIT_SND ? 2 : 1;
            assert_int_equal(first_found(name, q, false, false), near ? 1 : fixed);
            assert_int_equal(first_found(name, q, true, false), near ? 1 : fixed);
            assert_int_equal(first_found(name, q, false, true), near ? 2 : fixed);
        }
}

static void at_equal_t_the_first_found_stays(void **state)
{
    (void)state;
    static const float v[3][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    struct scene scene = trees_copies(8, v);
    struct bvh bvh = trees_make(&scene, 8, TREES_BALANCED);
    struct ray ray = {{1, 1, -5}, 0, {0, 0, 1}, TMAX};
    struct hit hit;
    for (uint32_t first = 0; first < 8; first++) {
        for (uint32_t i = 0; i < 8; i++)
            bvh.prim[i] = (first + i) % 8;
        for (size_t l = 0; l < ARRAY_COUNT(repaired); l++) {
            struct packed packed = pack(repaired[l], &bvh, &scene);
            assert_int_equal(closest(&packed, &scene, &ray, NULL).prim, first);
            packed_free(&packed);
        }
    }
    trace_brute(&scene, tri_tests[0], QUERY_CLOSEST, &ray, &hit);
    assert_int_equal(hit.prim, 0);
    bvh_free(&bvh);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tree_answers_what_is_exactly_true),
        cmocka_unit_test(an_empty_scene_is_a_miss),
        cmocka_unit_test(a_single_triangle_is_hit_through_the_root),
        cmocka_unit_test(every_item_of_a_leaf_of_1_to_8_is_hit_in_turn),
        cmocka_unit_test(triangle_0_can_be_the_only_hit),
        cmocka_unit_test(rays_out_of_contract_end),
        cmocka_unit_test(children_are_visited_in_the_layouts_order),
        cmocka_unit_test(at_equal_t_the_first_found_stays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
