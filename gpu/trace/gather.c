#include "gpu/trace/gather.h"

#include "ref/abi.h"

#include <stdlib.h>

/* Triangles gathered at a time. */
#define GATHER 8192u

#define TRI_BYTES  (ABI_TRI_FLOATS * sizeof(float))
#define QUAD_BYTES 16u

uint64_t gather_bytes(uint64_t count)
{
    return (TRI_BYTES * count + QUAD_BYTES - 1) / QUAD_BYTES * QUAD_BYTES;
}

enum status gather_write(struct vk *vk, const struct scene *scene, struct vk_buffer *buffer,
                         uint64_t first, struct reason *reason)
{
    enum status status = STATUS_OK;
    float(*tri)[3][3] = alloc_zeroed(GATHER, sizeof *tri);
    if (!tri)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory to gather triangles");
    for (uint32_t done = 0; done < scene->tri_count && !status;) {
        uint32_t part = scene->tri_count - done < GATHER ? scene->tri_count - done : GATHER;
        for (uint32_t i = 0; i < part; i++)
            scene_tri(scene, done + i, tri[i]);
        status =
            vk_buffer_write(vk, buffer, TRI_BYTES * (first + done), tri, TRI_BYTES * part, reason);
        done += part;
    }
    free(tri);
    return status;
}

enum status gather_triangles(struct vk *vk, const struct scene *scene, struct vk_buffer **out,
                             struct reason *reason)
{
    enum status status = vk_buffer_make(vk, gather_bytes(scene->tri_count), out, reason);
    if (status)
        return status;
    status = gather_write(vk, scene, *out, 0, reason);
    if (status) {
        vk_buffer_free(vk, *out);
        *out = NULL;
    }
    return status;
}
