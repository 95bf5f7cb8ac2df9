/* Shared by the files of raydiff report: commands run as child processes. Commands only. */
#ifndef CMD_REPORT_H
#define CMD_REPORT_H

#include "bench/report/report.h"
#include "cmd/common/cmd_tables.h"
#include "cmd/common/cmd_progress.h"

#define LINE_WORDS      64
#define LINE_TEXT_BYTES 4096
#define RUN_SAID_MOST   600

/* A command line: argv for the child, and text as a person would type it. */
struct line {
    char *argv[LINE_WORDS]; /* owned copies */
    int argc;
    char text[LINE_TEXT_BYTES];
};

/* Where children write, and how long they may run. */
struct runner {
    char *folder; /* temporary; owned */
    int held;     /* descriptor of the folder; while it is open the folder is in use */
    struct progress progress;
    unsigned seconds; /* time limit of a child */
    size_t parts;     /* started so far */
};

/* The result of a child. */
struct run {
    int code;     /* its exit code; EXIT_ENGINE if it was killed or took too long */
    bool stopped; /* a signal ended the report */
    bool dead;    /* it crashed or was ended */
    double seconds;
    char said[RUN_SAID_MOST]; /* lines of its standard error without progress, or how it ended */
    struct reason unread;     /* from runner_make: why its result cannot be read */
};

/* Starts a line with the sub-command's name. */
void line_begin(struct line *line, const char *command);
void line_word(struct line *line, const char *word);
/* Adds a file in the runner's folder; the text shows it without the folder. */
void line_file(struct line *line, const struct runner *runner, const char *name);
void line_free(struct line *line);

/* Creates the folder and catches SIGINT, SIGTERM and SIGHUP. Errors: STATUS_INPUT it cannot be
 * created; STATUS_MEMORY. */
enum status runner_open(struct runner *runner, struct reason *reason) MUST_USE;

/* Removes the folder and its content. Prints why if it cannot. */
void runner_close(struct runner *runner);

/* The signal that stops the report, or 0. */
int runner_signal(void);

/* Path of a file in the folder. */
void runner_path(const struct runner *runner, const char *name, char *path, size_t path_bytes);

typedef int command_fn(int argc, char **argv);

/* Runs a sub-command in a child process. Its standard output goes to the folder's file "out".
 * Errors: STATUS_DEVICE no process can be created. */
enum status runner_run(struct runner *runner, command_fn *command, const struct line *line,
                       struct run *run, struct reason *reason) MUST_USE;

/* Runs the line followed by "--json" and the folder's file `name`, and frees it. Reads that file,
 * the result, into part->json. Sets code, state, seconds and why (borrowed from `run`) of the part,
 * unless the run was stopped. Errors: those of runner_run. */
enum status runner_make(struct runner *runner, command_fn *command, struct line *line,
                        const char *name, struct run *run, struct report_part *part,
                        struct reason *reason) MUST_USE;

#endif
