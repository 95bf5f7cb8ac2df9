/* Shared by the files of raydiff min. Commands only. */
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
    struct list layout; /* external layouts */
    struct list named;  /* from --engine */
};

enum min_fate {
    MIN_SMALLER,
    MIN_SMALLEST,  /* nothing smaller was found */
    MIN_NOT_SHOWN, /* the finding does not show here */
    MIN_SKIPPED,   /* its engine cannot run here, or it is not repeatable */
    MIN_FAILED,    /* see code and reason */
};

/* A finding and the result of shrinking it. */
struct min_row {
    char path[MIN_PATH_MOST];
    char written[MIN_PATH_MOST]; /* "": nothing was written */
    struct finding_file file, smaller;
    const struct engine *engine;
    struct shrink_stats stats;
    size_t bytes_before, bytes_after; /* sizes of the files' texts */
    enum min_fate fate;
    struct reason reason;
    int code; /* enum exit_code */
};

/* Rejects options and engines that findings of these engines do not use, and prints one line.
 * Returns -1 if there are none, else the exit code. */
int min_check_use(const struct min_options *options, const struct list *engine);

/* Shrinks row->file, which was read from row->path with this status and row->reason. Sets all other
 * fields except `written`. */
void min_shrink(const struct min_options *options, struct min_row *row, enum status status);

void min_row_free(struct min_row *row);

/* Prints the result for a file and the command to continue with. */
void min_print(const struct min_row *row);

/* Prints a folder's row as a line of a table; NULL: prints the table's head. */
void min_print_line(const struct min_row *row);

/* Returns whether a finding uses the layout. */
typedef bool min_is_on_fn(const void *user, const struct layout *layout);

/* Errors: STATUS_INPUT no finding of `path` uses one of the external layouts. */
enum status min_check_layouts(const struct min_options *options, const char *path,
                              min_is_on_fn *is_on, const void *user,
                              struct reason *reason) MUST_USE;

/* Shrinks the smallest trial of each signature in a folder of findings, prints a table, and writes
 * options->json. Returns the exit code. */
int min_folder(const struct min_options *options, const char *folder);

/* Errors: STATUS_INPUT the file cannot be written; STATUS_MEMORY. */
enum status min_write_json(const char *path, const struct min_row *row, size_t count, int code,
                           struct reason *reason) MUST_USE;

#endif
