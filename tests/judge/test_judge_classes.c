/* Classes of answers that the judge allows: each is named, and ends where it should. */
#include "ref/judge/judge.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/judge/judge_fixture.h"

#include <math.h>

static void a_tie_is_exact(void **state)
{
    (void)state;
    struct judge_fixture *c = judge_fixture_of(layers());
    judge_fixture_ask(c, along_z(0.5f, -0.25f));
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_CLOSEST);
        must_be(c, right_answer(c, 0), VERDICT_TIE);
        must_be(c, right_answer(c, 4), VERDICT_TIE);
        must_be_wrong(c, right_answer(c, 2), WRONG_MISSED);
    }
    judge_fixture_close(c);
}

static void a_near_tie_is_within_both_bounds(void **state)
{
    (void)state;
    for (size_t s = 0; s < SUBJECTS; s++) {
        struct scene scene = layers();
        scene.tri_count = 4;
        for (int i = 4; i < 8; i++) /* one float behind the near layer */
            scene.vertex[3 * i + 2] = nextafterf(1.0f, 2.0f);
        struct judge_fixture *c = judge_fixture_of(scene);
        judge_fixture_seat(c, &subjects[s], QUERY_CLOSEST);
        judge_fixture_ask(c, along_z(0.5f, -0.25f));
        must_be(c, right_answer(c, 2), VERDICT_NEAR_TIE);
        judge_fixture_close(c);
        scene = layers();
        scene.tri_count = 4;
        for (int i = 4; i < 8; i++)
            scene.vertex[3 * i + 2] = is_unknown(&subjects[s]) ? 1.001f : 1.00001f;
        c = judge_fixture_of(scene);
        judge_fixture_seat(c, &subjects[s], QUERY_CLOSEST);
        judge_fixture_ask(c, along_z(0.5f, -0.25f));
        must_be_wrong(c, right_answer(c, 2), WRONG_MISSED);
        assert_int_equal(c->judgement.expected, 0);
        judge_fixture_close(c);
    }
}

/* A quad with a rim: on the rim every answer is chance, for what is not watertight or not closed.
 */
static void the_boundary_may_be_missed_but_not_what_lies_behind(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_CLOSEST);
        judge_fixture_ask(c, along_z(1, 0.25f)); /* on the rim of both layers */
        assert_int_equal(c->truth.class, ORACLE_EDGE);
        must_be(c, a_miss(), VERDICT_BOUNDARY);
        must_be(c, right_answer(c, 0), VERDICT_RIGHT);
        must_be(c, right_answer(c, 2), VERDICT_BOUNDARY);
        /* Just outside the rim: a hit is chance as well. */
        judge_fixture_ask(c, along_z(nextafterf(1, 2), 0.25f));
        assert_int_equal(c->truth.prim, ABI_NO_PRIM);
        must_be(c, a_miss(), VERDICT_RIGHT);
        struct hit phantom = right_answer(c, 0);
        /* Without a shear the edges of woop are exact, along an axis those of pluecker. */
        if (subjects[s].model.formula == TWIN_WOOP || subjects[s].model.formula == TWIN_PLUECKER)
            must_be_wrong(c, phantom, WRONG_PHANTOM);
        else
            must_be(c, phantom, VERDICT_BOUNDARY);
        /* At the rim of the near layer only: the far one is a certain hit behind it. */
        struct ray slanted = {{1.5f, 0.25f, 0}, 0, {-0.5f, 0, 1}, 1e30f};
        judge_fixture_ask(c, slanted);
        assert_int_equal(c->truth.class, ORACLE_EDGE);
        must_be(c, right_answer(c, 2), VERDICT_BOUNDARY);
        must_be_wrong(c, a_miss(), WRONG_MISSED);
        assert_int_equal(c->judgement.expected, c->truth.prim);
        assert_int_not_equal(c->truth.prim, 2);
        assert_true(c->judgement.behind && c->judgement.lost == 2);
    }
    judge_fixture_close(c);
}

static void the_ends_of_the_range_are_a_border(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    for (size_t s = 0; s < SUBJECTS; s++) {
        bool open = subjects[s].model.open;
        judge_fixture_seat(c, &subjects[s], QUERY_CLOSEST);
        for (int end = 0; end < 2; end++) {
            struct ray ray = along_z(0.5f, -0.25f);
            ray.tmin = end ? 0 : 1;
            ray.tmax = end ? 1 : 1e30f;
            judge_fixture_ask(c, ray);
            assert_int_equal(c->truth.prim, 0);
            must_be(c, end ? a_miss() : right_answer(c, 2), VERDICT_BORDER);
            if (open) /* it promises not to answer an end */
                must_be_wrong(c, right_answer(c, 0), WRONG_DISTANCE);
            else
                must_be(c, right_answer(c, 0), VERDICT_RIGHT);
            /* Clearly outside the range is no border. */
            ray.tmin = end ? 0 : 1.01f;
            ray.tmax = end ? 0.99f : 1e30f;
            judge_fixture_ask(c, ray);
            must_be(c, right_answer(c, 0), VERDICT_WRONG);
        }
    }
    judge_fixture_close(c);
}

/* Along an axis every evaluation's determinant is exactly 0. What else a plane may do:
 * test_judge_noise.c. */
static void a_ray_in_the_plane_may_miss(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_CLOSEST);
        judge_fixture_ask(c, (struct ray){{-3, 0.25f, 1}, 0, {1, 0, 0}, 1e30f});
        assert_int_equal(c->truth.prim, ABI_NO_PRIM);
        assert_true(c->truth.flags & ORACLE_SAW_IN_PLANE);
        must_be(c, a_miss(), VERDICT_RIGHT);
        struct hit on = {2.5f, 0.25f, 0.375f, 1}, off = {9, 0.25f, 0.25f, 1}; /* beyond it */
        if (is_unknown(&subjects[s]))
            must_be(c, on, VERDICT_IN_PLANE);
        else
            must_be_wrong(c, on, WRONG_PHANTOM);
        must_be(c, off, VERDICT_WRONG);
    }
    judge_fixture_close(c);
}

/* The published cheat: a triangle seen edge-on is answered wherever that hides something. */
static void a_wall_seen_edge_on_hides_nothing(void **state)
{
    (void)state;
    struct scene scene = layers();
    scene.tri_count = 4;
    /* Triangle 3 becomes a wall in the plane x = 0 at y, z in 3..5, seen edge-on along z. */
    const float wall[3][3] = {{0, 0.25f, 3}, {0, 0.5f, 5}, {0, -0.5f, 5}};
    scene.index[9] = 5, scene.index[10] = 6, scene.index[11] = 7;
    memcpy(scene.vertex + 15, wall, sizeof wall);
    scene.tri_count = 4;
    struct judge_fixture *c = judge_fixture_of(scene);
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_CLOSEST);
        judge_fixture_ask(c, along_z(0, -0.125f));
        assert_int_equal(c->truth.prim, 0);
        must_be_wrong(c, (struct hit){0.5f, 0.25f, 0.25f, 3}, WRONG_TRIANGLE);
        must_be(c, (struct hit){7, 0.25f, 0.25f, 3}, VERDICT_WRONG);
    }
    judge_fixture_close(c);
}

static void triangles_without_area_are_never_certain(void **state)
{
    (void)state;
    struct scene scene = layers();
    scene.tri_count = 3;
    scene.index[1] = scene.index[0]; /* triangle 0 is the diagonal from corner to corner */
    struct judge_fixture *c = judge_fixture_of(scene);
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_CLOSEST);
        struct ray ray = along_z(0.5f, 0.5f);
        ray.tmax = 1.5f; /* triangle 1 shares the diagonal: before it */
        judge_fixture_ask(c, ray);
        must_be(c, a_miss(), VERDICT_BOUNDARY); /* of triangle 1 */
        must_be(c, right_answer(c, 1), VERDICT_RIGHT);
    }
    judge_fixture_close(c);
}

static void the_slab_test_of_embree_loses_what_it_cannot_see(void **state)
{
    (void)state;
    const struct fixture_subject *embree = subject_of("embree"),
                                 *robust = subject_of("embree_robust");
    assert_string_equal(embree->name, "embree");
    struct scene scene = layers();
    scene.tri_count = 4;
    for (int i = 0; i < 24; i++)
        scene.vertex[i] += 10000; /* far away: boxes flat in z are lost by rounding */
    struct judge_fixture *c = judge_fixture_of(scene);
    struct ray ray = {{10000.99f, 9999.75f, 9999}, 0, {0.001f, 0, 1}, 1e30f};
    judge_fixture_seat(c, embree, QUERY_CLOSEST);
    judge_fixture_ask(c, ray);
    assert_int_equal(c->truth.prim, 0);
    must_be(c, a_miss(), VERDICT_SLAB);
    judge_fixture_seat(c, robust, QUERY_CLOSEST);
    must_be_wrong(c, a_miss(), WRONG_MISSED);
    judge_fixture_seat(c, embree, QUERY_CLOSEST);
    ray.org[0] = 10000.5f; /* well inside */
    judge_fixture_ask(c, ray);
    must_be_wrong(c, a_miss(), WRONG_MISSED);
    judge_fixture_close(c);
}

/* The layer's box is flat in z, which changes slowly: its distance may be off by more than the hit
 * is from the end of the range, which is 16 ulp. */
static void the_slab_test_of_embree_may_lose_what_is_next_to_the_end(void **state)
{
    (void)state;
    struct judge_fixture *c = judge_fixture_of(layers());
    struct ray ray = {{1.5f, -1.25f, 0x1.03fe58p+0f}, 0, {-1, 1.5f, -0x1.ff2c8p-7f}, 0x1.ffffcp-1f};
    judge_fixture_seat(c, subject_of("embree"), QUERY_CLOSEST);
    judge_fixture_ask(c, ray);
    assert_true(c->truth.class == ORACLE_INSIDE);
    must_be(c, a_miss(), VERDICT_SLAB);
    judge_fixture_seat(c, subject_of("embree_robust"), QUERY_CLOSEST);
    must_be_wrong(c, a_miss(), WRONG_MISSED);
    judge_fixture_seat(c, subject_of("embree"), QUERY_CLOSEST);
    ray.tmax = 2;
    judge_fixture_ask(c, ray);
    must_be_wrong(c, a_miss(), WRONG_MISSED);
    judge_fixture_close(c);
}

static void what_is_out_of_contract_is_left_alone(void **state)
{
    (void)state;
    struct judge_fixture *c = inside();
    const struct ray outside[] = {
        {{0, 0, 0}, 0, {0, 0, 0}, 1},      {{NAN, 0, 0}, 0, {0, 0, 1}, 1},
        {{0, 0, 0}, 0, {0, 1e-30f, 1}, 1}, {{0x1.000002p40f, 0, 0}, 0, {0, 0, 1}, 1},
        {{0, 0, 0}, 2, {0, 0, 1}, 1},      {{0, 0, 0}, 0, {0, 0, INFINITY}, 1}};
    struct hit anything = {3, 0.1f, 0.2f, 1}, nan = {NAN, NAN, NAN, 1}, absent = {1, 0, 0, 4};
    for (size_t s = 0; s < SUBJECTS; s++) {
        judge_fixture_seat(c, &subjects[s], QUERY_CLOSEST);
        for (size_t i = 0; i < ARRAY_COUNT(outside); i++) {
            judge_fixture_ask(c, outside[i]);
            must_be(c, anything, VERDICT_OUT_OF_CONTRACT);
            must_be(c, nan, VERDICT_OUT_OF_CONTRACT);
            must_be(c, a_miss(), VERDICT_OUT_OF_CONTRACT);
            must_be_wrong(c, absent, WRONG_PHANTOM); /* there is no triangle 4 */
        }
    }
    judge_fixture_close(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tie_is_exact),
        cmocka_unit_test(a_near_tie_is_within_both_bounds),
        cmocka_unit_test(the_boundary_may_be_missed_but_not_what_lies_behind),
        cmocka_unit_test(the_ends_of_the_range_are_a_border),
        cmocka_unit_test(a_ray_in_the_plane_may_miss),
        cmocka_unit_test(a_wall_seen_edge_on_hides_nothing),
        cmocka_unit_test(triangles_without_area_are_never_certain),
        cmocka_unit_test(the_slab_test_of_embree_loses_what_it_cannot_see),
        cmocka_unit_test(the_slab_test_of_embree_may_lose_what_is_next_to_the_end),
        cmocka_unit_test(what_is_out_of_contract_is_left_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
