/* The self-test of the fuzzer: planted bugs (fuzz/selftest.txt), a whole program of each, and how
 * long the fuzzer in that program takes to find it. */
#ifndef FUZZ_SELFTEST_H
#define FUZZ_SELFTEST_H

#include "ref/outside/child.h"
#include "fuzz/play/signature.h"

#define SELFTEST_PATH_MOST 4096
#define SELFTEST_SAID_MOST 256

/* A line of the table. */
struct selftest_bug {
    char bug[32];     /* a record of tests/planted */
    char unit[48];    /* the C unit or the shader that is compiled with it */
    char engines[48]; /* as of raydiff fuzz --engine; "spirv": shaders are only checked;
                         "pairs:ENGINE,...": members are drawn, with --pairs;
                         "worlds:ENGINE,...": trials of worlds, with --worlds */
    char layouts[48];
    char kind[24]; /* of bug */
};

/* Reads the table. Errors: STATUS_INPUT "PATH:LINE: rule"; STATUS_MEMORY. Caller frees *out. */
enum status selftest_read(const char *path, struct selftest_bug **out, size_t *count,
                          struct reason *reason) MUST_USE;
/* The same of a text in memory; `name` stands in messages. */
enum status selftest_parse(const char *name, const char *text, struct selftest_bug **out,
                           size_t *count, struct reason *reason) MUST_USE;

#define SELFTEST_NAME_MOST 96

/* "LOST_SLOT.layout_rf16": the folder of the bug's program. */
void selftest_name(const struct selftest_bug *bug, char name[SELFTEST_NAME_MOST]);

/* True if `choice` is the bug's name, its program's, its kind or its engines. */
bool selftest_chosen(const struct selftest_bug *bug, const char *choice);

enum selftest_end {
    SELFTEST_FOUND,
    SELFTEST_CLEAN,   /* nothing was found */
    SELFTEST_SKIPPED, /* an engine cannot run here */
    SELFTEST_FAILED,  /* the program failed otherwise: see `said` */
};

struct selftest_result {
    enum selftest_end end;
    uint64_t trials; /* until the first that showed it; all, if none did */
    double seconds;  /* of the whole program: its start, the finding's explanation, its end */
    char said
        [SELFTEST_SAID_MOST]; /* the signature; the output of the shaders' check; why it failed */
};

/* A program to be run. Everything borrowed. */
struct selftest_job {
    const char *program;
    const char *folder; /* its own: emptied of what an earlier run has left, gets "found",
                           "report.json" and "log" */
    const char *engines, *layouts;
    uint64_t seed;
    uint64_t trials;  /* play so many; 0: until something is found */
    unsigned seconds; /* at most, if trials is 0 */
    struct selftest_result result;
    /* Private. */
    struct child child;
    uint64_t start_ns, seen_ns; /* seen: when it first had a finding */
    bool stopping;
    char found[SELFTEST_PATH_MOST], log[SELFTEST_PATH_MOST], report[SELFTEST_PATH_MOST];
};

/* Starts it. Errors: STATUS_INPUT the folder cannot be written; as child_start. */
enum status selftest_start(struct selftest_job *job, struct reason *reason) MUST_USE;

/* Waits up to `ms` until one of the started jobs may have ended; NULL ones are skipped. */
void selftest_wait(struct selftest_job *const *job, size_t count, uint32_t ms);

/* False if it still runs; else job->result is set. A program that takes far longer than it may is
 * ended. Errors in *status: STATUS_MEMORY. */
bool selftest_ended(struct selftest_job *job, enum status *status, struct reason *reason);

/* Ends it at once, if it runs. */
void selftest_stop(struct selftest_job *job);

#endif
