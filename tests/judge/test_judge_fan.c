/* Watertight tests get no boundary band inside closed fans, and only there
 * (ref/judge/judge_fan.c). */
#include "ref/judge/judge.h"
#include "ref/base/rng.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/judge/judge_fixture.h"
#include "tests/support/trace_fixture.h"

#include "bench/measure/leak_rays.h"

#include <math.h>

#define RAYS 4000

static const struct fixture_subject *const mt = &subjects[0];
static const struct fixture_subject *const woop = &subjects[2];
static const struct fixture_subject *const unknown = &subjects[SUBJECTS - 1];

/* From inside a closed mesh at its edges or vertices: how many misses are excused? */
static size_t excused(struct judge_fixture *c, const struct fixture_subject *subject,
                      enum leak_target target)
{
    static struct ray ray[RAYS];
    struct reason reason = {""};
    size_t count = 0;
    if (leak_rays_make(c->oracle, &c->scene, target, 3, RAYS, ray, &reason))
        fail_msg("%s", reason.text);
    judge_fixture_seat(c, subject, QUERY_CLOSEST);
    for (size_t i = 0; i < RAYS; i++) {
        judge_fixture_ask(c, ray[i]);
        assert_int_not_equal(c->truth.prim, ABI_NO_PRIM);
        if (verdict(c, a_miss()) == VERDICT_WRONG)
            assert_int_equal(c->judgement.wrong, WRONG_MISSED);
        else
            count++;
    }
    return count;
}

static void nothing_is_missed_from_inside_a_closed_mesh(void **state)
{
    (void)state;
    static const char *const specs[] = {"sphere:n=4", "sphere:n=16", "platonic"};
    for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
        struct judge_fixture *c = judge_fixture_open(specs[s], 1);
        for (enum leak_target target = LEAK_EDGE; target <= LEAK_VERTEX; target++) {
            assert_int_equal(excused(c, woop, target), 0);
        }
        judge_fixture_close(c);
    }
}

/* Fans are found by position: every triangle with vertices of its own, zeros of either sign. */
static void shared_positions_are_shared_vertices(void **state)
{
    (void)state;
    struct judge_fixture *shared = judge_fixture_open("sphere:n=4", 1);
    struct scene scene;
    assert_int_equal(scene_make(3 * shared->scene.tri_count, shared->scene.tri_count, &scene),
                     STATUS_OK);
    struct rng rng = rng_make(4, 0);
    for (uint32_t i = 0; i < 3 * scene.tri_count; i++) {
        scene.index[i] = i;
        for (int k = 0; k < 3; k++) {
            float x = shared->scene.vertex[3 * shared->scene.index[i] + (uint32_t)k];
            scene.vertex[3 * i + (uint32_t)k] = x == 0 && rng_below(&rng, 2) ? -0.0f : x;
        }
    }
    judge_fixture_close(shared);
    struct judge_fixture *c = judge_fixture_of(scene);
    for (enum leak_target target = LEAK_EDGE; target <= LEAK_VERTEX; target++)
        assert_int_equal(excused(c, woop, target), 0);
    judge_fixture_close(c);
}

/* --- a pyramid's tip by hand ----------------------------------------------------------------- */

/* Triangles around vertex 0 at (0,0,1), of a square seen along z; more may be added. */
static struct scene tip(void)
{
    static const float vertex[6][3] = {{0, 0, 1},      {1, 1, 1.5f},  {-1, 1, 1.5f},
                                       {-1, -1, 1.5f}, {1, -1, 1.5f}, {0, 0, 9}};
    static const uint32_t index[5][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}, {0, 1, 5}};
    struct scene scene;
    assert_int_equal(scene_make(6, 5, &scene), STATUS_OK);
    memcpy(scene.vertex, vertex, sizeof vertex);
    memcpy(scene.index, index, sizeof index);
    scene.tri_count = 4;
    return scene;
}

/* A ray at the tip, or at the edge from the tip to vertex 1. */
static struct ray at_tip(bool edge)
{
    struct ray ray = along_z(0, 0);
    ray.org[0] = ray.org[1] = edge ? 0.25f : 0;
    return ray;
}

static void missing_the_tip_is(struct scene scene, bool edge, enum verdict expected)
{
    struct judge_fixture *c = judge_fixture_of(scene);
    judge_fixture_seat(c, woop, QUERY_CLOSEST);
    judge_fixture_ask(c, at_tip(edge));
    must_be(c, a_miss(), expected);
    judge_fixture_seat(c, mt, QUERY_CLOSEST);
    must_be(c, a_miss(), VERDICT_BOUNDARY);
    judge_fixture_close(c);
}

static void a_closed_tip_cannot_be_missed(void **state)
{
    (void)state;
    for (int edge = 0; edge < 2; edge++)
        missing_the_tip_is(tip(), edge, VERDICT_WRONG);
    for (int turn = 0; turn < 2; turn++) { /* all turned round: still one winding */
        struct scene scene = tip();
        for (uint32_t i = 0; i < 4; i++) {
            uint32_t first = scene.index[3 * i + 1];
            scene.index[3 * i + 1] = scene.index[3 * i + 2];
            scene.index[3 * i + 2] = first;
        }
        missing_the_tip_is(scene, turn, VERDICT_WRONG);
    }
}

/* Woop's promise needs the order of products that rounding to nearest keeps. */
static void a_closed_tip_may_be_missed_where_rounding_is_not_to_nearest(void **state)
{
    (void)state;
    struct rounding loose[] = {ROUNDING_VULKAN, ROUNDING_IEEE, ROUNDING_IEEE};
    loose[1].add = 1.5;
    loose[2].mul = 1.5;
    assert_true(rounding_is_nearest(ROUNDING_IEEE) && rounding_is_nearest(ROUNDING_FLUSHED));
    assert_true(rounding_is_nearest(ROUNDING_VULKAN_RTE) && rounding_is_nearest(ROUNDING_EMBREE));
    for (size_t i = 0; i < ARRAY_COUNT(loose); i++) {
        struct fixture_subject subject = *woop;
        subject.model.rounding = loose[i];
        assert_false(rounding_is_nearest(loose[i]));
        for (int edge = 0; edge < 2; edge++) {
            struct judge_fixture *c = judge_fixture_of(tip());
            judge_fixture_seat(c, &subject, QUERY_CLOSEST);
            judge_fixture_ask(c, at_tip(edge));
            must_be(c, a_miss(), VERDICT_BOUNDARY);
            judge_fixture_close(c);
        }
    }
}

static void a_tip_with_a_gap_may_be_missed(void **state)
{
    (void)state;
    struct scene scene = tip();
    scene.tri_count = 3; /* the edge to vertex 1 has one triangle left */
    missing_the_tip_is(scene, false, VERDICT_BOUNDARY);
    scene = tip();
    scene.tri_count = 3;
    missing_the_tip_is(scene, true, VERDICT_BOUNDARY);
    scene = tip();
    scene.index[3 * 2] = 5; /* a gap elsewhere: the edge to vertex 1 is closed, the tip is not */
    missing_the_tip_is(scene, false, VERDICT_BOUNDARY);
    scene = tip();
    scene.index[3 * 2] = 5;
    missing_the_tip_is(scene, true, VERDICT_WRONG);
}

static void a_tip_of_two_windings_may_be_missed(void **state)
{
    (void)state;
    for (int edge = 0; edge < 2; edge++) {
        struct scene scene = tip();
        scene.index[3 * 3 + 1] = 1, scene.index[3 * 3 + 2] = 4;
        missing_the_tip_is(scene, edge, VERDICT_BOUNDARY);
    }
}

static void a_third_triangle_at_an_edge_opens_it(void **state)
{
    (void)state;
    for (int edge = 0; edge < 2; edge++) {
        struct scene scene = tip();
        scene.tri_count = 5; /* seen edge-on besides */
        missing_the_tip_is(scene, edge, VERDICT_BOUNDARY);
    }
}

/* The neighbour is folded behind: seen from the ray both lie on one side of their edge. */
static void a_silhouette_may_be_missed(void **state)
{
    (void)state;
    static const float vertex[4][3] = {{0, -1, 1}, {0, 1, 1}, {-1, 0, 1.5f}, {-1, 0, 3}};
    static const uint32_t index[2][3] = {{0, 1, 2}, {1, 0, 3}};
    struct scene scene;
    assert_int_equal(scene_make(4, 2, &scene), STATUS_OK);
    memcpy(scene.vertex, vertex, sizeof vertex);
    memcpy(scene.index, index, sizeof index);
    missing_the_tip_is(scene, false, VERDICT_BOUNDARY);
}

/* The whole fan was missed only if the answer lies behind all of it, and its t must be in range. */
static void what_was_answered_counts_against_the_whole_fan(void **state)
{
    (void)state;
    struct scene scene = tip();
    scene.tri_count = 5;
    scene.vertex[3 * 5] = 5; /* triangle 4 becomes a wall behind the tip */
    static const float wall[3][3] = {{-5, -5, 4}, {5, -5, 4}, {0, 5, 4}};
    float *vertex = realloc(scene.vertex, sizeof(float) * 27);
    assert_non_null(vertex);
    memcpy(vertex + 18, wall, sizeof wall);
    scene.vertex = vertex;
    scene.vertex_count = 9;
    scene.index[12] = 6, scene.index[13] = 7, scene.index[14] = 8;
    struct judge_fixture *c = judge_fixture_of(scene);
    judge_fixture_seat(c, woop, QUERY_CLOSEST);
    for (int edge = 0; edge < 2; edge++) {
        judge_fixture_ask(c, at_tip(edge));
        must_be_wrong(c, right_answer(c, 4), WRONG_MISSED);
        assert_int_not_equal(c->judgement.expected, 4);
        must_be(c, right_answer(c, 0), VERDICT_TIE);
        struct ray ray = at_tip(edge);
        ray.tmin = edge ? 1.125f : 1; /* the range begins on the fan */
        judge_fixture_ask(c, ray);
        must_be(c, right_answer(c, 4), VERDICT_BOUNDARY);
    }
    judge_fixture_close(c);
}

/* --- trees that are not watertight ----------------------------------------------------------- */

/* A closed corridor, |x| and |y| up to 1, |z| up to `length`. */
static struct scene corridor(float length)
{
    static const uint32_t index[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                          {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                          {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    struct scene scene;
    assert_int_equal(scene_make(8, 12, &scene), STATUS_OK);
    for (uint32_t i = 0; i < 8; i++) {
        scene.vertex[3 * i] = i & 1 ? 1 : -1;
        scene.vertex[3 * i + 1] = i & 2 ? 1 : -1;
        scene.vertex[3 * i + 2] = i & 4 ? length : -length;
    }
    memcpy(scene.index, index, sizeof index);
    return scene;
}

static size_t leaks(struct judge_fixture *c, const struct packed *packed, const char *box)
{
    struct rng rng = rng_make(2, 0);
    size_t wrong = 0;
    for (int i = 0; i < 20000; i++) {
        float off = 1e-6f * powf(1000, rng_float(&rng));
        struct ray ray = {{1 - 0.3f * rng_float(&rng), rng_range(&rng, -0.2f, 0.2f),
                           rng_range(&rng, -0.1f, 0.1f)},
                          0,
                          {0, 0, rng_range(&rng, -1, 1)},
                          1e30f};
        ray.dir[0] = 1 - ray.org[0] + (i % 2 ? off : -off);
        ray.dir[1] = 1 - ray.org[1];
        struct hit hit;
        assert_int_equal(trace_ray(&(struct job){.scene = &c->scene,
                                                 .packed = packed,
                                                 .box = box_test_find(box),
                                                 .tri = tri_test_find("woop"),
                                                 .query = QUERY_CLOSEST},
                                   &ray, &hit, NULL),
                         STATUS_OK);
        judge_fixture_ask(c, ray);
        wrong += verdict(c, hit) == VERDICT_WRONG;
    }
    return wrong;
}

/* The judge sees what the triangle test promises and a tree breaks: boxes of relative padding lose
 * the neighbour that woop would have accepted. */
static void a_leak_through_the_tree_is_caught(void **state)
{
    (void)state;
    struct judge_fixture *c = judge_fixture_of(corridor(1000));
    struct bvh bvh = median(&c->scene, 1);
    struct packed packed = pack("f32", &bvh, &c->scene);
    judge_fixture_seat(c, woop, QUERY_CLOSEST);
    assert_true(leaks(c, &packed, "robust") > 10);
    assert_int_equal(leaks(c, &packed, "watertight"), 0);
    packed_free(&packed);
    bvh_free(&bvh);
    judge_fixture_close(c);
}

/* --- unknown formula ------------------------------------------------------------------------- */

static void an_unknown_formula_is_told_of_its_leaks(void **state)
{
    (void)state;
    struct fixture_subject promise = *unknown;
    promise.model.watertight = true;
    for (int edge = 0; edge < 2; edge++) {
        struct judge_fixture *c = judge_fixture_of(tip());
        judge_fixture_seat(c, unknown, QUERY_CLOSEST);
        judge_fixture_ask(c, at_tip(edge));
        must_be(c, a_miss(), VERDICT_BOUNDARY);
        assert_true(c->judgement.fan); /* counted apart, as "should" */
        judge_fixture_seat(c, &promise, QUERY_CLOSEST);
        must_be_wrong(c, a_miss(), WRONG_MISSED);
        judge_fixture_close(c);
        struct scene scene = tip();
        scene.tri_count = 3;
        c = judge_fixture_of(scene);
        judge_fixture_seat(c, &promise, QUERY_CLOSEST);
        judge_fixture_ask(c, at_tip(edge));
        must_be(c, a_miss(), VERDICT_BOUNDARY);
        assert_false(c->judgement.fan);
        judge_fixture_close(c);
    }
    struct judge_fixture *c = judge_fixture_open("sphere:n=16", 1);
    assert_int_equal(excused(c, &promise, LEAK_EDGE), 0);
    assert_int_equal(excused(c, &promise, LEAK_VERTEX), 0);
    judge_fixture_close(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_missed_from_inside_a_closed_mesh),
        cmocka_unit_test(shared_positions_are_shared_vertices),
        cmocka_unit_test(a_closed_tip_cannot_be_missed),
        cmocka_unit_test(a_closed_tip_may_be_missed_where_rounding_is_not_to_nearest),
        cmocka_unit_test(a_tip_with_a_gap_may_be_missed),
        cmocka_unit_test(a_tip_of_two_windings_may_be_missed),
        cmocka_unit_test(a_third_triangle_at_an_edge_opens_it),
        cmocka_unit_test(a_silhouette_may_be_missed),
        cmocka_unit_test(what_was_answered_counts_against_the_whole_fan),
        cmocka_unit_test(a_leak_through_the_tree_is_caught),
        cmocka_unit_test(an_unknown_formula_is_told_of_its_leaks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
