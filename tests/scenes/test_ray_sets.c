/* What each ray set aims at. */
#include "tests/support/ray_fixture.h"

#include <float.h>
#include <math.h>
#include <string.h>

static float extent_of(const struct scene *scene)
{
    struct box box = scene_bounds(scene);
    float extent = 0;
    for (int k = 0; k < 3; k++)
        extent = fmaxf(extent, box.hi[k] - box.lo[k]);
    return extent;
}

/* Distance of where a ray was aimed (t = 1) from the nearest vertex, largest component. */
static float vertex_distance(const struct scene *scene, const struct ray *ray)
{
    float best = FLT_MAX;
    for (uint32_t v = 0; v < scene->vertex_count; v++) {
        float far = 0;
        for (int k = 0; k < 3; k++)
            far = fmaxf(
                far, fabsf(ray->org[k] + ray->dir[k] - scene->vertex[3 * (size_t)v + (size_t)k]));
        best = fminf(best, far);
    }
    return best;
}

static bool is_inside(const struct box *box, const float p[3])
{
    for (int k = 0; k < 3; k++)
        if (p[k] < box->lo[k] || p[k] > box->hi[k])
            return false;
    return true;
}

static void vertices_are_hit_exactly_and_with_jitter(void **state)
{
    (void)state;
    struct scene scene = default_scene("grid");
    struct box box = scene_bounds(&scene);
    static struct ray ray[COUNT];
    size_t inside = 0, small = 0, large = 0;
    make_rays("vertices", &scene, 2, COUNT, ray);
    for (size_t i = 0; i < COUNT; i++) {
        float far = vertex_distance(&scene, &ray[i]) / extent_of(&scene);
        inside += is_inside(&box, ray[i].org);
        if (i % 3 == 0) {
            assert_true(far == 0); /* a lattice and a snapped origin: no rounding at all */
            struct hit hit = brute(&scene, &ray[i]);
            assert_true(hit.prim != ABI_NO_PRIM && hit.t <= 1);
        } else if (i % 3 == 1) {
            assert_true(far < 2e-6f);
            small += far > 1e-7f;
        } else {
            assert_true(far < 1.1e-3f);
            large += far > 1e-4f;
        }
    }
    assert_in_range(inside, COUNT / 3, COUNT * 2 / 3);
    assert_true(small > COUNT / 4 && large > COUNT / 4);
    scene_free(&scene);
}

static void edges_are_hit_on_their_middles_too(void **state)
{
    (void)state;
    struct scene scene = default_scene("grid");
    static struct ray ray[COUNT];
    size_t middles = 0, between = 0;
    make_rays("edges", &scene, 2, COUNT, ray);
    for (size_t i = 0; i < COUNT; i += 3) {
        bool half = false, other = false;
        for (int k = 0; k < 2; k++) { /* x or y of a lattice edge's middle is half an integer */
            float twice = 2 * (ray[i].org[k] + ray[i].dir[k]);
            half = half || (floorf(twice) == twice && floorf(twice / 2) != twice / 2);
            other = other || floorf(twice) != twice;
        }
        middles += half && !other;
        between += other;
        struct hit hit = brute(&scene, &ray[i]);
        if (half && !other)
            assert_true(hit.prim != ABI_NO_PRIM && hit.t <= 1);
    }
    assert_true(middles > COUNT / 20 && between > COUNT / 6);
    scene_free(&scene);
}

static void corners_are_met_by_a_third(void **state)
{
    (void)state;
    struct scene scene = default_scene("grid");
    struct box box = scene_bounds(&scene);
    static struct ray ray[COUNT];
    size_t of_scene = 0, faces = 0;
    make_rays("corners", &scene, 2, COUNT, ray);
    for (size_t i = 0; i < COUNT; i += 3) {
        int ends = 0;
        for (int k = 0; k < 3; k++) {
            float x = ray[i].org[k] + ray[i].dir[k];
            ends += x == box.lo[k] || x == box.hi[k];
        }
        of_scene += ends == 3;
        faces += ends > 0;
    }
    assert_true(of_scene > COUNT / 40 && faces > COUNT / 12);
    scene_free(&scene);
}

static void axis_rays_have_zeros_of_both_signs(void **state)
{
    (void)state;
    struct scene scene = default_scene("grid");
    struct box box = scene_bounds(&scene);
    static struct ray ray[COUNT];
    size_t zeros[2] = {0, 0}, along[3][2] = {{0}}, planar = 0, border[3][2] = {{0}}, lattice = 0;
    make_rays("axis", &scene, 2, COUNT, ray);
    for (size_t i = 0; i < COUNT; i++) {
        int nonzero = 0;
        bool whole = true;
        for (int k = 0; k < 3; k++) {
            if (ray[i].dir[k] == 0) {
                zeros[signbit(ray[i].dir[k]) ? 1 : 0]++;
                whole = whole && floorf(ray[i].org[k]) == ray[i].org[k];
                border[k][0] += ray[i].org[k] == box.lo[k];
                border[k][1] += ray[i].org[k] == box.hi[k];
            } else {
                nonzero++;
                along[k][ray[i].dir[k] < 0]++;
            }
        }
        assert_in_range(nonzero, 1, 2);
        planar += nonzero == 2;
        lattice += whole;
    }
    assert_true(zeros[0] > COUNT / 2 && zeros[1] > COUNT / 2);
    assert_in_range(planar, COUNT / 20, COUNT / 5);
    assert_true(lattice > COUNT / 2);
    for (int k = 0; k < 3; k++)
        for (int end = 0; end < 2; end++)
            assert_true(along[k][end] > COUNT / 12 && border[k][end] > COUNT / 30);
    scene_free(&scene);
}

static void ranges_end_exactly_at_hits(void **state)
{
    (void)state;
    struct scene scene = default_scene("grid");
    static struct ray ray[COUNT];
    size_t at_tmin = 0, at_tmax = 0, only = 0, just_missed = 0, at_zero = 0, beyond = 0;
    make_rays("ranges", &scene, 2, COUNT, ray);
    for (size_t i = 0; i < COUNT; i++) {
        struct hit hit = brute(&scene, &ray[i]);
        bool any = hit.prim != ABI_NO_PRIM;
        at_tmin += any && hit.t == ray[i].tmin && ray[i].tmin == 1;
        at_tmax += any && hit.t == ray[i].tmax && ray[i].tmax == 1;
        only += any && ray[i].tmin == ray[i].tmax && ray[i].tmin > 0;
        at_zero += any && hit.t == 0 && ray[i].tmax == 0;
        beyond += ray[i].tmin == 1 + FLT_EPSILON || ray[i].tmax == 1 - FLT_EPSILON / 2;
        struct ray wider = ray[i];
        wider.tmin = nextafterf(ray[i].tmin, 0);
        wider.tmax = nextafterf(ray[i].tmax, INFINITY);
        just_missed += !any && brute(&scene, &wider).prim != ABI_NO_PRIM;
    }
    assert_true(at_tmin > COUNT / 20 && at_tmax > COUNT / 20 && only > COUNT / 40);
    assert_true(beyond > COUNT / 10);
    assert_true(just_missed > COUNT / 40 && at_zero > COUNT / 40);
    scene_free(&scene);
}

static void primaries_fill_the_picture(void **state)
{
    (void)state;
    struct scene scene = default_scene("cornell"); /* camera (0, 0, 3) towards (0, 0, 0) */
    struct ray ray[16];
    make_rays("primary", &scene, 1, 16, ray);
    for (int i = 0; i < 16; i++) {
        float nx = ((float)(i % 4) + 0.5f) / 4 - 0.5f, ny = ((float)(i / 4) + 0.5f) / 4 - 0.5f;
        assert_true(ray[i].org[0] == 0 && ray[i].org[1] == 0 && ray[i].org[2] == 3);
        assert_true(fabsf(ray[i].dir[0] / -ray[i].dir[2] - nx) < 1e-6f);
        assert_true(fabsf(ray[i].dir[1] / -ray[i].dir[2] - ny) < 1e-6f);
    }
    static const float downwards[][2][3] = {{{0, 5, 0}, {0, 0, 0}}, {{0, 0, 0}, {0, 0, 0}}};
    for (size_t c = 0; c < ARRAY_COUNT(downwards); c++) { /* no right, no direction */
        memcpy(scene.camera.pos, downwards[c][0], sizeof scene.camera.pos);
        memcpy(scene.camera.at, downwards[c][1], sizeof scene.camera.at);
        make_rays("primary", &scene, 1, 16, ray);
        for (int i = 0; i < 16; i++)
            for (int j = 0; j < i; j++)
                assert_memory_not_equal(ray[i].dir, ray[j].dir, sizeof ray[i].dir);
    }
    scene_free(&scene);
}

static void a_camera_out_of_this_world_is_refused(void **state)
{
    (void)state;
    static const float wrong[] = {NAN, INFINITY, 1e13f};
    struct scene scene = default_scene("cornell");
    for (size_t i = 0; i < ARRAY_COUNT(wrong); i++) {
        static const char *const sets[] = {"primary", "bounce", "mixed"};
        scene.camera.pos[1] = wrong[i];
        for (size_t s = 0; s < ARRAY_COUNT(sets); s++) {
            struct ray ray[9];
            struct reason reason = {""};
            assert_int_equal(ray_set_make(ray_set_find(sets[s]), &scene, 1, 9, ray, &reason),
                             STATUS_INPUT);
            assert_non_null(strstr(reason.text, "camera: coordinate y"));
        }
    }
    scene_free(&scene);
}

/* A flat floor seen from above: every bounce goes up, and the mean of the cosine is 2/3. */
static void bounces_are_distributed_by_the_cosine(void **state)
{
    (void)state;
    static struct ray ray[12000];
    struct scene scene = default_scene("grid");
    for (uint32_t v = 0; v < scene.vertex_count; v++)
        scene.vertex[3 * (size_t)v + 2] = 0;
    double sum = 0, square = 0;
    size_t lifted = 0;
    make_rays("bounce", &scene, 2, ARRAY_COUNT(ray), ray);
    for (size_t i = 0; i < ARRAY_COUNT(ray); i++) {
        double z = (double)ray[i].dir[2];
        assert_true(z > 0 && fabsf(ray[i].org[0]) < 16.1f && fabsf(ray[i].org[1]) < 16.1f);
        assert_true(ray[i].org[2] > -1e-4f && ray[i].org[2] < 0.04f);
        lifted += ray[i].org[2] > 0.03f;
        sum += z;
        square += z * z;
    }
    assert_int_equal(lifted, ARRAY_COUNT(ray) / 2);
    assert_true(fabs(sum / (double)ARRAY_COUNT(ray) - 2.0 / 3.0) < 0.01);
    assert_true(fabs(square / (double)ARRAY_COUNT(ray) - 0.5) < 0.01);
    scene_free(&scene);
}

static void bounces_start_on_primary_hits(void **state)
{
    (void)state;
    static struct ray ray[COUNT];
    struct scene scene = default_scene("sphere");
    struct camera camera = scene_camera(&scene);
    make_rays("bounce", &scene, 2, COUNT, ray);
    for (size_t i = 0; i < COUNT; i++) {
        double length = 0, facing = 0, out = 0;
        for (int k = 0; k < 3; k++) {
            length += (double)ray[i].org[k] * (double)ray[i].org[k];
            facing += (double)ray[i].org[k] * (double)(camera.pos[k] - ray[i].org[k]);
            out += (double)ray[i].org[k] * (double)ray[i].dir[k];
        }
        assert_true(fabs(length - 1) < 0.02); /* on the sphere */
        assert_true(facing > -0.2);           /* on the camera's side */
        assert_true(out > -0.2);              /* away from the face */
    }
    scene_free(&scene);
}

static void bounces_find_the_scene_behind_the_camera(void **state)
{
    (void)state;
    static struct ray ray[COUNT];
    struct scene scene = default_scene("cornell");
    scene.camera.at[2] = 6; /* away from the room */
    make_rays("bounce", &scene, 2, COUNT, ray);
    for (size_t i = 0; i < COUNT; i++)
        assert_true(fabsf(ray[i].org[0]) < 1.01f && fabsf(ray[i].org[2]) < 1.01f);
    scene_free(&scene);
}

static void nothing_to_bounce_from_is_said(void **state)
{
    (void)state;
    struct scene scene;
    struct ray ray[64], random[8];
    struct reason reason = {""};
    assert_int_equal(scene_make(3, 1, &scene), STATUS_OK); /* a point */
    assert_int_equal(ray_set_make(ray_set_find("bounce"), &scene, 1, 64, ray, &reason),
                     STATUS_INPUT);
    assert_non_null(strstr(reason.text, "nothing to bounce from"));
    make_rays("mixed", &scene, 1, 64, ray);
    make_rays("random", &scene, 1, 8, random);
    for (size_t i = 0; i < 64; i++)
        assert_true(ray_in_contract(&ray[i]));
    assert_memory_not_equal(&ray[6], &random[0], sizeof *ray); /* in the place of a bounce */
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vertices_are_hit_exactly_and_with_jitter),
        cmocka_unit_test(edges_are_hit_on_their_middles_too),
        cmocka_unit_test(corners_are_met_by_a_third),
        cmocka_unit_test(axis_rays_have_zeros_of_both_signs),
        cmocka_unit_test(ranges_end_exactly_at_hits),
        cmocka_unit_test(primaries_fill_the_picture),
        cmocka_unit_test(a_camera_out_of_this_world_is_refused),
        cmocka_unit_test(bounces_are_distributed_by_the_cosine),
        cmocka_unit_test(bounces_start_on_primary_hits),
        cmocka_unit_test(bounces_find_the_scene_behind_the_camera),
        cmocka_unit_test(nothing_to_bounce_from_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
