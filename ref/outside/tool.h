/* Runs a program once: bytes to its standard input, its standard output whole. For compilers and
 * other filters; for tracers that answer many requests see ref/outside/pipe_child.h. */
#ifndef TOOL_H
#define TOOL_H

#include "ref/base/base.h"

#define TOOL_SAID_MOST 400

/* What to run. */
struct tool_order {
    const char *const
        *argv; /* NULL-terminated; argv[0] is looked for in PATH unless it has a '/' */
    const void *in;
    size_t in_size;
    size_t most;   /* bytes of output; more is an error */
    uint32_t ms;   /* time limit */
    bool diagnose; /* keep all of the standard error output, up to `most` bytes */
};

/* What it did. Owns `out` and `diagnosis`; see tool_free. */
struct tool_answer {
    char *out; /* its output, with a 0 after it */
    size_t size;
    char *diagnosis; /* its standard error output, with a 0 after it; NULL: not kept */
    size_t diagnosis_size;
    char said
        [TOOL_SAID_MOST]; /* the first line of its standard error output, or of its output if that
                                  is empty; printable */
};

/* Writes the path of a program to `path`: of one in PATH, or of a name with a '/'. Returns false if
 * there is none that can be run. */
bool tool_find(const char *name, char *path, size_t path_bytes);

/* Runs the program to its end. What it started is ended with it. *out is to be freed, on errors,
 * too. Errors: STATUS_UNSUPPORTED there is no such program; STATUS_DEVICE no process could be
 * made, it was late, wrote too much, or ended with another exit code than 0 (the reason has its
 * first words); STATUS_MEMORY. */
enum status tool_run(const struct tool_order *order, struct tool_answer *out,
                     struct reason *reason) MUST_USE;

void tool_free(struct tool_answer *answer);

#endif
