/* raydiff export: writes a finding as a file that runs without raydiff. */
#include "fuzz/export/export.h"
#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_use.h"
#include "cmd/common/cmd_screen.h"
#include "ref/base/command.h"
#include "ref/base/text.h"
#include "ref/files/file.h"

#include <string.h>

struct taken {
    struct export_options options;
    const char *to;
};

#define ROWS_OF struct taken

static const struct option_row rows[] = {
    {"to", "OUT", "file to write, '-' is the standard output", OF_TEXT(to), .value = "-",
     .file = true},
    {"form", "F",
     "c: a program; exit code 0 fixed, 1 the bug shows, 2 cannot run here. amber: a script of "
     "github.com/google/amber (vulkan, vulkan_brute). text: scene, rays and right answers, for "
     "any tracer",
     OF_CHOICE(options.form, export_form_names), .value = "c"},
    {"engine", "E", "for vulkan, vulkan_brute, rayquery, embree or embree_robust",
     OF_MEMBER(options.engine, TABLE_ENGINES), .shown = "the file's; else vulkan"},
    {"layout", "L",
     "its tree's layout; FILE.so, one from outside, also where the finding is on it and no tree is "
     "written",
     OF_MEMBER(options.layout, TABLE_LAYOUTS), .shown = "the file's; else f32"},
    {"ray", "N", "this ray alone", OF_COUNT(options.ray, 0, FUZZ_RAYS_MOST), .shown = "all"},
    {0},
};

static const struct option_set set = {
    .command = "export",
    .usage = "export FILE [OPTIONS]",
    .about = "Writes a finding (a .trial file) as something that a driver's maker can run without "
             "raydiff: the shader, the bytes of the tree, triangles and rays, what is right and "
             "with which tolerance.",
    .group = {GROUP(rows), GROUP_AT(engine_rows, options.engines)},
    .codes = "0 written, 2 bad input, or nothing that can run outside raydiff",
    .example = "export fuzz/corpus/sentinel.trial --engine vulkan --to x.c\n"
               "         cc x.c -lvulkan -o x && ./x",
};

/* Prints what was written and the writer's remarks: for a file one line, else to standard error,
 * one per line. */
static void print_said(const char *path, const char *to, const struct export_said *said)
{
    if (to) {
        char line[2 * sizeof said->text] = "";
        for (const char *at = said->text; *at;) {
            const size_t length = strcspn(at, "\n");
            text_append(line, sizeof line, "%s%.*s", at > said->text ? "; " : "", (int)length, at);
            at += length + (at[length] == '\n');
        }
        screen_line(4, "wrote %s%s%s\n", to, line[0] ? ", but " : "", line);
        return;
    }
    for (const char *at = said->text; *at;) {
        size_t length = strcspn(at, "\n");
        fprintf(stderr, "raydiff export: %s: %.*s\n", path, (int)length, at);
        at += length + (at[length] == '\n');
    }
}

static int write_file(const char *path, const struct taken *taken, const struct finding_file *file)
{
    struct file_out out = {0};
    struct export_said said;
    struct reason reason;
    struct export_options options = taken->options;
    bool standard = strcmp(taken->to, "-") == 0;
    const char *slash = strrchr(taken->to, '/');
    options.name = standard ? NULL : slash ? slash + 1 : taken->to;
    enum status status = standard ? STATUS_OK : file_out_open(taken->to, &out, &reason);
    if (status)
        return exit_with_reason("export", status, &reason);
    status = export_write(file, &options, standard ? stdout : out.stream, &said, &reason);
    if (status) {
        file_out_discard(&out);
        fprintf(stderr, "raydiff export: %s: %s\n", path, reason.text);
        return exit_of_status(status);
    }
    if (!standard)
        status = file_out_commit(&out, &reason);
    if (!status)
        print_said(path, standard ? NULL : taken->to, &said);
    return exit_with_reason("export", status, &reason);
}

/* Only these engines run during an export, and only their options are written. */
static bool is_vendors(const struct engine *engine)
{
    return engine && (engine->gpu || engine->library);
}

/* Rejects options that the file's engine does not use. Returns -1 if there are none. */
static int check_use(const struct export_options *o, const struct finding_file *file)
{
    const struct engine *engine = o->engine             ? o->engine
                                  : file->has_signature ? engine_find(file->signature.engine)
                                                        : engine_find("vulkan");
    struct list list = list_of_one(TABLE_ENGINES, engine); /* empty: the peer is not loaded */
    const bool brings = o->layout && o->layout->outside;   /* without it the file is not read */
    if (brings && !list_needs_trees(&list))
        list_add(&list, TABLE_ENGINES, engine_reference(true));
    const struct option_use use = {.engine = &list};
    const struct option_use ours = {.by = "an export of no vendor's engine",
                                    .never = is_vendors(engine) ? ""
                                             : brings           ? "threads"
                                                                : "layout threads"};
    int code = options_refused("export", &use);
    return code < 0 ? options_refused("export", &ours) : code;
}

int cmd_export(int argc, char **argv)
{
    struct taken taken = {.options = {.ray = EXPORT_ALL_RAYS, .engines = engine_options_default()}};
    struct finding_file file;
    struct reason reason;
    int first, code = options_read(&set, &taken, argc, argv, &first);
    if (code >= 0)
        return code;
    if (first + 1 != argc)
        return usage_error("export", first == argc ? "no file given" : "one file at a time");
    enum status status = finding_file_read(argv[first], &file, &reason);
    if (status)
        return exit_with_reason("export", status, &reason);
    code = check_use(&taken.options, &file);
    if (code < 0)
        code = write_file(argv[first], &taken, &file);
    finding_file_free(&file);
    return code;
}
