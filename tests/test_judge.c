/* The judge: right answers are allowed, and wrong answers of every kind are caught. */
#include "ref/judge.h"
#include "ref/rng.h"
#include "ref/trace.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

static const uint32_t no_prim = ABI_NO_PRIM;

/* Two layers of one quad each, at z = 1 and z = 2, and a duplicate of triangle 0 as triangle 4. */
static struct scene layers(void)
{
    struct scene scene;
    static const float vertex[8][3] = {{-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1},
                                       {-1, -1, 2}, {1, -1, 2}, {1, 1, 2}, {-1, 1, 2}};
    static const uint32_t index[5][3] = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}, {0, 1, 2}};
    if (scene_make(8, 5, &scene))
        abort();
    memcpy(scene.vertex, vertex, sizeof vertex);
    memcpy(scene.index, index, sizeof index);
    return scene;
}

static struct ray along_z(float x, float y)
{
    return (struct ray){{x, y, 0}, 0, {0, 0, 1}, 1e30f};
}

static struct hit answer_of(const struct scene *scene, const struct tri_test *tri,
                            const struct ray *ray, uint32_t prim)
{
    float v[3][3];
    struct hit hit;
    struct tri_ray r = tri_ray_make(ray);
    scene_tri(scene, prim, v);
    assert_true(tri_test_run(tri->id, &r, v, &hit));
    hit.prim = prim;
    return hit;
}

struct setup {
    struct scene scene;
    struct judge judge;
    struct ray ray;
    struct hit reference;
};

/* A ray through the inside of triangles 0, 2 and 4. */
static struct setup inside(const char *tri, enum query query, enum subject subject)
{
    struct setup s = {.scene = layers(), .ray = along_z(0.5f, -0.25f)};
    s.judge = judge_make(&s.scene, tri_test_find(tri), query, subject, true);
    trace_brute(&s.scene, s.judge.tri, QUERY_CLOSEST, &s.ray, &s.reference);
    assert_int_equal(s.reference.prim, 0);
    return s;
}

static enum verdict verdict_of(struct setup *s, struct hit answer)
{
    s->judge.scene = &s->scene; /* the setup was copied since it was made */
    enum verdict verdict = judge_answer(&s->judge, &s->ray, &s->reference, &answer);
    scene_free(&s->scene);
    return verdict;
}

static const char *const tri_names[] = {"mt", "woop", "mt_rtrs"};

static void judge_allows_the_same_bits(void **state)
{
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(tri_names); i++) {
        struct setup s = inside(tri_names[i], QUERY_CLOSEST, SUBJECT_TREE);
        assert_int_equal(verdict_of(&s, s.reference), VERDICT_SAME);
    }
}

static void judge_names_a_tie(void **state)
{
    (void)state;
    struct setup s = inside("mt", QUERY_CLOSEST, SUBJECT_TREE);
    struct hit twin = answer_of(&s.scene, s.judge.tri, &s.ray, 4);
    assert_int_equal(verdict_of(&s, twin), VERDICT_TIE);
}

static void judge_catches_a_lost_hit(void **state)
{
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(tri_names); i++)
        for (enum subject who = SUBJECT_TREE; who <= SUBJECT_EMBREE_ROBUST; who++) {
            struct setup s = inside(tri_names[i], QUERY_CLOSEST, who);
            assert_int_equal(verdict_of(&s, (struct hit){.prim = no_prim}), VERDICT_DIFFERENT);
        }
}

static void judge_catches_the_farther_triangle(void **state)
{
    (void)state;
    for (enum subject who = SUBJECT_TREE; who <= SUBJECT_EMBREE_ROBUST; who++) {
        struct setup s = inside("mt", QUERY_CLOSEST, who);
        struct hit behind = answer_of(&s.scene, s.judge.tri, &s.ray, 2);
        assert_int_equal(verdict_of(&s, behind), VERDICT_DIFFERENT);
    }
}

static void judge_catches_a_wrong_triangle(void **state)
{
    (void)state;
    for (enum subject who = SUBJECT_TREE; who <= SUBJECT_EMBREE_ROBUST; who++) {
        struct setup s = inside("mt", QUERY_CLOSEST, who);
        struct hit other = s.reference;
        other.prim = 1; /* the other half of the quad: the ray is far from it */
        assert_int_equal(verdict_of(&s, other), VERDICT_DIFFERENT);
        s = inside("mt", QUERY_CLOSEST, who);
        other.prim = 77; /* no such triangle */
        assert_int_equal(verdict_of(&s, other), VERDICT_DIFFERENT);
    }
}

static void judge_catches_a_flipped_bit(void **state)
{
    (void)state;
    for (int field = 0; field < 3; field++) {
        struct setup s = inside("mt", QUERY_CLOSEST, SUBJECT_TREE);
        struct hit hit = s.reference;
        float *value = field == 0 ? &hit.t : field == 1 ? &hit.u : &hit.v;
        *value = float_from_bits(float_bits(*value) ^ 1u);
        assert_int_equal(verdict_of(&s, hit), VERDICT_DIFFERENT);
    }
}

static void judge_bounds_the_distance_of_embree(void **state)
{
    (void)state;
    struct setup s = inside("mt", QUERY_CLOSEST, SUBJECT_EMBREE);
    struct hit hit = s.reference;
    hit.t = nextafterf(hit.t, 2.0f);
    assert_int_equal(verdict_of(&s, hit), VERDICT_SAME);
    s = inside("mt", QUERY_CLOSEST, SUBJECT_EMBREE);
    hit.t = s.reference.t * 1.0001f;
    assert_int_equal(verdict_of(&s, hit), VERDICT_DIFFERENT);
    s = inside("mt", QUERY_CLOSEST, SUBJECT_EMBREE);
    hit.t = NAN;
    assert_int_equal(verdict_of(&s, hit), VERDICT_DIFFERENT);
}

static void judge_catches_a_phantom(void **state)
{
    (void)state;
    struct scene scene = layers();
    struct ray ray = along_z(5, 5);
    struct hit miss = {.prim = no_prim}, phantom = {1, 0.25f, 0.25f, 0};
    for (enum query query = QUERY_CLOSEST; query <= QUERY_ANY; query++)
        for (enum subject who = SUBJECT_TREE; who <= SUBJECT_EMBREE_ROBUST; who++) {
            struct judge judge = judge_make(&scene, tri_test_find("mt"), query, who, true);
            assert_int_equal(judge_answer(&judge, &ray, &miss, &phantom), VERDICT_DIFFERENT);
        }
    scene_free(&scene);
}

static void judge_catches_a_wrong_any_hit(void **state)
{
    (void)state;
    struct setup s = inside("woop", QUERY_ANY, SUBJECT_TREE);
    struct hit behind = answer_of(&s.scene, s.judge.tri, &s.ray, 2);
    assert_int_equal(verdict_of(&s, behind), VERDICT_SAME); /* any accepted hit will do */
    s = inside("woop", QUERY_ANY, SUBJECT_TREE);
    behind.t = 1.5f; /* but not one that its triangle test does not give */
    assert_int_equal(verdict_of(&s, behind), VERDICT_DIFFERENT);
    for (enum subject who = SUBJECT_TREE; who <= SUBJECT_EMBREE_ROBUST; who++) {
        s = inside("woop", QUERY_ANY, who);
        assert_int_equal(verdict_of(&s, (struct hit){.prim = no_prim}), VERDICT_DIFFERENT);
    }
}

static void judge_allows_a_leak_at_the_boundary_only(void **state)
{
    (void)state;
    struct scene scene = layers();
    struct ray ray = along_z(1, 0.25f); /* on the rim of both layers */
    struct judge judge = judge_make(&scene, tri_test_find("mt"), QUERY_CLOSEST, SUBJECT_TREE, true);
    struct hit reference, miss = {.prim = no_prim};
    trace_brute(&scene, judge.tri, QUERY_CLOSEST, &ray, &reference);
    assert_int_not_equal(reference.prim, no_prim);
    assert_int_equal(judge_answer(&judge, &ray, &reference, &miss), VERDICT_BOUNDARY);
    /* On the diagonal of the near layer only: a miss loses the far layer's certain hit... the far
     * layer has the same diagonal, so turn the ray a little. */
    struct ray slanted = {{0.5f, 0.5f, 0}, 0, {-0.25f, 0.0f, 1}, 1e30f};
    slanted.org[0] = 0.75f; /* x = 0.5 = y at z = 1: on the diagonal; x = 0.25 at z = 2: inside */
    trace_brute(&scene, judge.tri, QUERY_CLOSEST, &slanted, &reference);
    assert_true(reference.t == 1.0f);
    struct hit far_hit = answer_of(&scene, judge.tri, &slanted, 3);
    assert_int_equal(judge_answer(&judge, &slanted, &reference, &far_hit), VERDICT_BOUNDARY);
    assert_int_equal(judge_answer(&judge, &slanted, &reference, &miss), VERDICT_DIFFERENT);
    scene_free(&scene);
}

static void judge_names_a_near_tie(void **state)
{
    (void)state;
    struct scene scene = layers();
    /* The far layer moved to one float behind the near one. */
    for (int i = 4; i < 8; i++)
        scene.vertex[3 * i + 2] = nextafterf(1.0f, 2.0f);
    struct ray ray = along_z(0.5f, -0.25f);
    struct judge judge = judge_make(&scene, tri_test_find("mt"), QUERY_CLOSEST, SUBJECT_TREE, true);
    struct hit reference;
    trace_brute(&scene, judge.tri, QUERY_CLOSEST, &ray, &reference);
    struct hit behind = answer_of(&scene, judge.tri, &ray, 2);
    assert_true(behind.t > reference.t);
    assert_int_equal(judge_answer(&judge, &ray, &reference, &behind), VERDICT_NEAR_TIE);
    scene_free(&scene);
}

/* Two triangles at t = 1 by the reference's test; Embree gives the other at one float less. */
static void judge_compares_each_side_by_its_own_distances(void **state)
{
    (void)state;
    struct scene scene = layers();
    struct ray ray = along_z(0.5f, -0.25f);
    struct judge judge =
        judge_make(&scene, tri_test_find("woop"), QUERY_CLOSEST, SUBJECT_EMBREE_ROBUST, false);
    struct hit reference = answer_of(&scene, judge.tri, &ray, 4);
    struct hit answer = answer_of(&scene, judge.tri, &ray, 0);
    answer.t = nextafterf(answer.t, 0.0f);
    assert_int_equal(judge_answer(&judge, &ray, &reference, &answer), VERDICT_NEAR_TIE);
    answer.t = 0.9f; /* but not of a t that the triangle cannot have */
    assert_int_equal(judge_answer(&judge, &ray, &reference, &answer), VERDICT_DIFFERENT);
    scene_free(&scene);
}

static void judge_does_not_let_embree_lose_the_inside(void **state)
{
    (void)state;
    /* Near the rim the default box test has an excuse, well inside it has none, at any offset. */
    struct rng rng = rng_make(9, 0);
    size_t excused = 0;
    for (int n = 0; n < 2000; n++) {
        struct scene scene = layers();
        float offset = n % 2 ? 1000.0f : 0.0f;
        for (int i = 0; i < 8; i++)
            for (int k = 0; k < 3; k++)
                scene.vertex[3 * i + k] += offset;
        struct ray ray = {{offset + rng_range(&rng, -0.9f, 0.9f),
                           offset + rng_range(&rng, -0.9f, 0.9f), offset - 3},
                          0,
                          {rng_range(&rng, -0.01f, 0.01f), 0.003f, 1},
                          1e30f};
        struct judge judge =
            judge_make(&scene, tri_test_find("woop"), QUERY_CLOSEST, SUBJECT_EMBREE, true);
        struct hit reference, miss = {.prim = no_prim};
        trace_brute(&scene, judge.tri, QUERY_CLOSEST, &ray, &reference);
        enum verdict verdict = judge_answer(&judge, &ray, &reference, &miss);
        excused += verdict == VERDICT_SLAB;
        assert_true(verdict == VERDICT_DIFFERENT || verdict == VERDICT_SLAB ||
                    verdict == VERDICT_BOUNDARY);
        scene_free(&scene);
    }
    assert_true(excused < 2000 / 4);
}

static void judge_leaves_rays_out_of_contract_alone(void **state)
{
    (void)state;
    struct scene scene = layers();
    struct judge judge = judge_make(&scene, tri_test_find("mt"), QUERY_CLOSEST, SUBJECT_TREE, true);
    struct hit miss = {.prim = no_prim}, hit = {1, 0, 0, 0};
    struct ray bad[] = {along_z(NAN, 0), along_z(0, 0), along_z(0, 0), along_z(0, 0),
                        along_z(0, 0)};
    bad[1].dir[2] = 0;        /* no direction */
    bad[2].dir[0] = 0x1p-61f; /* a component below 2^-60 of the largest */
    bad[3].tmin = -1;
    bad[4].tmin = 2, bad[4].tmax = 1;
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
        assert_false(ray_in_contract(&bad[i]));
        assert_int_equal(judge_answer(&judge, &bad[i], &miss, &hit), VERDICT_OUT_OF_CONTRACT);
        assert_int_equal(judge_bits(&bad[i], &miss, &hit), VERDICT_OUT_OF_CONTRACT);
    }
    struct ray good = along_z(0, 0);
    good.dir[0] = 0x1p-60f;
    assert_true(ray_in_contract(&good));
    assert_int_equal(judge_bits(&good, &miss, &hit), VERDICT_DIFFERENT);
    scene_free(&scene);
}

static void judge_tells_a_reference_that_is_not_complete(void **state)
{
    (void)state;
    struct setup s = inside("mt", QUERY_CLOSEST, SUBJECT_TREE);
    struct hit right = s.reference;
    s.reference = (struct hit){.prim = no_prim};
    s.judge.reference_complete = false;
    assert_int_equal(verdict_of(&s, right), VERDICT_DIFFERENT);
}

static void judge_bounds_a_hit_in_the_plane_by_the_triangle(void **state)
{
    (void)state;
    /* A quad lying along the ray, and a wall behind it: some t on the quad is allowed, others not.
     */
    struct scene scene = layers();
    scene.vertex[1] = scene.vertex[4] = scene.vertex[7] = scene.vertex[10] = 0; /* y = 0 */
    scene.vertex[2] = scene.vertex[5] = 0.5f, scene.vertex[8] = scene.vertex[11] = 1.5f;
    struct ray ray = along_z(0.5f, 0);
    struct judge judge =
        judge_make(&scene, tri_test_find("mt"), QUERY_CLOSEST, SUBJECT_EMBREE, true);
    struct hit reference, answer = {1.0f, 0, 0, 0};
    trace_brute(&scene, judge.tri, QUERY_CLOSEST, &ray, &reference);
    assert_true(reference.t == 2.0f);
    assert_int_equal(judge_answer(&judge, &ray, &reference, &answer), VERDICT_BOUNDARY);
    answer.t = 0.25f; /* before the quad begins */
    assert_int_equal(judge_answer(&judge, &ray, &reference, &answer), VERDICT_NOISE);
    answer.t = 1.75f; /* after it ends */
    assert_int_equal(judge_answer(&judge, &ray, &reference, &answer), VERDICT_NOISE);
    answer.t = 2.5f; /* behind the wall, which is a certain hit: noise excuses no loss */
    assert_int_equal(judge_answer(&judge, &ray, &reference, &answer), VERDICT_DIFFERENT);
    answer.t = NAN;
    assert_int_equal(judge_answer(&judge, &ray, &reference, &answer), VERDICT_DIFFERENT);
    ray.tmax = 1.9f; /* nothing but the quad in range */
    struct hit nothing = {.prim = no_prim};
    answer.t = 1.75f;
    assert_int_equal(judge_answer(&judge, &ray, &nothing, &answer), VERDICT_NOISE);
    scene_free(&scene);
}

static void judge_line_shows_both_answers(void **state)
{
    (void)state;
    struct ray ray = along_z(0.5f, 0);
    struct hit miss = {.prim = no_prim}, hit = {1.5f, 0, 0, 12};
    char line[512];
    judge_line(&ray, &hit, &miss, line, sizeof line);
    assert_non_null(strstr(line, "=> miss  expected: prim=12 t=0x1.8p+0"));
    assert_non_null(strstr(line, "o=(0x1p-1,0x0p+0,0x0p+0)"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(judge_allows_the_same_bits),
        cmocka_unit_test(judge_names_a_tie),
        cmocka_unit_test(judge_catches_a_lost_hit),
        cmocka_unit_test(judge_catches_the_farther_triangle),
        cmocka_unit_test(judge_catches_a_wrong_triangle),
        cmocka_unit_test(judge_catches_a_flipped_bit),
        cmocka_unit_test(judge_bounds_the_distance_of_embree),
        cmocka_unit_test(judge_catches_a_phantom),
        cmocka_unit_test(judge_catches_a_wrong_any_hit),
        cmocka_unit_test(judge_allows_a_leak_at_the_boundary_only),
        cmocka_unit_test(judge_names_a_near_tie),
        cmocka_unit_test(judge_compares_each_side_by_its_own_distances),
        cmocka_unit_test(judge_does_not_let_embree_lose_the_inside),
        cmocka_unit_test(judge_leaves_rays_out_of_contract_alone),
        cmocka_unit_test(judge_tells_a_reference_that_is_not_complete),
        cmocka_unit_test(judge_bounds_a_hit_in_the_plane_by_the_triangle),
        cmocka_unit_test(judge_line_shows_both_answers),
    };
    return cmocka_run_group_tests_name("judge", tests, NULL, NULL) ? 1 : 0;
}
