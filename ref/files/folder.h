/* Folders whose content may belong to others. All that is read, written, renamed or removed
 * through them lies in them: names are taken one by one, relative to an open folder, and no
 * symbolic link is followed; where a file belongs, a named pipe, a device, a socket or a folder is
 * refused and not opened. The path that a folder is opened by is the user's: links in it are
 * followed. */
#ifndef FOLDER_H
#define FOLDER_H

#include "ref/files/file.h"

#define FOLDER_PATH_MOST 4096

/* An open one. Zero: none. */
struct folder {
    int file;   /* its descriptor; only if there is a path */
    char *path; /* for reasons and for people */
};

/* Opens it, and makes it first if it is to be and is not there (its parent must be).
 * Errors: STATUS_INPUT "PATH: rule"; STATUS_MEMORY. */
enum status folder_open(const char *path, bool make, struct folder *out,
                        struct reason *reason) MUST_USE;

/* The same of a folder in a folder. `name` of these functions is one name, without '/'. */
enum status folder_open_in(const struct folder *parent, const char *name, bool make,
                           struct folder *out, struct reason *reason) MUST_USE;

void folder_close(struct folder *folder); /* does nothing if zero */

/* *there: a regular file of that name is. Errors: STATUS_INPUT what is there is something else. */
enum status folder_has(const struct folder *folder, const char *name, bool *there,
                       struct reason *reason) MUST_USE;
/* *there: a folder of that name is. Errors: likewise. */
enum status folder_has_folder(const struct folder *folder, const char *name, bool *there,
                              struct reason *reason) MUST_USE;

/* As file_read_most. */
enum status folder_read(const struct folder *folder, const char *name, size_t most, char **bytes,
                        size_t *size, struct reason *reason) MUST_USE;

/* Opens a file for reading; `append`: for reading and appending, created if missing. A file opened
 * for appending must have no second name (a hard link): that name may be someone else's.
 * *file is -1 on error. Errors: STATUS_INPUT "PATH: rule". */
enum status folder_open_file(const struct folder *folder, const char *name, bool append, int *file,
                             struct reason *reason) MUST_USE;

/* As file_out_open: the file appears whole or not at all, and is on the disk with its name when
 * file_out_commit returns. Errors: STATUS_INPUT what is there is no regular file. */
enum status folder_put(const struct folder *folder, const char *name, struct file_out *out,
                       struct reason *reason) MUST_USE;

/* Calls `each` for every name but "." and "..", in an order of the system's, until one returns
 * other than STATUS_OK, which is then returned. Errors: STATUS_INPUT the folder cannot be read. */
typedef enum status folder_name_fn(void *user, const char *name, struct reason *reason);
enum status folder_list(const struct folder *folder, folder_name_fn *each, void *user,
                        struct reason *reason) MUST_USE;

/* Removes a file or an empty folder. Errors: STATUS_INPUT it cannot be; it need not be there. */
enum status folder_remove(const struct folder *folder, const char *name, struct reason *reason);

/* Removes the temporary files that killed writers left, of any goal. Only for a folder without
 * other writers. */
enum status folder_clean(const struct folder *folder, struct reason *reason) MUST_USE;

/* Writes "PATH/NAME"; too long a path is cut. */
void folder_path(const struct folder *folder, const char *name, char *path, size_t path_bytes);

#endif
