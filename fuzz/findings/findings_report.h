/* The result of a campaign for machines: JUnit XML, TAP and JSON lines. One test case fails if no
 * trial was played, one per contestant if it tested nothing, and one per finding if the finding
 * counts. So the number of failures is the number of findings outside the baseline, and a campaign
 * that tested nothing fails. */
#ifndef FINDINGS_REPORT_H
#define FINDINGS_REPORT_H

#include "ref/base/base.h"

enum findings_report_state {
    REPORT_NEW,
    REPORT_KNOWN,   /* in the baseline: does not count */
    REPORT_EXPIRED, /* was in the baseline: counts */
    REPORT_FLAKY,   /* did not show when it was played again: does not count */
};

/* "new", "known", "expired", "flaky". */
const char *report_state_name(enum findings_report_state state);

/* Strings are borrowed; NULL and "" stand for none. */
struct report_finding {
    const char *signature;
    uint64_t count; /* how often it was found */
    enum findings_report_state state;
    const char *reason;                 /* of known, expired and flaky ones, one line */
    const char *cause;                  /* what its cause means, one line */
    const char *opinion;                /* what was seen of the first, one line */
    uint32_t triangles, rays, vertices; /* of the smallest */
    const char *first, *smallest;       /* paths */
    const char *replay;                 /* a command */
};

struct report_contestant {
    const char *name;    /* "cpu.rf16", "embree_robust" */
    uint64_t played;     /* trials of the campaign */
    uint64_t declined;   /* likewise, by the engine */
    uint64_t refused;    /* trials of this run, by the layout */
    double seconds;      /* of work */
    const char *why;     /* it was not played; NULL: because there was no trial, or it refused */
    const char *vacuous; /* why it tested nothing, or loses too much, a failure; NULL: it did, or
                            was not asked */
};

struct findings_report {
    uint64_t seed, trials;         /* of all runs of the campaign */
    uint64_t before;               /* of these trials, those of earlier runs */
    uint64_t judged;               /* of this run: rays with a verdict of all that played */
    double seconds, harness_share; /* of this run on the clock; of the time, what was not the
                                      engines' */
    const struct report_contestant *contestant;
    size_t contestants;
    const struct report_finding *finding;
    size_t findings;
    const char *const *note; /* other lines worth reading: unused entries of a baseline, ... */
    size_t notes;
};

/* True if the finding fails a campaign. */
bool report_counts(const struct report_finding *finding);

/* How many test cases fail; 0 is exit code 0. */
size_t report_failures(const struct findings_report *report);

/* Each writes `path` whole or not at all. Errors: STATUS_INPUT cannot write; STATUS_MEMORY. */
enum status report_junit(const struct findings_report *report, const char *path,
                         struct reason *reason) MUST_USE;
enum status report_tap(const struct findings_report *report, const char *path,
                       struct reason *reason) MUST_USE;
/* One object a line: {"type": "campaign" | "contestant" | "finding" | "note", ...}. */
enum status report_jsonl(const struct findings_report *report, const char *path,
                         struct reason *reason) MUST_USE;

#endif
