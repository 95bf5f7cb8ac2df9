/* World boxes against rationals: each bound is the float32 next to the outermost vertex, none is
 * inside of one. */
#include "ref/base/rng.h"
#include "ref/world/placed.h"
#include "ref/world/world_boxes.h"
#include "tests/two_level/two_level_fixture.h"

#include <float.h>
#include <gmp.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* row . p + T */
static void coordinate(const float row[4], const float p[3], mpq_t out)
{
    mpq_t a, b;
    mpq_inits(a, b, NULL);
    mpq_set_d(out, (double)row[3]);
    for (int k = 0; k < 3; k++) {
        mpq_set_d(a, (double)row[k]);
        mpq_set_d(b, (double)p[k]);
        mpq_mul(a, a, b);
        mpq_add(out, out, a);
    }
    mpq_clears(a, b, NULL);
}

/* Sign of x - f; f may be infinite. */
static int compare(const mpq_t x, float f)
{
    if (isinf(f))
        return f > 0 ? -1 : 1;
    mpq_t y;
    mpq_init(y);
    mpq_set_d(y, (double)f);
    int order = mpq_cmp(x, y);
    mpq_clear(y);
    return (order > 0) - (order < 0);
}

static void assert_next(const mpq_t x, float below, float above)
{
    int low = compare(x, below), high = compare(x, above);
    bool right =
        low == 0 ? below == above : low > 0 && high < 0 && nextafterf(below, INFINITY) == above;
    if (!right)
        fail_msg("%g lies between %a and %a", mpq_get_d(x), (double)below, (double)above);
}

static void assert_coordinate(const float row[4], const float p[3])
{
    mpq_t x;
    float below, above, lo = FLT_MAX, hi = -FLT_MAX;
    mpq_init(x);
    coordinate(row, p, x);
    placed_round(row, p, &below, &above);
    assert_next(x, below, above);
    placed_grow(row, p, &lo, &hi);
    assert_true(lo == (below < FLT_MAX ? below : FLT_MAX));
    assert_true(hi == (above > -FLT_MAX ? above : -FLT_MAX));
    double error, about = placed_about(row, p, &error);
    mpq_t y;
    mpq_init(y);
    mpq_set_d(y, about - error);
    assert_true(mpq_cmp(y, x) <= 0);
    mpq_set_d(y, about + error);
    assert_true(mpq_cmp(x, y) <= 0);
    const float near[] = {below, above, nextafterf(below, -INFINITY), row[3], 0};
    for (size_t i = 0; i < ARRAY_COUNT(near); i++)
        if (!isinf(near[i]))
            assert_int_equal(placed_compare(row, p, near[i]), compare(x, near[i]));
    mpq_clears(x, y, NULL);
}

static float any_float(struct rng *rng, int least, int most)
{
    float mantissa = 1.0f + (float)rng_below(rng, 1u << 23) * 0x1p-23f;
    int exponent = least + (int)rng_below(rng, (uint32_t)(most - least + 1));
    float x = ldexpf(mantissa, exponent);
    return rng_below(rng, 2) ? x : -x;
}

static void coordinates_of_all_sizes(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 40000; i++) {
        struct rng rng = rng_make(1, i);
        int reach = (int)(i % 120);
        float row[4], p[3];
        for (int k = 0; k < 4; k++)
            row[k] = rng_below(&rng, 8) ? any_float(&rng, -reach, reach) : 0;
        for (int k = 0; k < 3; k++)
            p[k] = rng_below(&rng, 8) ? any_float(&rng, -reach, reach) : -0.0f;
        assert_coordinate(row, p);
    }
}

/* Whole numbers, sums that cancel all but the last places, and sums that end beside a float or
 * half way between two. */
static void coordinates_that_cancel(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 20000; i++) {
        struct rng rng = rng_make(2, i);
        float row[4], p[3], spare;
        for (int k = 0; k < 3; k++) {
            row[k] = any_float(&rng, -2, 2);
            p[k] = any_float(&rng, -2, 2);
        }
        if (i % 2) /* the first two products cancel but for roundings */
            p[1] = -row[0] * p[0] / row[1];
        row[3] = 0;
        placed_round(row, p, &row[3], &spare);
        row[3] = -row[3];
        assert_coordinate(row, p);
        row[3] = 0x1p30f * (float)(i % 5);
        p[2] = i % 3 ? 0x1p-60f : 0;
        assert_coordinate(row, p);
        row[0] = 1.0f, row[1] = 0, row[2] = any_float(&rng, -70, -20);
        row[3] = ldexpf(p[0], (int)rng_below(&rng, 30)); /* ties of a + 2^k a */
        assert_coordinate(row, p);
    }
}

/* Sums past what doubles can tell: 2^120 and its like cancel, the rest is anything. */
static void coordinates_that_only_integers_tell(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 5000; i++) {
        struct rng rng = rng_make(3, i);
        float big = any_float(&rng, 60, 120), a = any_float(&rng, -20, 6);
        float row[4] = {big, a, -big, any_float(&rng, -149, 100)};
        float p[3] = {a, any_float(&rng, -140, 20), a};
        assert_coordinate(row, p);
        row[3] = 0;
        assert_coordinate(row, p);
        p[1] = 0;
        assert_coordinate(row, p);
    }
}

static void coordinates_beyond_float32(void **state)
{
    (void)state;
    float row[4] = {2, 0, 0, 0}, p[3] = {FLT_MAX, 0, 0}, below, above;
    assert_coordinate(row, p);
    placed_round(row, p, &below, &above);
    assert_true(below == FLT_MAX && isinf(above));
    row[0] = -2;
    assert_coordinate(row, p);
    row[0] = 1, row[1] = 1, p[1] = 0x1p-149f; /* by the least number beyond */
    assert_coordinate(row, p);
    placed_round(row, p, &below, &above);
    assert_true(below == FLT_MAX && isinf(above));
    row[1] = -1;
    assert_coordinate(row, p);
    row[1] = 0;
    assert_coordinate(row, p);
    placed_round(row, p, &below, &above);
    assert_true(below == FLT_MAX && above == FLT_MAX);
    row[0] = FLT_MAX, row[1] = -FLT_MAX, p[1] = FLT_MAX, row[3] = 1; /* 2^256 cancels */
    assert_coordinate(row, p);
}

/* Every bound is reached by a vertex, and no vertex is outside. */
static void assert_least_box(const struct instance *instance, const struct scene *scene,
                             const struct box *box)
{
    mpq_t x, least, most;
    mpq_inits(x, least, most, NULL);
    for (int k = 0; k < 3; k++) {
        for (size_t i = 0; i < 3 * (size_t)scene->tri_count; i++) {
            coordinate(instance->m[k], scene->vertex + 3 * (size_t)scene->index[i], x);
            if (i == 0 || mpq_cmp(x, least) < 0)
                mpq_set(least, x);
            if (i == 0 || mpq_cmp(x, most) > 0)
                mpq_set(most, x);
        }
        assert_true(compare(least, box->lo[k]) >= 0);
        assert_true(compare(least, nextafterf(box->lo[k], INFINITY)) < 0);
        assert_true(compare(most, box->hi[k]) <= 0);
        assert_true(compare(most, nextafterf(box->hi[k], -INFINITY)) > 0);
    }
    mpq_clears(x, least, most, NULL);
}

static void boxes_of_vertices_are_the_least(void **state)
{
    (void)state;
    for (uint32_t kind = 0; kind < WORLD_KINDS; kind++) {
        struct world world = fixture_world("soup:n=40", kind, 60, kind);
        struct box *box;
        struct reason reason = {""};
        if (world_boxes_make(&world, WORLD_BOXES_OF_VERTICES, &box, &reason))
            fail_msg("%s", reason.text);
        for (uint32_t i = 0; i < world.instance_count; i++)
            assert_least_box(&world.instance[i], world_scene(&world, i), &box[i]);
        struct box *same;
        assert_int_equal(world_boxes_make(&world, WORLD_BOXES_AUTO, &same, NULL), STATUS_OK);
        assert_memory_equal(box, same, world.instance_count * sizeof *box);
        free(box);
        free(same);
        world_free(&world);
    }
}

static void boxes_of_corners_contain_those_of_vertices(void **state)
{
    (void)state;
    for (uint32_t kind = 0; kind < WORLD_KINDS; kind++) {
        struct world world = fixture_world("soup:n=40", kind, 200, kind);
        struct box *box, *corners;
        assert_int_equal(world_boxes_make(&world, WORLD_BOXES_OF_VERTICES, &box, NULL), STATUS_OK);
        assert_int_equal(world_boxes_make(&world, WORLD_BOXES_OF_CORNERS, &corners, NULL),
                         STATUS_OK);
        double area = 0, area_of_corners = 0;
        for (uint32_t i = 0; i < world.instance_count; i++) {
            assert_true(box_contains_box(&corners[i], &box[i]));
            area += box_half_area(&box[i]);
            area_of_corners += box_half_area(&corners[i]);
        }
        assert_true(area_of_corners < 3 * area);
        if (kind == WORLD_SAME || kind == WORLD_MOVED || kind == WORLD_MIRRORED)
            assert_true(area_of_corners == area);
        free(box);
        free(corners);
        world_free(&world);
    }
}

static void boxes_of_triangles_are_the_least(void **state)
{
    (void)state;
    struct world world = fixture_world("soup:n=20", WORLD_TURNED, 20, 5);
    for (uint32_t i = 0; i < world.instance_count; i++)
        for (uint32_t prim = 0; prim < 20; prim++) {
            float v[3][3];
            uint32_t index[3] = {0, 1, 2};
            scene_tri(world_scene(&world, i), prim, v);
            struct scene one = {.vertex = v[0], .index = index, .vertex_count = 3, .tri_count = 1};
            struct box box = placed_tri_bounds(world.instance[i].m, v);
            assert_least_box(&world.instance[i], &one, &box);
        }
    world_free(&world);
}

/* At the identity, and where vertices go to floats, the box is that of the floats. */
static void exact_places_have_exact_boxes(void **state)
{
    (void)state;
    struct world world = fixture_world("grid:n=4", WORLD_SAME, 1, 1);
    struct box bounds = scene_bounds(world.mesh[0].scene), *box;
    assert_int_equal(world_boxes_make(&world, WORLD_BOXES_AUTO, &box, NULL), STATUS_OK);
    for (int k = 0; k < 3; k++)
        assert_true(box->lo[k] == bounds.lo[k] && box->hi[k] == bounds.hi[k]);
    free(box);
    world_free(&world);
}

/* A vertex without a triangle counts for nothing; instances that rays cannot meet have no box. */
static void what_no_ray_meets_has_no_box(void **state)
{
    (void)state;
    struct world world = fixture_world("soup:n=5", WORLD_SAME, 4, 1);
    struct scene *scene = world.mesh[0].scene;
    struct box *box;
    scene->vertex_count--; /* the last triangle names another vertex instead of the last */
    for (size_t i = 0; i < 3 * (size_t)scene->tri_count; i++)
        scene->index[i] = scene->index[i] == scene->vertex_count ? 0 : scene->index[i];
    scene->vertex_count++;
    for (size_t k = 0; k < 3; k++)
        scene->vertex[3 * (size_t)(scene->vertex_count - 1) + k] = 1e6f;
    world.instance[1].mask = 0;
    world.instance[2].mesh = WORLD_NO_MESH;
    assert_int_equal(world_finish(&world, NULL), STATUS_OK);
    assert_int_equal(world_boxes_make(&world, WORLD_BOXES_AUTO, &box, NULL), STATUS_OK);
    assert_true(box[0].hi[0] < 1e5f && box[3].hi[0] < 1e5f);
    assert_true(box[1].lo[0] > box[1].hi[0] && box[2].lo[0] > box[2].hi[0]);
    free(box);
    world.instance[3].m[1][3] = FLT_MAX;
    world.instance[3].m[1][1] = 0x1p110f;
    struct reason reason = {""};
    assert_int_equal(world_boxes_make(&world, WORLD_BOXES_AUTO, &box, &reason), STATUS_LIMIT);
    assert_string_equal(reason.text, "instance 3: its triangles reach beyond float32");
    assert_null(box);
    memcpy(world.instance[0].m, world.instance[3].m, sizeof world.instance[0].m);
    assert_int_equal(world_boxes_make(&world, WORLD_BOXES_AUTO, &box, &reason), STATUS_LIMIT);
    assert_string_equal(reason.text, "instance 0: its triangles reach beyond float32");
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(coordinates_of_all_sizes),
        cmocka_unit_test(coordinates_that_cancel),
        cmocka_unit_test(coordinates_that_only_integers_tell),
        cmocka_unit_test(coordinates_beyond_float32),
        cmocka_unit_test(boxes_of_vertices_are_the_least),
        cmocka_unit_test(boxes_of_corners_contain_those_of_vertices),
        cmocka_unit_test(boxes_of_triangles_are_the_least),
        cmocka_unit_test(exact_places_have_exact_boxes),
        cmocka_unit_test(what_no_ray_meets_has_no_box),
    };
    return cmocka_run_group_tests_name("world_boxes", tests, NULL, NULL);
}
