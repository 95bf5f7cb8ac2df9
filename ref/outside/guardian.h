/* A process between ours and a command of another program. It outlives us by as long as it takes to
 * end the command and all that it has started: children, their children, those that were left by
 * their parents and those in sessions of their own. That happens when its line is closed, by us or
 * by the kernel when we are killed.
 *
 * Not ended are processes that the command had another one start (a service manager, a container's
 * daemon), that run as another user, or that exit faster than they can be looked up while each
 * starts the next. */
#ifndef FUZZ_GUARDIAN_H
#define FUZZ_GUARDIAN_H

#include "ref/base/base.h"

#include <sys/types.h>

struct guardian {
    pid_t pid; /* 0: none */
    int line;  /* readable when the command has ended */
};

/* What becomes of the command's process, in a process group of its own: it calls exec. In a fork of
 * a process with threads: nothing in it may take a lock. */
typedef void guardian_fn(const void *user);

/* Starts a guardian and the command. Errors: STATUS_DEVICE no process or socket could be made. */
enum status guardian_start(guardian_fn *run, const void *user, struct guardian *out,
                           struct reason *reason) MUST_USE;

/* Waits up to `ms` for the command itself to end. True: *status is that of waitpid. */
bool guardian_ended(struct guardian *guardian, unsigned ms, int *status);

/* Ends the command and all that it started, and zeroes it. Returns when that is done, or after some
 * seconds: what the kernel does not let go of is left to the guardian. A zero one is fine. */
void guardian_stop(struct guardian *guardian);

#endif
