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
    struct level *bottom; /* bottom_count of them */
    uint32_t bottom_count;
    struct level top;
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

/* The geometries of one level: `count` of them, and how many primitives each has. */
struct level_input {
    const VkAccelerationStructureGeometryKHR *geometry;
    const VkAccelerationStructureBuildRangeInfoKHR *range;
    uint32_t *most; /* of range, for the sizes */
    uint32_t count;
};

static enum status build_level(struct vk *vk, VkAccelerationStructureTypeKHR type,
                               const struct level_input *input, struct level *out,
                               struct reason *reason)
{
    VkAccelerationStructureBuildGeometryInfoKHR info = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR,
        .type = type,
        .mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR,
        .geometryCount = input->count,
        .pGeometries = input->geometry,
    };
    VkAccelerationStructureBuildSizesInfoKHR sizes = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR};
    vk->fn.GetAccelerationStructureBuildSizesKHR(
        vk->device, VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &info, input->most, &sizes);
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
        info.scratchData.deviceAddress = (vk_address(vk, scratch) + align - 1) / align * align;
        vk->fn.CmdBuildAccelerationStructuresKHR(vk->command, 1, &info, &input->range);
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

static VkAccelerationStructureGeometryKHR
triangles_of(struct vk *vk, const struct vk_accel_mesh *mesh, bool opaque)
{
    return (VkAccelerationStructureGeometryKHR){
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR,
        .geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR,
        .geometry.triangles =
            {
                .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR,
                .vertexFormat = VK_FORMAT_R32G32B32_SFLOAT,
                .vertexData.deviceAddress = vk_address(vk, mesh->vertices),
                .vertexStride = 3 * sizeof(float),
                .maxVertex = mesh->vertex_count ? mesh->vertex_count - 1 : 0,
                .indexType = VK_INDEX_TYPE_UINT32,
                .indexData.deviceAddress = vk_address(vk, mesh->indices),
            },
        /* So that queries which list candidates get each triangle once. */
        .flags = VK_GEOMETRY_NO_DUPLICATE_ANY_HIT_INVOCATION_BIT_KHR |
                 (opaque ? VK_GEOMETRY_OPAQUE_BIT_KHR : 0u),
    };
}

static enum status build_bottom(struct vk *vk, const struct vk_accel_mesh *mesh, struct level *out,
                                struct reason *reason)
{
    const uint32_t count = mesh->geometry_count;
    VkAccelerationStructureGeometryKHR *geometry = alloc_zeroed(count, sizeof *geometry);
    VkAccelerationStructureBuildRangeInfoKHR *range = alloc_zeroed(count, sizeof *range);
    uint32_t *most = alloc_zeroed(count, sizeof *most);
    enum status status = STATUS_OK;
    if (!geometry || !range || !most)
        status = fail(reason, STATUS_MEMORY, "vulkan: no memory for %u geometries", count);
    for (uint32_t i = 0; i < count && !status; i++) {
        geometry[i] = triangles_of(vk, mesh, mesh->geometry[i].opaque);
        range[i].primitiveCount = most[i] = mesh->geometry[i].count;
        range[i].primitiveOffset = mesh->geometry[i].first * 3 * (uint32_t)sizeof(uint32_t);
    }
    if (!status)
        status = build_level(vk, VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR,
                             &(struct level_input){geometry, range, most, count}, out, reason);
    free(geometry);
    free(range);
    free(most);
    return status;
}

static VkAccelerationStructureInstanceKHR instance_of(struct vk *vk, const struct vk_accel *accel,
                                                      const struct vk_accel_instance *from)
{
    VkAccelerationStructureInstanceKHR instance = {
        .instanceCustomIndex = from->custom & 0xFFFFFFu,
        .mask = from->mask & 0xFFu,
        .flags = from->flags & 0xFFu,
    };
    memcpy(instance.transform.matrix, from->transform, sizeof from->transform);
    if (from->mesh != VK_ACCEL_NO_MESH) {
        const VkAccelerationStructureDeviceAddressInfoKHR where = {
            .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR,
            .accelerationStructure = accel->bottom[from->mesh].structure,
        };
        instance.accelerationStructureReference =
            vk->fn.GetAccelerationStructureDeviceAddressKHR(vk->device, &where);
    }
    return instance;
}

static enum status build_top(struct vk *vk, const struct vk_accel_world *world,
                             struct vk_accel *accel, struct reason *reason)
{
    uint32_t count = world->instance_count;
    VkAccelerationStructureInstanceKHR *instance = alloc_zeroed(count, sizeof *instance);
    struct vk_buffer *buffer = NULL;
    if (!instance)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for %u instances", count);
    for (uint32_t i = 0; i < count; i++)
        instance[i] = instance_of(vk, accel, &world->instance[i]);
    enum status status = vk_buffer_make_of(vk, instance, count * sizeof *instance, &buffer, reason);
    free(instance);
    if (!status) {
        const VkAccelerationStructureGeometryKHR geometry = {
            .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR,
            .geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR,
            .geometry.instances =
                {
                    .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR,
                    .data.deviceAddress = vk_address(vk, buffer),
                },
        };
        const VkAccelerationStructureBuildRangeInfoKHR range = {.primitiveCount = count};
        status =
            build_level(vk, VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR,
                        &(struct level_input){&geometry, &range, &count, 1}, &accel->top, reason);
    }
    vk_buffer_free(vk, buffer);
    return status;
}

/* A number of `what`, and what the device allows. */
static enum status check_limit(struct vk *vk, uint64_t number, uint64_t most, const char *what,
                               struct reason *reason)
{
    if (number <= most)
        return STATUS_OK;
    return fail(reason, STATUS_LIMIT, "vulkan: %s allows %llu %s, %llu are needed",
                vk->limits.device, (unsigned long long)most, what, (unsigned long long)number);
}

static enum status check_limits(struct vk *vk, const struct vk_accel_world *world,
                                struct reason *reason)
{
    const VkPhysicalDeviceAccelerationStructurePropertiesKHR limits = limits_of(vk);
    enum status status = check_limit(vk, world->instance_count, limits.maxInstanceCount,
                                     "instances in an acceleration structure", reason);
    for (uint32_t i = 0; i < world->mesh_count && !status; i++) {
        uint64_t triangles = 0;
        for (uint32_t k = 0; k < world->mesh[i].geometry_count; k++)
            triangles += world->mesh[i].geometry[k].count;
        status = check_limit(vk, triangles, limits.maxPrimitiveCount,
                             "triangles in an acceleration structure", reason);
        if (!status)
            status = check_limit(vk, world->mesh[i].geometry_count, limits.maxGeometryCount,
                                 "geometries in an acceleration structure", reason);
    }
    return status;
}

enum status vk_accel_make_world(struct vk *vk, const struct vk_accel_world *world,
                                struct vk_accel **out, struct reason *reason)
{
    *out = NULL;
    enum status status = check_limits(vk, world, reason);
    if (status)
        return status;
    struct vk_accel *accel = alloc_zeroed(1, sizeof *accel);
    if (accel)
        accel->bottom = alloc_zeroed(world->mesh_count, sizeof *accel->bottom);
    if (!accel || !accel->bottom) {
        free(accel);
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for an acceleration structure");
    }
    for (uint32_t i = 0; i < world->mesh_count && !status; i++) {
        accel->bottom_count = i + 1;
        status = build_bottom(vk, &world->mesh[i], &accel->bottom[i], reason);
    }
    if (!status)
        status = build_top(vk, world, accel, reason);
    if (status)
        vk_accel_free(vk, accel);
    else
        *out = accel;
    return status;
}

enum status vk_accel_make(struct vk *vk, struct vk_buffer *vertices, uint32_t vertex_count,
                          struct vk_buffer *indices, uint32_t tri_count, struct vk_accel **out,
                          struct reason *reason)
{
    const struct vk_accel_geometry geometry = {.count = tri_count};
    const struct vk_accel_mesh mesh = {vertices, indices, vertex_count, &geometry, 1};
    const struct vk_accel_instance instance = {
        .transform = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
        .mask = 0xFF,
        .flags = VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR,
    };
    const struct vk_accel_world world = {&mesh, &instance, 1, 1};
    return vk_accel_make_world(vk, &world, out, reason);
}

static void free_level(struct vk *vk, struct level *level)
{
    if (level->structure)
        vk->fn.DestroyAccelerationStructureKHR(vk->device, level->structure, NULL);
    vk_buffer_free(vk, level->memory);
}

void vk_accel_free(struct vk *vk, struct vk_accel *accel)
{
    if (!accel || !vk_idle(vk))
        return;
    free_level(vk, &accel->top);
    for (uint32_t i = accel->bottom_count; i-- > 0;)
        free_level(vk, &accel->bottom[i]);
    free(accel->bottom);
    free(accel);
}

uint64_t vk_accel_bytes(const struct vk_accel *accel)
{
    uint64_t bytes = accel ? vk_buffer_bytes(accel->top.memory) : 0;
    for (uint32_t i = 0; accel && i < accel->bottom_count; i++)
        bytes += vk_buffer_bytes(accel->bottom[i].memory);
    return bytes;
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
