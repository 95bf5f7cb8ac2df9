/* A report: one HTML file that needs nothing else, made from results of other commands. It
 * runs nothing itself. Every section shows the parts of its kind, or a line that there are none. */
#ifndef REPORT_H
#define REPORT_H

#include "ref/base/base.h"

#include <jansson.h>
#include <stdio.h>

#define REPORT_BYTES_MOST 3000000u /* of the file */

enum report_kind {
    REPORT_CHECK,    /* JSON of raydiff check */
    REPORT_BENCH,    /* of raydiff bench, or render --benchmark: flat rows */
    REPORT_PICTURES, /* commands that made pictures; JSON of raydiff diff SCENE, or none */
    REPORT_FINDING,  /* JSON of raydiff replay of one file, and what it printed */
    REPORT_MACHINE,  /* of raydiff doctor */
    REPORT_KINDS
};

enum report_state {
    REPORT_RAN,     /* the command did its work; its exit code is the result */
    REPORT_GIVEN,   /* the command ran earlier: read from a file */
    REPORT_SKIPPED, /* wanted, and cannot be had here */
    REPORT_FAILED   /* wanted, and it did not come to a result */
};

/* One part. Owns its texts and JSON. */
struct report_part {
    enum report_kind kind;
    enum report_state state;
    char *name;     /* "check"; of a finding its signature */
    char *command;  /* the line that makes it again, or the file that it was read from */
    char *why;      /* what the command complained of, or why there is no result; "" if nothing */
    char *text;     /* of a finding: what replay printed, else NULL */
    char *known;    /* of a finding: why the baseline excuses it; NULL or "": it does not */
    json_t *json;   /* NULL: none */
    int code;       /* exit code of the command */
    double seconds; /* that it took; 0: not known */
    uint64_t times; /* of a finding: how often it was found, 0: not known */
};

/* A picture, as the bytes of a PNG file. Owns all. */
struct report_picture {
    char *group; /* pictures of one group are side by side under this heading; may be "" */
    char *title, *caption;
    unsigned char *png;
    size_t size;
    uint32_t width, height;
};

struct report {
    const char *title, *command, *when; /* borrowed */
    struct report_part *part;
    size_t part_count, part_capacity;
    struct report_picture *picture;
    size_t picture_count, picture_capacity;
    size_t findings_left_out;  /* of a folder that has more than are shown */
    bool wanted[REPORT_KINDS]; /* requested; a section without parts has a line on that */
};

void report_free(struct report *report);

/* Adds a part of copies of the texts (NULL is ""; text may be NULL); `json` is taken over, also on
 * error. Errors: STATUS_MEMORY. */
enum status report_add(struct report *report, const struct report_part *part,
                       struct reason *reason) MUST_USE;

/* Adds a PNG file. Errors: STATUS_INPUT "PATH: rule": cannot be read, no PNG, damaged, or so large
 * that the report would pass REPORT_BYTES_MOST; STATUS_MEMORY. */
enum status report_add_picture(struct report *report, const char *group, const char *title,
                               const char *caption, const char *path,
                               struct reason *reason) MUST_USE;

/* Reads the JSON file of a command and checks that it is one of this kind.
 * Errors: STATUS_INPUT "PATH: rule"; STATUS_MEMORY. The caller owns *out. */
enum status report_read(const char *path, enum report_kind kind, json_t **out,
                        struct reason *reason) MUST_USE;

/* Whether `json` is what a command of this kind writes. Any JSON can be shown without harm. */
bool report_is(enum report_kind kind, const json_t *json);

/* The exit code that a part adds to the report's: the command's; of doctor 77 (some engine cannot
 * run) is a result like any other. A part that failed without a code is EXIT_INTERNAL. */
int report_part_code(const struct report_part *part);

/* True for a finding that still fails and is in the baseline: it does not count. */
bool report_part_known(const struct report_part *part);

/* All parts together (exit_worse). */
int report_code(const struct report *report);

/* What counts at the end. */
struct report_sum {
    size_t rows, answers, allowed, wrong, published; /* of check: judged answers, and what members
                                                        as published got wrong, which is not */
    size_t bits;                                     /* answers with other bits than engine cpu's */
    size_t findings, failing; /* played again; still failing, not in the baseline */
    size_t known;             /* still failing, in the baseline */
    size_t parts, skipped, failed;
    size_t figures; /* in the page: plots and pictures */
};
struct report_sum report_sum(const struct report *report);

/* Writes the page. Errors: STATUS_MEMORY; write errors are left in the stream for its owner. */
enum status report_write(const struct report *report, FILE *out, struct reason *reason) MUST_USE;

#endif
