/* Builds trees on a Vulkan device, by the shaders of shaders/build, in the stages of
 * ref/staged/staged.h. */
#ifndef DEVICE_TREE_H
#define DEVICE_TREE_H

#include "gpu/vk/vk.h"
#include "ref/staged/staged.h"

struct device_tree; /* an open device with its pipelines and buffers */

/* What is timed, each in a submission of its own. */
enum device_stage {
    DEVICE_CODES, /* bounds of the scene, codes */
    DEVICE_ORDER, /* the radix sort */
    DEVICE_LINKS,
    DEVICE_BOXES, /* of H-PLOC with the merging, which makes the links anew */
    DEVICE_STAGES
};

extern const char *const device_stage_names[DEVICE_STAGES];

struct device_times {
    uint64_t ns[DEVICE_STAGES];
    uint64_t bytes; /* that the build needs in buffers */
};

/* Opens a device. *out is NULL on error. Errors: as vk_open and vk_pipeline_make;
 * STATUS_UNSUPPORTED the device has too few storage buffers for a shader. */
enum status device_tree_open(const struct vk_options *options, struct device_tree **out,
                             struct reason *reason) MUST_USE;

/* Returns the number of validation messages, as vk_close. NULL is fine. */
uint32_t device_tree_close(struct device_tree *tree, struct reason *reason);

const struct vk_limits *device_tree_limits(const struct device_tree *tree);

/* Builds the tree of a checked scene. What the device made is in *out as it is: nothing of it is
 * checked. `times` may be NULL. Errors: STATUS_LIMIT more triangles than STAGED_MOST or than the
 * device's buffers and groups can hold; STATUS_DEVICE also for validation messages since open;
 * STATUS_MEMORY; *out is then zero. */
enum status device_tree_build(struct device_tree *tree, enum staged_kind kind,
                              const struct scene *scene, struct staged *out,
                              struct device_times *times, struct reason *reason) MUST_USE;

#endif
