/* --- the acceleration structure: one mesh, and one instance of it --- */

struct level {
    struct buffer memory;
    VkAccelerationStructureKHR structure;
};

static struct level bottom, top;

/* A function that the loader has no entry for. */
static PFN_vkVoidFunction find(const char *name)
{
    PFN_vkVoidFunction found = vkGetDeviceProcAddr(device, name);
    if (found)
        return found;
    printf("cannot run: the driver has no %s\n", name);
    exit(2);
}
#define FIND(name) ((PFN_##name)find(#name))

static VkDeviceAddress address_of(const struct buffer *buffer)
{
    VkBufferDeviceAddressInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO,
                                      .buffer = buffer->buffer};
    return vkGetBufferDeviceAddress(device, &info);
}

static struct buffer make_input(const void *data, size_t bytes)
{
    return make_buffer(VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR |
                           VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                       data, bytes, bytes);
}

static VkDeviceSize scratch_alignment(void)
{
    VkPhysicalDeviceAccelerationStructurePropertiesKHR limits = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_PROPERTIES_KHR};
    VkPhysicalDeviceProperties2 asked = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
                                         .pNext = &limits};
    vkGetPhysicalDeviceProperties2(physical, &asked);
    VkDeviceSize least = limits.minAccelerationStructureScratchOffsetAlignment;
    return least ? least : 1;
}

static void build_level(VkAccelerationStructureTypeKHR type,
                        const VkAccelerationStructureGeometryKHR *geometry, uint32_t count,
                        struct level *out)
{
    VkAccelerationStructureBuildGeometryInfoKHR info = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR,
        .type = type,
        .mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR,
        .geometryCount = 1,
        .pGeometries = geometry,
    };
    VkAccelerationStructureBuildSizesInfoKHR sizes = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR};
    FIND(vkGetAccelerationStructureBuildSizesKHR)
    (device, VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &info, &count, &sizes);
    out->memory = make_buffer(VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR |
                                  VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                              NULL, 0, sizes.accelerationStructureSize);
    VkAccelerationStructureCreateInfoKHR create = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR,
        .buffer = out->memory.buffer,
        .size = sizes.accelerationStructureSize,
        .type = type,
    };
    try(FIND(vkCreateAccelerationStructureKHR)(device, &create, NULL, &out->structure),
        "vkCreateAccelerationStructureKHR");
    VkDeviceSize align = scratch_alignment();
    struct buffer scratch =
        make_buffer(VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                    NULL, 0, sizes.buildScratchSize + align);
    info.dstAccelerationStructure = out->structure;
    info.scratchData.deviceAddress = (address_of(&scratch) + align - 1) / align * align;
    VkAccelerationStructureBuildRangeInfoKHR range = {.primitiveCount = count};
    const VkAccelerationStructureBuildRangeInfoKHR *ranges = &range;
    VkMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_ACCELERATION_STRUCTURE_WRITE_BIT_KHR,
        .dstAccessMask = VK_ACCESS_ACCELERATION_STRUCTURE_READ_BIT_KHR,
    };
    begin();
    FIND(vkCmdBuildAccelerationStructuresKHR)(command, 1, &info, &ranges);
    vkCmdPipelineBarrier(command, VK_PIPELINE_STAGE_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
                         VK_PIPELINE_STAGE_ACCELERATION_STRUCTURE_BUILD_BIT_KHR |
                             VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                         0, 1, &barrier, 0, NULL, 0, NULL);
    submit("building an acceleration structure");
    free_buffer(&scratch);
}

static void build_structure(void)
{
    struct buffer vertex = make_input(vertices, sizeof vertices);
    struct buffer index = make_input(indices, sizeof indices);
    VkAccelerationStructureGeometryKHR mesh = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR,
        .geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR,
        .geometry.triangles =
            {
                .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR,
                .vertexFormat = VK_FORMAT_R32G32B32_SFLOAT,
                .vertexData.deviceAddress = address_of(&vertex),
                .vertexStride = sizeof vertices[0],
                .maxVertex = VERTICES - 1,
                .indexType = VK_INDEX_TYPE_UINT32,
                .indexData.deviceAddress = address_of(&index),
            },
        .flags = VK_GEOMETRY_NO_DUPLICATE_ANY_HIT_INVOCATION_BIT_KHR,
    };
    build_level(VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, &mesh, TRIANGLES, &bottom);
    VkAccelerationStructureDeviceAddressInfoKHR where = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR,
        .accelerationStructure = bottom.structure,
    };
    VkAccelerationStructureInstanceKHR one = {
        .transform.matrix = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
        .mask = 0xFF,
        .flags = VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR,
        .accelerationStructureReference =
            FIND(vkGetAccelerationStructureDeviceAddressKHR)(device, &where),
    };
    struct buffer instances = make_input(&one, sizeof one);
    VkAccelerationStructureGeometryKHR world = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR,
        .geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR,
        .geometry.instances =
            {
                .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR,
                .data.deviceAddress = address_of(&instances),
            },
    };
    build_level(VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, &world, 1, &top);
    free_buffer(&instances);
    free_buffer(&index);
    free_buffer(&vertex);
}

static void bind_structure(VkDescriptorSet to)
{
    VkWriteDescriptorSetAccelerationStructureKHR structure = {
        .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET_ACCELERATION_STRUCTURE_KHR,
        .accelerationStructureCount = 1,
        .pAccelerationStructures = &top.structure,
    };
    VkWriteDescriptorSet write = {
        .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
        .pNext = &structure,
        .dstSet = to,
        .dstBinding = BINDINGS,
        .descriptorCount = 1,
        .descriptorType = VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR,
    };
    vkUpdateDescriptorSets(device, 1, &write, 0, NULL);
}

static void free_structure(void)
{
    struct level *levels[] = {&top, &bottom};
    for (int i = 0; i < 2; i++) {
        FIND(vkDestroyAccelerationStructureKHR)(device, levels[i]->structure, NULL);
        free_buffer(&levels[i]->memory);
    }
}
