/* A guardian is a process between raydiff and a command of another program. When its socket is
 * closed, by raydiff or by the kernel because raydiff was killed, it ends the command and every
 * process that it started: children, their children, orphans, and those in sessions of their own.
 * Then it exits.
 *
 * Not ended are processes that another one started for the command (a service manager, a
 * container's daemon), that run as another user, or that exit faster than they can be looked up
 * while each starts the next. */
#ifndef FUZZ_GUARDIAN_H
#define FUZZ_GUARDIAN_H

#include "ref/base/base.h"

#include <sys/types.h>

struct guardian {
    pid_t pid; /* 0: none */
    int line;  /* socket; readable when the command has ended */
};

/* The function that runs in the command's process, in a process group of its own, and calls exec.
 * It runs after a fork of a process with threads, so it must not take a lock. */
typedef void guardian_fn(const void *user);

/* Starts a guardian and the command. Errors: STATUS_DEVICE no process or socket could be made. */
enum status guardian_start(guardian_fn *run, const void *user, struct guardian *out,
                           struct reason *reason) MUST_USE;

/* Waits up to `ms` for the command itself to end. Returns true if it has; *status is that of
 * waitpid. */
bool guardian_ended(struct guardian *guardian, unsigned ms, int *status);

/* Ends the command and all that it started, and zeroes *guardian. Returns when that is done, or
 * after some seconds; the guardian then continues with what the kernel has not ended yet. Does
 * nothing on a zero guardian. */
void guardian_stop(struct guardian *guardian);

#endif
