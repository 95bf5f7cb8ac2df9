/* Figure 8: bytes, and the trees that give them. */
#include "cmd/bench/cmd_bench_paper.h"

#include "cmd/common/cmd_grid.h"
#include "ref/base/command.h"
#include "ref/base/json_record.h"
#include "ref/base/text.h"

#include <stdio.h>

/* Two kinds of CSV rows, each with its own header. */
static const struct benchmark figure8 = {.name = "figure8"}, same_tree = {.name = "same_tree"};

static double percent(uint64_t part, uint64_t whole)
{
    return 100.0 * (double)part / (double)whole;
}

static void print_mesh(const struct paper_scene *scene, const struct screen *screen)
{
    if (scene->same)
        printf("%s: the paper's default scene, %u triangles, %u vertices\n", scene->spec,
               scene->scene.tri_count, scene->scene.vertex_count);
    else
        screen_text(
            screen,
            "%s: ANOTHER MESH than the paper's teapot, whose numbers stand beside: %u triangles, "
            "%u vertices (%u, %u)\n",
            scene->spec, scene->scene.tri_count, scene->scene.vertex_count,
            scene->figure->tri_count, scene->figure->vertex_count);
}

static void print_line(const char *what, uint64_t bytes, uint64_t published, uint64_t geometry,
                       uint64_t uploaded)
{
    printf("  %-32s %9llu %9llu %9.1f %% %11.1f %%\n", what, (unsigned long long)bytes,
           (unsigned long long)published, percent(bytes, geometry), percent(bytes, uploaded));
}

static void add_figure_row(struct bench *bench, const struct paper_scene *scene, uint64_t geometry,
                           uint64_t uploaded, const struct paper_tree *direct,
                           const struct paper_tree *rf)
{
    const struct paper_figure *figure = scene->figure;
    bench_row(bench, &figure8,
              json_record("scene=%s mesh=%s triangles=%u vertices=%u geometry=%zu "
                          "geometry_paper=%zu with_vertices=%zu direct_leaf=%u direct_nodes=%u "
                          "direct=%zu direct_paper=%zu rf_leaf=%u rf_leaves=%u rf=%zu rf_paper=%zu",
                          scene->spec, scene->same ? "the paper's" : "another",
                          scene->scene.tri_count, scene->scene.vertex_count, geometry,
                          figure->geometry, uploaded, direct->leaf, direct->stats.node_count,
                          direct->direct, figure->direct, rf->leaf, rf->stats.leaf_count, rf->rf,
                          figure->rf));
}

/* Prints Figure 8 of one scene. */
static enum status print_figure(struct bench *bench, const struct paper_scene *scene,
                                struct reason *reason)
{
    struct paper_tree direct, rf;
    const struct paper_figure *figure = scene->figure;
    enum status status = paper_tree(&scene->scene, PAPER_LEAF_DIRECT, &direct, reason);
    if (!status)
        status = paper_tree(&scene->scene, PAPER_LEAF_RF, &rf, reason);
    if (status)
        return status;
    uint64_t geometry = paper_geometry(scene->scene.tri_count);
    uint64_t uploaded = paper_uploaded(scene->scene.tri_count, scene->scene.vertex_count);
    char name[80];
    print_mesh(scene, &bench->screen_is);
    puts("                                       bytes     paper of geometry with vertices");
    print_line("geometry, 16 n + 40", geometry, figure->geometry, geometry, uploaded);
    snprintf(name, sizeof name, "direct, leaf %u: %s of %u", direct.leaf,
             COUNTED(direct.stats.node_count, "node"), PAPER_DIRECT_BYTES);
    print_line(name, direct.direct, figure->direct, geometry, uploaded);
    snprintf(name, sizeof name, "RF, leaf %u: %s of %u", rf.leaf,
             COUNTED(3 * rf.stats.leaf_count - 1, "record"), PAPER_RF_BYTES);
    print_line(name, rf.rf, figure->rf, geometry, uploaded);
    add_figure_row(bench, scene, geometry, uploaded, &direct, &rf);
    if (!scene->same)
        return STATUS_OK;
    bool agrees = paper_agrees(figure, geometry, &direct, &rf);
    puts(agrees ? "  exactly the published numbers"
                : "  NOT THE PUBLISHED NUMBERS: builder, layouts or scene have changed");
    bench_worse(bench, agrees ? EXIT_AGREE : EXIT_MISMATCH);
    return STATUS_OK;
}

static enum status add_same_tree(struct bench *bench, const struct paper_scene *scene,
                                 uint32_t leaf, struct row_grid *grid, struct reason *reason)
{
    struct paper_tree tree;
    enum status status = paper_tree(&scene->scene, leaf, &tree, reason);
    if (status)
        return status;
    char records[80] = "-\t-\t-\t-";
    if (tree.rf)
        snprintf(records, sizeof records, "%llu\t%.3f\t%.3f\t%.3f", (unsigned long long)tree.rf,
                 (double)tree.direct / (double)tree.rf, (double)tree.plain / (double)tree.rf,
                 (double)(tree.plain + tree.items) / (double)tree.rf);
    else
        printf("leaf %u does not fit into records: a leaf of %u\n", leaf, tree.stats.largest_leaf);
    grid_add(grid, PAINT_PLAIN, "%u\t%u\t%u\t%u\t%u\t%llu\t%llu\t%llu\t%s", leaf,
             tree.stats.node_count, tree.stats.leaf_count, tree.stats.depth,
             tree.stats.largest_leaf, (unsigned long long)tree.direct,
             (unsigned long long)tree.plain, (unsigned long long)(tree.plain + tree.items),
             records);
    bench_row(bench, &same_tree,
              json_record("scene=%s leaf=%u nodes=%u leaves=%u depth=%u largest_leaf=%u "
                          "direct48=%zu plain32=%zu items=%zu rf16=%zu",
                          scene->spec, leaf, tree.stats.node_count, tree.stats.leaf_count,
                          tree.stats.depth, tree.stats.largest_leaf, tree.direct, tree.plain,
                          tree.items, tree.rf));
    return STATUS_OK;
}

/* The same trees in nodes of 48, 32 and 16 bytes. */
static void print_same_trees(struct bench *bench, const struct paper_scene *scene)
{
    static const struct column columns[] = {
        {.title = "leaf"},      {.title = "nodes"}, {"leaves", .rank = 1}, {"depth", .rank = 3},
        {"largest", .rank = 2}, {.title = "48"},    {.title = "32"},       {.title = "32+items"},
        {.title = "16"},        {.title = "48:16"}, {.title = "32:16"},    {.title = "+items:16"}};
    struct row_grid grid = {.column = columns, .column_count = ARRAY_COUNT(columns)};
    struct reason reason = {""};
    puts("");
    screen_text(&bench->screen_is,
                "%s: the same tree in nodes of 48 bytes (published), of 32 (without padding; "
                "beside them 4 bytes an item unless triangles are reordered) and in records of "
                "16\n",
                scene->spec);
    for (uint32_t leaf = 2; leaf <= 8; leaf += 2)
        bench_failed(bench, scene->spec, add_same_tree(bench, scene, leaf, &grid, &reason),
                     &reason);
    grid_print(&grid, &bench->screen_is);
}

void paper_print_bytes(struct bench *bench, const struct paper_scene *scene, size_t count)
{
    struct reason reason = {""};
    screen_text(&bench->screen_is,
                "Figure 8, bytes. The paper's trees are not the same: its direct handler has leaf "
                "2, its RF handler leaf 4; and its geometry leaves the vertices out.\n");
    puts("");
    for (size_t i = 0; i < count; i++)
        bench_failed(bench, scene[i].spec, print_figure(bench, &scene[i], &reason), &reason);
    for (size_t i = 0; i < count; i++)
        print_same_trees(bench, &scene[i]);
}
