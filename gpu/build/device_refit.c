#include "gpu/build/device_refit.h"

#include "gpu/build/device_tree_inner.h"
#include "ref/packed/packed_walk.h"
#include "ref/store.h"

#include <stdlib.h>
#include <string.h>

/* How a layout is refitted; `push` has no count. */
struct refitted {
    enum kernel kernel;
    struct refit_push push;
};

/* What is uploaded beside the nodes. A node is a reference of a binary layout, of a wide one a
 * record in one of its formats. */
struct refit_job {
    struct refitted how;
    const struct packed *packed;
    const struct scene *scene;
    uint32_t node_count;
    uint32_t *link;  /* two words a node */
    uint32_t *first; /* nodes that wait for no other */
    uint32_t first_count;
};

/* False if there is no shader for a layout. */
static bool find(const struct layout *layout, struct refitted *out)
{
    static const struct {
        const char *name;
        struct refitted how;
    } named[] = {
        {"f32", {REFIT, {.kind = ABI_REFIT_F32}}},
        {"rf16", {REFIT, {.kind = ABI_REFIT_RF16}}},
        {"cwbvh80", {REFIT_CWBVH80, {0}}},
        {"tiny8", {REFIT_TINY8, {0}}},
        {"tiny8_l8", {REFIT_TINY8, {0}}},
        {"tiny8_l14", {REFIT_TINY8, {0}}},
        {"half4", {REFIT_HALF4, {0}}},
        {"hpb64", {REFIT_HPB64, {0}}},
        {"amd64", {REFIT_AMD64, {.kind = ABI_REFIT_OUTWARD}}},
        {"amd64_f16", {REFIT_AMD64, {.kind = ABI_REFIT_OUTWARD}}},
        {"amd64_f32", {REFIT_AMD64, {.kind = ABI_REFIT_OUTWARD}}},
        {"amd64_g0", {REFIT_AMD64, {.kind = ABI_REFIT_NEAREST}}},
        {"amd64_g1", {REFIT_AMD64, {.kind = ABI_REFIT_NEAREST, .number = 1}}},
        {"gfx12", {REFIT_GFX12, {.kind = ABI_REFIT_OUTWARD}}},
        {"gfx12_mesa", {REFIT_GFX12, {.kind = ABI_REFIT_NEAREST}}},
    };
    for (size_t i = 0; i < ARRAY_COUNT(named); i++)
        if (layout == layout_find(named[i].name)) {
            *out = named[i].how;
            return true;
        }
    *out = (struct refitted){
        REFIT_GRID,
        {.width = layout->width, .number = layout->constant[0], .frame = layout->constant[1]}};
    return !layout->outside && strncmp(layout_shader(layout), "grid", 4) == 0;
}

bool device_refits(const struct layout *layout)
{
    struct refitted how;
    return find(layout, &how);
}

static enum status may_refit(const struct packed *packed, struct refitted *how,
                             struct reason *reason)
{
    if (!find(packed->layout, how))
        return fail(reason, STATUS_UNSUPPORTED, "layout %s is not refitted on a device",
                    packed->layout->name);
    if (!packed->layout->item && !tri_store_reads_scene(packed->store))
        return fail(reason, STATUS_UNSUPPORTED, "storage %s is not refitted on a device",
                    packed->store->name);
    if (packed->split)
        return fail(reason, STATUS_LIMIT, "rebuild: the tree is split");
    return STATUS_OK;
}

/* How many children a node waits for, those that are nodes themselves. */
static uint32_t awaited(const struct packed *packed, uint32_t node)
{
    struct wide decoded;
    uint32_t count = 0;
    packed->layout->load(packed, node, &decoded);
    for (uint32_t c = 0; c < decoded.child_count; c++)
        count += !layout_is_wide(packed->layout) || decoded.leaf_count[c] == 0;
    return count;
}

/* Lists the links of the nodes that are reached, and the nodes that wait for no other. */
static void list_nodes(struct refit_job *job, const struct packed_walk *walk)
{
    for (uint32_t i = 0; i < walk->visit_count; i++) {
        const uint32_t node = walk->visit[i].ref;
        if (node >= job->node_count)
            continue; /* a leaf without a record */
        const uint32_t count = awaited(job->packed, node);
        job->link[2 * (size_t)node] =
            i > 0 ? walk->visit[walk->visit[i].parent].ref : ABI_LINK_NONE;
        job->link[2 * (size_t)node + 1] = 2 - count;
        if (count == 0)
            job->first[job->first_count++] = node;
    }
}

/* References of nodes. Beside them a wide layout has one for each slot of a leaf. */
static uint32_t nodes_of(const struct packed *packed)
{
    const struct layout *layout = packed->layout;
    if (!layout_is_wide(layout))
        return packed->ref_count;
    return packed->node_count * (layout_refs(layout) / (1 + layout->width)); /* a node a format */
}

static enum status list(struct refit_job *job, struct reason *reason)
{
    const struct packed *packed = job->packed;
    struct packed_walk walk;
    enum status status = packed_walk_make(packed, &walk);
    job->node_count = nodes_of(packed);
    if (job->how.kernel == REFIT_AMD64)
        job->how.push.width = packed->node_count;
    job->link = alloc_zeroed(2 * (size_t)job->node_count, sizeof *job->link);
    job->first = malloc(sizeof *job->first * (size_t)job->node_count);
    if (status || !job->link || !job->first)
        status = fail(reason, STATUS_MEMORY, "no memory to refit %u records", packed->node_count);
    else if (walk.repeats > 0 || walk.bad_refs > 0)
        status = fail(reason, STATUS_INPUT, "%s: the words are not a tree", packed->layout->name);
    else
        list_nodes(job, &walk);
    packed_walk_free(&walk);
    return status;
}

/* Makes buffer b large enough, and writes the words to it; NULL: writes nothing. */
static enum status upload(struct device_tree *tree, int b, const void *from, uint64_t words,
                          struct reason *reason)
{
    const uint64_t bytes = sizeof(uint32_t) * words;
    enum status status = vk_buffer_grow(tree->vk, bytes, &tree->buffer[b], reason);
    if (!status && from && bytes > 0)
        status = vk_buffer_write(tree->vk, tree->buffer[b], 0, from, bytes, reason);
    return status;
}

static enum status upload_all(struct device_tree *tree, const struct refit_job *job,
                              struct reason *reason)
{
    static const uint32_t state[ABI_STATE_WORDS];
    const struct packed *packed = job->packed;
    const struct {
        int binding;
        const void *from;
        uint64_t words;
    } buffers[] = {
        {ABI_BUILD_VERTICES, job->scene->vertex, 3 * (uint64_t)job->scene->vertex_count},
        {ABI_BUILD_INDICES, job->scene->index, 3 * (uint64_t)job->scene->tri_count},
        {ABI_REFIT_NODES, packed->word, packed->word_count},
        {ABI_REFIT_ITEMS, packed->item, packed->item ? packed->item_count : 0},
        {ABI_REFIT_LEAVES, job->first, job->first_count},
        {ABI_REFIT_LINKS, job->link, 2 * (uint64_t)job->node_count},
        {ABI_BUILD_BOXES, NULL, 6 * (uint64_t)job->node_count},
        {ABI_BUILD_STATE, state, ABI_STATE_WORDS},
    };
    enum status status = STATUS_OK;
    for (size_t i = 0; i < ARRAY_COUNT(buffers) && !status; i++)
        status = upload(tree, buffers[i].binding, buffers[i].from, buffers[i].words, reason);
    return status;
}

static enum status run(struct device_tree *tree, const struct refit_job *job, uint32_t *word,
                       uint64_t *ns, struct reason *reason)
{
    const struct packed *packed = job->packed;
    const enum kernel kernel = job->how.kernel;
    struct refit_push push = job->how.push;
    struct vk_time time = {0};
    uint32_t beyond = 0;
    push.count = job->first_count;
    enum status status = device_tree_kernel(tree, kernel, reason);
    if (!status)
        status = upload_all(tree, job, reason);
    if (!status)
        status = vk_dispatch(tree->vk, tree->kernel[kernel], tree->buffer, &push,
                             groups_of(push.count, ABI_BUILD_GROUP), &time, reason);
    if (!status)
        status = vk_buffer_read(tree->vk, tree->buffer[ABI_BUILD_STATE],
                                ABI_REFIT_BEYOND * sizeof beyond, &beyond, sizeof beyond, reason);
    if (!status && beyond > 0)
        status = fail(reason, STATUS_LIMIT, "rebuild: %u bounds are beyond the numbers of %s",
                      beyond, packed->layout->name);
    if (!status)
        status = vk_buffer_read(tree->vk, tree->buffer[ABI_REFIT_NODES], 0, word,
                                sizeof *word * (uint64_t)packed->word_count, reason);
    *ns = time.ns;
    return status ? status : device_tree_messages(tree, reason);
}

enum status device_refit(struct device_tree *tree, const struct packed *packed,
                         const struct scene *scene, uint32_t *word, uint64_t *ns,
                         struct reason *reason)
{
    struct refit_job job = {.packed = packed, .scene = scene};
    *ns = 0;
    tree->built = false; /* its buffers are used */
    enum status status = may_refit(packed, &job.how, reason);
    if (status || packed->node_count == 0)
        return status;
    status = list(&job, reason);
    if (!status)
        status = run(tree, &job, word, ns, reason);
    free(job.link);
    free(job.first);
    return status;
}
