/* Trees that a device collapses and encodes have the nodes, items and words of C, on every driver
 * here. */
#include "gpu/build/device_refit.h"
#include "gpu/build/wide_compare.h"
#include "ref/packed/packed_check.h"
#include "ref/store.h"
#include "ref/trace/trace.h"
#include "scenes/scenes.h"
#include "tests/build/wide_fixture.h"
#include "tests/build/device_fixture.h"

static void must_be_same(const struct device_wide *devices, const struct staged_wide *wide,
                         const struct packed *packed, const char *what)
{
    struct staged_difference at = staged_wide_compare(&devices->wide, wide);
    const uint32_t words = packed->layout->node_bytes / 4;
    if (at.stage)
        fail_msg("%s, %s, %u triangles: %s %u: %s (%llu differ)", what, packed->layout->name,
                 packed->tri_count, at.stage, at.element, at.text, (unsigned long long)at.count);
    assert_int_equal(devices->word_count, packed->word_count);
    for (uint32_t i = 0; i < packed->word_count; i++)
        if (devices->word[i] != packed->word[i])
            fail_msg("%s, %s, %u triangles: record %u, word %u is %08x, not %08x", what,
                     packed->layout->name, packed->tri_count, i / words, i % words,
                     devices->word[i], packed->word[i]);
    assert_int_equal(packed->item_count, wide->item_count);
    assert_true(packed->item_count == 0 ||
                memcmp(packed->item, devices->wide.item, 4 * (size_t)packed->item_count) == 0);
}

/* Both sides in one layout. Returns false if both refuse the scene. */
static bool check_layout(struct device_tree *tree, const struct staged *staged,
                         const struct layout *layout, const struct scene *scene, const char *what)
{
    struct staged_wide wide;
    struct packed packed;
    struct device_wide devices;
    struct device_wide_times times;
    struct reason reason = {""}, mine = {""};
    assert_int_equal(staged_wide_make(staged, layout->width, layout->leaf_most, &wide), STATUS_OK);
    enum status expected = wide_pack(&wide, staged, layout, scene, &packed, &mine);
    enum status status = device_wide_make(tree, layout, &devices, &times, &reason);
    if (status != expected)
        fail_msg("%s, %s: '%s', in C '%s'", what, layout->name, reason.text, mine.text);
    if (!status)
        must_be_same(&devices, &wide, &packed, what);
    else
        assert_null(devices.word);
    if (!status && scene->tri_count > 0)
        assert_true(times.bytes >= 4 * (uint64_t)(packed.word_count + packed.item_count));
    packed_free(&packed);
    staged_wide_free(&wide);
    device_wide_free(&devices);
    return status == STATUS_OK;
}

static uint32_t check_scene(struct device_tree *tree, const struct scene *scene, const char *what)
{
    uint32_t encoded = 0;
    for (int k = 0; k < STAGED_KINDS; k++) {
        struct staged staged;
        struct reason reason = {""};
        gpu_must(device_tree_build(tree, (enum staged_kind)k, scene, &staged, NULL, &reason),
                 &reason);
        for (size_t l = 0; l < ARRAY_COUNT(wide_layouts); l++)
            encoded += check_layout(tree, &staged, layout_find(wide_layouts[l]), scene, what);
        staged_free(&staged);
    }
    return encoded;
}

/* A buffer is kept from scene to scene: large and small ones by turns, about the ends of
 * workgroups of triangles and of nodes. */
static void check_driver(struct device_tree *tree)
{
    static const uint32_t sizes[] = {1023, 1, 20000, 2, 4097, 63, 64, 65, 230, 12000, 300, 5, 0};
    uint32_t encoded = 0;
    for (size_t i = 0; i < WIDE_SCENES; i++) {
        const char *what;
        struct scene scene = wide_scene(i, &what);
        encoded += check_scene(tree, &scene, what);
        scene_free(&scene);
    }
    assert_int_equal(encoded, (WIDE_SCENES - 3) * STAGED_KINDS * ARRAY_COUNT(wide_layouts));
    for (size_t i = 0; i < ARRAY_COUNT(sizes); i++) {
        struct scene scene = built_soup(sizes[i], i);
        (void)check_scene(tree, &scene, "soup");
        scene_free(&scene);
    }
}

static void words_are_those_of_c(void **state)
{
    (void)state;
    device_each(check_driver);
}

/* A spec of raydiff, and a pile, whose H-PLOC tree is deep. */
static void large_scenes_and_piles(void **state)
{
    (void)state;
    static const char *const specs[] = {"sphere:n=60", "stack:n=2000", "needles:n=5000"};
    struct device_tree *tree = device_open(false);
    struct scene scene = built_soup(40000, 3);
    struct reason reason = {""};
    for (size_t i = 0; i < (size_t)9 * 10000; i++)
        scene.vertex[i] = scene.vertex[i % 9];
    assert_int_not_equal(check_scene(tree, &scene, "pile"), 0);
    scene_free(&scene);
    for (size_t i = 0; i < ARRAY_COUNT(specs); i++) {
        gpu_must(scene_open(specs[i], 1, &scene, &reason), &reason);
        assert_int_not_equal(check_scene(tree, &scene, specs[i]), 0);
        scene_free(&scene);
    }
    device_close(tree);
}

/* --- what the words answer -------------------------------------------------------------------- */

/* Rays from all sides at triangles find in the device's words what brute force finds. */
static void check_answers(struct device_tree *tree, const struct layout *layout,
                          const struct scene *scene)
{
    struct staged staged;
    struct staged_wide wide;
    struct packed packed;
    struct device_wide devices;
    struct device_wide_times times;
    struct reason reason = {""};
    struct rng rng = rng_make(5, 0);
    uint32_t hits = 0;
    gpu_must(device_tree_build(tree, STAGED_HPLOC, scene, &staged, NULL, &reason), &reason);
    gpu_must(device_wide_make(tree, layout, &devices, &times, &reason), &reason);
    assert_int_equal(staged_wide_make(&staged, layout->width, layout->leaf_most, &wide), STATUS_OK);
    assert_int_equal(wide_pack(&wide, &staged, layout, scene, &packed, &reason), STATUS_OK);
    memset(packed.word, 0, 4 * (size_t)packed.word_count);
    memcpy(packed.word, devices.word, 4 * (size_t)devices.word_count);
    memcpy(packed.item, devices.wide.item, 4 * (size_t)devices.wide.item_count);
    gpu_must(packed_check(&packed, scene, NULL, &reason), &reason);
    const struct job job = {.scene = scene,
                            .packed = &packed,
                            .box = box_test_find("robust"),
                            .tri = tri_test_find("mt"),
                            .query = QUERY_CLOSEST};
    for (uint32_t i = 0; i < 2000; i++) {
        struct ray ray = {.tmax = 1e30f};
        struct hit mine, brute;
        const float *corner = scene->vertex + 9 * (size_t)(i % scene->tri_count);
        for (int k = 0; k < 3; k++) {
            float aim = corner[k] + corner[3 + k] + corner[6 + k];
            ray.org[k] = rng_range(&rng, -12, 12);
            ray.dir[k] = aim / 3 - ray.org[k];
        }
        assert_int_equal(trace_ray(&job, &ray, &mine, NULL), STATUS_OK);
        trace_brute(scene, job.tri, job.query, &ray, &brute);
        assert_int_equal(mine.prim == ABI_NO_PRIM, brute.prim == ABI_NO_PRIM);
        assert_true(float_bits(mine.t) == float_bits(brute.t));
        hits += mine.prim != ABI_NO_PRIM;
    }
    assert_true(hits > 1800);
    packed_free(&packed);
    device_wide_free(&devices);
    staged_wide_free(&wide);
    staged_free(&staged);
}

static void rays_find_what_brute_force_finds(void **state)
{
    (void)state;
    struct device_tree *tree = device_open(false);
    struct scene scene = built_soup(1500, 8);
    for (size_t l = 0; l < ARRAY_COUNT(wide_layouts); l++)
        check_answers(tree, layout_find(wide_layouts[l]), &scene);
    scene_free(&scene);
    device_close(tree);
}

/* --- what is refused -------------------------------------------------------------------------- */

static void refuse(struct device_tree *tree, const char *layout, const char *rule)
{
    struct device_wide devices;
    struct device_wide_times times;
    struct reason reason = {""};
    assert_int_equal(device_wide_make(tree, layout_find(layout), &devices, &times, &reason),
                     STATUS_UNSUPPORTED);
    assert_null(devices.word);
    if (!strstr(reason.text, rule))
        fail_msg("'%s', not '%s'", reason.text, rule);
}

static void a_tree_must_stand_on_the_device(void **state)
{
    (void)state;
    struct device_tree *tree = device_open(false);
    struct scene scene = built_soup(50, 3);
    struct staged staged;
    struct reason reason = {""};
    assert_true(device_encodes(layout_find("tiny8_l14")));
    assert_false(device_encodes(layout_find("half4")));
    refuse(tree, "cwbvh80", "no tree");
    (void)check_scene(tree, &scene, "soup");
    refuse(tree, "half4", "half4");
    gpu_must(device_tree_build(tree, STAGED_HPLOC, &scene, &staged, NULL, &reason), &reason);
    assert_true(check_layout(tree, &staged, layout_find("tiny8"), &scene, "again"));
    assert_true(check_layout(tree, &staged, layout_find("tiny8"), &scene, "again"));
    struct packed packed = {.layout = layout_find("f32"), .store = tri_store_find("indexed")};
    uint64_t ns;
    gpu_must(device_refit(tree, &packed, &scene, NULL, &ns, &reason), &reason);
    refuse(tree, "tiny8", "no tree");
    staged_free(&staged);
    scene_free(&scene);
    device_close(tree);
}

/* --- what a comparison says ------------------------------------------------------------------- */

static void compare_must_agree(struct device_tree *tree, const struct scene *scene, bool refused)
{
    struct staged staged;
    struct reason reason = {""};
    gpu_must(device_tree_build(tree, STAGED_LBVH30, scene, &staged, NULL, &reason), &reason);
    for (size_t l = 0; l < ARRAY_COUNT(wide_layouts); l++) {
        const struct layout *layout = layout_find(wide_layouts[l]);
        struct wide_result result;
        gpu_must(wide_compare(tree, layout, &staged, scene, &result, &reason), &reason);
        assert_null(result.differs.stage);
        assert_int_equal(strstr(result.refused.text, layout->name) != NULL, refused);
        assert_true(result.nodes > 0 && result.c_ns[WIDE_COLLAPSE] > 0);
        assert_int_equal(result.device_ns[WIDE_WORDS] > 0, !refused);
    }
    staged_free(&staged);
}

/* Of a scene that is another one in C, each stage is named. */
static void a_comparison_names_what_differs(void **state)
{
    (void)state;
    struct device_tree *tree = device_open(false);
    struct scene scene = built_soup(200, 3);
    struct staged mine, devices;
    struct staged_wide wide;
    struct wide_result result;
    uint32_t leaf = 0;
    struct reason reason = {""};
    compare_must_agree(tree, &scene, false);
    gpu_must(device_tree_build(tree, STAGED_LBVH63, &scene, &devices, NULL, &reason), &reason);
    mine = wide_staged(STAGED_LBVH63, &scene);
    assert_int_equal(staged_wide_make(&mine, 8, 4, &wide), STATUS_OK);
    while (wide.child[leaf].count < 2) /* a leaf's box opens nothing: words alone differ */
        leaf++;
    uint32_t *lo = mine.box[wide.child[leaf].link];
    staged_wide_free(&wide);
    *lo = float_bits(float_from_bits(*lo) - 30);
    gpu_must(wide_compare(tree, layout_find("tiny8"), &mine, &scene, &result, &reason), &reason);
    assert_string_equal(result.differs.stage, "words");
    assert_non_null(strstr(result.differs.text, "of the record is "));
    mine.order[3] ^= 1;
    gpu_must(wide_compare(tree, layout_find("tiny8"), &mine, &scene, &result, &reason), &reason);
    assert_string_equal(result.differs.stage, "items");
    staged_free(&mine);
    staged_free(&devices);
    scene.vertex[7] = 2e30f;
    compare_must_agree(tree, &scene, true);
    scene_free(&scene);
    device_close(tree);
}

static void the_first_record_that_differs_is_named(void **state)
{
    (void)state;
    uint32_t mine[60] = {0}, other[60] = {0};
    const struct packed packed = {
        .layout = layout_find("cwbvh80"), .word = mine, .word_count = 60, .node_count = 3};
    assert_null(wide_words_compare(other, 60, &packed).stage);
    struct staged_difference at = wide_words_compare(other, 40, &packed);
    assert_string_equal(at.stage, "words");
    assert_string_equal(at.text, "40 words, not 60");
    mine[59] = 0x12;
    other[43] = 0x1F;
    at = wide_words_compare(other, 60, &packed);
    assert_string_equal(at.stage, "words");
    assert_int_equal(at.element, 2);
    assert_int_equal(at.count, 2);
    assert_string_equal(at.text, "word 3 of the record is 0000001f, not 00000000");
    other[43] = 0;
    at = wide_words_compare(other, 60, &packed);
    assert_int_equal(at.count, 1);
    assert_string_equal(at.text, "word 19 of the record is 00000000, not 00000012");
}

/* Nothing shows in the answers of a driver that runs dispatches one by one: the layer looks. */
static void dispatches_do_not_race(void **state)
{
    (void)state;
    struct device_tree *tree = device_open(true);
    struct scene scene = built_soup(3000, 1);
    (void)check_scene(tree, &scene, "validated");
    scene_free(&scene);
    device_close(tree);
}

/* How many messages the layer of validation claims to have; 0: those that it has. The program is
 * linked so that this is called (tests/tests.mk). */
static uint32_t told;

uint32_t __real_vk_messages(const struct vk *vk, struct reason *reason);
uint32_t __wrap_vk_messages(const struct vk *vk, struct reason *reason);

uint32_t __wrap_vk_messages(const struct vk *vk, struct reason *reason)
{
    if (told == 0)
        return __real_vk_messages(vk, reason);
    if (reason)
        snprintf(reason->text, sizeof reason->text, "a message");
    return told;
}

static void must_be_told(enum status status, const struct reason *reason)
{
    assert_int_equal(status, STATUS_DEVICE);
    assert_string_equal(reason->text, "3 validation messages, the first: a message");
}

/* Whatever the device does: a message since it was opened is its error. */
static void messages_are_an_error_of_every_step(void **state)
{
    (void)state;
    struct device_tree *tree = device_open(false);
    const struct layout *layout = layout_find("tiny8");
    const struct build_options options = {.leaf = 2, .eps = BUILD_EPS_DEFAULT};
    struct scene scene = built_soup(40, 3);
    struct bvh bvh;
    struct packed packed;
    struct staged staged;
    struct device_wide wide;
    struct device_wide_times times;
    struct reason reason = {""};
    uint64_t ns;
    gpu_must(bvh_build(builder_find("median"), &scene, &options, &bvh, &reason), &reason);
    gpu_must(packed_make(layout_find("f32"), &bvh, &scene, &packed, &reason), &reason);
    uint32_t *word = calloc(packed.word_count, sizeof *word);
    assert_non_null(word);
    gpu_must(device_tree_build(tree, STAGED_LBVH63, &scene, &staged, NULL, &reason), &reason);
    staged_free(&staged);
    told = 3;
    must_be_told(device_wide_make(tree, layout, &wide, &times, &reason), &reason);
    assert_true(!wide.word && wide.word_count == 0);
    must_be_told(device_refit(tree, &packed, &scene, word, &ns, &reason), &reason);
    must_be_told(device_tree_build(tree, STAGED_LBVH63, &scene, &staged, NULL, &reason), &reason);
    assert_true(!staged.code && staged.count == 0);
    told = 0;
    free(word);
    packed_free(&packed);
    bvh_free(&bvh);
    scene_free(&scene);
    device_close(tree);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words_are_those_of_c),
        cmocka_unit_test(large_scenes_and_piles),
        cmocka_unit_test(rays_find_what_brute_force_finds),
        cmocka_unit_test(a_tree_must_stand_on_the_device),
        cmocka_unit_test(a_comparison_names_what_differs),
        cmocka_unit_test(the_first_record_that_differs_is_named),
        cmocka_unit_test(messages_are_an_error_of_every_step),
        cmocka_unit_test(dispatches_do_not_race),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
