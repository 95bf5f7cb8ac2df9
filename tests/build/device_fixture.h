/* Devices that build trees, on every driver here. Includes cmocka.h, whose macros must come
 * last. */
#ifndef TESTS_DEVICE_FIXTURE_H
#define TESTS_DEVICE_FIXTURE_H

#include "gpu/build/device_tree.h"
#include "tests/support/gpu.h"

/* NULL where no device can be opened; the reason has been printed. */
static inline struct device_tree *device_open_with(const struct vk_options *options)
{
    struct device_tree *tree;
    struct reason reason = {""};
    enum status status = device_tree_open(options, &tree, &reason);
    if (status == STATUS_UNSUPPORTED) {
        assert_null(tree);
        print_message("SKIP %s\n", reason.text);
        return NULL;
    }
    gpu_must(status, &reason);
    return tree;
}

/* Any device; without one the test is skipped. */
static inline struct device_tree *device_open(bool validate)
{
    struct vk_options options = gpu_options();
    options.validate = options.validate || validate;
    struct device_tree *tree = device_open_with(&options);
    if (!tree)
        skip();
    return tree;
}

static inline void device_close(struct device_tree *tree)
{
    struct reason reason = {""};
    if (device_tree_close(tree, &reason) > 0)
        fail_msg("%s", reason.text);
}

/* Calls `check` with each driver that needs no GPU; skipped if none is there. */
static inline void device_each(void (*check)(struct device_tree *tree))
{
    int played = 0;
    for (size_t d = 0; d < ARRAY_COUNT(cpu_drivers); d++) {
        struct vk_options options = gpu_options();
        options.driver = cpu_drivers[d];
        struct device_tree *tree = device_open_with(&options);
        if (!tree)
            continue;
        print_message("driver %s\n", cpu_drivers[d]);
        check(tree);
        device_close(tree);
        played++;
    }
    if (played == 0)
        skip();
}

#endif
