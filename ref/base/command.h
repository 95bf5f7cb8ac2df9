/* The interface of a sub-command, and the exit codes that all of them share. */
#ifndef COMMAND_H
#define COMMAND_H

#include "ref/base/base.h"

#include <stdio.h>

/* Exit codes of every sub-command. If several apply, the first of this list is returned:
 * EXIT_INTERNAL, EXIT_ENGINE, EXIT_USAGE, EXIT_MISMATCH, EXIT_SKIPPED, EXIT_AGREE. */
enum exit_code {
    EXIT_AGREE = 0,
    EXIT_MISMATCH = 1, /* an engine's result differs beyond the allowed classes */
    EXIT_USAGE = 2,    /* unknown flag or name, bad input, the chosen layout cannot pack the
                          scene */
    EXIT_ENGINE = 3,   /* an engine crashed, hung or could not finish a ray */
    EXIT_INTERNAL = 4, /* out of memory, or our own bug */
    EXIT_SKIPPED = 77, /* a chosen engine cannot run here */
};

/* Returns the exit code for a and b together. */
int exit_worse(int a, int b);

/* Returns the exit code of a status that ends a command. STATUS_OK gives EXIT_AGREE. */
int exit_of_status(enum status status);

/* Prints "raydiff COMMAND: REASON" to stderr unless the status is STATUS_OK. Returns
 * exit_of_status. */
int exit_with_reason(const char *command, enum status status, const struct reason *reason);

/* Returns "" for 1, else "s". */
const char *plural(uint64_t count);

/* One sub-command: argv[0] is its name; --help is handled by the command itself. */
struct command {
    const char *name;
    const char *summary;
    int (*run)(int argc, char **argv);
    const char *group; /* the command whose name may precede it, or NULL */
};

int cmd_bench(int argc, char **argv);
int cmd_bisect(int argc, char **argv);
int cmd_check(int argc, char **argv);
int cmd_conform(int argc, char **argv);
int cmd_construct(int argc, char **argv);
int cmd_diff(int argc, char **argv);
int cmd_doctor(int argc, char **argv);
int cmd_explain(int argc, char **argv);
int cmd_export(int argc, char **argv);
int cmd_fuzz(int argc, char **argv);
int cmd_gen(int argc, char **argv);
int cmd_judge(int argc, char **argv);
int cmd_build(int argc, char **argv);
int cmd_leaks(int argc, char **argv);
int cmd_list(int argc, char **argv);
int cmd_min(int argc, char **argv);
int cmd_merge(int argc, char **argv);
int cmd_precompute(int argc, char **argv);
int cmd_render(int argc, char **argv);
int cmd_replay(int argc, char **argv);
int cmd_report(int argc, char **argv);
int cmd_tree(int argc, char **argv);
int cmd_web(int argc, char **argv);
int cmd_scene(int argc, char **argv);
int cmd_verify(int argc, char **argv);

/* Prints "raydiff COMMAND: TEXT" to stderr with a hint at --help and returns EXIT_USAGE. */
int usage_error(const char *command, const char *format, ...) PRINTF_LIKE(2, 3);

/* Appends a blank and the word to a command line, quoted for a shell if necessary; as much as
 * fits. */
void command_word(char *text, size_t text_bytes, const char *word);

/* Parses a whole decimal integer in [least, most]; "1e6" style powers are accepted.
 * Errors: STATUS_INPUT with the flag, the text and the range. */
enum status parse_count(const char *flag, const char *text, uint64_t least, uint64_t most,
                        uint64_t *out, struct reason *reason) MUST_USE;

/* Parses a whole finite float. Errors: STATUS_INPUT with the flag and the text. */
enum status parse_float(const char *flag, const char *text, float *out,
                        struct reason *reason) MUST_USE;

#endif
