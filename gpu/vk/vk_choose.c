/* Lists the devices and chooses one. */
#include "ref/base/text.h"
#include "gpu/vk/vk_private.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The properties of one device, chained for vkGetPhysicalDeviceProperties2. */
struct choose_answers {
    VkPhysicalDeviceProperties2 base;
    VkPhysicalDeviceMaintenance3Properties allocation;
    VkPhysicalDeviceDriverProperties driver;
    VkPhysicalDeviceFloatControlsProperties floats;
};

bool vk_has_extension(struct vk *vk, VkPhysicalDevice device, const char *name)
{
    uint32_t count = 0;
    if (vk->fn.EnumerateDeviceExtensionProperties(device, NULL, &count, NULL) < 0)
        return false;
    VkExtensionProperties *extension = alloc_zeroed(count, sizeof *extension);
    if (!extension)
        return false;
    bool found = false;
    if (vk->fn.EnumerateDeviceExtensionProperties(device, NULL, &count, extension) >= 0)
        for (uint32_t i = 0; i < count && !found; i++)
            found = strcmp(extension[i].extensionName, name) == 0;
    free(extension);
    return found;
}

/* Reads the properties that the device's version or extensions define. An unknown struct in the
 * chain would not be filled in. */
static void ask(struct vk *vk, VkPhysicalDevice device, struct choose_answers *out)
{
    *out = (struct choose_answers){
        .base.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
        .allocation.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES,
        .driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES,
        .floats.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FLOAT_CONTROLS_PROPERTIES,
    };
    vk->fn.GetPhysicalDeviceProperties(device, &out->base.properties);
    uint32_t version = out->base.properties.apiVersion;
    if (version < VK_API_VERSION_1_1)
        return;
    out->base.pNext = &out->allocation;
    if (version >= VK_API_VERSION_1_2 ||
        vk_has_extension(vk, device, VK_KHR_DRIVER_PROPERTIES_EXTENSION_NAME)) {
        out->driver.pNext = out->base.pNext;
        out->base.pNext = &out->driver;
    }
    if (version >= VK_API_VERSION_1_2 ||
        vk_has_extension(vk, device, VK_KHR_SHADER_FLOAT_CONTROLS_EXTENSION_NAME)) {
        out->floats.pNext = out->base.pNext;
        out->base.pNext = &out->floats;
    }
    vk->fn.GetPhysicalDeviceProperties2(device, &out->base);
}

/* Finds the compute queue family with the most timestamp bits; returns false if the device cannot
 * compute. *bits is the number of valid bits of its timestamps. */
static bool find_family(struct vk *vk, VkPhysicalDevice device, uint32_t *family, uint32_t *bits)
{
    VkQueueFamilyProperties properties[16];
    uint32_t count = ARRAY_COUNT(properties);
    vk->fn.GetPhysicalDeviceQueueFamilyProperties(device, &count, properties);
    bool found = false;
    *family = *bits = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (!(properties[i].queueFlags & VK_QUEUE_COMPUTE_BIT) || !properties[i].queueCount)
            continue;
        if (found && properties[i].timestampValidBits <= *bits)
            continue;
        *family = i;
        *bits = properties[i].timestampValidBits;
        found = true;
    }
    return found;
}

/* Integrated and software devices share the host's memory, so mapping it costs nothing. */
static bool is_shared(const VkPhysicalDeviceProperties *properties)
{
    return properties->deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU ||
           properties->deviceType == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU;
}

static struct vk_limits limits_of(const struct choose_answers *answers, uint32_t timestamp_bits)
{
    const VkPhysicalDeviceProperties *base = &answers->base.properties;
    struct vk_limits limits = {
        .api_version = base->apiVersion,
        .buffer_bytes = base->limits.maxStorageBufferRange,
        .groups = base->limits.maxComputeWorkGroupCount[0],
        .group_size = base->limits.maxComputeWorkGroupInvocations,
        .bindings = base->limits.maxPerStageDescriptorStorageBuffers,
        .alignment = base->limits.minStorageBufferOffsetAlignment,
        .texels = base->limits.maxTexelBufferElements,
        .timestamp_bits = timestamp_bits,
        .timestamp_ns = base->limits.timestampPeriod,
        .software = base->deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU,
        .shared_memory = is_shared(base),
        .round_to_nearest = answers->floats.shaderRoundingModeRTEFloat32,
        .keeps_denormals = answers->floats.shaderDenormPreserveFloat32,
        .keeps_inf_nan = answers->floats.shaderSignedZeroInfNanPreserveFloat32,
    };
    if (base->limits.minTexelBufferOffsetAlignment > limits.alignment)
        limits.alignment = base->limits.minTexelBufferOffsetAlignment;
    if (base->limits.maxComputeWorkGroupSize[0] < limits.group_size)
        limits.group_size = base->limits.maxComputeWorkGroupSize[0];
    if (answers->allocation.maxMemoryAllocationSize &&
        answers->allocation.maxMemoryAllocationSize < limits.buffer_bytes)
        limits.buffer_bytes = answers->allocation.maxMemoryAllocationSize;
    snprintf(limits.device, sizeof limits.device, "%s", base->deviceName);
    if (answers->driver.driverName[0])
        snprintf(limits.driver, sizeof limits.driver, "%.120s%s%.120s", answers->driver.driverName,
                 answers->driver.driverInfo[0] ? " " : "", answers->driver.driverInfo);
    else
        snprintf(limits.driver, sizeof limits.driver, "driver version 0x%x", base->driverVersion);
    return limits;
}

/* Returns true if `part` occurs in `text`, ignoring case. */
static bool contains(const char *text, const char *part)
{
    size_t length = strlen(part);
    for (; *text; text++) {
        size_t i = 0;
        while (i < length && text[i] &&
               tolower((unsigned char)text[i]) == tolower((unsigned char)part[i]))
            i++;
        if (i == length)
            return true;
    }
    return length == 0;
}

/* Returns true if the device belongs to the driver in the options. */
static bool is_wanted(const struct vk *vk, const struct vk_limits *limits)
{
    const struct driver *driver = &vk->driver;
    if (driver->kind == DRIVER_HARDWARE)
        return !limits->software;
    if (driver->kind == DRIVER_PART)
        return contains(limits->device, driver->text) || contains(limits->driver, driver->text);
    return true;
}

/* Sets *device to the loader's list, which the caller frees. */
static enum status enumerate(struct vk *vk, VkPhysicalDevice **device, uint32_t *count,
                             struct reason *reason)
{
    *device = NULL;
    VkResult result = vk->fn.EnumeratePhysicalDevices(vk->instance, count, NULL);
    if (result < 0)
        return vk_check(vk, result, "vkEnumeratePhysicalDevices", reason);
    *device = alloc_zeroed(*count, sizeof **device);
    if (!*device)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the list of devices");
    result = vk->fn.EnumeratePhysicalDevices(vk->instance, count, *device);
    if (result >= 0)
        return STATUS_OK;
    free(*device);
    *device = NULL;
    return vk_check(vk, result, "vkEnumeratePhysicalDevices", reason);
}

enum status vk_choose(struct vk *vk, struct reason *reason)
{
    VkPhysicalDevice *device;
    uint32_t count = 0;
    enum status status = enumerate(vk, &device, &count, reason);
    const char *driver = vk->options.driver;
    bool found = false;
    for (uint32_t i = 0; i < count && !status && !found; i++) {
        struct choose_answers answers;
        uint32_t bits;
        ask(vk, device[i], &answers);
        bool can = find_family(vk, device[i], &vk->family, &bits);
        vk->limits = limits_of(&answers, bits);
        found =
            can && vk->limits.api_version >= VK_API_VERSION_1_1 &&
            (vk->options.device < 0 || (uint32_t)vk->options.device == i) &&
            is_wanted(vk, &vk->limits) &&
            (!vk->options.ray_query || vk_can_query_rays(vk, device[i], vk->limits.api_version)) &&
            (!vk_ways(vk).references || vk_can_refer(vk, device[i], vk->limits.api_version));
        if (found && answers.allocation.maxMemoryAllocationSize)
            vk->allocation_bytes = answers.allocation.maxMemoryAllocationSize;
        vk->physical = device[i];
    }
    free(device);
    if (status)
        return status;
    if (found) {
        vk->limits.shared_memory = vk->limits.shared_memory && !vk->options.staging;
        vk->fn.GetPhysicalDeviceMemoryProperties(vk->physical, &vk->memory);
        return STATUS_OK;
    }
    char there[200];
    vk_list(vk, false, there, sizeof there);
    char index[16] = "any";
    if (vk->options.device >= 0)
        snprintf(index, sizeof index, "%d", vk->options.device);
    return fail(reason, STATUS_UNSUPPORTED,
                "vulkan: no device with Vulkan %s matches driver '%.40s', index %s; there is: %s",
                vk->options.ray_query    ? "ray queries (VK_KHR_ray_query)"
                : vk_ways(vk).references ? "1.2 buffer addresses"
                                         : "1.1 compute",
                driver ? driver : "any", index, count ? there : "none");
}

static void list_details(const struct vk_limits *limits, char *text, size_t text_bytes)
{
    text_append(text, text_bytes,
                "\n    Vulkan %u.%u, buffers to %llu MiB, workgroups to %u, timestamps %s",
                VK_API_VERSION_MAJOR(limits->api_version),
                VK_API_VERSION_MINOR(limits->api_version),
                (unsigned long long)(limits->buffer_bytes >> 20), limits->group_size,
                limits->timestamp_bits ? "yes" : "no (the host's clock is used)");
    text_append(text, text_bytes, "\n    f32: round to nearest %s, denormals %s, inf and NaN %s\n",
                limits->round_to_nearest ? "promised" : "not promised",
                limits->keeps_denormals ? "kept" : "not promised",
                limits->keeps_inf_nan ? "kept" : "not promised");
}

void vk_list(struct vk *vk, bool details, char *text, size_t text_bytes)
{
    VkPhysicalDevice *device;
    uint32_t count = 0;
    struct reason reason;
    text[0] = '\0';
    if (enumerate(vk, &device, &count, &reason)) {
        text_append(text, text_bytes, "%s", reason.text);
        return;
    }
    for (uint32_t i = 0; i < count; i++) {
        struct choose_answers answers;
        uint32_t family, bits;
        ask(vk, device[i], &answers);
        bool can = find_family(vk, device[i], &family, &bits);
        struct vk_limits limits = limits_of(&answers, bits);
        text_append(text, text_bytes, "%s%u: %s (%s)%s", i && !details ? "; " : "", i,
                    limits.device, limits.driver, can ? "" : ", cannot compute");
        if (details)
            list_details(&limits, text, text_bytes);
    }
    if (details && count == 0)
        text_append(text, text_bytes, "no device\n");
    free(device);
}
