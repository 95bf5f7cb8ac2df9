/* Results of the conformance suite: text, TAP, JUnit, waivers. For commands only. */
#ifndef CMD_CONFORM_REPORT_H
#define CMD_CONFORM_REPORT_H

#include "ref/match.h"
#include "scenes/file.h"

#define WAIVER_MOST 64

struct waiver {
    char pattern[256];
    char reason[256];
    size_t used;
};

struct conform_report {
    size_t expected, done;
    size_t passed, failed, skipped, waived;
    size_t rays, count[VERDICT_COUNT];
    bool verbose, tap;
    int code;
    uint64_t start_ns;
    struct waiver waiver[WAIVER_MOST];
    size_t waiver_count;
    struct file_out junit; /* stream NULL: none */
    const char *waiver_path;
};

/* Reads the waivers and opens the JUnit file. Errors: STATUS_INPUT bad waiver line, cannot write.
 */
enum status conform_report_open(struct conform_report *report, size_t expected, bool verbose,
                                bool tap, const char *waivers, const char *junit,
                                struct reason *reason) MUST_USE;

/* Adds the outcome of one trial: `status` and `reason` of stage_run, and its row. */
void conform_report_add(struct conform_report *report, const char *name, enum status status,
                        const struct row *row, const struct reason *reason, bool required,
                        double seconds);

/* Prints the summary, finishes files, fails waivers that matched nothing; returns the exit code. */
int conform_report_close(struct conform_report *report);

#endif
