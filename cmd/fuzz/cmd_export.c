/* raydiff export: a finding as something that runs without raydiff. */
#include "fuzz/export/export.h"
#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"
#include "ref/files/file.h"

#include <string.h>

static const char help[] =
    "usage: raydiff export FILE [OPTIONS]\n"
    "Writes a finding (a .trial file) as something that a driver's maker can run without raydiff:\n"
    "the shader, the bytes of the tree, triangles and rays, what is right and with which "
    "tolerance.\n\n"
    "  --to OUT        file to write, '-' is the standard output                [-]\n"
    "  --form F        c: a program; exit code 0 fixed, 1 the bug shows, 2 cannot run here\n"
    "                  amber: a script of github.com/google/amber (vulkan, vulkan_brute)\n"
    "                  text: scene, rays and right answers, for any tracer           [c]\n"
    "  --engine E      for vulkan, vulkan_brute, rayquery, embree or embree_robust\n"
    "                                                   [the file's; else vulkan]\n"
    "  --layout L      its tree's layout                [the file's; else f32]\n"
    "  --ray N         this ray alone                   [all]\n" ENGINE_OPTIONS_HELP
    "\nexit codes: 0 written, 2 bad input, or nothing that anybody else could run\n"
    "example: raydiff export fuzz/corpus/rounded-inward.trial --engine vulkan --to finding.c\n"
    "         cc finding.c -lvulkan -o finding && ./finding\n";

enum { OPT_TO = 256, OPT_FORM, OPT_ENGINE, OPT_LAYOUT, OPT_RAY };

static const struct option long_options[] = {
    {"to", 1, NULL, OPT_TO},         {"form", 1, NULL, OPT_FORM}, {"engine", 1, NULL, OPT_ENGINE},
    {"layout", 1, NULL, OPT_LAYOUT}, {"ray", 1, NULL, OPT_RAY},   ENGINE_OPTIONS};

struct taken {
    struct export_options options;
    const char *to;
};

static void print_help(void)
{
    fputs(help, stdout);
}

static enum status take_option(void *user, int option, char *text, struct reason *reason)
{
    struct taken *taken = user;
    struct export_options *o = &taken->options;
    enum status status = STATUS_OK;
    uint64_t value = 0;
    size_t index = 0;
    switch (option) {
    case OPT_TO:
        taken->to = text;
        return STATUS_OK;
    case OPT_FORM:
        if (export_form_find(text, &o->form))
            return STATUS_OK;
        return fail(reason, STATUS_INPUT, "--form: '%s' is not c, amber or text", text);
    case OPT_ENGINE:
        status = table_parse_one(TABLE_ENGINES, "--engine", text, &index, reason);
        o->engine = status ? NULL : engines[index];
        return status;
    case OPT_LAYOUT:
        status = table_parse_one(TABLE_LAYOUTS, "--layout", text, &index, reason);
        o->layout = status ? NULL : layouts_all[index];
        return status;
    case OPT_RAY:
        status = parse_count("--ray", text, 0, FUZZ_RAYS_MOST, &value, reason);
        o->ray = (uint32_t)value;
        return status;
    default:
        return engine_option_take(option, text, &o->engines, reason);
    }
}

static int complain(const char *path, enum status status, const struct reason *reason)
{
    fprintf(stderr, "raydiff export: %s%s%s\n", path, *path ? ": " : "", reason->text);
    return exit_of_status(status);
}

/* What the writer learned goes to the standard error, a line each. */
static void print_said(const char *path, const struct export_said *said)
{
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
        return complain("", status, &reason);
    status = export_write(file, &options, standard ? stdout : out.stream, &said, &reason);
    if (status) {
        file_out_discard(&out);
        return complain(path, status, &reason);
    }
    if (!standard)
        status = file_out_commit(&out, &reason);
    else if (fflush(stdout) != 0 || ferror(stdout))
        status = fail(&reason, STATUS_INPUT, "cannot write to the standard output");
    if (status)
        return complain("", status, &reason);
    print_said(path, &said);
    return EXIT_AGREE;
}

/* Only such are asked here, and written with what they were given. */
static bool is_vendors(const struct engine *engine)
{
    return engine && (engine->gpu || strncmp(engine->name, "embree", 6) == 0);
}

/* What was named that this file's engine does not use. -1: nothing. */
static int check_use(const struct export_options *o, const struct finding_file *file)
{
    const struct engine *engine = o->engine             ? o->engine
                                  : file->has_signature ? engine_find(file->signature.engine)
                                                        : engine_find("vulkan");
    const struct list list = engine ? list_of_engine(engine)
                                    : (struct list){.count = 0}; /* of a peer that is not here */
    const struct option_use use = {
        .by = "export", .never = "peer-time peer-memory shader", .engine = &list};
    const struct option_use ours = {.by = "an export of no vendor's engine",
                                    .never = is_vendors(engine) ? "" : "layout threads"};
    int code = options_refused("export", &use);
    return code < 0 ? options_refused("export", &ours) : code;
}

int cmd_export(int argc, char **argv)
{
    struct taken taken = {.options = {.ray = EXPORT_ALL_RAYS, .engines = engine_options_default()},
                          .to = "-"};
    struct finding_file file;
    struct reason reason;
    int first;
    int code =
        options_take("export", print_help, long_options, take_option, &taken, argc, argv, &first);
    if (code >= 0)
        return code;
    if (first + 1 != argc)
        return usage_error("export", first == argc ? "no file given" : "one file at a time");
    enum status status = finding_file_read(argv[first], &file, &reason);
    if (status)
        return complain("", status, &reason);
    code = check_use(&taken.options, &file);
    if (code < 0)
        code = write_file(argv[first], &taken, &file);
    finding_file_free(&file);
    return code;
}
