/* Builders on a device as campaigns use them: a difference in any stage or any layout is told, and
 * the device is the one that was chosen last. wide_compare is looked at (--wrap). */
#include "gpu/build/device_builders.h"
#include "gpu/build/wide_compare.h"
#include "tests/build/device_fixture.h"
#include "tests/support/built.h"

enum status __real_wide_compare(struct device_tree *tree, const struct layout *layout,
                                const struct staged *mine, const struct scene *scene,
                                struct wide_result *out, struct reason *reason);
enum status __wrap_wide_compare(struct device_tree *tree, const struct layout *layout,
                                const struct staged *mine, const struct scene *scene,
                                struct wide_result *out, struct reason *reason);

#define SEEN_MOST 16u

static const struct layout *seen[SEEN_MOST];
static uint32_t seen_count, liar; /* the layout of this number differs */

enum status __wrap_wide_compare(struct device_tree *tree, const struct layout *layout,
                                const struct staged *mine, const struct scene *scene,
                                struct wide_result *out, struct reason *reason)
{
    enum status status = __real_wide_compare(tree, layout, mine, scene, out, reason);
    if (seen_count == liar)
        out->differs = (struct staged_difference){.stage = "words", .element = 7, .count = 5};
    assert_true(seen_count < SEEN_MOST);
    seen[seen_count++] = layout;
    return status;
}

static const char *const names[] = {"gpu_lbvh30", "gpu_lbvh63", "gpu_hploc"};

/* The test is skipped where no device can be opened. */
static void add_builders(void)
{
    static bool added;
    struct reason reason = {""};
    if (!added)
        gpu_must(device_builders_add(&reason), &reason);
    added = true;
    struct device_tree *tree = device_open(false);
    device_close(tree);
}

static bool is_seen(const struct layout *layout)
{
    bool is = false;
    for (uint32_t i = 0; i < seen_count; i++)
        is = is || strcmp(layout_shader(seen[i]), layout_shader(layout)) == 0;
    return is;
}

/* Each kind of record that a device encodes is compared, of each builder, and told by its name. */
static void a_difference_in_any_layout_is_told(void **state)
{
    (void)state;
    add_builders();
    for (size_t b = 0; b < ARRAY_COUNT(names); b++) {
        const struct builder *builder = builder_find(names[b]);
        struct scene scene = built_soup(60, 3);
        struct reason reason = {""};
        liar = UINT32_MAX;
        seen_count = 0;
        gpu_must(builder->compare(&scene, &reason), &reason);
        const uint32_t count = seen_count;
        assert_true(count > 1);
        for (size_t l = 0; layouts_all[l]; l++)
            assert_true(!device_encodes(layouts_all[l]) || is_seen(layouts_all[l]));
        for (liar = 0; liar < count; liar++) {
            seen_count = 0;
            assert_int_equal(builder->compare(&scene, &reason), STATUS_DEVICE);
            assert_non_null(strstr(reason.text, seen[liar]->name));
            assert_non_null(strstr(reason.text, "words 7"));
        }
        scene_free(&scene);
    }
    (void)device_builders_close(NULL);
}

/* One that was opened before is closed. */
static void the_device_is_the_one_chosen_last(void **state)
{
    (void)state;
    add_builders();
    const struct engine_options usual = {.device = -1},
                                other = {.driver = "none-of-this-name", .device = -1};
    const struct build_options build = {.leaf = 4};
    struct scene scene = built_soup(20, 3);
    liar = UINT32_MAX;
    for (uint32_t turn = 0; turn < 4; turn++) {
        struct bvh bvh;
        struct reason reason = {""};
        device_builders_use(turn % 2 ? &other : &usual);
        const enum status status =
            bvh_build(builder_find(names[turn % 3]), &scene, &build, &bvh, &reason);
        assert_int_equal(status == STATUS_OK, turn % 2 == 0);
        if (!status)
            bvh_free(&bvh);
    }
    device_builders_use(&usual);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_difference_in_any_layout_is_told),
        cmocka_unit_test(the_device_is_the_one_chosen_last),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
