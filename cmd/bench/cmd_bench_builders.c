/* Builders: time per triangle and quality of the tree. */
#include "cmd/bench/cmd_bench.h"

#include "ref/base/command.h"
#include "ref/tree/tree_quality.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"

#include <inttypes.h>

/* End-point overlap is estimated for scenes with more triangles. */
#define OVERLAP_MOST 50000u
#define MOST         64
#define PARTS        0.3 /* the budget that Karras and Aila 2013 recommend */

/* One way to build. */
struct builders_contestant {
    const struct builder *builder;
    uint32_t passes, threads;
    bool rotates; /* the passes are of rotations */
    double share; /* of parts of triangles: --presplit, or --split-budget of sbvh; 0: the default */
    double ns[BENCH_ROUNDS];
    struct tree_quality quality;
    double overlap;
    struct build_traffic traffic; /* of a builder that is a stream */
    struct reason refused;        /* "" if it was not refused */
};

/* It cuts triangles by itself. */
static bool splits(const struct builders_contestant *c)
{
    return builder_takes(c->builder, "split-budget");
}

static void add(struct builders_contestant *list, size_t *count,
                const struct builders_contestant *c)
{
    if (*count < MOST)
        list[(*count)++] = *c;
}

/* All builders of C, and some with reinsertion and rotations after them, and some with a
 * budget of parts of triangles: with one and with two threads, or with the user's number of
 * threads. */
static size_t contestants(const struct bench *bench, struct builders_contestant list[MOST])
{
    static const struct {
        const char *builder;
        uint32_t passes;
        bool rotates;
        double share;
    } changed[] = {{"sah_binned", BUILD_PASSES_DEFAULT, false, 0},
                   {"lbvh", BUILD_PASSES_DEFAULT, false, 0},
                   {"ploc", BUILD_PASSES_DEFAULT, false, 0},
                   {"sbvh", BUILD_PASSES_DEFAULT, false, 0},
                   {"lbvh", BUILD_PASSES_DEFAULT, true, 0},
                   {"ploc", BUILD_PASSES_DEFAULT, true, 0},
                   {"sah_binned", 0, false, PARTS},
                   {"lbvh", 0, false, PARTS},
                   {"trbvh", 0, false, PARTS},
                   {"sbvh", 0, false, PARTS}};
    uint32_t first = bench->engines.threads ? bench->engines.threads : 1;
    uint32_t last = bench->engines.threads ? bench->engines.threads : 2;
    size_t count = 0;
    for (uint32_t threads = first; threads <= last; threads++) {
        for (size_t b = 0; builders_all[b] && !builders_all[b]->compare; b++)
            add(list, &count,
                &(struct builders_contestant){.builder = builders_all[b], .threads = threads});
        for (size_t i = 0; i < ARRAY_COUNT(changed); i++)
            add(list, &count,
                &(struct builders_contestant){.builder = builder_find(changed[i].builder),
                                              .passes = changed[i].passes,
                                              .rotates = changed[i].rotates,
                                              .share = changed[i].share,
                                              .threads = threads});
    }
    return count;
}

/* Builds once. With `look`, also measures the tree's quality. */
static enum status build_once(struct builders_contestant *c, const struct scene *scene,
                              size_t round, bool look, struct reason *reason)
{
    const struct build_options options = {.leaf = BUILD_LEAF_DEFAULT,
                                          .eps = BUILD_EPS_DEFAULT,
                                          .passes = c->passes,
                                          .rotates = c->rotates,
                                          .presplit = splits(c) ? 0 : (float)c->share,
                                          .split_budget = splits(c) ? (float)c->share : 0,
                                          .threads = c->threads};
    struct bvh bvh;
    uint64_t start = time_ns();
    enum status status = bvh_build(c->builder, scene, &options, &bvh, reason);
    c->ns[round] = (double)(time_ns() - start);
    if (status == STATUS_LIMIT) {
        c->refused = *reason;
        return STATUS_OK;
    }
    if (!status && look) {
        status = tree_quality(&bvh, scene, &c->quality, reason);
        if (!status && tree_overlap(&bvh, scene, OVERLAP_MOST, &c->overlap))
            status = fail(reason, STATUS_MEMORY, "no memory to judge a tree of %u nodes",
                          bvh.node_count);
        if (!status && c->builder->traffic && c->passes == 0)
            status = c->builder->traffic(scene, &options, &c->traffic, reason);
    }
    bvh_free(&bvh);
    return status;
}

static void print_row(struct bench *bench, const char *spec, const struct scene *scene,
                      struct builders_contestant *c, struct row_grid *grid)
{
    char name[64];
    int used = snprintf(name, sizeof name, "%s", c->builder->name);
    if (c->passes)
        snprintf(name + used, sizeof name - (size_t)used, " %s=%u",
                 c->rotates ? "rotate" : "reinsert", c->passes);
    if (c->share > 0)
        snprintf(name + used, sizeof name - (size_t)used, " %s=%g",
                 splits(c) ? "split-budget" : "presplit", c->share);
    if (c->refused.text[0]) {
        screen_text(&bench->screen_is, "  %-24s %s\n", name, c->refused.text);
        return;
    }
    struct spread spread = spread_of(c->ns, (size_t)bench->rounds);
    const struct tree_quality *q = &c->quality;
    double tris = scene->tri_count ? (double)scene->tri_count : 1.0;
    if (!bench->screen_is.wide)
        grid_add(grid, PAINT_PLAIN, "%s\t%u\t%.1f\t%.1f-%.1f\t%.2f\t%.2f\t%u\t%u\t%.2f\t%u\t%u",
                 name, c->threads, spread.median / tris, spread.least / tris, spread.most / tris,
                 q->sah, c->overlap, q->stats.depth, q->stats.node_count, q->leaf_fill,
                 q->stats.largest_leaf, q->stats.loose_count);
    else
        printf("  %-24s %7u %9.1f (%.1f-%.1f) %8.2f %8.2f %6u %9u %6.2f %7u %6u\n", name,
               c->threads, spread.median / tris, spread.least / tris, spread.most / tris, q->sah,
               c->overlap, q->stats.depth, q->stats.node_count, q->leaf_fill, q->stats.largest_leaf,
               q->stats.loose_count);
    json_t *row = json_record(
        "scene=%s builder=%s reinsert=%u rotate=%u presplit=%g split_budget=%g threads=%u "
        "triangles=%u rounds=%zu ns_per_tri_median=%g "
        "ns_per_tri_min=%g ns_per_tri_max=%g sah=%g overlap=%g overlap_exact=%i nodes=%u leaves=%u "
        "leaf_fill=%g depth=%u largest_leaf=%u loose=%u sweeps=%p boxes_read=%p boxes_written=%p",
        spec, c->builder->name, c->rotates ? 0 : c->passes, c->rotates ? c->passes : 0,
        splits(c) ? 0 : c->share, splits(c) ? c->share : 0, c->threads, scene->tri_count,
        bench->rounds, spread.median / tris, spread.least / tris, spread.most / tris, q->sah,
        c->overlap, scene->tri_count <= OVERLAP_MOST, q->stats.node_count, q->stats.leaf_count,
        q->leaf_fill, q->stats.depth, q->stats.largest_leaf, q->stats.loose_count,
        json_known(c->traffic.sweeps), json_known(c->traffic.boxes_read),
        json_known(c->traffic.boxes_written));
    bench_row(bench, &bench_builders, row);
}

/* What a streaming unit would move. With several numbers of threads it is the same. */
static void print_traffic(const struct bench *bench, const struct scene *scene,
                          const struct builders_contestant *list, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const struct build_traffic *t = &list[i].traffic;
        if (t->sweeps == 0 || list[i].threads != list[0].threads)
            continue;
        double bytes = (double)(t->boxes_read + t->boxes_written) * BUILD_TRAFFIC_BYTES;
        screen_text(&bench->screen_is,
                    "%s: %u sweeps read %" PRIu64 " boxes and write %" PRIu64
                    ", %u bytes each: %.0f bytes a sweep, %.1f a triangle\n",
                    list[i].builder->name, t->sweeps, t->boxes_read, t->boxes_written,
                    BUILD_TRAFFIC_BYTES, bytes / t->sweeps, bytes / scene->tri_count);
    }
}

static enum status build_all(struct bench *bench, const char *spec, const struct scene *scene,
                             struct reason *reason)
{
    static struct builders_contestant list[MOST];
    size_t count = contestants(bench, list);
    for (size_t round = 0; round < bench->rounds; round++)
        for (size_t i = 0; i < count; i++) {
            if (list[i].refused.text[0])
                continue;
            progress_done(&bench->progress, round * count + i, bench->rounds * count,
                          "these rounds");
            progress_step(&bench->progress, "%s, builder %s, %u threads, round %zu", spec,
                          list[i].builder->name, list[i].threads, round);
            enum status status = build_once(&list[i], scene, round, round == 0, reason);
            if (status)
                return status;
        }
    progress_end(&bench->progress);
    static const struct column columns[] = {
        {"builder", .left = true}, {.title = "threads"}, {.title = "ns/tri"},
        {"least-most", .rank = 4}, {.title = "SAH"},     {.title = "overlap"},
        {"depth", .rank = 1},      {.title = "nodes"},   {.title = "fill"},
        {"largest", .rank = 2},    {"loose", .rank = 3}};
    struct row_grid grid = {.column = columns, .column_count = ARRAY_COUNT(columns)};
    printf("%s: %s%s\n", spec, COUNTED(scene->tri_count, "triangle"),
           scene->tri_count > OVERLAP_MOST ? "; overlap is estimated" : "");
    if (bench->screen_is.wide)
        puts("  builder                  threads    ns/tri (least-most)       SAH  overlap  depth  "
             "   "
             "nodes   fill largest  loose");
    for (size_t i = 0; i < count; i++)
        print_row(bench, spec, scene, &list[i], &grid);
    if (!bench->screen_is.wide)
        grid_print(&grid, &bench->screen_is);
    print_traffic(bench, scene, list, count);
    return STATUS_OK;
}

const struct benchmark bench_builders = {
    .name = "builders",
    .shown = "times and trees, nothing is judged",
    .summary = "time per triangle, with one thread and with two, and the tree's quality",
    .takes = "scene rounds csv json threads" BENCH_SCREEN,
    .about = "leaf size 4. SAH: expected cost of a line through the scene's box, 1 for a node or "
             "a triangle; overlap: what a ray pays that ends on a surface in boxes of triangles "
             "elsewhere, likewise (of 50,000 triangles, if there are more); fill: triangles per "
             "leaf; loose: inner nodes that do not contain their triangles. sweeps: of the "
             "streams that ploctree's are, what a unit would read and write of them. --threads N: "
             "only so many.",
    .scenes = "soup:n=20000,size=0.01;sphere:n=100",
    .play = build_all,
    .titled = true,
    .triangles = true,
};
