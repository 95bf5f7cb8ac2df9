/* Shadow rays: each begins 1e-4 of the scene before its hit, ends in the light, and has the place
 * in the order of its hit. */
#include "bench/measure/shadow_rays.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

enum { COUNT = 23 };

/* A scene of these bounds whose light is `light`, or that has none. */
static struct scene box_of(const float lo[3], const float hi[3], const float *light)
{
    struct scene scene;
    assert_int_equal(scene_make(6, 2, &scene), STATUS_OK);
    for (uint32_t i = 0; i < 6; i++) {
        scene.index[i] = i;
        for (uint32_t k = 0; k < 3; k++)
            scene.vertex[3 * i + k] = i % 2 ? hi[k] : lo[k];
    }
    if (light) {
        scene.light = alloc_zeroed(2, sizeof *scene.light);
        assert_non_null(scene.light);
        scene.light_count = 2;
        for (int k = 0; k < 3; k++)
            scene.light[0].pos[k] = light[k];
    }
    return scene;
}

/* Rays in many directions and of many lengths; every third has no hit. */
static size_t make_rays(struct ray *ray, struct hit *hit)
{
    size_t hits = 0;
    for (int i = 0; i < COUNT; i++) {
        float f = (float)i;
        ray[i] = (struct ray){{f - 9, 5 - f / 2, f / 4}, 0, {1 + f, 2 - f, f / 8 - 1}, 1e30f};
        hit[i] = (struct hit){0.25f + f / 16, 0, 0, i % 3 == 1 ? ABI_NO_PRIM : (uint32_t)i};
        hits += hit[i].prim != ABI_NO_PRIM;
    }
    return hits;
}

static void check(const struct ray *from, const struct hit *hit, const struct ray *to,
                  const double light[3], double lift)
{
    double back = 0, length = 0, sideways = 0;
    for (int k = 0; k < 3; k++) {
        double at = (double)from->org[k] + (double)hit->t * (double)from->dir[k];
        length += (double)from->dir[k] * (double)from->dir[k];
        back += (at - (double)to->org[k]) * (double)from->dir[k];
        if (!(fabs((double)to->org[k] + (double)to->dir[k] - light[k]) < 1e-4))
            fail_msg("does not end in the light: %g", (double)to->org[k] + (double)to->dir[k]);
    }
    back /= sqrt(length);
    for (int k = 0; k < 3; k++) {
        double at = (double)from->org[k] + (double)hit->t * (double)from->dir[k];
        sideways += fabs(at - back * (double)from->dir[k] / sqrt(length) - (double)to->org[k]);
    }
    if (!(fabs(back - lift) < 0.02 * lift && sideways < 0.02 * lift))
        fail_msg("%g before the hit, not %g; %g beside", back, lift, sideways);
    assert_true(fabsf(to->tmin) <= 0 && fabsf(to->tmax - 1) <= 0);
}

static void every_ray_goes_from_its_hit_to_the_light(void **state)
{
    (void)state;
    static const float place[3] = {7, 30, -8};
    static const struct {
        float lo[3], hi[3];
        double side;
    } boxes[] = {{{0, 0, 0}, {40, 9, 3}, 40},
                 {{-20, -50, 1}, {1, 40, 2}, 90},
                 {{2, 2, -30}, {3, 4, 170}, 200}};
    for (size_t i = 0; i < 2 * ARRAY_COUNT(boxes); i++) {
        const float *lo = boxes[i / 2].lo, *hi = boxes[i / 2].hi;
        double light[3], side = boxes[i / 2].side;
        struct scene scene = box_of(lo, hi, i % 2 ? place : NULL);
        struct ray ray[COUNT], out[COUNT];
        struct hit hit[COUNT];
        struct reason reason;
        for (int k = 0; k < 3; k++)
            light[k] = i % 2 ? (double)place[k]
                             : ((double)lo[k] + (double)hi[k]) / 2 + (k == 1 ? 2 : 0.7) * side;
        size_t hits = make_rays(ray, hit), at = 0;
        assert_int_equal(shadow_rays_make(&scene, ray, hit, COUNT, out, &reason), STATUS_OK);
        for (size_t k = 0; k < COUNT; k++)
            if (hit[k].prim != ABI_NO_PRIM)
                check(&ray[k], &hit[k], &out[at++], light, 1e-4 * side);
        assert_int_equal(at, hits);
        for (size_t k = hits; k < COUNT; k++) /* again from the first */
            assert_memory_equal(&out[k], &out[k % hits], sizeof *out);
        scene_free(&scene);
    }
}

static void no_hits_have_no_shadow_rays(void **state)
{
    (void)state;
    static const float lo[3] = {0, 0, 0}, hi[3] = {1, 1, 1};
    struct scene scene = box_of(lo, hi, NULL);
    struct ray ray[COUNT], out[COUNT];
    struct hit hit[COUNT];
    struct reason reason;
    make_rays(ray, hit);
    for (int i = 0; i < COUNT; i++)
        hit[i].prim = ABI_NO_PRIM;
    assert_int_equal(shadow_rays_make(&scene, ray, hit, COUNT, out, &reason), STATUS_INPUT);
    hit[COUNT - 1].prim = 0; /* one is enough */
    assert_int_equal(shadow_rays_make(&scene, ray, hit, COUNT, out, &reason), STATUS_OK);
    for (int i = 1; i < COUNT; i++)
        assert_memory_equal(&out[i], &out[0], sizeof *out);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_ray_goes_from_its_hit_to_the_light),
        cmocka_unit_test(no_hits_have_no_shadow_rays),
    };
    return cmocka_run_group_tests_name("shadow_rays", tests, NULL, NULL) ? 1 : 0;
}
