/* What the driver is told of the triangles of a mesh. */
#include "gpu/vk/vk_accel_inner.h"

#include <stdlib.h>

VkDeviceOrHostAddressConstKHR vk_accel_place(struct vk *vk, const struct vk_accel_how *how,
                                             const struct vk_buffer *buffer, uint64_t at)
{
    if (how->where == VK_ACCEL_BY_HOST)
        return (VkDeviceOrHostAddressConstKHR){.hostAddress = buffer->map + at};
    return (VkDeviceOrHostAddressConstKHR){.deviceAddress = vk_address(vk, buffer) + at};
}

enum status vk_accel_check_reach(const struct vk *vk, const struct vk_accel_how *how,
                                 const struct vk_buffer *buffer, struct reason *reason)
{
    if (how->where != VK_ACCEL_BY_HOST || !buffer || buffer->map)
        return STATUS_OK;
    return fail(reason, STATUS_UNSUPPORTED,
                "vulkan: builds by the host need memory that it shares with %s", vk->limits.device);
}

/* What a geometry is without a form. */
static struct vk_accel_form form_of(const struct vk_accel_mesh *mesh,
                                    const struct vk_accel_geometry *geometry)
{
    if (geometry->form)
        return *geometry->form;
    return (struct vk_accel_form){
        .format = VK_FORMAT_R32G32B32_SFLOAT,
        .index_bytes = 4,
        .stride = 3 * sizeof(float),
        .transform_at = VK_ACCEL_NO_TRANSFORM,
        .max_vertex = mesh->vertex_count ? mesh->vertex_count - 1 : 0,
        .primitive_offset = geometry->first * 3 * (uint32_t)sizeof(uint32_t),
    };
}

static VkAccelerationStructureGeometryKHR
triangles_of(struct vk *vk, const struct vk_accel_how *how, const struct vk_accel_mesh *mesh,
             const struct vk_buffer *vertices, const struct vk_accel_geometry *from)
{
    const struct vk_accel_form form = form_of(mesh, from);
    VkAccelerationStructureGeometryTrianglesDataKHR triangles = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR,
        .vertexFormat = (VkFormat)form.format,
        .vertexData = vk_accel_place(vk, how, vertices, form.vertices_at),
        .vertexStride = form.stride,
        .maxVertex = form.max_vertex,
        .indexType = form.index_bytes == 4   ? VK_INDEX_TYPE_UINT32
                     : form.index_bytes == 2 ? VK_INDEX_TYPE_UINT16
                                             : VK_INDEX_TYPE_NONE_KHR,
    };
    if (form.index_bytes)
        triangles.indexData = vk_accel_place(vk, how, mesh->indices, form.indices_at);
    if (form.transform_at != VK_ACCEL_NO_TRANSFORM)
        triangles.transformData = vk_accel_place(vk, how, mesh->transforms, form.transform_at);
    return (VkAccelerationStructureGeometryKHR){
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR,
        .geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR,
        .geometry.triangles = triangles,
        /* So that queries which list candidates get each triangle once. */
        .flags = VK_GEOMETRY_NO_DUPLICATE_ANY_HIT_INVOCATION_BIT_KHR |
                 (from->opaque ? VK_GEOMETRY_OPAQUE_BIT_KHR : 0u),
    };
}

static enum status check_reaches(const struct vk *vk, const struct vk_accel_how *how,
                                 const struct vk_accel_mesh *mesh, struct reason *reason)
{
    enum status status = vk_accel_check_reach(vk, how, mesh->vertices, reason);
    if (!status)
        status = vk_accel_check_reach(vk, how, mesh->indices, reason);
    if (!status)
        status = vk_accel_check_reach(vk, how, mesh->before, reason);
    return status ? status : vk_accel_check_reach(vk, how, mesh->transforms, reason);
}

enum status vk_bottom_build(struct vk *vk, const struct vk_accel_how *how,
                            const struct vk_accel_mesh *mesh, struct level *out,
                            struct reason *reason)
{
    const uint32_t count = mesh->geometry_count;
    VkAccelerationStructureGeometryKHR *geometry =
        alloc_zeroed(2 * (size_t)count, sizeof *geometry);
    VkAccelerationStructureBuildRangeInfoKHR *range = alloc_zeroed(count, sizeof *range);
    uint32_t *most = alloc_zeroed(count, sizeof *most);
    enum status status = check_reaches(vk, how, mesh, reason);
    if (!geometry || !range || !most)
        status = fail(reason, STATUS_MEMORY, "vulkan: no memory for %u geometries", count);
    for (uint32_t i = 0; i < count && !status; i++) {
        const struct vk_accel_form form = form_of(mesh, &mesh->geometry[i]);
        geometry[i] = triangles_of(vk, how, mesh, mesh->vertices, &mesh->geometry[i]);
        if (how->update != VK_ACCEL_UPDATE_NONE)
            geometry[count + i] = triangles_of(vk, how, mesh, mesh->before, &mesh->geometry[i]);
        range[i].primitiveCount = most[i] = mesh->geometry[i].count;
        range[i].primitiveOffset = form.primitive_offset;
        range[i].firstVertex = form.first_vertex;
        range[i].transformOffset = form.transform_offset;
    }
    if (!status)
        status = vk_level_build(
            vk, VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, how,
            &(struct level_input){geometry, range, most, count, geometry + count}, out, reason);
    free(geometry);
    free(range);
    free(most);
    return status;
}
