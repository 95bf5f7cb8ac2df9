/* What the parts of raydiff report share: commands run as children. For commands only. */
#ifndef CMD_REPORT_H
#define CMD_REPORT_H

#include "bench/report/report.h"
#include "cmd/common/cmd_tables.h"

#define LINE_WORDS      64
#define LINE_TEXT_BYTES 4096
#define RUN_SAID_MOST   600

/* A command line: as its child gets it, and as a person would type it. */
struct line {
    char *argv[LINE_WORDS]; /* owned copies */
    int argc;
    char text[LINE_TEXT_BYTES];
};

/* Where children write to, and how long they may take. */
struct runner {
    char *folder; /* temporary; owned */
    int held;     /* its descriptor: as long as it is open the folder is in use */
    struct progress progress;
    unsigned seconds; /* that a child may take */
    size_t parts;     /* begun so far */
};

/* How a child ended. */
struct run {
    int code;     /* its exit code; EXIT_ENGINE if it was killed or took too long */
    bool stopped; /* by a signal to the report: it ends */
    bool dead;    /* it did not end by itself, or crashed */
    double seconds;
    char said[RUN_SAID_MOST]; /* lines of its standard error, but progress; or how it died */
    struct reason unread;     /* of runner_make: why its result cannot be read */
};

/* Starts a line with the sub-command's name. */
void line_begin(struct line *line, const char *command);
void line_word(struct line *line, const char *word);
/* A file in the runner's folder, which a person's line has without the folder. */
void line_file(struct line *line, const struct runner *runner, const char *name);
void line_free(struct line *line);

/* Makes the folder and takes over SIGINT, SIGTERM and SIGHUP. Errors: STATUS_INPUT it cannot be
 * made; STATUS_MEMORY. */
enum status runner_open(struct runner *runner, struct reason *reason) MUST_USE;

/* Removes the folder with all that is in it; prints why if it cannot. */
void runner_close(struct runner *runner);

/* The signal that stops the report, or 0. */
int runner_signal(void);

/* Path of a file in the folder. */
void runner_path(const struct runner *runner, const char *name, char *path, size_t path_bytes);

typedef int command_fn(int argc, char **argv);

/* Runs a sub-command in a child process, its standard output in the folder's file "out". Errors:
 * STATUS_DEVICE no process to be had. */
enum status runner_run(struct runner *runner, command_fn *command, const struct line *line,
                       struct run *run, struct reason *reason) MUST_USE;

/* Runs the line with "--json" and the folder's file `name` behind it, and frees it. Reads that
 * file, the result, into part->json, and sets code, state, seconds and why (which is borrowed from
 * `run`) of the part; none of them if the run was stopped. Errors: as runner_run. */
enum status runner_make(struct runner *runner, command_fn *command, struct line *line,
                        const char *name, struct run *run, struct report_part *part,
                        struct reason *reason) MUST_USE;

#endif
