/* Shared by the files of raydiff fuzz --self-test. Commands only. */
#ifndef FUZZ_CMD_SELFTEST_H
#define FUZZ_CMD_SELFTEST_H

#include "fuzz/selftest/selftest.h"

#define SELFTEST_JOBS_MOST   64u
#define SELFTEST_CHOICE_MOST 32u

/* A program of the self-test: one with a planted bug, or a control, which is the program without a
 * bug played in the field of some of them. */
struct selftest_row {
    const struct selftest_bug *bug; /* for a control: the first bug of its field */
    bool control;
    bool started, ended, printed;
    char folder[SELFTEST_PATH_MOST], program[SELFTEST_PATH_MOST];
    struct selftest_job job;
};

struct selftest_command {
    uint64_t seed;
    unsigned seconds, jobs, control;
    const char *json, *programs;
    const char *choice[SELFTEST_CHOICE_MOST]; /* none: all */
    size_t choices;
    bool shaders_only, terminal;
    char self[SELFTEST_PATH_MOST], folder[SELFTEST_PATH_MOST];
    struct selftest_bug *bug; /* the table */
    size_t bugs;
    struct selftest_row *row; /* bugs first, then controls */
    size_t rows, planted;     /* planted: how many rows are bugs */
    uint64_t start_ns;
};

/* Summary of a self-test. */
struct selftest_sum {
    size_t found, planted, skipped, clean, controls; /* planted and controls exclude skipped ones */
    double median_s, slowest_s;                      /* over found bugs */
    double seconds;                                  /* total */
};

struct selftest_sum selftest_sum(const struct selftest_command *command);
bool selftest_passed(const struct selftest_sum *sum);

/* Errors: those of json_write. */
enum status selftest_json(const struct selftest_command *command, const struct selftest_sum *sum,
                          struct reason *reason) MUST_USE;

/* Print the heading; all ended rows up to the first unfinished one that are not printed yet; the
 * last lines. */
void selftest_print_head(void);
void selftest_print_rows(struct selftest_command *command);
void selftest_print_sum(const struct selftest_sum *sum);

/* raydiff fuzz --self-test; argv[0] is "--self-test". */
int cmd_selftest(int argc, char **argv);

#endif
