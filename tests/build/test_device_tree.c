/* Trees that a device builds are C's, in every byte of every stage, on every driver here. */
#include "gpu/build/device_tree.h"
#include "tests/support/built.h"
#include "tests/build/device_fixture.h"

static const char *const kind_names[STAGED_KINDS] = {"lbvh30", "lbvh63", "hploc"};

static void check_same(struct device_tree *tree, const struct scene *scene, const char *what)
{
    for (int k = 0; k < STAGED_KINDS; k++) {
        struct staged mine, devices;
        struct device_times times;
        struct reason reason = {""};
        gpu_must(staged_build((enum staged_kind)k, scene, &mine, NULL, &reason), &reason);
        gpu_must(device_tree_build(tree, (enum staged_kind)k, scene, &devices, &times, &reason),
                 &reason);
        struct staged_difference differs = staged_compare(&devices, &mine);
        if (differs.stage)
            fail_msg("%s, %s, %u triangles: %s %u: %s (%llu differ)", what, kind_names[k],
                     scene->tri_count, differs.stage, differs.element, differs.text,
                     (unsigned long long)differs.count);
        assert_int_equal(mine.count, scene->tri_count);
        assert_int_equal(devices.count, scene->tri_count);
        assert_true(scene->tri_count == 0 || times.bytes > 100 * (uint64_t)scene->tri_count);
        staged_free(&mine);
        staged_free(&devices);
    }
}

/* -0 is 0, in codes and boxes. */
static void check_signs(struct device_tree *tree)
{
    struct scene scene = built_soup(300, 9);
    for (size_t c = 0; c < 9 * (size_t)scene.tri_count; c++)
        if (c % 5 < 3)
            scene.vertex[c] = c % 2 ? 0.0f : -0.0f;
    check_same(tree, &scene, "zeros");
    struct staged devices;
    struct reason reason = {""};
    gpu_must(device_tree_build(tree, STAGED_HPLOC, &scene, &devices, NULL, &reason), &reason);
    for (size_t i = 0; i < 2 * (size_t)devices.count - 1; i++)
        for (int k = 0; k < 6; k++)
            assert_int_not_equal(devices.box[i][k], 0x80000000u);
    staged_free(&devices);
    scene_free(&scene);
}

/* Far from the origin, where few of a coordinate's bits differ: cells are finer than units, and
 * areas of neighbours are about 2^32. */
static void check_offsets(struct device_tree *tree)
{
    static const float offsets[] = {1e6f, 6e4f, 5e3f, -3e2f};
    for (size_t i = 0; i < ARRAY_COUNT(offsets); i++) {
        struct scene scene = built_soup(2000, 20 + i);
        for (size_t c = 0; c < 9 * (size_t)scene.tri_count; c++)
            scene.vertex[c] += offsets[i];
        check_same(tree, &scene, "offset");
        scene_free(&scene);
    }
}

/* A buffer is kept from scene to scene: large and small ones by turns. */
static void check_driver(struct device_tree *tree)
{
    static const uint32_t sizes[] = {1023, 1,  1024, 2,  1025, 3,  2048, 0,   4097, 16,
                                     17,   63, 64,   65, 31,   33, 1200, 130, 5,    20000};
    for (size_t i = 0; i < BUILT_SCENES; i++) {
        const char *what;
        struct scene scene = built_scene(i, &what);
        check_same(tree, &scene, what);
        scene_free(&scene);
    }
    for (size_t i = 0; i < ARRAY_COUNT(sizes); i++) {
        struct scene scene = built_soup(sizes[i], i);
        check_same(tree, &scene, "soup");
        scene_free(&scene);
    }
    check_signs(tree);
    check_offsets(tree);
}

static void trees_are_those_of_c(void **state)
{
    (void)state;
    device_each(check_driver);
}

/* 10,000 equal triangles, among others: places decide there. */
static void piles_of_equal_triangles(void **state)
{
    (void)state;
    struct device_tree *tree = device_open(false);
    struct scene scene = built_soup(40000, 3);
    for (size_t i = 0; i < (size_t)9 * 10000; i++)
        scene.vertex[i] = scene.vertex[i % 9];
    check_same(tree, &scene, "pile");
    scene_free(&scene);
    device_close(tree);
}

/* Nothing shows in the answers of a driver that runs dispatches one by one: the layer looks. */
static void dispatches_do_not_race(void **state)
{
    (void)state;
    struct device_tree *tree = device_open(true);
    struct scene scene = built_soup(3000, 1);
    check_same(tree, &scene, "validated");
    scene_free(&scene);
    device_close(tree);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trees_are_those_of_c),
        cmocka_unit_test(piles_of_equal_triangles),
        cmocka_unit_test(dispatches_do_not_race),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
