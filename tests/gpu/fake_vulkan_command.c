/* What is recorded, and what shaders are made of. Copies are made at once. */
#include "tests/gpu/fake_vulkan.h"

#include <stdlib.h>
#include <string.h>

#define UNUSED (void)a, (void)fake_what(device, FAKE_DEVICE)
#define NEW(type, kind)                                                                            \
    VkResult result = fake_call(__func__);                                                         \
    if (!result)                                                                                   \
        *out = (type)fake_make(kind, NULL);                                                        \
    return result

/* What is bound to the command buffer. */
static struct {
    struct fake_object *pipeline, *set;
    uint32_t push_bytes, push[32];
} now;

void fake_unbind(void)
{
    memset(&now, 0, sizeof now);
    memset(fake.recorded, 0, sizeof fake.recorded);
    fake.barriers = 0;
}

void fake_record(char command)
{
    const size_t length = strlen(fake.recorded);
    if (length + 1 < sizeof fake.recorded)
        fake.recorded[length] = command;
}

static VkResult vkCreateShaderModule(VkDevice device, const VkShaderModuleCreateInfo *info,
                                     const VkAllocationCallbacks *a, VkShaderModule *out)
{
    UNUSED;
    if (info->codeSize < 20 || info->codeSize % 4 || info->pCode[0] != 0x07230203)
        fake_wrong("a module that is no SPIR-V");
    NEW(VkShaderModule, FAKE_MODULE);
}

static void vkDestroyShaderModule(VkDevice device, VkShaderModule module,
                                  const VkAllocationCallbacks *a)
{
    UNUSED;
    fake_drop(module, FAKE_MODULE);
}

static VkResult vkCreatePipelineLayout(VkDevice device, const VkPipelineLayoutCreateInfo *info,
                                       const VkAllocationCallbacks *a, VkPipelineLayout *out)
{
    UNUSED;
    VkResult result = fake_call(__func__);
    if (result)
        return result;
    struct fake_object *layout = fake_make(FAKE_LAYOUT, NULL);
    const VkPushConstantRange *push = info->pPushConstantRanges;
    if (info->setLayoutCount != 1 || info->pushConstantRangeCount > 1 ||
        (info->pushConstantRangeCount &&
         (push->offset || !push->size || push->stageFlags != VK_SHADER_STAGE_COMPUTE_BIT)))
        fake_wrong("the layout of a pipeline");
    (void)fake_what(info->pSetLayouts[0], FAKE_SET_LAYOUT);
    layout->bytes = info->pushConstantRangeCount ? push->size : 0;
    *out = (VkPipelineLayout)layout;
    return result;
}

static void vkDestroyPipelineLayout(VkDevice device, VkPipelineLayout layout,
                                    const VkAllocationCallbacks *a)
{
    UNUSED;
    fake_drop(layout, FAKE_LAYOUT);
}

/* Keeps its constants, by their numbers. */
static VkResult vkCreateComputePipelines(VkDevice device, VkPipelineCache cache, uint32_t count,
                                         const VkComputePipelineCreateInfo *info,
                                         const VkAllocationCallbacks *a, VkPipeline *out)
{
    UNUSED;
    (void)cache;
    VkResult result = fake_call(__func__);
    if (result)
        return result;
    struct fake_object *pipeline = fake_make(FAKE_PIPELINE, NULL);
    const VkSpecializationInfo *constants = info->stage.pSpecializationInfo;
    pipeline->count = constants->mapEntryCount;
    for (uint32_t i = 0; i < pipeline->count; i++) {
        const VkSpecializationMapEntry *entry = &constants->pMapEntries[i];
        if (entry->size != 4 || entry->constantID >= 16 || entry->offset + 4 > constants->dataSize)
            fake_wrong("constants of a pipeline");
        else
            memcpy(&pipeline->constant[entry->constantID],
                   (const uint8_t *)constants->pData + entry->offset, 4);
    }
    if (count != 1 || info->stage.stage != VK_SHADER_STAGE_COMPUTE_BIT ||
        strcmp(info->stage.pName, "main") != 0)
        fake_wrong("the stage of a pipeline");
    (void)fake_what(info->stage.module, FAKE_MODULE);
    (void)fake_what(info->layout, FAKE_LAYOUT);
    *out = (VkPipeline)pipeline;
    return result;
}

static void vkDestroyPipeline(VkDevice device, VkPipeline pipeline, const VkAllocationCallbacks *a)
{
    UNUSED;
    fake_drop(pipeline, FAKE_PIPELINE);
}

/* Counts down what it has room for. */
static void vkCmdBindPipeline(VkCommandBuffer command, VkPipelineBindPoint point, VkPipeline bound)
{
    (void)fake_what(command, FAKE_COMMAND);
    fake_record('p');
    if (point != VK_PIPELINE_BIND_POINT_COMPUTE)
        fake_wrong("no pipeline for compute");
    now.pipeline = fake_what(bound, FAKE_PIPELINE);
}

static void vkCmdBindDescriptorSets(VkCommandBuffer command, VkPipelineBindPoint point,
                                    VkPipelineLayout layout, uint32_t first, uint32_t count,
                                    const VkDescriptorSet *set, uint32_t offsets,
                                    const uint32_t *offset)
{
    (void)fake_what(command, FAKE_COMMAND);
    fake_record('s');
    (void)fake_what(layout, FAKE_LAYOUT);
    (void)offset;
    if (point != VK_PIPELINE_BIND_POINT_COMPUTE || first || count != 1 || offsets)
        fake_wrong("how a set is bound");
    now.set = fake_what(*set, FAKE_SET);
}

static void vkCmdPushConstants(VkCommandBuffer command, VkPipelineLayout layout,
                               VkShaderStageFlags stages, uint32_t offset, uint32_t bytes,
                               const void *from)
{
    (void)fake_what(command, FAKE_COMMAND);
    fake_record('k');
    if (stages != VK_SHADER_STAGE_COMPUTE_BIT || offset ||
        bytes != fake_what(layout, FAKE_LAYOUT)->bytes || bytes > sizeof now.push)
        fake_wrong("push constants");
    memcpy(now.push, from, bytes);
    now.push_bytes = bytes;
}

static void dispatch(uint32_t groups, uint64_t at)
{
    struct fake_dispatch *it = &fake.log[fake.dispatches++ % FAKE_LOG];
    if (!now.pipeline || !now.set) {
        fake_wrong("a dispatch without a pipeline or a set");
        return;
    }
    *it = (struct fake_dispatch){
        .groups = groups, .at = at, .push_bytes = now.push_bytes, .constants = now.pipeline->count};
    memcpy(it->push, now.push, sizeof now.push);
    memcpy(it->constant, now.pipeline->constant, sizeof it->constant);
    memcpy(it->part, now.set->part, sizeof it->part);
    if (fake.run)
        fake.run(it);
}

static void vkCmdDispatch(VkCommandBuffer command, uint32_t x, uint32_t y, uint32_t z)
{
    (void)fake_what(command, FAKE_COMMAND);
    fake_record('d');
    if (y != 1 || z != 1)
        fake_wrong("a dispatch in several dimensions");
    dispatch(x, 0);
}

static void vkCmdDispatchIndirect(VkCommandBuffer command, VkBuffer buffer, VkDeviceSize at)
{
    (void)fake_what(command, FAKE_COMMAND);
    fake_record('i');
    if (at + 12 > fake_what(buffer, FAKE_BUFFER)->bytes)
        fake_wrong("counts of groups beyond their buffer");
    dispatch(UINT32_MAX, at);
}

static void vkCmdUpdateBuffer(VkCommandBuffer command, VkBuffer buffer, VkDeviceSize at,
                              VkDeviceSize bytes, const void *from)
{
    (void)fake_what(command, FAKE_COMMAND);
    fake_record('u');
    struct fake_object *it = fake_what(buffer, FAKE_BUFFER);
    if (at + bytes > it->bytes)
        fake_wrong("an update beyond its buffer");
    memcpy(it->of->byte + at, from, bytes);
    fake.updates++;
}

static void vkCmdCopyBuffer(VkCommandBuffer command, VkBuffer from, VkBuffer to, uint32_t count,
                            const VkBufferCopy *region)
{
    (void)fake_what(command, FAKE_COMMAND);
    fake_record('c');
    struct fake_object *a = fake_what(from, FAKE_BUFFER), *b = fake_what(to, FAKE_BUFFER);
    if (count != 1 || region->srcOffset + region->size > a->bytes ||
        region->dstOffset + region->size > b->bytes)
        fake_wrong("a copy beyond a buffer");
    else
        memcpy(b->of->byte + region->dstOffset, a->of->byte + region->srcOffset, region->size);
}

static void vkCmdPipelineBarrier(VkCommandBuffer command, VkPipelineStageFlags from,
                                 VkPipelineStageFlags to, VkDependencyFlags flags, uint32_t count,
                                 const VkMemoryBarrier *barrier, uint32_t buffers,
                                 const VkBufferMemoryBarrier *buffer, uint32_t images,
                                 const VkImageMemoryBarrier *image)
{
    (void)fake_what(command, FAKE_COMMAND);
    fake_record('b');
    (void)buffer;
    (void)image;
    const uint32_t all[4] = {from, to, barrier->srcAccessMask, barrier->dstAccessMask};
    memcpy(fake.barrier[fake.barriers++ % 8], all, sizeof all);
    if (!from || !to || flags || count != 1 || buffers || images || !barrier->srcAccessMask ||
        !barrier->dstAccessMask)
        fake_wrong("a barrier");
}

const struct fake_entry fake_command_entry[] = {
    FAKE_ENTRY(vkCreateShaderModule),     FAKE_ENTRY(vkDestroyShaderModule),
    FAKE_ENTRY(vkCreatePipelineLayout),   FAKE_ENTRY(vkDestroyPipelineLayout),
    FAKE_ENTRY(vkCreateComputePipelines), FAKE_ENTRY(vkDestroyPipeline),
    FAKE_ENTRY(vkCmdBindPipeline),        FAKE_ENTRY(vkCmdBindDescriptorSets),
    FAKE_ENTRY(vkCmdPushConstants),       FAKE_ENTRY(vkCmdDispatch),
    FAKE_ENTRY(vkCmdDispatchIndirect),    FAKE_ENTRY(vkCmdUpdateBuffer),
    FAKE_ENTRY(vkCmdCopyBuffer),          FAKE_ENTRY(vkCmdPipelineBarrier),
};
const size_t fake_command_entries = sizeof fake_command_entry / sizeof *fake_command_entry;
