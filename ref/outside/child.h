/* A child process of our own: a function in a fork, and whole messages between it and its parent.
 * It may crash, hang or use all memory; the parent continues and receives how it ended. For
 * other programs see ref/outside/pipe_child.h. */
#ifndef FUZZ_CHILD_H
#define FUZZ_CHILD_H

#include "ref/base/base.h"

#include <sys/types.h>

#define CHILD_FOREVER   UINT32_MAX /* as a number of milliseconds */
#define CHILD_FATE_MOST 96

/* One end of the talk, the parent's or the child's. Zero: there is none. */
struct child {
    pid_t pid; /* 0 in the child */
    int file;  /* for poll: readable when there is something to receive */
    char *bytes;
    size_t got, capacity; /* received so far of the next message; owned */
};

/* The child's life; when it returns the process ends with code 0 and nothing of the parent's is
 * flushed, closed or freed. */
typedef void child_fn(struct child *parent, void *user);

/* Makes a process that runs `run`. All that the parent has in memory is there as well, but of open
 * files only the standard ones; it is killed when the parent's thread ends. The parent may have no
 * threads that the child would need. Errors: STATUS_DEVICE no process or socket could be made. */
enum status child_start(child_fn *run, void *user, struct child *out,
                        struct reason *reason) MUST_USE;

/* Sends a whole message. False: the other end is gone, or did not take it all within `ms`; then
 * nothing more can be sent. */
bool child_send(struct child *end, const void *bytes, size_t size, uint32_t ms) MUST_USE;

enum child_got {
    CHILD_GOT,     /* a message */
    CHILD_LATE,    /* not yet a whole one: what came is kept, call again */
    CHILD_GONE,    /* the other end ended, perhaps within a message */
    CHILD_TOO_LONG /* longer than `most`, or no memory: nothing more can be received */
};

/* Receives a message of at most `most` bytes, waiting up to `ms` (0: takes what is there). *bytes
 * is valid until the next call. */
enum child_got child_receive(struct child *end, size_t most, uint32_t ms, const void **bytes,
                             size_t *size) MUST_USE;

/* Receives a message of exactly `size` bytes. False: none was received. */
bool child_receive_into(struct child *end, void *bytes, size_t size, uint32_t ms) MUST_USE;

/* Waits up to `ms` until one of them has something to receive or has ended; NULL and zero ones are
 * skipped. At most CHILDREN_MOST. */
#define CHILDREN_MOST 256u
void child_wait(struct child *const *child, size_t count, uint32_t ms);

/* How a child ended. */
struct child_fate {
    bool forced;                /* by child_end */
    int signal;                 /* that ended it, or 0 */
    int code;                   /* else its exit code */
    char text[CHILD_FATE_MOST]; /* "killed by signal 11 (Segmentation fault)", "ended itself with
                                   code 3", "did not end by itself" */
};

/* Ends it and waits for that: closes the talk, gives it `ms` to end by itself, then kills it (0: at
 * once, unless it has ended already). Zeroes *child; `fate` may be NULL. A zero one is fine. */
void child_end(struct child *child, uint32_t ms, struct child_fate *fate);

/* True if it is stopped: SIGSTOP, Ctrl-Z, a debugger (*debugged). */
bool child_is_stopped(const struct child *child, bool *debugged);

/* Nanoseconds that its threads, added up, have waited for a processor that others had (Linux's
 * /proc/PID/task/TID/schedstat; 0 if that is not known; falls when a thread ends). *running: how
 * many of them want one now. */
uint64_t child_queued_ns(const struct child *child, uint32_t *running);

/* Closes all files of this process from number `first` on, except `kept`. Takes no lock. */
void child_close_files(int first, int kept);

/* Bytes of memory that it has in use, 0 if that is not known. */
uint64_t child_memory(const struct child *child);

/* Zeroed memory that parent and children made later share, or NULL; freed by child_unshare (NULL is
 * fine). */
void *child_share(size_t bytes) MUST_USE;
void child_unshare(void *memory, size_t bytes);

#endif
