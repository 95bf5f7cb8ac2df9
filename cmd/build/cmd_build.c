#include "cmd/build/cmd_build.h"
#include "cmd/build/cmd_build_same.h"

#include "cmd/common/cmd_progress.h"
#include "gpu/trace/vulkan_options.h"
#include "ref/base/command.h"
#include "ref/base/text.h"
#include "scenes/scenes.h"

#include <stdlib.h>

#define ROWS_OF struct build_command

static const struct option_row rows[] = {
    {"builder", "B,..", "builders on a device", OF_LIST(builder, TABLE_BUILDERS),
     .shown = "all of them"},
    {"layout", "L,..", "layouts that trees are encoded in on the device",
     OF_LIST(layout, TABLE_LAYOUTS), .value = "cwbvh80,tiny8"},
    {"driver", "NAME", "Vulkan: as in raydiff check", OF_TEXT(engines.driver)},
    {"device", "N", "Vulkan: device by the number that raydiff doctor gives",
     OF_COUNT(engines.device, 0, 255)},
    {"rounds", "N", "measurements of each", OF_COUNT(rounds, 1, BUILD_ROUNDS_MOST), .value = "5"},
    {"move", "F", "also moves vertices by up to F of the scene's size, and refits trees",
     OF_REAL(move, 1e-7f, 1e6f)},
    {"same", "N",
     "instead builds N times with each of 1, 2, 8 and 16 threads, in C: all bytes must be equal; "
     "and "
     "reports whether answers of other projects' engines change from build to build",
     OF_COUNT(same, 1, 99)},
    {"seed", "S", "of generators whose text gives none, and of --move",
     OF_COUNT(seed, 0, UINT64_MAX), .value = "1"},
    {"json", "FILE", "all rows, for machines", OF_DATA(json)},
    {0},
};

static const struct option_set set = {
    .command = "build",
    .usage = "build SCENE... [OPTIONS]",
    .about =
        "Builds trees by Vulkan compute shaders and in C, and compares every byte of every stage: "
        "the Morton codes, their order, the links and boxes of the nodes. Then each tree is "
        "collapsed to nodes of 8 children and encoded in the layouts, again on both sides: the "
        "children and items of the nodes are compared, and the words. Of trees that differ it "
        "names the first stage and the element. Times are of the stages alone, without copies; C "
        "builds with one thread. With --move, trees of builder hploc are refitted on the device, "
        "too, in each layout of which it can be done, and compared with C's word by word. With "
        "--same, "
        "no device is used: the same tree is built again and again, by default by all builders.",
    .group = {GROUP(rows), GROUP_AT(screen_rows, screen)},
    .codes = "0 equal, 1 a tree differs or an answer is WRONG, 2 bad input, 3 the device failed, "
             "77 no device",
    .example = "build sphere:n=40 --builder gpu_hploc\nbuild sphere:n=40 --same 2 --layout f32",
};

/* All device builders, or those that were named. */
static enum status choose(struct build_command *b, struct reason *reason)
{
    enum staged_kind kind;
    for (size_t i = 0; builders_all[i] && !option_was_given("builder"); i++)
        if (device_builder_kind(builders_all[i], &kind))
            b->builder.index[b->builder.count++] = i;
    for (size_t i = 0; i < b->builder.count; i++)
        if (!device_builder_kind(builders_all[b->builder.index[i]], &kind))
            return fail(reason, STATUS_INPUT, "--builder: %s is no builder on a device",
                        builders_all[b->builder.index[i]]->name);
    return STATUS_OK;
}

/* "all" and "every": those that a device encodes. */
static enum status choose_layouts(struct build_command *b, struct reason *reason)
{
    const bool all = b->layout.all || b->layout.every;
    for (size_t i = 0; i < b->layout.count && !all; i++)
        if (!device_encodes(layouts_all[b->layout.index[i]]))
            return fail(reason, STATUS_INPUT, "--layout: %s is not encoded on a device",
                        layouts_all[b->layout.index[i]]->name);
    b->layout.count = all ? 0 : b->layout.count;
    for (size_t i = 0; layouts_all[i] && all; i++)
        if (device_encodes(layouts_all[i]))
            b->layout.index[b->layout.count++] = i;
    return STATUS_OK;
}

static enum status play_scene(const struct build_command *b, struct device_tree *tree,
                              const char *spec, struct progress *progress,
                              struct build_results *out, struct reason *reason)
{
    struct scene scene;
    struct build_row *row = out->row + out->row_count;
    const size_t layout_count = b->layout.count;
    size_t refits = 0;
    enum status status = scene_open(spec, b->seed, &scene, reason);
    for (size_t i = 0; i < b->builder.count && !status; i++) {
        row[i] = (struct build_row){.scene = spec,
                                    .builder = builders_all[b->builder.index[i]],
                                    .triangles = scene.tri_count};
        struct build_wide *wide = out->wide + out->wide_count + i * layout_count;
        for (size_t l = 0; l < layout_count; l++)
            wide[l] = (struct build_wide){.scene = spec,
                                          .builder = row[i].builder,
                                          .layout = layouts_all[b->layout.index[l]],
                                          .triangles = scene.tri_count};
        progress_step(progress, "%s, builder %s", spec, row[i].builder->name);
        status = build_measure(tree, &scene, b->rounds, &row[i], wide, layout_count, reason);
    }
    if (!status && option_was_given("move"))
        status =
            build_refits(tree, b, &scene, spec, out->refit + out->refit_count, &refits, reason);
    progress_end(progress);
    scene_free(&scene);
    if (status)
        return status;
    out->row_count += b->builder.count;
    out->wide_count += b->builder.count * layout_count;
    out->refit_count += refits;
    return STATUS_OK;
}

/* Prints the results of the last scene. */
static void print_scene(const struct build_command *b, const struct build_results *results,
                        size_t refits, const struct screen *screen)
{
    const struct build_row *row = results->row + results->row_count - b->builder.count;
    const size_t wide = b->builder.count * b->layout.count;
    screen_text(screen, "%s: %s\n", row->scene, COUNTED(row->triangles, "triangle"));
    build_print(row, b->builder.count, screen);
    build_print_wide(results->wide + results->wide_count - wide, wide, screen);
    build_print_refits(results->refit + refits, results->refit_count - refits, screen);
    fflush(stdout);
}

int build_exit(const struct build_results *results)
{
    int code = results->code;
    for (size_t i = 0; i < results->row_count; i++)
        code = results->row[i].differs.stage ? exit_worse(code, EXIT_MISMATCH) : code;
    for (size_t i = 0; i < results->wide_count; i++)
        code = results->wide[i].differs.stage ? exit_worse(code, EXIT_MISMATCH) : code;
    for (size_t i = 0; i < results->refit_count; i++)
        code = results->refit[i].differing ? exit_worse(code, EXIT_MISMATCH) : code;
    return code;
}

static int play_all(const struct build_command *b, struct device_tree *tree, char *const *spec,
                    size_t count)
{
    const struct screen screen = screen_make(&b->screen);
    struct progress progress = progress_make("build");
    struct build_results results = {
        .row = alloc_zeroed(count * b->builder.count, sizeof *results.row),
        .wide = alloc_zeroed(count * b->builder.count, b->layout.count * sizeof *results.wide),
        .refit = alloc_zeroed(count * BUILD_REFITS_MOST, sizeof *results.refit)};
    const bool enough = results.row && results.wide && results.refit;
    struct reason reason = {""};
    results.code = enough ? EXIT_AGREE : EXIT_INTERNAL;
    screen_text(&screen, "device: %s, %s\n", device_tree_limits(tree)->device,
                device_tree_limits(tree)->driver);
    for (size_t i = 0; i < count && enough; i++) {
        const size_t refits = results.refit_count;
        enum status status = play_scene(b, tree, spec[i], &progress, &results, &reason);
        results.code = exit_worse(results.code, exit_with_reason("build", status, &reason));
        if (!status)
            print_scene(b, &results, refits, &screen);
    }
    int code = build_exit(&results);
    if (b->json && enough) {
        enum status status =
            build_write_json(b->json, &results, device_tree_limits(tree), b->rounds, code, &reason);
        code = exit_worse(code, exit_with_reason("build", status, &reason));
    }
    free(results.row);
    free(results.wide);
    free(results.refit);
    return code;
}

/* What --same does not use. Returns true if one of these was given. */
static bool refuse_same(const struct build_command *b)
{
    static const char *const unused[] = {"driver", "device", "rounds", "move"};
    for (size_t i = 0; i < ARRAY_COUNT(unused); i++)
        if (option_was_given(unused[i]))
            return usage_error("build", "--%s: not used here: --same builds in C", unused[i]);
    for (size_t i = 0; i < b->builder.count; i++)
        if (builders_all[b->builder.index[i]]->compare)
            return usage_error("build", "--builder: %s builds on a device, --same in C",
                               builders_all[b->builder.index[i]]->name);
    return false;
}

int cmd_build(int argc, char **argv)
{
    struct build_command b = {.engines = engine_options_default()};
    struct reason reason = {""};
    struct device_tree *tree;
    int first, code = options_read(&set, &b, argc, argv, &first);
    if (code >= 0)
        return code;
    if (first == argc)
        return usage_error("build", "no scene given");
    if (b.same > 0)
        return refuse_same(&b) ? EXIT_USAGE : same_run(&b, argv + first, (size_t)(argc - first));
    if (choose(&b, &reason) || choose_layouts(&b, &reason))
        return usage_error("build", "%s", reason.text);
    const struct vk_options options = vulkan_options(&b.engines);
    enum status status = device_tree_open(&options, &tree, &reason);
    if (status)
        return exit_with_reason("build", status, &reason);
    code = play_all(&b, tree, argv + first, (size_t)(argc - first));
    if (device_tree_close(tree, &reason) > 0)
        code = exit_worse(code, exit_with_reason("build", STATUS_DEVICE, &reason));
    return code;
}
