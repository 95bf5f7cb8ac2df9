/* Many dispatches in one submission, each with parts of the same buffers. */
#include "gpu/vk/vk_private.h"

#include <stdlib.h>

struct vk_sets {
    VkDescriptorSetLayout layout; /* as every pipeline's of so many bindings */
    VkDescriptorPool pool;
    uint32_t bindings, count;
    VkDescriptorSet set[];
};

static enum status make_sets(struct vk *vk, struct vk_sets *sets, struct reason *reason)
{
    VkDescriptorSetLayoutBinding binding[VK_BINDINGS_MAX];
    for (uint32_t i = 0; i < sets->bindings; i++)
        binding[i] = (VkDescriptorSetLayoutBinding){
            .binding = i,
            .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
            .descriptorCount = 1,
            .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
        };
    VkDescriptorSetLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = sets->bindings,
        .pBindings = binding,
    };
    VkResult result = vk->fn.CreateDescriptorSetLayout(vk->device, &layout, NULL, &sets->layout);
    if (result != VK_SUCCESS)
        return vk_fail(vk, reason, result, "vkCreateDescriptorSetLayout");
    const VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                       sets->bindings * sets->count};
    VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
        .maxSets = sets->count,
        .poolSizeCount = 1,
        .pPoolSizes = &size,
    };
    result = vk->fn.CreateDescriptorPool(vk->device, &pool, NULL, &sets->pool);
    if (result != VK_SUCCESS)
        return vk_fail(vk, reason, result, "vkCreateDescriptorPool");
    VkDescriptorSetAllocateInfo one = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
        .descriptorPool = sets->pool,
        .descriptorSetCount = 1,
        .pSetLayouts = &sets->layout,
    };
    for (uint32_t i = 0; i < sets->count && result == VK_SUCCESS; i++)
        result = vk->fn.AllocateDescriptorSets(vk->device, &one, &sets->set[i]);
    if (result != VK_SUCCESS)
        return vk_fail(vk, reason, result, "vkAllocateDescriptorSets");
    return STATUS_OK;
}

enum status vk_sets_make(struct vk *vk, uint32_t bindings, uint32_t count, struct vk_sets **out,
                         struct reason *reason)
{
    struct vk_sets *sets = alloc_zeroed(1, sizeof *sets + count * sizeof sets->set[0]);
    *out = NULL;
    if (!sets)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for descriptor sets");
    sets->bindings = bindings;
    sets->count = count;
    enum status status = make_sets(vk, sets, reason);
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
    if (sets->pool)
        vk->fn.DestroyDescriptorPool(vk->device, sets->pool, NULL);
    if (sets->layout)
        vk->fn.DestroyDescriptorSetLayout(vk->device, sets->layout, NULL);
    free(sets);
}

static void fill_set(struct vk *vk, VkDescriptorSet set, uint32_t bindings,
                     struct vk_buffer *const *buffer, const struct vk_work *work)
{
    VkDescriptorBufferInfo info[VK_BINDINGS_MAX];
    VkWriteDescriptorSet write = {
        .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
        .dstSet = set,
        .descriptorCount = bindings, /* runs on into the following bindings */
        .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
        .pBufferInfo = info,
    };
    for (uint32_t i = 0; i < bindings; i++)
        info[i] =
            (VkDescriptorBufferInfo){buffer[i]->buffer, work->part[i].offset, work->part[i].bytes};
    vk->fn.UpdateDescriptorSets(vk->device, 1, &write, 0, NULL);
}

static void record(struct vk *vk, VkDescriptorSet set, const struct vk_work *work, bool bind)
{
    const struct vk_pipeline *pipeline = work->pipeline;
    if (bind)
        vk->fn.CmdBindPipeline(vk->command, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline->pipeline);
    vk->fn.CmdBindDescriptorSets(vk->command, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline->layout, 0,
                                 1, &set, 0, NULL);
    if (pipeline->push_bytes)
        vk->fn.CmdPushConstants(vk->command, pipeline->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0,
                                pipeline->push_bytes, work->push);
    vk->fn.CmdDispatch(vk->command, work->groups, 1, 1);
}

enum status vk_dispatch_many(struct vk *vk, struct vk_sets *sets, struct vk_buffer *const *buffer,
                             const struct vk_work *work, uint32_t count, struct reason *reason)
{
    for (uint32_t i = 0; i < count; i++)
        if (work[i].groups > vk->limits.groups)
            return fail(reason, STATUS_LIMIT, "vulkan: %u workgroups, %s allows %u",
                        (unsigned)work[i].groups, vk->limits.device, (unsigned)vk->limits.groups);
    enum status status = vk_begin(vk, reason);
    if (status)
        return status;
    for (uint32_t i = 0; i < count; i++) {
        fill_set(vk, sets->set[i], sets->bindings, buffer, &work[i]);
        record(vk, sets->set[i], &work[i], i == 0 || work[i].pipeline != work[i - 1].pipeline);
    }
    VkMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_HOST_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT,
    };
    vk->fn.CmdPipelineBarrier(vk->command, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                              VK_PIPELINE_STAGE_HOST_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 1,
                              &barrier, 0, NULL, 0, NULL);
    return vk_submit(vk, "many dispatches", reason);
}
