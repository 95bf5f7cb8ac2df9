/* Acceleration structures for ray queries (VK_KHR_acceleration_structure, VK_KHR_ray_query). Only
 * for devices opened with vk_options.ray_query. */
#ifndef VK_ACCEL_H
#define VK_ACCEL_H

#include "gpu/vk/vk.h"

struct vk_accel;       /* a top level over meshes */
struct vk_accel_bytes; /* the same, serialised */

/* --- how a structure comes to be -------------------------------------------------------------- */

enum vk_accel_update {
    VK_ACCEL_UPDATE_NONE,
    VK_ACCEL_UPDATE_IN_PLACE, /* built over other vertices and transforms, then updated */
    VK_ACCEL_UPDATE_INTO,     /* the same, into another structure; the first is then freed */
    VK_ACCEL_UPDATES
};

/* What the structure that is traced is a copy of; the first is freed before it is traced. */
enum vk_accel_copy {
    VK_ACCEL_COPY_NONE,
    VK_ACCEL_COPY_COMPACT,
    VK_ACCEL_COPY_CLONE,
    VK_ACCEL_COPY_SERIALISE,     /* through the memory of the host */
    VK_ACCEL_COPY_SERIALISE_NEW, /* built on a device of its own, which is closed before */
    VK_ACCEL_COPIES
};

enum vk_accel_where { VK_ACCEL_BY_DEVICE, VK_ACCEL_INDIRECT, VK_ACCEL_BY_HOST, VK_ACCEL_WHERES };

/* The way of both levels. Zeros: built once on the device, without flags. */
struct vk_accel_how {
    bool fast_trace, fast_build; /* not both */
    bool low_memory, allow_update, allow_compaction;
    enum vk_accel_update update;
    enum vk_accel_copy copy;
    enum vk_accel_where where;
};

/* --- what it is made of ----------------------------------------------------------------------- */

#define VK_ACCEL_NO_TRANSFORM UINT64_MAX

/* The numbers of one geometry's input, with the meaning that the standard gives them; `_at` are
 * offsets in the buffers of the mesh, of the address that the driver is told. */
struct vk_accel_form {
    uint32_t format;      /* a VkFormat */
    uint32_t index_bytes; /* 4, 2, or 0: no indices */
    uint64_t vertices_at, stride, indices_at;
    uint64_t transform_at; /* or VK_ACCEL_NO_TRANSFORM */
    uint32_t max_vertex, first_vertex, primitive_offset, transform_offset;
};

/* Triangles first .. first + count - 1 of a mesh. */
struct vk_accel_geometry {
    uint32_t first, count;
    bool opaque;
    const struct vk_accel_form *form; /* NULL: three floats a vertex, uint32_t indices; else `first`
                                       * is unused */
};

struct vk_accel_mesh {
    struct vk_buffer *vertices; /* three floats each, or as the forms say */
    struct vk_buffer *indices;  /* three uint32_t per triangle, or as the forms say */
    uint32_t vertex_count;      /* 0 only if no geometry has triangles */
    const struct vk_accel_geometry *geometry;
    uint32_t geometry_count;      /* at least 1 */
    struct vk_buffer *before;     /* vertices that an update finds; else unused */
    struct vk_buffer *transforms; /* three rows of four floats each; NULL: no form has one */
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
    /* What an update finds; NULL: the same instances elsewhere, and smaller, as also in place of
     * one that has a mesh in only one of the two. */
    const struct vk_accel_instance *before;
    const struct vk_accel_how *how; /* NULL: built once, without flags */
};

/* What vk_accel_make_world needs of the device beyond ray queries for a way other than NULL; to be
 * put into vk_options.ray_more. */
struct vk_ray_more vk_accel_needs(const struct vk_accel_how *how);

/* True if the device takes vertices of a VkFormat. */
bool vk_accel_takes_format(struct vk *vk, uint32_t format);

/* Builds a structure for each mesh and the top level over them, in the way of the world. The
 * buffers may be freed afterwards. *out is NULL on error. Errors: STATUS_LIMIT more triangles,
 * geometries or instances than the device allows (the number and what it allows), or too large a
 * structure; STATUS_UNSUPPORTED a build by the host of buffers that it cannot reach; STATUS_MEMORY;
 * STATUS_DEVICE. */
enum status vk_accel_make_world(struct vk *vk, const struct vk_accel_world *world,
                                struct vk_accel **out, struct reason *reason) MUST_USE;

/* Builds a structure of one mesh, opaque or not as queries ask, in one instance without a
 * transform: `tri_count` triples of indices into vertices, at least 1 of each. Errors: as
 * vk_accel_make_world. */
enum status vk_accel_make(struct vk *vk, struct vk_buffer *vertices, uint32_t vertex_count,
                          struct vk_buffer *indices, uint32_t tri_count, struct vk_accel **out,
                          struct reason *reason) MUST_USE;

/* Serialises both levels. *out is to be freed also on error. Needs vk_options.ray_more.lives.
 * Errors: as vk_accel_make_world. */
enum status vk_accel_save(struct vk *vk, const struct vk_accel *accel, struct vk_accel_bytes **out,
                          struct reason *reason) MUST_USE;

/* Deserialises both levels, once, on the same device or another; the handles in the bytes are
 * replaced. Errors: as vk_accel_make_world; STATUS_DEVICE the device calls the bytes incompatible,
 * or a handle is that of no structure. */
enum status vk_accel_load(struct vk *vk, struct vk_accel_bytes *bytes, struct vk_accel **out,
                          struct reason *reason) MUST_USE;
void vk_accel_bytes_free(struct vk_accel_bytes *bytes); /* NULL is fine */

/* A serialised level, borrowed: 0 is the top one, i + 1 that of mesh i, whose handle in the top
 * level's bytes is *handle (0 of the top level). NULL: there is no such level. */
const uint8_t *vk_accel_bytes_level(const struct vk_accel_bytes *bytes, uint32_t level,
                                    uint64_t *count, uint64_t *handle);

void vk_accel_free(struct vk *vk, struct vk_accel *accel); /* NULL is fine */
uint64_t vk_accel_bytes(const struct vk_accel *accel);     /* NULL: 0 */

/* Binds the structure to a pipeline made with vk_shader.accel, for later dispatches. */
void vk_pipeline_use(struct vk *vk, struct vk_pipeline *pipeline, const struct vk_accel *accel);

#endif
