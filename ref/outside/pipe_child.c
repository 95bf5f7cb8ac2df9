#define _GNU_SOURCE /* pipe2 */
#include "ref/outside/pipe_child.h"

#include "ref/outside/pipe.h"
#include "ref/outside/quiet.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

/* Standard error is not read beyond this many bytes, so the pipe fills up. */
#define SAID_LIMIT ((size_t)1 << 20)

/* The command as exec takes it, and its standard files. */
struct become {
    const char *program;
    char *const *argv;
    int end[3];
    uint32_t megabytes; /* an object's host limits itself, once it knows what it takes */
};

/* Runs in the child. Nothing here may take a lock, since other threads of the parent may hold
 * any. */
static void become(const void *user)
{
    const struct become *order = user;
    struct rlimit none = {0, 0};
    for (int i = 0; i < 3; i++)
        if (dup2(order->end[i], i) < 0)
            return;
    if (order->megabytes != UINT32_MAX) {
        rlim_t most = (rlim_t)order->megabytes << 20;
        struct rlimit memory = {most, most};
        setrlimit(RLIMIT_AS, &memory);
    }
    setrlimit(RLIMIT_CORE, &none);
    execv(order->program, order->argv);
}

static void close_all(int end[6])
{
    for (int i = 0; i < 6; i++)
        if (end[i] >= 0)
            close(end[i]);
}

/* Opens three pipes, all ends above the standard files, so that dup2 in the child overwrites none.
 * Ends 0 and 1 are the child's input, 2 and 3 its output, 4 and 5 its standard error. */
static bool open_pipes(int end[6])
{
    for (int i = 0; i < 6; i++)
        end[i] = -1;
    for (int p = 0; p < 3; p++) {
        int low[2];
        if (pipe2(low, O_CLOEXEC) != 0)
            return false;
        for (int i = 0; i < 2; i++) {
            end[2 * p + i] = fcntl(low[i], F_DUPFD_CLOEXEC, 3);
            close(low[i]);
        }
        if (end[2 * p] < 0 || end[2 * p + 1] < 0)
            return false;
    }
    return true;
}

enum status pipe_child_start(const struct pipe_order *what, struct pipe_child *out,
                             struct reason *reason)
{
    int end[6];
    char megabytes[16], threads[16];
    char *const shell[] = {"sh", "-c", (char *)(uintptr_t)what->command, NULL};
    char *const host[] = {"raydiff", PIPE_HOST_FLAG, (char *)(uintptr_t)what->object,
                          megabytes, threads,        NULL};
    *out = (struct pipe_child){0};
    if (!open_pipes(end)) {
        enum status no_pipe = fail(reason, STATUS_DEVICE, "no pipe: %s", strerror(errno));
        close_all(end);
        return no_pipe;
    }
    snprintf(megabytes, sizeof megabytes, "%u", what->megabytes);
    snprintf(threads, sizeof threads, "%u", what->threads);
    const struct become order = {what->command ? "/bin/sh" : "/proc/self/exe",
                                 what->command ? shell : host,
                                 {end[0], end[3], end[5]},
                                 what->command ? what->megabytes : UINT32_MAX};
    struct guardian guardian;
    enum status status = guardian_start(become, &order, &guardian, reason);
    if (status) {
        close_all(end);
        return status;
    }
    close(end[0]);
    close(end[3]);
    close(end[5]);
    *out = (struct pipe_child){
        .guardian = guardian, .to = end[1], .from = end[2], .said_from = end[4]};
    fcntl(out->to, F_SETFL, O_NONBLOCK);
    fcntl(out->from, F_SETFL, O_NONBLOCK);
    fcntl(out->said_from, F_SETFL, O_NONBLOCK);
    return STATUS_OK;
}

static void close_ends(struct pipe_child *child)
{
    close(child->to);
    close(child->from);
    close(child->said_from);
}

void pipe_child_stop(struct pipe_child *child)
{
    if (!pipe_child_runs(child))
        return;
    guardian_stop(&child->guardian);
    close_ends(child);
    *child = (struct pipe_child){0};
}

void pipe_child_listen(struct pipe_child *child)
{
    char some[512];
    ssize_t got;
    while (child->said_length < SAID_LIMIT &&
           (got = read(child->said_from, some, sizeof some)) > 0) {
        child->noisy = true;
        for (ssize_t i = 0; i < got && child->said_length + (size_t)i < PIPE_SAID_MOST - 1; i++)
            child->said[child->said_length + (size_t)i] = some[i];
        child->said_length += (size_t)got;
    }
    child->mute = child->mute || child->said_length >= SAID_LIMIT;
    for (size_t i = 0; i < PIPE_SAID_MOST; i++) /* keep the first line, printable */
        if (child->said[i] == '\n' || child->said[i] == '\r')
            child->said[i] = '\0';
        else if (child->said[i] && (child->said[i] < ' ' || child->said[i] > '~'))
            child->said[i] = '?';
}

static bool all_sent(const struct pipe_talk *talk)
{
    return talk->broken || talk->part_count == 0;
}

static void send_some(struct pipe_talk *talk)
{
    while (!all_sent(talk)) {
        const struct pipe_part *part = talk->part;
        if (talk->at == part->size) {
            talk->part++;
            talk->part_count--;
            talk->at = 0;
            continue;
        }
        ssize_t wrote = write_quietly(talk->child->to, (const char *)part->bytes + talk->at,
                                      part->size - talk->at);
        if (wrote < 0 && errno != EINTR) {
            talk->broken = errno != EAGAIN && errno != EWOULDBLOCK;
            return;
        }
        talk->at += wrote > 0 ? (size_t)wrote : 0;
    }
}

/* Receives what has arrived; if `last`, with room for one byte too many, which sets *more. Returns
 * false at the end of the output. */
static bool receive_some(struct pipe_talk *talk, char *bytes, size_t size, bool last, bool *more)
{
    char spare;
    struct iovec into[2] = {{bytes + talk->got, size - talk->got}, {&spare, 1}};
    ssize_t got = readv(talk->child->from, into, last ? 2 : 1);
    if (got == 0)
        return false;
    if (got < 0)
        return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
    *more = (size_t)got > size - talk->got;
    talk->got += *more ? size - talk->got : (size_t)got;
    return true;
}

/* Waits until something can be sent or received, at most 1 s. Returns false if the deadline has
 * passed. */
static bool wait_for_peer(struct pipe_talk *talk)
{
    uint64_t now = time_ns();
    if (now >= talk->deadline_ns)
        return false;
    uint64_t ms = (talk->deadline_ns - now) / 1000000u + 1;
    struct pollfd wait[3] = {
        {.fd = talk->child->from, .events = POLLIN},
        {.fd = all_sent(talk) ? -1 : talk->child->to, .events = POLLOUT},
        {.fd = talk->child->mute ? -1 : talk->child->said_from, .events = POLLIN}};
    int ready = poll(wait, 3, ms > 1000 ? 1000 : (int)ms);
    if (ready <= 0)
        return true;
    if (wait[1].revents)
        send_some(talk);
    if (wait[2].revents & POLLIN)
        pipe_child_listen(talk->child);
    else if (wait[2].revents)
        talk->child->mute = true; /* closed: poll would return at once every time */
    return true;
}

bool pipe_child_is_early(struct pipe_child *child)
{
    char spare;
    return read(child->from, &spare, 1) == 1;
}

enum pipe_end pipe_talk(struct pipe_talk *talk, void *bytes, size_t size, bool last)
{
    char spare;
    bool more = false;
    talk->got = 0;
    send_some(talk);
    if (size == 0) /* nothing to wait for, but a byte may have arrived */
        return last && read(talk->child->from, &spare, 1) > 0 ? PIPE_LONG : PIPE_GOT;
    while (talk->got < size) {
        if (!wait_for_peer(talk))
            return PIPE_LATE;
        if (!receive_some(talk, bytes, size, last, &more))
            return PIPE_CLOSED;
    }
    pipe_child_listen(talk->child);
    return more ? PIPE_LONG : PIPE_GOT;
}

void pipe_child_fate(struct pipe_child *child, unsigned ms, char text[PIPE_FATE_MOST],
                     bool *missing)
{
    int status = 0;
    bool ended = guardian_ended(&child->guardian, ms, &status);
    *missing = false;
    pipe_child_listen(child);
    if (!ended) {
        snprintf(text, PIPE_FATE_MOST, "it closed its output");
    } else if (WIFEXITED(status)) {
        snprintf(text, PIPE_FATE_MOST, "it ended with exit code %d", WEXITSTATUS(status));
        *missing = WEXITSTATUS(status) == 126 || WEXITSTATUS(status) == 127;
    } else {
        snprintf(text, PIPE_FATE_MOST, "it was ended by signal %d", WTERMSIG(status));
    }
}
