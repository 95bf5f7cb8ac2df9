#include "gpu/trace/world_upload.h"

#include "gpu/trace/gather.h"
#include "ref/store.h"
#include "ref/two_level/packed_world.h"
#include "ref/world/world.h"

#include <stdlib.h>
#include <string.h>

#define QUAD_WORDS 4u
#define RECORD_OUT (sizeof(struct instance_record) / ABI_WORLD_QUAD_BYTES)
_Static_assert(RECORD_OUT == ABI_WORLD_INSTANCE, "a record is as many quads as the shader reads");

enum status world_upload_check(const struct world_job *job, struct reason *reason)
{
    const struct packed_world *packed = job->packed;
    const struct layout *layout = packed->top.layout;
    enum status status = STATUS_OK;
    for (uint32_t i = 0; i < packed->tree_count && !status; i++) {
        const struct packed *bottom = &packed->bottom[i];
        if (bottom->layout != layout || bottom->store != packed->bottom[0].store)
            return fail(reason, STATUS_UNSUPPORTED,
                        "vulkan: all trees of a world have one layout and storage here, the top "
                        "is in %s and mesh %u in %s",
                        layout->name, i, bottom->layout->name);
        status = tri_store_check(bottom->store, job->tri->id, job->tri->name, reason);
    }
    return status;
}

/* Words, triangles and geometries before a tree. */
struct world_places {
    uint64_t nodes, items, tris, geometries;
};

static uint32_t tree_count(const struct world_job *job)
{
    return 1 + (job->packed ? job->packed->tree_count : job->world->mesh_count);
}

/* The mesh of a tree that is not the top. */
static uint32_t mesh_of(const struct world_job *job, uint32_t tree)
{
    return job->packed ? job->packed->mesh[tree - 1] : tree - 1;
}

/* Tree 0 is the top, then come the meshes', then those of parts. Without trees, all are empty. */
static const struct packed *tree_of(const struct world_job *job, uint32_t tree)
{
    static const struct packed none;
    if (!job->packed)
        return &none;
    return tree == 0 ? &job->packed->top : &job->packed->bottom[tree - 1];
}

/* Goes on to the places of the tree behind `tree`. Nodes begin with a whole quad. */
static void go_on(const struct world_job *job, uint32_t tree, struct world_places *places)
{
    const struct packed *packed = tree_of(job, tree);
    places->nodes += (packed->word_count + QUAD_WORDS - 1ull) / QUAD_WORDS * QUAD_WORDS;
    places->items += packed->item_count;
    if (tree == 0 || tree > job->world->mesh_count)
        return;
    places->tris += job->world->mesh[tree - 1].scene->tri_count;
    places->geometries += job->world->mesh[tree - 1].geometry_count;
}

/* `places` are those of all trees. A part has the triangles and the geometries of its mesh. */
static void put_tree(const struct world_job *job, uint32_t tree, const struct world_places *places,
                     uint32_t *out)
{
    const struct packed *packed = tree_of(job, tree);
    const struct world_places *of_mesh = tree > 0 ? &places[1 + mesh_of(job, tree)] : places;
    uint32_t tris = job->packed ? job->packed->entry_count : job->world->instance_count;
    uint32_t geometries = 0;
    if (tree > 0) {
        tris = job->world->mesh[mesh_of(job, tree)].scene->tri_count;
        geometries = job->world->mesh[mesh_of(job, tree)].geometry_count;
    }
    const uint32_t words[] = {(uint32_t)places[tree].nodes,
                              (uint32_t)places[tree].items,
                              (uint32_t)of_mesh->tris,
                              packed->root,
                              packed->node_count > 0 ? packed->ref_count : 0,
                              packed->item_count,
                              tris,
                              (uint32_t)of_mesh->geometries,
                              geometries};
    memcpy(out, words, sizeof words);
}

/* Makes a buffer, or keeps one that is as large. */
static enum status have_buffer(struct vk *vk, uint64_t bytes, struct vk_buffer **buffer,
                               struct reason *reason)
{
    if (*buffer && vk_buffer_bytes(*buffer) >= bytes)
        return STATUS_OK;
    vk_buffer_free(vk, *buffer);
    *buffer = NULL;
    return vk_buffer_make(vk, bytes, buffer, reason);
}

/* The members of the filter. */
static void put_filter(const struct world *world, struct world_push *push)
{
    push->filter_kind = (uint32_t)world->filter.kind;
    push->filter_seed = world->filter.seed;
    push->filter_share = world->filter.share;
}

/* A quad for each geometry of every mesh. */
static void put_geometries(const struct world *world, uint32_t *at)
{
    for (uint32_t i = 0; i < world->mesh_count; i++)
        for (uint32_t g = 0; g < world->mesh[i].geometry_count; g++, at += QUAD_WORDS) {
            const struct geometry *geometry = &world->mesh[i].geometry[g];
            at[0] = geometry->first;
            at[1] = geometry->count;
            at[2] = geometry->opaque;
        }
}

/* The records of all entries and the instances of parts; records are made here if no packed world
 * has them. */
static enum status put_records(const struct world_job *job, uint32_t entries, uint32_t *out,
                               struct reason *reason)
{
    const size_t bytes = entries * sizeof(struct instance_record);
    const uint32_t instances = job->world->instance_count;
    struct instance_record *made = NULL;
    enum status status = STATUS_OK;
    if (!job->packed)
        status = world_records_make(job->world, &made, reason);
    if (!status)
        memcpy(out, job->packed ? job->packed->record : made, bytes);
    if (!status && entries > instances)
        memcpy(out + (size_t)QUAD_WORDS * ABI_WORLD_INSTANCE * entries,
               job->packed->instance + instances, (entries - instances) * sizeof *out);
    free(made);
    return status;
}

static enum status upload_world(struct vk *vk, const struct world_job *job,
                                const struct world_places *places, struct vk_buffer **out,
                                struct world_push *push, struct reason *reason)
{
    const struct world *world = job->world;
    const struct packed_world *packed = job->packed;
    uint32_t trees = tree_count(job);
    uint32_t entries = packed ? packed->entry_count : world->instance_count;
    uint64_t records = ABI_WORLD_TREE * (uint64_t)trees;
    uint64_t owners = records + ABI_WORLD_INSTANCE * (uint64_t)entries;
    uint64_t geometries =
        owners + (entries - world->instance_count + QUAD_WORDS - 1ull) / QUAD_WORDS;
    uint64_t quads = geometries + places[trees].geometries;
    uint32_t *word = quads <= UINT32_MAX ? alloc_zeroed(quads, ABI_WORLD_QUAD_BYTES) : NULL;
    if (!word)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for %u instances",
                    world->instance_count);
    *push = (struct world_push){.instance_count = world->instance_count,
                                .records = (uint32_t)records,
                                .geometries = (uint32_t)geometries,
                                .entry_count = entries,
                                .share = packed ? packed->share : 0,
                                .reach = packed ? packed->reach : 0};
    put_filter(world, push);
    for (uint32_t i = 0; i < trees; i++)
        put_tree(job, i, places, word + (size_t)QUAD_WORDS * ABI_WORLD_TREE * i);
    enum status status = put_records(job, entries, word + QUAD_WORDS * records, reason);
    put_geometries(world, word + QUAD_WORDS * geometries);
    if (!status)
        status = have_buffer(vk, quads * ABI_WORLD_QUAD_BYTES, out, reason);
    if (!status)
        status = vk_buffer_write(vk, *out, 0, word, quads * ABI_WORLD_QUAD_BYTES, reason);
    free(word);
    return status;
}

/* Copies the nodes and the items of all trees. */
static enum status upload_trees(struct vk *vk, const struct world_job *job,
                                const struct world_places *places, uint32_t trees,
                                struct vk_buffer **nodes, struct vk_buffer **items,
                                struct reason *reason)
{
    enum status status = have_buffer(vk, 4 * places[trees].nodes, nodes, reason);
    if (!status)
        status = have_buffer(vk, 4 * places[trees].items, items, reason);
    for (uint32_t i = 0; i < trees && !status; i++) {
        const struct packed *packed = tree_of(job, i);
        if (packed->word_count)
            status = vk_buffer_write(vk, *nodes, 4 * places[i].nodes, packed->word,
                                     packed_node_bytes(packed), reason);
        if (!status && packed->item_count)
            status = vk_buffer_write(vk, *items, 4 * places[i].items, packed->item,
                                     packed_item_bytes(packed), reason);
    }
    return status;
}

/* Copies the vertices of all meshes, which facing is computed from whatever the storage. */
static enum status upload_triangles(struct vk *vk, const struct world_job *job,
                                    const struct world_places *places, struct vk_buffer **out,
                                    struct reason *reason)
{
    uint32_t meshes = job->world->mesh_count;
    enum status status = have_buffer(vk, gather_bytes(places[meshes + 1].tris), out, reason);
    for (uint32_t i = 0; i < meshes && !status; i++)
        status = gather_write(vk, job->world->mesh[i].scene, *out, places[i + 1].tris, reason);
    return status;
}

enum status world_upload(struct vk *vk, const struct world_job *job,
                         struct vk_buffer *buffer[WORLD_BINDINGS], struct world_push *push,
                         struct reason *reason)
{
    uint32_t trees = tree_count(job);
    struct world_places *places = alloc_zeroed((size_t)trees + 1, sizeof *places);
    if (!places)
        return fail(reason, STATUS_MEMORY, "vulkan: no memory for %u trees", trees);
    for (uint32_t i = 0; i < trees; i++) {
        places[i + 1] = places[i];
        go_on(job, i, &places[i + 1]);
    }
    enum status status = upload_trees(vk, job, places, trees, &buffer[ABI_BIND_NODES],
                                      &buffer[ABI_BIND_ITEMS], reason);
    if (!status)
        status = upload_triangles(vk, job, places, &buffer[ABI_BIND_TRIS], reason);
    if (!status)
        status = upload_world(vk, job, places, &buffer[ABI_BIND_WORLD], push, reason);
    free(places);
    return status;
}

/* --- for the driver's trees ------------------------------------------------------------------- */

/* The first geometry of each mesh, and behind them the number of all. NULL: no memory. */
static uint64_t *first_geometries(const struct world *world)
{
    uint64_t *first = alloc_zeroed((size_t)world->mesh_count + 1, sizeof *first);
    for (uint32_t i = 0; i < world->mesh_count && first; i++)
        first[i + 1] = first[i] + world->mesh[i].geometry_count;
    return first;
}

enum status world_upload_query(struct vk *vk, const struct world *world, struct vk_buffer **out,
                               struct world_push *push, struct reason *reason)
{
    uint64_t *first = first_geometries(world);
    uint64_t quads = world->instance_count + (first ? first[world->mesh_count] : 0);
    uint32_t *word =
        first && quads <= UINT32_MAX ? alloc_zeroed(quads, ABI_WORLD_QUAD_BYTES) : NULL;
    enum status status = STATUS_OK;
    *push = (struct world_push){.instance_count = world->instance_count,
                                .geometries = world->instance_count};
    put_filter(world, push);
    if (!word)
        status = fail(reason, STATUS_MEMORY, "vulkan: no memory for %u instances",
                      world->instance_count);
    for (uint32_t i = 0; i < world->instance_count && !status; i++) {
        const struct instance *instance = &world->instance[i];
        uint32_t *at = word + (size_t)QUAD_WORDS * i;
        if (instance->mesh == WORLD_NO_MESH)
            continue;
        at[0] = world->first[i];
        at[1] = (uint32_t)first[instance->mesh];
        at[2] = world->mesh[instance->mesh].geometry_count;
        at[3] = instance->flags;
    }
    if (!status) {
        put_geometries(world, word + (size_t)QUAD_WORDS * world->instance_count);
        status = vk_buffer_make_of(vk, word, quads * ABI_WORLD_QUAD_BYTES, out, reason);
    }
    free(first);
    free(word);
    return status;
}
