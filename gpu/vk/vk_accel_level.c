/* Builds and updates one acceleration structure: on the device, indirectly, or by the host. */
#include "gpu/vk/vk_accel_inner.h"

#include <stdlib.h>

VkPhysicalDeviceAccelerationStructurePropertiesKHR vk_accel_limits(struct vk *vk)
{
    VkPhysicalDeviceAccelerationStructurePropertiesKHR limits = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_PROPERTIES_KHR};
    VkPhysicalDeviceProperties2 asked = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
                                         .pNext = &limits};
    vk->fn.GetPhysicalDeviceProperties2(vk->physical, &asked);
    return limits;
}

enum status vk_level_make(struct vk *vk, VkAccelerationStructureTypeKHR type, uint64_t bytes,
                          bool mapped, struct level *out, struct reason *reason)
{
    enum status status = mapped ? vk_buffer_make_mapped(vk, bytes, &out->memory, reason)
                                : vk_buffer_make_unbound(vk, bytes, &out->memory, reason);
    if (status)
        return status;
    const VkAccelerationStructureCreateInfoKHR info = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR,
        .buffer = out->memory->buffer,
        .size = bytes,
        .type = type,
    };
    return vk_check(vk,
                    vk->fn.CreateAccelerationStructureKHR(vk->device, &info, NULL, &out->structure),
                    "vkCreateAccelerationStructureKHR", reason);
}

void vk_level_free(struct vk *vk, struct level *level)
{
    if (level->structure)
        vk->fn.DestroyAccelerationStructureKHR(vk->device, level->structure, NULL);
    vk_buffer_free(vk, level->memory);
    *level = (struct level){0};
}

uint64_t vk_level_address(struct vk *vk, const struct level *level)
{
    const VkAccelerationStructureDeviceAddressInfoKHR where = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR,
        .accelerationStructure = level->structure,
    };
    return level->structure ? vk->fn.GetAccelerationStructureDeviceAddressKHR(vk->device, &where)
                            : 0;
}

static VkBuildAccelerationStructureFlagsKHR flags_of(const struct vk_accel_how *how)
{
    const bool updates = how->allow_update || how->update != VK_ACCEL_UPDATE_NONE;
    const bool compacts = how->allow_compaction || how->copy == VK_ACCEL_COPY_COMPACT;
    return (how->fast_trace ? VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR : 0u) |
           (how->fast_build ? VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_BUILD_BIT_KHR : 0u) |
           (how->low_memory ? VK_BUILD_ACCELERATION_STRUCTURE_LOW_MEMORY_BIT_KHR : 0u) |
           (updates ? VK_BUILD_ACCELERATION_STRUCTURE_ALLOW_UPDATE_BIT_KHR : 0u) |
           (compacts ? VK_BUILD_ACCELERATION_STRUCTURE_ALLOW_COMPACTION_BIT_KHR : 0u);
}

/* It is read by the next build, update or copy, and by shaders. All are later submissions, which
 * wait for this one's fence. */
static void barrier_behind_build(struct vk *vk)
{
    vk_barrier(vk, VK_PIPELINE_STAGE_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
               VK_ACCESS_ACCELERATION_STRUCTURE_WRITE_BIT_KHR,
               VK_PIPELINE_STAGE_ACCELERATION_STRUCTURE_BUILD_BIT_KHR |
                   VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
               VK_ACCESS_ACCELERATION_STRUCTURE_READ_BIT_KHR);
}

/* Records the build whose ranges lie in a buffer. */
static void record_indirect(struct vk *vk, const VkAccelerationStructureBuildGeometryInfoKHR *info,
                            const struct level_input *input, const struct vk_buffer *ranges)
{
    const VkDeviceAddress at = vk_address(vk, ranges);
    const uint32_t stride = sizeof *input->range;
    const uint32_t *most = input->most;
    vk->fn.CmdBuildAccelerationStructuresIndirectKHR(vk->command, 1, info, &at, &stride, &most);
}

/* Builds or updates once, on the device. */
static enum status build_device(struct vk *vk, VkAccelerationStructureBuildGeometryInfoKHR *info,
                                const struct level_input *input, bool indirect,
                                uint64_t scratch_bytes, struct reason *reason)
{
    uint64_t align = vk_accel_limits(vk).minAccelerationStructureScratchOffsetAlignment;
    align = align ? align : 1;
    struct vk_buffer *scratch = NULL, *ranges = NULL;
    enum status status = vk_buffer_make_unbound(vk, scratch_bytes + align, &scratch, reason);
    if (!status && indirect)
        status = vk_buffer_make_of(vk, input->range, input->count * sizeof *input->range, &ranges,
                                   reason);
    if (!status)
        status = vk_begin(vk, reason);
    if (!status) {
        info->scratchData.deviceAddress = (vk_address(vk, scratch) + align - 1) / align * align;
        if (indirect)
            record_indirect(vk, info, input, ranges);
        else
            vk->fn.CmdBuildAccelerationStructuresKHR(vk->command, 1, info, &input->range);
        barrier_behind_build(vk);
        status = vk_submit(vk, "building an acceleration structure", reason);
    }
    vk_buffer_free(vk, scratch);
    vk_buffer_free(vk, ranges);
    return status;
}

/* The same by the host. */
static enum status build_host(struct vk *vk, VkAccelerationStructureBuildGeometryInfoKHR *info,
                              const struct level_input *input, uint64_t scratch_bytes,
                              struct reason *reason)
{
    void *scratch = alloc_zeroed(scratch_bytes + 1, 1);
    if (!scratch)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for a build by the host");
    info->scratchData.hostAddress = scratch;
    enum status status = vk_check(
        vk,
        vk->fn.BuildAccelerationStructuresKHR(vk->device, VK_NULL_HANDLE, 1, info, &input->range),
        "vkBuildAccelerationStructuresKHR", reason);
    free(scratch);
    return status;
}

static enum status build_once(struct vk *vk, const struct vk_accel_how *how,
                              VkAccelerationStructureBuildGeometryInfoKHR *info,
                              const struct level_input *input, uint64_t scratch_bytes,
                              struct reason *reason)
{
    if (how->where == VK_ACCEL_BY_HOST)
        return build_host(vk, info, input, scratch_bytes, reason);
    return build_device(vk, info, input, how->where == VK_ACCEL_INDIRECT, scratch_bytes, reason);
}

enum status vk_level_build(struct vk *vk, VkAccelerationStructureTypeKHR type,
                           const struct vk_accel_how *how, const struct level_input *input,
                           struct level *out, struct reason *reason)
{
    const bool host = how->where == VK_ACCEL_BY_HOST;
    const bool updates = how->update != VK_ACCEL_UPDATE_NONE;
    VkAccelerationStructureBuildGeometryInfoKHR info = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR,
        .type = type,
        .flags = flags_of(how),
        .mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR,
        .geometryCount = input->count,
        .pGeometries = updates ? input->before : input->geometry,
    };
    VkAccelerationStructureBuildSizesInfoKHR sizes = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR};
    vk->fn.GetAccelerationStructureBuildSizesKHR(
        vk->device,
        host ? VK_ACCELERATION_STRUCTURE_BUILD_TYPE_HOST_KHR
             : VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR,
        &info, input->most, &sizes);
    enum status status =
        vk_level_make(vk, type, sizes.accelerationStructureSize, host, out, reason);
    info.dstAccelerationStructure = out->structure;
    if (!status)
        status = build_once(vk, how, &info, input, sizes.buildScratchSize, reason);
    if (status || !updates)
        return status;
    struct level old = *out;
    if (how->update == VK_ACCEL_UPDATE_INTO) {
        *out = (struct level){0};
        status = vk_level_make(vk, type, sizes.accelerationStructureSize, host, out, reason);
    }
    info.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_UPDATE_KHR;
    info.pGeometries = input->geometry;
    info.srcAccelerationStructure = old.structure;
    info.dstAccelerationStructure = out->structure;
    if (!status)
        status = build_once(vk, how, &info, input, sizes.updateScratchSize, reason);
    if (how->update == VK_ACCEL_UPDATE_INTO && vk_idle(vk))
        vk_level_free(vk, &old);
    return status;
}
