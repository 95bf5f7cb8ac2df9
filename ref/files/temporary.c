#define _GNU_SOURCE /* O_TMPFILE, asprintf, mkdtemp */
#include "ref/files/temporary.h"

#include "ref/files/file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define NAMES_MOST 1000u
#define MARK       ".raydiff."
#define END        ".tmp"

static char *name_of(const char *goal, unsigned number)
{
    char *name;
    return asprintf(&name, "%s" MARK "%u" END, goal, number) < 0 ? NULL : name;
}

/* Locks a new file. Returns false if another process took it for a leftover and removed it. On a
 * file system without locks nothing is removed. */
static bool hold(int file)
{
    struct stat about;
    if (flock(file, LOCK_EX | LOCK_NB) != 0)
        return errno != EWOULDBLOCK;
    return fstat(file, &about) != 0 || about.st_nlink > 0;
}

/* Opens `name` and locks it, if a killed process of this user left it. While it is locked, no other
 * process replaces it. Returns -1 if it must not be removed. */
static int take_left(int folder, const char *name, mode_t kind)
{
    struct stat about, open;
    if (fstatat(folder, name, &about, AT_SYMLINK_NOFOLLOW) != 0 ||
        (about.st_mode & S_IFMT) != kind || about.st_uid != geteuid())
        return -1;
    int file = file_open_again(folder, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK);
    if (file >= 0 && flock(file, LOCK_EX | LOCK_NB) == 0 && fstat(file, &open) == 0 &&
        fstatat(folder, name, &about, AT_SYMLINK_NOFOLLOW) == 0 && open.st_dev == about.st_dev &&
        open.st_ino == about.st_ino)
        return file;
    if (file >= 0)
        close(file);
    return -1;
}

/* --- files -------------------------------------------------------------------------------- */

int temporary_nameless(int folder, const char *name)
{
    const char *slash = strrchr(name, '/');
    char proc[64], *in = slash ? strndup(name, (size_t)(slash - name) + 1) : strdup(".");
    int file = in ? file_open_again(folder, in, O_WRONLY | O_TMPFILE) : -1;
    free(in);
    snprintf(proc, sizeof proc, "/proc/self/fd/%d", file);
    if (file >= 0 && access(proc, F_OK) != 0) {
        close(file);
        return -1;
    }
    if (file >= 0)
        (void)!flock(file, LOCK_EX | LOCK_NB);
    return file;
}

int temporary_named(int folder, const char *name, char **temporary)
{
    errno = EEXIST;
    for (unsigned n = 0; n < NAMES_MOST; n++) {
        *temporary = name_of(name, n);
        int file = -1;
        if (*temporary)
            file = file_open_again(folder, *temporary, O_WRONLY | O_CREAT | O_EXCL);
        if (file >= 0 && hold(file))
            return file;
        int why = *temporary ? errno : ENOMEM;
        bool taken = file >= 0 || why == EEXIST;
        if (file >= 0)
            close(file);
        free(*temporary);
        *temporary = NULL;
        errno = taken ? EEXIST : why;
        if (!taken)
            break;
    }
    return -1;
}

bool temporary_link(int file, int folder, const char *name, char **temporary)
{
    char proc[64];
    snprintf(proc, sizeof proc, "/proc/self/fd/%d", file);
    *temporary = NULL;
    if (linkat(AT_FDCWD, proc, folder, name, AT_SYMLINK_FOLLOW) == 0)
        return true;
    for (unsigned n = 0; n < NAMES_MOST && errno == EEXIST; n++) {
        *temporary = name_of(name, n);
        if (*temporary && linkat(AT_FDCWD, proc, folder, *temporary, AT_SYMLINK_FOLLOW) == 0)
            return true;
        int why = *temporary ? errno : ENOMEM;
        free(*temporary);
        *temporary = NULL;
        errno = why;
    }
    return false;
}

/* Several writers at once use the first numbers, so two free ones in a row end the search. */
void temporary_sweep(int folder, const char *name)
{
    struct stat about;
    for (unsigned n = 0, unused = 0; n < NAMES_MOST && unused < 2; n++) {
        char *one = name_of(name, n);
        bool there = one && fstatat(folder, one, &about, AT_SYMLINK_NOFOLLOW) == 0;
        unused = there ? 0 : unused + 1;
        int file = there ? take_left(folder, one, S_IFREG) : -1;
        if (file >= 0) {
            unlinkat(folder, one, 0);
            close(file);
        }
        free(one);
    }
}

/* Removes a point and digits from the end. Returns false if there are none. */
static bool drop_number(const char *name, size_t *length)
{
    size_t end = *length;
    while (end > 0 && name[end - 1] >= '0' && name[end - 1] <= '9')
        end--;
    if (end == *length || end == 0 || name[end - 1] != '.')
        return false;
    *length = end - 1;
    return true;
}

/* NAME.raydiff.N.tmp, or NAME.PID.N.tmp of earlier versions. */
bool temporary_is_name(const char *name)
{
    const size_t mark = sizeof MARK - 2; /* without its second point */
    size_t length = strlen(name);
    if (length < sizeof END || strcmp(name + length - (sizeof END - 1), END) != 0)
        return false;
    length -= sizeof END - 1;
    if (!drop_number(name, &length))
        return false;
    if (length > mark && memcmp(name + length - mark, MARK, mark) == 0)
        return true;
    return drop_number(name, &length) && length > 0;
}

/* --- folders ------------------------------------------------------------------------------ */

bool temporary_folder_remove(const char *path)
{
    DIR *listing = opendir(path);
    struct dirent *one;
    while (listing && (one = readdir(listing)) != NULL)
        if (strcmp(one->d_name, ".") != 0 && strcmp(one->d_name, "..") != 0)
            unlinkat(dirfd(listing), one->d_name, 0);
    if (listing)
        closedir(listing);
    return rmdir(path) == 0;
}

/* PREFIX.XXXXXX */
static bool is_folder_name(const char *name, const char *prefix)
{
    const size_t length = strlen(prefix);
    return strncmp(name, prefix, length) == 0 && name[length] == '.' &&
           strlen(name + length + 1) == 6;
}

static void sweep_folders(const char *parent, const char *prefix)
{
    DIR *listing = opendir(parent);
    struct dirent *one;
    char *path;
    while (listing && (one = readdir(listing)) != NULL) {
        if (!is_folder_name(one->d_name, prefix))
            continue;
        int file = take_left(dirfd(listing), one->d_name, S_IFDIR);
        if (file >= 0 && asprintf(&path, "%s/%s", parent, one->d_name) >= 0) {
            (void)!temporary_folder_remove(path);
            free(path);
        }
        if (file >= 0)
            close(file);
    }
    if (listing)
        closedir(listing);
}

int temporary_folder(const char *parent, const char *prefix, char **path)
{
    sweep_folders(parent, prefix);
    for (unsigned n = 0; n < NAMES_MOST; n++) {
        if (asprintf(path, "%s/%s.XXXXXX", parent, prefix) < 0) {
            errno = ENOMEM;
            break;
        }
        bool made = mkdtemp(*path) != NULL;
        int why, file = made ? file_open_again(AT_FDCWD, *path, O_RDONLY | O_DIRECTORY) : -1;
        if (file >= 0 && hold(file))
            return file;
        why = errno;
        if (file >= 0)
            close(file);
        else if (made)
            rmdir(*path);
        free(*path);
        errno = why;
        if (file < 0 && !(made && why == ENOENT))
            break;
    }
    *path = NULL;
    return -1;
}
