/* Runs a program, and all processes that it makes, with one of their system calls failing. */
#ifndef FAULTS_TRACED_H
#define FAULTS_TRACED_H

#include <stdbool.h>
#include <stddef.h>

/* How a call fails: with an error number above 0, or: */
#define FAULT_SHORT (-1) /* a read or write moves one byte */
#define FAULT_KILL  (-2) /* the process is killed when it makes the call */

#define FAULT_KINDS_MOST 6

/* A system call that is counted, and the ways that it may fail. */
struct traced_call {
    const char *name;
    long number;
    long second;                 /* the value of its second argument, -1: any */
    int kinds[FAULT_KINDS_MOST]; /* 0 behind the last */
};

extern const struct traced_call traced_calls[];
extern const size_t traced_call_count;

/* One call of a run: the `occurrence`-th (from 0) of its kind in its process, which is the
 * `process`-th that was made (0: the program itself). */
struct traced_place {
    int process;
    size_t call; /* in traced_calls */
    unsigned occurrence;
    bool counts;   /* it moves more than a byte, so that FAULT_SHORT makes sense */
    bool standard; /* of a standard file: what is interrupted there is restarted (SA_RESTART) */
};

struct traced_result {
    int code; /* exit code, 128 + signal, or -1: it took longer than `seconds` and was killed, or
                 what it left running did */
    bool reached; /* the call came */
    bool refused; /* the system does not let one process trace another */
};

/* Called for each counted call of a run without a fault. */
typedef void traced_fn(void *user, const struct traced_place *place);

/* Runs argv in the folder `in`, its output in the files `out` and `err`. Calls are counted from the
 * program's entry on: what the loader does is not the program's. `kind` 0: nothing fails. Returns
 * when none of its processes is left. */
struct traced_result traced_run(char *const argv[], const char *in, const char *out,
                                const char *err, const struct traced_place *fault, int kind,
                                unsigned seconds, traced_fn *each, void *user);

/* The name of a kind, "ENOSPC", "short", "killed". */
const char *fault_name(int kind);

#endif
