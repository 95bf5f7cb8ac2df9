/* What each scene generator draws. */
#include "tests/scenes/generators.h"

#include <math.h>
#include <stdlib.h>

static int compare_u64(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

/* Directed edges, sorted. A surface is closed and consistently turned iff each occurs once and so
 * does its reverse. */
static void assert_closed(const struct scene *scene, int64_t euler)
{
    size_t count = 3 * (size_t)scene->tri_count;
    uint64_t *edge = malloc(count * sizeof *edge);
    assert_non_null(edge);
    for (size_t i = 0; i < count; i++) {
        uint64_t a = scene->index[i], b = scene->index[i % 3 == 2 ? i - 2 : i + 1];
        edge[i] = a << 32 | b;
    }
    qsort(edge, count, sizeof *edge, compare_u64);
    for (size_t i = 0; i < count; i++) {
        uint64_t reverse = edge[i] << 32 | edge[i] >> 32;
        assert_true(i == 0 || edge[i] != edge[i - 1]);
        assert_non_null(bsearch(&reverse, edge, count, sizeof *edge, compare_u64));
    }
    free(edge);
    assert_int_equal((int64_t)scene->vertex_count - (int64_t)count / 2 + scene->tri_count, euler);
}

/* Signed volume of triangles first .. first + count - 1: positive
 * when they face outward. */
static double volume(const struct scene *scene, uint32_t first, uint32_t count)
{
    double sum = 0;
    for (uint32_t i = first; i < first + count; i++) {
        float v[3][3];
        scene_tri(scene, i, v);
        for (int k = 0; k < 3; k++) {
            int a = (k + 1) % 3, b = (k + 2) % 3;
            sum += (double)v[0][k] * ((double)v[1][a] * v[2][b] - (double)v[1][b] * v[2][a]);
        }
    }
    return sum / 6;
}

static void sphere_is_closed_and_faces_outward(void **state)
{
    (void)state;
    static const uint32_t parts[] = {1, 2, 3, 16, 33};
    double before = 0;
    for (size_t i = 0; i < ARRAY_COUNT(parts); i++) {
        struct scene scene = make("sphere", SETTINGS({"n", parts[i]}, {"radius", 2}), 1);
        assert_int_equal(scene.tri_count, 8 * parts[i] * parts[i]);
        assert_closed(&scene, 2);
        for (uint32_t v = 0; v < scene.vertex_count; v++) {
            const float *p = scene.vertex + 3 * (size_t)v;
            assert_true(fabs(sqrt((double)p[0] * p[0] + (double)p[1] * p[1] + (double)p[2] * p[2]) -
                             2) < 2e-7);
        }
        for (uint32_t t = 0; t < scene.tri_count; t++)
            assert_true(volume(&scene, t, 1) > 0);
        double inside = volume(&scene, 0, scene.tri_count);
        assert_true(inside > before && inside < 33.5103217); /* 4/3 pi 2^3 */
        before = inside;
        scene_free(&scene);
    }
    assert_true(before > 33.4);
}

static void platonic_solids_are_closed_and_regular(void **state)
{
    (void)state;
    static const uint32_t vertices[] = {4, 8, 6, 20, 12}, tris[] = {4, 12, 8, 36, 20};
    static const double inside[] = {0.5132002, 1.5396007, 1.3333333, 2.7851639, 2.5361507};
    for (int which = 0; which < 5; which++) {
        struct scene scene = make("platonic", SETTINGS({"which", which}), 1);
        assert_int_equal(scene.vertex_count, vertices[which]);
        assert_int_equal(scene.tri_count, tris[which]);
        assert_closed(&scene, 2);
        assert_true(fabs(volume(&scene, 0, scene.tri_count) - inside[which]) < 1e-6);
        for (uint32_t v = 0; v < scene.vertex_count; v++) {
            const float *p = scene.vertex + 3 * (size_t)v;
            double length = sqrt((double)p[0] * p[0] + (double)p[1] * p[1] + (double)p[2] * p[2]);
            assert_true(fabs(length - 1) < 2e-7);
        }
        scene_free(&scene);
    }
    struct scene all = make("platonic", SETTINGS({"rows", 3}), 1);
    assert_int_equal(all.tri_count, 3 * 80);
    assert_closed(&all, 3 * 5 * 2);
    struct box box = scene_bounds(&all);
    assert_true(box.lo[0] > -6.01f && box.hi[0] < 6.01f && box.lo[2] == -box.hi[2]);
    scene_free(&all);
}

static void flake_is_closed_balls_in_a_closed_room(void **state)
{
    (void)state;
    for (uint32_t depth = 0, balls = 1; depth < 4; depth++, balls = 9 * balls + 1) {
        struct scene scene = make("flake", SETTINGS({"depth", depth}, {"n", 3}), 1);
        assert_int_equal(scene.tri_count, 12 + 72 * balls);
        assert_closed(&scene, 2 * ((int64_t)balls + 1));
        assert_true(fabs(volume(&scene, 0, 12) + 4.5 * 4.5 * 4.5) < 1e-6);
        for (uint32_t b = 0; b < balls; b++)
            assert_true(volume(&scene, 12 + 72 * b, 72) > 0);
        for (uint32_t v = 8; v < scene.vertex_count; v++) {
            const float *p = scene.vertex + 3 * (size_t)v;
            assert_true((double)p[0] * p[0] + (double)p[1] * p[1] + (double)p[2] * p[2] < 4);
        }
        scene_free(&scene);
    }
}

/* Balls touch their parents and keep apart from everybody else's children of the same size. */
static void flake_balls_do_not_meet(void **state)
{
    (void)state;
    struct scene scene = make("flake", SETTINGS({"depth", 2}, {"n", 1}), 1);
    double centre[91][3], radius[91];
    for (uint32_t b = 0; b < 91; b++) {
        const float *v = scene.vertex + 3 * (8 + 6 * (size_t)b); /* the ends of an axis: 0 and 5 */
        double length = 0;
        for (int k = 0; k < 3; k++) {
            centre[b][k] = 0.5 * (v[k] + v[15 + k]);
            length += ((double)v[k] - v[15 + k]) * ((double)v[k] - v[15 + k]);
        }
        radius[b] = 0.5 * sqrt(length);
    }
    uint32_t touching = 0;
    for (uint32_t a = 0; a < 91; a++)
        for (uint32_t b = 0; b < a; b++) {
            double square = 0;
            for (int k = 0; k < 3; k++)
                square += (centre[a][k] - centre[b][k]) * (centre[a][k] - centre[b][k]);
            double gap = sqrt(square) - radius[a] - radius[b];
            assert_true(gap > -1e-6);
            touching += gap < 1e-6;
        }
    assert_true(touching >= 90);
    scene_free(&scene);
}

static void grid_coordinates_are_exact_integers(void **state)
{
    (void)state;
    static const struct setting far[][5] = {
        {{NULL, 0}},
        {{"n", 7}, {"height", 1000000}, {"z", -8000000}, {"offset", 8000000}},
        {{"n", 1024}, {"height", 5}, {"z", 8000000}, {"offset", -8000000}},
    };
    for (size_t i = 0; i < ARRAY_COUNT(far); i++) {
        struct scene scene = make("grid", far[i], 1);
        for (size_t k = 0; k < 3 * (size_t)scene.vertex_count; k++)
            assert_true(floorf(scene.vertex[k]) == scene.vertex[k] &&
                        fabsf(scene.vertex[k]) < 0x1p24f);
        struct box box = scene_bounds(&scene);
        float n = i == 0 ? 32 : (float)far[i][0].value;
        assert_true(box.hi[0] - box.lo[0] == n && box.hi[1] - box.lo[1] == n);
        assert_true(box.hi[2] > box.lo[2]);
        scene_free(&scene);
    }
    struct scene flat = make("grid", SETTINGS({"n", 4}, {"height", 0}, {"z", -3}), 1);
    struct box box = scene_bounds(&flat);
    assert_true(box.lo[0] == -2 && box.hi[0] == 2 && box.lo[2] == -3 && box.hi[2] == -3);
    scene_free(&flat);
}

static void soup_stays_in_its_cube(void **state)
{
    (void)state;
    static const double sizes[] = {0, 0.1, 0.7, 1};
    for (size_t i = 0; i < ARRAY_COUNT(sizes); i++) {
        struct scene scene = make("soup", SETTINGS({"n", 20000}, {"size", sizes[i]}), 5);
        struct box box = scene_bounds(&scene);
        for (int k = 0; k < 3; k++) {
            assert_true(box.lo[k] >= -0.5f && box.lo[k] < -0.45f);
            assert_true(box.hi[k] <= 0.5f && box.hi[k] > 0.45f);
        }
        for (uint32_t t = 0; t < scene.tri_count; t++) {
            struct box one = scene_tri_bounds(&scene, t);
            for (int k = 0; k < 3; k++)
                assert_true(one.hi[k] - one.lo[k] <= (float)sizes[i] + 1e-7f);
        }
        scene_free(&scene);
    }
    struct scene near = make("soup", NULL, 5), far = make("soup", SETTINGS({"offset", 100}), 5);
    for (size_t k = 0; k < 3 * (size_t)near.vertex_count; k++)
        assert_true(far.vertex[k] == near.vertex[k] + 100);
    scene_free(&near);
    scene_free(&far);
}

static void terrain_is_a_graph_over_the_square(void **state)
{
    (void)state;
    double bumps[2] = {0, 0};
    for (int rough = 0; rough < 2; rough++) {
        struct scene scene = make("terrain", SETTINGS({"roughness", rough ? 0.9 : 0.3}), 1);
        for (uint32_t v = 0; v < scene.vertex_count; v++) {
            const float *p = scene.vertex + 3 * (size_t)v;
            assert_true(p[0] == (float)(v % 33) / 32 - 0.5f);
            assert_true(p[2] == 0.5f - (float)(v / 33) / 32);
            assert_true(v == 0 || p[1] != p[-2]);
            if (v % 33 > 1)
                bumps[rough] += fabs((double)p[1] - 2.0 * p[-2] + p[-5]);
        }
        for (uint32_t t = 0; t < scene.tri_count; t++) { /* seen from above: counter-clockwise */
            float w[3][3];
            scene_tri(&scene, t, w);
            assert_true((w[1][2] - w[0][2]) * (w[2][0] - w[0][0]) -
                            (w[1][0] - w[0][0]) * (w[2][2] - w[0][2]) >
                        0);
        }
        scene_free(&scene);
    }
    assert_true(bumps[1] > 4 * bumps[0]);
}

static void cornell_is_furnished(void **state)
{
    (void)state;
    struct scene scene = make("cornell", NULL, 1);
    assert_int_equal(scene.tri_count, 36);
    assert_int_equal(scene.material_count, 4);
    assert_int_equal(scene.light_count, 1);
    assert_true(scene.has_camera && scene.camera.pos[2] > 1);
    uint32_t used = 0;
    for (uint32_t i = 0; i < scene.tri_count; i++) {
        assert_in_range(scene.material_of[i], 0, scene.material_count - 1);
        used |= 1u << scene.material_of[i];
    }
    assert_int_equal(used, 15);
    struct box box = scene_bounds(&scene);
    for (int k = 0; k < 3; k++)
        assert_true(box.lo[k] == -1 && box.hi[k] == 1);
    /* The room faces inward, the lamp down, the blocks outward. */
    for (uint32_t i = 0; i < 10; i++)
        assert_true(volume(&scene, i, 1) < 0);
    assert_true(fabs(volume(&scene, 12, 12) - 0.625 * 0.625 * 1.25) < 1e-6);
    assert_true(fabs(volume(&scene, 24, 12) - 0.625 * 0.625 * 0.625) < 1e-6);
    struct scene fine = make("cornell", SETTINGS({"n", 5}), 1);
    assert_int_equal(fine.tri_count, 36 * 25);
    assert_true(fabs(volume(&fine, 300, 300) - 0.625 * 0.625 * 1.25) < 1e-6);
    scene_free(&scene);
    scene_free(&fine);
}

/* Length of the longest side and distance of the corner beside it. */
static void needles_are_as_thin_as_asked(void **state)
{
    (void)state;
    struct scene scene = make("needles", SETTINGS({"n", 100}, {"aspect", 1000}), 5);
    for (uint32_t i = 0; i < scene.tri_count; i++) {
        float v[3][3];
        double along[3], aside[3], length = 0, dot = 0, size = 0;
        scene_tri(&scene, i, v);
        for (int k = 0; k < 3; k++) {
            along[k] = (double)v[1][k] - (double)v[0][k];
            aside[k] = (double)v[2][k] - (double)v[0][k];
            length += along[k] * along[k];
            dot += along[k] * aside[k];
            size += aside[k] * aside[k];
        }
        double from_line = sqrt(fmax(size - dot * dot / length, 0)), at = dot / length;
        assert_true(sqrt(length) > 0.04 && sqrt(length) < 0.31);
        assert_true(from_line < 1.1e-3 * sqrt(length)); /* aside may lean along */
        assert_true(fabs(at - (i % 2 ? 0.5 : 1.0)) < 2e-3);
    }
    scene_free(&scene);
}

static void stack_repeats_each_triangle_in_its_plane(void **state)
{
    (void)state;
    struct scene scene = make("stack", SETTINGS({"n", 50}, {"copies", 3}, {"offset", 3}), 5);
    assert_int_equal(scene.tri_count, 150);
    for (uint32_t i = 0; i < scene.tri_count; i += 3) {
        const uint32_t *a = scene.index + 3 * (size_t)i;
        float v[3][3], w[3][3];
        assert_true(a[3] == a[1] && a[4] == a[0] && a[5] == a[2]); /* turned over */
        assert_true(a[6] == a[0]);
        scene_tri(&scene, i, v);
        scene_tri(&scene, i + 2, w);
        for (int c = 0; c < 3; c++) {
            assert_true(v[c][2] == v[0][2] && w[c][2] == v[0][2] &&
                        w[c][2] * 8 == floorf(w[c][2] * 8));
            for (int k = 0; k < 2 && c > 0; k++)
                assert_true(w[c][k] == 0.5f * (v[0][k] + v[c][k])); /* halved exactly */
        }
    }
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sphere_is_closed_and_faces_outward),
        cmocka_unit_test(platonic_solids_are_closed_and_regular),
        cmocka_unit_test(flake_is_closed_balls_in_a_closed_room),
        cmocka_unit_test(flake_balls_do_not_meet),
        cmocka_unit_test(grid_coordinates_are_exact_integers),
        cmocka_unit_test(soup_stays_in_its_cube),
        cmocka_unit_test(terrain_is_a_graph_over_the_square),
        cmocka_unit_test(cornell_is_furnished),
        cmocka_unit_test(needles_are_as_thin_as_asked),
        cmocka_unit_test(stack_repeats_each_triangle_in_its_plane),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
