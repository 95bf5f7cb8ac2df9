#define _GNU_SOURCE /* getdents64, ppoll, prctl */
#include "ref/outside/guardian.h"

#include "ref/outside/child.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#define STOP_MS  3000u  /* limit of guardian_stop */
#define KILL_MS  60000u /* limit of the guardian's end_all */
#define START_MS 5000

/* --- the guardian: no locks, no memory ------------------------------------------------------- */

static void on_child(int number)
{
    (void)number;
}

/* Returns the parent of a process, from "PID (NAME) STATE PARENT ..."; 0: not known. */
static long parent_of(int folder, const char *name)
{
    char path[32], text[512];
    size_t length = strlen(name);
    if (length + sizeof "/stat" > sizeof path)
        return 0;
    memcpy(path, name, length);
    memcpy(path + length, "/stat", sizeof "/stat");
    int file = openat(folder, path, O_RDONLY | O_CLOEXEC);
    ssize_t size = file < 0 ? -1 : read(file, text, sizeof text - 1);
    if (file >= 0)
        close(file);
    if (size <= 0)
        return 0;
    text[size] = '\0';
    const char *after = strrchr(text, ')'); /* a name may contain any character */
    return after && strlen(after) > 4 ? strtol(after + 4, NULL, 10) : 0;
}

/* Kills the guardian's children. Their children then become its own: it is the nearest
 * subreaper. */
static void kill_children(void)
{
    char bytes[16384];
    const long self = getpid();
    int folder = open("/proc", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    ssize_t size;
    while (folder >= 0 && (size = getdents64(folder, bytes, sizeof bytes)) > 0)
        for (ssize_t at = 0; at < size;) {
            const struct dirent64 *one = (const void *)(bytes + at);
            at += one->d_reclen;
            if (one->d_name[0] >= '1' && one->d_name[0] <= '9' &&
                parent_of(folder, one->d_name) == self)
                kill((pid_t)strtol(one->d_name, NULL, 10), SIGKILL);
        }
    if (folder >= 0)
        close(folder);
}

/* Reaps ended children and reports the command's status. Returns false if there are no more
 * children. */
static bool reap(pid_t command, bool *ended, int line)
{
    int status;
    pid_t pid;
    while ((pid = waitpid(-1, &status, WNOHANG)) > 0)
        if (pid == command) {
            *ended = true;
            (void)!send(line, &status, sizeof status, MSG_NOSIGNAL);
        }
    return pid == 0 || errno != ECHILD;
}

static void end_all(pid_t command, bool ended, int line)
{
    const uint64_t start = time_ns();
    if (!ended) /* the process number is not yet reused */
        kill(-command, SIGKILL);
    while (reap(command, &ended, line) && (time_ns() - start) / 1000000u < KILL_MS) {
        kill_children();
        poll(NULL, 0, 2);
    }
}

/* Reaps children until the other end of the socket is closed, then ends all. */
static void keep_watch(pid_t command, int line)
{
    struct pollfd wait = {.fd = line, .events = POLLIN};
    sigset_t all, but_children;
    bool ended = false;
    sigfillset(&all);
    but_children = all;
    sigdelset(&but_children, SIGCHLD);
    do {
        (void)reap(command, &ended, line);
        (void)ppoll(&wait, 1, NULL, &but_children);
    } while (!wait.revents);
    end_all(command, ended, line);
}

static _Noreturn void command(guardian_fn *run, const void *user, pid_t guardian)
{
    sigset_t none;
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != guardian)
        _exit(126);
    for (int number = 1; number < 32; number++)
        signal(number, SIG_DFL);
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
    run(user);
    _exit(126);
}

static _Noreturn void guard(guardian_fn *run, const void *user, int line)
{
    const struct sigaction wake = {.sa_handler = on_child};
    sigset_t all;
    setpgid(0, 0); /* not ended by Ctrl-C */
    sigfillset(&all);
    sigprocmask(SIG_SETMASK, &all, NULL);
    sigaction(SIGCHLD, &wake, NULL);
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    pid_t self = getpid(), pid = fork();
    if (pid == 0)
        command(run, user, self);
    int why = pid < 0 ? errno : 0;
    child_close_files(0, line);
    bool told = send(line, &why, sizeof why, MSG_NOSIGNAL) == sizeof why;
    if (pid > 0) {
        setpgid(pid, pid); /* in both processes, since it must precede the group's kill */
        if (told)
            keep_watch(pid, line);
        else
            end_all(pid, false, line);
    }
    _exit(0);
}

/* --- our side -------------------------------------------------------------------------------- */

/* Receives a number from the guardian within `ms`; returns false if none came. */
static bool hear(const struct guardian *guardian, int ms, int *number)
{
    struct pollfd wait = {.fd = guardian->line, .events = POLLIN};
    const uint64_t end = time_ns() + (uint64_t)ms * 1000000u;
    for (;;) {
        ssize_t got = recv(guardian->line, number, sizeof *number, MSG_DONTWAIT);
        uint64_t now = time_ns();
        if (got == (ssize_t)sizeof *number)
            return true;
        if (got >= 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) || now >= end)
            return false;
        (void)poll(&wait, 1, (int)((end - now) / 1000000u) + 1);
    }
}

enum status guardian_start(guardian_fn *run, const void *user, struct guardian *out,
                           struct reason *reason)
{
    int end[2], why = 0;
    *out = (struct guardian){0};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, end) != 0)
        return fail(reason, STATUS_DEVICE, "no socket: %s", strerror(errno));
    pid_t pid = fork();
    if (pid == 0)
        guard(run, user, end[1]);
    int failed = errno;
    close(end[1]);
    if (pid < 0) {
        close(end[0]);
        return fail(reason, STATUS_DEVICE, "no process: %s", strerror(failed));
    }
    *out = (struct guardian){.pid = pid, .line = end[0]};
    if (hear(out, START_MS, &why) && why == 0)
        return STATUS_OK;
    guardian_stop(out);
    return fail(reason, STATUS_DEVICE, "no process: %s", why ? strerror(why) : "it did not start");
}

bool guardian_ended(struct guardian *guardian, unsigned ms, int *status)
{
    return hear(guardian, (int)ms, status);
}

void guardian_stop(struct guardian *guardian)
{
    if (guardian->pid <= 0)
        return;
    const uint64_t start = time_ns();
    close(guardian->line);
    while (waitpid(guardian->pid, NULL, WNOHANG) == 0 && (time_ns() - start) / 1000000u < STOP_MS)
        poll(NULL, 0, 1);
    *guardian = (struct guardian){0};
}
