#include "gpu/trace/gather.h"

#include "ref/abi.h"

#include <stdlib.h>

/* Triangles gathered at a time. */
#define GATHER 8192u

#define QUAD_BYTES 16u

uint64_t gather_bytes(const struct scene *scene)
{
    uint64_t whole = (uint64_t)ABI_TRI_FLOATS * sizeof(float) * scene->tri_count;
    return (whole + QUAD_BYTES - 1) / QUAD_BYTES * QUAD_BYTES;
}

enum status gather_triangles(struct vk *vk, const struct scene *scene, struct vk_buffer **out,
                             struct reason *reason)
{
    const uint64_t bytes = ABI_TRI_FLOATS * sizeof(float);
    enum status status = vk_buffer_make(vk, gather_bytes(scene), out, reason);
    if (status)
        return status;
    float(*tri)[3][3] = alloc_zeroed(GATHER, sizeof *tri);
    if (!tri)
        status = fail(reason, STATUS_MEMORY, "vulkan: no memory to gather triangles");
    for (uint32_t done = 0; done < scene->tri_count && !status;) {
        uint32_t part = scene->tri_count - done < GATHER ? scene->tri_count - done : GATHER;
        for (uint32_t i = 0; i < part; i++)
            scene_tri(scene, done + i, tri[i]);
        status = vk_buffer_write(vk, *out, bytes * done, tri, bytes * part, reason);
        done += part;
    }
    free(tri);
    if (status) {
        vk_buffer_free(vk, *out);
        *out = NULL;
    }
    return status;
}
