#include "gpu/vk/vk_accel.h"

#include "gpu/vk/vk_private.h"

#include <stdlib.h>
#include <string.h>

const char *const vk_ray_extensions[VK_RAY_EXTENSIONS] = {
    VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME,
    VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
    VK_KHR_RAY_QUERY_EXTENSION_NAME,
};

struct level {
    struct vk_buffer *memory;
    VkAccelerationStructureKHR structure;
};

struct vk_accel {
    struct level bottom, top;
};

void *vk_ray_chain(struct vk_ray_features *features, bool wanted)
{
    *features = (struct vk_ray_features){
        .address = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES,
                    .pNext = &features->accel,
                    .bufferDeviceAddress = wanted},
        .accel = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR,
                  .pNext = &features->query,
                  .accelerationStructure = wanted},
        .query = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR,
                  .rayQuery = wanted},
    };
    return features;
}

bool vk_can_query_rays(struct vk *vk, VkPhysicalDevice device, uint32_t version)
{
    if (version < VK_API_VERSION_1_2)
        return false;
    for (uint32_t i = 0; i < VK_RAY_EXTENSIONS; i++)
        if (!vk_has_extension(vk, device, vk_ray_extensions[i]))
            return false;
    struct vk_ray_features features;
    VkPhysicalDeviceFeatures2 asked = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                       .pNext = vk_ray_chain(&features, false)};
    vk->fn.GetPhysicalDeviceFeatures2(device, &asked);
    return features.address.bufferDeviceAddress && features.accel.accelerationStructure &&
           features.query.rayQuery;
}

static VkDeviceAddress address_of(struct vk *vk, const struct vk_buffer *buffer)
{
    const VkBufferDeviceAddressInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO,
        .buffer = buffer->buffer,
    };
    return vk->fn.GetBufferDeviceAddress(vk->device, &info);
}

static VkPhysicalDeviceAccelerationStructurePropertiesKHR limits_of(struct vk *vk)
{
    VkPhysicalDeviceAccelerationStructurePropertiesKHR limits = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_PROPERTIES_KHR};
    VkPhysicalDeviceProperties2 asked = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
                                         .pNext = &limits};
    vk->fn.GetPhysicalDeviceProperties2(vk->physical, &asked);
    return limits;
}

/* Makes memory and handle of one level. */
static enum status make_level(struct vk *vk, VkAccelerationStructureTypeKHR type, uint64_t bytes,
                              struct level *out, struct reason *reason)
{
    enum status status = vk_buffer_make_unbound(vk, bytes, &out->memory, reason);
    if (status)
        return status;
    const VkAccelerationStructureCreateInfoKHR info = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR,
        .buffer = out->memory->buffer,
        .size = bytes,
        .type = type,
    };
    return vk_check(vk,
                    vk->fn.CreateAccelerationStructureKHR(vk->device, &info, NULL, &out->structure),
                    "vkCreateAccelerationStructureKHR", reason);
}

static enum status build_level(struct vk *vk, VkAccelerationStructureTypeKHR type,
                               const VkAccelerationStructureGeometryKHR *geometry, uint32_t count,
                               struct level *out, struct reason *reason)
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
    vk->fn.GetAccelerationStructureBuildSizesKHR(
        vk->device, VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &info, &count, &sizes);
    uint64_t align = limits_of(vk).minAccelerationStructureScratchOffsetAlignment;
    align = align ? align : 1;
    struct vk_buffer *scratch = NULL;
    enum status status = make_level(vk, type, sizes.accelerationStructureSize, out, reason);
    if (!status)
        status = vk_buffer_make_unbound(vk, sizes.buildScratchSize + align, &scratch, reason);
    if (!status)
        status = vk_begin(vk, reason);
    if (!status) {
        info.dstAccelerationStructure = out->structure;
        info.scratchData.deviceAddress = (address_of(vk, scratch) + align - 1) / align * align;
        const VkAccelerationStructureBuildRangeInfoKHR range = {.primitiveCount = count};
        const VkAccelerationStructureBuildRangeInfoKHR *ranges = &range;
        vk->fn.CmdBuildAccelerationStructuresKHR(vk->command, 1, &info, &ranges);
        /* It is read by the next build and by shaders. Both are later submissions, which wait for
         * this one's fence. */
        vk_barrier(vk, VK_PIPELINE_STAGE_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
                   VK_ACCESS_ACCELERATION_STRUCTURE_WRITE_BIT_KHR,
                   VK_PIPELINE_STAGE_ACCELERATION_STRUCTURE_BUILD_BIT_KHR |
                       VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                   VK_ACCESS_ACCELERATION_STRUCTURE_READ_BIT_KHR);
        status = vk_submit(vk, "building an acceleration structure", reason);
    }
    vk_buffer_free(vk, scratch);
    return status;
}

static enum status build_bottom(struct vk *vk, struct vk_buffer *vertices, uint32_t vertex_count,
                                struct vk_buffer *indices, uint32_t tri_count, struct level *out,
                                struct reason *reason)
{
    const VkAccelerationStructureGeometryKHR geometry = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR,
        .geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR,
        .geometry.triangles =
            {
                .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR,
                .vertexFormat = VK_FORMAT_R32G32B32_SFLOAT,
                .vertexData.deviceAddress = address_of(vk, vertices),
                .vertexStride = 3 * sizeof(float),
                .maxVertex = vertex_count - 1,
                .indexType = VK_INDEX_TYPE_UINT32,
                .indexData.deviceAddress = address_of(vk, indices),
            },
        /* So that queries which list candidates get each triangle once. */
        .flags = VK_GEOMETRY_NO_DUPLICATE_ANY_HIT_INVOCATION_BIT_KHR,
    };
    return build_level(vk, VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, &geometry, tri_count,
                       out, reason);
}

static enum status build_top(struct vk *vk, const struct level *bottom, struct level *out,
                             struct reason *reason)
{
    const VkAccelerationStructureDeviceAddressInfoKHR where = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR,
        .accelerationStructure = bottom->structure,
    };
    const VkAccelerationStructureInstanceKHR instance = {
        .transform.matrix = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
        .mask = 0xFF,
        .flags = VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR,
        .accelerationStructureReference =
            vk->fn.GetAccelerationStructureDeviceAddressKHR(vk->device, &where),
    };
    struct vk_buffer *buffer = NULL;
    enum status status = vk_buffer_make_of(vk, &instance, sizeof instance, &buffer, reason);
    if (!status) {
        const VkAccelerationStructureGeometryKHR geometry = {
            .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR,
            .geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR,
            .geometry.instances =
                {
                    .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR,
                    .data.deviceAddress = address_of(vk, buffer),
                },
        };
        status = build_level(vk, VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, &geometry, 1, out,
                             reason);
    }
    vk_buffer_free(vk, buffer);
    return status;
}

enum status vk_accel_make(struct vk *vk, struct vk_buffer *vertices, uint32_t vertex_count,
                          struct vk_buffer *indices, uint32_t tri_count, struct vk_accel **out,
                          struct reason *reason)
{
    *out = NULL;
    const uint64_t most = limits_of(vk).maxPrimitiveCount;
    if (tri_count > most)
        return fail(reason, STATUS_LIMIT,
                    "vulkan: %s allows %llu triangles in an acceleration structure, %u are needed",
                    vk->limits.device, (unsigned long long)most, tri_count);
    struct vk_accel *accel = alloc_zeroed(1, sizeof *accel);
    if (!accel)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for an acceleration structure");
    enum status status =
        build_bottom(vk, vertices, vertex_count, indices, tri_count, &accel->bottom, reason);
    if (!status)
        status = build_top(vk, &accel->bottom, &accel->top, reason);
    if (status)
        vk_accel_free(vk, accel);
    else
        *out = accel;
    return status;
}

void vk_accel_free(struct vk *vk, struct vk_accel *accel)
{
    if (!accel || !vk_idle(vk))
        return;
    struct level *level[] = {&accel->top, &accel->bottom};
    for (int i = 0; i < 2; i++) {
        if (level[i]->structure)
            vk->fn.DestroyAccelerationStructureKHR(vk->device, level[i]->structure, NULL);
        vk_buffer_free(vk, level[i]->memory);
    }
    free(accel);
}

uint64_t vk_accel_bytes(const struct vk_accel *accel)
{
    return accel ? vk_buffer_bytes(accel->bottom.memory) + vk_buffer_bytes(accel->top.memory) : 0;
}

void vk_pipeline_use(struct vk *vk, struct vk_pipeline *pipeline, const struct vk_accel *accel)
{
    const VkWriteDescriptorSetAccelerationStructureKHR structure = {
        .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET_ACCELERATION_STRUCTURE_KHR,
        .accelerationStructureCount = 1,
        .pAccelerationStructures = &accel->top.structure,
    };
    const VkWriteDescriptorSet write = {
        .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
        .pNext = &structure,
        .dstSet = pipeline->sets->set[0],
        .dstBinding = pipeline->sets->bindings,
        .descriptorCount = 1,
        .descriptorType = VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR,
    };
    vk->fn.UpdateDescriptorSets(vk->device, 1, &write, 0, NULL);
}
