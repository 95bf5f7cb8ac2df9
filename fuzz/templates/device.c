#define WAIT_NS 60000000000u /* a dispatch that takes longer hangs */

static VkInstance instance;
static VkPhysicalDevice physical;
static VkPhysicalDeviceMemoryProperties memory_types;
static VkDevice device;
static uint32_t family;
static VkQueue queue;
static VkCommandPool pool;
static VkCommandBuffer command;
static VkFence fence;

static void try(VkResult result, const char *what)
{
    if (result >= 0)
        return;
    printf("cannot run: %s: VkResult %d\n", what, (int)result);
    exit(2);
}

/* --- the device --- */

static void print_device(uint32_t index, VkPhysicalDevice which)
{
    VkPhysicalDeviceDriverProperties driver = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
    VkPhysicalDeviceProperties2 all = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
    vkGetPhysicalDeviceProperties(which, &all.properties);
    if (all.properties.apiVersion >= VK_API_VERSION_1_2) {
        all.pNext = &driver;
        vkGetPhysicalDeviceProperties2(which, &all);
    }
    printf("device %" PRIu32 ": %s, driver %s %s (0x%" PRIx32 "), Vulkan %u.%u.%u\n", index,
           all.properties.deviceName, driver.driverName, driver.driverInfo,
           all.properties.driverVersion, VK_VERSION_MAJOR(all.properties.apiVersion),
           VK_VERSION_MINOR(all.properties.apiVersion),
           VK_VERSION_PATCH(all.properties.apiVersion));
}

static void choose_device(unsigned long index)
{
    VkPhysicalDevice list[16];
    uint32_t count = 16;
    try(vkEnumeratePhysicalDevices(instance, &count, list), "vkEnumeratePhysicalDevices");
    if (index >= count) {
        printf("cannot run: there is no device %lu; there are %" PRIu32 "\n", index, count);
        for (uint32_t i = 0; i < count; i++)
            print_device(i, list[i]);
        exit(2);
    }
    physical = list[index];
    print_device((uint32_t)index, physical);
    vkGetPhysicalDeviceMemoryProperties(physical, &memory_types);
}

static void choose_queue(void)
{
    VkQueueFamilyProperties list[16];
    uint32_t count = 16;
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, list);
    while (family < count && !(list[family].queueFlags & VK_QUEUE_COMPUTE_BIT))
        family++;
    if (family < count)
        return;
    puts("cannot run: the device cannot compute");
    exit(2);
}

static void make_instance(void)
{
    VkApplicationInfo application = {
        .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
#if EXPORT_RAY_QUERY
        .apiVersion = VK_API_VERSION_1_2,
#else
        .apiVersion = VK_API_VERSION_1_1,
#endif
    };
    VkInstanceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
        .pApplicationInfo = &application,
    };
    try(vkCreateInstance(&info, NULL, &instance), "vkCreateInstance");
}

static void make_device(void)
{
#if EXPORT_RAY_QUERY
    static const char *const extensions[] = {VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME,
                                             VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
                                             VK_KHR_RAY_QUERY_EXTENSION_NAME};
    VkPhysicalDeviceRayQueryFeaturesKHR query = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR, .rayQuery = VK_TRUE};
    VkPhysicalDeviceAccelerationStructureFeaturesKHR structure = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR,
        .pNext = &query,
        .accelerationStructure = VK_TRUE};
    VkPhysicalDeviceBufferDeviceAddressFeatures address = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES,
        .pNext = &structure,
        .bufferDeviceAddress = VK_TRUE};
#endif
    /* A tree that was packed wrongly may make the shader read beyond its buffers. */
    VkPhysicalDeviceFeatures features = {.robustBufferAccess = VK_TRUE};
    VkDeviceQueueCreateInfo queues = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
        .queueFamilyIndex = family,
        .queueCount = 1,
        .pQueuePriorities = (const float[]){1.0f},
    };
    VkDeviceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
#if EXPORT_RAY_QUERY
        .pNext = &address,
        .enabledExtensionCount = 3,
        .ppEnabledExtensionNames = extensions,
#endif
        .queueCreateInfoCount = 1,
        .pQueueCreateInfos = &queues,
        .pEnabledFeatures = &features,
    };
    try(vkCreateDevice(physical, &info, NULL, &device), "vkCreateDevice");
    vkGetDeviceQueue(device, family, 0, &queue);
    VkCommandPoolCreateInfo pool_info = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
        .queueFamilyIndex = family,
    };
    try(vkCreateCommandPool(device, &pool_info, NULL, &pool), "vkCreateCommandPool");
    VkFenceCreateInfo fence_info = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    try(vkCreateFence(device, &fence_info, NULL, &fence), "vkCreateFence");
}

static void begin(void)
{
    VkCommandBufferAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .commandPool = pool,
        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
        .commandBufferCount = 1,
    };
    VkCommandBufferBeginInfo start = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
        .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
    };
    try(vkAllocateCommandBuffers(device, &info, &command), "vkAllocateCommandBuffers");
    try(vkBeginCommandBuffer(command, &start), "vkBeginCommandBuffer");
}

/* Submits what was recorded and waits for it. */
static void submit(const char *what)
{
    VkSubmitInfo info = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
        .commandBufferCount = 1,
        .pCommandBuffers = &command,
    };
    try(vkEndCommandBuffer(command), "vkEndCommandBuffer");
    VkResult result = vkQueueSubmit(queue, 1, &info, fence);
    if (result == VK_SUCCESS)
        result = vkWaitForFences(device, 1, &fence, VK_TRUE, WAIT_NS);
    if (result == VK_TIMEOUT || result == VK_ERROR_DEVICE_LOST) {
        printf("%s: %s: the bug shows\n", what,
               result == VK_TIMEOUT ? "it hangs" : "the device is lost");
        exit(1);
    }
    try(result, what);
    try(vkResetFences(device, 1, &fence), "vkResetFences");
    vkFreeCommandBuffers(device, pool, 1, &command);
}

/* --- buffers --- */

struct buffer {
    VkBuffer buffer;
    VkDeviceMemory memory;
    void *map;
};

static uint32_t memory_type(uint32_t allowed)
{
    const VkMemoryPropertyFlags wanted =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    for (uint32_t i = 0; i < memory_types.memoryTypeCount; i++)
        if ((allowed & 1u << i) && (memory_types.memoryTypes[i].propertyFlags & wanted) == wanted)
            return i;
    puts("cannot run: no memory that both sides see");
    exit(2);
}

/* A buffer of that many bytes that begins with `data`, the rest 0; data may be NULL. */
static struct buffer make_buffer(VkBufferUsageFlags usage, const void *data, size_t data_bytes,
                                 size_t bytes)
{
    struct buffer out;
    VkMemoryRequirements needs;
    VkBufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = bytes, .usage = usage};
    try(vkCreateBuffer(device, &info, NULL, &out.buffer), "vkCreateBuffer");
    vkGetBufferMemoryRequirements(device, out.buffer, &needs);
#if EXPORT_RAY_QUERY
    VkMemoryAllocateFlagsInfo flags = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
                                       .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT};
#endif
    VkMemoryAllocateInfo allocate = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
#if EXPORT_RAY_QUERY
        .pNext = &flags,
#endif
        .allocationSize = needs.size,
        .memoryTypeIndex = memory_type(needs.memoryTypeBits),
    };
    try(vkAllocateMemory(device, &allocate, NULL, &out.memory), "vkAllocateMemory");
    try(vkBindBufferMemory(device, out.buffer, out.memory, 0), "vkBindBufferMemory");
    try(vkMapMemory(device, out.memory, 0, VK_WHOLE_SIZE, 0, &out.map), "vkMapMemory");
    memset(out.map, 0, bytes);
    if (data)
        memcpy(out.map, data, data_bytes);
    return out;
}

static void free_buffer(struct buffer *buffer)
{
    vkDestroyBuffer(device, buffer->buffer, NULL);
    vkFreeMemory(device, buffer->memory, NULL);
}
