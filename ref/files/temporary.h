/* What is not whole yet, and what is left of it when its writer is killed. A writer holds a lock
 * (flock) on what it makes until that has its goal's name, or is removed; what is not locked was
 * left behind, and the next writer of the same goal removes it. Nothing of another user is removed.
 */
#ifndef TEMPORARY_H
#define TEMPORARY_H

#include "ref/base/base.h"

/* In these functions `name` is a path relative to the open folder `folder` (AT_FDCWD: any path). */

/* Opens a file without a name for writing, which shall become `name`: nothing is left of it if the
 * process is killed. -1 if the file system has no such files, or without /proc. */
int temporary_nameless(int folder, const char *name) MUST_USE;

/* Opens a new file NAME.raydiff.N.tmp for the first N that is free. -1 and errno on error; else
 * *temporary is its name, freed by the caller. */
int temporary_named(int folder, const char *name, char **temporary) MUST_USE;

/* Gives a nameless file the name `name`, if that is free; else *temporary, as above. False and
 * errno on error. */
bool temporary_link(int file, int folder, const char *name, char **temporary) MUST_USE;

/* Removes the files NAME.raydiff.N.tmp that killed writers left. */
void temporary_sweep(int folder, const char *name);

/* True if a name is that of a temporary file, of any goal. */
bool temporary_is_name(const char *name) MUST_USE;

/* Makes a new folder PREFIX.XXXXXX (with other letters) in the folder `parent`, after those are
 * removed, with the files in them, that killed ones left. -1 and errno on error; else a descriptor
 * to be kept open as long as the folder is used, and *path is freed by the caller. */
int temporary_folder(const char *parent, const char *prefix, char **path) MUST_USE;

/* Removes a folder and the files in it. False and errno: it cannot be. */
bool temporary_folder_remove(const char *path);

#endif
