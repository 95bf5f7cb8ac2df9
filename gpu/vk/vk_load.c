/* Finds the Vulkan loader and its functions at run time. */
#define _GNU_SOURCE /* dl_iterate_phdr */
#include "gpu/vk/vk_private.h"

#include <dlfcn.h>
#include <link.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define LOADER "libvulkan.so.1"

/* An entry point: its name and its offset in struct vk_fn. */
struct entry {
    const char *name;
    size_t offset;
};

#define ENTRY(name)                                                                                \
    {                                                                                              \
        "vk" #name, offsetof(struct vk_fn, name)                                                   \
    }

static const struct entry global_entry[] = {
    ENTRY(EnumerateInstanceVersion),
    ENTRY(EnumerateInstanceLayerProperties),
    ENTRY(EnumerateInstanceExtensionProperties),
    ENTRY(CreateInstance),
};

static const struct entry instance_entry[] = {
    ENTRY(DestroyInstance),
    ENTRY(EnumeratePhysicalDevices),
    ENTRY(GetPhysicalDeviceProperties),
    ENTRY(GetPhysicalDeviceProperties2),
    ENTRY(GetPhysicalDeviceFeatures2),
    ENTRY(GetPhysicalDeviceMemoryProperties),
    ENTRY(GetPhysicalDeviceQueueFamilyProperties),
    ENTRY(EnumerateDeviceExtensionProperties),
    ENTRY(CreateDevice),
    ENTRY(GetDeviceProcAddr),
};

static const struct entry debug_entry[] = {
    ENTRY(CreateDebugUtilsMessengerEXT),
    ENTRY(DestroyDebugUtilsMessengerEXT),
};

static const struct entry device_entry[] = {
    ENTRY(DestroyDevice),
    ENTRY(DeviceWaitIdle),
    ENTRY(GetDeviceQueue),
    ENTRY(QueueSubmit),
    ENTRY(CreateFence),
    ENTRY(DestroyFence),
    ENTRY(ResetFences),
    ENTRY(WaitForFences),
    ENTRY(CreateCommandPool),
    ENTRY(DestroyCommandPool),
    ENTRY(ResetCommandPool),
    ENTRY(AllocateCommandBuffers),
    ENTRY(BeginCommandBuffer),
    ENTRY(EndCommandBuffer),
    ENTRY(CreateQueryPool),
    ENTRY(DestroyQueryPool),
    ENTRY(GetQueryPoolResults),
    ENTRY(CmdResetQueryPool),
    ENTRY(CmdWriteTimestamp),
    ENTRY(CreateBuffer),
    ENTRY(DestroyBuffer),
    ENTRY(GetBufferMemoryRequirements),
    ENTRY(AllocateMemory),
    ENTRY(FreeMemory),
    ENTRY(BindBufferMemory),
    ENTRY(MapMemory),
    ENTRY(CmdCopyBuffer),
    ENTRY(CmdPipelineBarrier),
    ENTRY(CreateShaderModule),
    ENTRY(DestroyShaderModule),
    ENTRY(CreateDescriptorSetLayout),
    ENTRY(DestroyDescriptorSetLayout),
    ENTRY(CreatePipelineLayout),
    ENTRY(DestroyPipelineLayout),
    ENTRY(CreateComputePipelines),
    ENTRY(DestroyPipeline),
    ENTRY(CreateDescriptorPool),
    ENTRY(DestroyDescriptorPool),
    ENTRY(AllocateDescriptorSets),
    ENTRY(UpdateDescriptorSets),
    ENTRY(CmdBindPipeline),
    ENTRY(CmdBindDescriptorSets),
    ENTRY(CmdPushConstants),
    ENTRY(CmdDispatch),
    ENTRY(CmdDispatchIndirect),
    ENTRY(CmdUpdateBuffer),
    ENTRY(CreateBufferView),
    ENTRY(DestroyBufferView),
};

static const struct entry address_entry[] = {
    ENTRY(GetBufferDeviceAddress),
};

static const struct entry ray_entry[] = {
    ENTRY(CreateAccelerationStructureKHR),        ENTRY(DestroyAccelerationStructureKHR),
    ENTRY(GetAccelerationStructureBuildSizesKHR), ENTRY(GetAccelerationStructureDeviceAddressKHR),
    ENTRY(CmdBuildAccelerationStructuresKHR),
};

/* With vk_options.ray_more: of any way but the plain one, then of the instance, and of features. */
static const struct entry life_entry[] = {
    ENTRY(CmdCopyAccelerationStructureKHR),
    ENTRY(CmdCopyAccelerationStructureToMemoryKHR),
    ENTRY(CmdCopyMemoryToAccelerationStructureKHR),
    ENTRY(CmdWriteAccelerationStructuresPropertiesKHR),
    ENTRY(GetDeviceAccelerationStructureCompatibilityKHR),
};

static const struct entry format_entry[] = {
    ENTRY(GetPhysicalDeviceFormatProperties),
};

static const struct entry indirect_entry[] = {
    ENTRY(CmdBuildAccelerationStructuresIndirectKHR),
};

static const struct entry host_entry[] = {
    ENTRY(BuildAccelerationStructuresKHR),
};

/* Stores one function. All function pointers have the same representation (POSIX). */
static enum status store(struct vk *vk, const struct entry *entry, PFN_vkVoidFunction function,
                         struct reason *reason)
{
    if (!function)
        return fail(reason, STATUS_UNSUPPORTED, "vulkan: the loader or driver lacks %s",
                    entry->name);
    memcpy((char *)&vk->fn + entry->offset, &function, sizeof function);
    return STATUS_OK;
}

/* Loads functions of the device if there is one, else of the instance. */
static enum status load(struct vk *vk, const struct entry *entry, size_t count,
                        struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < count && !status; i++)
        status = store(vk, entry + i,
                       vk->device ? vk->fn.GetDeviceProcAddr(vk->device, entry[i].name)
                                  : vk->fn.GetInstanceProcAddr(vk->instance, entry[i].name),
                       reason);
    return status;
}

enum status vk_load_library(struct vk *vk, struct reason *reason)
{
    const char *name = vk->options.library ? vk->options.library : LOADER;
    vk->library = dlopen(name, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    if (!vk->library)
        return fail(reason, STATUS_UNSUPPORTED, "vulkan: no loader: %s", dlerror());
    void *symbol = dlsym(vk->library, "vkGetInstanceProcAddr");
    if (!symbol)
        return fail(reason, STATUS_UNSUPPORTED, "vulkan: %s has no vkGetInstanceProcAddr", name);
    memcpy(&vk->fn.GetInstanceProcAddr, &symbol, sizeof symbol);
    return load(vk, global_entry, ARRAY_COUNT(global_entry), reason);
}

/* Paths of the drivers and layers that the loader has loaded. */
struct loaded {
    char *path[64];
    size_t count;
};

static int note(struct dl_phdr_info *info, size_t bytes, void *user)
{
    static const char *const begins[] = {"libvulkan_", "libvk_", "libVkLayer_"};
    struct loaded *loaded = user;
    const char *slash = strrchr(info->dlpi_name, '/');
    const char *name = slash ? slash + 1 : info->dlpi_name;
    (void)bytes;
    for (size_t i = 0; i < ARRAY_COUNT(begins); i++)
        if (strncmp(name, begins[i], strlen(begins[i])) == 0 &&
            loaded->count < ARRAY_COUNT(loaded->path)) {
            loaded->path[loaded->count] = strdup(info->dlpi_name);
            loaded->count += loaded->path[loaded->count] != NULL;
        }
    return 0;
}

/* Keeps drivers and layers loaded, which the loader would unload with each instance: Mesa's leak
 * when unloaded, and are slow to load again. Failure is ignored. */
static void keep_drivers_loaded(void)
{
    struct loaded loaded = {.count = 0};
    (void)dl_iterate_phdr(note, &loaded);
    for (size_t i = 0; i < loaded.count; i++) {
        (void)dlopen(loaded.path[i], RTLD_LAZY | RTLD_NOLOAD | RTLD_NODELETE);
        free(loaded.path[i]);
    }
}

enum status vk_load_instance(struct vk *vk, struct reason *reason)
{
    keep_drivers_loaded();
    enum status status = load(vk, instance_entry, ARRAY_COUNT(instance_entry), reason);
    if (!status && (vk->options.validate || vk->options.watch))
        status = load(vk, debug_entry, ARRAY_COUNT(debug_entry), reason);
    if (!status && vk->options.ray_more.lives)
        status = load(vk, format_entry, ARRAY_COUNT(format_entry), reason);
    return status;
}

enum status vk_load_device(struct vk *vk, struct reason *reason)
{
    enum status status = load(vk, device_entry, ARRAY_COUNT(device_entry), reason);
    if (!status && vk_has_addresses(vk))
        status = load(vk, address_entry, ARRAY_COUNT(address_entry), reason);
    if (!status && vk->options.ray_query)
        status = load(vk, ray_entry, ARRAY_COUNT(ray_entry), reason);
    if (!status && vk->options.ray_more.lives)
        status = load(vk, life_entry, ARRAY_COUNT(life_entry), reason);
    if (!status && vk->options.ray_more.indirect)
        status = load(vk, indirect_entry, ARRAY_COUNT(indirect_entry), reason);
    if (!status && vk->options.ray_more.host)
        status = load(vk, host_entry, ARRAY_COUNT(host_entry), reason);
    return status;
}
