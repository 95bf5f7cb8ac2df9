/* Shared by the vk_accel*.c files; private to them. */
#ifndef VK_ACCEL_INNER_H
#define VK_ACCEL_INNER_H

#include "gpu/vk/vk_accel.h"
#include "gpu/vk/vk_private.h"

/* One acceleration structure and its memory. */
struct level {
    struct vk_buffer *memory;
    VkAccelerationStructureKHR structure;
};

/* The geometries of one level: `count` of them, and how many primitives each has. */
struct level_input {
    const VkAccelerationStructureGeometryKHR *geometry;
    const VkAccelerationStructureBuildRangeInfoKHR *range;
    uint32_t *most; /* of range, for the sizes */
    uint32_t count;
    const VkAccelerationStructureGeometryKHR *before; /* what an update finds; else unused */
};

/* A serialised structure, in the memory of the host. */
struct level_bytes {
    uint8_t *byte;
    uint64_t count;
};

/* Makes a level in a way: builds it, or builds it of input->before and updates it. On error what
 * was made is left in *out, for vk_level_free. Errors: as vk_accel_make_world. */
enum status vk_level_build(struct vk *vk, VkAccelerationStructureTypeKHR type,
                           const struct vk_accel_how *how, const struct level_input *input,
                           struct level *out, struct reason *reason) MUST_USE;

/* Replaces a level by its compacted copy, or its clone, and frees the first. */
enum status vk_level_copy(struct vk *vk, VkAccelerationStructureTypeKHR type,
                          enum vk_accel_copy copy, struct level *level,
                          struct reason *reason) MUST_USE;

/* Serialises a level. The caller frees out->byte, also on error. */
enum status vk_level_save(struct vk *vk, const struct level *level, struct level_bytes *out,
                          struct reason *reason) MUST_USE;

/* Replaces the handles in a serialised top level: where `old` has one, by that of `now` at the same
 * place. Errors: STATUS_DEVICE a handle that is not 0 and none of `old`, or a broken header. */
enum status vk_level_relink(const struct vk *vk, struct level_bytes *bytes, const uint64_t *old,
                            const uint64_t *now, uint32_t count, struct reason *reason) MUST_USE;

/* Makes a level of what vk_level_save made, maybe on another device. Errors: as
 * vk_accel_make_world; STATUS_DEVICE the device calls the bytes incompatible. */
enum status vk_level_load(struct vk *vk, VkAccelerationStructureTypeKHR type,
                          const struct level_bytes *bytes, struct level *out,
                          struct reason *reason) MUST_USE;

/* Frees what a level holds and zeroes it. */
void vk_level_free(struct vk *vk, struct level *level);

/* The address of a level, or 0 of none. */
uint64_t vk_level_address(struct vk *vk, const struct level *level);

/* Makes memory and handle of one level of so many bytes; `mapped` for builds of the host. */
enum status vk_level_make(struct vk *vk, VkAccelerationStructureTypeKHR type, uint64_t bytes,
                          bool mapped, struct level *out, struct reason *reason) MUST_USE;

VkPhysicalDeviceAccelerationStructurePropertiesKHR vk_accel_limits(struct vk *vk);

/* The place in a buffer as the driver is told it: its address, or where the host sees it. */
VkDeviceOrHostAddressConstKHR vk_accel_place(struct vk *vk, const struct vk_accel_how *how,
                                             const struct vk_buffer *buffer, uint64_t at);

/* Checks that the host reaches a buffer (or NULL), if it has to. Errors: STATUS_UNSUPPORTED. */
enum status vk_accel_check_reach(const struct vk *vk, const struct vk_accel_how *how,
                                 const struct vk_buffer *buffer, struct reason *reason) MUST_USE;

/* Builds the level of a mesh. Errors: as vk_accel_make_world. */
enum status vk_bottom_build(struct vk *vk, const struct vk_accel_how *how,
                            const struct vk_accel_mesh *mesh, struct level *out,
                            struct reason *reason) MUST_USE;

#endif
