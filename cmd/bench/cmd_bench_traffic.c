/* The bytes that schedulers of the literature move for real rays. */
#include "cmd/bench/cmd_bench_traffic.h"

#include "ref/base/command.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"
#include "ref/store.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PATHS 65536
#define FRAME 1000000.0 /* paths of a megapixel frame */

static const char about[] =
    "replays how machines of the literature would trace paths through a layout, and counts the "
    "bytes that they read and write, by what they are for. Nothing is timed. Paths begin at the "
    "camera; rays that hit leave the surface for another one.\n"
    "  DRAM/ray  bytes that DRAM moves, per ray of any depth\n"
    "  ratio     of that to depth_first's\n"
    "  nodes to hits  the parts of DRAM/ray: nodes, triangles, stack or trail, rays and their "
    "queues, hit records\n"
    "  L1/ray    bytes of the accesses; L2/ray: lines that level 1 moves\n"
    "  row-hits  bursts of DRAM that find their row open\n"
    "  set       bytes of the scene that are read at least once\n"
    "An answer that is not engine cpu's is WRONG, but for another triangle at the same t, a tie. "
    "raycore traces engine kd's tree, and its answers are compared with that engine's. Leaves of "
    "RTRS's layouts as published name other triangles than lie in their boxes: there packets, dual "
    "and mach_rt, which visit nodes in another order, are not judged.";

static const struct column columns[] = {
    {"verdict", .left = true}, {"scheduler", .left = true},
    {"layout", .left = true},  {"store", .left = true, .rank = 7},
    {.title = "depth"},        {.title = "DRAM/ray"},
    {.title = "ratio"},        {"nodes", .rank = 1},
    {"tris", .rank = 1},       {"stack", .rank = 1},
    {"rays", .rank = 1},       {"hits", .rank = 1},
    {"L1/ray", .rank = 4},     {"L2/ray", .rank = 3},
    {"row-hits", .rank = 5},   {"set", .rank = 8},
    {"ties", .rank = 9},       {"alive", .rank = 10},
};

/* A scene and what is played on it. */
struct traffic_field {
    struct bench *bench;
    const char *spec;
    const struct scene *scene;
    const struct scheduler *scheduler[TRAFFIC_SCHEDULERS_MOST];
    size_t scheduler_count;
    uint32_t depth[TRAFFIC_DEPTHS_MOST];
    size_t depth_count;
    size_t count; /* paths */
    struct bvh bvh;
    struct kd_tree kd;
    struct traffic_paths paths;
    struct row_grid grid;
    double first[TRAFFIC_DEPTHS_MOST]; /* depth_first's bytes of DRAM, of the layout at hand; 0:
                                          not played */
    size_t layouts;                    /* that were played */
};

/* A layout and a storage of it. */
struct traffic_tree {
    struct packed packed;
    struct traffic_walker walker;
};

static uint64_t moved(const struct traffic_count *count)
{
    return count->read + count->written;
}

/* --- output ----------------------------------------------------------------------------------- */

static void add_level(json_t *row, const char *level, const struct traffic_count *count)
{
    static const char *const cause[TRAFFIC_CAUSES] = {"nodes", "triangles", "stack", "rays",
                                                      "hits"};
    for (int c = 0; c < TRAFFIC_CAUSES; c++) {
        char name[40];
        snprintf(name, sizeof name, "%s_%s", level, cause[c]);
        json_add(row, "%s=%zu", name, (size_t)(count->in[c] + count->out[c]));
    }
    json_add(row, "%s_read=%zu %s_written=%zu", level, (size_t)count->read, level,
             (size_t)count->written);
}

static void write_row(struct traffic_field *field, const struct traffic_tree *tree,
                      const struct scheduler *scheduler, size_t d, const struct traffic_result *r)
{
    const struct traffic_machine *m = &field->bench->traffic.machine;
    const struct traffic_memory_size *size = &m->memory;
    uint32_t depth = field->depth[d];
    double dram = (double)moved(&r->count[TRAFFIC_DRAM]);
    bool kd = scheduler->kd;
    json_t *row = json_record(
        "scene=%s triangles=%u scheduler=%s layout=%s store=%s depth=%u paths=%zu rays=%zu "
        "alive=%zu units=%u lanes=%u packet=%u treelet=%zu queue=%zu l1_bytes=%zu l1_ways=%u "
        "l1_line=%u l2_bytes=%zu l2_ways=%u l2_line=%u row_bytes=%u",
        field->spec, field->scene->tri_count, scheduler->name, kd ? "-" : tree->packed.layout->name,
        kd ? "-" : tree->packed.store->name, depth, field->count, (size_t)r->rays,
        depth <= field->paths.depth ? field->paths.wave[depth - 1].count : (size_t)0, size->units,
        m->lanes, m->packet, (size_t)m->treelet, (size_t)m->queue, (size_t)size->cache[0].bytes,
        size->cache[0].ways, size->cache[0].line, (size_t)size->cache[1].bytes, size->cache[1].ways,
        size->cache[1].line, size->row_bytes);
    add_level(row, "l1", &r->count[TRAFFIC_L1]);
    add_level(row, "l2", &r->count[TRAFFIC_L2]);
    add_level(row, "dram", &r->count[TRAFFIC_DRAM]);
    json_add(
        row,
        "l1_lookups=%zu l1_misses=%zu l2_lookups=%zu l2_misses=%zu row_hits=%zu "
        "row_misses=%zu working_set=%zu node_bytes=%zu item_bytes=%zu treelets=%u loads=%zu "
        "visits=%zu ties=%zu other=%zu wrong=%zu conserved=%i dram_per_ray=%g dram_per_frame=%g "
        "ratio=%g",
        (size_t)r->count[0].lookups, (size_t)r->count[0].misses, (size_t)r->count[1].lookups,
        (size_t)r->count[1].misses, (size_t)r->row_hits, (size_t)r->row_misses,
        (size_t)r->working_set,
        (size_t)(kd ? kd_node_bytes(&field->kd) : packed_node_bytes(&tree->packed)),
        (size_t)(kd ? kd_item_bytes(&field->kd) : packed_item_bytes(&tree->packed)),
        kd ? 0 : tree->walker.treelets.count, (size_t)r->loads, (size_t)r->visits, (size_t)r->ties,
        (size_t)r->other, (size_t)(r->wrong + r->reloads), r->conserved, dram / (double)r->rays,
        dram / (double)field->count * FRAME,
        field->first[d] > 0 ? dram / field->first[d] : (double)NAN);
    bench_row(field->bench, &bench_traffic, row);
}

static void report(struct traffic_field *field, const struct traffic_tree *tree,
                   const struct scheduler *scheduler, size_t d, const struct traffic_result *r)
{
    const struct traffic_count *dram = &r->count[TRAFFIC_DRAM];
    double rays = (double)r->rays, part[TRAFFIC_CAUSES];
    bool wrong = r->wrong > 0 || r->reloads > 0 || !r->conserved;
    char ratio[32] = "-";
    uint32_t depth = field->depth[d];
    for (int c = 0; c < TRAFFIC_CAUSES; c++)
        part[c] = (double)(dram->in[c] + dram->out[c]) / rays;
    if (field->first[d] > 0)
        snprintf(ratio, sizeof ratio, "%.2f", (double)moved(dram) / field->first[d]);
    if (wrong)
        bench_worse(field->bench, EXIT_MISMATCH);
    grid_add(&field->grid, wrong ? PAINT_BAD : PAINT_GOOD,
             "%s\t%s\t%s\t%s\t%u\t%.1f\t%s\t%.1f\t%.1f\t%.1f\t%.1f\t%.1f\t%.0f\t%.0f\t%.2f\t%.2f"
             "\t%zu\t%zu",
             wrong ? "WRONG" : "agrees", scheduler->name,
             scheduler->kd ? "-" : tree->packed.layout->name,
             scheduler->kd ? "-" : tree->packed.store->name, depth, (double)moved(dram) / rays,
             ratio, part[TRAFFIC_NODES], part[TRAFFIC_TRIANGLES], part[TRAFFIC_STACK],
             part[TRAFFIC_RAYS], part[TRAFFIC_HITS], (double)moved(&r->count[TRAFFIC_L1]) / rays,
             (double)moved(&r->count[TRAFFIC_L2]) / rays,
             (double)r->row_hits / (double)(r->row_hits + r->row_misses),
             (double)r->working_set / (1 << 20), (size_t)r->ties,
             depth <= field->paths.depth ? field->paths.wave[depth - 1].count : (size_t)0);
    write_row(field, tree, scheduler, d, r);
}

/* --- playing ---------------------------------------------------------------------------------- */

static enum status play_one(struct traffic_field *field, struct traffic_tree *tree,
                            const struct scheduler *scheduler, size_t d, struct reason *reason)
{
    uint32_t depth = field->depth[d];
    struct traffic_run run = {.machine = &field->bench->traffic.machine,
                              .paths = &field->paths,
                              .depth = depth < field->paths.depth ? depth : field->paths.depth,
                              .walker = &tree->walker,
                              .kd = &field->kd};
    struct traffic_result result;
    progress_step(&field->bench->progress, "%s: %s, depth %u", field->spec, scheduler->name, depth);
    enum status status = traffic_play(scheduler, &run, &result, reason);
    if (status)
        return status;
    if (scheduler == schedulers[0])
        field->first[d] = (double)moved(&result.count[TRAFFIC_DRAM]);
    report(field, tree, scheduler, d, &result);
    return STATUS_OK;
}

/* Plays all schedulers on a tree; those of the k-d tree once for all layouts. */
static enum status play_tree(struct traffic_field *field, struct traffic_tree *tree,
                             struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t s = 0; s < field->scheduler_count && !status; s++) {
        const struct scheduler *scheduler = field->scheduler[s];
        if (scheduler->kd && field->layouts > 0)
            continue;
        if (scheduler->kd && !field->kd.node)
            status = kd_make(field->scene, &field->kd, reason);
        if (scheduler->streams && !tree->walker.treelets.first && !status)
            status = treelets_runs(&tree->walker.treelets, &tree->walker.touch, reason);
        for (size_t d = 0; d < field->depth_count && !status; d++)
            status = play_one(field, tree, scheduler, d, reason);
    }
    field->layouts++;
    return status;
}

static struct job job_of(const struct traffic_field *field, const struct packed *packed)
{
    return (struct job){.scene = field->scene,
                        .packed = packed,
                        .box = box_tests[0],
                        .tri = tri_tests[0],
                        .query = QUERY_CLOSEST};
}

static enum status play_store(struct traffic_field *field, const struct layout *layout,
                              const struct tri_store *store, struct reason *reason)
{
    struct traffic_tree *tree = alloc_zeroed(1, sizeof *tree);
    if (!tree)
        return fail(reason, STATUS_MEMORY, "no memory for a tree");
    enum status status =
        packed_make_stored(layout, store, &field->bvh, field->scene, &tree->packed, reason);
    struct job job = job_of(field, &tree->packed);
    if (!status)
        status = tri_store_check(store, job.tri->id, job.tri->name, reason);
    if (!status)
        status =
            traffic_walker_make(&job, field->bench->traffic.machine.treelet, &tree->walker, reason);
    if (!status) {
        memset(field->first, 0, sizeof field->first);
        status = traffic_paths_trace(&field->paths, &job, reason);
        if (!status)
            status = play_tree(field, tree, reason);
        traffic_walker_free(&tree->walker);
    }
    packed_free(&tree->packed);
    free(tree);
    return status;
}

/* Makes the paths with float32 nodes, so that each layout gets the same rays. */
static enum status make_paths(struct traffic_field *field, struct reason *reason)
{
    struct packed packed;
    uint32_t most = 0;
    for (size_t d = 0; d < field->depth_count; d++)
        most = field->depth[d] > most ? field->depth[d] : most;
    enum status status = packed_make(layouts[0], &field->bvh, field->scene, &packed, reason);
    struct job job = job_of(field, &packed);
    if (!status)
        status =
            traffic_paths_make(&job, field->bench->seed, field->count, most, &field->paths, reason);
    packed_free(&packed);
    return status;
}

/* Plays the named layouts, or the first one. */
static enum status play_all(struct traffic_field *field, struct reason *reason)
{
    static const char *const own_layout[] = {"f32", NULL}, *const own_store[] = {"indexed", NULL};
    const void *layout[LIST_MOST], *store[LIST_MOST];
    size_t layouts_count = bench_members(TABLE_LAYOUTS, &field->bench->layout, own_layout, layout);
    size_t stores = bench_members(TABLE_STORES, &field->bench->store, own_store, store);
    enum status status = make_paths(field, reason);
    for (size_t l = 0; l < layouts_count && !status; l++)
        for (size_t s = 0; s < stores && !status; s++) {
            struct reason why = {""};
            const struct layout *one = layout[l];
            const struct tri_store *of = store[s];
            enum status left_out = play_store(field, one, of, &why);
            if (left_out == STATUS_LIMIT || left_out == STATUS_UNSUPPORTED) {
                screen_text(&field->bench->screen_is, "%s, %s: left out: %s\n", one->name, of->name,
                            why.text);
                bench_left_out(field->bench, one, of, left_out);
            } else if (left_out) {
                status = fail(reason, left_out, "%s", why.text);
            }
        }
    if (!status && field->layouts == 0)
        status = fail(reason, STATUS_LIMIT, "no layout holds the scene");
    return status;
}

static enum status make_tree(struct traffic_field *field, struct reason *reason)
{
    const struct build_options build = {.leaf = BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT};
    if (field->bench->bvh)
        return bench_tree_make(field->bench, field->scene, &field->bvh, reason);
    return bvh_build(builder_find("sah_binned"), field->scene, &build, &field->bvh, reason);
}

static enum status play_scene(struct bench *bench, const char *spec, const struct scene *scene,
                              struct reason *reason)
{
    const struct traffic_options *o = &bench->traffic;
    struct traffic_field *field = alloc_zeroed(1, sizeof *field);
    if (!field)
        return fail(reason, STATUS_MEMORY, "no memory for a scene");
    field->bench = bench;
    field->spec = spec;
    field->scene = scene;
    field->count = bench_rays_count(bench, PATHS);
    field->depth[0] = 1;
    field->depth_count = o->depth_count ? o->depth_count : 1;
    for (size_t d = 0; d < o->depth_count; d++)
        field->depth[d] = o->depth[d];
    for (size_t s = 0; o->scheduler_count ? s < o->scheduler_count : schedulers[s] != NULL; s++)
        field->scheduler[field->scheduler_count++] =
            o->scheduler_count ? o->scheduler[s] : schedulers[s];
    field->grid.column = columns;
    field->grid.column_count = ARRAY_COUNT(columns);
    screen_text(&bench->screen_is, "%s: %s; %s, %s\n", spec, COUNTED(scene->tri_count, "triangle"),
                COUNTED(field->count, "path"),
                bench->bvh ? "the tree of --bvh" : "builder sah_binned, leaf 4");
    enum status status = make_tree(field, reason);
    if (!status)
        status = play_all(field, reason);
    progress_end(&bench->progress);
    if (field->grid.row_count > 0)
        grid_print(&field->grid, &bench->screen_is);
    traffic_paths_free(&field->paths);
    kd_free(&field->kd);
    bvh_free(&field->bvh);
    free(field);
    return status;
}

static int run(struct bench *bench)
{
    struct reason reason = {""};
    enum status status = traffic_check(bench, PATHS, &reason);
    if (status)
        return usage_error("bench", "traffic: %s", reason.text);
    bench_each(bench, &bench_traffic);
    if (bench->svg_path)
        bench_failed(bench, NULL, traffic_plot(bench->svg_path, bench->rows, &reason), &reason);
    return bench->code;
}

const struct benchmark bench_traffic = {
    .name = "traffic",
    .shown = "all bytes add up, and no answer is WRONG",
    .refuted = "bytes do not add up, or an answer is WRONG",
    .summary = "bytes that schedulers of the literature move for paths through layouts",
    .takes = "scene count csv json svg seed bvh layout store scheduler depths units lanes packet "
             "treelet queue private shared row" BENCH_SCREEN,
    .about = about,
    .scenes = "scenes/fetched/glmark2-bunny.obj;scenes/fetched/dragon-871k.ply.gz",
    .made = "sphere:n=50;terrain:k=6",
    .play = play_scene,
    .run = run,
    .titled = true,
    .triangles = true,
    .alone = true,
};
