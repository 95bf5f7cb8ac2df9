/* Whole files in, whole files out. */
#ifndef FILE_H
#define FILE_H

#include "ref/base/base.h"

#include <stdio.h>

#define FILE_LARGEST ((size_t)2 << 30) /* bytes, as stored and as unzipped */

/* A zipped file may have that many bytes for each byte stored, and a fixed number. */
#define FILE_UNZIPPED_TIMES 40u
#define FILE_UNZIPPED_FIXED ((size_t)1 << 20)

/* Reads all of `path`, gunzipping if it begins with the gzip magic; *bytes has a 0 after the last
 * byte, which does not count. Refuses directories, unreadable and empty files, what is larger than
 * FILE_LARGEST, and gzip data that are cut short, damaged, followed by something else or unzip to
 * more than a mesh can (FILE_UNZIPPED_TIMES).
 * Errors: STATUS_INPUT "PATH: rule"; STATUS_MEMORY. Caller frees *bytes. */
enum status file_read(const char *path, char **bytes, size_t *size, struct reason *reason) MUST_USE;

/* As file_read, with another largest size. */
enum status file_read_most(const char *path, size_t most, char **bytes, size_t *size,
                           struct reason *reason) MUST_USE;

/* The same of an open file, which it closes; `path` stands in reasons. */
enum status file_read_from(int file, const char *path, size_t most, char **bytes, size_t *size,
                           struct reason *reason) MUST_USE;

/* The part of `path` that fits into a reason beside a rule: all of it, or its end. */
const char *file_label(const char *path);

/* A file being written beside its goal. It has no name if the file system supports that, so that
 * nothing is left when the process is killed; else it has a temporary one, and the next writer of
 * the same goal removes what is left (ref/files/temporary.h). */
struct file_out {
    FILE *stream;
    char *path;      /* the goal; the target, if the path named is a symbolic link */
    char *temporary; /* its name until then, if it has one */
    int file;        /* descriptor of the stream; not to be closed */
    int held; /* 1 + another one, which keeps the lock; 0: a device or pipe, written directly */
    bool nameless;
    bool unsynced; /* set by its user: after a crash of the machine it may be empty */
    bool within;   /* both names are the last of their paths, in the folder that is open here */
    int folder;
};

/* Opens a temporary file in the folder of `path`, with the permissions of any new file. What is no
 * regular file and cannot be replaced (/dev/stdout, a pipe) is opened itself.
 * Errors: STATUS_INPUT a directory, or cannot write there; STATUS_MEMORY. */
enum status file_out_open(const char *path, struct file_out *out, struct reason *reason) MUST_USE;

/* The same of the file `name` of an open folder, of which a copy is kept; `path`, the folder's,
 * stands in reasons. Nothing is followed: a link is replaced. The commit syncs the folder, too. */
enum status file_out_within(int folder, const char *path, const char *name, struct file_out *out,
                            struct reason *reason) MUST_USE;

/* Flushes, checks for write errors and renames to the goal; on error nothing is left behind. A call
 * that a signal interrupts is made again. */
enum status file_out_commit(struct file_out *out, struct reason *reason) MUST_USE;

/* Drops the temporary file, if it was not committed. Safe on a zero struct. */
void file_out_discard(struct file_out *out);

/* Drops the temporary files with names that this process has open, for a handler of signals that
 * ends it: it calls nothing that a handler may not. What the process was forked from keeps its own.
 */
void file_out_abandon(void);

/* openat() with O_CLOEXEC; a call that a signal interrupts is made again. -1 and errno on error. */
int file_open_again(int folder, const char *name, int flags) MUST_USE;

/* fsync() with what a signal interrupts made again. */
int file_sync(int file) MUST_USE;

#endif
