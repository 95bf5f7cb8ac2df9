/* Descriptor sets. */
#include "gpu/vk/vk_private.h"

#include <stdlib.h>

static enum status make_layout(struct vk *vk, struct vk_sets *sets, struct reason *reason)
{
    VkDescriptorSetLayoutBinding binding[VK_BINDINGS_MAX + 1];
    const uint32_t count = sets->bindings + sets->accel;
    for (uint32_t i = 0; i < count; i++)
        binding[i] = (VkDescriptorSetLayoutBinding){
            .binding = i,
            .descriptorType = i < sets->bindings ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER
                                                 : VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR,
            .descriptorCount = 1,
            .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
        };
    const VkDescriptorSetLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = count,
        .pBindings = binding,
    };
    return vk_check(vk, vk->fn.CreateDescriptorSetLayout(vk->device, &layout, NULL, &sets->layout),
                    "vkCreateDescriptorSetLayout", reason);
}

static enum status make_sets(struct vk *vk, struct vk_sets *sets, struct reason *reason)
{
    const VkDescriptorPoolSize size[] = {
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, sets->bindings * sets->count},
        {VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR, sets->count},
    };
    const VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
        .maxSets = sets->count,
        .poolSizeCount = sets->accel ? 2 : 1,
        .pPoolSizes = size,
    };
    enum status status =
        vk_check(vk, vk->fn.CreateDescriptorPool(vk->device, &pool, NULL, &sets->pool),
                 "vkCreateDescriptorPool", reason);
    const VkDescriptorSetAllocateInfo one = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
        .descriptorPool = sets->pool,
        .descriptorSetCount = 1,
        .pSetLayouts = &sets->layout,
    };
    for (uint32_t i = 0; i < sets->count && !status; i++)
        status = vk_check(vk, vk->fn.AllocateDescriptorSets(vk->device, &one, &sets->set[i]),
                          "vkAllocateDescriptorSets", reason);
    return status;
}

enum status vk_sets_make(struct vk *vk, uint32_t bindings, bool accel, uint32_t count,
                         struct vk_sets **out, struct reason *reason)
{
    struct vk_sets *sets = alloc_zeroed(1, sizeof *sets + count * sizeof sets->set[0]);
    *out = NULL;
    if (!sets)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for descriptor sets");
    sets->bindings = bindings;
    sets->accel = accel;
    sets->count = count;
    enum status status = make_layout(vk, sets, reason);
    if (!status)
        status = make_sets(vk, sets, reason);
    if (status)
        vk_sets_free(vk, sets);
    else
        *out = sets;
    return status;
}

void vk_sets_free(struct vk *vk, struct vk_sets *sets)
{
    if (!sets || !vk_idle(vk))
        return;
    vk->fn.DestroyDescriptorPool(vk->device, sets->pool, NULL);
    vk->fn.DestroyDescriptorSetLayout(vk->device, sets->layout, NULL);
    free(sets);
}

void vk_set_write(struct vk *vk, const struct vk_sets *sets, uint32_t i,
                  const VkDescriptorBufferInfo *info)
{
    const VkWriteDescriptorSet write = {
        .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
        .dstSet = sets->set[i],
        .descriptorCount = sets->bindings, /* also writes the following bindings */
        .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
        .pBufferInfo = info,
    };
    vk->fn.UpdateDescriptorSets(vk->device, 1, &write, 0, NULL);
}
