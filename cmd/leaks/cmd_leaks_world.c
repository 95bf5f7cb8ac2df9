/* raydiff leaks on one world: runs every named engine that traces worlds on every tree and test, on
 * rays that start inside instances. Rays that hit nothing are counted; where instances are closed
 * only together, which no specification promises, nothing is judged but bits. */
#include "cmd/leaks/cmd_leaks_world.h"

#include "ref/base/command.h"
#include "ref/store.h"
#include "ref/two_level/packed_world.h"
#include "ref/world/world.h"
#include "scenes/rays/rays_inside_world.h"

#include <stdlib.h>
#include <string.h>

#define BATCH 65536u

/* The run on one world. */
struct leak_world_play {
    const struct leaks_options *options;
    struct pool *pool;
    struct progress *progress;
    struct leak_scene *result;
    struct world *world;
    struct ray *ray;
    struct ray_mode *mode;
    uint8_t *aim;
    struct hit *hit, *cpu; /* all answers */
    uint32_t *tag, *cpu_tag;
    bool cpu_known; /* cpu, cpu_tag are of the row's trees and tests */
    struct world_trees trees;
    struct packed_world packed;
};

/* Traces all rays. Errors: as prepare_world and trace_world. */
static enum status trace(struct leak_world_play *play, const struct engine *engine, void *self,
                         const struct leak_row *row, struct hit *hit, uint32_t *tag, uint64_t *ns,
                         struct reason *reason)
{
    const struct world_job job = {.world = play->world,
                                  .packed = engine->needs_packed ? &play->packed : NULL,
                                  .box = row->box,
                                  .tri = row->tri,
                                  .query = QUERY_CLOSEST};
    const size_t count = play->result->ray_count;
    enum status status = engine->worlds->prepare_world(self, &job, reason);
    for (size_t at = 0; at < count && !status; at += BATCH) {
        const size_t part = count - at < BATCH ? count - at : BATCH;
        struct trace_report report = {0};
        status = engine->worlds->trace_world(self, play->ray + at, play->mode + at, part, hit + at,
                                             tag + at, &report, reason);
        *ns += report.ns;
    }
    return status;
}

/* Adds the answers that are none to the row, the first of them as findings. */
static void count_misses(const struct leak_world_play *play, struct leaks *out)
{
    for (size_t i = 0; i < play->result->ray_count; i++) {
        struct leak_tally *tally = &out->tally[play->aim[i]];
        tally->rays++;
        if (play->hit[i].prim != ABI_NO_PRIM)
            continue;
        tally->misses++;
        if (out->finding_count < LEAK_FINDINGS)
            out->finding[out->finding_count++] =
                (struct leak_finding){.aim = (enum leak_aim)play->aim[i],
                                      .ray_index = i,
                                      .ray = play->ray[i],
                                      .prim = {ABI_NO_PRIM, ABI_NO_PRIM}};
    }
}

/* Counts answers whose bits are not those of engine cpu on the same trees. */
static enum status compare(struct leak_world_play *play, struct leak_row *row)
{
    const struct engine *cpu = engine_reference(true);
    uint64_t unused = 0;
    enum status status = STATUS_OK;
    void *self = play->cpu_known ? NULL : pool_get(play->pool, cpu, &status, &row->reason);
    if (self)
        status = trace(play, cpu, self, row, play->cpu, play->cpu_tag, &unused, &row->reason);
    play->cpu_known = !status;
    for (size_t i = 0; i < play->result->ray_count && !status; i++)
        row->bit_differences += memcmp(&play->hit[i], &play->cpu[i], sizeof *play->hit) != 0 ||
                                play->tag[i] != play->cpu_tag[i];
    return status;
}

static bool keeps_watertight(const struct leak_world_play *play, const struct leak_row *row)
{
    if (!row->engine->needs_packed)
        return true;
    return row->box->watertight && !play->packed.split && !row->layout->faithful &&
           !row->builder->faithful && !row->box->faithful;
}

static void count_row(struct leak_world_play *play, struct leak_row *row)
{
    const struct engine *engine = row->engine;
    if (!engine->worlds) {
        row->absent = true;
        row->status =
            fail(&row->reason, STATUS_UNSUPPORTED, "%s traces scenes, not worlds", engine->name);
        return;
    }
    void *self = pool_get(play->pool, engine, &row->status, &row->reason);
    row->absent = row->status == STATUS_UNSUPPORTED;
    if (!self)
        return;
    row->absent = !engine_traces_worlds(engine, self);
    row->status =
        trace(play, engine, self, row, play->hit, play->tag, &row->leaks.ns, &row->reason);
    if (row->status)
        return;
    const struct model model = engine_model(engine, self, row->tri);
    const bool own = twin_is_own(model.formula);
    row->promises = !play->result->seams && own && model.watertight && keeps_watertight(play, row);
    count_misses(play, &row->leaks);
    row->compared = model.bits && engine->needs_packed && !engine->reference;
    if (row->compared)
        row->status = compare(play, row);
    if (!row->status)
        leak_row_judge(row, play->result->seams ? leak_profiles[0] : play->result->profile);
}

static enum status play_row(struct leak_world_play *play, struct leak_row row,
                            struct reason *reason)
{
    progress_step(play->progress, "%s: %s %s %s", play->result->spec,
                  row.layout ? row.layout->name : "-", row.engine->name, row.tri->name);
    count_row(play, &row);
    return leaks_add_row(play->result, &row, reason);
}

/* Runs the engines with trees, or those without. An engine with a triangle test of its own runs
 * only with the first. */
static enum status play_engines(struct leak_world_play *play, struct leak_row row, bool tree,
                                bool first, struct reason *reason)
{
    const struct leaks_options *o = play->options;
    enum status status = STATUS_OK;
    for (size_t e = 0; e < o->engine.count && !status; e++) {
        row.engine = engines[o->engine.index[e]];
        row.own_test = row.engine->own_tri;
        if (row.engine->needs_packed == tree && (first || !row.engine->own_tri) &&
            (row.engine->worlds || o->engine_named))
            status = play_row(play, row, reason);
    }
    return status;
}

/* Every layout and box test on the trees of one builder. */
static enum status play_layouts(struct leak_world_play *play, struct leak_row row, bool first,
                                struct reason *reason)
{
    const struct leaks_options *o = play->options;
    enum status status = STATUS_OK;
    for (size_t i = 0; i < o->layout.count && !status; i++) {
        row.layout = layouts_all[o->layout.index[i]];
        row.engine = NULL;
        row.status = packed_world_make(play->world, &play->trees, row.layout, row.layout, row.store,
                                       &play->packed, &row.reason);
        if (row.status == STATUS_LIMIT)
            status = leaks_add_row(play->result, &row, reason);
        else if (row.status)
            status = fail(reason, row.status, "%s", row.reason.text);
        for (size_t b = 0; b < o->box.count && !row.status && !status; b++) {
            row.box = box_tests[o->box.index[b]];
            play->cpu_known = false;
            status = play_engines(play, row, true, first && b == 0, reason);
        }
        packed_world_free(&play->packed);
    }
    return status;
}

static enum status play_rows(struct leak_world_play *play, struct reason *reason)
{
    const struct leaks_options *o = play->options;
    struct leak_row row = {.box = box_tests[o->box.index[0]], .store = tri_stores[0]};
    enum status status = STATUS_OK;
    for (size_t b = 0; b < o->builder.count && !status; b++) {
        row.builder = builders_all[o->builder.index[b]];
        const struct world_build build = {.top = row.builder,
                                          .bottom = row.builder,
                                          .top_options = o->build,
                                          .bottom_options = o->build,
                                          .braid = o->braid};
        status = world_trees_make(play->world, &build, &play->trees, reason);
        for (size_t t = 0; t < o->tri.count && !status; t++) {
            row.tri = tri_tests[o->tri.index[t]];
            status = play_layouts(play, row, t == 0, reason);
            row.layout = NULL;
            row.box = box_tests[o->box.index[0]];
            if (!status && b == 0)
                status = play_engines(play, row, false, t == 0, reason);
        }
        world_trees_free(&play->trees);
    }
    return status;
}

static enum status prepare(struct leak_world_play *play, struct reason *reason)
{
    struct leak_scene *result = play->result;
    const size_t count = result->ray_count;
    struct world_inside inside;
    play->ray = alloc_zeroed(count, sizeof *play->ray);
    play->mode = alloc_zeroed(count, sizeof *play->mode);
    play->aim = alloc_zeroed(count, 1);
    play->hit = alloc_zeroed(count, sizeof *play->hit);
    play->cpu = alloc_zeroed(count, sizeof *play->cpu);
    play->tag = alloc_zeroed(count, sizeof *play->tag);
    play->cpu_tag = alloc_zeroed(count, sizeof *play->cpu_tag);
    if (!play->ray || !play->mode || !play->aim || !play->hit || !play->cpu || !play->tag ||
        !play->cpu_tag)
        return fail(reason, STATUS_MEMORY, "no memory for %zu rays", count);
    enum status status = world_rays_inside_make(play->world, result->seed, count, play->ray,
                                                play->mode, play->aim, &inside, reason);
    if (status)
        return status;
    if (!inside.seams)
        world_inside_masks(play->world);
    result->is_world = true;
    result->seams = inside.seams;
    result->instances = inside.seams ? play->world->instance_count : inside.instances;
    result->inside.origins = inside.origins;
    result->tri_count = world_tri_count(play->world);
    if (count < LEAKS_LEAST)
        snprintf(result->vacuous, sizeof result->vacuous,
                 "%zu rays are aimed, at least %d are needed", count, LEAKS_LEAST);
    return STATUS_OK;
}

enum status leaks_play_world(const struct leaks_options *options, struct pool *pool,
                             struct progress *progress, struct world *world,
                             struct leak_scene *result, struct reason *reason)
{
    struct leak_world_play play = {
        .options = options, .pool = pool, .progress = progress, .world = world, .result = result};
    enum status status = prepare(&play, reason);
    if (!status)
        status = play_rows(&play, reason);
    free(play.ray);
    free(play.mode);
    free(play.aim);
    free(play.hit);
    free(play.cpu);
    free(play.tag);
    free(play.cpu_tag);
    return status;
}
