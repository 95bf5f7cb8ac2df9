/* Descriptor sets: their layouts and pools, what they bind, and views of buffers. */
#include "tests/gpu/fake_vulkan.h"

#include <string.h>

#define UNUSED (void)a, (void)fake_what(device, FAKE_DEVICE)

static VkResult vkCreateDescriptorSetLayout(VkDevice device,
                                            const VkDescriptorSetLayoutCreateInfo *info,
                                            const VkAllocationCallbacks *a,
                                            VkDescriptorSetLayout *out)
{
    UNUSED;
    VkResult result = fake_call(__func__);
    if (result)
        return result;
    struct fake_object *layout = fake_make(FAKE_SET_LAYOUT, NULL);
    for (uint32_t i = 0; i < info->bindingCount; i++) {
        const VkDescriptorSetLayoutBinding *binding = &info->pBindings[i];
        bool accel = binding->descriptorType == VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR;
        if (binding->binding != i || binding->descriptorCount != 1 ||
            binding->stageFlags != VK_SHADER_STAGE_COMPUTE_BIT ||
            (accel && i + 1 != info->bindingCount))
            fake_wrong("bindings of a set");
        layout->count += !accel;
        layout->texels |=
            (uint32_t)(binding->descriptorType == VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER) << i;
        layout->bytes += accel;
    }
    *out = (VkDescriptorSetLayout)layout;
    return result;
}

static void vkDestroyDescriptorSetLayout(VkDevice device, VkDescriptorSetLayout layout,
                                         const VkAllocationCallbacks *a)
{
    UNUSED;
    fake_drop(layout, FAKE_SET_LAYOUT);
}

static VkResult vkCreateDescriptorPool(VkDevice device, const VkDescriptorPoolCreateInfo *info,
                                       const VkAllocationCallbacks *a, VkDescriptorPool *out)
{
    UNUSED;
    VkResult result = fake_call(__func__);
    if (result)
        return result;
    struct fake_object *pool = fake_make(FAKE_POOL, NULL);
    for (uint32_t i = 0; i < info->poolSizeCount; i++)
        if (info->pPoolSizes[i].type != VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR)
            pool->constant[0] += info->pPoolSizes[i].descriptorCount;
        else
            pool->constant[1] += info->pPoolSizes[i].descriptorCount;
    pool->count = info->maxSets;
    *out = (VkDescriptorPool)pool;
    return result;
}

static void vkDestroyDescriptorPool(VkDevice device, VkDescriptorPool pool,
                                    const VkAllocationCallbacks *a)
{
    UNUSED;
    if (!pool)
        return;
    for (struct fake_object *set = fake_what(pool, FAKE_POOL)->of, *next; set; set = next) {
        next = set->of;
        fake_drop(set, FAKE_SET);
    }
    fake_drop(pool, FAKE_POOL);
}

static VkResult vkAllocateDescriptorSets(VkDevice device, const VkDescriptorSetAllocateInfo *info,
                                         VkDescriptorSet *out)
{
    (void)fake_what(device, FAKE_DEVICE);
    struct fake_object *pool = fake_what(info->descriptorPool, FAKE_POOL);
    const struct fake_object *layout = fake_what(info->pSetLayouts[0], FAKE_SET_LAYOUT);
    VkResult result = fake_call(__func__);
    if (result)
        return result;
    if (info->descriptorSetCount != 1 || pool->count < 1 || pool->constant[0] < layout->count ||
        pool->constant[1] < layout->bytes)
        fake_wrong("a set that the pool has no room for");
    pool->count--;
    pool->constant[0] -= layout->count;
    pool->constant[1] -= (uint32_t)layout->bytes;
    struct fake_object *set = fake_make(FAKE_SET, pool->of);
    set->count = layout->count;
    set->texels = layout->texels;
    pool->of = set;
    *out = (VkDescriptorSet)set;
    return result;
}

/* One binding of a set that has texel buffers. */
static void update_texels(struct fake_object *set, const VkWriteDescriptorSet *w)
{
    const bool texels = w->descriptorType == VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
    if (texels != (set->texels >> w->dstBinding & 1u) || w->descriptorCount != 1)
        fake_wrong("a descriptor of another kind");
    if (texels)
        set->part[w->dstBinding] = fake_what(*w->pTexelBufferView, FAKE_VIEW)->part[0];
    else
        set->part[w->dstBinding] =
            (struct fake_part){.byte = fake_what(w->pBufferInfo->buffer, FAKE_BUFFER)->of->byte,
                               .offset = w->pBufferInfo->offset,
                               .bytes = w->pBufferInfo->range};
}

static void vkUpdateDescriptorSets(VkDevice device, uint32_t count, const VkWriteDescriptorSet *w,
                                   uint32_t copies, const VkCopyDescriptorSet *copy)
{
    (void)fake_what(device, FAKE_DEVICE);
    (void)copy;
    struct fake_object *set = fake_what(w->dstSet, FAKE_SET);
    if (set->texels && count == set->count && !copies) {
        for (uint32_t i = 0; i < count; i++)
            update_texels(set, &w[i]);
        return;
    }
    if (count != 1 || copies || set->texels)
        fake_wrong("several updates of sets");
    if (w->descriptorType == VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR) {
        const VkWriteDescriptorSetAccelerationStructureKHR *structure = w->pNext;
        (void)fake_what(*structure->pAccelerationStructures, FAKE_ACCEL);
        if (w->dstBinding != set->count)
            fake_wrong("the binding of an acceleration structure");
        return;
    }
    if (w->dstBinding + w->descriptorCount > set->count)
        fake_wrong("a binding that the set has not");
    for (uint32_t i = 0; i < w->descriptorCount && i < FAKE_BINDINGS; i++) {
        const VkDescriptorBufferInfo *info = &w->pBufferInfo[i];
        const struct fake_object *buffer = fake_what(info->buffer, FAKE_BUFFER);
        uint64_t bytes = info->range == VK_WHOLE_SIZE ? buffer->bytes - info->offset : info->range;
        if (info->offset + bytes > buffer->bytes)
            fake_wrong("a part beyond its buffer");
        set->part[w->dstBinding + i] =
            (struct fake_part){.byte = buffer->of->byte, .offset = info->offset, .bytes = bytes};
    }
}

static VkResult vkCreateBufferView(VkDevice device, const VkBufferViewCreateInfo *info,
                                   const VkAllocationCallbacks *a, VkBufferView *out)
{
    UNUSED;
    VkResult result = fake_call(__func__);
    if (result)
        return result;
    const struct fake_object *buffer = fake_what(info->buffer, FAKE_BUFFER);
    struct fake_object *view = fake_make(FAKE_VIEW, NULL);
    const uint64_t element = info->format == VK_FORMAT_R32_UINT ? 4 : 16;
    if (info->offset + info->range > buffer->bytes || info->range % element)
        fake_wrong("a view beyond its buffer");
    view->part[0] = (struct fake_part){buffer->of->byte, info->offset, info->range, info->format};
    *out = (VkBufferView)view;
    return result;
}

static void vkDestroyBufferView(VkDevice device, VkBufferView view, const VkAllocationCallbacks *a)
{
    UNUSED;
    fake_drop(view, FAKE_VIEW);
}

/* Copies of acceleration structures. */
static void
vkCmdWriteAccelerationStructuresPropertiesKHR(VkCommandBuffer command, uint32_t count,
                                              const VkAccelerationStructureKHR *structure,
                                              VkQueryType type, VkQueryPool pool, uint32_t first)
{
    (void)fake_what(command, FAKE_COMMAND);
    (void)fake_what(*structure, FAKE_ACCEL);
    (void)fake_what(pool, FAKE_QUERY);
    if (count != 1 || first != 0 ||
        (type != VK_QUERY_TYPE_ACCELERATION_STRUCTURE_SERIALIZATION_SIZE_KHR &&
         type != VK_QUERY_TYPE_ACCELERATION_STRUCTURE_COMPACTED_SIZE_KHR))
        fake_wrong("what is asked of a structure");
}

static void vkCmdCopyAccelerationStructureKHR(VkCommandBuffer command,
                                              const VkCopyAccelerationStructureInfoKHR *info)
{
    (void)fake_what(command, FAKE_COMMAND);
    (void)fake_what(info->src, FAKE_ACCEL);
    (void)fake_what(info->dst, FAKE_ACCEL);
}

/* A head and no more: two UUIDs, sizes serialised and not, handles. */
static void
vkCmdCopyAccelerationStructureToMemoryKHR(VkCommandBuffer command,
                                          const VkCopyAccelerationStructureToMemoryInfoKHR *info)
{
    (void)fake_what(command, FAKE_COMMAND);
    (void)fake_what(info->src, FAKE_ACCEL);
    uint8_t *at = (uint8_t *)(uintptr_t)info->dst.deviceAddress;
    const uint64_t handle = fake.serial_handle ? fake.serial_handle : fake.accel_address;
    const uint64_t head[3] = {fake.serial_bytes, 2 * FAKE_ACCEL_BYTES, fake.serial_handles};
    if (info->dst.deviceAddress % 256)
        fake_wrong("where a structure is serialised to");
    memset(at, 0, fake.serial_bytes);
    for (uint64_t i = 0; i < 7 && 8 * i + 8 <= fake.serial_bytes; i++)
        memcpy(at + 8 * i, i < 4 ? &(uint64_t){0} : &head[i - 4], 8);
    for (uint64_t i = 0; i < fake.serial_handles && 64 + 8 * i <= fake.serial_bytes; i++)
        memcpy(at + 56 + 8 * i, &handle, 8);
}

static void
vkCmdCopyMemoryToAccelerationStructureKHR(VkCommandBuffer command,
                                          const VkCopyMemoryToAccelerationStructureInfoKHR *info)
{
    (void)fake_what(command, FAKE_COMMAND);
    (void)fake_what(info->dst, FAKE_ACCEL);
    if (info->src.deviceAddress % 256)
        fake_wrong("where a structure is deserialised from");
}

static void
vkGetDeviceAccelerationStructureCompatibilityKHR(VkDevice device,
                                                 const VkAccelerationStructureVersionInfoKHR *info,
                                                 VkAccelerationStructureCompatibilityKHR *out)
{
    (void)fake_what(device, FAKE_DEVICE);
    (void)info;
    *out = fake.incompatible ? VK_ACCELERATION_STRUCTURE_COMPATIBILITY_INCOMPATIBLE_KHR
                             : VK_ACCELERATION_STRUCTURE_COMPATIBILITY_COMPATIBLE_KHR;
}

const struct fake_entry fake_set_entry[] = {
    FAKE_ENTRY(vkCmdWriteAccelerationStructuresPropertiesKHR),
    FAKE_ENTRY(vkCmdCopyAccelerationStructureKHR),
    FAKE_ENTRY(vkCmdCopyAccelerationStructureToMemoryKHR),
    FAKE_ENTRY(vkCmdCopyMemoryToAccelerationStructureKHR),
    FAKE_ENTRY(vkGetDeviceAccelerationStructureCompatibilityKHR),
    FAKE_ENTRY(vkCreateDescriptorSetLayout),
    FAKE_ENTRY(vkDestroyDescriptorSetLayout),
    FAKE_ENTRY(vkCreateDescriptorPool),
    FAKE_ENTRY(vkDestroyDescriptorPool),
    FAKE_ENTRY(vkAllocateDescriptorSets),
    FAKE_ENTRY(vkUpdateDescriptorSets),
    FAKE_ENTRY(vkCreateBufferView),
    FAKE_ENTRY(vkDestroyBufferView),
};
const size_t fake_set_entries = sizeof fake_set_entry / sizeof *fake_set_entry;
