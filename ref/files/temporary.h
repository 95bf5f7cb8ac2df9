/* Temporary files and folders, and how they are cleaned up when their writer is killed. A writer
 * holds a lock (flock) on its file until that is renamed to its goal or removed. An unlocked one
 * was left by a killed process, and the next writer of the same goal removes it. Files of other
 * users are never removed. */
#ifndef TEMPORARY_H
#define TEMPORARY_H

#include "ref/base/base.h"

/* `name` is a path relative to the open folder `folder` (AT_FDCWD: any path). */

/* Opens a nameless file for writing, which will become `name`. Nothing is left of it if the process
 * is killed. Returns -1 if the file system does not support this, or without /proc. */
int temporary_nameless(int folder, const char *name) MUST_USE;

/* Opens a new file NAME.raydiff.N.tmp with the first free N, and sets *temporary to its name, which
 * the caller frees. Returns -1 and sets errno on error. */
int temporary_named(int folder, const char *name, char **temporary) MUST_USE;

/* Links a nameless file to `name`. If that exists, links it to NAME.raydiff.N.tmp instead and sets
 * *temporary as above. Returns false and sets errno on error. */
bool temporary_link(int file, int folder, const char *name, char **temporary) MUST_USE;

/* Removes the files NAME.raydiff.N.tmp that killed processes left. */
void temporary_sweep(int folder, const char *name);

/* Returns true if `name` is that of a temporary file, of any goal. */
bool temporary_is_name(const char *name) MUST_USE;

/* Makes a new folder PREFIX.XXXXXX (X: any letters) in the folder `parent`. First removes those
 * that killed processes left, with their files. Returns a descriptor, to be kept open as long as
 * the folder is used; the caller frees *path. Returns -1 and sets errno on error. */
int temporary_folder(const char *parent, const char *prefix, char **path) MUST_USE;

/* Removes a folder and the files in it. Returns false and sets errno on error. */
bool temporary_folder_remove(const char *path);

#endif
