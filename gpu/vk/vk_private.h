/* Shared by the vk_*.c files; private to them. */
#ifndef VK_PRIVATE_H
#define VK_PRIVATE_H

#define VK_NO_PROTOTYPES
#include "gpu/vk/vk.h"
#include "gpu/vk/vk_driver.h"

#include <stdatomic.h>
#include <vulkan/vulkan_core.h>

/* The entry points used, filled in by vk_load_*. */
struct vk_fn {
    PFN_vkGetInstanceProcAddr GetInstanceProcAddr;
    PFN_vkEnumerateInstanceVersion EnumerateInstanceVersion;
    PFN_vkEnumerateInstanceLayerProperties EnumerateInstanceLayerProperties;
    PFN_vkEnumerateInstanceExtensionProperties EnumerateInstanceExtensionProperties;
    PFN_vkCreateInstance CreateInstance;

    PFN_vkDestroyInstance DestroyInstance;
    PFN_vkEnumeratePhysicalDevices EnumeratePhysicalDevices;
    PFN_vkGetPhysicalDeviceProperties GetPhysicalDeviceProperties;
    PFN_vkGetPhysicalDeviceProperties2 GetPhysicalDeviceProperties2;
    PFN_vkGetPhysicalDeviceMemoryProperties GetPhysicalDeviceMemoryProperties;
    PFN_vkGetPhysicalDeviceQueueFamilyProperties GetPhysicalDeviceQueueFamilyProperties;
    PFN_vkEnumerateDeviceExtensionProperties EnumerateDeviceExtensionProperties;
    PFN_vkCreateDevice CreateDevice;
    PFN_vkGetDeviceProcAddr GetDeviceProcAddr;
    PFN_vkCreateDebugUtilsMessengerEXT CreateDebugUtilsMessengerEXT;
    PFN_vkDestroyDebugUtilsMessengerEXT DestroyDebugUtilsMessengerEXT;

    PFN_vkGetPhysicalDeviceFeatures2 GetPhysicalDeviceFeatures2;

    PFN_vkDestroyDevice DestroyDevice;
    PFN_vkDeviceWaitIdle DeviceWaitIdle;
    PFN_vkGetDeviceQueue GetDeviceQueue;
    PFN_vkQueueSubmit QueueSubmit;
    PFN_vkCreateFence CreateFence;
    PFN_vkDestroyFence DestroyFence;
    PFN_vkResetFences ResetFences;
    PFN_vkWaitForFences WaitForFences;
    PFN_vkCreateCommandPool CreateCommandPool;
    PFN_vkDestroyCommandPool DestroyCommandPool;
    PFN_vkResetCommandPool ResetCommandPool;
    PFN_vkAllocateCommandBuffers AllocateCommandBuffers;
    PFN_vkBeginCommandBuffer BeginCommandBuffer;
    PFN_vkEndCommandBuffer EndCommandBuffer;
    PFN_vkCreateQueryPool CreateQueryPool;
    PFN_vkDestroyQueryPool DestroyQueryPool;
    PFN_vkGetQueryPoolResults GetQueryPoolResults;
    PFN_vkCmdResetQueryPool CmdResetQueryPool;
    PFN_vkCmdWriteTimestamp CmdWriteTimestamp;
    PFN_vkCreateBuffer CreateBuffer;
    PFN_vkDestroyBuffer DestroyBuffer;
    PFN_vkGetBufferMemoryRequirements GetBufferMemoryRequirements;
    PFN_vkAllocateMemory AllocateMemory;
    PFN_vkFreeMemory FreeMemory;
    PFN_vkBindBufferMemory BindBufferMemory;
    PFN_vkMapMemory MapMemory;
    PFN_vkCmdCopyBuffer CmdCopyBuffer;
    PFN_vkCmdPipelineBarrier CmdPipelineBarrier;
    PFN_vkCreateShaderModule CreateShaderModule;
    PFN_vkDestroyShaderModule DestroyShaderModule;
    PFN_vkCreateDescriptorSetLayout CreateDescriptorSetLayout;
    PFN_vkDestroyDescriptorSetLayout DestroyDescriptorSetLayout;
    PFN_vkCreatePipelineLayout CreatePipelineLayout;
    PFN_vkDestroyPipelineLayout DestroyPipelineLayout;
    PFN_vkCreateComputePipelines CreateComputePipelines;
    PFN_vkDestroyPipeline DestroyPipeline;
    PFN_vkCreateDescriptorPool CreateDescriptorPool;
    PFN_vkDestroyDescriptorPool DestroyDescriptorPool;
    PFN_vkAllocateDescriptorSets AllocateDescriptorSets;
    PFN_vkUpdateDescriptorSets UpdateDescriptorSets;
    PFN_vkCmdBindPipeline CmdBindPipeline;
    PFN_vkCmdBindDescriptorSets CmdBindDescriptorSets;
    PFN_vkCmdPushConstants CmdPushConstants;
    PFN_vkCmdDispatch CmdDispatch;
    PFN_vkCmdDispatchIndirect CmdDispatchIndirect;
    PFN_vkCmdUpdateBuffer CmdUpdateBuffer;
    PFN_vkCreateBufferView CreateBufferView;
    PFN_vkDestroyBufferView DestroyBufferView;

    /* With ray queries: */
    PFN_vkGetBufferDeviceAddress GetBufferDeviceAddress;
    PFN_vkCreateAccelerationStructureKHR CreateAccelerationStructureKHR;
    PFN_vkDestroyAccelerationStructureKHR DestroyAccelerationStructureKHR;
    PFN_vkGetAccelerationStructureBuildSizesKHR GetAccelerationStructureBuildSizesKHR;
    PFN_vkGetAccelerationStructureDeviceAddressKHR GetAccelerationStructureDeviceAddressKHR;
    PFN_vkCmdBuildAccelerationStructuresKHR CmdBuildAccelerationStructuresKHR;

    /* With vk_options.ray_more: */
    PFN_vkGetPhysicalDeviceFormatProperties GetPhysicalDeviceFormatProperties;
    PFN_vkCmdCopyAccelerationStructureKHR CmdCopyAccelerationStructureKHR;
    PFN_vkCmdCopyAccelerationStructureToMemoryKHR CmdCopyAccelerationStructureToMemoryKHR;
    PFN_vkCmdCopyMemoryToAccelerationStructureKHR CmdCopyMemoryToAccelerationStructureKHR;
    PFN_vkCmdWriteAccelerationStructuresPropertiesKHR CmdWriteAccelerationStructuresPropertiesKHR;
    PFN_vkGetDeviceAccelerationStructureCompatibilityKHR
        GetDeviceAccelerationStructureCompatibilityKHR;
    PFN_vkCmdBuildAccelerationStructuresIndirectKHR CmdBuildAccelerationStructuresIndirectKHR;
    PFN_vkBuildAccelerationStructuresKHR BuildAccelerationStructuresKHR;
};

/* Messages of the validation layer. The callback may run on any thread. */
struct vk_log {
    atomic_uint count;
    atomic_bool has_first;
    struct reason first; /* valid once count is read as 1 or more */
};

struct vk {
    void *library;
    struct vk_fn fn;
    struct vk_options options;
    struct driver driver; /* the meaning of options.driver */
    struct vk_log log;
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger;
    VkPhysicalDevice physical;
    VkPhysicalDeviceMemoryProperties memory;
    struct vk_limits limits;
    uint64_t allocation_bytes; /* largest memory allocation; 0: not known */
    uint32_t family;           /* queue family */
    VkDevice device;
    VkQueue queue;
    VkCommandPool pool;
    VkCommandBuffer command;
    VkFence fence;
    VkQueryPool query; /* two timestamps, or null */
    struct vk_buffer *staging;
    VkBufferView *view; /* of the texel buffers of the last submission */
    size_t view_count, view_capacity;
    struct vk_buffer *table; /* addresses of the buffers of the last submission, or NULL */
    bool given_up;           /* lost or hung; the fence may still be pending */
    bool pending;            /* submitted and not known to have finished */
    bool stuck;              /* still pending after the grace time */
};

struct vk_buffer {
    VkBuffer buffer;
    VkDeviceMemory memory;
    uint8_t *map; /* NULL if not visible to the host */
    uint64_t bytes;
};

struct vk_sets {
    VkDescriptorSetLayout layout; /* same as that of every pipeline with these bindings */
    VkDescriptorPool pool;
    uint32_t bindings;           /* storage buffers of a set */
    bool accel;                  /* followed by an acceleration structure */
    uint32_t texels, references; /* as of vk_ways */
    uint32_t count;
    VkDescriptorSet set[];
};

struct vk_pipeline {
    struct vk_sets *sets; /* one set, for vk_dispatch_series */
    VkPipelineLayout layout;
    VkPipeline pipeline;
    uint32_t push_bytes;
    uint32_t words; /* as of its shader */
};

/* Returns STATUS_OK if `result`, of the call `what`, is VK_SUCCESS, and marks a lost device.
 * Errors: STATUS_MEMORY for the out-of-memory results, else STATUS_DEVICE, with the call and its
 * result. */
enum status vk_check(struct vk *vk, VkResult result, const char *what,
                     struct reason *reason) MUST_USE;

/* Fill in vk->fn. Errors: STATUS_UNSUPPORTED with the library or the missing function. */
enum status vk_load_library(struct vk *vk, struct reason *reason) MUST_USE;
enum status vk_load_instance(struct vk *vk, struct reason *reason) MUST_USE;
enum status vk_load_device(struct vk *vk, struct reason *reason) MUST_USE;

/* Makes vk->instance, with the validation layer if vk->options need it. */
enum status vk_instance_make(struct vk *vk, struct reason *reason) MUST_USE;

/* Chooses vk->physical, vk->family and fills in vk->limits and vk->memory. */
enum status vk_choose(struct vk *vk, struct reason *reason) MUST_USE;

/* Lists the devices in one line, or in several if `details`. */
void vk_list(struct vk *vk, bool details, char *text, size_t text_bytes);

/* The size that a buffer of so many bytes is made with: texel buffers have whole elements. */
static inline uint64_t vk_buffer_size(const struct vk *vk, uint64_t bytes)
{
    return vk_ways(vk).texels ? (bytes + 15) / 16 * 16 : bytes;
}

/* The kind of a binding's descriptor. */
VkDescriptorType vk_set_type(const struct vk_sets *sets, uint32_t binding);

/* Makes a buffer that is mapped, whatever memory the others are in. Errors: as vk_buffer_make. */
enum status vk_buffer_make_mapped(struct vk *vk, uint64_t bytes, struct vk_buffer **out,
                                  struct reason *reason) MUST_USE;

/* Whether buffers of this device have addresses. */
static inline bool vk_has_addresses(const struct vk *vk)
{
    return vk->options.ray_query || vk_ways(vk).references != 0;
}

/* The address of a buffer of a device that has addresses. */
VkDeviceAddress vk_address(struct vk *vk, const struct vk_buffer *buffer);

/* Returns true if the device, of Vulkan `version`, gives buffers addresses. */
bool vk_can_refer(struct vk *vk, VkPhysicalDevice device, uint32_t version);

/* Returns true if the device has the extension. */
bool vk_has_extension(struct vk *vk, VkPhysicalDevice device, const char *name);

/* Returns true if the device, of Vulkan `version`, has all that vk_options.ray_query requires. */
bool vk_can_query_rays(struct vk *vk, VkPhysicalDevice device, uint32_t version);

/* Features for vkCreateDevice if ray queries are used. */
struct vk_ray_features {
    VkPhysicalDeviceBufferDeviceAddressFeatures address;
    VkPhysicalDeviceAccelerationStructureFeaturesKHR accel;
    VkPhysicalDeviceRayQueryFeaturesKHR query;
};
#define VK_RAY_EXTENSIONS 3u
extern const char *const vk_ray_extensions[VK_RAY_EXTENSIONS];
/* Chains the features, enabled if `wanted`; returns the head of the chain. */
void *vk_ray_chain(struct vk_ray_features *features, bool wanted);

/* Checks that vk->physical has the features of vk->options.ray_more. Errors: STATUS_UNSUPPORTED
 * with the name of the first that it lacks. */
enum status vk_check_ray_more(struct vk *vk, struct reason *reason) MUST_USE;

/* Makes a buffer that no shader binds, up to the largest memory allocation. */
enum status vk_buffer_make_unbound(struct vk *vk, uint64_t bytes, struct vk_buffer **out,
                                   struct reason *reason) MUST_USE;

/* Returns true if no work is running, after waiting a limited time for work that hung. If false, no
 * object that a shader can use may be destroyed. */
bool vk_idle(struct vk *vk);

/* Binds buffers to set `i`; info[b] is that of binding b, whose elements are words in texel buffers
 * of `words`, else quads. Views of these are made, and addresses are written to the device's table:
 * both are of one submission, see vk_bind_begin. Errors: STATUS_LIMIT more elements than the device
 * allows; STATUS_DEVICE; STATUS_MEMORY. */
enum status vk_set_write(struct vk *vk, const struct vk_sets *sets, uint32_t i, uint32_t words,
                         const VkDescriptorBufferInfo *info, struct reason *reason) MUST_USE;

/* To be called before the sets of a submission are written: frees what those of the last one had,
 * and makes the table of addresses large enough. Errors: as vk_buffer_make. */
enum status vk_bind_begin(struct vk *vk, const struct vk_sets *sets,
                          struct reason *reason) MUST_USE;

/* Frees all that vk_set_write made. No work may be running. */
void vk_bind_free(struct vk *vk);

/* Record in vk->command: a pipeline's descriptor set and push constants; a barrier that makes what
 * was written in stage `from` visible in stage `to`; a barrier before copies or the host read what
 * shaders wrote. */
void vk_bind(struct vk *vk, const struct vk_pipeline *pipeline, VkDescriptorSet set,
             const void *push);
void vk_barrier(struct vk *vk, VkPipelineStageFlags from, VkAccessFlags written,
                VkPipelineStageFlags to, VkAccessFlags access);
void vk_barrier_for_reading(struct vk *vk);

/* vk_begin begins vk->command; vk_submit ends it, submits it and waits. `what` names the work for
 * messages. */
enum status vk_begin(struct vk *vk, struct reason *reason) MUST_USE;
enum status vk_submit(struct vk *vk, const char *what, struct reason *reason) MUST_USE;

#endif
