/* Builders: time per triangle and what the tree looks like. */
#include "bench/cmd_bench.h"

#include "ref/command.h"
#include "scenes/scenes.h"

static int bench_one(struct bench *bench, const char *spec, const struct scene *scene,
                     const struct builder *builder)
{
    const struct build_options build = {.leaf = BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT};
    double ns[BENCH_ROUNDS];
    struct bvh_stats stats = {0};
    for (size_t round = 0; round < bench->rounds; round++) {
        struct bvh bvh;
        struct reason reason = {""};
        progress_step(&bench->progress, "%s, builder %s, round %zu", spec, builder->name, round);
        uint64_t start = time_ns();
        enum status status = builder->build(scene, &build, &bvh, &reason);
        ns[round] = (double)(time_ns() - start);
        if (status) {
            progress_end(&bench->progress);
            printf("%-32s %-8s %s\n", spec, builder->name, reason.text);
            return status == STATUS_LIMIT ? EXIT_AGREE : exit_of_status(status);
        }
        stats = bvh_stats(&bvh, scene);
        bvh_free(&bvh);
    }
    progress_end(&bench->progress);
    struct spread spread = spread_of(ns, (size_t)bench->rounds);
    double tris = scene->tri_count ? (double)scene->tri_count : 1.0;
    printf("%-32s %-8s %8.1f (%.1f-%.1f) ns per triangle; %u nodes, depth %u, largest leaf %u, "
           "loose %u\n",
           spec, builder->name, spread.median / tris, spread.least / tris, spread.most / tris,
           stats.node_count, stats.depth, stats.largest_leaf, stats.loose_count);
    json_t *row =
        json_pack("{s:s, s:s, s:I, s:I}", "scene", spec, "builder", builder->name, "triangles",
                  (json_int_t)scene->tri_count, "rounds", (json_int_t)bench->rounds);
    json_object_set_new(row, "ns_per_tri_median", bench_number(spread.median / tris));
    json_object_set_new(row, "ns_per_tri_min", bench_number(spread.least / tris));
    json_object_set_new(row, "ns_per_tri_max", bench_number(spread.most / tris));
    json_object_set_new(row, "nodes", json_integer(stats.node_count));
    json_object_set_new(row, "depth", json_integer(stats.depth));
    json_object_set_new(row, "largest_leaf", json_integer(stats.largest_leaf));
    json_object_set_new(row, "loose", json_integer(stats.loose_count));
    bench_row(bench, &bench_builders, row);
    return EXIT_AGREE;
}

static int run(struct bench *bench)
{
    static const char *const own[] = {"soup:n=100000,size=0.01", "sphere:n=200", NULL};
    const char *spec[BENCH_SCENES];
    size_t count = bench_scenes(bench, own, spec);
    int code = EXIT_AGREE;
    puts("\nbuilders");
    for (size_t i = 0; i < count; i++) {
        struct scene scene;
        struct reason reason;
        enum status status = scene_open(spec[i], 1, &scene, &reason);
        if (status) {
            fprintf(stderr, "raydiff bench: %s\n", reason.text);
            code = exit_worse(code, exit_of_status(status));
            continue;
        }
        for (size_t b = 0; builders_all[b]; b++)
            code = exit_worse(code, bench_one(bench, spec[i], &scene, builders_all[b]));
        scene_free(&scene);
    }
    return code;
}

const struct benchmark bench_builders = {
    .name = "builders",
    .summary = "time per triangle, nodes, depth",
    .takes = BENCH_TAKES_JSON,
    .run = run,
};
