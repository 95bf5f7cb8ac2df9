/* Reads and writes whole files. */
#ifndef FILE_H
#define FILE_H

#include "ref/base/base.h"

#include <stdio.h>

#define FILE_LARGEST ((size_t)2 << 30) /* bytes, as stored and as unzipped */

/* A gzip file may unzip to its size * FILE_UNZIPPED_TIMES + FILE_UNZIPPED_FIXED bytes. */
#define FILE_UNZIPPED_TIMES 40u
#define FILE_UNZIPPED_FIXED ((size_t)1 << 20)

/* Reads all of `path`, and unzips it if it begins with the gzip magic. A 0 follows the last of
 * *size bytes. Rejects directories, unreadable and empty files, files larger than FILE_LARGEST, and
 * gzip data that are cut short, damaged, followed by other data, or unzip to more than a mesh can
 * (FILE_UNZIPPED_TIMES).
 * Errors: STATUS_INPUT "PATH: rule"; STATUS_MEMORY. The caller frees *bytes. */
enum status file_read(const char *path, char **bytes, size_t *size, struct reason *reason) MUST_USE;

/* As file_read, with a different size limit. */
enum status file_read_most(const char *path, size_t most, char **bytes, size_t *size,
                           struct reason *reason) MUST_USE;

/* As file_read for what another file names: a regular file, which is never zipped, whatever its
 * first bytes. */
enum status file_read_stored(const char *path, char **bytes, size_t *size,
                             struct reason *reason) MUST_USE;

/* As file_read_most for an open file, which it closes. `path` is used in reasons only. */
enum status file_read_from(int file, const char *path, size_t most, char **bytes, size_t *size,
                           struct reason *reason) MUST_USE;

/* The part of `path` that is printed in reasons: all of it, or its end. */
const char *file_label(const char *path);

/* A file that is written under another name before it replaces its goal. It has no name at all if
 * the file system supports that, so nothing is left when the process is killed. Else it has a
 * temporary name, and the next writer of the same goal removes what a killed one left
 * (ref/files/temporary.h). */
struct file_out {
    FILE *stream;
    char *path;      /* the goal; if a symbolic link was given, its target */
    char *temporary; /* its temporary name, or NULL */
    int file;        /* descriptor of the stream, which closes it */
    int held;        /* 1 + a duplicate, which keeps the lock; 0: device or pipe */
    bool nameless;
    bool unsynced; /* set by the caller: after a crash of the machine it may be empty */
    bool within;   /* written in `folder`, to which both names are relative */
    int folder;
};

/* Opens a temporary file in the folder of `path`, with the permissions of any new file. A path that
 * is no regular file (/dev/stdout, a pipe) cannot be replaced and is opened itself.
 * Errors: STATUS_INPUT a directory, or not writable; STATUS_MEMORY. */
enum status file_out_open(const char *path, struct file_out *out, struct reason *reason) MUST_USE;

/* As file_out_open for the file `name` in an open folder. The folder's descriptor is duplicated;
 * `path` is the folder's path for reasons. A symbolic link is replaced, not followed.
 * file_out_commit syncs the folder, too. */
enum status file_out_within(int folder, const char *path, const char *name, struct file_out *out,
                            struct reason *reason) MUST_USE;

/* Flushes, checks for write errors and renames the file to its goal; on error the temporary file is
 * removed. Calls interrupted by a signal are repeated. */
enum status file_out_commit(struct file_out *out, struct reason *reason) MUST_USE;

/* Removes the temporary file, if it was not committed. Safe on a zero struct. */
void file_out_discard(struct file_out *out);

/* Removes the named temporary files that this process has open; those of its parent process stay.
 * For signal handlers that end the process: it is async-signal-safe. */
void file_out_abandon(void);

/* openat() with O_CLOEXEC, repeated if a signal interrupts it. Returns -1 and sets errno on
 * error. */
int file_open_again(int folder, const char *name, int flags) MUST_USE;

/* fsync(), repeated if a signal interrupts it. */
int file_sync(int file) MUST_USE;

#endif
