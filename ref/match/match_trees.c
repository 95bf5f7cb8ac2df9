/* Trees of a match: built, packed, and refitted to where the scene has moved. */
#include "ref/match/match_trees.h"

#include "ref/match/match_engine.h"
#include "ref/packed/refit.h"
#include "ref/tree/tree_quality.h"
#include "ref/store.h"

#include <stdlib.h>
#include <string.h>

void match_forget_against(struct match *match)
{
    free(match->against.hit);
    free(match->against.tag);
    match->against.engine = NULL;
    match->against.hit = NULL;
    match->against.tag = NULL;
}

void match_unpack(struct match *match)
{
    for (uint32_t i = 0; match->tree && i <= match->options.life->count; i++)
        life_tree_free(&match->tree[i]);
    free(match->tree);
    match->tree = NULL;
    for (uint32_t i = 0; match->lived && i <= match->options.life->count; i++)
        world_life_free(&match->lived[i]);
    free(match->lived);
    match->lived = NULL;
    packed_free(&match->packed);
    packed_world_free(&match->packed_world);
    match_forget_against(match);
    match->closest.count = 0;
}

/* The scene that trees are built of. */
static const struct scene *scene_of_trees(const struct match *match)
{
    const struct match_options *o = &match->options;
    return o->rest ? o->rest : o->life ? o->life->scene : match->scene;
}

/* Measures the effect of the motion on the tree, which itself stays as it was built. */
static enum status measure_motion(struct match *match)
{
    struct bvh moved = match->bvh;
    match->refit.sah_before = tree_sah(&match->bvh);
    moved.node = alloc_zeroed(moved.node_count, sizeof *moved.node);
    if (!moved.node)
        return STATUS_MEMORY;
    if (moved.node_count > 0)
        memcpy(moved.node, match->bvh.node, moved.node_count * sizeof *moved.node);
    enum status status = bvh_refit(&moved, match->scene, NULL);
    if (!status)
        match->refit.sah_after = tree_sah(&moved);
    free(moved.node);
    return status == STATUS_LIMIT ? STATUS_OK : status;
}

/* Refits the tree that was packed, from `start` on, of the scene at rest. */
static enum status refit_packed(struct match *match, uint64_t start, struct reason *reason)
{
    if (!match->options.rest)
        return STATUS_OK;
    uint64_t packed = time_ns();
    enum status status = packed_refit(&match->packed, match->scene, reason);
    match->refit.pack_ns = packed - start;
    match->refit.refit_ns = time_ns() - packed;
    if (status)
        match_unpack(match);
    return status;
}

enum status match_rebuild(struct match *match, const struct builder *builder,
                          const struct build_options *build, const struct tri_test *tri,
                          struct reason *reason)
{
    match_unpack(match);
    bvh_free(&match->bvh);
    match->options.builder = builder;
    match->options.build = *build;
    match->options.tri = tri;
    if (match->world)
        return match_rebuild_world(match, reason);
    const struct tree_file *tree = match->options.tree;
    enum status status = STATUS_OK;
    if (tree)
        match->stats = tree->stats;
    if (tree && tree_file_is_packed(tree))
        return status; /* match->bvh stays empty: only match_pack uses the tree */
    const struct scene *scene = scene_of_trees(match);
    uint64_t start = time_ns();
    status = tree ? tree_file_bvh(tree, scene, &match->bvh, reason)
                  : bvh_build(builder, scene, build, &match->bvh, reason);
    match->refit = (struct match_refit){.build_ns = tree ? 0 : time_ns() - start};
    if (status == STATUS_OK && !tree)
        status = bvh_count(&match->bvh, scene, &match->stats, reason);
    if (status == STATUS_OK && match->options.rest && measure_motion(match))
        status = fail(reason, STATUS_MEMORY, "no memory to refit a tree");
    return status;
}

/* Packs the first tree of a life and takes it through the steps. */
static enum status pack_life(struct match *match, const struct layout *layout,
                             const struct tri_store *store, struct reason *reason)
{
    const struct match_life *life = match->options.life;
    const struct life_recipe recipe = {match->options.builder, &match->options.build, store,
                                       layout};
    match->tree = alloc_zeroed(life->count + 1, sizeof *match->tree);
    if (!match->tree)
        return fail(reason, STATUS_MEMORY, "no memory for the trees of %u steps", life->count);
    enum status status = life_begin(&recipe, &life->scene[0], &match->tree[0], reason);
    for (uint32_t i = 0; i < life->count && !status; i++)
        status = life_step(&recipe, life->act[i], &life->scene[i + 1], &match->tree[i],
                           &match->tree[i + 1], reason);
    if (!status)
        status = bvh_count(&match->tree[life->count].bvh, match->scene, &match->stats, reason);
    if (status) {
        match_unpack(match);
        return status;
    }
    match->packed = match->tree[life->count].packed;
    match->tree[life->count].packed = (struct packed){0};
    return STATUS_OK;
}

enum status match_pack(struct match *match, const struct layout *layout, struct reason *reason)
{
    const struct tri_store *store = match->options.store ? match->options.store : tri_stores[0];
    match_unpack(match);
    if (match->world)
        return match_pack_world(match, layout, reason);
    if (match->options.tree && store != tri_stores[0])
        return fail(reason, STATUS_LIMIT,
                    "%s: a tree from a file has its own items, not storage %s", layout->name,
                    store->name);
    if (match->options.life)
        return pack_life(match, layout, store, reason);
    const struct scene *scene = scene_of_trees(match);
    uint64_t start = time_ns();
    enum status status =
        match->options.tree
            ? tree_file_pack(match->options.tree, layout, scene, &match->packed, reason)
            : packed_make_stored(layout, store, &match->bvh, scene, &match->packed, reason);
    return status ? status : refit_packed(match, start, reason);
}

enum status match_pack_auto(struct match *match, char *refused, size_t refused_bytes,
                            struct reason *reason)
{
    const struct tree_file *tree = match->options.tree;
    if (match->options.store && match->options.store != tri_stores[0])
        return fail(reason, STATUS_INPUT,
                    "--layout auto packs storage indexed: name a layout for storage %s",
                    match->options.store->name);
    if (tree && tree_file_is_packed(tree))
        return match_pack(match, tree->packed.layout, reason);
    if (match->world)
        return match_pack_world_auto(match, refused, refused_bytes, reason);
    match_unpack(match);
    uint64_t start = time_ns();
    enum status status = packed_make_auto(&match->bvh, scene_of_trees(match), &match->packed,
                                          refused, refused_bytes, reason);
    return status ? status : refit_packed(match, start, reason);
}
