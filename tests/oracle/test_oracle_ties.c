/* Ties of triangles that share vertices, edges or all three: found without arithmetic
 * (ref/oracle/nearest.c), so they are compared with the fractions here; and hits that are apart by
 * less than any enclosure tells. */
#include "ref/oracle/nearest.h"
#include "ref/base/rng.h"
#include "tests/exact/pair_fault.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define TRIANGLES 12u
#define RAYS      24u
#define SCENES    400u

/* On the lattice, in the plane z = 0 or off it by next to nothing. */
static void put_vertex(struct rng *rng, float *v)
{
    v[0] = (float)rng_below(rng, 9);
    v[1] = (float)rng_below(rng, 9);
    v[2] = 0;
    if (rng_below(rng, 4) == 0)
        v[2] = ldexpf(1, -30 - (int)rng_below(rng, 60)) * (rng_below(rng, 2) ? 1.0f : -1.0f);
}

/* Triangles over few vertices, each with copies, so that faces are shared by index and by place. */
static void put_scene(struct rng *rng, struct scene *scene)
{
    uint32_t half = scene->vertex_count / 2;
    for (uint32_t i = 0; i < half; i++) {
        put_vertex(rng, &scene->vertex[3 * i]);
        for (uint32_t k = 0; k < 3; k++)
            scene->vertex[3 * (half + i) + k] = scene->vertex[3 * i + k];
    }
    for (uint32_t i = 0; i < 3 * scene->tri_count; i++)
        scene->index[i] = rng_below(rng, scene->vertex_count);
}

/* Up through a point of the lattice or of its halves, straight or not. */
static struct ray put_ray(struct rng *rng)
{
    float x = 0.5f * (float)rng_below(rng, 17), y = 0.5f * (float)rng_below(rng, 17);
    float dx = (float)rng_below(rng, 3) - 1, dy = (float)rng_below(rng, 3) - 1;
    return (struct ray){{x - dx, y - dy, -1}, 0, {dx, dy, 1}, INFINITY};
}

static bool is_hit(const struct oracle_pair *pair)
{
    return pair->class == ORACLE_INSIDE || pair->class == ORACLE_EDGE ||
           pair->class == ORACLE_VERTEX;
}

/* All that an answer tells, from the pairs one by one: the set at the least t, what lies behind it,
 * and what touches the ray in its plane. `first` is the smallest number of the set. */
static void expect_answer(const struct oracle *oracle, const struct ray *ray, uint32_t first,
                          const struct oracle_answer *answer)
{
    struct oracle_answer want = {
        .prim = ABI_NO_PRIM, .t_lo = INFINITY, .t_hi = INFINITY, .t_next = INFINITY};
    double margin = INFINITY, plane = INFINITY;
    bool exact = false;
    for (uint32_t prim = 0; prim < TRIANGLES; prim++) {
        struct oracle_pair pair;
        oracle_pair(oracle, ray, prim, &pair);
        if (pair.class == ORACLE_IN_PLANE && pair.range == ORACLE_WITHIN)
            plane = fmin(plane, pair.t_lo);
        if (!is_hit(&pair))
            continue;
        if (oracle_compare(oracle, ray, prim, first) > 0) {
            want.t_next = fmin(want.t_next, pair.t_lo);
            continue;
        }
        margin = fmin(margin, pair.margin);
        exact = exact || !pair.by_filter || want.tie_count > 0;
        want.tie_count++;
        if (prim == first) {
            want.prim = prim;
            want.t_lo = pair.t_lo;
            want.t_hi = pair.t_hi;
            want.class = (uint8_t)pair.class;
        }
    }
    want.margin = want.tie_count ? (float)margin : 0;
    want.flags = exact ? ORACLE_SAW_EXACT : 0;
    want.flags |= plane <= want.t_hi && plane < INFINITY ? ORACLE_SAW_IN_PLANE : 0;
    assert_true(answer_same(answer, &want));
}

/* The same answer of the triangles in any order; and how far the next hit lets the walk reach. */
static void expect_any_order(const struct oracle *oracle, struct rng *rng, const struct ray *ray,
                             const struct oracle_answer *answer)
{
    uint32_t order[TRIANGLES];
    struct nearest nearest;
    struct oracle_answer got;
    for (uint32_t i = 0; i < TRIANGLES; i++) {
        uint32_t k = rng_below(rng, i + 1);
        order[i] = order[k];
        order[k] = i;
    }
    nearest_start(&nearest);
    for (uint32_t i = 0; i < TRIANGLES; i++) {
        struct decided pair;
        struct located at = pair_locate(oracle, order[i]);
        pair_decide(&at, ray, order[i], PAIR_HITS, &pair, NULL);
        nearest_add(&nearest, ray, ORACLE_CLOSED, &pair);
    }
    nearest_finish(&nearest, &got);
    assert_true(answer_same(&got, answer));
    const long double next = answer->t_next, reach = nearest_reach(&nearest);
    if (isinf(answer->t_next))
        assert_true(reach == next);
    else
        assert_true(fabsl(reach - next - fabsl(next) * 0x1p-38L) <= fabsl(next) * 0x1p-53L);
}

static void only_equal_fractions_tie(void **state)
{
    (void)state;
    struct rng rng = rng_make(77, 0);
    struct scene scene;
    size_t ties = 0, near_ties = 0;
    assert_int_equal(scene_make(12, TRIANGLES, &scene), STATUS_OK);
    for (uint32_t s = 0; s < SCENES; s++) {
        struct oracle *oracle = NULL;
        struct reason reason = {""};
        struct ray ray[RAYS];
        struct oracle_answer answer[RAYS];
        put_scene(&rng, &scene);
        for (uint32_t i = 0; i < RAYS; i++)
            ray[i] = put_ray(&rng);
        assert_int_equal(oracle_make(&scene, &oracle, &reason), STATUS_OK);
        assert_int_equal(oracle_closest(oracle, ORACLE_BRUTE, ORACLE_CLOSED, ray, RAYS, 1, answer,
                                        NULL, &reason),
                         STATUS_OK);
        for (uint32_t i = 0; i < RAYS; i++) {
            uint32_t first = ABI_NO_PRIM, count = 0, close = 0;
            struct oracle_pair best, pair;
            for (uint32_t prim = 0; prim < TRIANGLES; prim++) {
                oracle_pair(oracle, &ray[i], prim, &pair);
                if (!is_hit(&pair))
                    continue;
                int order =
                    first == ABI_NO_PRIM ? -1 : oracle_compare(oracle, &ray[i], prim, first);
                bool overlap = order != 0 && first != ABI_NO_PRIM && pair.t_lo <= best.t_hi &&
                               pair.t_hi >= best.t_lo;
                close += overlap;
                count = order < 0 ? 1 : count + (order == 0);
                if (order < 0) {
                    first = prim;
                    best = pair;
                }
            }
            assert_int_equal(answer[i].prim, first);
            assert_int_equal(answer[i].tie_count, count);
            expect_answer(oracle, &ray[i], first, &answer[i]);
            expect_any_order(oracle, &rng, &ray[i], &answer[i]);
            ties += count > 1;
            near_ties += close;
        }
        oracle_free(oracle);
    }
    scene_free(&scene);
    printf("%zu ties, %zu hits next to others\n", ties, near_ties);
    assert_true(ties > 1000 && near_ties > 300);
}

static struct oracle *make(const struct scene *scene)
{
    struct oracle *oracle;
    struct reason reason = {""};
    assert_int_equal(oracle_make(scene, &oracle, &reason), STATUS_OK);
    return oracle;
}

/* Puts two triangles into the plane across an axis, and turns the ray with them. */
static void turn_to_plane(int k, float vertex[18], struct ray *ray)
{
    int i = (k + 1) % 3, j = (k + 2) % 3;
    for (int c = 0; c < 6; c++) {
        float *v = &vertex[3 * c], x = v[0], y = v[1];
        v[i] = x;
        v[j] = y;
        v[k] = 4;
    }
    *ray = (struct ray){.tmax = INFINITY};
    ray->org[i] = 0.5f;
    ray->org[j] = 0.75f;
    ray->org[k] = -1;
    ray->dir[i] = 0.03125f;
    ray->dir[j] = 0.0625f;
    ray->dir[k] = 1;
}

/* Copies of a triangle, its vertices in any order, are in one place without integers; so are
 * triangles in a plane across an axis. */
static void copies_need_no_integers(void **state)
{
    (void)state;
    static const uint32_t order[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                         {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    for (int kind = 0; kind < 4; kind++) {
        float vertex[18] = {-3, -2, 5, 4, -1.5f, 6, 1, 7, 8, -5, -4, 5, 6, -2.5f, 6, 1, 9, 8};
        uint32_t index[21] = {3, 4, 5}, tris = kind < 3 ? 7 : 6;
        struct ray ray = {{0.5f, 0.75f, -1}, 0, {0.03125f, 0.0625f, 1}, INFINITY};
        if (kind < 3)
            turn_to_plane(kind, vertex, &ray);
        for (uint32_t i = 0; i < 18; i++)
            index[i + (kind < 3 ? 3 : 0)] = order[i / 3][i % 3];
        struct scene scene = {
            .vertex = vertex, .index = index, .vertex_count = 6, .tri_count = tris};
        struct oracle *oracle = make(&scene);
        for (uint32_t a = 0; a < tris; a++)
            for (uint32_t b = 0; b < tris; b++) {
                struct decided pair[2];
                for (int n = 0; n < 2; n++) {
                    uint32_t prim = n ? b : a;
                    struct located at = pair_locate(oracle, prim);
                    pair_decide(&at, &ray, prim, PAIR_FULL, &pair[n], NULL);
                    assert_int_equal(pair[n].pair.class, ORACLE_INSIDE);
                    assert_false(pair[n].have_exact);
                }
                assert_int_equal(pair_order(&ray, &pair[0], &pair[1]), 0);
                assert_false(pair[0].have_exact || pair[1].have_exact);
            }
        oracle_free(oracle);
    }
}

/* A hit and a touch in plane that begin at the same exact t = 1 / d: the answer tells of the touch;
 * in the list it is first if its t_lo is rounded down, else the smaller number. */
static void touches_begin_at_t_lo(void **state)
{
    (void)state;
    float vertex[18] = {0, 0, 1, 1, 0, 1, 0, 1, 1, 0, 0, 1, 0, 1, 3, 0, -1, 3};
    size_t rounded = 0;
    for (int n = 0; n < 18; n++) {
        uint32_t index[6] = {0, 1, 2, 3, 4, 5};
        for (uint32_t i = 0; i < 6 && n % 2; i++)
            index[i] = (i + 3) % 6;
        struct scene scene = {.vertex = vertex, .index = index, .vertex_count = 6, .tri_count = 2};
        struct oracle *oracle = make(&scene);
        const struct ray ray = {{0, 0, 0}, 0, {0, 0, (float)(n / 2 + 1)}, INFINITY};
        struct oracle_crossing *list = NULL;
        struct oracle_answer answer;
        struct reason reason = {""};
        size_t capacity = 0, count;
        assert_int_equal(
            oracle_crossings(oracle, &ray, INFINITY, &list, &capacity, &count, &reason), STATUS_OK);
        assert_int_equal(count, 2);
        bool swapped = list[0].pair.class == ORACLE_IN_PLANE;
        const struct oracle_pair *touch = &list[swapped ? 0 : 1].pair;
        bool below = (n / 2 + 1) * (long double)touch->t_lo < 1;
        assert_int_equal(touch->class, ORACLE_IN_PLANE);
        assert_int_equal(swapped, below || n % 2);
        rounded += below;
        for (int path = 0; path < 2; path++) {
            assert_int_equal(oracle_closest(oracle, path ? ORACLE_TREE : ORACLE_BRUTE,
                                            ORACLE_CLOSED, &ray, 1, 1, &answer, NULL, &reason),
                             STATUS_OK);
            assert_int_equal(answer.prim, n % 2);
            assert_true(answer.flags & ORACLE_SAW_IN_PLANE);
        }
        free(list);
        oracle_free(oracle);
    }
    assert_true(rounded > 4 && rounded < 18);
}

/* Where hits alone count, a triangle that is met on an edge out of the range needs no integers;
 * one along whose plane the ray runs does. Whichever side it shows and wherever the range is. */
static void out_of_range_needs_no_integers(void **state)
{
    (void)state;
    float vertex[9] = {-1, 0.1f, 3, 1, -0.1f, 3, 0, 7, 3};
    for (int n = 0; n < 16; n++) {
        const float sense = n & 1 ? -1 : 1, d = n & 2 ? -0.7f : 0.7f;
        uint32_t index[3] = {0, n & 4 ? 2 : 1, n & 4 ? 1 : 2};
        for (int c = 0; c < 3; c++)
            vertex[3 * c + 2] = 3 * sense;
        struct scene scene = {.vertex = vertex, .index = index, .vertex_count = 3, .tri_count = 1};
        struct oracle *oracle = make(&scene);
        struct ray ray = {{0, 0, 0}, n & 8 ? 90 : -2, {0, 0, d}, n & 8 ? 99 : 2};
        struct located at = pair_locate(oracle, 0);
        struct decided pair;
        pair_decide(&at, &ray, 0, PAIR_HITS, &pair, NULL);
        assert_int_equal(pair.pair.class, ORACLE_MISS);
        assert_false(pair.have_exact);
        ray.tmin = -10;
        ray.tmax = 10;
        pair_decide(&at, &ray, 0, PAIR_HITS, &pair, NULL);
        assert_true(pair.have_exact && pair.pair.class == ORACLE_EDGE);
        assert_int_equal(pair.pair.range, ORACLE_WITHIN);
        const struct ray along = {{-7, 0.3f, 3 * sense}, n & 8 ? 90 : -2, {d, d / 3, 0}, 99};
        pair_decide(&at, &along, 0, PAIR_HITS, &pair, NULL);
        assert_true(pair.have_exact && pair.pair.class == ORACLE_IN_PLANE);
        oracle_free(oracle);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_equal_fractions_tie),
        cmocka_unit_test(copies_need_no_integers),
        cmocka_unit_test(touches_begin_at_t_lo),
        cmocka_unit_test(out_of_range_needs_no_integers),
    };
    return cmocka_run_group_tests_name("oracle_ties", tests, NULL, NULL) ? 1 : 0;
}
