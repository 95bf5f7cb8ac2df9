/* A closed mesh is closed on a tree, too: woop with the watertight box test loses no ray that woop
 * over all triangles does not lose. The robust box test does: what it pads shrinks with the
 * distance of the hit, and woop's rounding does not where a triangle reaches behind the origin. */
#include "ref/base/rng.h"
#include "ref/trace/trace.h"
#include "ref/twin/twin.h"

#include <math.h>
#include <stdlib.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/corridor.h"
#include "tests/support/trace_fixture.h"
#include "ref/primitives/test_run.h"

/* Is woop's t certain to lie in range? Where it is not, brute force is no better than a tree. */
static bool range_is_certain(const struct scene *scene, const struct ray *ray, const struct hit *h)
{
    float v[3][3];
    scene_tri(scene, h->prim, v);
    struct twin twin = twin_eval(TWIN_WOOP, ROUNDING_IEEE, ray, v);
    return (double)h->t - twin.t_err > (double)ray->tmin;
}

struct watertight_leaks {
    size_t rays, hits, robust, watertight;
};

/* Every ray is inside a closed mesh: a miss is a leak. */
static void count(const struct scene *scene, const struct packed *packed, const struct ray *ray,
                  struct watertight_leaks *leaks)
{
    const struct tri_test *woop = tri_test_find("woop");
    struct hit all, hit;
    leaks->rays++;
    trace_brute(scene, woop, QUERY_CLOSEST, ray, &all);
    if (all.prim == ABI_NO_PRIM || !range_is_certain(scene, ray, &all))
        return;
    leaks->hits++;
    assert_int_equal(trace_ray(&(struct job){.scene = scene,
                                             .packed = packed,
                                             .box = box_test_find("robust"),
                                             .tri = woop,
                                             .query = QUERY_CLOSEST},
                               ray, &hit, NULL),
                     STATUS_OK);
    leaks->robust += hit.prim == ABI_NO_PRIM;
    assert_int_equal(trace_ray(&(struct job){.scene = scene,
                                             .packed = packed,
                                             .box = box_test_find("watertight"),
                                             .tri = woop,
                                             .query = QUERY_CLOSEST},
                               ray, &hit, NULL),
                     STATUS_OK);
    leaks->watertight += hit.prim == ABI_NO_PRIM;
}

#define OFFSETS 6

static size_t rays_each(void)
{
    return getenv("RAYDIFF_SLOW") ? 300000 : 3000;
}

static void long_corridors_leak_through_robust_boxes_only(void **state)
{
    (void)state;
    for (float half = 10.0f; half <= 1000.0f; half *= 10.0f) {
        struct watertight_leaks leaks = {0};
        for (int axis = 0; axis < 3; axis++) {
            struct scene scene = corridor_scene(axis, half);
            struct bvh bvh = median(&scene, 1);
            for (size_t l = 0; l < ARRAY_COUNT(repaired); l++) {
                struct packed packed = pack(repaired[l], &bvh, &scene);
                for (int j = 0; j < OFFSETS; j++) {
                    struct rng rng = rng_make(7, (uint64_t)(axis * OFFSETS + j));
                    double off = j == 0 ? 0.0 : ldexp(1.0, 2 * j - 23);
                    for (size_t n = 0; n < rays_each(); n++) {
                        struct ray ray = corridor_ray(&rng, axis, off);
                        count(&scene, &packed, &ray, &leaks);
                    }
                }
                packed_free(&packed);
            }
            bvh_free(&bvh);
            scene_free(&scene);
        }
        print_message("corridor 2 x 2 x %g: of %zu rays woop hits %zu; leaks: robust %zu, "
                      "watertight %zu\n",
                      2 * (double)half, leaks.rays, leaks.hits, leaks.robust, leaks.watertight);
        assert_true(leaks.hits > leaks.rays * 9 / 10);
        assert_int_equal(leaks.watertight, 0);
        assert_true(half < 100.0f || leaks.robust > leaks.rays / 1000);
    }
}

/* One of the rays above, kept. */
static void kept_leak(void **state)
{
    (void)state;
    struct ray ray = {{-0x1.e5616p-4f, 0x1.2f1c6p-1f, 0x1.5c5de4p-1f},
                      0,
                      {0x1.1e5614p+0f, 0x1.a1c77ap-2f, 0x1.734568p+1f},
                      TMAX};
    struct scene scene = corridor_scene(2, 1000.0f);
    struct bvh bvh = median(&scene, 1);
    struct packed packed = pack("f32", &bvh, &scene);
    struct watertight_leaks leaks = {0};
    count(&scene, &packed, &ray, &leaks);
    assert_int_equal(leaks.hits, 1);
    assert_int_equal(leaks.robust, 1);
    assert_int_equal(leaks.watertight, 0);
    packed_free(&packed);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* Without the scene's reach behind the origin the test is blind to it. */
static void place_measures_along_the_main_axis(void **state)
{
    (void)state;
    struct box box = {{-5, -70, -900}, {3, 40, 500}};
    for (int main = 0; main < 3; main++)
        for (int sign = -1; sign <= 1; sign += 2) {
            struct ray ray = {{1, 2, 3}, 0, {0.25f, 0.25f, 0.25f}, TMAX};
            ray.dir[main] = 0.5f * (float)sign;
            struct slab_ray r = slab_ray_make(&ray);
            slab_ray_place(&r, &box);
            float behind = sign > 0 ? ray.org[main] - box.lo[main] : box.hi[main] - ray.org[main];
            assert_int_equal(r.main, main);
            assert_true(r.behind == 2 * behind * SLAB_BEHIND);
            ray.org[main] = sign > 0 ? -1000.0f : 1000.0f; /* all of it lies ahead */
            r = slab_ray_make(&ray);
            slab_ray_place(&r, &box);
            assert_true(r.behind == 0.0f);
        }
    struct slab_ray r = slab_ray_make(&(struct ray){{0, 0, 0}, 0, {1, -1, 1}, TMAX});
    assert_int_equal(r.main, 0); /* as tri_ray_make chooses */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(long_corridors_leak_through_robust_boxes_only),
        cmocka_unit_test(kept_leak),
        cmocka_unit_test(place_measures_along_the_main_axis),
    };
    return cmocka_run_group_tests_name("watertight", tests, NULL, NULL) ? 1 : 0;
}
