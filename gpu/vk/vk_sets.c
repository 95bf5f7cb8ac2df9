/* Descriptor sets. */
#include "gpu/vk/vk_private.h"

#include <stdlib.h>

VkDescriptorType vk_set_type(const struct vk_sets *sets, uint32_t binding)
{
    return sets->texels >> binding & 1 ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER
                                       : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

static enum status make_layout(struct vk *vk, struct vk_sets *sets, struct reason *reason)
{
    VkDescriptorSetLayoutBinding binding[VK_BINDINGS_MAX + 1];
    const uint32_t count = sets->bindings + sets->accel;
    for (uint32_t i = 0; i < count; i++)
        binding[i] = (VkDescriptorSetLayoutBinding){
            .binding = i,
            .descriptorType = i < sets->bindings ? vk_set_type(sets, i)
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
    uint32_t texels = 0, kinds = 0;
    VkDescriptorPoolSize size[3];
    for (uint32_t i = 0; i < sets->bindings; i++)
        texels += sets->texels >> i & 1;
    if (sets->bindings > texels)
        size[kinds++] = (VkDescriptorPoolSize){VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                               (sets->bindings - texels) * sets->count};
    if (texels)
        size[kinds++] =
            (VkDescriptorPoolSize){VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, texels * sets->count};
    if (sets->accel)
        size[kinds++] =
            (VkDescriptorPoolSize){VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR, sets->count};
    const VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
        .maxSets = sets->count,
        .poolSizeCount = kinds,
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

struct vk_ways vk_ways(const struct vk *vk)
{
    return vk->options.compiler ? vk->options.compiler->ways : (struct vk_ways){0, 0};
}

enum status vk_sets_make(struct vk *vk, uint32_t bindings, struct vk_ways ways, bool accel,
                         uint32_t count, struct vk_sets **out, struct reason *reason)
{
    struct vk_sets *sets = alloc_zeroed(1, sizeof *sets + count * sizeof sets->set[0]);
    *out = NULL;
    if (!sets)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for descriptor sets");
    sets->bindings = bindings;
    sets->accel = accel;
    sets->texels = ways.texels;
    sets->references = ways.references;
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
