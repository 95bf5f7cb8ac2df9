/* Writing to a program that may have ended. */
#ifndef QUIET_H
#define QUIET_H

#include <stddef.h>
#include <sys/types.h>

/* write() without a SIGPIPE: the library does not change the process's signal handling. */
ssize_t write_quietly(int to, const void *bytes, size_t size);

#endif
