/* raydiff min: shrinks findings, one file or a folder of them. */
#define _POSIX_C_SOURCE 200809L
#include "cmd/fuzz/cmd_min.h"

#include "cmd/fuzz/cmd_replay.h"
#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_progress.h"
#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static enum status take_layouts(void *options, const struct option_value *given,
                                struct reason *reason)
{
    return list_bring_layouts(&((struct min_options *)options)->layout, given->text, reason);
}

enum status min_check_layouts(const struct min_options *options, const char *path,
                              min_is_on_fn *is_on, const void *user, struct reason *reason)
{
    for (size_t i = 0; i < options->layout.count; i++) {
        const struct layout *layout = layouts_all[options->layout.index[i]];
        if (!is_on(user, layout))
            return fail(reason, STATUS_INPUT, "--layout: no finding of %.200s is on %s", path,
                        layout->name);
    }
    return STATUS_OK;
}

#define ROWS_OF struct min_options

static const struct option_row rows[] = {
    {"out", "FILE", "of a FILE: write to this one, also if nothing smaller was found",
     OF_OUTPUT(out)},
    {"force", NULL, "replace NAME.min.trial if it exists", OF_FLAG(force)},
    {"asks", "N",
     "candidates that are played at most; one of many triangles or rays counts for more",
     OF_COUNT(asks, 1, UINT64_MAX / 2), .standard = SHRINK_ASKS},
    {"time", "S", "end after so many seconds; then the result is not the same everywhere",
     OF_COUNT(seconds, 1, 1000000)},
    {"trial-time", "S", "seconds that the engine may take for a trial",
     OF_COUNT(trial_seconds, 1, 86400), .value = "10"},
    {"memory", "MIB", "memory that it may hold, 0 is no limit", OF_COUNT(memory_mib, 0, 1u << 30),
     .value = "4096"},
    {"engine", "E,..",
     "brings pipe:COMMAND to a finding of pipe:PROGRAM, and PATH/FILE.so to one of FILE.so",
     OF_LIST(named, TABLE_ENGINES)},
    {"layout", "L,..", "brings FILE.so, a layout from outside, to findings on it",
     OF_OWN(take_layouts), .file = true, .repeats = true},
    {"threads", "N", "CPU threads, 0 is all; 1, since trials are small",
     OF_COUNT(engines.threads, 0, 4096), .value = "1"},
    {"json", "FILE", "results, for machines", OF_DATA(json)},
    {0},
};

static const struct option_set set = {
    .command = "min",
    .usage = "min FILE [OPTIONS]\n"
             "min DIR [OPTIONS]",
    .about =
        "Shrinks a finding (a .trial file) as long as it shows the same: engine, layout, kind and "
        "cause. Fewer triangles and rays, then shorter numbers and plainer members; the result is "
        "NAME.min.trial beside it. Of a folder of raydiff fuzz the smallest trial of each finding "
        "is replaced by a smaller one. The engine runs in a child process: crashes and hangs are "
        "shrunk, too.",
    .group = {GROUP(rows), GROUP_AT(engine_rows, engines), GROUP_AT(outside_rows, engines)},
    .codes = "0 done, 1 a finding does not show here and is left as it is, 2 bad input, 3 an "
             "engine cannot be opened, 4 internal error, 77 the engine cannot run here",
    .example = "min fuzz/corpus/slot-not-read.trial --out small.trial",
};

/* --- one finding ----------------------------------------------------------------------------- */

int min_check_use(const struct min_options *options, const struct list *engine)
{
    const struct option_use use = {.engine = engine, .layout = &options->layout, .compares = true};
    for (size_t i = 0; i < options->named.count; i++)
        if (!list_has(engine, options->named.index[i]))
            return usage_error("min", "--engine: not used here: no finding is of engine %s",
                               engines[options->named.index[i]]->name);
    return options_refused("min", &use);
}

static size_t text_bytes(const struct finding_file *file)
{
    char *bytes;
    size_t size;
    if (finding_file_print(file, &bytes, &size, NULL))
        return 0;
    free(bytes);
    return size;
}

static void show_progress(void *user, const struct shrink_stats *stats,
                          const struct fuzz_trial *best)
{
    (void)best;
    progress_step(user, "%u triangles, %u rays, %llu bits; %llu asks", stats->after.triangles,
                  stats->after.rays, (unsigned long long)stats->after.bits,
                  (unsigned long long)stats->asks);
}

static enum status check_row(struct min_row *row, struct reason *reason)
{
    const struct finding_file *file = &row->file;
    if (!file->has_signature)
        return fail(reason, STATUS_INPUT, "it expects 'clean': nothing is wrong with it to shrink");
    return replay_engine(file, &row->engine, reason);
}

static enum min_fate fate_of(const struct min_row *row, enum status status)
{
    if (status)
        return status == STATUS_UNSUPPORTED ? MIN_SKIPPED : MIN_FAILED;
    if (row->stats.end == SHRINK_NOT_SHOWN)
        return MIN_NOT_SHOWN;
    return row->stats.accepted ? MIN_SMALLER : MIN_SMALLEST;
}

void min_shrink(const struct min_options *options, struct min_row *row, enum status status)
{
    struct progress progress = progress_make("min");
    struct reason why;
    if (!status && (status = check_row(row, &why)))
        fail(&row->reason, status, "%.150s: %.160s", row->path, why.text);
    if (!status) {
        const struct shrink_apart how = {.who = {row->engine, row->file.signature.layout},
                                         .engines = options->engines,
                                         .ms = (uint32_t)options->trial_seconds * 1000,
                                         .memory = options->memory_mib << 20};
        const struct shrink_options shrink = {.asks = options->asks,
                                              .ns = options->seconds * 1000000000u,
                                              .progress = show_progress,
                                              .user = &progress};
        status =
            fuzz_shrink_apart(&how, &row->file, &shrink, &row->smaller, &row->stats, &row->reason);
        row->bytes_before = text_bytes(&row->file);
        row->bytes_after = status ? 0 : text_bytes(&row->smaller);
    }
    progress_end(&progress);
    row->fate = fate_of(row, status);
    row->code = row->fate == MIN_NOT_SHOWN ? EXIT_MISMATCH : exit_of_status(status);
}

void min_row_free(struct min_row *row)
{
    finding_file_free(&row->file);
    finding_file_free(&row->smaller);
}

/* --- one file -------------------------------------------------------------------------------- */

static bool ends_with(const char *text, const char *end)
{
    size_t length = strlen(text), end_length = strlen(end);
    return length >= end_length && strcmp(text + length - end_length, end) == 0;
}

/* Chooses the output: NAME.min.trial beside NAME.trial. A file already named NAME.min.trial is
 * resumed in place. Errors: STATUS_INPUT the name is too long, or the file exists. */
static enum status choose_out(const struct min_options *options, const char *path,
                              char out[MIN_PATH_MOST], struct reason *reason)
{
    struct stat there;
    size_t stem = strlen(path) - (ends_with(path, ".trial") ? strlen(".trial") : 0);
    bool again = ends_with(path, ".min.trial");
    int length = options->out ? snprintf(out, MIN_PATH_MOST, "%s", options->out)
                 : again      ? snprintf(out, MIN_PATH_MOST, "%s", path)
                              : snprintf(out, MIN_PATH_MOST, "%.*s.min.trial", (int)stem, path);
    if (length >= MIN_PATH_MOST)
        return fail(reason, STATUS_INPUT, "%.100s...: too long a name", path);
    bool here = !options->out && lstat(out, &there) == 0;
    if (here && S_ISLNK(there.st_mode))
        return fail(reason, STATUS_INPUT, "%.200s is a symbolic link: name a file with --out", out);
    if (here && !again && !options->force)
        return fail(reason, STATUS_INPUT, "%.200s is there already: --force or --out", out);
    return STATUS_OK;
}

static bool is_on(const void *user, const struct layout *layout)
{
    const struct min_row *row = user;
    return row->file.has_signature && row->file.signature.layout == layout;
}

static int min_file(const struct min_options *options, const char *path)
{
    struct min_row row = {0};
    struct reason reason;
    char out[MIN_PATH_MOST];
    if (strlen(path) >= sizeof row.path || choose_out(options, path, out, &reason))
        return usage_error("min", "%s",
                           strlen(path) >= sizeof row.path ? "too long a name" : reason.text);
    strcpy(row.path, path);
    enum status status = finding_file_read(row.path, &row.file, &row.reason);
    const struct engine *engine =
        !status && row.file.has_signature ? fuzz_signature_engine(&row.file.signature) : NULL;
    if (engine) {
        const struct list of = list_of_one(TABLE_ENGINES, engine);
        row.code = min_check_use(options, &of);
    }
    if (engine && row.code >= 0) {
        finding_file_free(&row.file);
        return row.code;
    }
    if (!status && min_check_layouts(options, path, is_on, &row, &reason)) {
        min_row_free(&row);
        return usage_error("min", "%s", reason.text);
    }
    min_shrink(options, &row, status);
    bool write = row.fate == MIN_SMALLER || (row.fate == MIN_SMALLEST && options->out);
    if (write) {
        status = finding_file_write(&row.smaller, out, &row.reason);
        if (status) {
            row.fate = MIN_FAILED;
            row.code = exit_of_status(status);
        } else {
            strcpy(row.written, out);
        }
    }
    min_print(&row);
    if (options->json) {
        status = min_write_json(options->json, &row, 1, row.code, &reason);
        row.code = exit_worse(row.code, exit_with_reason("min", status, &reason));
    }
    min_row_free(&row);
    return row.code;
}

int cmd_min(int argc, char **argv)
{
    struct min_options options = {.engines = engine_options_default()};
    struct stat what;
    int first, code = options_read(&set, &options, argc, argv, &first);
    if (code >= 0)
        return code;
    if (first + 1 != argc)
        return usage_error("min", first == argc ? "no file or folder given" : "one at a time");
    signal(SIGPIPE, SIG_IGN); /* a dead peer is detected by its missing answer */
    if (options.out && options.force)
        return usage_error("min", "--force: not used with --out, whose file is replaced");
    if (stat(argv[first], &what) != 0 || !S_ISDIR(what.st_mode))
        return min_file(&options, argv[first]);
    if (options.out || options.force)
        return usage_error("min", "--out and --force are for a file");
    return min_folder(&options, argv[first]);
}
