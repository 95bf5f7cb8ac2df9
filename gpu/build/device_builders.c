#include "gpu/build/device_builders.h"

#include "gpu/build/wide_compare.h"
#include "gpu/trace/vulkan_options.h"
#include "ref/build/grow.h"
#include "ref/staged/staged_builder.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NAME_MOST 128

/* One device for all builds of the process, opened by the first: opening takes longer than most
 * builds. A device is not thread-safe. */
static struct {
    pthread_mutex_t lock;
    struct device_tree *tree;
    char driver[NAME_MOST];
    int device;
    bool has_driver, closes;
} one = {.lock = PTHREAD_MUTEX_INITIALIZER, .device = -1};

static void close_at_end(void)
{
    (void)device_builders_close(NULL);
}

uint32_t device_builders_close(struct reason *reason)
{
    uint32_t messages = device_tree_close(one.tree, reason);
    one.tree = NULL;
    return messages;
}

void device_builders_use(const struct engine_options *options)
{
    (void)pthread_mutex_lock(&one.lock);
    (void)device_builders_close(NULL);
    one.has_driver = options->driver != NULL;
    one.device = options->device;
    snprintf(one.driver, sizeof one.driver, "%s", options->driver ? options->driver : "");
    (void)pthread_mutex_unlock(&one.lock);
}

/* Under the lock. */
static enum status build_locked(enum staged_kind kind, const struct scene *scene,
                                struct staged *out, struct reason *reason)
{
    const struct engine_options options = {.driver = one.has_driver ? one.driver : NULL,
                                           .device = one.device};
    const struct vk_options vk_options = vulkan_options(&options);
    enum status status = STATUS_OK;
    if (!one.closes)
        one.closes = atexit(close_at_end) == 0;
    if (!one.tree)
        status = device_tree_open(&vk_options, &one.tree, reason);
    if (!status)
        status = device_tree_build(one.tree, kind, scene, out, NULL, reason);
    return status;
}

static enum status build_on_device(enum staged_kind kind, const struct scene *scene,
                                   struct staged *out, struct reason *reason)
{
    (void)pthread_mutex_lock(&one.lock);
    enum status status = build_locked(kind, scene, out, reason);
    (void)pthread_mutex_unlock(&one.lock);
    return status;
}

static enum status build(enum staged_kind kind, const struct scene *scene,
                         const struct build_options *options, struct bvh *out,
                         struct reason *reason)
{
    struct staged staged;
    *out = (struct bvh){0};
    enum status status = build_check(scene, options, reason);
    if (!status)
        status = build_on_device(kind, scene, &staged, reason);
    if (status)
        return status;
    status = staged_write(&staged, options->leaf, out, reason);
    staged_free(&staged);
    return status;
}

/* Returns STATUS_DEVICE if there is a difference. */
static enum status tell(const struct staged_difference *at, const char *of, struct reason *reason)
{
    return at->stage ? fail(reason, STATUS_DEVICE, "%s%s %u: %s (%llu differ)", of, at->stage,
                            at->element, at->text, (unsigned long long)at->count)
                     : STATUS_OK;
}

/* What is made of the tree that the device has just built. */
static enum status compare_wide(const struct staged *mine, const struct scene *scene,
                                struct reason *reason)
{
    static const char *const names[] = {"cwbvh80", "tiny8"};
    enum status status = STATUS_OK;
    for (size_t i = 0; i < ARRAY_COUNT(names) && !status; i++) {
        struct wide_result result;
        char of[32];
        snprintf(of, sizeof of, "%s, ", names[i]);
        status = wide_compare(one.tree, layout_find(names[i]), mine, scene, &result, reason);
        if (!status)
            status = tell(&result.differs, of, reason);
    }
    return status;
}

static enum status compare_locked(enum staged_kind kind, const struct scene *scene,
                                  struct reason *reason)
{
    struct staged devices, mine = {0};
    enum status status = build_locked(kind, scene, &devices, reason);
    if (status)
        return status;
    status = staged_build(kind, scene, &mine, NULL, reason);
    if (!status) {
        struct staged_difference at = staged_compare(&devices, &mine);
        status = tell(&at, "", reason);
    }
    if (!status)
        status = compare_wide(&mine, scene, reason);
    staged_free(&devices);
    staged_free(&mine);
    return status;
}

static enum status compare(enum staged_kind kind, const struct scene *scene, struct reason *reason)
{
    (void)pthread_mutex_lock(&one.lock);
    enum status status = compare_locked(kind, scene, reason);
    (void)pthread_mutex_unlock(&one.lock);
    return status;
}

/* --- the members ------------------------------------------------------------------------------ */

#define MEMBER(kind, its_name, its_twin, its_summary)                                              \
    static enum status build_##kind(const struct scene *scene,                                     \
                                    const struct build_options *options, struct bvh *out,          \
                                    struct reason *reason)                                         \
    {                                                                                              \
        return build(kind, scene, options, out, reason);                                           \
    }                                                                                              \
    static enum status compare_##kind(const struct scene *scene, struct reason *reason)            \
    {                                                                                              \
        return compare(kind, scene, reason);                                                       \
    }                                                                                              \
    static const struct builder member_##kind = {.name = its_name,                                 \
                                                 .summary = its_summary,                           \
                                                 .build = build_##kind,                            \
                                                 .tri_bytes = STAGED_TRI_BYTES,                    \
                                                 .compare = compare_##kind,                        \
                                                 .twin = its_twin};

MEMBER(STAGED_LBVH30, "gpu_lbvh30", "lbvh30", "lbvh30 by Vulkan compute shaders")
MEMBER(STAGED_LBVH63, "gpu_lbvh63", "lbvh63", "lbvh63 by Vulkan compute shaders")
MEMBER(STAGED_HPLOC, "gpu_hploc", "hploc", "hploc by Vulkan compute shaders")

static const struct builder *const member[STAGED_KINDS] = {[STAGED_LBVH30] = &member_STAGED_LBVH30,
                                                           [STAGED_LBVH63] = &member_STAGED_LBVH63,
                                                           [STAGED_HPLOC] = &member_STAGED_HPLOC};

bool device_builder_kind(const struct builder *builder, enum staged_kind *kind)
{
    for (int k = 0; k < STAGED_KINDS; k++)
        if (member[k] == builder) {
            *kind = (enum staged_kind)k;
            return true;
        }
    return false;
}

enum status device_builders_add(struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < ARRAY_COUNT(member) && !status; i++)
        status = builder_add(member[i], reason);
    return status;
}
