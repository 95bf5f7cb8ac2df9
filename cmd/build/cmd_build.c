#include "cmd/build/cmd_build.h"

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
    {"driver", "NAME", "Vulkan: as in raydiff check", OF_TEXT(engines.driver)},
    {"device", "N", "Vulkan: device by the number that raydiff doctor gives",
     OF_COUNT(engines.device, 0, 255)},
    {"rounds", "N", "measurements of each", OF_COUNT(rounds, 1, BUILD_ROUNDS_MOST), .value = "5"},
    SCENE_SEED_ROW(seed),
    {"json", "FILE", "all rows, for machines", OF_DATA(json)},
    {0},
};

static const struct option_set set = {
    .command = "build",
    .usage = "build SCENE... [OPTIONS]",
    .about =
        "Builds trees by Vulkan compute shaders and in C, and compares every byte of every stage: "
        "the Morton codes, their order, the links and boxes of the nodes. Of trees that differ it "
        "names the first stage and the element. Times are of the stages alone, without copies; C "
        "builds with one thread.",
    .group = {GROUP(rows), GROUP_AT(screen_rows, screen)},
    .codes = "0 equal, 1 a tree differs, 2 bad input, 3 the device failed, 77 no device",
    .example = "build sphere:n=40 --builder gpu_hploc",
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

static enum status play_scene(const struct build_command *b, struct device_tree *tree,
                              const char *spec, struct progress *progress, struct build_row *row,
                              struct reason *reason)
{
    struct scene scene;
    enum status status = scene_open(spec, b->seed, &scene, reason);
    for (size_t i = 0; i < b->builder.count && !status; i++) {
        row[i] = (struct build_row){.scene = spec,
                                    .builder = builders_all[b->builder.index[i]],
                                    .triangles = scene.tri_count};
        progress_step(progress, "%s, builder %s", spec, row[i].builder->name);
        status = build_measure(tree, &scene, b->rounds, &row[i], reason);
    }
    progress_end(progress);
    scene_free(&scene);
    return status;
}

static int play_all(const struct build_command *b, struct device_tree *tree, char *const *spec,
                    size_t count)
{
    const size_t each = b->builder.count;
    const struct screen screen = screen_make(&b->screen);
    struct progress progress = progress_make("build");
    struct build_row *row = alloc_zeroed(count * each, sizeof *row);
    struct reason reason = {""};
    int code = row ? EXIT_AGREE : EXIT_INTERNAL;
    size_t done = 0;
    screen_text(&screen, "device: %s, %s\n", device_tree_limits(tree)->device,
                device_tree_limits(tree)->driver);
    for (size_t i = 0; i < count && row; i++) {
        enum status status = play_scene(b, tree, spec[i], &progress, row + done, &reason);
        if (status) {
            code = exit_worse(code, exit_with_reason("build", status, &reason));
            continue;
        }
        screen_text(&screen, "%s: %s\n", spec[i], COUNTED(row[done].triangles, "triangle"));
        build_print(row + done, each, &screen);
        for (size_t k = 0; k < each; k++, done++)
            code = row[done].differs.stage ? exit_worse(code, EXIT_MISMATCH) : code;
        fflush(stdout);
    }
    if (b->json && row) {
        enum status status = build_write_json(b->json, row, done, device_tree_limits(tree),
                                              b->rounds, code, &reason);
        code = exit_worse(code, exit_with_reason("build", status, &reason));
    }
    free(row);
    return code;
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
    if (choose(&b, &reason))
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
