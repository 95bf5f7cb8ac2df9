/* Grids that scenes are moved onto: what holds of one axis holds of each. */
#include "ref/scene/quantise.h"
#include "scenes/scenes.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static struct scene soup(void)
{
    struct scene scene;
    struct reason reason = {""};
    if (scene_open("soup:n=100", 3, &scene, &reason))
        fail_msg("%s", reason.text);
    return scene;
}

/* Every coordinate has a code of the grid's bits. */
static void must_be_on_grid(const struct scene *scene, const struct grid *grid)
{
    for (uint32_t i = 0; i < 3 * scene->vertex_count; i++) {
        const long double n = (long double)scene->vertex[i] / grid->step[i % 3] - grid->lo[i % 3];
        assert_true(n == floorl(n) && n >= 0 && n < (1u << grid->bits));
    }
}

/* The least step with which numbers of an axis fit: half of it is too fine. */
static bool half_is_too_fine(const struct scene *scene, int k, long double step, uint32_t bits,
                             long double limit)
{
    long double least = INFINITY, most = -INFINITY;
    for (uint32_t i = 0; i < scene->vertex_count; i++) {
        const long double n = floorl(scene->vertex[3 * (size_t)i + (size_t)k] / (step / 2) + 0.5L);
        least = fminl(least, n);
        most = fmaxl(most, n);
    }
    return most - least > (1u << bits) - 1 || most > limit || least < -limit || step / 2 < FLT_MIN;
}

/* Axes of other extents, in every order: none is another than the others, with one step for all
 * or one each; and no step is larger than it must be. */
static void no_axis_is_another(void **state)
{
    (void)state;
    static const size_t order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                       {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    static const float stretch[] = {1, 0x1p-7f, 0x1.8p5f}, shift[] = {3, -0.125f, -4000};
    struct scene base = soup();
    for (uint32_t i = 0; i < 3 * base.vertex_count; i++)
        base.vertex[i] = base.vertex[i] * stretch[i % 3] + shift[i % 3];
    for (uint32_t n = 0; n < 6 * 2 * 14; n++) {
        const size_t *to = order[n % 6];
        const bool even = n / 6 % 2;
        const uint32_t bits = QUANTISE_BITS_LEAST + n / 12;
        struct scene turned = soup(), out, want;
        struct quantised q, of_base;
        for (uint32_t i = 0; i < 3 * base.vertex_count; i++)
            turned.vertex[i - i % 3 + to[i % 3]] = base.vertex[i];
        assert_int_equal(
            (even ? scene_quantise_even : scene_quantise)(&base, bits, &want, &of_base, NULL),
            STATUS_OK);
        assert_int_equal(
            (even ? scene_quantise_even : scene_quantise)(&turned, bits, &out, &q, NULL),
            STATUS_OK);
        must_be_on_grid(&out, &q.grid);
        for (uint32_t i = 0; i < 3 * base.vertex_count; i++)
            assert_true(out.vertex[i - i % 3 + to[i % 3]] == want.vertex[i]);
        bool needed = false;
        for (size_t k = 0; k < 3; k++) {
            assert_true(q.grid.step[to[k]] == of_base.grid.step[k]);
            assert_int_equal(q.grid.lo[to[k]], of_base.grid.lo[k]);
            assert_true(q.moved[to[k]] == of_base.moved[k]);
            assert_true(!even || q.grid.step[k] == q.grid.step[0]);
            const bool fine = half_is_too_fine(&base, (int)k, of_base.grid.step[k], bits,
                                               even ? EVEN_MOST : GRID_MOST);
            assert_true(even || fine);
            needed = needed || fine;
        }
        assert_true(needed);
        scene_free(&out);
        scene_free(&want);
        scene_free(&turned);
    }
    scene_free(&base);
}

/* Of no vertex and no axis: a grid has one zero. */
static void a_negative_zero_is_on_no_grid(void **state)
{
    (void)state;
    struct scene scene = soup();
    struct grid grid;
    for (uint32_t i = 0; i < 3 * scene.vertex_count; i++)
        scene.vertex[i] = floorf(scene.vertex[i] * 64);
    assert_int_equal(grid_of_scene(&scene, &grid, NULL), STATUS_OK);
    for (uint32_t i = 0; i < 3 * scene.vertex_count; i++) {
        const float was = scene.vertex[i];
        struct reason reason = {""};
        char want[64];
        scene.vertex[i] = -0.0f;
        assert_int_equal(grid_of_scene(&scene, &grid, &reason), STATUS_LIMIT);
        snprintf(want, sizeof want, "the scene's %c coordinates lie on no grid of", "xyz"[i % 3]);
        assert_int_equal(strncmp(reason.text, want, strlen(want)), 0);
        scene.vertex[i] = was;
    }
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(no_axis_is_another),
                                       cmocka_unit_test(a_negative_zero_is_on_no_grid)};
    return cmocka_run_group_tests_name("axes of grids", tests, NULL, NULL);
}
