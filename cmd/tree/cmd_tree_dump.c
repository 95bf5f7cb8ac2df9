#include "cmd/tree/cmd_tree_dump.h"

#include "ref/base/command.h"
#include "ref/files/file.h"
#include "scenes/opening.h"
#include "scenes/scenes.h"

#include <stdlib.h>
#include <string.h>

static const char *const formats[] = {"raydiff", "tinybvh", "bvh2", "guessed", NULL};

#define ROWS_OF struct tree_command

static const struct option_row rows[] = {
    {"format", "F",
     "raydiff, tinybvh (BVH::Save), bvh2 (serialize of madmann91's bvh, version 2), or guessed "
     "from "
     "the file",
     OF_CHOICE(format, formats), .value = "guessed"},
    {"faults", "N", "faults of each rule that are named; all are counted",
     OF_COUNT(faults, 0, 1u << 20), .value = "4"},
    {"json", "FILE", "all that was found, for machines", OF_DATA(json)},
    {0},
};

static const struct option_set set = {
    .command = "tree",
    .usage = "tree FILE [SCENE] [OPTIONS]",
    .about =
        "Reads a tree that another program wrote, with any number of children a node, and tells "
        "what it is and what is wrong with it, without a ray. SCENE is what the tree is of, a mesh "
        "file or a generator; without it the file's own triangles count, or the scene that it "
        "names. With neither, boxes are compared with those of the leaves below.\n"
        "\n"
        "Faults: a child that is no node, is above its parent or has two; a node that nothing "
        "leads to; a leaf beyond the list of triangles; a triangle that there is not, is missing "
        "or doubled; a bound that is no number; a box that is too small, with the triangle, the "
        "side and by how much, exactly. In a tree that splits triangles, the boxes of the leaves "
        "must cover each triangle together.",
    .group = {GROUP(rows), GROUP_AT(screen_rows, screen)},
    .notes = "The format raydiff is text, which a tracer writes in twenty lines "
             "(docs/my-engine.md).",
    .codes = "0 sound, 1 faults found, 2 bad input, 4 no memory",
    .example = "tree fuzz/samples/two.tree\n"
               "tree fuzz/samples/two.tree --format raydiff --json -",
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

/* Checks, and prints and writes what was found. Returns the exit code. */
static int tell(const struct tree_command *command, const char *file, const char *spec,
                const struct tree_dump *dump)
{
    struct tree_told told = {.file = file, .dump = dump};
    struct dump_report report = {0};
    struct reason reason = {""}, why = {""};
    struct scene opened;
    enum status status = open_scene(file, spec, dump, &opened, &told.scene, &reason);
    if (status)
        return exit_with_reason("tree", status, &reason);
    const struct scene *scene = told.scene ? &opened : &dump->scene;
    told.has_scene = told.scene || scene->tri_count > 0;
    told.report = &report;
    status = dump_check(dump, told.has_scene ? scene : NULL, command->faults, true, &report, &why);
    if (status)
        (void)fail(&reason, status, "%s: %s", file_label(file), why.text);
    int code = status          ? exit_with_reason("tree", status, &reason)
               : report.faults ? EXIT_MISMATCH
                               : EXIT_AGREE;
    if (!status) {
        const struct screen screen = screen_make(&command->screen);
        tree_print(&told, &screen);
        fflush(stdout);
    }
    if (!status && command->json)
        code = exit_worse(
            code,
            exit_with_reason("tree", tree_write_json(command->json, &told, code, &why), &why));
    free(report.fault);
    scene_free(&opened);
    return code;
}

int cmd_tree(int argc, char **argv)
{
    struct tree_command command = {.format = DUMP_GUESSED};
    struct reason reason = {""};
    int first, code = options_read(&set, &command, argc, argv, &first);
    if (code >= 0)
        return code;
    if (first == argc)
        return usage_error("tree", "no file given");
    if (argc - first > 2)
        return usage_error("tree", "unexpected argument '%s'", argv[first + 2]);
    char *bytes;
    size_t size;
    struct tree_dump dump = {0};
    enum status status = file_read(argv[first], &bytes, &size, &reason);
    if (!status)
        status =
            tree_dump_read(file_label(argv[first]), bytes, size, command.format, &dump, &reason);
    free(bytes);
    code = status ? exit_with_reason("tree", status, &reason)
                  : tell(&command, argv[first], argc - first > 1 ? argv[first + 1] : NULL, &dump);
    tree_dump_free(&dump);
    return code;
}
