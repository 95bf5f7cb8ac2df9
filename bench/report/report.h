/* A report: one self-contained HTML file made from the results of other commands. It runs nothing
 * itself. Every section shows the parts of its kind, or a line if there are none. */
#ifndef REPORT_H
#define REPORT_H

#include "ref/base/base.h"

#include <jansson.h>
#include <stdio.h>

#define REPORT_BYTES_MOST 3000000u /* size limit of the file */

enum report_kind {
    REPORT_CHECK,    /* JSON of raydiff check */
    REPORT_BENCH,    /* JSON of raydiff bench or render --benchmark: flat rows */
    REPORT_PICTURES, /* commands that made pictures; JSON of raydiff diff SCENE, or none */
    REPORT_FINDING,  /* JSON of raydiff replay of one file, and its output */
    REPORT_MACHINE,  /* JSON of raydiff doctor */
    REPORT_KINDS
};

enum report_state {
    REPORT_RAN,     /* the command completed; its exit code is the result */
    REPORT_GIVEN,   /* the command ran earlier; the result was read from a file */
    REPORT_SKIPPED, /* requested, but not possible here */
    REPORT_FAILED   /* requested, but without a result */
};

/* One part of a report. Owns its texts and JSON. */
struct report_part {
    enum report_kind kind;
    enum report_state state;
    char *name;     /* such as "check"; for a finding its signature */
    char *command;  /* the command that makes it again, or the file it was read from */
    char *why;      /* the command's complaints, or why there is no result; "" if none */
    char *text;     /* for a finding: the output of replay; else NULL */
    char *drawing;  /* for a finding: its picture, an SVG element of raydiff explain; NULL: none */
    char *page;     /* for a finding: the link to its page of raydiff web; NULL or "": none */
    char *known;    /* for a finding: why the baseline excuses it; NULL or "": not excused */
    json_t *json;   /* NULL: none */
    int code;       /* exit code of the command */
    double seconds; /* run time; 0: unknown */
    uint64_t times; /* for a finding: how often it was found; 0: unknown */
};

/* A picture, as the bytes of a PNG file. Owns everything. */
struct report_picture {
    char *group; /* pictures of a group are side by side under this heading; may be "" */
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
    size_t findings_left_out;  /* findings of folders that are not shown */
    bool wanted[REPORT_KINDS]; /* requested; a section without parts says so */
};

void report_free(struct report *report);

/* Adds a part with copies of the texts (NULL is stored as ""; text and drawing may be NULL). Takes
 * ownership of `json`, also on error. Errors: STATUS_MEMORY. */
enum status report_add(struct report *report, const struct report_part *part,
                       struct reason *reason) MUST_USE;

/* Adds a PNG file. Errors: STATUS_INPUT "PATH: rule": cannot be read, not a PNG, damaged, or so
 * large that the report would exceed REPORT_BYTES_MOST; STATUS_MEMORY. */
enum status report_add_picture(struct report *report, const char *group, const char *title,
                               const char *caption, const char *path,
                               struct reason *reason) MUST_USE;

/* Reads the JSON file of a command and checks that it has this kind. The caller owns *out. Errors:
 * STATUS_INPUT "PATH: rule"; STATUS_MEMORY. */
enum status report_read(const char *path, enum report_kind kind, json_t **out,
                        struct reason *reason) MUST_USE;

/* Returns whether `json` looks like the output of a command of this kind. Any JSON can be shown
 * safely. */
bool report_is(enum report_kind kind, const json_t *json);

/* The exit code that a part contributes to the report: its command's code. For doctor 77 (some
 * engine cannot run) counts as a normal result. A part that failed without an error code gives
 * EXIT_INTERNAL. */
int report_part_code(const struct report_part *part);

/* True for a finding that still fails and is in the baseline, so that it does not count. */
bool report_part_known(const struct report_part *part);

/* The exit code of all parts together (exit_worse). */
int report_code(const struct report *report);

/* The totals of a report. */
struct report_sum {
    /* Rows of check and judged answers. `published`: wrong answers of members as published, which
     * are not judged. */
    size_t rows, answers, allowed, wrong, published;
    size_t bits;              /* answers with other bits than engine cpu's */
    size_t findings, failing; /* replayed; still failing and not in the baseline */
    size_t known;             /* still failing and in the baseline */
    size_t parts, skipped, failed;
    size_t figures; /* plots and pictures in the page */
};
struct report_sum report_sum(const struct report *report);

/* Writes the page. Errors: STATUS_MEMORY. Write errors stay in the stream for its owner. */
enum status report_write(const struct report *report, FILE *out, struct reason *reason) MUST_USE;

#endif
