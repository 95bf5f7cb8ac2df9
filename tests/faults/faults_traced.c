#define _GNU_SOURCE
#include "tests/faults/faults_traced.h"

#include <elf.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#define PROCESSES_MOST 64

#define CALL(name, ...)                                                                            \
    {                                                                                              \
#name, SYS_##name, -1,                                                                     \
        {                                                                                          \
            __VA_ARGS__                                                                            \
        }                                                                                          \
    }
#define FCNTL(what, ...)                                                                           \
    {                                                                                              \
        "fcntl." #what, SYS_fcntl, what,                                                           \
        {                                                                                          \
            __VA_ARGS__                                                                            \
        }                                                                                          \
    }

/* close() of Linux has closed the descriptor also where it fails: it is let through, and its result
 * replaced. Not here are EPIPE and ECONNRESET, which say that the other end has died: a campaign
 * believes that, and what died is a finding; and brk(), on whose failure glibc 2.36's malloc()
 * itself ends the process. */
const struct traced_call traced_calls[] = {
    CALL(openat, EINTR, EIO, EMFILE, ENOMEM, ENOSPC),
    CALL(read, EINTR, EIO, ENOMEM, FAULT_SHORT),
    CALL(pread64, EINTR, EIO, FAULT_SHORT),
    CALL(write, EINTR, EIO, ENOSPC, FAULT_SHORT),
    CALL(pwrite64, EINTR, EIO, ENOSPC, FAULT_SHORT),
    CALL(writev, EINTR, EIO, ENOSPC),
    CALL(close, EINTR, EIO),
    CALL(rename, EIO, ENOSPC, ENOMEM),
    CALL(renameat, EIO, ENOSPC, ENOMEM),
    CALL(renameat2, EIO, ENOSPC, ENOMEM),
    CALL(linkat, EIO, ENOSPC, ENOMEM),
    CALL(flock, EINTR, ENOLCK),
    CALL(unlink, EIO, ENOMEM),
    CALL(unlinkat, EIO, ENOMEM),
    CALL(rmdir, EIO, ENOMEM),
    CALL(mkdir, EIO, ENOSPC, ENOMEM),
    CALL(mkdirat, EIO, ENOSPC, ENOMEM),
    CALL(fsync, EINTR, EIO, ENOSPC),
    CALL(fdatasync, EINTR, EIO, ENOSPC),
    CALL(ftruncate, EINTR, EIO),
    CALL(lseek, EIO),
    CALL(fstat, EIO, ENOMEM),
    CALL(stat, EIO, ENOMEM),
    CALL(lstat, EIO, ENOMEM),
    CALL(newfstatat, EIO, ENOMEM),
    CALL(statx, EIO, ENOMEM),
    CALL(access, EIO, ENOMEM),
    CALL(readlink, EIO, ENOMEM),
    CALL(getdents64, EIO, ENOMEM),
    FCNTL(F_SETLK, EINTR, ENOLCK),
    FCNTL(F_DUPFD_CLOEXEC, EMFILE),
    CALL(dup2, EINTR, EMFILE),
    CALL(pipe2, EMFILE, ENFILE),
    CALL(socketpair, EMFILE, ENFILE, ENOMEM),
    CALL(sendmsg, EINTR, ENOMEM, ENOBUFS),
    CALL(recvfrom, EINTR, ENOMEM),
    CALL(poll, EINTR, ENOMEM),
    CALL(wait4, EINTR),
    CALL(clone, EAGAIN, ENOMEM),
    CALL(fork, EAGAIN, ENOMEM),
    CALL(vfork, EAGAIN, ENOMEM),
    CALL(mmap, ENOMEM),
    CALL(mremap, ENOMEM),
};
const size_t traced_call_count = sizeof traced_calls / sizeof *traced_calls;

const char *fault_name(int kind)
{
    return kind == FAULT_SHORT ? "short" : kind == FAULT_KILL ? "killed" : strerrorname_np(kind);
}

#ifdef __x86_64__

struct process {
    pid_t pid;
    int index;
    bool started, within; /* a call, between its two stops */
    int result;           /* what the call within is to return, if not 0: -errno */
    unsigned *seen;
};

struct traced_tracer {
    struct process process[PROCESSES_MOST];
    int count, made;
    const struct traced_place *fault;
    int kind;
    bool done;
    struct traced_result *result;
    traced_fn *each;
    void *user;
};

static volatile sig_atomic_t late;

static void on_alarm(int number)
{
    (void)number;
    late = 1;
}

static struct process *process_of(struct traced_tracer *t, pid_t pid)
{
    for (int i = 0; i < t->count; i++)
        if (t->process[i].pid == pid)
            return &t->process[i];
    if (t->count == PROCESSES_MOST)
        return NULL;
    struct process *made = &t->process[t->count++];
    *made = (struct process){.pid = pid, .index = t->made++};
    made->seen = calloc(traced_call_count, sizeof *made->seen);
    return made;
}

static void forget(struct traced_tracer *t, pid_t pid)
{
    for (int i = 0; i < t->count; i++)
        if (t->process[i].pid == pid) {
            free(t->process[i].seen);
            t->process[i] = t->process[--t->count];
            return;
        }
}

/* Where the program begins once its libraries are loaded. */
static uint64_t entry_of(pid_t pid)
{
    char path[64];
    Elf64_auxv_t pair;
    uint64_t entry = 0;
    snprintf(path, sizeof path, "/proc/%d/auxv", (int)pid);
    FILE *file = fopen(path, "r");
    while (file && fread(&pair, sizeof pair, 1, file) == 1)
        if (pair.a_type == AT_ENTRY)
            entry = pair.a_un.a_val;
    if (file)
        fclose(file);
    return entry;
}

/* Lets it run to its entry. False: it ended before, or cannot be traced. */
static bool run_to_entry(pid_t pid)
{
    int status;
    struct user_regs_struct regs;
    if (waitpid(pid, &status, 0) != pid || !WIFSTOPPED(status))
        return false;
    uint64_t entry = entry_of(pid);
    long word = ptrace(PTRACE_PEEKTEXT, pid, (void *)entry, NULL);
    if (entry == 0 || ptrace(PTRACE_POKETEXT, pid, (void *)entry, (word & ~0xFFL) | 0xCC) ||
        ptrace(PTRACE_CONT, pid, NULL, NULL) || waitpid(pid, &status, 0) != pid ||
        !WIFSTOPPED(status) || WSTOPSIG(status) != SIGTRAP ||
        ptrace(PTRACE_POKETEXT, pid, (void *)entry, word) ||
        ptrace(PTRACE_GETREGS, pid, NULL, &regs))
        return false;
    regs.rip = entry;
    return ptrace(PTRACE_SETREGS, pid, NULL, &regs) == 0;
}

static void inject(struct traced_tracer *t, struct process *p, struct user_regs_struct *regs)
{
    long number = (long)regs->orig_rax;
    t->done = t->result->reached = true;
    if (t->kind == FAULT_KILL) {
        kill(p->pid, SIGKILL);
        return;
    }
    if (t->kind == FAULT_SHORT) {
        regs->rdx = 1;
    } else {
        p->result = -t->kind;
        if (number != SYS_close)
            regs->orig_rax = (unsigned long long)-1;
    }
    ptrace(PTRACE_SETREGS, p->pid, NULL, regs);
}

static void at_call(struct traced_tracer *t, struct process *p)
{
    struct user_regs_struct regs;
    struct __ptrace_syscall_info info;
    if (ptrace(PTRACE_GET_SYSCALL_INFO, p->pid, (void *)sizeof info, &info) <= 0 ||
        ptrace(PTRACE_GETREGS, p->pid, NULL, &regs))
        return;
    p->within = info.op == PTRACE_SYSCALL_INFO_ENTRY;
    if (!p->within) {
        if (p->result) {
            regs.rax = (unsigned long long)(long long)p->result;
            ptrace(PTRACE_SETREGS, p->pid, NULL, &regs);
            p->result = 0;
        }
        return;
    }
    size_t call = 0;
    while (call < traced_call_count &&
           !(traced_calls[call].number == (long)regs.orig_rax &&
             (traced_calls[call].second == -1 || traced_calls[call].second == (long)regs.rsi)))
        call++;
    if (call == traced_call_count)
        return;
    struct traced_place place = {p->index, call, p->seen[call]++, regs.rdx > 1, regs.rdi <= 2};
    if (t->each)
        t->each(t->user, &place);
    if (t->fault && !t->done && t->fault->process == place.process && t->fault->call == call &&
        t->fault->occurrence == place.occurrence)
        inject(t, p, &regs);
}

/* Serves one stop. */
static void at_stop(struct traced_tracer *t, pid_t pid, int status)
{
    struct process *p = process_of(t, pid);
    int signal = WSTOPSIG(status), event = status >> 16;
    if (signal == (SIGTRAP | 0x80) && p)
        at_call(t, p);
    if (signal == (SIGTRAP | 0x80) || event || (signal == SIGSTOP && p && !p->started))
        signal = 0;
    if (p)
        p->started = true;
    /* Another program is not the one that is tested; and one fault is enough. */
    bool leave = event == PTRACE_EVENT_EXEC || (t->done && !(p && p->within));
    ptrace(leave ? PTRACE_DETACH : PTRACE_SYSCALL, pid, NULL, (void *)(long)signal);
}

static int code_of(int status)
{
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

/* Serves all processes until none is left, orphans included. */
static void attend(struct traced_tracer *t, pid_t first)
{
    bool ended = false, killed = false;
    int status;
    for (;;) {
        pid_t pid = waitpid(-1, &status, __WALL);
        if (pid > 0 && WIFSTOPPED(status)) {
            at_stop(t, pid, status);
        } else if (pid > 0) {
            forget(t, pid);
            ended = ended || pid == first;
            if (pid == first && !killed)
                t->result->code = code_of(status);
        } else if (errno != EINTR) {
            return;
        } else if (late) {
            t->result->code = -1;
            if (ended || killed)
                return;
            kill(first, SIGKILL);
            killed = true;
        }
    }
}

static bool trace(struct traced_tracer *t, pid_t first)
{
    const long how = PTRACE_O_TRACESYSGOOD | PTRACE_O_TRACEFORK | PTRACE_O_TRACEVFORK |
                     PTRACE_O_TRACECLONE | PTRACE_O_TRACEEXEC | PTRACE_O_EXITKILL;
    if (!run_to_entry(first))
        return false;
    process_of(t, first)->started = true;
    return !ptrace(PTRACE_SETOPTIONS, first, NULL, (void *)how) &&
           !ptrace(PTRACE_SYSCALL, first, NULL, NULL);
}

static void become(const char *in, const char *out, const char *err)
{
    int to = open(out, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    int errors = open(err, O_WRONLY | O_CREAT | O_TRUNC, 0666), from = open("/dev/null", O_RDONLY);
    if (to < 0 || errors < 0 || from < 0 || dup2(from, 0) < 0 || dup2(to, 1) < 0 ||
        dup2(errors, 2) < 0 || chdir(in) != 0)
        _exit(126);
    for (int file = 3; file < 64; file++)
        close(file);
}

struct traced_result traced_run(char *const argv[], const char *in, const char *out,
                                const char *err, const struct traced_place *fault, int kind,
                                unsigned seconds, traced_fn *each, void *user)
{
    struct traced_result result = {.code = -1};
    struct traced_tracer tracer = {
        .fault = kind ? fault : NULL, .kind = kind, .result = &result, .each = each, .user = user};
    const struct sigaction action = {.sa_handler = on_alarm};
    const bool traced = tracer.fault || each;
    late = 0;
    sigaction(SIGALRM, &action, NULL);
    prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0);
    pid_t pid = fork();
    if (pid == 0) {
        become(in, out, err);
        if (traced && ptrace(PTRACE_TRACEME, 0, NULL, NULL) != 0)
            _exit(125);
        execv(argv[0], argv);
        _exit(127);
    }
    setitimer(ITIMER_REAL, &(struct itimerval){{1, 0}, {seconds, 0}}, NULL);
    if (traced && !trace(&tracer, pid)) {
        kill(pid, SIGKILL);
        result.refused = true;
    }
    attend(&tracer, pid);
    setitimer(ITIMER_REAL, &(struct itimerval){{0, 0}, {0, 0}}, NULL);
    for (int i = 0; i < tracer.count; i++)
        free(tracer.process[i].seen);
    return result;
}

#else

struct traced_result traced_run(char *const argv[], const char *in, const char *out,
                                const char *err, const struct traced_place *fault, int kind,
                                unsigned seconds, traced_fn *each, void *user)
{
    (void)argv, (void)in, (void)out, (void)err, (void)fault;
    (void)kind, (void)seconds, (void)each, (void)user;
    return (struct traced_result){.code = -1, .refused = true};
}

#endif
