/* The fast traversal on all cores. Any packed tree is converted to a form of ref/fast/fast.h. */
#include "ref/engines/fast_inner.h"

#include "ref/engines/cpu_rays.h"
#include "ref/fast/decoded.h"
#include "ref/twin/model.h"

#include <stdio.h>
#include <stdlib.h>

enum status fast_engine_open(const struct engine_options *options, bool small, void **self,
                             struct reason *reason)
{
    /* struct fast_tree is aligned for vectors. */
    struct fast *fast = aligned_alloc(_Alignof(struct fast), sizeof *fast);
    *self = fast;
    if (!fast)
        return fail(reason, STATUS_MEMORY, "no memory for an engine");
    *fast = (struct fast){.kernel = small ? fast_small_kernel_best() : fast_kernel_best(),
                          .small = small,
                          .threads = cpu_rays_threads(options),
                          .alone = options->alone};
    return STATUS_OK;
}

static enum status fast_open(const struct engine *engine, const struct engine_options *options,
                             void **self, struct reason *reason)
{
    (void)engine;
    return fast_engine_open(options, false, self, reason);
}

void fast_close(void *self)
{
    struct fast *fast = self;
    if (fast) {
        fast_free(&fast->tree);
        fast_world_free(&fast->world);
    }
    free(fast);
}

enum status fast_takes_layout(const struct layout *layout, const char *engine,
                              struct reason *reason)
{
    if (layout->faithful)
        return fail(reason, STATUS_UNSUPPORTED, "%s has no layout that loses hits, as %s", engine,
                    layout->name);
    return STATUS_OK;
}

enum status fast_prepare(void *self, const struct job *job, struct reason *reason)
{
    struct fast *fast = self;
    struct bvh bvh = {.node = NULL};
    fast_free(&fast->tree);
    fast->query = job->query;
    enum status status =
        fast_takes_layout(job->packed->layout, fast->small ? "fast_small" : "fast", reason);
    if (status || job->packed->node_count == 0)
        return status;
    const struct fast_form *form = fast_form_of(fast->small, job->packed);
    fast->kernel = form->kernel();
    status = fast_decode(job->packed, job->scene, &bvh, reason);
    if (!status)
        status = form->make(&bvh, job->scene, &fast->tree, reason);
    if (fast->alone)
        fast->tree.in_packets = fast->tree.in_stream = fast->tree.in_pairs = false;
    bvh_free(&bvh);
    return status;
}

enum status fast_trace(void *self, const struct ray *ray, size_t ray_count, struct hit *hit,
                       struct trace_report *report, struct reason *reason)
{
    (void)reason;
    struct fast *fast = self;
    size_t chunks = (ray_count + FAST_CHUNK - 1) / FAST_CHUNK;
    uint64_t start = time_ns();
#pragma omp parallel for schedule(dynamic, 1) num_threads(fast->threads) if (chunks > 1)
    for (size_t i = 0; i < chunks; i++) {
        size_t first = i * FAST_CHUNK, count = fast_chunk(i, ray_count);
        if (fast->tree.node_count == 0)
            for (size_t k = first; k < first + count; k++)
                hit[k] = (struct hit){.prim = ABI_NO_PRIM};
        else if (fast->query == QUERY_ANY)
            fast->kernel->any(&fast->tree, ray + first, count, hit + first);
        else
            fast->kernel->closest(&fast->tree, ray + first, count, hit + first);
    }
    const size_t node = fast_node_bytes(&fast->tree);
    *report = (struct trace_report){.ns = time_ns() - start,
                                    .node_bytes = node * fast->tree.node_count,
                                    .item_bytes = 4 * fast->tree.block_words,
                                    .memory_bytes = fast_bytes(&fast->tree)};
    return STATUS_OK;
}

enum status fast_trace_all(void *self, const struct ray *ray, size_t ray_count, uint32_t capacity,
                           struct hit *hit, uint32_t *hit_count, struct reason *reason)
{
    (void)reason;
    struct fast *fast = self;
#pragma omp parallel for schedule(dynamic, FAST_CHUNK)                                             \
    num_threads(fast->threads) if (ray_count > FAST_CHUNK)
    for (size_t i = 0; i < ray_count; i++)
        hit_count[i] = fast_all(&fast->tree, &ray[i], capacity, hit + i * capacity);
    return STATUS_OK;
}

struct model fast_model(const struct engine *engine, void *self, const struct tri_test *tri)
{
    (void)tri;
    return cpu_rays_model(engine, self, tri_test_find("woop"));
}

static void fast_describe(const struct engine *engine, const struct engine_options *options,
                          char *text, size_t text_bytes)
{
    (void)engine;
    snprintf(text, text_bytes, "%u threads, kernel %s, triangle test woop",
             cpu_rays_threads(options), fast_kernel_best()->name);
}

extern const struct engine engine_fast;
const struct engine engine_fast = {
    .name = "fast",
    .summary = "C with AVX2 and AVX-512: 8-wide nodes, leaves that share vertices; test woop",
    .needs_packed = true,
    .own_tri = true,
    .tri_name = "woop",
    .own_tree = true,
    .open = fast_open,
    .prepare = fast_prepare,
    .trace = fast_trace,
    .trace_all = fast_trace_all,
    .worlds = &fast_worlds,
    .model = fast_model,
    .close = fast_close,
    .describe = fast_describe,
};
