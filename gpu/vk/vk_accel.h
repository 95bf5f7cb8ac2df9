/* Acceleration structures for ray queries (VK_KHR_acceleration_structure, VK_KHR_ray_query). Only
 * for devices opened with vk_options.ray_query. */
#ifndef VK_ACCEL_H
#define VK_ACCEL_H

#include "gpu/vk/vk.h"

struct vk_accel; /* a top level over meshes */

/* Triangles first .. first + count - 1 of a mesh. */
struct vk_accel_geometry {
    uint32_t first, count;
    bool opaque;
};

struct vk_accel_mesh {
    struct vk_buffer *vertices; /* three floats each */
    struct vk_buffer *indices;  /* three uint32_t per triangle */
    uint32_t vertex_count;      /* 0 only if no geometry has triangles */
    const struct vk_accel_geometry *geometry;
    uint32_t geometry_count; /* at least 1 */
};

#define VK_ACCEL_NO_MESH 0xFFFFFFFFu

/* The numbers of VkAccelerationStructureInstanceKHR. */
struct vk_accel_instance {
    float transform[3][4];
    uint32_t mesh; /* or VK_ACCEL_NO_MESH: a null reference */
    uint32_t custom, mask, flags;
};

struct vk_accel_world {
    const struct vk_accel_mesh *mesh;
    const struct vk_accel_instance *instance;
    uint32_t mesh_count;
    uint32_t instance_count; /* 0 is allowed: nothing is hit */
};

/* Builds a structure for each mesh and the top level over them. The buffers may be freed
 * afterwards. *out is NULL on error. Errors: STATUS_LIMIT more triangles, geometries or instances
 * than the device allows (the number and what it allows), or too large a structure; STATUS_MEMORY;
 * STATUS_DEVICE. */
enum status vk_accel_make_world(struct vk *vk, const struct vk_accel_world *world,
                                struct vk_accel **out, struct reason *reason) MUST_USE;

/* Builds a structure of one mesh, opaque or not as queries ask, in one instance without a
 * transform: `tri_count` triples of indices into vertices, at least 1 of each. Errors: as
 * vk_accel_make_world. */
enum status vk_accel_make(struct vk *vk, struct vk_buffer *vertices, uint32_t vertex_count,
                          struct vk_buffer *indices, uint32_t tri_count, struct vk_accel **out,
                          struct reason *reason) MUST_USE;

void vk_accel_free(struct vk *vk, struct vk_accel *accel); /* NULL is fine */
uint64_t vk_accel_bytes(const struct vk_accel *accel);     /* NULL: 0 */

/* Binds the structure to a pipeline made with vk_shader.accel, for later dispatches. */
void vk_pipeline_use(struct vk *vk, struct vk_pipeline *pipeline, const struct vk_accel *accel);

#endif
