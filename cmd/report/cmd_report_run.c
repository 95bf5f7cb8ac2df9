/* The child processes of raydiff report. Each runs a sub-command, so that one that crashes or hangs
 * only adds a line to the report; its output goes to a file. */
#define _GNU_SOURCE /* strsignal */
#include "cmd/report/cmd_report.h"

#include "ref/outside/child.h"
#include "ref/base/command.h"
#include "ref/files/file.h"
#include "ref/files/temporary.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LOOK_MS   200u  /* time between checks of progress and signals */
#define END_MS    5000u /* time for a child to exit after it answered */
#define PATH_MOST 4096

static volatile sig_atomic_t stop_signal;

static void on_signal(int number)
{
    stop_signal = number;
}

int runner_signal(void)
{
    return stop_signal;
}

/* --- lines -------------------------------------------------------------------------------- */

static void take_word(struct line *line, const char *word)
{
    char *mine = line->argc < LINE_WORDS - 1 ? strdup(word) : NULL;
    if (mine)
        line->argv[line->argc++] = mine;
}

void line_begin(struct line *line, const char *command)
{
    *line = (struct line){.text = "raydiff"};
    line_word(line, command);
}

void line_word(struct line *line, const char *word)
{
    take_word(line, word);
    command_word(line->text, sizeof line->text, word);
}

void line_file(struct line *line, const struct runner *runner, const char *name)
{
    char path[PATH_MOST];
    runner_path(runner, name, path, sizeof path);
    take_word(line, path);
    command_word(line->text, sizeof line->text, name);
}

void line_free(struct line *line)
{
    for (int i = 0; i < line->argc; i++)
        free(line->argv[i]);
    line->argc = 0;
}

/* --- the folder --------------------------------------------------------------------------- */

void runner_path(const struct runner *runner, const char *name, char *path, size_t path_bytes)
{
    snprintf(path, path_bytes, "%s/%s", runner->folder, name);
}

enum status runner_open(struct runner *runner, struct reason *reason)
{
    static const int stopping[] = {SIGINT, SIGTERM, SIGHUP};
    const struct sigaction action = {.sa_handler = on_signal};
    const char *parent = getenv("TMPDIR");
    if (!parent || !parent[0])
        parent = "/tmp";
    for (size_t i = 0; i < ARRAY_COUNT(stopping); i++)
        sigaction(stopping[i], &action, NULL);
    runner->held = temporary_folder(parent, "raydiff-report", &runner->folder);
    if (runner->held >= 0)
        return STATUS_OK;
    return fail(reason, STATUS_INPUT, "%s: cannot make a temporary folder: %s", file_label(parent),
                strerror(errno));
}

void runner_close(struct runner *runner)
{
    if (!runner->folder)
        return;
    if (!temporary_folder_remove(runner->folder))
        fprintf(stderr, "raydiff report: %s: cannot be removed: %s; the next report tries again\n",
                file_label(runner->folder), strerror(errno));
    close(runner->held);
    free(runner->folder);
    runner->folder = NULL;
}

/* --- a child ------------------------------------------------------------------------------ */

struct run_order {
    command_fn *command;
    const struct line *line;
    char out[PATH_MOST], err[PATH_MOST];
};

/* Redirects a standard stream to the file at `path`. */
static bool stand_in(const char *path, int flags, int standard)
{
    int code = -1, file = file_open_again(AT_FDCWD, path, flags);
    while (file >= 0 && (code = dup2(file, standard)) < 0 && errno == EINTR)
        continue;
    if (file < 0 || code < 0)
        fprintf(stderr, "raydiff report: %s: %s\n", path, strerror(errno));
    if (file >= 0)
        close(file);
    return code >= 0;
}

static void obey(struct child *parent, void *user)
{
    struct run_order *order = user;
    int code = EXIT_INTERNAL;
    signal(SIGINT, SIG_DFL);
    signal(SIGTERM, SIG_DFL);
    signal(SIGHUP, SIG_DFL);
    if (stand_in("/dev/null", O_RDONLY, STDIN_FILENO) &&
        stand_in(order->out, O_WRONLY | O_CREAT | O_TRUNC, STDOUT_FILENO) &&
        stand_in(order->err, O_WRONLY | O_CREAT | O_TRUNC, STDERR_FILENO))
        code = order->command(order->line->argc, (char **)(uintptr_t)order->line->argv);
    if (fflush(stdout) != 0 || ferror(stdout)) {
        fprintf(stderr, "raydiff report: cannot write what it prints: %s\n", strerror(errno));
        code = exit_worse(code, EXIT_USAGE);
    }
    fflush(NULL);
    if (!child_send(parent, &code, sizeof code, CHILD_FOREVER))
        _exit(EXIT_INTERNAL); /* no output is left to report the error */
}

/* Reads the child's standard error without progress lines such as "raydiff check: 10 s: ..."
 * and "raydiff check: 10 s, about 5 s left: ...". */
static void read_said(const char *path, struct run *run)
{
    char line[RUN_SAID_MOST];
    FILE *file = fopen(path, "re");
    while (file && fgets(line, sizeof line, file)) {
        unsigned seconds;
        char name[16], next;
        size_t used = strlen(run->said);
        if (sscanf(line, "raydiff %15[a-z]: %u s%c", name, &seconds, &next) == 3 &&
            (next == ':' || next == ','))
            continue;
        snprintf(run->said + used, sizeof run->said - used, "%s", line);
    }
    if (file)
        fclose(file);
    for (size_t used = strlen(run->said); used > 0 && run->said[used - 1] == '\n'; used--)
        run->said[used - 1] = '\0';
}

/* Waits until the child answers, ends or takes too long, or a signal stops the report. */
static void attend(struct runner *runner, struct child *child, const struct line *line,
                   struct run *run)
{
    struct child_fate fate;
    const uint64_t start = time_ns();
    enum child_got got = CHILD_LATE;
    const void *bytes;
    size_t size;
    while (got == CHILD_LATE && !stop_signal && run->seconds < (double)runner->seconds) {
        got = child_receive(child, sizeof run->code, LOOK_MS, &bytes, &size);
        run->seconds = (double)(time_ns() - start) * 1e-9;
        progress_step(&runner->progress, "part %zu: %.100s", runner->parts, line->text);
    }
    if (got == CHILD_GOT && size == sizeof run->code)
        memcpy(&run->code, bytes, size);
    else
        run->dead = true;
    child_end(child, got == CHILD_LATE ? 0 : END_MS, &fate);
    run->stopped = stop_signal != 0;
    if (!run->dead)
        return;
    run->code = EXIT_ENGINE;
    if (got == CHILD_LATE)
        snprintf(run->said, sizeof run->said, "it took longer than %u s\n", runner->seconds);
    else
        snprintf(run->said, sizeof run->said, "it %s%s\n",
                 fate.signal && !fate.forced ? "was " : "", fate.text);
}

enum status runner_run(struct runner *runner, command_fn *command, const struct line *line,
                       struct run *run, struct reason *reason)
{
    struct run_order order = {.command = command, .line = line};
    struct child child;
    *run = (struct run){.code = EXIT_INTERNAL};
    runner->parts++;
    runner_path(runner, "out", order.out, sizeof order.out);
    runner_path(runner, "err", order.err, sizeof order.err);
    enum status status = child_start(obey, &order, &child, reason);
    if (status)
        return status;
    attend(runner, &child, line, run);
    read_said(order.err, run);
    return STATUS_OK;
}

enum status runner_make(struct runner *runner, command_fn *command, struct line *line,
                        const char *name, struct run *run, struct report_part *part,
                        struct reason *reason)
{
    char path[PATH_MOST];
    line_word(line, "--json");
    line_file(line, runner, name);
    runner_path(runner, name, path, sizeof path);
    remove(path);
    enum status status = runner_run(runner, command, line, run, reason);
    line_free(line);
    if (status || run->stopped)
        return status;
    enum status read = report_read(path, part->kind, &part->json, &run->unread);
    part->code = run->code;
    part->seconds = run->seconds;
    part->why = run->said; /* copied by report_add */
    part->state = REPORT_RAN;
    if (run->dead || read != STATUS_OK)
        part->state = run->code == EXIT_SKIPPED && !run->dead ? REPORT_SKIPPED : REPORT_FAILED;
    if (read != STATUS_OK && (run->code == EXIT_AGREE || run->code == EXIT_MISMATCH))
        part->why = run->unread.text;
    return STATUS_OK;
}
