/* What the bytes of a small tree hold, of a tree that is known by hand and of others. */
#include "bench/measure/small_parts.h"
#include "scenes/scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

static struct fast_tree made(const struct scene *scene)
{
    const struct build_options options = {.leaf = 1};
    struct reason reason = {""};
    struct fast_tree tree = {.node = NULL};
    struct bvh bvh;
    if (bvh_build(builder_find("median"), scene, &options, &bvh, &reason) ||
        fast_make_small(&bvh, scene, &tree, &reason))
        fail_msg("%s", reason.text);
    bvh_free(&bvh);
    return tree;
}

static void near(double a, double b)
{
    if (!(fabs(a - b) < 1e-9 * (1 + fabs(b))))
        fail_msg("%.17g, expected %.17g", a, b);
}

/* A square: differences of x and y are those of 0 and 1, in 30 bits, and of z none. */
static void a_square_is_counted_by_hand(void **state)
{
    (void)state;
    static const float vertex[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    static const uint32_t index[6] = {0, 1, 2, 0, 2, 3};
    static const double held[SMALL_PARTS] = {
        80, 20, 3, 4 * 2 * 30 / 8.0, 2 / 8.0, (14 * 32 - 160 - 24 - 240 - 2) / 8.0};
    const double least[SMALL_PARTS] = {
        80, 20, 2 * log2(4 * 3 * 2) / 8, 4 * 2 * log2(0x3F800001) / 8, 0, 0};
    struct scene scene;
    assert_int_equal(scene_make(4, 2, &scene), STATUS_OK);
    memcpy(scene.vertex, vertex, sizeof vertex);
    memcpy(scene.index, index, sizeof index);
    struct fast_tree tree = made(&scene);
    struct small_parts parts = small_parts_count(&tree);
    for (int i = 0; i < SMALL_PARTS; i++) {
        near(parts.held[i], held[i]);
        near(parts.least[i], least[i]);
    }
    fast_free(&tree);
    scene_free(&scene);
}

static void parts_are_the_whole(void **state)
{
    (void)state;
    static const char *const specs[] = {"soup:n=300", "sphere:n=30", "cornell", "needles:n=50",
                                        "terrain:k=5"};
    for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
        struct scene scene;
        struct reason reason = {""};
        double all = 0;
        if (scene_open(specs[s], 1, &scene, &reason))
            fail_msg("%s", reason.text);
        struct fast_tree tree = made(&scene);
        struct small_parts parts = small_parts_count(&tree);
        for (int i = 0; i < SMALL_PARTS; i++) {
            assert_true(parts.least[i] >= 0 && parts.least[i] <= parts.held[i] + 1e-9);
            all += parts.held[i];
        }
        near(all, (double)fast_bytes(&tree));
        near(parts.held[PART_CORNERS], 1.5 * scene.tri_count);
        assert_true(parts.least[PART_VERTICES] > 0.9 * parts.held[PART_VERTICES]);
        fast_free(&tree);
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_square_is_counted_by_hand),
        cmocka_unit_test(parts_are_the_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
