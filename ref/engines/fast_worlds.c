#include "ref/engines/fast_inner.h"

#include "ref/fast/decoded.h"
#include "ref/two_level/packed_world.h"

#include <stdlib.h>

/* Trees in the form that fast_world_make takes. */
struct fast_decoding {
    struct bvh top, *bottom;
    struct scene items;
    uint32_t mesh_count;
};

static void decoding_free(struct fast_decoding *d)
{
    for (uint32_t i = 0; d->bottom && i < d->mesh_count; i++)
        bvh_free(&d->bottom[i]);
    free(d->bottom);
    bvh_free(&d->top);
    scene_free(&d->items);
}

static enum status decode_tree(const struct packed *packed, const struct scene *scene,
                               struct bvh *out, struct reason *reason)
{
    *out = (struct bvh){.node = NULL};
    if (packed->node_count == 0)
        return STATUS_OK;
    enum status status = fast_takes_layout(packed->layout, "fast", reason);
    return status ? status : fast_decode(packed, scene, out, reason);
}

/* The tree of whole instances, for worlds whose top has parts of them: this engine's boxes have no
 * room for what is lost between parts (ref/two_level/braid.h). */
static enum status build_top(const struct world_job *job, struct bvh *out, struct reason *reason)
{
    const struct world_parts none = {.part = NULL};
    const struct build_options options = {.leaf = BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT};
    return world_top_make(job->world, &none, job->packed->box, builders[0], &options, out, reason);
}

static enum status decode_world(const struct world_job *job, struct fast_decoding *d,
                                struct reason *reason)
{
    const struct packed_world *packed = job->packed;
    *d = (struct fast_decoding){.mesh_count = packed->mesh_count};
    d->bottom = alloc_zeroed(packed->mesh_count, sizeof *d->bottom);
    if (!d->bottom)
        return fail(reason, STATUS_MEMORY, "fast: no memory for %u trees", packed->mesh_count);
    const struct world_parts none = {.part = NULL};
    enum status status = world_items_make(job->world, &none, packed->box, &d->items, reason);
    if (!status)
        status = packed->entry_count > packed->instance_count
                     ? build_top(job, &d->top, reason)
                     : decode_tree(&packed->top, &d->items, &d->top, reason);
    for (uint32_t i = 0; i < packed->mesh_count && !status; i++)
        status = decode_tree(&packed->bottom[i], job->world->mesh[i].scene, &d->bottom[i], reason);
    return status;
}

static enum status prepare_world(void *self, const struct world_job *job, struct reason *reason)
{
    struct fast *fast = self;
    struct fast_decoding d;
    fast_world_free(&fast->world);
    fast_free(&fast->tree);
    fast->query = job->query;
    enum status status = decode_world(job, &d, reason);
    if (!status)
        status = fast_world_make(job->world, &d.top, &d.items, d.bottom, job->packed->record,
                                 &fast->world, reason);
    decoding_free(&d);
    return status;
}

static enum status trace_world(void *self, const struct ray *ray, const struct ray_mode *mode,
                               size_t ray_count, struct hit *hit, uint32_t *tag,
                               struct trace_report *report, struct reason *reason)
{
    (void)reason;
    struct fast *fast = self;
    size_t chunks = (ray_count + FAST_CHUNK - 1) / FAST_CHUNK;
    uint64_t start = time_ns();
#pragma omp parallel for schedule(dynamic, 1) num_threads(fast->threads) if (chunks > 1)
    for (size_t i = 0; i < chunks; i++) {
        size_t first = i * FAST_CHUNK, count = fast_chunk(i, ray_count);
        fast->kernel->world(&fast->world, ray + first, mode ? mode + first : NULL, count,
                            fast->query == QUERY_ANY, hit + first, tag + first);
    }
    *report = (struct trace_report){.ns = time_ns() - start,
                                    .memory_bytes = fast_world_bytes(&fast->world)};
    return STATUS_OK;
}

static enum status trace_world_all(void *self, const struct ray *ray, const struct ray_mode *mode,
                                   size_t ray_count, uint32_t capacity, struct hit *hit,
                                   uint32_t *tag, uint32_t *hit_count, struct reason *reason)
{
    (void)reason;
    struct fast *fast = self;
#pragma omp parallel for schedule(dynamic, FAST_CHUNK)                                             \
    num_threads(fast->threads) if (ray_count > FAST_CHUNK)
    for (size_t i = 0; i < ray_count; i++)
        hit_count[i] = fast_world_all(&fast->world, &ray[i], mode ? mode[i] : ray_mode_all(),
                                      capacity, hit + i * capacity, tag + i * capacity);
    return STATUS_OK;
}

const struct world_tracer fast_worlds = {
    .prepare_world = prepare_world,
    .trace_world = trace_world,
    .trace_world_all = trace_world_all,
};
