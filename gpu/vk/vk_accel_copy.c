/* Copies of acceleration structures: compacted, cloned, serialised and deserialised. */
#include "gpu/vk/vk_accel_inner.h"

#include <stdlib.h>
#include <string.h>

#define SERIAL_ALIGN 256u /* of the address that a structure is serialised to, by the standard */

/* The begin of a serialised structure: two UUIDs, then three numbers, then handles. */
#define SERIAL_UUIDS   (2 * VK_UUID_SIZE)
#define SERIAL_SIZE    (SERIAL_UUIDS + 8)
#define SERIAL_HANDLES (SERIAL_UUIDS + 16)
#define SERIAL_HEADER  (SERIAL_UUIDS + 24)

/* Ends a submission that wrote `access`, for later ones of all kinds. */
static enum status submit_copy(struct vk *vk, VkAccessFlags access, const char *what,
                               struct reason *reason)
{
    vk_barrier(vk, VK_PIPELINE_STAGE_ACCELERATION_STRUCTURE_BUILD_BIT_KHR, access,
               VK_PIPELINE_STAGE_ACCELERATION_STRUCTURE_BUILD_BIT_KHR |
                   VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT |
                   VK_PIPELINE_STAGE_HOST_BIT,
               VK_ACCESS_ACCELERATION_STRUCTURE_READ_BIT_KHR | VK_ACCESS_TRANSFER_READ_BIT |
                   VK_ACCESS_HOST_READ_BIT);
    return vk_submit(vk, what, reason);
}

/* Reads one size that the device tells of a structure. */
static enum status size_of(struct vk *vk, const struct level *level, VkQueryType type,
                           uint64_t *bytes, struct reason *reason)
{
    const VkQueryPoolCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO, .queryType = type, .queryCount = 1};
    VkQueryPool pool = VK_NULL_HANDLE;
    VkDeviceSize size = 0;
    enum status status = vk_check(vk, vk->fn.CreateQueryPool(vk->device, &info, NULL, &pool),
                                  "vkCreateQueryPool", reason);
    if (status)
        return status;
    status = vk_begin(vk, reason);
    if (!status) {
        vk->fn.CmdResetQueryPool(vk->command, pool, 0, 1);
        vk->fn.CmdWriteAccelerationStructuresPropertiesKHR(vk->command, 1, &level->structure, type,
                                                           pool, 0);
        status = vk_submit(vk, "asking for the size of an acceleration structure", reason);
    }
    if (!status)
        status = vk_check(
            vk,
            vk->fn.GetQueryPoolResults(vk->device, pool, 0, 1, sizeof size, &size, sizeof size,
                                       VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
            "vkGetQueryPoolResults", reason);
    if (vk_idle(vk))
        vk->fn.DestroyQueryPool(vk->device, pool, NULL);
    *bytes = size;
    if (!status && !size)
        return fail(reason, STATUS_DEVICE, "vulkan: %s has an acceleration structure of 0 bytes",
                    vk->limits.device);
    return status;
}

enum status vk_level_copy(struct vk *vk, VkAccelerationStructureTypeKHR type,
                          enum vk_accel_copy copy, struct level *level, struct reason *reason)
{
    const bool compact = copy == VK_ACCEL_COPY_COMPACT;
    struct level made = {0};
    uint64_t bytes = vk_buffer_bytes(level->memory);
    enum status status = STATUS_OK;
    if (compact)
        status = size_of(vk, level, VK_QUERY_TYPE_ACCELERATION_STRUCTURE_COMPACTED_SIZE_KHR, &bytes,
                         reason);
    if (!status)
        status = vk_level_make(vk, type, bytes, false, &made, reason);
    if (!status)
        status = vk_begin(vk, reason);
    if (!status) {
        const VkCopyAccelerationStructureInfoKHR info = {
            .sType = VK_STRUCTURE_TYPE_COPY_ACCELERATION_STRUCTURE_INFO_KHR,
            .src = level->structure,
            .dst = made.structure,
            .mode = compact ? VK_COPY_ACCELERATION_STRUCTURE_MODE_COMPACT_KHR
                            : VK_COPY_ACCELERATION_STRUCTURE_MODE_CLONE_KHR,
        };
        vk->fn.CmdCopyAccelerationStructureKHR(vk->command, &info);
        status = submit_copy(vk, VK_ACCESS_ACCELERATION_STRUCTURE_WRITE_BIT_KHR,
                             "copying an acceleration structure", reason);
    }
    if (!vk_idle(vk))
        return status;
    vk_level_free(vk, level);
    *level = made;
    return status;
}

/* Where in a buffer of SERIAL_ALIGN more bytes the serialised structure begins. */
static uint64_t serial_at(struct vk *vk, const struct vk_buffer *buffer)
{
    return (SERIAL_ALIGN - vk_address(vk, buffer) % SERIAL_ALIGN) % SERIAL_ALIGN;
}

enum status vk_level_save(struct vk *vk, const struct level *level, struct level_bytes *out,
                          struct reason *reason)
{
    struct vk_buffer *buffer = NULL;
    uint64_t bytes = 0;
    enum status status = size_of(
        vk, level, VK_QUERY_TYPE_ACCELERATION_STRUCTURE_SERIALIZATION_SIZE_KHR, &bytes, reason);
    if (!status)
        status = vk_buffer_make_unbound(vk, bytes + SERIAL_ALIGN, &buffer, reason);
    if (!status)
        status = vk_begin(vk, reason);
    if (!status) {
        const VkCopyAccelerationStructureToMemoryInfoKHR info = {
            .sType = VK_STRUCTURE_TYPE_COPY_ACCELERATION_STRUCTURE_TO_MEMORY_INFO_KHR,
            .src = level->structure,
            .dst.deviceAddress = vk_address(vk, buffer) + serial_at(vk, buffer),
            .mode = VK_COPY_ACCELERATION_STRUCTURE_MODE_SERIALIZE_KHR,
        };
        vk->fn.CmdCopyAccelerationStructureToMemoryKHR(vk->command, &info);
        status = submit_copy(vk, VK_ACCESS_TRANSFER_WRITE_BIT,
                             "serialising an acceleration structure", reason);
    }
    if (!status) {
        out->byte = alloc_zeroed(bytes, 1);
        out->count = bytes;
        status = out->byte
                     ? vk_buffer_read(vk, buffer, serial_at(vk, buffer), out->byte, bytes, reason)
                     : fail(reason, STATUS_MEMORY,
                            "vulkan: no memory for a serialised "
                            "acceleration structure");
    }
    vk_buffer_free(vk, buffer);
    return status;
}

static uint64_t number_at(const struct level_bytes *bytes, uint64_t at)
{
    uint64_t number = 0;
    if (at + sizeof number <= bytes->count)
        memcpy(&number, bytes->byte + at, sizeof number);
    return number;
}

enum status vk_level_relink(const struct vk *vk, struct level_bytes *bytes, const uint64_t *old,
                            const uint64_t *now, uint32_t count, struct reason *reason)
{
    const uint64_t handles = number_at(bytes, SERIAL_HANDLES);
    if (bytes->count < SERIAL_HEADER || handles > (bytes->count - SERIAL_HEADER) / 8)
        return fail(reason, STATUS_DEVICE,
                    "vulkan: %s serialised a structure whose header counts %llu handles in %llu "
                    "bytes",
                    vk->limits.device, (unsigned long long)handles,
                    (unsigned long long)bytes->count);
    for (uint64_t i = 0; i < handles; i++) {
        const uint64_t at = SERIAL_HEADER + 8 * i, handle = number_at(bytes, at);
        uint32_t k = 0;
        while (k < count && old[k] != handle)
            k++;
        if (k < count)
            memcpy(bytes->byte + at, &now[k], 8);
        else if (handle)
            return fail(reason, STATUS_DEVICE,
                        "vulkan: %s serialised a top level whose handle %llu, 0x%llx, is that of "
                        "no structure",
                        vk->limits.device, (unsigned long long)i, (unsigned long long)handle);
    }
    return STATUS_OK;
}

static enum status check_compatible(struct vk *vk, const struct level_bytes *bytes,
                                    struct reason *reason)
{
    const VkAccelerationStructureVersionInfoKHR version = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_VERSION_INFO_KHR,
        .pVersionData = bytes->byte,
    };
    VkAccelerationStructureCompatibilityKHR answer =
        VK_ACCELERATION_STRUCTURE_COMPATIBILITY_INCOMPATIBLE_KHR;
    vk->fn.GetDeviceAccelerationStructureCompatibilityKHR(vk->device, &version, &answer);
    if (answer == VK_ACCELERATION_STRUCTURE_COMPATIBILITY_COMPATIBLE_KHR)
        return STATUS_OK;
    return fail(reason, STATUS_DEVICE, "vulkan: %s calls what it serialised itself incompatible",
                vk->limits.device);
}

enum status vk_level_load(struct vk *vk, VkAccelerationStructureTypeKHR type,
                          const struct level_bytes *bytes, struct level *out, struct reason *reason)
{
    struct vk_buffer *buffer = NULL;
    enum status status = check_compatible(vk, bytes, reason);
    if (!status)
        status = vk_buffer_make_unbound(vk, bytes->count + SERIAL_ALIGN, &buffer, reason);
    if (!status)
        status =
            vk_buffer_write(vk, buffer, serial_at(vk, buffer), bytes->byte, bytes->count, reason);
    if (!status)
        status = vk_level_make(vk, type, number_at(bytes, SERIAL_SIZE), false, out, reason);
    if (!status)
        status = vk_begin(vk, reason);
    if (!status) {
        const VkCopyMemoryToAccelerationStructureInfoKHR info = {
            .sType = VK_STRUCTURE_TYPE_COPY_MEMORY_TO_ACCELERATION_STRUCTURE_INFO_KHR,
            .src.deviceAddress = vk_address(vk, buffer) + serial_at(vk, buffer),
            .dst = out->structure,
            .mode = VK_COPY_ACCELERATION_STRUCTURE_MODE_DESERIALIZE_KHR,
        };
        vk->fn.CmdCopyMemoryToAccelerationStructureKHR(vk->command, &info);
        status = submit_copy(vk, VK_ACCESS_ACCELERATION_STRUCTURE_WRITE_BIT_KHR,
                             "deserialising an acceleration structure", reason);
    }
    vk_buffer_free(vk, buffer);
    return status;
}
