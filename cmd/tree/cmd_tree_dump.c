#include "cmd/tree/cmd_tree_dump.h"

#include "ref/base/command.h"
#include "ref/files/file.h"
#include "scenes/opening.h"
#include "scenes/scenes.h"
#include "scenes/worlds.h"

#include <stdlib.h>
#include <string.h>

static const char *const formats[] = {"raydiff", "tinybvh", "bvh2", "lavapipe",
                                      "radv",    "guessed", NULL};

#define ROWS_OF struct tree_command

static const struct option_row rows[] = {
    {"format", "F",
     "raydiff, tinybvh (BVH::Save), bvh2 (serialize of madmann91's bvh, version 2), lavapipe "
     "or radv (acceleration structures of Mesa 25.0 as Vulkan serialises them), or guessed from "
     "the "
     "file",
     OF_CHOICE(format, formats), .value = "guessed"},
    {"faults", "N", "faults of each rule that are named; all are counted",
     OF_COUNT(faults, 0, 1u << 20), .value = "4"},
    {"from", "ENGINE",
     "rayquery or a variant of it: has a Vulkan driver build the trees of SCENE, and reads these",
     OF_TEXT(from)},
    {"aim", "N",
     "with --from: N rays that meet triangles of instances just outside of their boxes, and "
     "whether "
     "the driver finds these",
     OF_COUNT(aim, 0, 1u << 30), .value = "0"},
    {"save", "FILE", "with --from: what the driver serialised", OF_WRITTEN(save)},
    {"driver", "NAME", "with --from: the driver, as in raydiff check", OF_TEXT(engines.driver)},
    {"device", "N", "with --from: device by the number that raydiff doctor gives",
     OF_COUNT(engines.device, 0, 255)},
    {"json", "FILE", "all that was found, for machines", OF_DATA(json)},
    {0},
};

static const struct option_set set = {
    .command = "tree",
    .usage = "tree FILE [SCENE] [OPTIONS]\n"
             "tree SCENE --from rayquery [--driver NAME] [--save FILE] [OPTIONS]",
    .about =
        "Reads a tree that another program wrote, with any number of children a node, and tells "
        "what it is and what is wrong with it, without a ray. SCENE is what the tree is of, a mesh "
        "file or a generator; without it the file's own triangles count, or the scene that it "
        "names. With neither, boxes are compared with those of the leaves below. What a driver "
        "serialised has its triangles, which are compared with those of SCENE, a world or a mesh.\n"
        "\n"
        "Faults: a child that is no node, is above its parent or has two; a node that nothing "
        "leads to; a leaf beyond the list of triangles; a triangle that there is not, is missing "
        "or doubled; a bound that is no number; a box that is too small, with the triangle, the "
        "side and by how much, exactly. In a tree that splits triangles, the boxes of the leaves "
        "must cover each triangle together. The box of an instance must contain its triangles, "
        "placed by real numbers: told is how many do not, and by how much at most, in floats and "
        "in u, 2^-24 of the sizes that the box is a sum of (docs/variants.md).",
    .group = {GROUP(rows), GROUP_AT(screen_rows, screen)},
    .notes = "The format raydiff is text, which a tracer writes in twenty lines "
             "(docs/my-engine.md).",
    .codes = "0 sound, 1 faults found, 2 bad input, 4 no memory, 77 the driver cannot do it",
    .example = "tree fuzz/samples/two.tree\n"
               "tree fuzz/samples/two.tree --format raydiff --json -\n"
               "tree crowd:n=100 --from rayquery --driver mesa25 --save crowd.as\n"
               "tree crowd:n=100 --from rayquery --driver mesa25 --aim 100000",
};

/* Opens the scene of the tree. *out is empty if there is none; *named is what it is called. */
static enum status open_scene(const char *file, const char *spec, const struct tree_dump *dump,
                              struct scene *out, const char **named, struct reason *reason)
{
    *out = (struct scene){0};
    *named = spec ? spec : dump->spec;
    if (spec && dump->scene.tri_count)
        return fail(reason, STATUS_INPUT, "%s: has triangles of its own, so %s is not used", file,
                    spec);
    if (spec)
        return scene_open(spec, 1, out, reason);
    return dump->spec ? scene_open_beside(file, dump->spec, out, reason) : STATUS_OK;
}

/* Compares what a driver serialised with the scene or world that it is of. */
static enum status compare(const char *spec, struct tree_told *told, struct reason *reason)
{
    struct world world;
    struct reason why = {""};
    enum status status = world_open(spec, 1, &world, reason);
    if (status)
        return status;
    status = dump_compare(told->dump, &world, &told->differences, &why);
    world_free(&world);
    told->compared = status == STATUS_OK;
    told->scene = spec;
    return status ? fail(reason, status, "%s: %s", spec, why.text) : STATUS_OK;
}

/* Checks a tree, without what is below a top level. `scene` NULL: its own triangles, if any. */
static enum status look(const struct tree_command *command, const struct scene *scene,
                        struct tree_told *told, struct reason *reason)
{
    const struct tree_dump *dump = told->dump;
    struct reason why = {""};
    if (!scene && dump->scene.tri_count)
        scene = &dump->scene;
    told->has_scene = scene != NULL;
    enum status status = dump_check(dump, scene, command->faults, true, &told->report, &why);
    told->measured = dump->instance && dump->scene.tri_count;
    if (!status && told->measured)
        status = dump_measure(dump, &told->lacks, &why);
    return status ? fail(reason, status, "%s: %s", file_label(told->file), why.text) : STATUS_OK;
}

static enum status look_below(const struct tree_command *command, struct tree_told *told,
                              struct reason *reason)
{
    enum status status = STATUS_OK;
    told->below = alloc_zeroed(told->dump->below_count, sizeof *told->below);
    if (!told->below)
        return fail(reason, STATUS_MEMORY, "no memory for %zu trees", told->dump->below_count);
    for (size_t i = 0; i < told->dump->below_count && !status; i++) {
        told->below[i] =
            (struct tree_told){.file = told->file, .tree = i + 1, .dump = &told->dump->below[i]};
        status = look(command, NULL, &told->below[i], reason);
    }
    return status;
}

static void told_free(struct tree_told *told)
{
    for (size_t i = 0; told->below && i < told->dump->below_count; i++)
        free(told->below[i].report.fault);
    free(told->below);
    free(told->report.fault);
    free(told->lacks.side);
}

static bool is_faulty(const struct tree_told *told)
{
    bool faulty = told->report.faults > 0 || told->differences.instances > 0 ||
                  told->differences.triangles > 0;
    for (size_t i = 0; told->below && i < told->dump->below_count; i++)
        faulty = faulty || told->below[i].report.faults > 0;
    return faulty;
}

/* Checks, and prints and writes what was found. Returns the exit code. */
static int tell(const struct tree_command *command, const char *spec, struct tree_told *told)
{
    struct reason reason = {""}, why = {""};
    struct scene opened = {0};
    enum status status = STATUS_OK;
    if (spec && (told->dump->instance || told->dump->source))
        status = compare(spec, told, &reason);
    else
        status = open_scene(told->file, spec, told->dump, &opened, &told->scene, &reason);
    if (!status)
        status = look(command, told->scene && !told->compared ? &opened : NULL, told, &reason);
    if (!status)
        status = look_below(command, told, &reason);
    if (!status && command->aim && told->measured)
        status = tree_aim(command, spec, told, &reason);
    int code = status            ? exit_with_reason("tree", status, &reason)
               : is_faulty(told) ? EXIT_MISMATCH
                                 : EXIT_AGREE;
    if (!status) {
        const struct screen screen = screen_make(&command->screen);
        tree_print(told, &screen);
        fflush(stdout);
    }
    if (!status && command->json)
        code = exit_worse(
            code, exit_with_reason("tree", tree_write_json(command->json, told, code, &why), &why));
    told_free(told);
    scene_free(&opened);
    return code;
}

/* What goes with --from, and what does not. */
static int check_from(const struct tree_command *command, int words)
{
    if (!command->from &&
        (command->save || command->aim || command->engines.driver || command->engines.device >= 0))
        return usage_error("tree", "%s needs --from",
                           command->save             ? "--save"
                           : command->aim            ? "--aim"
                           : command->engines.driver ? "--driver"
                                                     : "--device");
    if (command->from && words > 1)
        return usage_error("tree", "--from takes a SCENE, and no FILE beside it");
    if (command->from && command->format != DUMP_GUESSED && command->format != DUMP_LAVAPIPE)
        return usage_error("tree", "--from: a driver writes no trees of format %s",
                           formats[command->format]);
    return -1;
}

/* Builds or reads the bytes of the trees, and reads these. What was built by a driver that is not
 * known cannot be. */
static enum status open_dump(const struct tree_command *command, const char *file, char **driver,
                             struct tree_dump *dump, struct reason *reason)
{
    char *bytes = NULL;
    size_t size = 0;
    enum status status = command->from ? tree_build(command, file, &bytes, &size, driver, reason)
                                       : file_read(file, &bytes, &size, reason);
    const unsigned format = command->from ? DUMP_LAVAPIPE : command->format;
    if (!status)
        status = tree_dump_read(file_label(file), bytes, size, format, dump, reason);
    else
        bytes = command->from ? bytes : NULL;
    free(bytes);
    return status == STATUS_INPUT && *driver ? STATUS_UNSUPPORTED : status;
}

int cmd_tree(int argc, char **argv)
{
    struct tree_command command = {.format = DUMP_GUESSED, .engines = engine_options_default()};
    struct reason reason = {""};
    int first, code = options_read(&set, &command, argc, argv, &first);
    if (code >= 0)
        return code;
    if (first == argc)
        return usage_error("tree", "no file given");
    if (argc - first > 2)
        return usage_error("tree", "unexpected argument '%s'", argv[first + 2]);
    code = check_from(&command, argc - first);
    if (code >= 0)
        return code;
    char *driver = NULL;
    struct tree_dump dump = {0};
    struct tree_told told = {.file = argv[first], .dump = &dump};
    enum status status = open_dump(&command, argv[first], &driver, &dump, &reason);
    told.driver = driver;
    code = status ? exit_with_reason("tree", status, &reason)
                  : tell(&command, command.from ? argv[first] : argv[first + 1], &told);
    tree_dump_free(&dump);
    free(driver);
    return code;
}
