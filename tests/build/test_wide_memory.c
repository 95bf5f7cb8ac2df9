/* Memory that runs out while a tree in stages is collapsed and packed, in C and on a device: each
 * allocation in turn fails. It must be said in one line, with nothing made and nothing kept. */
#include "tests/support/allocations.h"

#include "gpu/build/wide_compare.h"
#include "tests/build/wide_fixture.h"
#include "tests/build/device_fixture.h"

#include "tests/support/each_fails.h"

struct wide_work {
    const struct scene *scene;
    const struct staged *staged;
    const struct staged_wide *wide;
    struct device_tree *tree;
    const struct layout *layout;
};

static enum status do_make(const void *of, struct reason *reason)
{
    const struct wide_work *work = of;
    struct staged_wide wide = {.node_count = 7};
    enum status status = staged_wide_make(work->staged, 8, 3, &wide);
    if (status)
        assert_true(!wide.node && !wide.child && !wide.item && wide.node_count == 0);
    staged_wide_free(&wide);
    return status ? (fail)(reason, status, "no memory") : STATUS_OK;
}

static enum status do_pack(const void *of, struct reason *reason)
{
    const struct wide_work *work = of;
    struct wide_tree tree = {.node_count = 7};
    struct packed packed = {.node_count = 0};
    enum status status = staged_wide_tree(work->wide, work->staged, &tree);
    if (status) {
        assert_true(!tree.node && !tree.child && tree.node_count == 0);
        return (fail)(reason, status, "no memory");
    }
    status = packed_make_tree(work->layout, &tree, work->wide->item, work->wide->item_count,
                              work->scene, &packed, reason);
    if (status)
        assert_true(!packed.word && !packed.item && packed.node_count == 0);
    wide_tree_free(&tree);
    packed_free(&packed);
    return status;
}

static enum status do_device(const void *of, struct reason *reason)
{
    const struct wide_work *work = of;
    struct device_wide wide = {.word_count = 7};
    struct device_wide_times times;
    enum status status = device_wide_make(work->tree, work->layout, &wide, &times, reason);
    if (status)
        assert_true(!wide.word && !wide.wide.node && wide.word_count == 0);
    device_wide_free(&wide);
    return status;
}

static enum status do_compare(const void *of, struct reason *reason)
{
    const struct wide_work *work = of;
    struct wide_result result;
    return wide_compare(work->tree, work->layout, work->staged, work->scene, &result, reason);
}

static void it_is_said_and_nothing_is_kept(void **state)
{
    (void)state;
    struct scene scene = built_soup(300, 1);
    struct staged staged = wide_staged(STAGED_HPLOC, &scene);
    struct staged_wide wide;
    assert_int_equal(staged_wide_make(&staged, 8, 3, &wide), STATUS_OK);
    struct wide_work work = {&scene, &staged, &wide, NULL, layout_find("cwbvh80")};
    assert_true(each_fails("staged_wide_make", do_make, &work, 1) >= 6);
    assert_true(each_fails("packed_make_tree", do_pack, &work, 1) >= 5);
    staged_wide_free(&wide);
    staged_free(&staged);
    scene_free(&scene);
}

/* The device has its buffers from a first time. */
static void so_it_is_on_a_device(void **state)
{
    (void)state;
    struct device_tree *tree = device_open(false);
    struct scene scene = built_soup(300, 1);
    struct staged staged;
    struct reason reason = {""};
    gpu_must(device_tree_build(tree, STAGED_HPLOC, &scene, &staged, NULL, &reason), &reason);
    struct wide_work work = {&scene, &staged, NULL, tree, layout_find("tiny8")};
    gpu_must(do_device(&work, &reason), &reason);
    assert_true(each_fails("device_wide_make", do_device, &work, 1) >= 8);
    assert_true(each_fails("wide_compare", do_compare, &work, 1) >= 18);
    staged_free(&staged);
    scene_free(&scene);
    device_close(tree);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_is_said_and_nothing_is_kept),
        cmocka_unit_test(so_it_is_on_a_device),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
