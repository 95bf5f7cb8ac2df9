#include "gpu/build/device_refit.h"

#include "gpu/build/device_tree_inner.h"
#include "ref/packed/packed_walk.h"
#include "ref/store.h"

#include <stdlib.h>
#include <string.h>

static const struct {
    const char *name;
    uint32_t id;
} layouts_here[] = {{"f32", ABI_REFIT_F32}, {"rf16", ABI_REFIT_RF16}};

/* What is uploaded beside the nodes. */
struct refit_job {
    const struct packed *packed;
    const struct scene *scene;
    uint32_t *link; /* two words a reference */
    uint32_t *leaf;
    uint32_t leaf_count;
};

bool device_refits(const struct layout *layout)
{
    for (size_t i = 0; i < ARRAY_COUNT(layouts_here); i++)
        if (layout == layout_find(layouts_here[i].name))
            return true;
    return false;
}

static uint32_t id_of(const struct layout *layout)
{
    size_t i = 0;
    while (layout != layout_find(layouts_here[i].name))
        i++;
    return layouts_here[i].id;
}

static enum status may_refit(const struct packed *packed, struct reason *reason)
{
    if (!device_refits(packed->layout))
        return fail(reason, STATUS_UNSUPPORTED, "layout %s is not refitted on a device",
                    packed->layout->name);
    if (!packed->layout->item && !tri_store_reads_scene(packed->store))
        return fail(reason, STATUS_UNSUPPORTED, "storage %s is not refitted on a device",
                    packed->store->name);
    if (packed->split)
        return fail(reason, STATUS_LIMIT, "rebuild: the tree is split");
    return STATUS_OK;
}

/* Lists the leaves, and the links from the parents of references. */
static enum status list_leaves(struct refit_job *job, struct reason *reason)
{
    const struct packed *packed = job->packed;
    uint32_t *parent = NULL;
    enum status status = packed_links(packed, &parent, reason);
    if (status)
        return status;
    job->link = malloc(2 * sizeof *job->link * (size_t)packed->ref_count);
    job->leaf = malloc(sizeof *job->leaf * (size_t)packed->ref_count);
    if (!job->link || !job->leaf) {
        free(parent);
        return fail(reason, STATUS_MEMORY, "no memory to refit %u records", packed->node_count);
    }
    for (uint32_t ref = 0; ref < packed->ref_count; ref++) {
        struct wide node;
        const bool has_parent = parent[ref] != ABI_NO_PRIM;
        job->link[2 * ref] = has_parent ? parent[ref] : ABI_LINK_NONE;
        job->link[2 * ref + 1] = 0;
        if (!has_parent && ref != packed->root)
            continue;
        packed->layout->load(packed, ref, &node);
        if (node.child_count == 0)
            job->leaf[job->leaf_count++] = ref;
    }
    free(parent);
    return STATUS_OK;
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
        {ABI_REFIT_LEAVES, job->leaf, job->leaf_count},
        {ABI_REFIT_LINKS, job->link, 2 * (uint64_t)packed->ref_count},
        {ABI_BUILD_BOXES, NULL, 6 * (uint64_t)packed->ref_count},
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
    const struct build_push push = {.count = job->leaf_count, .axis_bits = id_of(packed->layout)};
    struct vk_time time = {0};
    uint32_t beyond = 0;
    enum status status = upload_all(tree, job, reason);
    if (!status)
        status = vk_dispatch(tree->vk, tree->kernel[REFIT], tree->buffer, &push,
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
    enum status status = may_refit(packed, reason);
    if (status || packed->node_count == 0)
        return status;
    status = list_leaves(&job, reason);
    if (!status)
        status = run(tree, &job, word, ns, reason);
    free(job.link);
    free(job.leaf);
    return status;
}
