/* Collapses the tree that a Vulkan device has built, and encodes it in a layout, where it stands:
 * the stages of ref/staged/staged_wide.h and a layout's words by the shaders of shaders/build. */
#ifndef DEVICE_WIDE_H
#define DEVICE_WIDE_H

#include "gpu/build/device_tree.h"
#include "ref/layout.h"
#include "ref/staged/staged_wide.h"

/* Owns its arrays (see device_wide_free). */
struct device_wide {
    struct staged_wide wide;
    uint32_t *word; /* of the packed tree, whose items are wide.item */
    uint32_t word_count;
};

struct device_wide_times {
    uint64_t collapse_ns, encode_ns;
    uint64_t bytes; /* that these stages need in buffers beside those of the build */
};

/* True if a device can encode this layout: cwbvh80, and tiny8 and its family. */
bool device_encodes(const struct layout *layout);

/* Collapses and encodes the tree that device_tree_build made last. What the device made is in *out
 * as it is: nothing of it is checked. Errors: STATUS_UNSUPPORTED another layout, or the device has
 * no tree; STATUS_LIMIT a bound beyond those of the layout, or the device's buffers; STATUS_DEVICE
 * also for validation messages since open; STATUS_MEMORY; *out is then zero. */
enum status device_wide_make(struct device_tree *tree, const struct layout *layout,
                             struct device_wide *out, struct device_wide_times *times,
                             struct reason *reason) MUST_USE;

void device_wide_free(struct device_wide *wide);

#endif
