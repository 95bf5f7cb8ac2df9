/* The options that a command was given, and the output files that they name. For commands only. */
#ifndef CMD_OPTIONS_H
#define CMD_OPTIONS_H

#include "ref/match/match.h"
#include "ref/files/file.h"

/* Name of the i-th option given to the last options_read, without dashes and each only once; NULL
 * past the end. */
const char *option_given(size_t i);

/* True if that option was given. */
bool option_was_given(const char *name);

/* For functions that read command lines. Forgets all given options. */
void options_begin(void);
/* Notes an option. Errors: STATUS_INPUT it was given before and may not repeat. */
enum status option_note(const char *name, bool repeats, struct reason *reason) MUST_USE;
/* Notes an output and its option (NULL: none). outputs_try calls output_try for all that are
 * to be tried. Errors of outputs_apart: STATUS_INPUT two of them are one file. */
void output_note(const char *name, const char *path, bool tried);
enum status outputs_apart(struct reason *reason) MUST_USE;
enum status outputs_try(struct reason *reason) MUST_USE;
/* Checks the words of a command line, of which JSON and JUnit would tell. Errors: STATUS_INPUT one
 * of them is to be written, and a word that is not the path of an output is not UTF-8. */
enum status outputs_can_tell(int argc, char *const *argv, struct reason *reason) MUST_USE;
/* For "-": redirects standard output to standard error from here on. Errors: STATUS_INPUT a second
 * "-", or cannot redirect. */
enum status output_aside(struct reason *reason) MUST_USE;
/* Prints why an option is wrong. Returns EXIT_ENGINE for STATUS_DEVICE, EXIT_SKIPPED for
 * STATUS_UNSUPPORTED, else EXIT_USAGE. */
int option_error(const char *command, enum status status, const struct reason *reason);

/* Tests that a file can be written, before the work for it begins. Existing files stay unchanged,
 * and no new file remains. NULL, "-" and special files such as pipes are not opened. Errors: as
 * file_out_open. */
enum status output_try(const char *path, struct reason *reason) MUST_USE;

/* Opens the file of an option: `path`, or for "-" the former standard output, which works only
 * once. Errors: as file_out_open. */
enum status options_out(const char *path, struct file_out *out, struct reason *reason) MUST_USE;

#endif
