/* Whole files in, whole files out. */
#ifndef FILE_H
#define FILE_H

#include "ref/base.h"

#include <stdio.h>

/* Reads all of `path`, gunzipping if it begins with the gzip magic; *bytes has a 0 after the last
 * byte, which does not count. Refuses directories, unreadable and empty files.
 * Errors: STATUS_INPUT "PATH: rule"; STATUS_MEMORY. Caller frees *bytes. */
enum status file_read(const char *path, char **bytes, size_t *size,
                      struct reason *reason) MUST_USE;

/* A file being written under a temporary name beside its goal. */
struct file_out {
    FILE *stream;
    char *path;
    char *temporary;
};

/* Opens a temporary file in the folder of `path`. Errors: STATUS_INPUT cannot write there. */
enum status file_out_open(const char *path, struct file_out *out, struct reason *reason) MUST_USE;

/* Flushes, checks for write errors and renames to the goal; on error nothing is left behind. */
enum status file_out_commit(struct file_out *out, struct reason *reason) MUST_USE;

/* Drops the temporary file, if it was not committed. Safe on a zero struct. */
void file_out_discard(struct file_out *out);

#endif
