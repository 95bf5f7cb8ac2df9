/* The process that runs a guest: it answers the protocol of ref/outside/pipe.h. */
#ifndef GUEST_HOST_H
#define GUEST_HOST_H

#include "ref/guest/guest.h"

/* True if the arguments of main() are those of a host (PIPE_HOST_FLAG). */
bool guest_host_is_meant(int argc, char *const *argv);

/* Answers requests from the standard input on the standard output until its input ends; the guest
 * itself gets an empty input and an output that goes nowhere. Returns an exit code: 0, or 3 where
 * the guest failed otherwise than by refusing, with one line on the standard error. */
int guest_host_main(char *const *argv);

#endif
