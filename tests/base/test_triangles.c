/* Laws of ref/primitives/tri.h. The box tests: test_primitives.c. */
#include "ref/primitives/primitives.h"
#include "ref/base/rng.h"
#include "ref/twin/twin.h"
#include "scenes/scenes.h"
#include "ref/primitives/test_run.h"
#include "tests/support/triangle_drawn.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

/* Corners (0,0,z), (4,0,z), (0,4,z) seen along z: everything is exact. */
static bool on_lattice(uint32_t id, float x, float y, int axis, float sign, struct hit *hit)
{
    float v[3][3] = {{0}};
    struct ray ray = {.tmax = TRIANGLE_TMAX};
    int a = (axis + 1) % 3, b = (axis + 2) % 3;
    v[1][a] = v[2][b] = 4;
    ray.org[a] = x;
    ray.org[b] = y;
    ray.org[axis] = -8 * sign;
    ray.dir[axis] = 2 * sign;
    return triangle_run(id, &ray, v, hit);
}

static void every_test_is_closed_at_edges_and_vertices(void **state)
{
    (void)state;
    static const float on[][2] = {{0, 0}, {4, 0}, {0, 4}, {2, 0}, {0, 2}, {2, 2}, {1, 3}, {1, 1}};
    const float e = 1e-6f;
    const float off[][2] = {{-e, 0}, {0, -e}, {-e, 2}, {2, -e}, {2 + e, 2}, {4 + e, 0}, {0, 4 + e}};
    for (size_t i = 0; tri_tests[i]; i++)
        for (int axis = 0; axis < 3; axis++)
            for (int sign = -1; sign <= 1; sign += 2) {
                struct hit hit;
                for (size_t p = 0; p < ARRAY_COUNT(on); p++) {
                    assert_true(
                        on_lattice(tri_tests[i]->id, on[p][0], on[p][1], axis, (float)sign, &hit));
                    assert_true(hit.t == 4 && hit.u == on[p][0] / 4 && hit.v == on[p][1] / 4);
                }
                for (size_t p = 0; p < ARRAY_COUNT(off); p++)
                    assert_false(on_lattice(tri_tests[i]->id, off[p][0], off[p][1], axis,
                                            (float)sign, &hit));
            }
}

/* The hit of the lattice is at t = 4. */
static bool in_range(const struct tri_test *test, float tmin, float tmax)
{
    float v[3][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    struct ray ray = {{1, 1, -8}, tmin, {0, 0, 2}, tmax};
    struct hit hit;
    return triangle_run(test->id, &ray, v, &hit);
}

static void only_mt_rtrs_is_open_at_the_ends_of_the_range(void **state)
{
    (void)state;
    float above = nextafterf(4, 5), below = nextafterf(4, 3);
    for (size_t i = 0; tri_tests[i]; i++) {
        bool closed = strcmp(tri_tests[i]->name, "mt_rtrs") != 0;
        assert_int_equal(tri_tests[i]->open, !closed);
        assert_int_equal(in_range(tri_tests[i], 4, TRIANGLE_TMAX), closed);
        assert_int_equal(in_range(tri_tests[i], 0, 4), closed);
        assert_int_equal(in_range(tri_tests[i], 4, 4), closed);
        assert_true(in_range(tri_tests[i], below, above));
        assert_true(in_range(tri_tests[i], 0, INFINITY));
        assert_false(in_range(tri_tests[i], above, TRIANGLE_TMAX));
        assert_false(in_range(tri_tests[i], 0, below));
        assert_false(in_range(tri_tests[i], 5, 3));
        assert_false(in_range(tri_tests[i], NAN, TRIANGLE_TMAX) || in_range(tri_tests[i], 0, NAN));
    }
}

/* A triangle with legs `a` and 1, head-on: |determinant| is exactly `a`. */
static bool of_determinant(const char *name, float a)
{
    float v[3][3] = {{0, 0, 0}, {a, 0, 0}, {0, 1, 0}};
    struct ray ray = {{0, 0, -1}, 0, {0, 0, 1}, TRIANGLE_TMAX};
    struct hit hit;
    return triangle_run(tri_test_find(name)->id, &ray, v, &hit);
}

static void only_mt_rtrs_has_a_threshold(void **state)
{
    (void)state;
    for (int sign = -1; sign <= 1; sign += 2) {
        float s = (float)sign;
        assert_false(of_determinant("mt_rtrs", s * 1e-7f));
        assert_true(of_determinant("mt_rtrs", s * nextafterf(1e-7f, 1)));
        for (size_t i = 0; tri_tests[i]; i++) {
            if (!tri_tests[i]->open)
                assert_true(of_determinant(tri_tests[i]->name, s * 1e-38f));
            assert_false(of_determinant(tri_tests[i]->name, s * 0.0f));
        }
    }
}

static void u_and_v_weigh_vertices_1_and_2(void **state)
{
    (void)state;
    for (size_t i = 0; tri_tests[i]; i++) {
        struct rng rng = rng_make(5, i);
        uint32_t hits = 0;
        for (int n = 0; n < 20000; n++) {
            struct ray ray;
            struct hit hit;
            float v[3][3];
            triangle_drawn(&rng, &ray, v);
            struct twin twin = twin_eval(twin_of_tri(tri_tests[i]->id), ROUNDING_IEEE, &ray, v);
            if (!triangle_run(tri_tests[i]->id, &ray, v, &hit) || twin.t_err > 1e-5)
                continue;
            hits++;
            for (int k = 0; k < 3; k++) {
                float at = (1 - hit.u - hit.v) * v[0][k] + hit.u * v[1][k] + hit.v * v[2][k];
                assert_true(fabsf(at - (ray.org[k] + hit.t * ray.dir[k])) < 1e-4f);
            }
        }
        assert_true(hits > 5000);
    }
}

static void permute(float v[3][3], int which, float out[3][3])
{
    static const int order[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                    {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    for (int c = 0; c < 3; c++)
        memcpy(out[c], v[order[which][c]], sizeof out[c]);
}

/* woop decides by edge functions of which each is negated exactly when its ends are swapped; the
 * others may differ where a sign is not certain. */
static void vertex_order_and_winding_change_nothing_that_is_certain(void **state)
{
    (void)state;
    for (size_t i = 0; tri_tests[i]; i++) {
        uint32_t id = tri_tests[i]->id, hits = 0, misses = 0;
        struct rng rng = rng_make(6, 0);
        for (int n = 0; n < 20000; n++) {
            struct ray ray;
            struct hit hit, other;
            float v[3][3], turned[3][3];
            triangle_drawn(&rng, &ray, v);
            if (n % 2) /* at an edge */
                for (int k = 0; k < 3; k++)
                    ray.dir[k] = 0.5f * (v[0][k] + v[1][k]) - ray.org[k];
            struct twin twin = twin_eval(twin_of_tri(id), ROUNDING_IEEE, &ray, v);
            bool first = triangle_run(id, &ray, v, &hit);
            for (int which = 1; which < 6; which++) {
                permute(v, which, turned);
                bool second = triangle_run(id, &ray, turned, &other);
                if (id == ABI_TRI_WOOP || twin.certain || !twin.possible)
                    assert_int_equal(first, second);
                if (first && second && isfinite(twin.t_err))
                    assert_true(fabs((double)hit.t - (double)other.t) <= 4 * twin.t_err);
                if (first && second && which == 3 && twin.t_err < 1e-5)
                    assert_true(fabsf(hit.u - other.v) < 1e-4f && fabsf(hit.v - other.u) < 1e-4f);
            }
            hits += first;
            misses += !first;
        }
        assert_true(hits > 2000 && misses > 2000);
    }
}

static void nan_anywhere_is_a_miss(void **state)
{
    (void)state;
    for (size_t i = 0; tri_tests[i]; i++)
        for (int word = 0; word < 17; word++) {
            float v[3][3] = {{0, 0, 0.1f}, {4, 0, 0.2f}, {0, 4, 0.3f}}, w[8];
            struct ray ray = {{1, 1, -8}, 0, {0.01f, 0.02f, 2}, TRIANGLE_TMAX};
            struct hit hit;
            assert_true(triangle_run(tri_tests[i]->id, &ray, v, &hit));
            memcpy(w, &ray, sizeof w);
            if (word < 8)
                w[word] = NAN;
            else
                v[(word - 8) / 3][(word - 8) % 3] = NAN;
            memcpy(&ray, w, sizeof ray);
            assert_false(triangle_run(tri_tests[i]->id, &ray, v, &hit));
        }
}

static void a_direction_of_zero_is_a_miss(void **state)
{
    (void)state;
    float v[3][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    struct ray ray = {{1, 1, 0}, 0, {0, -0.0f, 0}, TRIANGLE_TMAX};
    struct hit hit;
    for (size_t i = 0; tri_tests[i]; i++)
        assert_false(triangle_run(tri_tests[i]->id, &ray, v, &hit));
}

static void minus_zero_is_zero(void **state)
{
    (void)state;
    for (size_t i = 0; tri_tests[i]; i++)
        for (int axis = 0; axis < 3; axis++)
            for (uint32_t signs = 1; signs < 16; signs++) {
                float v[3][3] = {{0.5f, 0.25f, 0.125f}, {3, 0.5f, 2}, {0.75f, 3, 3}};
                struct ray ray = {{1.25f, 1, 1.5f}, 0, {0, 0, 0}, TRIANGLE_TMAX}, negated;
                struct hit hit, other;
                int a = (axis + 1) % 3, b = (axis + 2) % 3;
                ray.dir[axis] = 1;
                ray.org[axis] = -4;
                if (signs & 12) /* an origin of zero too */
                    v[0][a] = v[0][b] = -0.5f, ray.org[a] = ray.org[b] = 0;
                negated = ray;
                if (signs & 1)
                    negated.dir[a] = -0.0f;
                if (signs & 2)
                    negated.dir[b] = -0.0f;
                if (signs & 4)
                    negated.org[a] = -0.0f;
                if (signs & 8)
                    negated.org[b] = -0.0f;
                bool hits = triangle_run(tri_tests[i]->id, &ray, v, &hit);
                assert_int_equal(triangle_run(tri_tests[i]->id, &negated, v, &other), hits);
                if (hits)
                    assert_true(hit.t == other.t && hit.u == other.u && hit.v == other.v);
            }
}

/* Origin and vertices times 2^k, direction times 2^j: t times 2^(k - j), u and v alike. */
static void powers_of_two_scale_t_exactly(void **state)
{
    (void)state;
    static const uint32_t scale_free[] = {ABI_TRI_MT, ABI_TRI_WOOP, ABI_TRI_PLUECKER,
                                          ABI_TRI_BALDWIN_WEBBER}; /* mt_rtrs is not: F16 */
    for (size_t i = 0; i < ARRAY_COUNT(scale_free); i++) {
        struct rng rng = rng_make(7, i);
        uint32_t hits = 0;
        for (int n = 0; n < 20000; n++) {
            struct ray ray, scaled = {.tmax = INFINITY};
            struct hit hit, other;
            float v[3][3], large[3][3];
            int k = (int)rng_below(&rng, 41) - 20, j = (int)rng_below(&rng, 41) - 20;
            triangle_drawn(&rng, &ray, v);
            for (int x = 0; x < 3; x++) {
                scaled.org[x] = ldexpf(ray.org[x], k);
                scaled.dir[x] = ldexpf(ray.dir[x], j);
                for (int c = 0; c < 3; c++)
                    large[c][x] = ldexpf(v[c][x], k);
            }
            bool first = triangle_run(scale_free[i], &ray, v, &hit);
            assert_int_equal(triangle_run(scale_free[i], &scaled, large, &other), first);
            if (!first)
                continue;
            hits++;
            assert_true(other.t == ldexpf(hit.t, k - j));
            assert_true(other.u == hit.u && other.v == hit.v);
        }
        assert_true(hits > 5000);
    }
}

/* --- leaks of a closed mesh ------------------------------------------------------------------ */

/* Rays from inside that hit nothing, of `count` aimed at vertices or at points of edges. */
static uint32_t leaks(const struct scene *scene, const char *test, bool vertices, uint32_t count)
{
    struct rng rng = rng_make(9, vertices);
    uint32_t id = tri_test_find(test)->id, leaked = 0;
    for (uint32_t i = 0; i < count; i++) {
        struct ray ray = {.tmax = TRIANGLE_TMAX};
        float v[3][3], s = vertices ? 0 : rng_float(&rng);
        uint32_t c = rng_below(&rng, 3), d = (c + 1) % 3;
        scene_tri(scene, rng_below(&rng, scene->tri_count), v);
        for (int k = 0; k < 3; k++) {
            ray.org[k] = 0.3f * triangle_unit(&rng);
            ray.dir[k] = v[c][k] + s * (v[d][k] - v[c][k]) - ray.org[k];
        }
        struct tri_ray r = tri_ray_make(&ray);
        struct hit hit;
        uint32_t prim = 0;
        for (; prim < scene->tri_count; prim++) {
            scene_tri(scene, prim, v);
            if (tri_test_run(id, &r, v, &hit))
                break;
        }
        leaked += prim == scene->tri_count;
    }
    return leaked;
}

static void woop_is_watertight_and_mt_is_not(void **state)
{
    (void)state;
    static const double parts[] = {1, 5}; /* the octahedron; 200 triangles */
    for (size_t i = 0; i < ARRAY_COUNT(parts); i++) {
        const double values[GENERATOR_PARAMS] = {parts[i], 1};
        struct scene scene;
        assert_int_equal(generator_make(generator_find("sphere"), values, 1, &scene, NULL),
                         STATUS_OK);
        for (int vertices = 0; vertices < 2; vertices++) {
            assert_int_equal(leaks(&scene, "woop", vertices, 40000), 0);
            assert_true(leaks(&scene, "mt", vertices, 40000) > 100);
        }
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_test_is_closed_at_edges_and_vertices),
        cmocka_unit_test(only_mt_rtrs_is_open_at_the_ends_of_the_range),
        cmocka_unit_test(only_mt_rtrs_has_a_threshold),
        cmocka_unit_test(u_and_v_weigh_vertices_1_and_2),
        cmocka_unit_test(vertex_order_and_winding_change_nothing_that_is_certain),
        cmocka_unit_test(nan_anywhere_is_a_miss),
        cmocka_unit_test(a_direction_of_zero_is_a_miss),
        cmocka_unit_test(minus_zero_is_zero),
        cmocka_unit_test(powers_of_two_scale_t_exactly),
        cmocka_unit_test(woop_is_watertight_and_mt_is_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
