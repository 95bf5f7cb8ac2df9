/* Trees that a device refits have the words of packed_refit, on every driver here. */
#include "gpu/build/device_refit.h"
#include "ref/packed/refit.h"
#include "ref/store.h"
#include "scenes/move.h"
#include "tests/support/built.h"
#include "tests/build/device_fixture.h"

static const char *const layout_names[] = {"f32",   "rf16",     "cwbvh80",
                                           "tiny8", "tiny8_l8", "tiny8_l14"};

/* A tree of the scene as it is, packed; false if the layout cannot hold it. */
static bool packed_of(const struct scene *scene, const char *builder, const char *layout,
                      uint32_t leaf, struct packed *out)
{
    const struct build_options options = {.leaf = leaf, .eps = BUILD_EPS_DEFAULT};
    struct bvh bvh;
    struct reason reason;
    gpu_must(bvh_build(builder_find(builder), scene, &options, &bvh, &reason), &reason);
    enum status status = packed_make(layout_find(layout), &bvh, scene, out, &reason);
    bvh_free(&bvh);
    return status == STATUS_OK;
}

/* Refits to the scene on both sides. Returns C's status. */
static enum status refit_both(struct device_tree *tree, struct packed *packed,
                              const struct scene *scene, const char *what)
{
    uint32_t *word = calloc(packed->word_count + 1, sizeof *word);
    uint64_t ns;
    struct reason reason = {""}, mine = {""};
    assert_non_null(word);
    enum status status = device_refit(tree, packed, scene, word, &ns, &reason);
    enum status expected = packed_refit(packed, scene, &mine);
    if (status != expected)
        fail_msg("%s, %s: '%s', in C '%s'", what, packed->layout->name, reason.text, mine.text);
    for (uint32_t i = 0; i < packed->word_count && !status; i++)
        if (word[i] != packed->word[i])
            fail_msg("%s, %s, %u triangles: word %u of %u is %08x, not %08x", what,
                     packed->layout->name, scene->tri_count, i, packed->word_count, word[i],
                     packed->word[i]);
    if (status)
        assert_non_null(strstr(reason.text, "rebuild: "));
    free(word);
    return status;
}

static uint32_t check_scene(struct device_tree *tree, struct scene *scene, const char *what)
{
    static const float moves[] = {0, 0.01f, 10};
    uint32_t refitted = 0;
    for (size_t l = 0; l < ARRAY_COUNT(layout_names); l++)
        for (uint32_t leaf = 1; leaf <= 7; leaf += 3) {
            struct packed packed;
            struct scene moved = *scene;
            const size_t bytes = 3 * sizeof(float) * (size_t)scene->vertex_count;
            if (!packed_of(scene, leaf == 1 ? "lbvh63" : "median", layout_names[l], leaf, &packed))
                continue;
            moved.vertex = malloc(bytes + 1);
            assert_non_null(moved.vertex);
            for (size_t m = 0; m < ARRAY_COUNT(moves); m++) {
                memcpy(moved.vertex, scene->vertex, bytes);
                scene_move(&moved, moves[m], m);
                refitted += refit_both(tree, &packed, &moved, what) == STATUS_OK;
            }
            free(moved.vertex);
            packed_free(&packed);
        }
    return refitted;
}

static void check_driver(struct device_tree *tree)
{
    uint32_t refitted = 0;
    for (size_t i = 0; i < BUILT_SCENES; i++) {
        const char *what;
        struct scene scene = built_scene(i, &what);
        refitted += check_scene(tree, &scene, what);
        scene_free(&scene);
    }
    for (uint32_t n = 0; n < 12; n++) {
        struct scene scene = built_soup(n, n);
        refitted += check_scene(tree, &scene, "few");
        scene_free(&scene);
    }
    /* Coordinates about where halves are subnormal, and zeros of both signs. */
    struct scene scene = built_soup(500, 7);
    for (size_t c = 0; c < 9 * (size_t)scene.tri_count; c++) {
        scene.vertex[c] *= 0x1p-17f;
        if (c % 4 == 0)
            scene.vertex[c] = c % 8 ? 0.0f : -0.0f;
    }
    refitted += check_scene(tree, &scene, "zeros");
    scene_free(&scene);
    assert_true(refitted > 300);
}

static void words_are_those_of_c(void **state)
{
    (void)state;
    device_each(check_driver);
}

/* Halves from the least to the largest, and what lies between and beyond them. */
static void every_half_is_rounded_outward(void **state)
{
    (void)state;
    struct device_tree *tree = device_open(false);
    struct scene scene = built_soup(2000, 3);
    struct packed packed;
    assert_true(packed_of(&scene, "median", "rf16", 4, &packed));
    for (uint32_t round = 0; round < 32; round++) {
        for (size_t i = 0; i < scene.tri_count; i++)
            for (size_t c = 0; c < 9; c++) {
                uint32_t bits = 0x33000000u + (uint32_t)((i * 9 + c) * 32 + round) * 0x24Bu;
                bits = bits > 0x477FE000u ? 0x477FE000u - (uint32_t)i : bits;
                scene.vertex[9 * i + c] = float_from_bits(bits | (uint32_t)(i % 2) << 31);
            }
        assert_int_equal(refit_both(tree, &packed, &scene, "halves"), STATUS_OK);
    }
    scene.vertex[5] = float_from_bits(0x477FE001u); /* just beyond 65504 */
    assert_int_equal(refit_both(tree, &packed, &scene, "beyond"), STATUS_LIMIT);
    packed_free(&packed);
    scene_free(&scene);
    device_close(tree);
}

static void what_cannot_be_refitted_is_refused(void **state)
{
    (void)state;
    struct device_tree *tree = device_open(false);
    struct scene scene = built_soup(50, 3);
    struct packed packed;
    struct reason reason = {""};
    uint64_t ns;
    assert_true(packed_of(&scene, "median", "obb8", 3, &packed));
    assert_false(device_refits(packed.layout));
    assert_int_equal(device_refit(tree, &packed, &scene, NULL, &ns, &reason), STATUS_UNSUPPORTED);
    assert_non_null(strstr(reason.text, "obb8"));
    packed_free(&packed);
    assert_true(packed_of(&scene, "sbvh", "f32", 3, &packed));
    assert_true(device_refits(packed.layout));
    packed.split = true;
    assert_int_equal(device_refit(tree, &packed, &scene, NULL, &ns, &reason), STATUS_LIMIT);
    packed.split = false;
    packed.store = tri_stores[1];
    assert_int_equal(device_refit(tree, &packed, &scene, NULL, &ns, &reason), STATUS_UNSUPPORTED);
    packed_free(&packed);
    scene_free(&scene);
    device_close(tree);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words_are_those_of_c),
        cmocka_unit_test(every_half_is_rounded_outward),
        cmocka_unit_test(what_cannot_be_refitted_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
