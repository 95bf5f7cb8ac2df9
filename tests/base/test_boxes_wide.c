/* Box tests of rays that take every box for wider. */
#include "ref/base/rng.h"
#include "ref/primitives/primitives.h"
#include "ref/primitives/test_run.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

/* A box is met as if it was wider by what the ray was widened by, on every side, and 0 changes
 * nothing. */
static void rays_may_take_boxes_for_wider(void **state)
{
    (void)state;
    struct rng rng = rng_make(31, 0);
    uint32_t kept[2] = {0, 0};
    for (uint32_t i = 0; i < 100000; i++) {
        const int axis = (int)rng_below(&rng, 3), side = rng_below(&rng, 2) ? 1 : -1;
        const bool near = rng_below(&rng, 2);
        const float by = rng_range(&rng, 0.01f, 1), beside = by * (near ? 0.999f : 1.001f);
        struct box box;
        struct ray ray = {.tmax = 1e30f};
        float entry;
        for (int k = 0; k < 3; k++) {
            box.lo[k] = rng_range(&rng, -2, 0);
            box.hi[k] = box.lo[k] + rng_range(&rng, 0, 2);
            ray.dir[k] = rng_range(&rng, -1, 1);
            ray.org[k] = 0.5f * (box.lo[k] + box.hi[k]) - ray.dir[k];
        }
        /* Along the axis the ray runs beside the box, parallel to its side, or almost: that it
         * counts as parallel, or not even so. */
        ray.org[axis] = side > 0 ? box.hi[axis] + beside : box.lo[axis] - beside;
        ray.dir[axis] *= i % 4 == 0 ? 1e-9f : i % 4 == 1 ? 1e-30f : 0;
        for (size_t b = 0; box_tests[b]; b++) {
            if (box_tests[b]->faithful)
                continue;
            struct slab_ray plain = slab_ray_make(&ray), wide = plain, same = plain;
            slab_ray_place(&wide, &box);
            slab_ray_widen(&wide, by);
            slab_ray_widen(&same, 0);
            assert_memory_equal(&same, &plain, sizeof same);
            assert_false(box_test_run(box_tests[b]->id, &plain, &box, ray.tmax, &entry));
            assert_int_equal(box_test_run(box_tests[b]->id, &wide, &box, ray.tmax, &entry), near);
            kept[near]++;
        }
    }
    assert_true(kept[0] > 50000 && kept[1] > 50000);
}

/* What meets a box meets the wider one, at a t that is not later; and so does a ray whose point
 * beside the box is in it. */
static void wider_boxes_are_met_no_later(void **state)
{
    (void)state;
    struct rng rng = rng_make(32, 0);
    uint32_t beside = 0;
    for (uint32_t i = 0; i < 200000; i++) {
        const int down = (int)rng_below(&rng, 16);
        const float by = ldexpf(rng_range(&rng, 1, 2), -down);
        struct box box;
        struct ray ray = {.tmax = 1e30f};
        float first, entry;
        for (int k = 0; k < 3; k++) {
            box.lo[k] = rng_range(&rng, -2, 0);
            box.hi[k] = box.lo[k] + rng_range(&rng, 0, 2);
            const float at = rng_range(&rng, box.lo[k] - 0.99f * by, box.hi[k] + 0.99f * by);
            ray.org[k] = rng_range(&rng, -4, 4);
            ray.dir[k] = at - ray.org[k];
        }
        struct slab_ray plain = slab_ray_make(&ray), wide = plain;
        slab_ray_widen(&wide, by);
        const bool met = slab_robust(&plain, &box, ray.tmax, &first);
        assert_true(slab_robust(&wide, &box, ray.tmax, &entry));
        assert_true(slab_watertight(&wide, &box, ray.tmax, &entry));
        assert_true(!met || entry <= first);
        beside += !met;
    }
    assert_true(beside > 1000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_may_take_boxes_for_wider),
        cmocka_unit_test(wider_boxes_are_met_no_later),
    };
    return cmocka_run_group_tests_name("boxes_wide", tests, NULL, NULL);
}
