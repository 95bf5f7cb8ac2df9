/* raydiff leaks on one scene: runs every named engine on every tree and test. */
#include "cmd/leaks/cmd_leaks.h"
#include "cmd/common/cmd_tree.h"
#include "cmd/leaks/cmd_leaks_world.h"
#include "ref/base/command.h"
#include "ref/base/text.h"
#include "ref/twin/twin.h"
#include "scenes/worlds.h"
#include "ref/store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The run on one scene. */
struct play {
    const struct leaks_options *options;
    struct pool *pool;
    struct progress *progress;
    size_t rows; /* at most */
    struct leak_scene *result;
    struct world world; /* which scene borrows its own from, if it is a plain one */
    struct scene scene;
    struct topology topology;
    struct oracle *oracle;
    struct ray *ray;
    uint8_t *aim;
    struct leak_rays rays;
    uint64_t *digest, *cpu_digest;
    bool cpu_known;        /* cpu_digest is for the row's tree and tests */
    struct tree_file tree; /* from --bvh */
    struct packed packed;
};

enum status leaks_add_row(struct leak_scene *result, const struct leak_row *row,
                          struct reason *reason)
{
    size_t capacity = result->row_count; /* grows one by one, since rows are few */
    void *rows = result->row;
    if (array_reserve(&rows, &capacity, result->row_count + 1, sizeof *row))
        return fail(reason, STATUS_MEMORY, "no memory for rows");
    result->row = rows;
    result->row[result->row_count++] = *row;
    return STATUS_OK;
}

/* Computes the answers of engine cpu that a row is compared with. */
static enum status know_cpu(struct play *play, const struct job *job, struct reason *reason)
{
    if (play->cpu_known)
        return STATUS_OK;
    const struct engine *cpu = engine_reference(true);
    struct leaks unused;
    enum status status = STATUS_OK;
    void *self = pool_get(play->pool, cpu, &status, reason);
    if (self)
        status = leaks_count(&play->rays, cpu, self, job, &unused, play->cpu_digest, reason);
    play->cpu_known = !status;
    return status;
}

static void count_row(struct play *play, struct leak_row *row)
{
    const struct engine *engine = row->engine;
    struct job job = {.scene = &play->scene,
                      .packed = engine->needs_packed ? &play->packed : NULL,
                      .box = row->box,
                      .tri = row->tri};
    void *self = pool_get(play->pool, engine, &row->status, &row->reason);
    row->absent = row->status == STATUS_UNSUPPORTED;
    if (!self)
        return;
    bool is_cpu = engine == engine_reference(true);
    struct model model = engine_model(engine, self, row->tri);
    row->promises = model.watertight && job_keeps_watertight(&job) &&
                    !(engine->needs_packed &&
                      (row->layout->faithful || row->builder->faithful || row->box->faithful));
    row->status = leaks_count(&play->rays, engine, self, &job, &row->leaks,
                              is_cpu ? play->cpu_digest : play->digest, &row->reason);
    if (is_cpu)
        play->cpu_known = row->status == STATUS_OK;
    row->compared = !row->status && model.bits && engine->needs_packed && !is_cpu;
    if (row->compared)
        row->status = know_cpu(play, &job, &row->reason);
    for (size_t i = 0; row->compared && !row->status && i < play->rays.ray_count; i++)
        row->bit_differences += play->digest[i] != play->cpu_digest[i];
}

void leak_row_judge(struct leak_row *row, const struct leak_profile *profile)
{
    struct leak_tally sum = leaks_total(&row->leaks);
    row->broken[0] = '\0';
    bool misses = row->promises || profile->misses_must, doubles = profile->doubles_must;
    const struct {
        bool is;
        size_t count;
        const char *what;
    } breach[] = {
        {misses, sum.misses, "missed"},
        {misses && row->leaks.lists, sum.empty, "listed nothing"},
        {misses, sum.lost, "lost a wall"},
        {row->promises, sum.phantoms, "hit a wall that is not there"},
        {doubles, sum.doubles, "hit twice"},
        {row->promises, sum.repeated, "listed a triangle twice"},
        {row->compared, row->bit_differences, "differ from cpu"},
    };
    for (size_t i = 0; i < ARRAY_COUNT(breach); i++)
        if (breach[i].is && breach[i].count > 0)
            text_append(row->broken, sizeof row->broken, "%s%zu %s", row->broken[0] ? ", " : "",
                        breach[i].count, breach[i].what);
}

static enum status play_row(struct play *play, struct leak_row row, struct reason *reason)
{
    char text[STORED_NAME_MOST];
    progress_done(play->progress, play->result->row_count, play->rows, "this scene");
    progress_step(play->progress, "%s: %s %s %s", play->result->spec,
                  stored_name(row.layout, row.store, text), row.engine->name, row.tri->name);
    count_row(play, &row);
    if (row.status == STATUS_OK)
        leak_row_judge(&row, play->result->profile);
    return leaks_add_row(play->result, &row, reason);
}

/* The triangle test that an engine with one of its own reports, or NULL: none of the table, or it
 * cannot run here. */
static const struct tri_test *own_test_of(struct play *play, const struct leak_row *row)
{
    enum status status;
    void *self = pool_get(play->pool, row->engine, &status, NULL);
    const char *name =
        self ? row_formula_name(engine_model(row->engine, self, row->tri).formula) : NULL;
    return name ? tri_test_find(name) : NULL;
}

/* Runs the engines that need no tree. Those with a test of their own run only once. */
static enum status play_treeless(struct play *play, const struct leak_row *like, bool first,
                                 struct reason *reason)
{
    const struct leaks_options *o = play->options;
    enum status status = STATUS_OK;
    for (size_t e = 0; e < o->engine.count && !status; e++) {
        struct leak_row row = *like;
        row.layout = NULL;
        row.engine = engines[o->engine.index[e]];
        if (row.engine->needs_packed || (row.engine->own_tri && !first))
            continue;
        const struct tri_test *own = row.engine->own_tri ? own_test_of(play, &row) : NULL;
        row.own_test = row.engine->own_tri && !own;
        if (own)
            row.tri = own;
        status = play_row(play, row, reason);
    }
    return status;
}

/* The box test under whose name an engine with a tree of its own runs, which tests boxes in its own
 * way: a watertight one, if any is to be played. */
static size_t box_of_own_tree(const struct list *box)
{
    for (size_t b = 0; b < box->count; b++)
        if (box_tests[box->index[b]]->watertight)
            return b;
    return 0;
}

/* Runs the engines that need a tree. Those with a triangle test or a tree of their own run only
 * once, since the tests named make no difference to them. */
static enum status play_packed(struct play *play, struct leak_row row, bool first,
                               struct reason *reason)
{
    const struct leaks_options *o = play->options;
    const size_t own = box_of_own_tree(&o->box);
    enum status status = STATUS_OK;
    for (size_t b = 0; b < o->box.count && !status; b++) {
        row.box = box_tests[o->box.index[b]];
        play->cpu_known = false;
        for (size_t e = 0; e < o->engine.count && !status; e++) {
            row.engine = engines[o->engine.index[e]];
            const bool again =
                (row.engine->own_tri && !first) || (row.engine->own_tree && b != own);
            if (row.engine->needs_packed && !again)
                status = play_row(play, row, reason);
        }
    }
    return status;
}

/* `bvh` NULL: uses the tree of the file. */
static enum status play_layouts(struct play *play, const struct bvh *bvh, struct leak_row row,
                                bool first, struct reason *reason)
{
    const struct leaks_options *o = play->options;
    struct list list = o->layout_named ? o->layout : tree_layouts(&play->tree, &o->layout);
    enum status status = STATUS_OK;
    for (size_t i = 0; i < list.count * o->store.count && !status; i++) {
        row.layout = layouts_all[list.index[i / o->store.count]];
        row.store = tri_stores[o->store.index[i % o->store.count]];
        row.status =
            bvh ? packed_make_stored(row.layout, row.store, bvh, &play->scene, &play->packed,
                                     &row.reason)
                : tree_file_pack(&play->tree, row.layout, &play->scene, &play->packed, &row.reason);
        if (row.status == STATUS_LIMIT)
            status = leaks_add_row(play->result, &row, reason);
        else if (row.status)
            status = fail(reason, row.status, "%s", row.reason.text);
        else
            status = play_packed(play, row, first, reason);
        packed_free(&play->packed);
    }
    return status;
}

/* Adds all rows of one tree. Engines without a tree run only with the first tree. */
static enum status play_tree(struct play *play, const struct bvh *bvh, struct leak_row row,
                             bool first, struct reason *reason)
{
    const struct leaks_options *o = play->options;
    enum status status = STATUS_OK;
    for (size_t t = 0; t < o->tri.count && !status; t++) {
        row.tri = tri_tests[o->tri.index[t]];
        status = play_layouts(play, bvh, row, t == 0, reason);
        if (!status && first)
            status = play_treeless(play, &row, t == 0, reason);
    }
    return status;
}

static enum status play_rows(struct play *play, struct reason *reason)
{
    const struct leaks_options *o = play->options;
    struct leak_row row = {.builder = &tree_file_builder, .box = box_tests[o->box.index[0]]};
    const struct list_rows rows = {&o->engine, &o->tri, &o->box, o->bvh ? 1 : o->builder.count,
                                   o->layout.count * o->store.count};
    play->rows = list_rows(&rows);
    if (o->bvh)
        return play_tree(play, NULL, row, true, reason);
    enum status status = STATUS_OK;
    for (size_t b = 0; b < o->builder.count && !status; b++) {
        struct bvh bvh = {0};
        row.builder = builders_all[o->builder.index[b]];
        status = bvh_build(row.builder, &play->scene, &o->build, &bvh, reason);
        if (!status)
            status = play_tree(play, &bvh, row, b == 0, reason);
        bvh_free(&bvh);
    }
    return status;
}

/* Opens the scene, requires a closed mesh, and aims the rays. */
static enum status prepare(struct play *play, struct reason *reason)
{
    const struct leaks_options *o = play->options;
    struct leak_scene *result = play->result;
    size_t count = result->ray_count;
    enum status status = STATUS_OK;
    if (o->bvh)
        status = tree_open("leaks", o->bvh, &play->scene, &play->tree, reason);
    if (!status)
        status = topology_make(&play->scene, &play->topology, reason);
    if (!status)
        status = topology_is_closed(&play->topology, &play->scene, reason);
    if (!status)
        status = oracle_make(&play->scene, &play->oracle, reason);
    if (status)
        return status;
    play->ray = alloc_zeroed(count, sizeof *play->ray);
    play->aim = alloc_zeroed(count, sizeof *play->aim);
    play->digest = alloc_zeroed(count, sizeof *play->digest);
    play->cpu_digest = alloc_zeroed(count, sizeof *play->cpu_digest);
    if (!play->ray || !play->aim || !play->digest || !play->cpu_digest)
        return fail(reason, STATUS_MEMORY, "no memory for %zu rays", count);
    play->rays = (struct leak_rays){&play->topology, play->oracle, play->ray, play->aim, count};
    result->tri_count = play->scene.tri_count;
    result->point_count = play->topology.point_count;
    result->edge_count = play->topology.edge_count;
    return rays_inside_make(&play->scene, &play->topology, play->oracle, o->seed, count, play->ray,
                            play->aim, &result->inside, reason);
}

static void look_whether_vacuous(struct leak_scene *result)
{
    const struct inside *inside = &result->inside;
    if (result->ray_count < LEAKS_LEAST)
        snprintf(result->vacuous, sizeof result->vacuous, "%s %s aimed, at least %d are needed",
                 COUNTED(result->ray_count, "ray"), result->ray_count == 1 ? "is" : "are",
                 LEAKS_LEAST);
    else if (2 * inside->near < inside->sampled)
        snprintf(result->vacuous, sizeof result->vacuous,
                 "of %zu aimed rays looked at only %zu come near an edge", inside->sampled,
                 inside->near);
}

/* No storage is named but the default. */
static bool only_indexed(const struct leaks_options *o)
{
    return o->store.count == 1 && tri_stores[o->store.index[0]] == tri_stores[0];
}

enum status leaks_play(const struct leaks_options *o, struct pool *pool, struct progress *progress,
                       const char *spec, struct leak_scene *result, struct reason *reason)
{
    struct play play = {.options = o, .pool = pool, .progress = progress, .result = result};
    struct reason why = {""};
    *result = (struct leak_scene){
        .spec = spec, .profile = o->profile, .ray_count = (size_t)o->count, .seed = o->seed};
    progress_step(progress, "%s: aiming", spec);
    enum status status = world_open(spec, o->seed, &play.world, &why);
    const bool is_world = !status && !world_is_plain(&play.world);
    if (is_world && (o->bvh || !only_indexed(o)))
        status = fail(&why, STATUS_INPUT, "%s: is of scenes, not of worlds",
                      o->bvh ? "--bvh" : "--store");
    else if (!status && !is_world && option_was_given("braid"))
        status = fail(&why, STATUS_INPUT, "--braid: is of worlds, not of scenes");
    else if (is_world)
        status = leaks_play_world(o, pool, progress, &play.world, result, &why);
    else if (!status)
        play.scene = *play.world.mesh[0].scene;
    if (!status && !is_world)
        status = prepare(&play, &why);
    if (!status && !is_world) {
        look_whether_vacuous(result);
        status = play_rows(&play, &why);
    }
    free(play.ray);
    free(play.aim);
    free(play.digest);
    free(play.cpu_digest);
    oracle_free(play.oracle);
    topology_free(&play.topology);
    tree_file_free(&play.tree);
    world_free(&play.world);
    if (status)
        return fail(reason, status, "%s%s%s", strstr(why.text, spec) ? "" : spec,
                    strstr(why.text, spec) ? "" : ": ", why.text);
    return STATUS_OK;
}
