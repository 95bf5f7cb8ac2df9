/* Results of the conformance suite: text, TAP, JUnit, waivers. Commands only. */
#ifndef CMD_CONFORM_REPORT_H
#define CMD_CONFORM_REPORT_H

#include "cmd/common/cmd_compiler.h"
#include "cmd/common/cmd_tables.h"
#include "ref/match/turnout.h"
#include "tests/hard/matrix.h"
#include "fuzz/findings/ci.h"
#include "fuzz/findings/waivers.h"

/* Options of raydiff conform. */
struct conform_options {
    const char *pattern, *junit, *waivers, *markdown, *html; /* each may be NULL */
    bool list_only, verbose, tap, hard, summary, quick, worlds;
    struct list list[TABLE_COUNT], require; /* per table, the members to play; empty: the default */
    bool all;
    struct match_demands demands;
    uint64_t count, brute;
    struct engine_options engines;
    struct compiler_options compilers;
    struct screen_options screen;
};

struct conform_report {
    size_t expected /* 0: unknown until the end */, done;
    size_t outcomes[OUTCOME_COUNT];
    size_t vacuous; /* failed since too few of their rays hit anything */
    size_t absent;  /* skipped because the engine cannot run here at all */
    size_t rays, count[VERDICT_COUNT];
    size_t published; /* WRONG answers of members as published; not in `count` */
    size_t excused;   /* rays of hard cases whose failure is waived or known; not in `rays` */
    bool verbose, tap, complete;
    bool quiet; /* do not print waived entries: a matrix shows them */
    int code;
    uint64_t start_ns;
    struct screen screen;
    struct engine_options options; /* for the engines whose versions waivers name */
    struct turnout turnout;        /* of the named members */
    struct waivers waivers;
    char versions[8192];   /* from conform_versions, if a waiver needs them */
    struct ci_junit junit; /* body NULL: no JUnit file */
};

/* The result of one trial or hard case. */
struct conform_entry {
    const char *name;
    enum matrix_outcome outcome; /* a waiver turns OUTCOME_FAILED into OUTCOME_WAIVED */
    const char *why;
    int code;   /* exit code of a failure */
    bool plain; /* a failure that no waiver may excuse */
    double seconds;
};

/* Writes the description of every engine, one or more lines each, or why it cannot run. */
void conform_versions(const struct engine_options *options, char *text, size_t text_bytes);

/* Reads the waivers and opens the JUnit file of the options.
 *   expected   number of entries; 0: unknown until the end
 *   complete   no pattern limits the suite: waivers that match nothing are faults
 *   named      members that must answer something, or the run fails
 * Errors: STATUS_INPUT bad waiver line, cannot write. */
enum status conform_report_open(struct conform_report *report,
                                const struct conform_options *options, size_t expected,
                                bool complete, const struct list named[TABLE_COUNT],
                                struct reason *reason) MUST_USE;

/* Counts and prints an entry. Returns its outcome after waivers, and the waiver that excuses it in
 * *waiver (may be NULL). */
enum matrix_outcome conform_report_put(struct conform_report *report,
                                       const struct conform_entry *entry,
                                       const struct waiver **waiver);

/* Adds the outcome of one trial: `status` and `reason` of trial_stage_run, and its row. */
void conform_report_add(struct conform_report *report, const char *name, enum status status,
                        const struct row *row, const struct reason *reason, bool required,
                        double seconds);

/* Prints the summary and finishes the files. Waivers that matched nothing and named members that
 * answered nothing are failures. Returns the exit code. */
int conform_report_close(struct conform_report *report);

#endif
