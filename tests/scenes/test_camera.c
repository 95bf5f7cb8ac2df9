#include "scenes/render/camera.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static void assert_vector(const float v[3], double x, double y, double z)
{
    const double expected[3] = {x, y, z};
    for (int k = 0; k < 3; k++)
        if (!(fabs((double)v[k] - expected[k]) <= 1e-6))
            fail_msg("(%g %g %g) is not (%g %g %g)", (double)v[0], (double)v[1], (double)v[2], x, y,
                     z);
}

static void camera_published_is_neither_unit_nor_upright(void **state)
{
    (void)state;
    const struct camera camera = {.pos = {1, 8, 5}, .at = {1, 5, 1}};
    struct view view = camera_view(&camera, PROFILE_RTRS, 400, 100);
    assert_vector(view.pos, 1, 8, 5);
    assert_vector(view.forward, 0, -0.6, -0.8);
    assert_vector(view.right, 0.8, 0, 0); /* forward x (0, 1, 0), whatever the aspect */
    assert_vector(view.up, 0, 1, 0);
    assert_true(view.centre == 0);
}

static void camera_repaired_has_square_pixels(void **state)
{
    (void)state;
    const struct camera camera = {.pos = {1, 8, 5}, .at = {1, 5, 1}};
    struct view view = camera_view(&camera, PROFILE_REPAIRED, 400, 100);
    assert_vector(view.forward, 0, -0.6, -0.8);
    assert_vector(view.right, 4, 0, 0);
    assert_vector(view.up, 0, 0.8, -0.6);
    assert_true(view.centre == 0.5f);
    view = camera_view(&camera, PROFILE_REPAIRED, 100, 400);
    assert_vector(view.right, 0.25, 0, 0);
}

static void camera_looks_straight_down_and_at_itself(void **state)
{
    (void)state;
    const struct camera down = {.pos = {2, 9, 3}, .at = {2, 1, 3}};
    struct view view = camera_view(&down, PROFILE_REPAIRED, 64, 64);
    assert_vector(view.forward, 0, -1, 0);
    assert_vector(view.right, -1, 0, 0); /* up is +z: forward x up */
    assert_vector(view.up, 0, 0, 1);
    const struct camera none = {.pos = {2, 9, 3}, .at = {2, 9, 3}};
    for (enum profile profile = PROFILE_REPAIRED; profile <= PROFILE_RTRS; profile++) {
        view = camera_view(&none, profile, 64, 64);
        assert_vector(view.forward, 0, 0, -1);
        assert_vector(view.right, 1, 0, 0);
        assert_vector(view.up, 0, 1, 0);
    }
}

static void camera_orbit_turns_from_x_to_z(void **state)
{
    (void)state;
    const struct camera camera = {.pos = {0.1f, 7, -9.3f}, .at = {0.1f - 5, 2, -9.3f}};
    const double quarter = acos(0.0);
    struct camera turned = camera_orbit(&camera, quarter);
    assert_vector(turned.pos, (double)camera.at[0], 7, (double)camera.at[2] + 5);
    assert_vector(turned.at, (double)camera.at[0], 2, (double)camera.at[2]);
    turned = camera_orbit(&camera, -quarter);
    assert_vector(turned.pos, (double)camera.at[0], 7, (double)camera.at[2] - 5);
    turned = camera_orbit(&camera, 0);
    for (int k = 0; k < 3; k++)
        assert_true(turned.pos[k] == camera.pos[k]); /* to the bit */
    for (int i = 0; i < 1000; i++) {
        turned = camera_orbit(&camera, 0.1 * i);
        double x = (double)turned.pos[0] - (double)camera.at[0];
        double z = (double)turned.pos[2] - (double)camera.at[2];
        assert_true(fabs(hypot(x, z) - 5) < 2e-6);
    }
}

/* One triangle between two corners of a box, and a vertex far away that no triangle has. */
static struct camera camera_of_box(const float lo[3], const float hi[3], uint32_t tris)
{
    struct scene scene;
    assert_int_equal(scene_make(4, 1, &scene), STATUS_OK);
    for (int k = 0; k < 3; k++) {
        scene.vertex[k] = hi[k];
        scene.vertex[3 + k] = lo[k];
        scene.vertex[6 + k] = k == 1 ? hi[k] : lo[k];
        scene.vertex[9 + k] = -1000;
        scene.index[k] = (uint32_t)k;
    }
    scene.tri_count = tris;
    struct camera camera = scene_camera(&scene);
    scene_free(&scene);
    return camera;
}

/* It looks at the middle, from as far as the longest side is long. */
static void camera_of_a_scene_without_one(void **state)
{
    (void)state;
    static const float size[][3] = {{4, 2, 1}, {1, 6, 2}, {2, 1, 8},
                                    {3, 3, 3}, {0, 0, 5}, {2, 0, 0}};
    static const float lo[] = {-3, 5, 0.5f}, zero[] = {0, 0, 0}, one[] = {1, 1, 1};
    for (size_t i = 0; i < sizeof size / sizeof *size; i++) {
        float hi[3];
        double middle[3], longest = 0;
        for (int k = 0; k < 3; k++) {
            hi[k] = lo[k] + size[i][k];
            middle[k] = (double)lo[k] + (double)size[i][k] / 2;
            longest = fmax(longest, (double)size[i][k]);
        }
        struct camera camera = camera_of_box(lo, hi, 1);
        assert_true(camera.orbit);
        assert_vector(camera.at, middle[0], middle[1], middle[2]);
        assert_vector(camera.pos, middle[0] + longest, middle[1] + 0.7 * longest,
                      middle[2] + 1.3 * longest);
    }
    struct camera point = camera_of_box(one, one, 1), empty = camera_of_box(zero, one, 0);
    assert_vector(point.at, 1, 1, 1);
    assert_vector(point.pos, 2, 1.7, 2.3);
    assert_vector(empty.at, 0, 0, 0);
    assert_vector(empty.pos, 2, 1.4, 2.6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(camera_published_is_neither_unit_nor_upright),
        cmocka_unit_test(camera_repaired_has_square_pixels),
        cmocka_unit_test(camera_looks_straight_down_and_at_itself),
        cmocka_unit_test(camera_orbit_turns_from_x_to_z),
        cmocka_unit_test(camera_of_a_scene_without_one),
    };
    return cmocka_run_group_tests_name("camera", tests, NULL, NULL);
}
