/* The instance, and the validation layer's messages. */
#include "gpu/vk/vk_private.h"

#include <stdlib.h>
#include <string.h>

#define VALIDATION_LAYER "VK_LAYER_KHRONOS_validation"

/* Messages of the layer about its own checks. They are not counted: features that it enables,
 * accesses that it cannot check and raydiff's shaders do not make (buffer addresses; ray queries on
 * a device without them), and a warning that both kinds of checks together are slow. */
static const struct note {
    const char *name, *text;
} watch_notes[] = {
    {"UNASSIGNED-GPU-Assisted Validation Warning", "No buffer device address checking"},
    {"VALIDATION-SETTINGS",
     "Both GPU Assisted Validation and Normal Core Check Validation are enabled"},
    {"WARNING-GPU-Assisted-Validation", "Internal Warning: Forcing "},
    {"WARNING-GPU-Assisted-Validation", "Internal Warning: Adding "},
    {"WARNING-GPU-Assisted-Validation", "[Disabling gpuav_validate_ray_query]"},
};

static bool is_watch_note(const VkDebugUtilsMessengerCallbackDataEXT *data)
{
    for (size_t i = 0; i < ARRAY_COUNT(watch_notes); i++)
        if (data->pMessageIdName && strcmp(data->pMessageIdName, watch_notes[i].name) == 0 &&
            strstr(data->pMessage, watch_notes[i].text))
            return true;
    return false;
}

static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                 VkDebugUtilsMessageTypeFlagsEXT types,
                                                 const VkDebugUtilsMessengerCallbackDataEXT *data,
                                                 void *user)
{
    struct vk_log *log = user;
    (void)types;
    if (!(severity & VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT) && is_watch_note(data))
        return VK_FALSE;
    if (!atomic_exchange(&log->has_first, true))
        (void)fail(&log->first, STATUS_DEVICE, "vulkan validation: %s", data->pMessage);
    atomic_fetch_add(&log->count, 1);
    return VK_FALSE;
}

/* Excludes general messages: the loader sends them about drivers that are not used. */
static VkDebugUtilsMessengerCreateInfoEXT messenger_info(struct vk_log *log)
{
    return (VkDebugUtilsMessengerCreateInfoEXT){
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                       VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
        .pfnUserCallback = on_message,
        .pUserData = log,
    };
}

/* Sets *found if the loader lists the validation layer. */
static enum status find_layer(struct vk *vk, bool *found, struct reason *reason)
{
    uint32_t count = 0;
    *found = false;
    VkResult result = vk->fn.EnumerateInstanceLayerProperties(&count, NULL);
    if (result != VK_SUCCESS)
        return vk_check(vk, result, "vkEnumerateInstanceLayerProperties", reason);
    VkLayerProperties *layer = alloc_zeroed(count, sizeof *layer);
    if (!layer)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for the list of layers");
    result = vk->fn.EnumerateInstanceLayerProperties(&count, layer);
    for (uint32_t i = 0; i < count && result >= 0; i++)
        *found = *found || strcmp(layer[i].layerName, VALIDATION_LAYER) == 0;
    free(layer);
    return result == VK_INCOMPLETE
               ? STATUS_OK
               : vk_check(vk, result, "vkEnumerateInstanceLayerProperties", reason);
}

/* Races between dispatches, for every run under the layer. */
static const VkValidationFeatureEnableEXT validated[] = {
    VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT,
};
static const VkValidationFeatureEnableEXT watched[] = {
    VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_EXT,
    VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_RESERVE_BINDING_SLOT_EXT,
};

enum status vk_instance_make(struct vk *vk, struct reason *reason)
{
    uint32_t version = 0;
    VkResult result = vk->fn.EnumerateInstanceVersion(&version);
    if (result != VK_SUCCESS)
        return vk_check(vk, result, "vkEnumerateInstanceVersion", reason);
    if (version < VK_API_VERSION_1_1)
        return fail(reason, STATUS_UNSUPPORTED, "vulkan: the loader is older than Vulkan 1.1");
    bool layer = false;
    bool asked = vk->options.validate || vk->options.watch;
    enum status status = asked ? find_layer(vk, &layer, reason) : STATUS_OK;
    if (status)
        return status;
    if (asked && !layer)
        return fail(reason, STATUS_UNSUPPORTED,
                    "vulkan: validation was asked for and " VALIDATION_LAYER " is not installed");

    VkDebugUtilsMessengerCreateInfoEXT messenger = messenger_info(&vk->log);
    const VkValidationFeaturesEXT watch = {
        .sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
        .pNext = &messenger, /* so that creation and destruction of the instance are checked, too */
        .enabledValidationFeatureCount =
            vk->options.watch ? ARRAY_COUNT(watched) : ARRAY_COUNT(validated),
        .pEnabledValidationFeatures = vk->options.watch ? watched : validated,
    };
    VkApplicationInfo application = {
        .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
        .pApplicationName = "raydiff",
        .apiVersion = version < VK_API_VERSION_1_2 ? VK_API_VERSION_1_1 : VK_API_VERSION_1_2,
    };
    VkInstanceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
        .pNext = layer ? &watch : NULL,
        .pApplicationInfo = &application,
        .enabledLayerCount = layer ? 1 : 0,
        .ppEnabledLayerNames = (const char *[]){VALIDATION_LAYER},
        .enabledExtensionCount = layer ? 2 : 0,
        .ppEnabledExtensionNames = (const char *[]){VK_EXT_DEBUG_UTILS_EXTENSION_NAME,
                                                    VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME},
    };
    result = vk->fn.CreateInstance(&info, NULL, &vk->instance);
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER)
        return fail(reason, STATUS_UNSUPPORTED, "vulkan: the loader found no driver");
    status = vk_check(vk, result, "vkCreateInstance", reason);
    if (!status)
        status = vk_load_instance(vk, reason);
    if (status || !layer)
        return status;
    result = vk->fn.CreateDebugUtilsMessengerEXT(vk->instance, &messenger, NULL, &vk->messenger);
    return vk_check(vk, result, "vkCreateDebugUtilsMessengerEXT", reason);
}

uint32_t vk_messages(const struct vk *vk, struct reason *reason)
{
    uint32_t count = atomic_load(&vk->log.count);
    if (count && reason)
        *reason = vk->log.first;
    return count;
}
