/* The storage buffers of the Vulkan subjects. */
#include "fuzz/export/export_inner.h"

#include "gpu/trace/gather.h"

void export_buffers(const struct export_case *the, struct export_buffer out[DISPATCH_BINDINGS])
{
    static const char *const names[DISPATCH_BINDINGS] = {
        [ABI_BIND_RAYS] = "rays",   [ABI_BIND_HITS] = "hits",   [ABI_BIND_FLAGS] = "flags",
        [ABI_BIND_NODES] = "nodes", [ABI_BIND_ITEMS] = "items", [ABI_BIND_TRIS] = "triangles",
        [ABI_BIND_FOUND] = "found"};
    const uint64_t rays = the->ray_count, tris = the->trial->scene.tri_count;
    bool in_buffers = the->subject != SUBJECT_QUERY;
    uint64_t bytes[DISPATCH_BINDINGS] = {
        [ABI_BIND_RAYS] = rays * sizeof(struct ray),
        [ABI_BIND_HITS] = rays * sizeof(struct hit),
        [ABI_BIND_FLAGS] = rays * sizeof(uint32_t),
        [ABI_BIND_NODES] = packed_node_bytes(&the->packed),
        [ABI_BIND_ITEMS] = packed_item_bytes(&the->packed),
        [ABI_BIND_TRIS] = in_buffers ? gather_bytes(the->trial->scene.tri_count) : 0,
    };
    for (uint32_t i = 0; i < DISPATCH_BINDINGS; i++) {
        out[i] = (struct export_buffer){names[i], bytes[i] ? bytes[i] : 16, bytes[i]};
        if (i == ABI_BIND_HITS || i == ABI_BIND_FLAGS)
            out[i].data_bytes = 0;
        if (i == ABI_BIND_TRIS && in_buffers)
            out[i].data_bytes = ABI_TRI_FLOATS * sizeof(float) * tris;
    }
}
