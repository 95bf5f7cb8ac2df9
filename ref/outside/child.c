#define _GNU_SOURCE /* close_range, SOCK_CLOEXEC, MAP_ANONYMOUS */
#include "ref/outside/child.h"

#include <dirent.h>
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

/* File descriptors below this are closed one by one if the kernel has no close_range. */
#define FILES_MOST 4096

/* Header of a message. */
struct child_head {
    uint64_t size;
};

void child_close_files(int first, int kept)
{
#ifdef SYS_close_range
    if ((kept <= first || syscall(SYS_close_range, (unsigned)first, (unsigned)kept - 1, 0u) == 0) &&
        syscall(SYS_close_range, (unsigned)kept + 1, ~0u, 0u) == 0)
        return;
#endif
    for (int file = first; file < FILES_MOST; file++)
        if (file != kept)
            close(file);
}

static _Noreturn void live(child_fn *run, void *user, int file, pid_t parent)
{
    const struct rlimit none = {0, 0};
    struct child end = {.file = file};
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent)
        _exit(0); /* the parent ended before the call took effect */
    setrlimit(RLIMIT_CORE, &none);
    child_close_files(3, file); /* ends of siblings, which would never see their parent end */
    run(&end, user);
    fflush(stdout);
    _exit(0);
}

enum status child_start(child_fn *run, void *user, struct child *out, struct reason *reason)
{
    int file[2];
    *out = (struct child){0};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, file) != 0)
        return fail(reason, STATUS_DEVICE, "no socket: %s", strerror(errno));
    fflush(NULL); /* else the child would print it, too */
    pid_t parent = getpid(), pid = fork();
    if (pid == 0)
        live(run, user, file[1], parent);
    close(file[1]);
    if (pid < 0) {
        enum status status = fail(reason, STATUS_DEVICE, "no process: %s", strerror(errno));
        close(file[0]);
        return status;
    }
    *out = (struct child){.pid = pid, .file = file[0]};
    return STATUS_OK;
}

/* Waits until the file is ready for `what`, at most 1 s. Returns false once `ms` since `start` have
 * passed. */
static bool wait_for(int file, short what, uint32_t ms, uint64_t start)
{
    struct pollfd wait = {.fd = file, .events = what};
    uint64_t spent = (time_ns() - start) / 1000000u;
    if (ms != CHILD_FOREVER && spent >= ms)
        return false;
    uint64_t left = ms == CHILD_FOREVER ? 1000 : ms - spent;
    (void)poll(&wait, 1, left > 1000 ? 1000 : (int)left);
    return true;
}

/* Returns true if the call can be repeated later. That includes a lack of system memory. */
static bool would_block(void)
{
    return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR || errno == ENOMEM ||
           errno == ENOBUFS;
}

/* Sends header and body with one call if possible, so that a small message arrives whole or not at
 * all. */
bool child_send(struct child *end, const void *bytes, size_t size, uint32_t ms)
{
    struct child_head head = {size};
    uint64_t start = time_ns();
    for (size_t done = 0; done < sizeof head + size;) {
        size_t of_head = done < sizeof head ? done : sizeof head, of_body = done - of_head;
        struct iovec part[2] = {{(char *)&head + of_head, sizeof head - of_head},
                                {(char *)(uintptr_t)bytes + of_body, size - of_body}};
        const struct msghdr message = {.msg_iov = part, .msg_iovlen = 2};
        ssize_t sent = sendmsg(end->file, &message, MSG_NOSIGNAL);
        if (sent < 0 && (!would_block() || !wait_for(end->file, POLLOUT, ms, start))) {
            shutdown(end->file, SHUT_WR); /* nothing may follow half a message */
            return false;
        }
        done += sent > 0 ? (size_t)sent : 0;
    }
    return true;
}

/* Receives what has arrived, up to `want` bytes in all. Returns CHILD_GOT if all of them have. */
static enum child_got take(struct child *end, size_t want)
{
    while (end->got < want) {
        ssize_t got = recv(end->file, end->bytes + end->got, want - end->got, 0);
        if (got < 0 && would_block())
            return CHILD_LATE;
        if (got <= 0)
            return CHILD_GONE;
        end->got += (size_t)got;
    }
    return CHILD_GOT;
}

/* As take for a whole message: first the header, which has the size of the rest. */
static enum child_got take_message(struct child *end, size_t most, size_t *size)
{
    struct child_head head;
    if (array_reserve(&end->bytes, &end->capacity, sizeof head, 1))
        return CHILD_TOO_LONG;
    enum child_got got = end->got < sizeof head ? take(end, sizeof head) : CHILD_GOT;
    if (got != CHILD_GOT)
        return got;
    memcpy(&head, end->bytes, sizeof head);
    if (head.size > most || head.size > SIZE_MAX / 4 ||
        array_reserve(&end->bytes, &end->capacity, sizeof head + (size_t)head.size, 1))
        return CHILD_TOO_LONG;
    *size = (size_t)head.size;
    return take(end, sizeof head + (size_t)head.size);
}

enum child_got child_receive(struct child *end, size_t most, uint32_t ms, const void **bytes,
                             size_t *size)
{
    uint64_t start = time_ns();
    *bytes = NULL;
    *size = 0;
    for (;;) {
        enum child_got got = take_message(end, most, size);
        if (got == CHILD_GOT) {
            *bytes = end->bytes + sizeof(struct child_head);
            end->got = 0;
        }
        if (got != CHILD_LATE || !wait_for(end->file, POLLIN, ms, start))
            return got;
    }
}

bool child_receive_into(struct child *end, void *bytes, size_t size, uint32_t ms)
{
    const void *from;
    size_t got;
    if (child_receive(end, size, ms, &from, &got) != CHILD_GOT || got != size)
        return false;
    memcpy(bytes, from, size);
    return true;
}

void child_wait(struct child *const *child, size_t count, uint32_t ms)
{
    struct pollfd wait[CHILDREN_MOST];
    nfds_t used = 0;
    for (size_t i = 0; i < count && used < CHILDREN_MOST; i++)
        if (child[i] && child[i]->pid > 0)
            wait[used++] = (struct pollfd){.fd = child[i]->file, .events = POLLIN};
    (void)poll(wait, used, ms > INT32_MAX ? -1 : (int)ms);
}

/* Waits up to `ms` for the process to end; returns false if it did not. */
static bool reap(pid_t pid, uint32_t ms, int *status)
{
    uint64_t start = time_ns();
    for (;;) {
        if (waitpid(pid, status, WNOHANG) == pid)
            return true;
        if ((time_ns() - start) / 1000000u >= ms)
            return false;
        (void)poll(NULL, 0, 1);
    }
}

static void name_fate(struct child_fate *fate, int status)
{
    if (WIFSIGNALED(status))
        fate->signal = WTERMSIG(status);
    else
        fate->code = WEXITSTATUS(status);
    if (fate->forced)
        snprintf(fate->text, sizeof fate->text, "did not end by itself");
    else if (fate->signal)
        snprintf(fate->text, sizeof fate->text, "killed by signal %d (%s)", fate->signal,
                 strsignal(fate->signal));
    else
        snprintf(fate->text, sizeof fate->text, "ended itself with code %d", fate->code);
}

void child_end(struct child *child, uint32_t ms, struct child_fate *fate)
{
    struct child_fate how = {0};
    int status = 0;
    if (child->pid <= 0)
        return;
    shutdown(child->file, SHUT_RDWR);
    if (!reap(child->pid, ms, &status)) {
        kill(child->pid, SIGKILL);
        how.forced = true;
        while (waitpid(child->pid, &status, 0) < 0 && errno == EINTR)
            continue;
    }
    close(child->file);
    free(child->bytes);
    *child = (struct child){0};
    name_fate(&how, status);
    if (fate)
        *fate = how;
}

/* Returns the state letter of a /proc stat file: R, S, T, t, Z ...; '?' if it cannot be read. */
static char state_of(const char *path)
{
    char text[512];
    FILE *file = fopen(path, "re");
    const char *name_end = file && fgets(text, sizeof text, file) ? strrchr(text, ')') : NULL;
    if (file)
        fclose(file);
    return name_end && name_end[1] ? name_end[2] : '?';
}

bool child_is_stopped(const struct child *child, bool *debugged)
{
    char path[48];
    snprintf(path, sizeof path, "/proc/%ld/stat", (long)child->pid);
    const char state = state_of(path);
    *debugged = state == 't';
    return state == 'T' || *debugged;
}

/* Time that one thread has waited for a processor; `task` is its /proc folder. */
static uint64_t waited_ns(const char *task)
{
    char path[400];
    unsigned long long waited = 0;
    snprintf(path, sizeof path, "%s/schedstat", task);
    FILE *file = fopen(path, "re");
    if (file && fscanf(file, "%*u %llu", &waited) != 1)
        waited = 0;
    if (file)
        fclose(file);
    return waited;
}

uint64_t child_queued_ns(const struct child *child, uint32_t *running)
{
    char path[48], task[320], state[400];
    uint64_t all = 0;
    *running = 0;
    snprintf(path, sizeof path, "/proc/%ld/task", (long)child->pid);
    DIR *tasks = opendir(path);
    for (const struct dirent *entry; tasks && (entry = readdir(tasks));) {
        if (entry->d_name[0] == '.')
            continue;
        snprintf(task, sizeof task, "%s/%s", path, entry->d_name);
        snprintf(state, sizeof state, "%s/stat", task);
        all += waited_ns(task);
        *running += state_of(state) == 'R';
    }
    if (tasks)
        closedir(tasks);
    return all;
}

uint64_t child_memory(const struct child *child)
{
    char path[48];
    unsigned long long all = 0, resident = 0;
    snprintf(path, sizeof path, "/proc/%ld/statm", (long)child->pid);
    FILE *file = fopen(path, "re");
    if (!file)
        return 0;
    if (fscanf(file, "%llu %llu", &all, &resident) != 2)
        resident = 0;
    fclose(file);
    return resident * (uint64_t)sysconf(_SC_PAGESIZE);
}

void *child_share(size_t bytes)
{
    void *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    return memory == MAP_FAILED ? NULL : memory;
}

void child_unshare(void *memory, size_t bytes)
{
    if (memory)
        munmap(memory, bytes);
}
