/* raydiff replay: plays findings again, with the engines in a child process. */
#define _POSIX_C_SOURCE 200809L
#include "cmd/fuzz/cmd_replay.h"

#include "gpu/build/device_builders.h"
#include "ref/outside/pipe.h"
#include "ref/outside/shared_object.h"
#include "cmd/common/cmd_outside.h"
#include "cmd/common/cmd_rows.h"
#include "cmd/common/cmd_use.h"
#include "ref/base/command.h"

#include <stdlib.h>
#include <string.h>

#define ROWS_OF struct replay_options

static const struct option_row rows[] = {
    {"engine", "E,..",
     "these engines; the signature's engine then does not matter, and for one that walks no tree "
     "neither do its layout and cause",
     OF_LIST(engine, TABLE_ENGINES), .shown = "all"},
    {"layout", "L,..", "these layouts", OF_LIST(layout, TABLE_LAYOUTS),
     .shown = "the signature's; else f32,rf16"},
    {"time", "S", "seconds that an engine may take for a file", OF_COUNT(seconds, 1, 86400),
     .value = "60"},
    {"brief", NULL, "a line per file, and what was not expected; no explanation", OF_FLAG(brief)},
    {"as-expected", NULL, "succeed if each file shows exactly what it expects",
     OF_FLAG(as_expected)},
    {"json", "FILE", "results, for machines", OF_DATA(json)},
    {0},
};

static const struct option_set set = {
    .command = "replay",
    .usage = "replay FILE... [OPTIONS]",
    .about = "Plays findings (.trial files of raydiff fuzz, or regressions) again, on all engines, "
             "and prints whether what a file expects is still there: its signature, or of a clean "
             "one anything wrong. Every engine runs in a child process; one that crashes or hangs "
             "is reported.",
    .group = {GROUP(rows), GROUP_AT(engine_rows, engines), GROUP_AT(outside_rows, engines),
              GROUP_AT(screen_rows, screen)},
    .codes = "0 no file fails any more, 1 one still fails, 2 bad input, 3 an engine crashed or "
             "hung where that was not expected, 77 the file's engine cannot run here",
    .example = "replay fuzz/corpus/rounded-inward.trial",
};

bool replay_is_expected(const struct replay_options *options, const struct finding_file *file,
                        const struct fuzz_signature *found)
{
    const struct fuzz_signature *want = &file->signature;
    if (!file->has_signature)
        return true;
    /* A cause within a layout is none of an engine that has no layout: the kind is what is left. */
    if (options->any_engine && want->layout && !found->layout)
        return want->kind == found->kind;
    return want->kind == found->kind && want->cause == found->cause &&
           (options->any_engine || strcmp(want->engine, found->engine) == 0) &&
           (options->layout.count > 0 || want->layout == found->layout);
}

/* True if the contestant is the one named by the signature, or stands in for it. */
static bool is_wanted(const struct replay_options *options, const struct finding_file *file,
                      const struct fuzz_contestant *who)
{
    struct fuzz_signature mine = file->signature;
    fuzz_signature_set_engine(&mine, who->engine->name);
    mine.layout = who->layout;
    return replay_is_expected(options, file, &mine);
}

/* The layouts to play a file on: those of --layout, the signature's, or all except those as
 * published. */
static struct list choose_layouts(const struct replay_options *options,
                                  const struct finding_file *file)
{
    struct list list = {.count = 0};
    if (options->layout.count > 0)
        return options->layout;
    if (file->has_signature && file->signature.layout)
        return list_of_one(TABLE_LAYOUTS, file->signature.layout);
    for (size_t i = 0; layouts[i]; i++)
        if (!layouts[i]->faithful)
            list_add(&list, TABLE_LAYOUTS, layouts[i]);
    return list;
}

static bool has_died(const struct replay_played *played)
{
    return played->fate == REPLAY_CRASHED || played->fate == REPLAY_HUNG;
}

/* A crash or hang has no ray and no cause. A peer that dies before the first request may have been
 * recorded as a protocol error. */
static bool died_as_expected(const struct replay_options *options, const struct finding_file *file,
                             const struct replay_played *played)
{
    bool hung = played->fate == REPLAY_HUNG;
    enum fuzz_kind kind = file->signature.kind;
    bool alike = kind == (hung ? FUZZ_KIND_HANG : FUZZ_KIND_CRASH) || kind == FUZZ_KIND_PROTOCOL;
    return file->has_signature && alike && is_wanted(options, file, &played->who);
}

/* True if an engine died, or a tracer's answers ended, where the file does not say so. */
static bool died_unexpectedly(const struct replay_options *options, const struct finding_file *file,
                              const struct replay_played *played)
{
    bool died = has_died(played) && !played->crashed_as_expected;
    for (size_t i = 0; i < played->finding_count; i++) {
        const struct fuzz_signature *found = &played->finding[i].signature;
        bool ended = found->kind == FUZZ_KIND_HANG || found->kind == FUZZ_KIND_CRASH ||
                     found->kind == FUZZ_KIND_PROTOCOL;
        died =
            died || (ended && (!file->has_signature || !replay_is_expected(options, file, found)));
    }
    return died;
}

static int code_of(const struct replay_options *options, struct replay_file *file)
{
    bool wanted_played = false;
    int code = EXIT_AGREE;
    for (size_t i = 0; i < file->played_count; i++) {
        const struct replay_played *played = &file->played[i];
        if (died_unexpectedly(options, &file->file, played))
            code = exit_worse(code, EXIT_ENGINE);
        if (played->fate == REPLAY_FAILED)
            code = exit_worse(code, EXIT_INTERNAL);
        if (played->fate == REPLAY_REFUSED && is_wanted(options, &file->file, &played->who))
            file->refused = true;
        if (played->fate != REPLAY_SKIPPED && played->fate != REPLAY_REFUSED &&
            (!file->file.has_signature || is_wanted(options, &file->file, &played->who)))
            wanted_played = true;
    }
    file->refused = file->refused && !wanted_played;
    if (!wanted_played)
        return exit_worse(code, file->refused ? EXIT_MISMATCH : EXIT_SKIPPED);
    bool bad = options->as_expected ? file->fails != file->file.has_signature : file->fails;
    return bad ? exit_worse(code, EXIT_MISMATCH) : code;
}

static void play_file(struct replay_worker *worker, size_t i)
{
    const struct replay_options *options = worker->options;
    struct replay_file *file = &worker->files[i];
    const struct list layouts_of = choose_layouts(options, &file->file);
    const struct engine *engine[LIST_MOST];
    const struct layout *layout[LIST_MOST];
    struct fuzz_field field;
    struct reason reason;
    list_engines(&options->engine, engine);
    list_layouts(&layouts_of, layout);
    if (fuzz_field_make(engine, options->engine.count, layout, layouts_of.count, &options->engines,
                        &field, &reason)) {
        file->code = usage_error("replay", "%s", reason.text);
        return;
    }
    for (size_t k = 0; k < field.count; k++) {
        struct replay_played *played = &file->played[file->played_count++];
        *played = (struct replay_played){.who = field.who[k]};
        replay_play(worker, i, played);
        played->expected = 0;
        while (
            played->expected < played->finding_count &&
            !replay_is_expected(options, &file->file, &played->finding[played->expected].signature))
            played->expected++;
        played->crashed_as_expected =
            has_died(played) && died_as_expected(options, &file->file, played);
        if (played->crashed_as_expected || played->expected < played->finding_count)
            file->fails = true;
    }
    replay_versions(worker, i);
    file->code = code_of(options, file);
}

/* True if the finding has a ray that can be explained. */
static bool has_page(const struct fuzz_finding *finding)
{
    enum fuzz_kind kind = finding->signature.kind;
    return kind <= FUZZ_KIND_BITS || kind == FUZZ_KIND_UNFINISHED;
}

/* Prints the page of the first finding that the file expects, or of the first finding if it is a
 * clean one. */
static void print_page(struct replay_worker *worker, size_t i)
{
    const struct replay_file *file = &worker->files[i];
    for (size_t k = 0; k < file->played_count; k++) {
        const struct replay_played *played = &file->played[k];
        for (size_t n = played->expected; n < played->finding_count; n++)
            if (has_page(&played->finding[n]) &&
                replay_is_expected(worker->options, &file->file, &played->finding[n].signature)) {
                replay_page(worker, i, &played->who, played->finding[n].ray);
                return;
            }
    }
}

/* Reads all files before playing any. Returns the exit code. */
static int read_files(char **path, size_t count, struct replay_file *files)
{
    int code = EXIT_AGREE;
    for (size_t i = 0; i < count; i++) {
        struct reason reason;
        files[i].path = path[i];
        enum status status = finding_file_read(path[i], &files[i].file, &reason);
        code = exit_worse(code, exit_with_reason("replay", status, &reason));
    }
    return code;
}

enum status replay_engine(const struct finding_file *file, const struct engine **out,
                          struct reason *reason)
{
    *out = fuzz_signature_engine(&file->signature);
    if (*out)
        return STATUS_OK;
    const char *name = file->signature.engine, *object = file_of_engine(name);
    if (outside_is_known(name))
        return outside_engine(name, out, reason);
    return fail(reason, STATUS_INPUT, "engine '%s' is not available%s", name,
                object && !object_of_engine(name) ? "; name its file: --engine shader:PATH"
                : object && object != name        ? "; name its file: --engine inside:PATH/FILE.so"
                : object                          ? "; name its file: --engine PATH/FILE.so"
                : pipe_is_peer(name)              ? "; name its command: --engine 'pipe:COMMAND'"
                                                  : "");
}

/* Without --engine the signature's engine must be available. */
static int check_engine(const struct replay_options *options, const struct replay_file *file)
{
    const struct engine *engine;
    struct reason reason;
    if (!file->file.has_signature || options->any_engine ||
        !replay_engine(&file->file, &engine, &reason))
        return EXIT_AGREE;
    return usage_error("replay", "%s: %s", file->path, reason.text);
}

static void count_turnout(const struct replay_file *file, struct turnout *turnout)
{
    for (size_t i = 0; i < file->played_count; i++) {
        const struct replay_played *played = &file->played[i];
        enum turnout_end end = TURNOUT_FAILED;
        if (played->fate == REPLAYED || played->crashed_as_expected)
            end = TURNOUT_ANSWERED;
        else if (played->fate == REPLAY_SKIPPED)
            end = TURNOUT_ABSENT;
        else if (played->fate == REPLAY_REFUSED)
            end = played->who.layout ? TURNOUT_SKIPPED : TURNOUT_REFUSED;
        turnout_add(turnout, "engine", played->who.engine->name, end, 1, played->reason);
    }
}

static int replay_all(const struct replay_options *options, struct replay_file *files, size_t count,
                      struct turnout *turnout)
{
    struct replay_worker worker = {.options = options, .files = files};
    const struct screen screen = screen_make(&options->screen);
    int code = EXIT_AGREE;
    if (options->any_engine && !options->engine.all && !options->engine.every)
        list_expect(TABLE_ENGINES, &options->engine, turnout);
    for (size_t i = 0; i < count; i++) {
        play_file(&worker, i);
        replay_print(&screen, options->brief, &files[i]);
        fflush(stdout); /* the child prints the page to the same stream */
        if (!options->brief)
            print_page(&worker, i);
        count_turnout(&files[i], turnout);
        code = exit_worse(code, files[i].code);
    }
    replay_end(&worker);
    if (!options->brief || turnout_exit(turnout))
        turnout_print(turnout, &screen);
    return exit_worse(code, turnout_exit(turnout));
}

int cmd_replay(int argc, char **argv)
{
    struct replay_options options = {.engine = table_all(TABLE_ENGINES),
                                     .engines = engine_options_default()};
    struct reason reason;
    int first, code = options_read(&set, &options, argc, argv, &first);
    if (code >= 0)
        return code;
    if (first == argc)
        return usage_error("replay", "no file given");
    options.any_engine = option_was_given("engine");
    const struct option_use use = {
        .engine = &options.engine, .layout = &options.layout, .unnamed = !options.any_engine};
    device_builders_use(&options.engines);
    code = options_refused("replay", &use);
    if (code >= 0)
        return code;
    size_t count = (size_t)(argc - first);
    struct replay_file *files = alloc_zeroed(count, sizeof *files);
    if (!files) {
        fputs("raydiff replay: out of memory\n", stderr);
        return EXIT_INTERNAL;
    }
    code = read_files(argv + first, count, files);
    for (size_t i = 0; i < count && code == EXIT_AGREE; i++)
        code = check_engine(&options, &files[i]);
    if (!options.any_engine)
        options.engine = table_all(TABLE_ENGINES); /* with those that files brought */
    if (code == EXIT_AGREE) {
        static struct turnout turnout;
        code = replay_all(&options, files, count, &turnout);
        if (options.json) {
            enum status status =
                replay_write_json(options.json, files, count, &turnout, code, &reason);
            code = exit_worse(code, exit_with_reason("replay", status, &reason));
        }
    }
    for (size_t i = 0; i < count; i++)
        finding_file_free(&files[i].file);
    free(files);
    return code;
}
