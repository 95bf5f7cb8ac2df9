/* Child processes of raydiff itself: a fork that runs one function and exchanges whole messages
 * with its parent. It may crash, hang or use all memory; the parent continues and learns how it
 * ended. For other programs see ref/outside/pipe_child.h. */
#ifndef FUZZ_CHILD_H
#define FUZZ_CHILD_H

#include "ref/base/base.h"

#include <sys/types.h>

#define CHILD_FOREVER   UINT32_MAX /* as a time in milliseconds */
#define CHILD_FATE_MOST 96

/* One end of the connection, the parent's or the child's. Zero: no child. */
struct child {
    pid_t pid; /* 0 in the child */
    int file;  /* socket; readable when there is something to receive */
    char *bytes;
    size_t got, capacity; /* bytes received of the next message; owned */
};

/* The function that runs in the child. When it returns the process exits with code 0, and nothing
 * of the parent's is flushed, closed or freed. */
typedef void child_fn(struct child *parent, void *user);

/* Starts a process that runs `run`. It has a copy of the parent's memory, but only the standard
 * ones of its open files, and is killed when the parent's thread ends. The child may not need other
 * threads of the parent. Errors: STATUS_DEVICE no process or socket could be made. */
enum status child_start(child_fn *run, void *user, struct child *out,
                        struct reason *reason) MUST_USE;

/* Sends a whole message. Returns false if the other end is gone, or did not receive all of it
 * within `ms`. Then nothing more can be sent. */
bool child_send(struct child *end, const void *bytes, size_t size, uint32_t ms) MUST_USE;

enum child_got {
    CHILD_GOT,     /* a whole message */
    CHILD_LATE,    /* no whole message yet: its bytes are kept, call again */
    CHILD_GONE,    /* the other end ended, perhaps in the middle of a message */
    CHILD_TOO_LONG /* longer than `most`, or no memory: nothing more can be received */
};

/* Receives a message of at most `most` bytes, waiting up to `ms` (0: does not wait). *bytes is
 * valid until the next call. */
enum child_got child_receive(struct child *end, size_t most, uint32_t ms, const void **bytes,
                             size_t *size) MUST_USE;

/* Receives a message of exactly `size` bytes. Returns false if none was received. */
bool child_receive_into(struct child *end, void *bytes, size_t size, uint32_t ms) MUST_USE;

/* Waits up to `ms` until a child has something to receive or has ended. NULL and zero children are
 * skipped; at most CHILDREN_MOST are watched. */
#define CHILDREN_MOST 256u
void child_wait(struct child *const *child, size_t count, uint32_t ms);

/* How a child ended. */
struct child_fate {
    bool forced;                /* killed by child_end */
    int signal;                 /* signal that ended it, or 0 */
    int code;                   /* exit code, if no signal */
    char text[CHILD_FATE_MOST]; /* "killed by signal 11 (Segmentation fault)", "ended itself with
                                   code 3", "did not end by itself" */
};

/* Ends a child and waits for that: closes the connection, waits `ms` for it to end by itself, then
 * kills it (0: kills it at once, unless it has ended). Zeroes *child; `fate` may be NULL. Does
 * nothing on a zero child. */
void child_end(struct child *child, uint32_t ms, struct child_fate *fate);

/* Returns true if the child is stopped (SIGSTOP, Ctrl-Z, a debugger). *debugged: by a debugger. */
bool child_is_stopped(const struct child *child, bool *debugged);

/* Returns the nanoseconds that the child's threads, added up, have waited for a processor (Linux's
 * /proc/PID/task/TID/schedstat). 0 if not known; falls when a thread ends. *running: the number of
 * threads that are running or waiting for a processor. */
uint64_t child_queued_ns(const struct child *child, uint32_t *running);

/* Closes all file descriptors of this process from `first` on, except `kept`. Takes no lock. */
void child_close_files(int first, int kept);

/* Returns the child's resident memory in bytes, 0 if not known. */
uint64_t child_memory(const struct child *child);

/* Returns zeroed memory shared with children started later, or NULL. Free it with child_unshare
 * (NULL is fine). */
void *child_share(size_t bytes) MUST_USE;
void child_unshare(void *memory, size_t bytes);

#endif
