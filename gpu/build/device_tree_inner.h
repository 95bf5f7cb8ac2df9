/* Between the files of this room. */
#ifndef DEVICE_TREE_INNER_H
#define DEVICE_TREE_INNER_H

#include "gpu/build/device_tree.h"
#include "ref/abi_build.h"

enum kernel {
    BOUNDS,
    CODES,
    COUNT,
    SCAN,
    SCATTER,
    LINKS,
    BOXES,
    CLUSTERS,
    REFIT, /* what follows is made when it is needed */
    REFIT_CWBVH80,
    REFIT_TINY8,
    REFIT_HALF4,
    REFIT_GRID,
    REFIT_HPB64,
    REFIT_AMD64,
    REFIT_GFX12,
    ADOPT,
    SIZES,
    OPEN,
    LEVEL,
    PLACE,
    ENCODE,
    KERNELS
};

#define DEVICE_WIDE_BUFFERS 3 /* bound in place of buffers of the build */

struct device_tree {
    struct vk *vk;
    struct vk_pipeline *kernel[KERNELS];
    struct vk_buffer *buffer[ABI_BUILD_BINDINGS];
    struct vk_buffer *wide[DEVICE_WIDE_BUFFERS];
    uint32_t poisoned;    /* buffers, since open */
    bool built;           /* a tree of `count` triangles stands in the buffers */
    bool links_in_counts; /* its links do */
    uint32_t count;
};

/* Workgroups for `count` things, `each` a workgroup. */
static inline uint32_t groups_of(uint32_t count, uint32_t each)
{
    return (count + each - 1) / each;
}

/* Makes a kernel, unless it is there. Errors: as vk_pipeline_make. */
enum status device_tree_kernel(struct device_tree *tree, enum kernel kernel,
                               struct reason *reason) MUST_USE;

/* Overwrites what earlier builds left where results will stand, with other words each time: a
 * device that does nothing must not be right. Errors: as vk_buffer_write; STATUS_MEMORY. */
enum status device_tree_poison(struct device_tree *tree, struct vk_buffer *buffer, uint64_t bytes,
                               struct reason *reason) MUST_USE;

/* Errors: STATUS_DEVICE validation messages since open. */
enum status device_tree_messages(struct device_tree *tree, struct reason *reason) MUST_USE;

#endif
