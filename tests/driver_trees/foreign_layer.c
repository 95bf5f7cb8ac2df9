/* A Vulkan layer that makes a driver another one: the trees that it serialises begin with a UUID
 * that no driver has. It uses nothing of raydiff. */
#include <vulkan/vulkan.h>

#include <string.h>

static PFN_vkVoidFunction own_call(const char *name);

#define LAYER_OWN(name) own_call(name)
#include "tests/support/module_layer.h"

static VkDevice device_of;
static VkBuffer buffer_of; /* the last whose address was asked for */
static VkDeviceAddress address_of;

static VKAPI_ATTR VkResult VKAPI_CALL make_module(VkDevice device,
                                                  const VkShaderModuleCreateInfo *info,
                                                  const VkAllocationCallbacks *allocator,
                                                  VkShaderModule *out)
{
    return next_module(device, info, allocator, out);
}

static VKAPI_ATTR VkDeviceAddress VKAPI_CALL give_address(VkDevice device,
                                                          const VkBufferDeviceAddressInfo *info)
{
    PFN_vkGetBufferDeviceAddress next =
        (PFN_vkGetBufferDeviceAddress)next_device(device, "vkGetBufferDeviceAddress");
    device_of = device;
    buffer_of = info->buffer;
    return address_of = next(device, info);
}

static VKAPI_ATTR void VKAPI_CALL serialise(VkCommandBuffer commands,
                                            const VkCopyAccelerationStructureToMemoryInfoKHR *info)
{
    static const char uuid[16] = "none of these";
    PFN_vkCmdCopyAccelerationStructureToMemoryKHR copy =
        (PFN_vkCmdCopyAccelerationStructureToMemoryKHR)next_device(
            device_of, "vkCmdCopyAccelerationStructureToMemoryKHR");
    PFN_vkCmdUpdateBuffer update =
        (PFN_vkCmdUpdateBuffer)next_device(device_of, "vkCmdUpdateBuffer");
    copy(commands, info);
    update(commands, buffer_of, info->dst.deviceAddress - address_of, sizeof uuid, uuid);
}

static PFN_vkVoidFunction own_call(const char *name)
{
    if (strncmp(name, "vkGetBufferDeviceAddress", 24) == 0)
        return (PFN_vkVoidFunction)give_address;
    if (strcmp(name, "vkCmdCopyAccelerationStructureToMemoryKHR") == 0)
        return (PFN_vkVoidFunction)serialise;
    return NULL;
}
