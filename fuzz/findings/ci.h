/* Results as continuous integration reads them: JUnit XML and TAP, of test cases one after another.
 * Text of any bytes is taken: what is no printable UTF-8 is written as '?'. */
#ifndef FUZZ_CI_H
#define FUZZ_CI_H

#include "ref/base/base.h"
#include "ref/files/file.h"

enum ci_state {
    CI_PASSED,
    CI_FAILED,
    CI_KNOWN,   /* a known failure: "not ok" that counts as none in TAP, skipped in JUnit */
    CI_SKIPPED, /* was not run */
};

struct ci_case {
    const char *group; /* in JUnit alone */
    const char *name;  /* unique in a run */
    enum ci_state state;
    const char *why;    /* one line of all that did not pass; NULL or "": none */
    const char *type;   /* of a failure, one word; NULL: "failure" */
    const char *detail; /* lines that help to understand it, '\n' between them; NULL or "": none */
    double seconds;     /* that it took; 0: not known */
};

/* Writes `text` so that it can stand in an attribute or in an element of XML 1.0. */
void ci_xml(FILE *to, const char *text);

/* Writes `text` in double quotes, as JSON and YAML read it. */
void ci_quote(FILE *to, const char *text);

/* Writes `text` on one line, as a description or a directive of TAP: an unescaped '#' would begin a
 * directive. */
void ci_line(FILE *to, const char *text);

/* Writes `text` with nothing escaped. */
void ci_plain(FILE *to, const char *text);

/* A JUnit file being written; the cases are kept in memory, since the head has their number. Zero
 * is none. */
struct ci_junit {
    struct file_out out;
    FILE *body; /* a stream into `text` */
    char *text;
    size_t bytes, cases, failures, skipped;
};

/* Opens the file, so that an unwritable one fails before the work is done. Errors:
 * STATUS_INPUT cannot write; STATUS_MEMORY. */
enum status ci_junit_open(const char *path, struct ci_junit *out, struct reason *reason) MUST_USE;
void ci_junit_add(struct ci_junit *junit, const struct ci_case *one);
/* Writes everything as one suite of that name; the file appears whole or not at all. Errors:
 * STATUS_INPUT cannot write; STATUS_MEMORY. */
enum status ci_junit_close(struct ci_junit *junit, const char *suite, double seconds,
                           struct reason *reason) MUST_USE;
void ci_junit_discard(struct ci_junit *junit); /* a zero or closed one is fine */

/* TAP. Version 13, which all readers of version 14 take, and prove of Perl 5.36 takes no later one;
 * '#' in a name is escaped as in version 14. */
void ci_tap_head(FILE *to, size_t cases);
/* The head in two parts, if the number of cases is known only after the last one. */
void ci_tap_version(FILE *to);
void ci_tap_plan(FILE *to, size_t cases);
void ci_tap_case(FILE *to, size_t number, const struct ci_case *one); /* numbers begin at 1 */

#endif
