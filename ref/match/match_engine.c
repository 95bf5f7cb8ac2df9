#include "ref/match/match_engine.h"

#include "ref/base/text.h"
#include "ref/match/match_trees.h"
#include "ref/store.h"

#include <stdlib.h>
#include <string.h>

struct job match_job(const struct match *match, const struct engine *engine)
{
    return (struct job){.scene = match->scene,
                        .packed = engine->needs_packed ? &match->packed : NULL,
                        .box = match->options.box,
                        .tri = match->options.tri,
                        .query = match->options.query};
}

/* Rays traced after each step but the last. */
#define LIFE_RAYS 1000u

/* What the last step did to the engine's tree; of an engine without one what the step says. */
static enum life_fate fate_of(const struct match *match, const struct engine *engine, uint32_t step)
{
    if (engine->needs_packed)
        return match->world ? match->lived[step].fate : match->tree[step].fate;
    if (step == 0)
        return LIFE_BUILT;
    return match->options.life->act[step - 1] == LIFE_REFIT ? LIFE_REFITTED : LIFE_REBUILT;
}

struct model match_model(const struct match *match, const struct engine *engine, void *self,
                         struct row *row)
{
    struct model model = engine_model(engine, self, match->options.tri);
    row->unknown = model.formula == TWIN_UNKNOWN || /* as the judge of worlds has it */
                   (match->world && !twin_is_own(model.formula));
    row->formula = row_formula_name(model.formula);
    if (match->options.demands.displacement > 0.0f)
        model.displacement = (double)match->options.demands.displacement;
    row->displacement.allowed =
        model.displacement > 0.0 ? model.displacement : JUDGE_DISPLACEMENT_MOST;
    if (!match_keeps_watertight(match, engine))
        model.watertight = false; /* the triangle test is, but its boxes are not */
    row->bits = model.bits;
    return model;
}

void match_row_life(const struct match *match, const struct engine *engine, struct row *row)
{
    const struct match_life *life = match->options.life;
    if (!life || (engine->needs_packed && !match->tree && !match->lived))
        return;
    row->life.fate = fate_of(match, engine, life->count);
}

struct world_job match_world_job(const struct match *match, const struct engine *engine)
{
    return (struct world_job){.world = match->world,
                              .packed = engine->needs_packed ? &match->packed_world : NULL,
                              .box = match->options.box,
                              .tri = match->options.tri,
                              .query = match->options.query};
}

/* Takes an engine through the steps of a world. */
static enum status prepare_world_life(const struct match *match, const struct engine *engine,
                                      void *self, struct reason *reason)
{
    const struct match_life *life = match->options.life;
    const size_t rays = match->ray_count < LIFE_RAYS ? match->ray_count : LIFE_RAYS;
    struct hit *unused = alloc_zeroed(rays, sizeof *unused);
    uint32_t *tag = alloc_zeroed(rays, sizeof *tag);
    enum status status =
        unused && tag ? STATUS_OK : fail(reason, STATUS_MEMORY, "no memory for %zu rays", rays);
    for (uint32_t i = 0; i <= life->count && !status; i++) {
        struct trace_report report = {0};
        struct world_job job = match_world_job(match, engine);
        job.world = &life->world[i];
        if (job.packed && i < life->count)
            job.packed = &match->lived[i].packed;
        status = engine_follow_world(engine, self, &job, fate_of(match, engine, i) == LIFE_REFITTED,
                                     reason);
        if (!status && i < life->count && job.query != QUERY_ALL)
            status = match_trace(match, engine, self, rays, unused, tag, &report, reason);
    }
    free(unused);
    free(tag);
    return status;
}

/* Takes an engine through the steps. */
static enum status prepare_life(const struct match *match, const struct engine *engine, void *self,
                                struct reason *reason)
{
    const struct match_life *life = match->options.life;
    const size_t rays = match->ray_count < LIFE_RAYS ? match->ray_count : LIFE_RAYS;
    struct hit *unused = alloc_zeroed(rays, sizeof *unused);
    enum status status =
        unused ? STATUS_OK : fail(reason, STATUS_MEMORY, "no memory for %zu rays", rays);
    for (uint32_t i = 0; i <= life->count && !status; i++) {
        struct trace_report report = {0};
        struct job job = match_job(match, engine);
        const bool refitted = fate_of(match, engine, i) == LIFE_REFITTED;
        job.scene = &life->scene[i];
        if (job.packed && i < life->count)
            job.packed = &match->tree[i].packed;
        status = engine_follow(engine, self, &job, refitted, reason);
        if (!status && i < life->count && job.query != QUERY_ALL)
            status = engine->trace(self, match->ray, rays, unused, &report, reason);
    }
    free(unused);
    return status;
}

enum status match_prepare(const struct match *match, const struct engine *engine, void *self,
                          struct reason *reason)
{
    const bool lists = match->options.query == QUERY_ALL;
    if (!match->world) {
        const struct job job = match_job(match, engine);
        if (lists && !engine->trace_all)
            return fail(reason, STATUS_UNSUPPORTED, "%s cannot list all hits", engine->name);
        return match->options.life ? prepare_life(match, engine, self, reason)
                                   : engine->prepare(self, &job, reason);
    }
    if (!engine->worlds)
        return fail(reason, STATUS_UNSUPPORTED, "%s traces scenes, not worlds", engine->name);
    if (lists && !engine->worlds->trace_world_all)
        return fail(reason, STATUS_UNSUPPORTED, "%s cannot list all hits of a world", engine->name);
    if (match->options.life)
        return prepare_world_life(match, engine, self, reason);
    const struct world_job job = match_world_job(match, engine);
    return engine->worlds->prepare_world(self, &job, reason);
}

enum status match_trace(const struct match *match, const struct engine *engine, void *self,
                        size_t count, struct hit *hit, uint32_t *tag, struct trace_report *report,
                        struct reason *reason)
{
    if (!match->world)
        return engine->trace(self, match->ray, count, hit, report, reason);
    return engine->worlds->trace_world(self, match->ray, match->mode, count, hit, tag, report,
                                       reason);
}

bool match_keeps_watertight(const struct match *match, const struct engine *engine)
{
    if (match->world)
        return !engine->needs_packed ||
               (match->options.box->watertight && !match->packed_world.split);
    const struct job job = match_job(match, engine);
    return job_keeps_watertight(&job);
}

bool match_same_bits(const struct hit *a, const struct hit *b, const uint32_t *a_tag,
                     const uint32_t *b_tag, size_t i)
{
    return memcmp(&a[i], &b[i], sizeof *a) == 0 && (!a_tag || a_tag[i] == b_tag[i]);
}

const struct layout *match_layout(const struct match *match)
{
    const struct packed_world *packed = &match->packed_world;
    if (!match->world)
        return match->packed.layout;
    return packed->mesh_count > 0 ? packed->bottom[0].layout : packed->top.layout;
}

uint32_t match_tri_count(const struct match *match)
{
    return match->world ? world_tri_count(match->world) : match->scene->tri_count;
}

static uint64_t bytes_of_scene(const struct scene *scene)
{
    return 12 * ((uint64_t)scene->vertex_count + scene->tri_count);
}

static void world_bytes(const struct match *match, struct row *row)
{
    const struct packed_world *packed = &match->packed_world;
    row->node_bytes = packed_node_bytes(&packed->top);
    row->item_bytes =
        packed_item_bytes(&packed->top) + packed->entry_count * (uint64_t)sizeof *packed->record;
    for (uint32_t i = 0; i < packed->tree_count; i++) {
        row->node_bytes += packed_node_bytes(&packed->bottom[i]);
        row->item_bytes += packed_item_bytes(&packed->bottom[i]);
        if (i < packed->mesh_count && tri_store_reads_scene(packed->bottom[i].store))
            row->scene_bytes += bytes_of_scene(match->world->mesh[i].scene);
    }
}

void match_row_bytes(const struct match *match, struct row *row)
{
    if (!match_layout(match))
        return;
    if (match->world) {
        world_bytes(match, row);
        return;
    }
    row->node_bytes = packed_node_bytes(&match->packed);
    row->item_bytes = packed_item_bytes(&match->packed);
    if (tri_store_reads_scene(match->packed.store))
        row->scene_bytes = bytes_of_scene(match->scene);
}

static uint32_t more_of(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

/* Of all trees together: nodes and leaves added up, the deepest way down both levels. */
static enum status count_all(const struct world *world, const struct world_trees *trees,
                             struct bvh_stats *out, struct reason *reason)
{
    enum status status = bvh_count(&trees->top, &trees->items, out, reason);
    uint32_t bottom = 0;
    for (uint32_t i = 0; i < trees->mesh_count && !status; i++) {
        struct bvh_stats one;
        status = bvh_count(&trees->bottom[i], world->mesh[i].scene, &one, reason);
        out->node_count += one.node_count;
        out->leaf_count += one.leaf_count;
        out->largest_leaf = more_of(out->largest_leaf, one.largest_leaf);
        out->loose_count += one.loose_count;
        bottom = more_of(bottom, one.depth);
    }
    out->depth += bottom;
    return status;
}

static struct world_build build_of(const struct match *match)
{
    const struct builder *top = match->options.top_builder;
    return (struct world_build){.top = top ? top : match->options.builder,
                                .bottom = match->options.builder,
                                .top_options = match->options.build,
                                .bottom_options = match->options.build,
                                .braid = match->options.braid};
}

enum status match_rebuild_world(struct match *match, struct reason *reason)
{
    const struct world_build build = build_of(match);
    world_trees_free(&match->trees);
    match->stats = (struct bvh_stats){0};
    const enum status status = world_trees_make(match->world, &build, &match->trees, reason);
    return status ? status : count_all(match->world, &match->trees, &match->stats, reason);
}

/* Packs the first trees of a life and takes them through the steps. */
static enum status pack_life(struct match *match, const struct world_recipe *recipe,
                             struct reason *reason)
{
    const struct match_life *life = match->options.life;
    match->lived = alloc_zeroed(life->count + 1, sizeof *match->lived);
    if (!match->lived)
        return fail(reason, STATUS_MEMORY, "no memory for the trees of %u steps", life->count);
    enum status status = world_life_begin(recipe, &life->world[0], &match->lived[0], reason);
    for (uint32_t i = 0; i < life->count && !status; i++)
        status = world_life_step(recipe, life->act[i], &life->world[i + 1], &match->lived[i],
                                 &match->lived[i + 1], reason);
    if (!status)
        status = count_all(match->world, &match->lived[life->count].trees, &match->stats, reason);
    if (status) {
        match_unpack(match);
        return status;
    }
    match->packed_world = match->lived[life->count].packed;
    match->lived[life->count].packed = (struct packed_world){.mesh_count = 0};
    return STATUS_OK;
}

enum status match_pack_world(struct match *match, const struct layout *layout,
                             struct reason *reason)
{
    const struct tri_store *store = match->options.store ? match->options.store : tri_stores[0];
    const struct layout *top = match->options.top_layout;
    if (match->options.life) {
        const struct world_build build = build_of(match);
        const struct world_recipe recipe = {&build, top ? top : layout, layout, store};
        return pack_life(match, &recipe, reason);
    }
    return packed_world_make(match->world, &match->trees, top ? top : layout, layout, store,
                             &match->packed_world, reason);
}

enum status match_pack_world_auto(struct match *match, char *refused, size_t refused_bytes,
                                  struct reason *reason)
{
    struct reason why = {"no layout can be chosen"};
    if (refused_bytes > 0)
        refused[0] = 0;
    for (size_t i = 0; layouts_auto[i]; i++) {
        match_unpack(match);
        enum status status = match_pack_world(match, layouts_auto[i], &why);
        if (!status)
            return STATUS_OK;
        if (status != STATUS_LIMIT)
            return fail(reason, status, "%s", why.text);
        text_append(refused, refused_bytes, "%s%s", i ? "\n" : "", why.text);
    }
    return fail(reason, STATUS_LIMIT, "no layout can hold this world: %s", why.text);
}
