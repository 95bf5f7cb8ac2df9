/* Access to folders whose content may be another user's. Files are read, written, renamed and
 * removed only within the folder: each name is resolved relative to an open folder, and no symbolic
 * link is followed. Where a file is expected, a named pipe, a device, a socket or a folder is
 * rejected without being opened. The path by which a folder is opened is the user's own, so links
 * in it are followed. */
#ifndef FOLDER_H
#define FOLDER_H

#include "ref/files/file.h"

#define FOLDER_PATH_MOST 4096

/* An open folder. Zero: none. */
struct folder {
    int file;   /* descriptor; valid if path is not NULL */
    char *path; /* for reasons and messages */
};

/* Opens a folder. `make`: creates it first if it is missing; its parent must exist.
 * Errors: STATUS_INPUT "PATH: rule"; STATUS_MEMORY. */
enum status folder_open(const char *path, bool make, struct folder *out,
                        struct reason *reason) MUST_USE;

/* As folder_open for a folder in a folder. Here and below `name` is a single name, without '/'. */
enum status folder_open_in(const struct folder *parent, const char *name, bool make,
                           struct folder *out, struct reason *reason) MUST_USE;

void folder_close(struct folder *folder); /* does nothing if zero */

/* Sets *there if a regular file of that name exists. Errors: STATUS_INPUT the name is something
 * else's. */
enum status folder_has(const struct folder *folder, const char *name, bool *there,
                       struct reason *reason) MUST_USE;
/* Sets *there if a folder of that name exists. Errors: as folder_has. */
enum status folder_has_folder(const struct folder *folder, const char *name, bool *there,
                              struct reason *reason) MUST_USE;

/* As file_read_most for a file in the folder. */
enum status folder_read(const struct folder *folder, const char *name, size_t most, char **bytes,
                        size_t *size, struct reason *reason) MUST_USE;

/* Opens a file for reading; `append`: for reading and appending, created if missing. A file opened
 * for appending must not have a second name (a hard link), which may be another user's. *file is -1
 * on error. Errors: STATUS_INPUT "PATH: rule". */
enum status folder_open_file(const struct folder *folder, const char *name, bool append, int *file,
                             struct reason *reason) MUST_USE;

/* As file_out_open. The file appears whole or not at all; after file_out_commit it is on the disk
 * under its name. Errors: STATUS_INPUT the name exists and is no regular file. */
enum status folder_put(const struct folder *folder, const char *name, struct file_out *out,
                       struct reason *reason) MUST_USE;

/* Calls `each` for every name except "." and "..", in the order of the system. Stops at the first
 * result other than STATUS_OK, and returns it. Errors: STATUS_INPUT the folder cannot be read. */
typedef enum status folder_name_fn(void *user, const char *name, struct reason *reason);
enum status folder_list(const struct folder *folder, folder_name_fn *each, void *user,
                        struct reason *reason) MUST_USE;

/* Removes a file or an empty folder; does nothing if there is none. Errors: STATUS_INPUT it cannot
 * be removed. */
enum status folder_remove(const struct folder *folder, const char *name, struct reason *reason);

/* Removes all temporary files, which killed writers left. Only for folders that no other process
 * writes to. */
enum status folder_clean(const struct folder *folder, struct reason *reason) MUST_USE;

/* Writes "PATH/NAME". A path that is too long is cut. */
void folder_path(const struct folder *folder, const char *name, char *path, size_t path_bytes);

#endif
