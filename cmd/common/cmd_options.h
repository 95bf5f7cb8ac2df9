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

/* For those that read command lines: forgets what was given; notes that an option was, which is an
 * error the second time unless it repeats; notes an output, and tries all that
 * were noted; puts what is printed on the standard error output from here on, for "-"; and prints
 * why an option is wrong, and returns the exit code. */
void options_begin(void);
enum status option_note(const char *name, bool repeats, struct reason *reason) MUST_USE;
void output_note(const char *path);
enum status outputs_try(struct reason *reason) MUST_USE;
enum status output_aside(struct reason *reason) MUST_USE;
int option_error(const char *command, enum status status, const struct reason *reason);

/* Proves that a file can be written, before work is done for it: what is there stays as it is, and
 * nothing is left behind. What is no regular file is not opened. Errors: as file_out_open. */
enum status output_try(const char *path, struct reason *reason) MUST_USE;

/* Opens the file of an option: `path`, or for "-" what was the standard output, once. Errors: as
 * file_out_open. */
enum status options_out(const char *path, struct file_out *out, struct reason *reason) MUST_USE;

#endif
