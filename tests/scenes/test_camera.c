#include "scenes/render/camera.h"
#include "scenes/scenes.h"

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

/* Where the picture has p, as the ray of a pixel is defined: -0.5 to 0.5 from left to right, from
 * bottom to top. */
static void place_of(const struct view *view, const float p[3], double place[2])
{
    double right = 0, length = 0, up = 0, forward = 0, slant = 0;
    for (int k = 0; k < 3; k++) {
        double x = (double)p[k] - (double)view->pos[k];
        right += x * (double)view->right[k];
        length += (double)view->right[k] * (double)view->right[k];
        up += x * (double)view->up[k];
        forward += x * (double)view->forward[k];
        slant += (double)view->up[k] * (double)view->forward[k];
    }
    double far = (forward - slant * up) / (1 - slant * slant);
    assert_true(far > 0);
    place[0] = right / length / far;
    place[1] = (up - slant * far) / far;
}

struct seen_extent {
    double lo[2], hi[2];
};

static struct seen_extent extent_of(const struct scene *scene, const struct view *view)
{
    struct seen_extent e = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
    for (size_t i = 0; i < 3 * (size_t)scene->tri_count; i++) {
        double place[2];
        place_of(view, scene->vertex + 3 * (size_t)scene->index[i], place);
        for (int k = 0; k < 2; k++) {
            e.lo[k] = fmin(e.lo[k], place[k]);
            e.hi[k] = fmax(e.hi[k], place[k]);
        }
    }
    return e;
}

static const char *const models[] = {
    "soup",     "soup:offset=1000", "sphere:n=6",       "flake:n=2", "terrain:k=4",
    "grid:n=6", "platonic",         "platonic:which=3", "needles",   "stack"};
static const uint32_t shapes[][2] = {{160, 120}, {120, 160}, {400, 50}};

static struct scene model_open(const char *spec)
{
    struct scene scene;
    struct reason reason;
    assert_int_equal(scene_open(spec, 1, &scene, &reason), STATUS_OK);
    return scene;
}

/* A model fills 80 % of the width or of the height, in the middle of that side, and no more of the
 * other. */
static void camera_frames_the_model(void **state)
{
    (void)state;
    for (size_t m = 0; m < ARRAY_COUNT(models); m++) {
        struct scene scene = model_open(models[m]);
        for (size_t s = 0; s < 2 * ARRAY_COUNT(shapes); s++) {
            enum profile profile = s % 2 ? PROFILE_RTRS : PROFILE_REPAIRED;
            const uint32_t *size = shapes[s / 2];
            struct camera camera =
                camera_of_scene(&scene, FRAMING_MODEL, profile, size[0], size[1]);
            struct view view = camera_view(&camera, profile, size[0], size[1]);
            struct seen_extent e = extent_of(&scene, &view);
            double share[2] = {e.hi[0] - e.lo[0], e.hi[1] - e.lo[1]};
            int side = share[1] > share[0];
            if (!(fabs(share[side] - 0.8) < 0.002 && fabs(e.hi[side] - 0.4) < 0.001))
                fail_msg("%s %u x %u: %g of the width, %g of the height", models[m], size[0],
                         size[1], share[0], share[1]);
            assert_true(e.lo[!side] > -0.401 && e.hi[!side] < 0.401);
            assert_true(camera.orbit);
        }
        scene_free(&scene);
    }
}

/* A turn shows the whole model all the time, and a sphere as large as a single picture. */
static void camera_frames_a_turn(void **state)
{
    (void)state;
    for (size_t m = 0; m < ARRAY_COUNT(models); m++) {
        struct scene scene = model_open(models[m]);
        const struct camera camera =
            camera_of_scene(&scene, FRAMING_TURN, PROFILE_REPAIRED, 160, 120);
        double most = 0;
        for (int i = 0; i < 36; i++) {
            struct camera turned = camera_orbit(&camera, i * acos(-1.0) / 18);
            struct view view = camera_view(&turned, PROFILE_REPAIRED, 160, 120);
            struct seen_extent e = extent_of(&scene, &view);
            for (int k = 0; k < 2; k++)
                most = fmax(most, fmax(-e.lo[k], e.hi[k]));
        }
        if (!(most < 0.401 && most > 0.25))
            fail_msg("%s: %g of half a picture", models[m], 2 * most);
        scene_free(&scene);
    }
}

/* A scene's own camera stays. Benchmarks have scene_camera's, and so has a scene without size. */
static void camera_of_the_scene_stays(void **state)
{
    (void)state;
    static const char *const own[] = {"cornell", "rtrs"};
    for (size_t i = 0; i < ARRAY_COUNT(own); i++) {
        struct scene scene = model_open(own[i]);
        for (int framing = FRAMING_MODEL; framing <= FRAMING_OVERVIEW; framing++) {
            struct camera camera =
                camera_of_scene(&scene, (enum framing)framing, PROFILE_REPAIRED, 64, 48);
            assert_memory_equal(&camera, &scene.camera, sizeof camera);
        }
        scene_free(&scene);
    }
    struct scene scene = model_open("sphere:n=6");
    struct camera far = scene_camera(&scene);
    struct camera shared = camera_of_scene(&scene, FRAMING_OVERVIEW, PROFILE_REPAIRED, 64, 48);
    assert_vector(shared.pos, (double)far.pos[0], (double)far.pos[1], (double)far.pos[2]);
    scene.tri_count = 0;
    far = scene_camera(&scene);
    struct camera empty = camera_of_scene(&scene, FRAMING_MODEL, PROFILE_REPAIRED, 64, 48);
    assert_vector(empty.pos, (double)far.pos[0], (double)far.pos[1], (double)far.pos[2]);
    for (size_t i = 0; i < 3; i++)
        for (size_t k = 0; k < 3; k++)
            scene.vertex[3 * (size_t)scene.index[i] + k] = 0.5f;
    scene.tri_count = 1;
    struct camera point = camera_of_scene(&scene, FRAMING_MODEL, PROFILE_REPAIRED, 64, 48);
    assert_vector(point.at, 0.5, 0.5, 0.5);
    assert_vector(point.pos, 1.5, 1.2, 1.8);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(camera_published_is_neither_unit_nor_upright),
        cmocka_unit_test(camera_repaired_has_square_pixels),
        cmocka_unit_test(camera_looks_straight_down_and_at_itself),
        cmocka_unit_test(camera_orbit_turns_from_x_to_z),
        cmocka_unit_test(camera_of_a_scene_without_one),
        cmocka_unit_test(camera_frames_the_model),
        cmocka_unit_test(camera_frames_a_turn),
        cmocka_unit_test(camera_of_the_scene_stays),
    };
    return cmocka_run_group_tests_name("camera", tests, NULL, NULL);
}
