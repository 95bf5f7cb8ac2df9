#define _GNU_SOURCE /* O_NOFOLLOW, O_DIRECTORY, strdup */
#include "ref/files/folder.h"

#include "ref/files/temporary.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Opening must not wait for a named pipe or acquire a terminal; check_file rejects both. */
#define CAREFULLY  (O_NOFOLLOW | O_NONBLOCK | O_NOCTTY)
#define STAT_FLAGS AT_SYMLINK_NOFOLLOW

static enum status system_fail(const char *path, int why, struct reason *reason)
{
    return fail(reason, STATUS_INPUT, "%s: %s", file_label(path), strerror(why));
}

void folder_path(const struct folder *folder, const char *name, char *path, size_t path_bytes)
{
    snprintf(path, path_bytes, "%s/%s", folder->path, name);
}

/* Buffer for the path of a name, for reasons. */
struct folder_place {
    char path[FOLDER_PATH_MOST];
};

static const char *place_of(const struct folder *folder, const char *name,
                            struct folder_place *place)
{
    folder_path(folder, name, place->path, sizeof place->path);
    return place->path;
}

static const char *kind_name(mode_t mode)
{
    return S_ISLNK(mode)    ? "a symbolic link"
           : S_ISDIR(mode)  ? "a folder"
           : S_ISREG(mode)  ? "a file"
           : S_ISFIFO(mode) ? "a named pipe"
           : S_ISSOCK(mode) ? "a socket"
                            : "a device";
}

/* Looks up a name without opening it. Sets *there if it exists; fails if it is not of kind
 * `want`. */
static enum status look(const struct folder *folder, const char *name, mode_t want, bool *there,
                        struct reason *reason)
{
    struct folder_place place;
    struct stat about;
    const char *path = place_of(folder, name, &place);
    *there = fstatat(folder->file, name, &about, STAT_FLAGS) == 0;
    if (!*there)
        return errno == ENOENT ? STATUS_OK : system_fail(path, errno, reason);
    if ((about.st_mode & S_IFMT) == want)
        return STATUS_OK;
    return fail(reason, STATUS_INPUT, "%s: is %s, not %s: left unchanged", file_label(path),
                kind_name(about.st_mode), kind_name(want));
}

enum status folder_has(const struct folder *folder, const char *name, bool *there,
                       struct reason *reason)
{
    return look(folder, name, S_IFREG, there, reason);
}

enum status folder_has_folder(const struct folder *folder, const char *name, bool *there,
                              struct reason *reason)
{
    return look(folder, name, S_IFDIR, there, reason);
}

/* Makes a folder of an open descriptor, or fails with errno if it is -1. */
static enum status become(int file, const char *path, struct folder *out, struct reason *reason)
{
    if (file < 0)
        return system_fail(path, errno, reason);
    *out = (struct folder){file, strdup(path)};
    if (out->path)
        return STATUS_OK;
    close(file);
    *out = (struct folder){0};
    return fail(reason, STATUS_MEMORY, "no memory for a folder's name");
}

enum status folder_open(const char *path, bool make, struct folder *out, struct reason *reason)
{
    *out = (struct folder){0};
    if (make && mkdir(path, 0777) != 0 && errno != EEXIST)
        return system_fail(path, errno, reason);
    return become(file_open_again(AT_FDCWD, path, O_RDONLY | O_DIRECTORY), path, out, reason);
}

enum status folder_open_in(const struct folder *parent, const char *name, bool make,
                           struct folder *out, struct reason *reason)
{
    struct folder_place place;
    bool there;
    const char *path = place_of(parent, name, &place);
    *out = (struct folder){0};
    enum status status = folder_has_folder(parent, name, &there, reason);
    if (status)
        return status;
    if (make && !there &&
        (mkdirat(parent->file, name, 0777) != 0 ? errno != EEXIST : file_sync(parent->file) != 0))
        return system_fail(path, errno, reason);
    const int flags = O_RDONLY | O_DIRECTORY | CAREFULLY;
    return become(file_open_again(parent->file, name, flags), path, out, reason);
}

void folder_close(struct folder *folder)
{
    if (folder->path)
        close(folder->file);
    free(folder->path);
    *folder = (struct folder){0};
}

/* Checks an open file: it may have been replaced since its name was looked up. */
static enum status check_file(int file, const char *path, bool append, struct reason *reason)
{
    struct stat about;
    if (fstat(file, &about) != 0)
        return system_fail(path, errno, reason);
    if (!S_ISREG(about.st_mode))
        return fail(reason, STATUS_INPUT, "%s: is %s, not a file: left unchanged", file_label(path),
                    kind_name(about.st_mode));
    if (append && about.st_nlink > 1)
        return fail(reason, STATUS_INPUT,
                    "%s: has %lu names (hard links), and would change under all of them: copy it",
                    file_label(path), (unsigned long)about.st_nlink);
    return STATUS_OK;
}

enum status folder_open_file(const struct folder *folder, const char *name, bool append, int *file,
                             struct reason *reason)
{
    struct folder_place place;
    bool there;
    const char *path = place_of(folder, name, &place);
    *file = -1;
    enum status status = folder_has(folder, name, &there, reason);
    if (status)
        return status;
    int flags = (append ? O_RDWR | O_CREAT | O_APPEND : O_RDONLY) | CAREFULLY;
    *file = file_open_again(folder->file, name, flags);
    if (*file < 0)
        return system_fail(path, errno, reason);
    status = check_file(*file, path, append, reason);
    if (!status && append && !there && file_sync(folder->file) != 0)
        status = system_fail(path, errno, reason);
    if (status) {
        close(*file);
        *file = -1;
    }
    return status;
}

enum status folder_read(const struct folder *folder, const char *name, size_t most, char **bytes,
                        size_t *size, struct reason *reason)
{
    struct folder_place place;
    int file;
    *bytes = NULL;
    *size = 0;
    enum status status = folder_open_file(folder, name, false, &file, reason);
    if (status)
        return status;
    return file_read_from(file, place_of(folder, name, &place), most, bytes, size, reason);
}

enum status folder_put(const struct folder *folder, const char *name, struct file_out *out,
                       struct reason *reason)
{
    bool there;
    *out = (struct file_out){0};
    enum status status = folder_has(folder, name, &there, reason);
    if (status)
        return status;
    return file_out_within(folder->file, folder->path, name, out, reason);
}

enum status folder_list(const struct folder *folder, folder_name_fn *each, void *user,
                        struct reason *reason)
{
    int file = file_open_again(folder->file, ".", O_RDONLY | O_DIRECTORY);
    DIR *listing = file < 0 ? NULL : fdopendir(file);
    enum status status = STATUS_OK;
    if (!listing) {
        status = system_fail(folder->path, errno, reason);
        if (file >= 0)
            close(file);
        return status;
    }
    while (!status) {
        errno = 0;
        const struct dirent *one = readdir(listing);
        if (!one && errno != 0)
            status = system_fail(folder->path, errno, reason);
        if (!one)
            break;
        if (strcmp(one->d_name, ".") != 0 && strcmp(one->d_name, "..") != 0)
            status = each(user, one->d_name, reason);
    }
    closedir(listing);
    return status;
}

enum status folder_remove(const struct folder *folder, const char *name, struct reason *reason)
{
    struct folder_place place;
    if (unlinkat(folder->file, name, 0) == 0 || errno == ENOENT ||
        (errno == EISDIR && unlinkat(folder->file, name, AT_REMOVEDIR) == 0))
        return STATUS_OK;
    return system_fail(place_of(folder, name, &place), errno, reason);
}

static enum status remove_temporary(void *user, const char *name, struct reason *reason)
{
    return temporary_is_name(name) ? folder_remove(user, name, reason) : STATUS_OK;
}

enum status folder_clean(const struct folder *folder, struct reason *reason)
{
    struct folder copy = *folder; /* `user` is not const */
    return folder_list(folder, remove_temporary, &copy, reason);
}
