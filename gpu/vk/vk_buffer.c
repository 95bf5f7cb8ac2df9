/* Storage buffers: mapped where memory is shared, else copied through a staging buffer. */
#include "gpu/vk/vk_private.h"

#include <stdlib.h>
#include <string.h>

#define STAGING_BYTES ((uint64_t)16 << 20)
#define BUFFER_LEAST  ((uint64_t)16)

#define HOST_FLAGS (VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT)

/* With ray queries any buffer may hold or feed an acceleration structure. */
#define RAY_USAGE                                                                                  \
    (VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT |                                                   \
     VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR |                        \
     VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR)

/* Finds the first allowed memory type with all of `wanted`; returns false if there is none. */
static bool find_type(const struct vk *vk, uint32_t allowed, VkMemoryPropertyFlags wanted,
                      uint32_t *type)
{
    for (uint32_t i = 0; i < vk->memory.memoryTypeCount; i++) {
        *type = i;
        if ((allowed >> i & 1) && (vk->memory.memoryTypes[i].propertyFlags & wanted) == wanted)
            return true;
    }
    return false;
}

/* Prefers cached memory for reading back, as other is slow, but only coherent memory is
 * guaranteed. */
static bool choose_type(const struct vk *vk, uint32_t allowed, bool host, uint32_t *type)
{
    if (host)
        return find_type(vk, allowed, HOST_FLAGS | VK_MEMORY_PROPERTY_HOST_CACHED_BIT, type) ||
               find_type(vk, allowed, HOST_FLAGS, type);
    return find_type(vk, allowed, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, type) ||
           find_type(vk, allowed, 0, type);
}

static enum status bind_memory(struct vk *vk, struct vk_buffer *buffer, bool host,
                               struct reason *reason)
{
    VkMemoryRequirements need;
    vk->fn.GetBufferMemoryRequirements(vk->device, buffer->buffer, &need);
    const VkMemoryAllocateFlagsInfo address = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
        .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT,
    };
    VkMemoryAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
        .pNext = vk_has_addresses(vk) ? &address : NULL,
        .allocationSize = need.size,
    };
    if (!choose_type(vk, need.memoryTypeBits, host, &info.memoryTypeIndex))
        return fail(reason, STATUS_DEVICE, "vulkan: %s has no memory type for a storage buffer",
                    vk->limits.device);
    const VkMemoryType *type = vk->memory.memoryTypes + info.memoryTypeIndex;
    uint64_t heap = vk->memory.memoryHeaps[type->heapIndex].size;
    if (need.size > heap)
        return fail(reason, STATUS_LIMIT, "vulkan: %llu bytes do not fit in a heap of %llu bytes",
                    (unsigned long long)need.size, (unsigned long long)heap);
    enum status status =
        vk_check(vk, vk->fn.AllocateMemory(vk->device, &info, NULL, &buffer->memory),
                 "vkAllocateMemory", reason);
    if (!status)
        status =
            vk_check(vk, vk->fn.BindBufferMemory(vk->device, buffer->buffer, buffer->memory, 0),
                     "vkBindBufferMemory", reason);
    if (status || !host)
        return status;
    void *map = NULL;
    VkResult mapped = vk->fn.MapMemory(vk->device, buffer->memory, 0, VK_WHOLE_SIZE, 0, &map);
    buffer->map = mapped == VK_SUCCESS ? map : NULL;
    return vk_check(vk, mapped, "vkMapMemory", reason);
}

static enum status make_buffer(struct vk *vk, uint64_t bytes, bool host, struct vk_buffer **out,
                               struct reason *reason)
{
    *out = alloc_zeroed(1, sizeof **out);
    if (!*out)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for a buffer");
    (*out)->bytes = bytes < BUFFER_LEAST ? BUFFER_LEAST : bytes;
    VkBufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
        .size = vk_buffer_size(vk, (*out)->bytes),
        .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                 VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT,
    };
    if (vk->options.ray_query)
        info.usage |= RAY_USAGE;
    if (vk_ways(vk).texels)
        info.usage |= VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;
    if (vk_ways(vk).references)
        info.usage |= VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
    enum status status = vk_check(vk, vk->fn.CreateBuffer(vk->device, &info, NULL, &(*out)->buffer),
                                  "vkCreateBuffer", reason);
    if (!status)
        status = bind_memory(vk, *out, host, reason);
    if (status) {
        vk_buffer_free(vk, *out);
        *out = NULL;
    }
    return status;
}

enum status vk_buffer_make(struct vk *vk, uint64_t bytes, struct vk_buffer **out,
                           struct reason *reason)
{
    *out = NULL;
    if (bytes > vk->limits.buffer_bytes)
        return fail(reason, STATUS_LIMIT,
                    "vulkan: %s allows storage buffers of %llu bytes, %llu are needed",
                    vk->limits.device, (unsigned long long)vk->limits.buffer_bytes,
                    (unsigned long long)bytes);
    return make_buffer(vk, bytes, vk->limits.shared_memory, out, reason);
}

enum status vk_buffer_make_unbound(struct vk *vk, uint64_t bytes, struct vk_buffer **out,
                                   struct reason *reason)
{
    *out = NULL;
    if (vk->allocation_bytes && bytes > vk->allocation_bytes)
        return fail(reason, STATUS_LIMIT,
                    "vulkan: %s allocates at most %llu bytes at once, %llu are needed",
                    vk->limits.device, (unsigned long long)vk->allocation_bytes,
                    (unsigned long long)bytes);
    return make_buffer(vk, bytes, false, out, reason);
}

enum status vk_buffer_make_of(struct vk *vk, const void *data, uint64_t bytes,
                              struct vk_buffer **out, struct reason *reason)
{
    enum status status = vk_buffer_make(vk, bytes, out, reason);
    return status || !bytes ? status : vk_buffer_write(vk, *out, 0, data, bytes, reason);
}

enum status vk_buffer_grow(struct vk *vk, uint64_t bytes, struct vk_buffer **buffer,
                           struct reason *reason)
{
    if (*buffer && (*buffer)->bytes >= bytes)
        return STATUS_OK;
    vk_buffer_free(vk, *buffer);
    return vk_buffer_make(vk, bytes, buffer, reason);
}

void vk_buffers_free(struct vk *vk, struct vk_buffer **buffer, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        vk_buffer_free(vk, buffer[i]);
        buffer[i] = NULL;
    }
}

void vk_buffer_free(struct vk *vk, struct vk_buffer *buffer)
{
    if (!buffer || !vk_idle(vk))
        return;
    if (buffer->buffer)
        vk->fn.DestroyBuffer(vk->device, buffer->buffer, NULL);
    if (buffer->memory) /* freeing memory unmaps it */
        vk->fn.FreeMemory(vk->device, buffer->memory, NULL);
    free(buffer);
}

uint64_t vk_buffer_bytes(const struct vk_buffer *buffer)
{
    return buffer ? buffer->bytes : 0;
}

static enum status copy(struct vk *vk, struct vk_buffer *from, uint64_t from_offset,
                        struct vk_buffer *to, uint64_t to_offset, uint64_t bytes,
                        struct reason *reason)
{
    enum status status = vk_begin(vk, reason);
    if (status)
        return status;
    VkBufferCopy region = {from_offset, to_offset, bytes};
    vk->fn.CmdCopyBuffer(vk->command, from->buffer, to->buffer, 1, &region);
    /* The host reads it next, or a shader in a later submission, which waits for this one's
     * fence. */
    vk_barrier(vk, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
               VK_PIPELINE_STAGE_HOST_BIT | VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
               VK_ACCESS_HOST_READ_BIT | VK_ACCESS_SHADER_READ_BIT);
    return vk_submit(vk, "copying a buffer", reason);
}

enum status vk_buffer_make_mapped(struct vk *vk, uint64_t bytes, struct vk_buffer **out,
                                  struct reason *reason)
{
    return make_buffer(vk, bytes, true, out, reason);
}

static enum status need_staging(struct vk *vk, struct reason *reason)
{
    if (vk->staging)
        return STATUS_OK;
    return make_buffer(vk, STAGING_BYTES, true, &vk->staging, reason);
}

enum status vk_buffer_write(struct vk *vk, struct vk_buffer *buffer, uint64_t offset,
                            const void *data, uint64_t bytes, struct reason *reason)
{
    if (buffer->map) {
        memcpy(buffer->map + offset, data, bytes);
        return STATUS_OK;
    }
    enum status status = need_staging(vk, reason);
    for (uint64_t done = 0; done < bytes && !status;) {
        uint64_t part = bytes - done < STAGING_BYTES ? bytes - done : STAGING_BYTES;
        memcpy(vk->staging->map, (const uint8_t *)data + done, part);
        status = copy(vk, vk->staging, 0, buffer, offset + done, part, reason);
        done += part;
    }
    return status;
}

enum status vk_buffer_read(struct vk *vk, struct vk_buffer *buffer, uint64_t offset, void *data,
                           uint64_t bytes, struct reason *reason)
{
    if (buffer->map) {
        memcpy(data, buffer->map + offset, bytes);
        return STATUS_OK;
    }
    enum status status = need_staging(vk, reason);
    for (uint64_t done = 0; done < bytes && !status;) {
        uint64_t part = bytes - done < STAGING_BYTES ? bytes - done : STAGING_BYTES;
        status = copy(vk, buffer, offset + done, vk->staging, 0, part, reason);
        if (!status)
            memcpy((uint8_t *)data + done, vk->staging->map, part);
        done += part;
    }
    return status;
}
