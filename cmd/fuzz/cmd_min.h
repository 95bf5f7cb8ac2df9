/* What the parts of raydiff min share. For commands only. */
#ifndef FUZZ_CMD_MIN_H
#define FUZZ_CMD_MIN_H

#include "fuzz/shrink/shrink.h"
#include "cmd/common/cmd_tables.h"

#define MIN_PATH_MOST 4096

struct min_options {
    const char *out, *json;
    bool force;
    uint64_t asks, seconds, trial_seconds, memory_mib;
    struct engine_options engines;
    struct list layout; /* brought from outside */
    struct list named;  /* of --engine */
};

enum min_fate {
    MIN_SMALLER,
    MIN_SMALLEST,  /* nothing smaller was found */
    MIN_NOT_SHOWN, /* it does not show here */
    MIN_SKIPPED,   /* its engine cannot run here, or it is not repeatable */
    MIN_FAILED,    /* see code and reason */
};

/* A finding, and what became of it. */
struct min_row {
    char path[MIN_PATH_MOST];
    char written[MIN_PATH_MOST]; /* "": nothing was */
    struct finding_file file, smaller;
    const struct engine *engine;
    struct shrink_stats stats;
    size_t bytes_before, bytes_after; /* of the files' texts */
    enum min_fate fate;
    struct reason reason;
    int code; /* enum exit_code */
};

/* Refuses options and engines that findings of these engines do not use, in one line. Returns -1 if
 * there are none, else the exit code. */
int min_check_use(const struct min_options *options, const struct list *engine);

/* Shrinks row->file, which was read from row->path with this status and row->reason; sets
 * everything else but `written`. */
void min_shrink(const struct min_options *options, struct min_row *row, enum status status);

void min_row_free(struct min_row *row);

/* Prints what became of a file, and how to go on. */
void min_print(const struct min_row *row);

/* The same of a row of a folder, as a line of a table; NULL: its head. */
void min_print_line(const struct min_row *row);

/* Whether a finding is on the layout. */
typedef bool min_is_on_fn(const void *user, const struct layout *layout);

/* Errors: STATUS_INPUT a layout was brought that no finding of `path` is on. */
enum status min_check_layouts(const struct min_options *options, const char *path,
                              min_is_on_fn *is_on, const void *user,
                              struct reason *reason) MUST_USE;

/* Shrinks the smallest trial of each signature of a folder of findings, prints a table, and writes
 * options->json. Returns the exit code. */
int min_folder(const struct min_options *options, const char *folder);

/* Errors: STATUS_INPUT cannot write; STATUS_MEMORY. */
enum status min_write_json(const char *path, const struct min_row *row, size_t count, int code,
                           struct reason *reason) MUST_USE;

#endif
