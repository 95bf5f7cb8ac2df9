/* Opens and closes a device, and submits work to it. */
#include "gpu/vk/vk_private.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* How long to wait for a device that hung before its objects are left undestroyed. */
#define GRACE_NS 10000000000u

static const char *result_text(VkResult result)
{
    switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
        return "out of host memory";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
        return "out of device memory";
    case VK_ERROR_INITIALIZATION_FAILED:
        return "initialization failed";
    case VK_ERROR_DEVICE_LOST:
        return "device lost";
    case VK_ERROR_MEMORY_MAP_FAILED:
        return "memory cannot be mapped";
    case VK_ERROR_LAYER_NOT_PRESENT:
        return "layer not present";
    case VK_ERROR_EXTENSION_NOT_PRESENT:
        return "extension not present";
    case VK_ERROR_FEATURE_NOT_PRESENT:
        return "feature not present";
    case VK_ERROR_TOO_MANY_OBJECTS:
        return "too many objects";
    default:
        return "failed";
    }
}

enum status vk_check(struct vk *vk, VkResult result, const char *what, struct reason *reason)
{
    if (result == VK_SUCCESS)
        return STATUS_OK;
    bool memory = result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY;
    if (result == VK_ERROR_DEVICE_LOST)
        vk->given_up = true;
    return fail(reason, memory ? STATUS_MEMORY : STATUS_DEVICE, "vulkan: %s: %s (VkResult %d)",
                what, result_text(result), (int)result);
}

/* Enables robust buffer access, which every device has, so that a broken tree does not hurt the
 * driver. It is off where accesses are checked, as it would hide errors. */
static enum status make_device(struct vk *vk, struct reason *reason)
{
    VkPhysicalDeviceFeatures features = {.robustBufferAccess = !vk->options.watch};
    VkDeviceQueueCreateInfo queue = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
        .queueFamilyIndex = vk->family,
        .queueCount = 1,
        .pQueuePriorities = (const float[]){1.0f},
    };
    struct vk_ray_features ray;
    VkPhysicalDeviceBufferDeviceAddressFeatures address = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES,
        .bufferDeviceAddress = VK_TRUE};
    void *more = vk_has_addresses(vk) ? &address : NULL;
    if (vk->options.ray_query) {
        more = vk_ray_chain(&ray, true);
        ray.accel.accelerationStructureIndirectBuild = vk->options.ray_more.indirect;
        ray.accel.accelerationStructureHostCommands = vk->options.ray_more.host;
    }
    VkDeviceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
        .pNext = more,
        .queueCreateInfoCount = 1,
        .pQueueCreateInfos = &queue,
        .enabledExtensionCount = vk->options.ray_query ? VK_RAY_EXTENSIONS : 0,
        .ppEnabledExtensionNames = vk_ray_extensions,
        .pEnabledFeatures = &features,
    };
    VkResult result = vk->fn.CreateDevice(vk->physical, &info, NULL, &vk->device);
    enum status status = vk_check(vk, result, "vkCreateDevice", reason);
    if (!status)
        status = vk_load_device(vk, reason);
    if (!status)
        vk->fn.GetDeviceQueue(vk->device, vk->family, 0, &vk->queue);
    return status;
}

static enum status make_commands(struct vk *vk, struct reason *reason)
{
    VkCommandPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
        .queueFamilyIndex = vk->family,
    };
    enum status status = vk_check(vk, vk->fn.CreateCommandPool(vk->device, &pool, NULL, &vk->pool),
                                  "vkCreateCommandPool", reason);
    if (status)
        return status;
    VkCommandBufferAllocateInfo command = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .commandPool = vk->pool,
        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
        .commandBufferCount = 1,
    };
    status = vk_check(vk, vk->fn.AllocateCommandBuffers(vk->device, &command, &vk->command),
                      "vkAllocateCommandBuffers", reason);
    VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    if (!status)
        status = vk_check(vk, vk->fn.CreateFence(vk->device, &fence, NULL, &vk->fence),
                          "vkCreateFence", reason);
    if (status || !vk->limits.timestamp_bits)
        return status;
    VkQueryPoolCreateInfo query = {
        .sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
        .queryType = VK_QUERY_TYPE_TIMESTAMP,
        .queryCount = 2,
    };
    return vk_check(vk, vk->fn.CreateQueryPool(vk->device, &query, NULL, &vk->query),
                    "vkCreateQueryPool", reason);
}

/* Opens library, instance and functions, without a device. */
static enum status open_instance(const struct vk_options *options, struct vk **out,
                                 struct reason *reason)
{
    struct vk *vk = alloc_zeroed(1, sizeof *vk);
    *out = vk;
    if (!vk)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the device");
    vk->options = *options;
    const char *whole = getenv("RAYDIFF_WHOLE_MODULES");
    if (whole && strcmp(whole, "1") == 0)
        vk->options.whole_modules = true;
    struct driver_scope scope = {0};
    enum status status = driver_find(options->driver, &vk->driver, reason);
    if (!status)
        status = vk_load_library(vk, reason);
    if (!status)
        status = driver_begin(&vk->driver, &scope, reason);
    if (!status)
        status = vk_instance_make(vk, reason);
    driver_end(&scope);
    return status;
}

enum status vk_open(const struct vk_options *options, struct vk **out, struct reason *reason)
{
    enum status status = open_instance(options, out, reason);
    if (!status)
        status = vk_choose(*out, reason);
    if (!status)
        status = vk_check_ray_more(*out, reason);
    if (!status)
        status = make_device(*out, reason);
    if (!status)
        status = make_commands(*out, reason);
    if (status) {
        (void)vk_close(*out, NULL);
        *out = NULL;
    }
    return status;
}

bool vk_idle(struct vk *vk)
{
    if (vk->pending && !vk->stuck) {
        VkResult result = vk->fn.WaitForFences(vk->device, 1, &vk->fence, VK_TRUE, GRACE_NS);
        vk->stuck = result != VK_SUCCESS && result != VK_ERROR_DEVICE_LOST;
        vk->pending = vk->stuck;
    }
    return !vk->stuck;
}

static void close_device(struct vk *vk)
{
    if (!vk->device || !vk->fn.DestroyDevice)
        return;
    vk_buffer_free(vk, vk->staging);
    vk_bind_free(vk);
    if (vk->query)
        vk->fn.DestroyQueryPool(vk->device, vk->query, NULL);
    if (vk->fence)
        vk->fn.DestroyFence(vk->device, vk->fence, NULL);
    if (vk->pool)
        vk->fn.DestroyCommandPool(vk->device, vk->pool, NULL);
    vk->fn.DestroyDevice(vk->device, NULL);
}

uint32_t vk_close(struct vk *vk, struct reason *reason)
{
    if (!vk)
        return 0;
    if (!vk_idle(vk))
        return vk_messages(vk, reason);
    close_device(vk);
    if (vk->messenger)
        vk->fn.DestroyDebugUtilsMessengerEXT(vk->instance, vk->messenger, NULL);
    if (vk->instance && vk->fn.DestroyInstance)
        vk->fn.DestroyInstance(vk->instance, NULL);
    uint32_t messages = vk_messages(vk, reason);
    /* The loader stays loaded. Unloading it unloads drivers whose threads and thread-local
     * destructors may still run, and leak checkers could then not name the owner of lost memory. */
    free(vk);
    return messages;
}

const struct vk_limits *vk_limits(const struct vk *vk)
{
    return &vk->limits;
}

void vk_describe(const struct vk_options *options, char *text, size_t text_bytes)
{
    struct vk *vk;
    struct reason reason;
    if (open_instance(options, &vk, &reason))
        snprintf(text, text_bytes, "%s\n", reason.text);
    else
        vk_list(vk, true, text, text_bytes);
    (void)vk_close(vk, NULL);
}

enum status vk_begin(struct vk *vk, struct reason *reason)
{
    if (vk->given_up)
        return fail(reason, STATUS_DEVICE, "vulkan: the device was lost or hung before");
    enum status status = vk_check(vk, vk->fn.ResetCommandPool(vk->device, vk->pool, 0),
                                  "vkResetCommandPool", reason);
    if (status)
        return status;
    VkCommandBufferBeginInfo begin = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
        .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
    };
    return vk_check(vk, vk->fn.BeginCommandBuffer(vk->command, &begin), "vkBeginCommandBuffer",
                    reason);
}

enum status vk_submit(struct vk *vk, const char *what, struct reason *reason)
{
    enum status status =
        vk_check(vk, vk->fn.EndCommandBuffer(vk->command), "vkEndCommandBuffer", reason);
    if (!status)
        status =
            vk_check(vk, vk->fn.ResetFences(vk->device, 1, &vk->fence), "vkResetFences", reason);
    VkSubmitInfo submit = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
        .commandBufferCount = 1,
        .pCommandBuffers = &vk->command,
    };
    if (!status)
        status = vk_check(vk, vk->fn.QueueSubmit(vk->queue, 1, &submit, vk->fence), "vkQueueSubmit",
                          reason);
    if (status)
        return status;
    vk->pending = true;
    uint64_t wait_ns = vk->options.wait_ns ? vk->options.wait_ns : VK_WAIT_NS;
    VkResult result = vk->fn.WaitForFences(vk->device, 1, &vk->fence, VK_TRUE, wait_ns);
    if (result == VK_TIMEOUT) {
        vk->given_up = true;
        return fail(reason, STATUS_DEVICE, "vulkan: %s on %s hangs: not done after %.3f s", what,
                    vk->limits.device, (double)wait_ns * 1e-9);
    }
    vk->pending = false;
    /* Waits for the layer, which may report accesses from a thread of its own. */
    if (result == VK_SUCCESS && vk->options.watch)
        result = vk->fn.DeviceWaitIdle(vk->device);
    return vk_check(vk, result, what, reason);
}
