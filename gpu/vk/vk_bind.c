/* How buffers are bound: as they are, by views of their texels, or by their addresses. */
#include "gpu/vk/vk_private.h"

#include <stdlib.h>
#include <string.h>

#define ADDRESS_BYTES 16u /* of the table, of each address; 8 are read */

/* Whether a part of so many bytes is a texel buffer. */
static enum status fits(const struct vk *vk, bool words, uint64_t bytes, struct reason *reason)
{
    const uint64_t elements = bytes / (words ? 4 : 16);
    return elements <= vk->limits.texels
               ? STATUS_OK
               : fail(reason, STATUS_LIMIT,
                      "vulkan: %s allows texel buffers of %u elements, %llu are needed",
                      vk->limits.device, vk->limits.texels, (unsigned long long)elements);
}

uint64_t vk_quad_bytes(const struct vk *vk)
{
    const uint64_t texels = (uint64_t)vk->limits.texels * 16;
    return vk_ways(vk).texels && texels < vk->limits.buffer_bytes ? texels
                                                                  : vk->limits.buffer_bytes;
}

enum status vk_work_check(const struct vk *vk, const struct vk_sets *sets,
                          const struct vk_work *work, struct reason *reason)
{
    enum status status = STATUS_OK;
    for (uint32_t b = 0; b < sets->bindings && !status; b++)
        if (sets->texels >> b & 1)
            status = fits(vk, work->pipeline->words >> b & 1, work->part[b].bytes, reason);
    return status;
}

/* Adds a view of a texel buffer, all of whose bytes are whole elements. */
static enum status make_view(struct vk *vk, bool words, const VkDescriptorBufferInfo *of,
                             struct reason *reason)
{
    const VkBufferViewCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO,
        .buffer = of->buffer,
        .format = words ? VK_FORMAT_R32_UINT : VK_FORMAT_R32G32B32A32_UINT,
        .offset = of->offset,
        .range = of->range,
    };
    enum status status = fits(vk, words, of->range, reason);
    if (status)
        return status;
    if (array_reserve(&vk->view, &vk->view_capacity, vk->view_count + 1, sizeof *vk->view))
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for views of buffers");
    status =
        vk_check(vk, vk->fn.CreateBufferView(vk->device, &info, NULL, &vk->view[vk->view_count]),
                 "vkCreateBufferView", reason);
    vk->view_count += status == STATUS_OK;
    return status;
}

/* The bytes between two addresses in the table. */
static uint64_t step_of(const struct vk *vk)
{
    return vk->limits.alignment > ADDRESS_BYTES ? vk->limits.alignment : ADDRESS_BYTES;
}

VkDeviceAddress vk_address(struct vk *vk, const struct vk_buffer *buffer)
{
    const VkBufferDeviceAddressInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO,
        .buffer = buffer->buffer,
    };
    return vk->fn.GetBufferDeviceAddress(vk->device, &info);
}

bool vk_can_refer(struct vk *vk, VkPhysicalDevice device, uint32_t version)
{
    VkPhysicalDeviceBufferDeviceAddressFeatures address = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES};
    VkPhysicalDeviceFeatures2 asked = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                       .pNext = &address};
    if (version < VK_API_VERSION_1_2)
        return false;
    vk->fn.GetPhysicalDeviceFeatures2(device, &asked);
    return address.bufferDeviceAddress;
}

/* Puts the address of a binding's part into the table; *info becomes its place there. */
static void put_address(struct vk *vk, uint64_t place, VkDescriptorBufferInfo *info)
{
    const struct vk_buffer named = {.buffer = info->buffer};
    const uint64_t address = vk_address(vk, &named) + info->offset;
    memcpy(vk->table->map + place, &address, sizeof address);
    *info = (VkDescriptorBufferInfo){vk->table->buffer, place, ADDRESS_BYTES};
}

enum status vk_set_write(struct vk *vk, const struct vk_sets *sets, uint32_t i, uint32_t words,
                         const VkDescriptorBufferInfo *given, struct reason *reason)
{
    VkDescriptorBufferInfo info[VK_BINDINGS_MAX];
    VkWriteDescriptorSet write[VK_BINDINGS_MAX];
    VkBufferView view[VK_BINDINGS_MAX];
    for (uint32_t b = 0; b < sets->bindings; b++) {
        const bool texels = sets->texels >> b & 1;
        info[b] = given[b];
        if (sets->references >> b & 1)
            put_address(vk, step_of(vk) * ((uint64_t)i * sets->bindings + b), &info[b]);
        write[b] = (VkWriteDescriptorSet){
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = sets->set[i],
            .dstBinding = b,
            .descriptorCount = 1,
            .descriptorType = vk_set_type(sets, b),
            .pBufferInfo = &info[b],
        };
        if (!texels)
            continue;
        enum status status = make_view(vk, words >> b & 1, &info[b], reason);
        if (status)
            return status;
        view[b] = vk->view[vk->view_count - 1];
        write[b].pTexelBufferView = &view[b];
    }
    if (!sets->texels) /* one for all: it goes on with the bindings that follow */
        write[0].descriptorCount = sets->bindings;
    vk->fn.UpdateDescriptorSets(vk->device, sets->texels ? sets->bindings : 1, write, 0, NULL);
    return STATUS_OK;
}

static void free_views(struct vk *vk)
{
    for (size_t i = 0; i < vk->view_count; i++)
        vk->fn.DestroyBufferView(vk->device, vk->view[i], NULL);
    vk->view_count = 0;
}

enum status vk_bind_begin(struct vk *vk, const struct vk_sets *sets, struct reason *reason)
{
    free_views(vk);
    if (!sets->references)
        return STATUS_OK;
    const uint64_t bytes = step_of(vk) * sets->count * sets->bindings;
    if (vk->table && vk->table->bytes >= bytes)
        return STATUS_OK;
    vk_buffer_free(vk, vk->table);
    vk->table = NULL;
    return vk_buffer_make_mapped(vk, bytes, &vk->table, reason);
}

void vk_bind_free(struct vk *vk)
{
    free_views(vk);
    free(vk->view);
    vk_buffer_free(vk, vk->table);
}
