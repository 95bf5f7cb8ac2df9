#include "ref/fast/fast_world.h"

#include "ref/base/memory.h"

#include <stdlib.h>

/* True if every candidate counts that no flag of a ray concerns. */
static bool is_plain(const struct world *world)
{
    bool opaque = true;
    for (uint32_t i = 0; i < world->instance_count; i++)
        opaque = opaque && !(world->instance[i].flags & ABI_INSTANCE_FORCE_NO_OPAQUE);
    for (uint32_t i = 0; i < world->mesh_count; i++)
        for (uint32_t g = 0; g < world->mesh[i].geometry_count; g++)
            opaque = opaque && world->mesh[i].geometry[g].opaque;
    return opaque || world->filter.kind == FILTER_ALL;
}

static struct fast_instance instance_of(const struct instance_record *record)
{
    struct fast_instance out = {.mesh = record->mesh,
                                .custom_mask = record->custom_mask,
                                .first = record->first,
                                .flags = record->flags};
    for (int j = 0; j < 3; j++) {
        for (int k = 0; k < 3; k++)
            out.column[j][k] = record->w[3 * k + j];
        out.column[j][3] = record->t[j];
    }
    return out;
}

static enum status make_instances(const struct world *world, struct fast_world *out,
                                  struct reason *reason)
{
    size_t bytes = ((size_t)world->instance_count + 1) * sizeof *out->instance; /* of none, too */
    out->instance = memory_fits(bytes) ? aligned_alloc(64, bytes) : NULL;
    out->bottom = alloc_zeroed(world->mesh_count, sizeof *out->bottom);
    if (!out->instance || !out->bottom)
        return fail(reason, STATUS_MEMORY, "fast: no memory for %u instances",
                    world->instance_count);
    for (uint32_t i = 0; i < world->instance_count; i++)
        out->instance[i] = instance_of(&out->record[i]);
    return STATUS_OK;
}

enum status fast_world_make(const struct world *world, const struct bvh *top,
                            const struct scene *items, const struct bvh *bottom,
                            const struct instance_record *record, struct fast_world *out,
                            struct reason *reason)
{
    struct reason why = {""};
    *out = (struct fast_world){.mesh_count = world->mesh_count,
                               .world = world,
                               .record = record,
                               .plain = is_plain(world)};
    enum status status = make_instances(world, out, reason);
    if (!status) {
        status = fast_make_items(top, items, &out->top, &why);
        if (status)
            (void)fail(reason, status, "top level: %s", why.text);
    }
    for (uint32_t i = 0; i < world->mesh_count && !status; i++) {
        if (bottom[i].node_count == 0)
            continue;
        status = fast_make(&bottom[i], world->mesh[i].scene, &out->bottom[i], &why);
        if (status)
            (void)fail(reason, status, "mesh %u: %s", i, why.text);
    }
    if (status)
        fast_world_free(out);
    return status;
}

void fast_world_free(struct fast_world *fast)
{
    for (uint32_t i = 0; fast->bottom && i < fast->mesh_count; i++)
        fast_free(&fast->bottom[i]);
    fast_free(&fast->top);
    free(fast->bottom);
    free(fast->instance);
    *fast = (struct fast_world){.world = NULL};
}

uint64_t fast_world_bytes(const struct fast_world *fast)
{
    uint64_t bytes = fast_bytes(&fast->top);
    for (uint32_t i = 0; i < fast->mesh_count; i++)
        bytes += fast_bytes(&fast->bottom[i]);
    return bytes + sizeof *fast->instance * fast->world->instance_count;
}
