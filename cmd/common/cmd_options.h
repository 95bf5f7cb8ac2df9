/* Which options a command was given, and the files that they name to be written. For commands only. */
#ifndef CMD_OPTIONS_H
#define CMD_OPTIONS_H

#include "ref/match/match.h"
#include "ref/files/file.h"

/* Name of the i-th option that the last options_read was given, without dashes and each once; NULL
 * past the end. */
const char *option_given(size_t i);

/* Whether that option was given. */
bool option_was_given(const char *name);

/* For readers of command lines. Forgets all options that were given. */
void options_begin(void);
/* Notes an option. Errors: STATUS_INPUT it was given before and does not repeat. */
enum status option_note(const char *name, bool repeats, struct reason *reason) MUST_USE;
/* Notes an output (NULL: none); outputs_try is output_try of all of them. */
void output_note(const char *path);
enum status outputs_try(struct reason *reason) MUST_USE;
/* For "-": prints go to the standard error output from here on. Errors: STATUS_INPUT a second "-". */
enum status output_aside(struct reason *reason) MUST_USE;
/* Prints why an option is wrong. Returns the exit code: EXIT_ENGINE of STATUS_DEVICE, else
 * EXIT_USAGE. */
int option_error(const char *command, enum status status, const struct reason *reason);

/* Tests that a file can be written, before work is done for it. An existing file stays as it is, and
 * no file is left behind. NULL, "-" and what is no regular file are not opened. Errors: as
 * file_out_open. */
enum status output_try(const char *path, struct reason *reason) MUST_USE;

/* Opens the file of an option: `path`, or for "-" what was the standard output, once. Errors: as
 * file_out_open. */
enum status options_out(const char *path, struct file_out *out, struct reason *reason) MUST_USE;

#endif
