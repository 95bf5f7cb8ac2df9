#define _POSIX_C_SOURCE 200809L /* fdopen, strdup */
#include "cmd/common/cmd_options.h"

#include "ref/outside/plugin_guard.h"
#include "ref/outside/plugin_shader.h"
#include "ref/base/command.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum status engine_option_take(int option, const char *text, struct engine_options *out,
                               struct reason *reason)
{
    uint64_t n = 0;
    enum status status = STATUS_OK;
    switch (option) {
    case OPT_THREADS:
        status = parse_count("--threads", text, 0, 4096, &n, reason);
        out->threads = (uint32_t)n;
        return status;
    case OPT_DEVICE:
        status = parse_count("--device", text, 0, 255, &n, reason);
        out->device = (int)n;
        return status;
    case OPT_WORKGROUP:
        status = parse_count("--workgroup", text, 1, 1024, &n, reason);
        out->workgroup = (uint32_t)n;
        return status;
    case OPT_PEER_TIME:
        status = parse_count("--peer-time", text, 1, 86400, &n, reason);
        out->peer_ms = (uint32_t)(1000 * n);
        plugin_limits(out->peer_ms, out->peer_mb);
        return status;
    case OPT_PEER_MEMORY:
        status = parse_count("--peer-memory", text, 0, 1u << 24, &n, reason);
        out->peer_mb = n ? (uint32_t)n : UINT32_MAX;
        plugin_limits(out->peer_ms, out->peer_mb);
        return status;
    case OPT_SHADER:
        return plugin_shader_take(text, reason);
    case OPT_DRIVER:
        out->driver = text;
        return STATUS_OK;
    default:
        return fail(reason, STATUS_INPUT, "unknown option");
    }
}

enum status demand_take(int option, const char *text, struct match_demands *out,
                        struct reason *reason)
{
    if (option == OPT_DEMAND) {
        out->watertight = true;
        return strcmp(text, "watertight") == 0
                   ? STATUS_OK
                   : fail(reason, STATUS_INPUT, "--require: '%.60s' is not watertight", text);
    }
    enum status status = parse_float("--displacement", text, &out->displacement, reason);
    if (!status && !(out->displacement > 0.0f && float_is_finite(out->displacement)))
        return fail(reason, STATUS_INPUT, "--displacement %.60s: it is above 0", text);
    return status;
}

static enum status take_optimize(const char *text, struct build_options *out, struct reason *reason)
{
    static const char name[] = "reinsert";
    uint64_t n = BUILD_PASSES_DEFAULT;
    enum status status = STATUS_OK;
    if (strncmp(text, name, sizeof name - 1) != 0 || !strchr("=", text[sizeof name - 1]))
        return fail(reason, STATUS_INPUT, "--optimize: '%.60s' is not reinsert or reinsert=N",
                    text);
    if (text[sizeof name - 1] == '=')
        status = parse_count("--optimize", text + sizeof name, 1, 1000, &n, reason);
    out->passes = (uint32_t)n;
    return status;
}

/* 0 is none, which the options have as a number below 0, since their 0 is the default. */
static enum status take_share(const char *name, const char *text, float most, float *out,
                              struct reason *reason)
{
    float x = 0;
    enum status status = parse_float(name, text, &x, reason);
    if (!status && !(x >= 0 && x <= most))
        status = fail(reason, STATUS_INPUT, "%s: '%.60s' is not a number from 0 to %g", name, text,
                      (double)most);
    *out = x > 0 ? x : -1;
    return status;
}

enum status build_option_take(int option, const char *text, struct build_options *out,
                              const char **flag, struct reason *reason)
{
    const char *name = option == OPT_BINS           ? "--bins"
                       : option == OPT_RADIUS       ? "--radius"
                       : option == OPT_SPLIT_BUDGET ? "--split-budget"
                       : option == OPT_SPLIT_ALPHA  ? "--split-alpha"
                                                    : "--optimize";
    uint64_t n = 0;
    enum status status;
    if (flag)
        *flag = name;
    if (option == OPT_OPTIMIZE)
        return take_optimize(text, out, reason);
    if (option == OPT_SPLIT_BUDGET)
        return take_share(name, text, BUILD_SPLIT_BUDGET_MOST, &out->split_budget, reason);
    if (option == OPT_SPLIT_ALPHA)
        return take_share(name, text, 1, &out->split_alpha, reason);
    if (option == OPT_BINS) {
        status = parse_count(name, text, 2, BUILD_BINS_MOST, &n, reason);
        out->bins = (uint32_t)n;
    } else {
        status = parse_count(name, text, 1, BUILD_RADIUS_MOST, &n, reason);
        out->radius = (uint32_t)n;
    }
    return status;
}

/* What was the standard output, once an option has asked for it. */
static FILE *aside;

enum status output_aside(struct reason *reason)
{
    if (aside)
        return fail(reason, STATUS_INPUT, "--csv and --json cannot both be '-'");
    fflush(stdout);
    int kept = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0);
    aside = kept < 0 ? NULL : fdopen(kept, "w");
    if (aside && dup2(STDERR_FILENO, STDOUT_FILENO) >= 0)
        return STATUS_OK;
    return fail(reason, STATUS_INPUT, "-: cannot write to the standard output");
}

/* An option's value is "-". False: it may not be. */
static bool take_dash(const char *name, struct reason *reason)
{
    static const char *const whole_files[] = {"out",   "svg",      "junit", "tap",
                                              "jsonl", "markdown", "html"};
    for (size_t i = 0; i < ARRAY_COUNT(whole_files); i++)
        if (strcmp(name, whole_files[i]) == 0)
            return !fail(reason, STATUS_INPUT, "--%s: needs a file, not '-'", name);
    if (strcmp(name, "json") != 0 && strcmp(name, "csv") != 0)
        return true; /* the command says what it is */
    return output_aside(reason) == STATUS_OK;
}

enum status options_out(const char *path, struct file_out *out, struct reason *reason)
{
    if (strcmp(path, "-") != 0)
        return file_out_open(path, out, reason);
    *out = (struct file_out){.stream = aside, .path = strdup("the standard output")};
    aside = NULL;
    if (out->stream && out->path)
        return STATUS_OK;
    file_out_discard(out);
    return fail(reason, STATUS_INPUT, "-: cannot write to the standard output");
}

/* Options whose value is a file that is written at the end. Others that write are left to their
 * commands: what they name may be a folder, or the beginning of several names. */
static bool is_output(const char *name)
{
    static const char *const names[] = {"json", "csv",   "svg",      "junit",
                                        "tap",  "jsonl", "markdown", "html"};
    for (size_t i = 0; i < ARRAY_COUNT(names); i++)
        if (strcmp(name, names[i]) == 0)
            return true;
    return false;
}

enum status output_try(const char *path, struct reason *reason)
{
    struct file_out out;
    struct stat what;
    if (!path || strcmp(path, "-") == 0 ||
        (stat(path, &what) == 0 && !S_ISREG(what.st_mode) && !S_ISDIR(what.st_mode)))
        return STATUS_OK; /* a reader of a pipe would see it end */
    enum status status = file_out_open(path, &out, reason);
    file_out_discard(&out);
    return status;
}

#define GIVEN_MOST   128 /* more than any table has */
#define OUTPUTS_MOST 16

/* Names of a table, which outlives the command. */
static const char *given[GIVEN_MOST];
static size_t given_count;

/* The outputs that were named, tried when all options are known to be right. */
static const char *outputs[OUTPUTS_MOST];
static size_t output_count;

void options_begin(void)
{
    given_count = output_count = 0;
}

const char *option_given(size_t i)
{
    return i < given_count ? given[i] : NULL;
}

bool option_was_given(const char *name)
{
    for (size_t i = 0; i < given_count; i++)
        if (strcmp(given[i], name) == 0)
            return true;
    return false;
}

enum status option_note(const char *name, bool repeats, struct reason *reason)
{
    if (option_was_given(name))
        return repeats ? STATUS_OK : fail(reason, STATUS_INPUT, "--%s: is given twice", name);
    if (given_count < GIVEN_MOST)
        given[given_count++] = name;
    return STATUS_OK;
}

void output_note(const char *path)
{
    if (path && output_count < OUTPUTS_MOST)
        outputs[output_count++] = path;
}

enum status outputs_try(struct reason *reason)
{
    enum status status = STATUS_OK;
    for (size_t i = 0; i < output_count && !status; i++)
        status = output_try(outputs[i], reason);
    return status;
}

int option_error(const char *command, enum status status, const struct reason *reason)
{
    int code = usage_error(command, "%s", reason->text);
    return status == STATUS_DEVICE ? EXIT_ENGINE : code;
}

/* getopt takes the beginning of a name for it: then another option is meant, perhaps. True if what
 * was typed is the whole name. */
static bool is_whole(char *const *argv, const char *name)
{
    const bool apart = optarg && argv[optind - 1] == optarg;
    const char *typed = argv[optind - (apart ? 2 : 1)] + strlen("--");
    const size_t length = strlen(name);
    return strncmp(typed, name, length) == 0 && (typed[length] == '\0' || typed[length] == '=');
}

int options_take(const char *command, void (*print_help)(void), const struct option *table,
                 option_fn *take, void *user, int argc, char **argv, int *first)
{
    struct reason reason;
    int option, index = 0;
    options_begin();
    opterr = 0; /* the message is ours */
    optind = 1;
    while ((option = getopt_long(argc, argv, "h", table, &index)) != -1) {
        if (option == OPT_HELP || option == 'h') {
            print_help();
            return EXIT_AGREE;
        }
        if (option == '?')
            return usage_error(command, "unknown option or missing value: '%s'", argv[optind - 1]);
        if (!is_whole(argv, table[index].name))
            return usage_error(command, "unknown option: '%s'; --%s is one",
                               argv[optind - (optarg && argv[optind - 1] == optarg ? 2 : 1)],
                               table[index].name);
        if (optarg && strcmp(optarg, "-") == 0 && !take_dash(table[index].name, &reason))
            return usage_error(command, "%s", reason.text);
        enum status status = option_note(table[index].name, true, &reason);
        if (!status)
            status = take(user, option, optarg, &reason);
        if (status)
            return option_error(command, status, &reason);
        if (optarg && is_output(table[index].name))
            output_note(optarg);
    }
    *first = optind;
    enum status status = plugin_shader_settle(&reason);
    if (!status && strcmp(command, "fuzz") != 0) /* which makes the folder that they may be in */
        status = outputs_try(&reason);
    return status ? option_error(command, status, &reason) : -1;
}
