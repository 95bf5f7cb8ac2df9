#include "gpu/vk/vk_accel_inner.h"

#include <stdlib.h>
#include <string.h>

const char *const vk_ray_extensions[VK_RAY_EXTENSIONS] = {
    VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME,
    VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
    VK_KHR_RAY_QUERY_EXTENSION_NAME,
};

/* Serialised levels: the top one, then the bottom ones, whose addresses are known. */
struct vk_accel_bytes {
    struct level_bytes *level;
    uint64_t *address;
    uint32_t bottom_count;
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

enum status vk_check_ray_more(struct vk *vk, struct reason *reason)
{
    const struct vk_ray_more *more = &vk->options.ray_more;
    if (!more->indirect && !more->host)
        return STATUS_OK;
    struct vk_ray_features features;
    VkPhysicalDeviceFeatures2 asked = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                       .pNext = vk_ray_chain(&features, false)};
    vk->fn.GetPhysicalDeviceFeatures2(vk->physical, &asked);
    const bool indirect = !more->indirect || features.accel.accelerationStructureIndirectBuild;
    const bool host = !more->host || features.accel.accelerationStructureHostCommands;
    if (indirect && host)
        return STATUS_OK;
    return fail(reason, STATUS_UNSUPPORTED, "vulkan: %s lacks the feature %s", vk->limits.device,
                indirect ? "accelerationStructureHostCommands"
                         : "accelerationStructureIndirectBuild");
}

struct vk_ray_more vk_accel_needs(const struct vk_accel_how *how)
{
    return (struct vk_ray_more){.lives = true,
                                .indirect = how->where == VK_ACCEL_INDIRECT,
                                .host = how->where == VK_ACCEL_BY_HOST};
}

bool vk_accel_takes_format(struct vk *vk, uint32_t format)
{
    VkFormatProperties properties;
    vk->fn.GetPhysicalDeviceFormatProperties(vk->physical, (VkFormat)format, &properties);
    return properties.bufferFeatures &
           VK_FORMAT_FEATURE_ACCELERATION_STRUCTURE_VERTEX_BUFFER_BIT_KHR;
}

/* --- top levels ------------------------------------------------------------------------------- */

/* Where an instance stands before an update: elsewhere, and smaller. */
static void move_instance(VkAccelerationStructureInstanceKHR *instance)
{
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++)
            instance->transform.matrix[i][k] *= 0.5f;
    instance->transform.matrix[0][3] += 3.0f;
    instance->transform.matrix[1][3] -= 5.0f;
}

static VkAccelerationStructureInstanceKHR instance_of(struct vk *vk, const struct vk_accel *accel,
                                                      const struct vk_accel_how *how,
                                                      const struct vk_accel_instance *from)
{
    VkAccelerationStructureInstanceKHR instance = {
        .instanceCustomIndex = from->custom & 0xFFFFFFu,
        .mask = from->mask & 0xFFu,
        .flags = from->flags & 0xFFu,
    };
    memcpy(instance.transform.matrix, from->transform, sizeof from->transform);
    if (from->mesh != VK_ACCEL_NO_MESH && how->where == VK_ACCEL_BY_HOST)
        memcpy(&instance.accelerationStructureReference, &accel->bottom[from->mesh].structure,
               sizeof accel->bottom[from->mesh].structure);
    else if (from->mesh != VK_ACCEL_NO_MESH)
        instance.accelerationStructureReference = vk_level_address(vk, &accel->bottom[from->mesh]);
    return instance;
}

/* The instances in a buffer: where they are before an update, then where they are. */
static enum status upload_instances(struct vk *vk, const struct vk_accel_world *world,
                                    const struct vk_accel_how *how, const struct vk_accel *accel,
                                    struct vk_buffer **out, struct reason *reason)
{
    const uint32_t count = world->instance_count;
    const size_t bytes = 2 * (size_t)count * sizeof(VkAccelerationStructureInstanceKHR);
    VkAccelerationStructureInstanceKHR *instance =
        alloc_zeroed(2 * (size_t)count, sizeof *instance);
    if (!instance)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for %u instances", count);
    for (uint32_t i = 0; i < count; i++) {
        const struct vk_accel_instance *now = &world->instance[i];
        const struct vk_accel_instance *before = world->before ? &world->before[i] : now;
        instance[count + i] = instance_of(vk, accel, how, now);
        if ((before->mesh == VK_ACCEL_NO_MESH) != (now->mesh == VK_ACCEL_NO_MESH))
            before = now; /* an update keeps what is active, and what is not */
        instance[i] = instance_of(vk, accel, how, before);
        if (before == now)
            move_instance(&instance[i]);
    }
    enum status status = vk_buffer_make_of(vk, instance, bytes, out, reason);
    free(instance);
    return status ? status : vk_accel_check_reach(vk, how, *out, reason);
}

static VkAccelerationStructureGeometryKHR instances_at(VkDeviceOrHostAddressConstKHR place)
{
    return (VkAccelerationStructureGeometryKHR){
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR,
        .geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR,
        .geometry.instances =
            {
                .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR,
                .data = place,
            },
    };
}

static enum status build_top(struct vk *vk, const struct vk_accel_world *world,
                             const struct vk_accel_how *how, struct vk_accel *accel,
                             struct reason *reason)
{
    uint32_t count = world->instance_count;
    struct vk_buffer *buffer = NULL;
    enum status status = upload_instances(vk, world, how, accel, &buffer, reason);
    if (!status) {
        const uint64_t at = count * sizeof(VkAccelerationStructureInstanceKHR);
        const VkAccelerationStructureGeometryKHR before = instances_at(
                                                     vk_accel_place(vk, how, buffer, 0)),
                                                 geometry = instances_at(
                                                     vk_accel_place(vk, how, buffer, at));
        const VkAccelerationStructureBuildRangeInfoKHR range = {.primitiveCount = count};
        status = vk_level_build(vk, VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, how,
                                &(struct level_input){&geometry, &range, &count, 1, &before},
                                &accel->top, reason);
    }
    vk_buffer_free(vk, buffer);
    return status;
}

/* --- both ------------------------------------------------------------------------------------- */

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
    const VkPhysicalDeviceAccelerationStructurePropertiesKHR limits = vk_accel_limits(vk);
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

static bool copies_levels(const struct vk_accel_how *how)
{
    return how->copy == VK_ACCEL_COPY_COMPACT || how->copy == VK_ACCEL_COPY_CLONE;
}

/* Builds both levels on a device; the top level is over copies of the bottom ones if the way has
 * them copied. */
static enum status build_levels(struct vk *vk, const struct vk_accel_world *world,
                                const struct vk_accel_how *how, struct vk_accel *accel,
                                struct reason *reason)
{
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i < world->mesh_count && !status; i++) {
        status = vk_bottom_build(vk, how, &world->mesh[i], &accel->bottom[i], reason);
        if (!status && copies_levels(how))
            status = vk_level_copy(vk, VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, how->copy,
                                   &accel->bottom[i], reason);
    }
    if (!status)
        status = build_top(vk, world, how, accel, reason);
    if (!status && copies_levels(how))
        status = vk_level_copy(vk, VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, how->copy,
                               &accel->top, reason);
    return status;
}

static struct vk_accel *make_empty(uint32_t mesh_count)
{
    struct vk_accel *accel = alloc_zeroed(1, sizeof *accel);
    if (accel)
        accel->bottom = alloc_zeroed(mesh_count, sizeof *accel->bottom);
    if (accel && accel->bottom) {
        accel->bottom_count = mesh_count;
        return accel;
    }
    free(accel);
    return NULL;
}

enum status vk_accel_make_world(struct vk *vk, const struct vk_accel_world *world,
                                struct vk_accel **out, struct reason *reason)
{
    static const struct vk_accel_how plain = {0};
    const struct vk_accel_how *how = world->how ? world->how : &plain;
    *out = NULL;
    enum status status = check_limits(vk, world, reason);
    if (status)
        return status;
    struct vk_accel *accel = make_empty(world->mesh_count);
    if (!accel)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for an acceleration structure");
    status = build_levels(vk, world, how, accel, reason);
    if (status)
        vk_accel_free(vk, accel);
    else
        *out = accel;
    return status;
}

/* --- through bytes ---------------------------------------------------------------------------- */

void vk_accel_bytes_free(struct vk_accel_bytes *bytes)
{
    for (uint32_t i = 0; bytes && bytes->level && i <= bytes->bottom_count; i++)
        free(bytes->level[i].byte);
    if (bytes) {
        free(bytes->level);
        free(bytes->address);
    }
    free(bytes);
}

const uint8_t *vk_accel_bytes_level(const struct vk_accel_bytes *bytes, uint32_t level,
                                    uint64_t *count, uint64_t *handle)
{
    if (level > bytes->bottom_count)
        return NULL;
    *count = bytes->level[level].count;
    *handle = level ? bytes->address[level - 1] : 0;
    return bytes->level[level].byte;
}

enum status vk_accel_save(struct vk *vk, const struct vk_accel *accel, struct vk_accel_bytes **out,
                          struct reason *reason)
{
    struct vk_accel_bytes *bytes = *out = alloc_zeroed(1, sizeof *bytes);
    if (bytes) {
        bytes->bottom_count = accel->bottom_count;
        bytes->level = alloc_zeroed((size_t)accel->bottom_count + 1, sizeof *bytes->level);
        bytes->address = alloc_zeroed(accel->bottom_count, sizeof *bytes->address);
    }
    if (!bytes || !bytes->level || !bytes->address)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for serialised structures");
    enum status status = vk_level_save(vk, &accel->top, &bytes->level[0], reason);
    for (uint32_t i = 0; i < accel->bottom_count && !status; i++) {
        bytes->address[i] = vk_level_address(vk, &accel->bottom[i]);
        status = vk_level_save(vk, &accel->bottom[i], &bytes->level[i + 1], reason);
    }
    return status;
}

enum status vk_accel_load(struct vk *vk, struct vk_accel_bytes *bytes, struct vk_accel **out,
                          struct reason *reason)
{
    const uint32_t count = bytes->bottom_count;
    uint64_t *address = alloc_zeroed(count, sizeof *address);
    struct vk_accel *accel = make_empty(count);
    enum status status = STATUS_OK;
    *out = NULL;
    if (!accel || !address)
        status = fail(reason, STATUS_MEMORY, "vulkan: no memory for an acceleration structure");
    for (uint32_t i = 0; i < count && !status; i++) {
        status = vk_level_load(vk, VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR,
                               &bytes->level[i + 1], &accel->bottom[i], reason);
        if (!status)
            address[i] = vk_level_address(vk, &accel->bottom[i]);
    }
    if (!status)
        status = vk_level_relink(vk, &bytes->level[0], bytes->address, address, count, reason);
    if (!status)
        status = vk_level_load(vk, VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, &bytes->level[0],
                               &accel->top, reason);
    free(address);
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
    const struct vk_accel_mesh mesh = {.vertices = vertices,
                                       .indices = indices,
                                       .vertex_count = vertex_count,
                                       .geometry = &geometry,
                                       .geometry_count = 1};
    const struct vk_accel_instance instance = {
        .transform = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
        .mask = 0xFF,
        .flags = VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR,
    };
    const struct vk_accel_world world = {
        .mesh = &mesh, .instance = &instance, .mesh_count = 1, .instance_count = 1};
    return vk_accel_make_world(vk, &world, out, reason);
}

void vk_accel_free(struct vk *vk, struct vk_accel *accel)
{
    if (!accel || !vk_idle(vk))
        return;
    vk_level_free(vk, &accel->top);
    for (uint32_t i = accel->bottom_count; i-- > 0;)
        vk_level_free(vk, &accel->bottom[i]);
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
