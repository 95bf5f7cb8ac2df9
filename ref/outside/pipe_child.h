/* A child process with messages over its standard input and output. It is always ended: there is a
 * time limit for each exchange, a memory limit, and a guardian that ends it with all its children,
 * also when this process is killed. */
#ifndef FUZZ_PIPE_CHILD_H
#define FUZZ_PIPE_CHILD_H

#include "ref/outside/guardian.h"

#define PIPE_SAID_MOST 120 /* kept of what it writes to its standard error */

/* Zero, or running. */
struct pipe_child {
    struct guardian guardian;
    int to, from, said_from;
    bool noisy; /* it wrote to its standard error */
    bool mute;  /* it closed it, or wrote too much: no longer listened to */
    char said[PIPE_SAID_MOST];
    size_t said_length;
};

static inline bool pipe_child_runs(const struct pipe_child *child)
{
    return child->guardian.pid > 0;
}

/* Runs `sh -c command` in a process group of its own, with at most `megabytes` of address space
 * (UINT32_MAX: no limit) and no core file. Errors: STATUS_DEVICE no process or pipe. */
enum status pipe_child_start(const char *command, uint32_t megabytes, struct pipe_child *out,
                             struct reason *reason) MUST_USE;

/* Ends the child and all its children (guardian_stop); zeroes it. A zero one is fine. */
void pipe_child_stop(struct pipe_child *child);

/* A piece of memory to send. */
struct pipe_part {
    const void *bytes;
    size_t size;
};

/* One exchange: parts to send, while bytes are received in one or more calls. */
struct pipe_talk {
    struct pipe_child *child;
    const struct pipe_part *part;
    size_t part_count, at; /* of the part that is being sent, `at` bytes are */
    bool broken;           /* the peer does not read any more */
    uint64_t deadline_ns;  /* time_ns() */
    size_t got;            /* bytes received by the last call */
};

enum pipe_end {
    PIPE_GOT,   /* all bytes of the answer */
    PIPE_LONG,  /* it wrote more than these */
    PIPE_LATE,  /* the deadline passed */
    PIPE_CLOSED /* its output ended */
};

/* True if it has written something that is not waited for; between exchanges. */
bool pipe_child_is_early(struct pipe_child *child);

/* Sends, and receives `size` bytes, then checks that nothing follows if `last`. Never blocks longer
 * than the deadline. */
enum pipe_end pipe_talk(struct pipe_talk *talk, void *bytes, size_t size, bool last);

/* Takes what the child has written to its standard error so far. */
void pipe_child_listen(struct pipe_child *child);

#define PIPE_FATE_MOST 64

/* Waits up to `ms` for the child to end by itself and writes how: "it ended with exit code 3", "it
 * was ended by signal 11", or "it closed its output". *missing: the shell did not find the command
 * (exit codes 126 and 127). It is still to be stopped. */
void pipe_child_fate(struct pipe_child *child, unsigned ms, char text[PIPE_FATE_MOST],
                     bool *missing);

#endif
