/* The loader, the instance and its devices. */
#include "tests/gpu/fake_vulkan.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct fake fake;

static struct fake_object physical[3];

void fake_reset(void)
{
    fake = (struct fake){
        .devices = 1, .version = VK_API_VERSION_1_3, .ticks = {1000, 3000}, .serial_bytes = 200};
    struct fake_device *device = &fake.device[0];
    *device = (struct fake_device){
        .base = {.apiVersion = VK_API_VERSION_1_3,
                 .deviceType = VK_PHYSICAL_DEVICE_TYPE_CPU,
                 .deviceName = "fake device",
                 .limits = {.maxTexelBufferElements = 65536,
                            .maxStorageBufferRange = 1u << 26,
                            .maxComputeWorkGroupCount = {65535, 65535, 65535},
                            .maxComputeWorkGroupInvocations = 1024,
                            .maxComputeWorkGroupSize = {1024, 1024, 64},
                            .maxPerStageDescriptorStorageBuffers = 8,
                            .minStorageBufferOffsetAlignment = 16,
                            .timestampPeriod = 2}},
        .allocation = 1u << 30,
        .driver_name = "fake driver",
        .driver_info = "1.2",
        .family = {{VK_QUEUE_COMPUTE_BIT, 1, 64, {1, 1, 1}}},
        .family_count = 1,
        .extension = {VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME,
                      VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
                      VK_KHR_RAY_QUERY_EXTENSION_NAME},
        .extension_count = 3,
        .has_address = true,
        .has_accel = true,
        .has_query = true,
        .scratch_alignment = 256,
        .most_triangles = 1000,
        .most_geometries = 1000,
        .most_instances = 1000,
        .memory = {.memoryTypeCount = 1,
                   .memoryTypes = {{VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT |
                                        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                        VK_MEMORY_PROPERTY_HOST_COHERENT_BIT |
                                        VK_MEMORY_PROPERTY_HOST_CACHED_BIT,
                                    0}},
                   .memoryHeapCount = 1,
                   .memoryHeaps = {{1u << 30, 0}}},
        .memory_types = ~0u,
    };
    fake.device[1] = fake.device[2] = *device;
    for (int i = 0; i < 3; i++)
        physical[i].kind = FAKE_PHYSICAL;
}

void fake_wrong(const char *what)
{
    if (!fake.wrong)
        fake.wrong = what;
}

VkResult fake_call(const char *name)
{
    fake.calls++;
    if (fake.calls != fake.fail_at && (!fake.fail_name || strcmp(fake.fail_name, name) != 0))
        return VK_SUCCESS;
    fake.failed = name;
    return fake.result;
}

static void *(*take)(size_t, size_t) = calloc;
static void (*give_back)(void *) = free;

void fake_memory(void *(*own_calloc)(size_t, size_t), void (*own_free)(void *))
{
    take = own_calloc;
    give_back = own_free;
}

void *fake_bytes(size_t bytes)
{
    void *made = take(1, bytes);
    if (!made)
        abort();
    return made;
}

struct fake_object *fake_make(enum fake_kind kind, struct fake_object *of)
{
    struct fake_object *object = fake_bytes(sizeof *object);
    object->kind = kind;
    object->of = of;
    fake.alive++;
    return object;
}

struct fake_object *fake_what(void *object, enum fake_kind kind)
{
    struct fake_object *it = object;
    if (!it || it->kind != kind)
        fake_wrong("an object of another kind");
    return it;
}

void fake_drop(void *object, enum fake_kind kind)
{
    if (!object)
        return;
    struct fake_object *it = fake_what(object, kind);
    it->kind = 0;
    fake.alive--;
    fake.destroyed++;
    give_back(it->byte);
    give_back(it);
}

static const struct fake_device *device_of(VkPhysicalDevice which)
{
    return &fake.device[fake_what(which, FAKE_PHYSICAL) - physical];
}

/* Only a list can be incomplete, not a count. */
static VkResult list_call(const char *name, bool list)
{
    VkResult result = fake_call(name);
    return result > 0 && !list ? VK_SUCCESS : result;
}

static VkResult vkEnumerateInstanceVersion(uint32_t *version)
{
    *version = fake.version;
    return fake_call(__func__);
}

static VkResult vkEnumerateInstanceLayerProperties(uint32_t *count, VkLayerProperties *layer)
{
    const uint32_t there = fake.layer ? 2 : 1;
    static const char other[] = "VK_LAYER_other";
    if (layer)
        for (uint32_t i = 0; i < there; i++)
            (void)snprintf(layer[i].layerName, sizeof layer[i].layerName, "%s",
                           i ? fake.layer : other);
    *count = there;
    return list_call(__func__, layer != NULL);
}

static VkResult vkEnumerateInstanceExtensionProperties(const char *layer, uint32_t *count,
                                                       VkExtensionProperties *out)
{
    (void)layer;
    (void)out;
    *count = 0;
    return fake_call(__func__);
}

static VkResult vkCreateInstance(const VkInstanceCreateInfo *info, const VkAllocationCallbacks *a,
                                 VkInstance *out)
{
    (void)a;
    fake.api = info->pApplicationInfo->apiVersion;
    const VkValidationFeaturesEXT *checks = info->pNext;
    for (uint32_t i = 0; checks && i < checks->enabledValidationFeatureCount; i++) {
        const VkValidationFeatureEnableEXT feature = checks->pEnabledValidationFeatures[i];
        fake.checks = fake.checks || feature == VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_EXT;
        fake.races =
            fake.races || feature == VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    }
    if (info->enabledLayerCount != (fake.layer ? 1 : 0) ||
        info->enabledExtensionCount != 2 * info->enabledLayerCount)
        fake_wrong("layers and extensions of the instance");
    VkResult result = fake_call(__func__);
    if (!result)
        *out = (VkInstance)fake_make(FAKE_INSTANCE, NULL);
    return result;
}

static void vkDestroyInstance(VkInstance instance, const VkAllocationCallbacks *a)
{
    (void)a;
    fake_drop(instance, FAKE_INSTANCE);
    if (fake.alive)
        fake_wrong("an instance destroyed before what it made");
}

static VkResult vkEnumeratePhysicalDevices(VkInstance instance, uint32_t *count,
                                           VkPhysicalDevice *out)
{
    (void)fake_what(instance, FAKE_INSTANCE);
    for (uint32_t i = 0; out && i < fake.devices; i++)
        out[i] = (VkPhysicalDevice)&physical[i];
    *count = fake.devices;
    return list_call(__func__, out != NULL);
}

static void vkGetPhysicalDeviceProperties(VkPhysicalDevice which, VkPhysicalDeviceProperties *out)
{
    *out = device_of(which)->base;
}

static void vkGetPhysicalDeviceProperties2(VkPhysicalDevice which,
                                           VkPhysicalDeviceProperties2 *asked)
{
    const struct fake_device *device = device_of(which);
    asked->properties = device->base;
    for (VkBaseOutStructure *s = asked->pNext; s; s = s->pNext) {
        if (s->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES) {
            ((VkPhysicalDeviceMaintenance3Properties *)s)->maxMemoryAllocationSize =
                device->allocation;
        } else if (s->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES) {
            VkPhysicalDeviceDriverProperties *driver = (void *)s;
            (void)snprintf(driver->driverName, sizeof driver->driverName, "%s",
                           device->driver_name);
            (void)snprintf(driver->driverInfo, sizeof driver->driverInfo, "%s",
                           device->driver_info);
        } else if (s->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FLOAT_CONTROLS_PROPERTIES) {
            VkPhysicalDeviceFloatControlsProperties *floats = (void *)s;
            floats->shaderRoundingModeRTEFloat32 = device->nearest;
            floats->shaderDenormPreserveFloat32 = device->denormals;
            floats->shaderSignedZeroInfNanPreserveFloat32 = device->inf_nan;
        } else if (s->sType ==
                   VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_PROPERTIES_KHR) {
            VkPhysicalDeviceAccelerationStructurePropertiesKHR *accel = (void *)s;
            accel->minAccelerationStructureScratchOffsetAlignment = device->scratch_alignment;
            accel->maxPrimitiveCount = device->most_triangles;
            accel->maxGeometryCount = device->most_geometries;
            accel->maxInstanceCount = device->most_instances;
        } else {
            fake_wrong("an unknown question in vkGetPhysicalDeviceProperties2");
        }
    }
}

static void vkGetPhysicalDeviceFeatures2(VkPhysicalDevice which, VkPhysicalDeviceFeatures2 *asked)
{
    const struct fake_device *device = device_of(which);
    for (VkBaseOutStructure *s = asked->pNext; s; s = s->pNext) {
        if (s->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES)
            ((VkPhysicalDeviceBufferDeviceAddressFeatures *)s)->bufferDeviceAddress =
                device->has_address;
        else if (s->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR)
            *(VkPhysicalDeviceAccelerationStructureFeaturesKHR *)s =
                (VkPhysicalDeviceAccelerationStructureFeaturesKHR){
                    .sType = s->sType,
                    .pNext = s->pNext,
                    .accelerationStructure = device->has_accel,
                    .accelerationStructureIndirectBuild = device->has_indirect,
                    .accelerationStructureHostCommands = device->has_host};
        else if (s->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR)
            ((VkPhysicalDeviceRayQueryFeaturesKHR *)s)->rayQuery = device->has_query;
        else
            fake_wrong("an unknown question in vkGetPhysicalDeviceFeatures2");
    }
}

static void vkGetPhysicalDeviceFormatProperties(VkPhysicalDevice which, VkFormat format,
                                                VkFormatProperties *out)
{
    (void)device_of(which);
    (void)format;
    *out = (VkFormatProperties){0};
}

static void vkGetPhysicalDeviceMemoryProperties(VkPhysicalDevice which,
                                                VkPhysicalDeviceMemoryProperties *out)
{
    *out = device_of(which)->memory;
}

static void vkGetPhysicalDeviceQueueFamilyProperties(VkPhysicalDevice which, uint32_t *count,
                                                     VkQueueFamilyProperties *out)
{
    const struct fake_device *device = device_of(which);
    if (*count < device->family_count)
        fake_wrong("no room for all queue families");
    memcpy(out, device->family, device->family_count * sizeof *out);
    *count = device->family_count;
}

static VkResult vkEnumerateDeviceExtensionProperties(VkPhysicalDevice which, const char *layer,
                                                     uint32_t *count, VkExtensionProperties *out)
{
    const struct fake_device *device = device_of(which);
    (void)layer;
    for (uint32_t i = 0; out && i < device->extension_count; i++)
        (void)snprintf(out[i].extensionName, sizeof out[i].extensionName, "%s",
                       device->extension[i]);
    *count = device->extension_count;
    return list_call(__func__, out != NULL);
}

/* The features that were enabled must be those of ray queries, that of addresses, or none. */
static VkResult vkCreateDevice(VkPhysicalDevice which, const VkDeviceCreateInfo *info,
                               const VkAllocationCallbacks *a, VkDevice *out)
{
    (void)a;
    const struct fake_device *device = device_of(which);
    fake.chosen = device;
    fake.family = info->pQueueCreateInfos->queueFamilyIndex;
    fake.robust = info->pEnabledFeatures->robustBufferAccess;
    fake.extensions = info->enabledExtensionCount;
    uint32_t features = 0;
    bool address = false;
    for (const VkBaseInStructure *s = info->pNext; s; s = s->pNext)
        features += ((const VkPhysicalDeviceRayQueryFeaturesKHR *)s)->rayQuery; /* their first */
    if (features == 1)
        address = ((const VkBaseInStructure *)info->pNext)->sType ==
                  VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES;
    if (info->queueCreateInfoCount != 1 || info->pQueueCreateInfos->queueCount != 1 ||
        fake.family >= device->family_count || (features != 0 && features != 3 && !address))
        fake_wrong("queues and features of the device");
    VkResult result = fake_call(__func__);
    if (!result)
        *out = (VkDevice)(fake.opened = fake_make(FAKE_DEVICE, NULL));
    return result;
}

static VkResult vkCreateDebugUtilsMessengerEXT(VkInstance instance,
                                               const VkDebugUtilsMessengerCreateInfoEXT *info,
                                               const VkAllocationCallbacks *a,
                                               VkDebugUtilsMessengerEXT *out)
{
    (void)a;
    (void)fake_what(instance, FAKE_INSTANCE);
    fake.messenger = *info;
    VkResult result = fake_call(__func__);
    if (!result)
        *out = (VkDebugUtilsMessengerEXT)fake_make(FAKE_MESSENGER, NULL);
    return result;
}

static void vkDestroyDebugUtilsMessengerEXT(VkInstance instance, VkDebugUtilsMessengerEXT messenger,
                                            const VkAllocationCallbacks *a)
{
    (void)a;
    (void)fake_what(instance, FAKE_INSTANCE);
    fake_drop(messenger, FAKE_MESSENGER);
}

static PFN_vkVoidFunction find(const struct fake_entry *entry, size_t count, const char *name)
{
    if (fake.missing && strcmp(fake.missing, name) == 0)
        return NULL;
    for (size_t i = 0; i < count; i++)
        if (strcmp(entry[i].name, name) == 0)
            return entry[i].function;
    return NULL;
}

static PFN_vkVoidFunction vkGetDeviceProcAddr(VkDevice device, const char *name)
{
    (void)fake_what(device, FAKE_DEVICE);
    PFN_vkVoidFunction function = find(fake_device_entry, fake_device_entries, name);
    if (!function)
        function = find(fake_command_entry, fake_command_entries, name);
    return function ? function : find(fake_set_entry, fake_set_entries, name);
}

static const struct fake_entry global_entry[] = {
    FAKE_ENTRY(vkEnumerateInstanceVersion),
    FAKE_ENTRY(vkEnumerateInstanceLayerProperties),
    FAKE_ENTRY(vkEnumerateInstanceExtensionProperties),
    FAKE_ENTRY(vkCreateInstance),
};

static const struct fake_entry instance_entry[] = {
    FAKE_ENTRY(vkDestroyInstance),
    FAKE_ENTRY(vkEnumeratePhysicalDevices),
    FAKE_ENTRY(vkGetPhysicalDeviceProperties),
    FAKE_ENTRY(vkGetPhysicalDeviceProperties2),
    FAKE_ENTRY(vkGetPhysicalDeviceFeatures2),
    FAKE_ENTRY(vkGetPhysicalDeviceFormatProperties),
    FAKE_ENTRY(vkGetPhysicalDeviceMemoryProperties),
    FAKE_ENTRY(vkGetPhysicalDeviceQueueFamilyProperties),
    FAKE_ENTRY(vkEnumerateDeviceExtensionProperties),
    FAKE_ENTRY(vkCreateDevice),
    FAKE_ENTRY(vkGetDeviceProcAddr),
    FAKE_ENTRY(vkCreateDebugUtilsMessengerEXT),
    FAKE_ENTRY(vkDestroyDebugUtilsMessengerEXT),
};

/* As Vulkan has it: without an instance only the global ones are found. */
PFN_vkVoidFunction vkGetInstanceProcAddr(VkInstance instance, const char *name);
PFN_vkVoidFunction vkGetInstanceProcAddr(VkInstance instance, const char *name)
{
    if (!instance)
        return find(global_entry, sizeof global_entry / sizeof *global_entry, name);
    return find(instance_entry, sizeof instance_entry / sizeof *instance_entry, name);
}
