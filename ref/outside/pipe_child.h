/* A child process that runs another program and exchanges messages over its standard input and
 * output. It is always ended: each exchange has a time limit, its memory is limited, and a guardian
 * ends it with all its children, also when this process is killed. */
#ifndef FUZZ_PIPE_CHILD_H
#define FUZZ_PIPE_CHILD_H

#include "ref/outside/guardian.h"

#define PIPE_SAID_MOST 120 /* characters kept of its standard error */

/* A running child. Zero: none. */
struct pipe_child {
    struct guardian guardian;
    int to, from, said_from;
    bool noisy; /* it wrote to its standard error */
    bool mute;  /* it closed its standard error or wrote too much to it: no longer read */
    char said[PIPE_SAID_MOST];
    size_t said_length;
};

static inline bool pipe_child_runs(const struct pipe_child *child)
{
    return child->guardian.pid > 0;
}

/* What runs. */
struct pipe_order {
    const char *command; /* for sh -c; NULL: the object */
    const char *object;  /* a shared object, hosted by this program's file (PIPE_HOST_FLAG) */
    uint32_t megabytes;  /* of address space at most, of an object beyond its host's; UINT32_MAX: no
                            limit */
    uint32_t threads;    /* of an object */
};

/* Runs it in a process group of its own, with no core file. Errors: STATUS_DEVICE no process or
 * pipe. */
enum status pipe_child_start(const struct pipe_order *order, struct pipe_child *out,
                             struct reason *reason) MUST_USE;

/* Ends the child and all its children (guardian_stop), and zeroes *child. Does nothing on a zero
 * child. */
void pipe_child_stop(struct pipe_child *child);

/* A piece of memory to send. */
struct pipe_part {
    const void *bytes;
    size_t size;
};

/* One exchange: the parts are sent while bytes are received in one or more calls. */
struct pipe_talk {
    struct pipe_child *child;
    const struct pipe_part *part;
    size_t part_count, at; /* bytes sent of the current part */
    bool broken;           /* the peer has closed its input */
    uint64_t deadline_ns;  /* time_ns() */
    size_t got;            /* bytes received by the last call */
};

enum pipe_end {
    PIPE_GOT,   /* all bytes were received */
    PIPE_LONG,  /* more bytes followed */
    PIPE_LATE,  /* the deadline passed */
    PIPE_CLOSED /* the peer closed its output */
};

/* Returns true if the child has written a byte between exchanges. */
bool pipe_child_is_early(struct pipe_child *child);

/* Sends the parts and receives `size` bytes; if `last`, then checks that no more follow. Never
 * blocks longer than the deadline. */
enum pipe_end pipe_talk(struct pipe_talk *talk, void *bytes, size_t size, bool last);

/* Reads what the child has written to its standard error so far. */
void pipe_child_listen(struct pipe_child *child);

#define PIPE_FATE_MOST 64

/* Waits up to `ms` for the child to end by itself and writes how: "it ended with exit code 3", "it
 * was ended by signal 11", or "it closed its output". *missing: the shell did not find the command
 * (exit codes 126 and 127). pipe_child_stop must still be called. */
void pipe_child_fate(struct pipe_child *child, unsigned ms, char text[PIPE_FATE_MOST],
                     bool *missing);

#endif
