#define _GNU_SOURCE /* pipe2 */
#include "ref/outside/tool.h"

#include "ref/outside/guardian.h"
#include "ref/outside/quiet.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define TOOL_PATH_MOST 1024

enum { TOOL_IN, TOOL_OUT, TOOL_ERROR, TOOL_PIPES };

/* A run: our ends of the pipes (-1: closed), and what has arrived. */
struct running {
    const struct tool_order *order;
    struct guardian guardian;
    int end[TOOL_PIPES];
    size_t sent;
    struct arrived {
        char *bytes;
        size_t size, capacity;
    } from[TOOL_PIPES];
    uint64_t deadline_ns;
};

struct command_line {
    const char *path;
    char *const *argv;
    int end[TOOL_PIPES];
};

static bool can_run(const char *path)
{
    struct stat about;
    return stat(path, &about) == 0 && S_ISREG(about.st_mode) && access(path, X_OK) == 0;
}

bool tool_find(const char *name, char *path, size_t path_bytes)
{
    const char *at = getenv("PATH");
    if (strchr(name, '/'))
        return snprintf(path, path_bytes, "%s", name) < (int)path_bytes && can_run(path);
    for (; at && *at; at += *at == ':') {
        const size_t length = strcspn(at, ":");
        const int wrote =
            snprintf(path, path_bytes, "%.*s%s%s", (int)length, at, length ? "/" : "./", name);
        if (wrote > 0 && wrote < (int)path_bytes && can_run(path))
            return true;
        at += length;
    }
    return false;
}

/* Runs in the child, where no lock may be taken. */
static void become(const void *user)
{
    const struct command_line *line = user;
    const struct rlimit none = {0, 0};
    for (int i = 0; i < TOOL_PIPES; i++)
        if (dup2(line->end[i], i) < 0)
            return;
    setrlimit(RLIMIT_CORE, &none);
    execv(line->path, line->argv);
}

static void close_end(int *end)
{
    if (*end >= 0)
        close(*end);
    *end = -1;
}

/* Opens three pipes, all ends above the standard files: [0] read, [1] write. */
static bool open_pipes(int pipes[TOOL_PIPES][2])
{
    memset(pipes, -1, TOOL_PIPES * sizeof pipes[0]);
    for (int p = 0; p < TOOL_PIPES; p++) {
        int low[2];
        if (pipe2(low, O_CLOEXEC) != 0)
            return false;
        for (int i = 0; i < 2; i++) {
            pipes[p][i] = fcntl(low[i], F_DUPFD_CLOEXEC, 3);
            close(low[i]);
        }
        if (pipes[p][0] < 0 || pipes[p][1] < 0)
            return false;
    }
    return true;
}

static enum status start(struct running *run, const char *path, struct reason *reason)
{
    int pipes[TOOL_PIPES][2];
    enum status status = STATUS_OK;
    const bool open = open_pipes(pipes);
    if (!open)
        status = fail(reason, STATUS_DEVICE, "%.80s: no pipe: %s", path, strerror(errno));
    /* exec takes pointers to what it does not change */
    const struct command_line line = {
        path,
        (char *const *)(uintptr_t)run->order->argv,
        {pipes[TOOL_IN][0], pipes[TOOL_OUT][1], pipes[TOOL_ERROR][1]}};
    if (open)
        status = guardian_start(become, &line, &run->guardian, reason);
    for (int p = 0; p < TOOL_PIPES; p++) {
        const int ours = p == TOOL_IN;
        close_end(&pipes[p][!ours]);
        run->end[p] = pipes[p][ours];
        if (status)
            close_end(&run->end[p]);
        else
            fcntl(run->end[p], F_SETFL, O_NONBLOCK);
    }
    return status;
}

static bool would_wait(void)
{
    return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
}

/* A program need not read all of its input. */
static void send_some(struct running *run)
{
    const struct tool_order *order = run->order;
    ssize_t wrote = 1;
    while (run->sent < order->in_size && wrote > 0) {
        wrote = write_quietly(run->end[TOOL_IN], (const char *)order->in + run->sent,
                              order->in_size - run->sent);
        run->sent += wrote > 0 ? (size_t)wrote : 0;
    }
    if (run->sent == order->in_size || (wrote < 0 && !would_wait()))
        close_end(&run->end[TOOL_IN]);
}

/* Receives what has arrived of the output or of the standard error output, of which only the
 * beginning is kept. */
static enum status receive_some(struct running *run, int which, struct reason *reason)
{
    struct arrived *from = &run->from[which];
    char some[65536];
    ssize_t got;
    const size_t most =
        which == TOOL_OUT || run->order->diagnose ? run->order->most : TOOL_SAID_MOST - 1;
    while ((got = read(run->end[which], some, sizeof some)) > 0) {
        const size_t room = most - from->size, size = (size_t)got;
        if (size > room && which == TOOL_OUT)
            return fail(reason, STATUS_DEVICE, "%.80s: its output is longer than %zu bytes",
                        run->order->argv[0], most);
        const size_t taken = size < room ? size : room;
        if (array_reserve(&from->bytes, &from->capacity, from->size + taken + 1, 1))
            return fail(reason, STATUS_MEMORY, "%.80s: no memory for its output",
                        run->order->argv[0]);
        memcpy(from->bytes + from->size, some, taken);
        from->size += taken;
    }
    if (got == 0 || !would_wait())
        close_end(&run->end[which]);
    return STATUS_OK;
}

/* The milliseconds left, at most a second. */
static int time_left(const struct running *run)
{
    const uint64_t now = time_ns();
    if (now >= run->deadline_ns)
        return 0;
    const uint64_t ms = (run->deadline_ns - now) / 1000000u + 1;
    return ms < 1000 ? (int)ms : 1000;
}

static enum status late(const struct running *run, struct reason *reason)
{
    return fail(reason, STATUS_DEVICE, "%.80s: not done after %g s", run->order->argv[0],
                run->order->ms / 1e3);
}

/* Sends and receives until the program has closed its output. */
static enum status talk(struct running *run, struct reason *reason)
{
    enum status status = STATUS_OK;
    while (run->end[TOOL_OUT] >= 0 && !status) {
        struct pollfd wait[TOOL_PIPES];
        const int left = time_left(run);
        for (int p = 0; p < TOOL_PIPES; p++)
            wait[p] = (struct pollfd){.fd = run->end[p],
                                      .events = (short)(p == TOOL_IN ? POLLOUT : POLLIN)};
        if (left == 0)
            return late(run, reason);
        if (poll(wait, TOOL_PIPES, left) <= 0)
            continue;
        if (wait[TOOL_IN].revents)
            send_some(run);
        for (int p = TOOL_OUT; p < TOOL_PIPES && !status; p++)
            if (wait[p].revents)
                status = receive_some(run, p, reason);
    }
    return status;
}

/* Some programs complain on their standard output. */
static void keep_said(const struct running *run, char said[TOOL_SAID_MOST])
{
    const struct arrived *from = &run->from[run->from[TOOL_ERROR].size ? TOOL_ERROR : TOOL_OUT];
    size_t at = 0;
    while (at < from->size && at + 1 < TOOL_SAID_MOST && from->bytes[at] != '\n') {
        const char c = from->bytes[at];
        said[at++] = '~' < c || c < ' ' ? '?' : c;
    }
    said[at] = '\0';
}

/* Waits for the end, and receives the rest of what it says. */
static enum status finish(struct running *run, struct tool_answer *out, struct reason *reason)
{
    int how = 0, left = 0;
    bool ended = false;
    const char *name = run->order->argv[0];
    while (!ended && (left = time_left(run)) > 0)
        ended = guardian_ended(&run->guardian, (unsigned)left, &how);
    enum status status =
        run->end[TOOL_ERROR] < 0 ? STATUS_OK : receive_some(run, TOOL_ERROR, reason);
    keep_said(run, out->said);
    if (!ended && !status)
        return late(run, reason);
    if (status || (WIFEXITED(how) && WEXITSTATUS(how) == 0))
        return status;
    if (!WIFEXITED(how))
        return fail(reason, STATUS_DEVICE, "%.80s was ended by signal %d", name, WTERMSIG(how));
    return fail(reason, STATUS_DEVICE, "%.80s ended with exit code %d%s%.160s", name,
                WEXITSTATUS(how), out->said[0] ? ": " : "", out->said);
}

/* Ends the text with 0. */
static enum status take(struct arrived *from, char **bytes, size_t *size, struct reason *reason)
{
    if (array_reserve(&from->bytes, &from->capacity, from->size + 1, 1))
        return fail(reason, STATUS_MEMORY, "no memory for a program's output");
    from->bytes[from->size] = '\0';
    *bytes = from->bytes;
    *size = from->size;
    from->bytes = NULL;
    return STATUS_OK;
}

enum status tool_run(const struct tool_order *order, struct tool_answer *out, struct reason *reason)
{
    char path[TOOL_PATH_MOST];
    struct running run = {.order = order,
                          .end = {-1, -1, -1},
                          .deadline_ns = time_ns() + (uint64_t)order->ms * 1000000u};
    *out = (struct tool_answer){0};
    if (!tool_find(order->argv[0], path, sizeof path))
        return fail(reason, STATUS_UNSUPPORTED, "there is no program %.120s", order->argv[0]);
    enum status status = start(&run, path, reason);
    if (status)
        return status;
    status = talk(&run, reason);
    if (!status)
        status = finish(&run, out, reason);
    guardian_stop(&run.guardian);
    for (int p = 0; p < TOOL_PIPES; p++)
        close_end(&run.end[p]);
    if (!status)
        status = take(&run.from[TOOL_OUT], &out->out, &out->size, reason);
    if (!status && order->diagnose)
        status = take(&run.from[TOOL_ERROR], &out->diagnosis, &out->diagnosis_size, reason);
    for (int p = 0; p < TOOL_PIPES; p++)
        free(run.from[p].bytes);
    return status;
}

void tool_free(struct tool_answer *answer)
{
    free(answer->out);
    free(answer->diagnosis);
    *answer = (struct tool_answer){0};
}
