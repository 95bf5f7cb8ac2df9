/* The device: its queue, fence, timestamps, buffers, memory and acceleration structures. */
#include "tests/gpu/fake_vulkan.h"

#include <stdlib.h>
#include <string.h>

#define UNUSED (void)a, (void)fake_what(device, FAKE_DEVICE)
#define NEW(type, kind)                                                                            \
    VkResult result = fake_call(__func__);                                                         \
    if (!result)                                                                                   \
        *out = (type)fake_make(kind, NULL);                                                        \
    return result

/* The state of the command buffer. */
static struct {
    bool recording, ended, submitted;
} now;

static void shift(uint64_t *last, uint64_t value)
{
    memmove(last + 1, last, 3 * sizeof *last);
    last[0] = value;
}

static void vkDestroyDevice(VkDevice device, const VkAllocationCallbacks *a)
{
    UNUSED;
    long instances = 1;
    fake_drop(device, FAKE_DEVICE);
    instances += fake.messenger.pUserData != NULL;
    if (fake.alive > instances)
        fake_wrong("a device destroyed before what it made");
}

static VkResult vkDeviceWaitIdle(VkDevice device)
{
    (void)fake_what(device, FAKE_DEVICE);
    fake.idles++;
    return fake_call(__func__);
}

static void vkGetDeviceQueue(VkDevice device, uint32_t family, uint32_t index, VkQueue *out)
{
    static struct fake_object queue = {.kind = FAKE_QUEUE};
    (void)fake_what(device, FAKE_DEVICE);
    if (family != fake.family || index != 0)
        fake_wrong("a queue that was not made");
    *out = (VkQueue)&queue;
}

static VkResult vkQueueSubmit(VkQueue queue, uint32_t count, const VkSubmitInfo *info,
                              VkFence fence)
{
    (void)fake_what(queue, FAKE_QUEUE);
    (void)fake_what(fence, FAKE_FENCE);
    if (count != 1 || info->commandBufferCount != 1 || !now.ended)
        fake_wrong("what is submitted");
    now.submitted = true;
    return fake_call(__func__);
}

static VkResult vkCreateFence(VkDevice device, const VkFenceCreateInfo *info,
                              const VkAllocationCallbacks *a, VkFence *out)
{
    UNUSED;
    if (info->flags)
        fake_wrong("a fence that is signalled");
    NEW(VkFence, FAKE_FENCE);
}

static void vkDestroyFence(VkDevice device, VkFence fence, const VkAllocationCallbacks *a)
{
    UNUSED;
    fake_drop(fence, FAKE_FENCE);
}

static VkResult vkResetFences(VkDevice device, uint32_t count, const VkFence *fence)
{
    (void)fake_what(device, FAKE_DEVICE);
    (void)fake_what(*fence, FAKE_FENCE);
    now.submitted = false;
    if (count != 1)
        fake_wrong("fences that are reset");
    return fake_call(__func__);
}

static VkResult vkWaitForFences(VkDevice device, uint32_t count, const VkFence *fence, VkBool32 all,
                                uint64_t ns)
{
    (void)fake_what(device, FAKE_DEVICE);
    (void)fake_what(*fence, FAKE_FENCE);
    (void)all;
    shift(fake.waited, ns);
    if (count != 1 || !now.submitted)
        fake_wrong("a wait for what was not submitted");
    if (fake.waits_in_vain) {
        fake.waits_in_vain--;
        return VK_TIMEOUT;
    }
    return fake_call(__func__);
}

static VkResult vkCreateCommandPool(VkDevice device, const VkCommandPoolCreateInfo *info,
                                    const VkAllocationCallbacks *a, VkCommandPool *out)
{
    UNUSED;
    if (info->queueFamilyIndex != fake.family)
        fake_wrong("commands of another queue family");
    NEW(VkCommandPool, FAKE_COMMANDS);
}

static void vkDestroyCommandPool(VkDevice device, VkCommandPool pool,
                                 const VkAllocationCallbacks *a)
{
    UNUSED;
    fake_drop(pool, FAKE_COMMANDS);
}

static VkResult vkResetCommandPool(VkDevice device, VkCommandPool pool, VkCommandPoolResetFlags f)
{
    (void)fake_what(device, FAKE_DEVICE);
    (void)fake_what(pool, FAKE_COMMANDS);
    (void)f;
    now.recording = now.ended = false;
    fake_unbind();
    return fake_call(__func__);
}

static VkResult vkAllocateCommandBuffers(VkDevice device, const VkCommandBufferAllocateInfo *info,
                                         VkCommandBuffer *out)
{
    static struct fake_object command = {.kind = FAKE_COMMAND};
    (void)fake_what(device, FAKE_DEVICE);
    (void)fake_what(info->commandPool, FAKE_COMMANDS);
    if (info->commandBufferCount != 1)
        fake_wrong("several command buffers");
    *out = (VkCommandBuffer)&command;
    return fake_call(__func__);
}

static VkResult vkBeginCommandBuffer(VkCommandBuffer command, const VkCommandBufferBeginInfo *info)
{
    (void)fake_what(command, FAKE_COMMAND);
    if (now.recording || !(info->flags & VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT))
        fake_wrong("a command buffer begun twice");
    now.recording = true;
    return fake_call(__func__);
}

static VkResult vkEndCommandBuffer(VkCommandBuffer command)
{
    (void)fake_what(command, FAKE_COMMAND);
    if (!now.recording)
        fake_wrong("the end of a command buffer that was not begun");
    now.ended = true;
    return fake_call(__func__);
}

static VkResult vkCreateQueryPool(VkDevice device, const VkQueryPoolCreateInfo *info,
                                  const VkAllocationCallbacks *a, VkQueryPool *out)
{
    UNUSED;
    if (info->queryCount != (info->queryType == VK_QUERY_TYPE_TIMESTAMP ? 2 : 1))
        fake_wrong("queries that are no two timestamps and no size");
    NEW(VkQueryPool, FAKE_QUERY);
}

static void vkDestroyQueryPool(VkDevice device, VkQueryPool pool, const VkAllocationCallbacks *a)
{
    UNUSED;
    fake_drop(pool, FAKE_QUERY);
}

static VkResult vkGetQueryPoolResults(VkDevice device, VkQueryPool pool, uint32_t first,
                                      uint32_t count, size_t bytes, void *out, VkDeviceSize stride,
                                      VkQueryResultFlags flags)
{
    (void)fake_what(device, FAKE_DEVICE);
    (void)fake_what(pool, FAKE_QUERY);
    if (count == 1) {
        if (first != 0 || bytes != 8 ||
            flags != (VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT))
            fake_wrong("how a size is read");
        memcpy(out, &fake.serial_bytes, 8);
        return fake_call(__func__);
    }
    if (first != 0 || count != 2 || bytes != 16 || stride != 8 || flags != VK_QUERY_RESULT_64_BIT)
        fake_wrong("how timestamps are read");
    memcpy(out, fake.ticks, 16);
    return fake.no_ticks ? VK_NOT_READY : VK_SUCCESS;
}

static void vkCmdResetQueryPool(VkCommandBuffer command, VkQueryPool pool, uint32_t first,
                                uint32_t count)
{
    (void)fake_what(command, FAKE_COMMAND);
    fake_record('r');
    (void)fake_what(pool, FAKE_QUERY);
    if (first != 0 || count < 1 || count > 2)
        fake_wrong("timestamps that are not reset");
}

static void vkCmdWriteTimestamp(VkCommandBuffer command, VkPipelineStageFlagBits stage,
                                VkQueryPool pool, uint32_t query)
{
    (void)fake_what(command, FAKE_COMMAND);
    fake_record('t');
    (void)fake_what(pool, FAKE_QUERY);
    if (stage != (query ? VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT : VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT))
        fake_wrong("the stage of a timestamp");
}

static VkResult vkCreateBuffer(VkDevice device, const VkBufferCreateInfo *info,
                               const VkAllocationCallbacks *a, VkBuffer *out)
{
    UNUSED;
    VkResult result = fake_call(__func__);
    if (result)
        return result;
    struct fake_object *buffer = fake_make(FAKE_BUFFER, NULL);
    buffer->bytes = info->size;
    *out = (VkBuffer)buffer;
    return result;
}

static void vkDestroyBuffer(VkDevice device, VkBuffer buffer, const VkAllocationCallbacks *a)
{
    UNUSED;
    fake_drop(buffer, FAKE_BUFFER);
}

static void vkGetBufferMemoryRequirements(VkDevice device, VkBuffer buffer,
                                          VkMemoryRequirements *out)
{
    (void)fake_what(device, FAKE_DEVICE);
    *out = (VkMemoryRequirements){fake_what(buffer, FAKE_BUFFER)->bytes, 16,
                                  fake.chosen->memory_types};
}

static VkResult vkAllocateMemory(VkDevice device, const VkMemoryAllocateInfo *info,
                                 const VkAllocationCallbacks *a, VkDeviceMemory *out)
{
    UNUSED;
    shift(fake.memory_type, info->memoryTypeIndex);
    VkResult result = fake_call(__func__);
    if (result)
        return result;
    struct fake_object *memory = fake_make(FAKE_MEMORY, NULL);
    memory->bytes = info->allocationSize;
    memory->byte = fake_bytes(memory->bytes);
    memory->count = info->memoryTypeIndex;
    *out = (VkDeviceMemory)memory;
    return result;
}

static void vkFreeMemory(VkDevice device, VkDeviceMemory memory, const VkAllocationCallbacks *a)
{
    UNUSED;
    fake_drop(memory, FAKE_MEMORY);
}

static VkResult vkBindBufferMemory(VkDevice device, VkBuffer buffer, VkDeviceMemory memory,
                                   VkDeviceSize offset)
{
    (void)fake_what(device, FAKE_DEVICE);
    struct fake_object *it = fake_what(buffer, FAKE_BUFFER);
    it->of = fake_what(memory, FAKE_MEMORY);
    if (offset + it->bytes > it->of->bytes)
        fake_wrong("a buffer beyond its memory");
    return fake_call(__func__);
}

static VkResult vkMapMemory(VkDevice device, VkDeviceMemory memory, VkDeviceSize offset,
                            VkDeviceSize bytes, VkMemoryMapFlags flags, void **out)
{
    (void)fake_what(device, FAKE_DEVICE);
    (void)flags;
    struct fake_object *it = fake_what(memory, FAKE_MEMORY);
    if (offset || bytes != VK_WHOLE_SIZE ||
        !(fake.chosen->memory.memoryTypes[it->count].propertyFlags &
          VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT))
        fake_wrong("how memory is mapped");
    *out = it->byte;
    return fake_call(__func__);
}

/* Acceleration structures. `asked`: the buffer whose address was asked for last. */
static const struct fake_object *asked;

static VkDeviceAddress vkGetBufferDeviceAddress(VkDevice device,
                                                const VkBufferDeviceAddressInfo *info)
{
    (void)fake_what(device, FAKE_DEVICE);
    asked = fake_what(info->buffer, FAKE_BUFFER);
    return (VkDeviceAddress)(uintptr_t)asked->of->byte;
}

static VkResult vkCreateAccelerationStructureKHR(VkDevice device,
                                                 const VkAccelerationStructureCreateInfoKHR *info,
                                                 const VkAllocationCallbacks *a,
                                                 VkAccelerationStructureKHR *out)
{
    UNUSED;
    if (info->offset + info->size > fake_what(info->buffer, FAKE_BUFFER)->bytes)
        fake_wrong("an acceleration structure beyond its buffer");
    NEW(VkAccelerationStructureKHR, FAKE_ACCEL);
}

static void vkDestroyAccelerationStructureKHR(VkDevice device, VkAccelerationStructureKHR structure,
                                              const VkAllocationCallbacks *a)
{
    UNUSED;
    fake_drop(structure, FAKE_ACCEL);
}

static void
vkGetAccelerationStructureBuildSizesKHR(VkDevice device, VkAccelerationStructureBuildTypeKHR type,
                                        const VkAccelerationStructureBuildGeometryInfoKHR *info,
                                        const uint32_t *most,
                                        VkAccelerationStructureBuildSizesInfoKHR *out)
{
    (void)fake_what(device, FAKE_DEVICE);
    bool top = info->type == VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR;
    if (type != VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR || info->geometryCount == 0 ||
        (top && info->geometryCount != 1))
        fake_wrong("what is built");
    out->accelerationStructureSize = 0;
    for (uint32_t i = 0; i < info->geometryCount; i++)
        out->accelerationStructureSize += FAKE_ACCEL_BYTES * (uint64_t)most[i];
    out->buildScratchSize = FAKE_SCRATCH_BYTES;
}

static VkDeviceAddress
vkGetAccelerationStructureDeviceAddressKHR(VkDevice device,
                                           const VkAccelerationStructureDeviceAddressInfoKHR *info)
{
    (void)fake_what(device, FAKE_DEVICE);
    fake.accel_address = (uintptr_t)fake_what(info->accelerationStructure, FAKE_ACCEL);
    return fake.accel_address;
}

/* The scratch memory lies in the buffer whose address was asked for last. */
static void
vkCmdBuildAccelerationStructuresKHR(VkCommandBuffer command, uint32_t count,
                                    const VkAccelerationStructureBuildGeometryInfoKHR *info,
                                    const VkAccelerationStructureBuildRangeInfoKHR *const *range)
{
    (void)fake_what(command, FAKE_COMMAND);
    fake_record('a');
    (void)fake_what(info->dstAccelerationStructure, FAKE_ACCEL);
    const uint64_t scratch = info->scratchData.deviceAddress;
    const uint64_t begin = (uintptr_t)asked->of->byte;
    if (count != 1 || scratch % fake.chosen->scratch_alignment || scratch < begin ||
        scratch + FAKE_SCRATCH_BYTES > begin + asked->bytes)
        fake_wrong("the scratch memory of a build");
    uint32_t built = 0;
    for (uint32_t i = 0; i < info->geometryCount; i++) {
        if (info->type == VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR &&
            range[0][i].primitiveOffset != 12 * built)
            fake_wrong("the first triangle of a geometry");
        built += range[0][i].primitiveCount;
    }
    fake.built[fake.builds++ % 4] = built;
}

const struct fake_entry fake_device_entry[] = {
    FAKE_ENTRY(vkDestroyDevice),
    FAKE_ENTRY(vkDeviceWaitIdle),
    FAKE_ENTRY(vkGetDeviceQueue),
    FAKE_ENTRY(vkQueueSubmit),
    FAKE_ENTRY(vkCreateFence),
    FAKE_ENTRY(vkDestroyFence),
    FAKE_ENTRY(vkResetFences),
    FAKE_ENTRY(vkWaitForFences),
    FAKE_ENTRY(vkCreateCommandPool),
    FAKE_ENTRY(vkDestroyCommandPool),
    FAKE_ENTRY(vkResetCommandPool),
    FAKE_ENTRY(vkAllocateCommandBuffers),
    FAKE_ENTRY(vkBeginCommandBuffer),
    FAKE_ENTRY(vkEndCommandBuffer),
    FAKE_ENTRY(vkCreateQueryPool),
    FAKE_ENTRY(vkDestroyQueryPool),
    FAKE_ENTRY(vkGetQueryPoolResults),
    FAKE_ENTRY(vkCmdResetQueryPool),
    FAKE_ENTRY(vkCmdWriteTimestamp),
    FAKE_ENTRY(vkCreateBuffer),
    FAKE_ENTRY(vkDestroyBuffer),
    FAKE_ENTRY(vkGetBufferMemoryRequirements),
    FAKE_ENTRY(vkAllocateMemory),
    FAKE_ENTRY(vkFreeMemory),
    FAKE_ENTRY(vkBindBufferMemory),
    FAKE_ENTRY(vkMapMemory),
    FAKE_ENTRY(vkGetBufferDeviceAddress),
    FAKE_ENTRY(vkCreateAccelerationStructureKHR),
    FAKE_ENTRY(vkDestroyAccelerationStructureKHR),
    FAKE_ENTRY(vkGetAccelerationStructureBuildSizesKHR),
    FAKE_ENTRY(vkGetAccelerationStructureDeviceAddressKHR),
    FAKE_ENTRY(vkCmdBuildAccelerationStructuresKHR),
};
const size_t fake_device_entries = sizeof fake_device_entry / sizeof *fake_device_entry;
