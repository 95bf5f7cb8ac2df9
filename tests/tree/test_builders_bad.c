/* Scenes whose vertices are not finite: every builder makes a sound tree of them, and no bin is out
 * of range. A centre that is NaN is lost by minima and maxima, and those before it with it. */
#include "ref/base/rng.h"
#include "ref/build/bins.h"
#include "ref/build/room.h"
#include "ref/tree/bvh.h"
#include "tests/support/built.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

static const float bad[] = {NAN, INFINITY, -INFINITY, FLT_MAX, -FLT_MAX, 1e30f, -1e30f, 0};

/* Of `share` coordinates in a hundred. */
static struct scene spoilt(struct rng *rng, uint32_t count, uint32_t share)
{
    struct scene scene = built_soup(count, rng_below(rng, 1000));
    for (uint32_t i = 0; i < 3 * scene.vertex_count; i++)
        if (rng_below(rng, 100) < share)
            scene.vertex[i] = bad[rng_below(rng, ARRAY_COUNT(bad))];
    return scene;
}

static const uint32_t shares[] = {1, 5, 30, 100};

static void every_builder_makes_a_tree_of_any_numbers(void **state)
{
    (void)state;
    struct rng rng = rng_make(44, 1);
    for (uint32_t n = 0; n < 60; n++) {
        struct scene scene = spoilt(&rng, 1 + rng_below(&rng, 400), shares[n % 4]);
        for (size_t b = 0; builders[b]; b++) {
            struct build_options options = {.leaf = 1 + rng_below(&rng, 8),
                                            .eps = BUILD_EPS_DEFAULT,
                                            .bins = 2 + rng_below(&rng, BUILD_BINS_MOST - 1),
                                            .presplit = n % 3 == 0};
            struct bvh bvh;
            struct reason reason = {""};
            enum status status = bvh_build(builders[b], &scene, &options, &bvh, &reason);
            if (!status)
                status = bvh_check_form(&bvh, &scene, &reason);
            if (status && !builders[b]->faithful)
                fail_msg("%s: %s", builders[b]->name, reason.text);
            bvh_free(&bvh);
        }
        scene_free(&scene);
    }
}

static void every_bin_is_one_of_them(void **state)
{
    (void)state;
    struct rng rng = rng_make(44, 2);
    uint32_t below = 0;
    for (uint32_t n = 0; n < 2000; n++) {
        struct scene scene = spoilt(&rng, 1 + rng_below(&rng, 100), shares[n % 4]);
        struct build_options options = {.presplit = n % 3 == 0};
        struct refs refs;
        assert_int_equal(refs_make(&scene, &options, 1, &refs, NULL), STATUS_OK);
        struct bin_map map = bin_map_of(&refs.centres, 2 + rng_below(&rng, BINS_MOST - 1));
        for (uint32_t i = 0; i < refs.count; i++) {
            lanes_int bin = bin_of(&map, &refs.ref[i]);
            lanes centre = ref_centre(&refs.ref[i]);
            for (int k = 0; k < 3; k++) {
                assert_true(bin[k] >= 0 && bin[k] < (int)map.count);
                below += centre[k] < map.base[k];
            }
        }
        room_free(refs.ref);
        scene_free(&scene);
    }
    assert_true(below > 1000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_builder_makes_a_tree_of_any_numbers),
        cmocka_unit_test(every_bin_is_one_of_them),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
