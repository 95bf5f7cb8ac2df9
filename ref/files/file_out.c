/* Writes files atomically: each appears whole or not at all. */
#define _GNU_SOURCE /* realpath, fopencookie */
#include "ref/files/file.h"

#include "ref/files/temporary.h"

#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* For file_out_abandon: names and folders of the temporary files that process `owner` has open.
 * Files beyond the last slot are not recorded. */
static _Atomic(const char *) open_name[16];
static atomic_int open_folder[16];
static atomic_long owner;
static const char taken[] = ""; /* marks a slot that is being filled */

static void name_know(int folder, const char *name)
{
    bool mine = atomic_exchange(&owner, (long)getpid()) == (long)getpid();
    for (size_t i = 0; i < ARRAY_COUNT(open_name) && !mine; i++)
        atomic_store(&open_name[i], NULL); /* inherited from the parent process */
    for (size_t i = 0; i < ARRAY_COUNT(open_name); i++) {
        const char *none = NULL;
        if (atomic_compare_exchange_strong(&open_name[i], &none, taken)) {
            atomic_store(&open_folder[i], folder);
            atomic_store(&open_name[i], name);
            return;
        }
    }
}

static void name_forget(const char *name)
{
    for (size_t i = 0; i < ARRAY_COUNT(open_name); i++) {
        const char *one = name;
        atomic_compare_exchange_strong(&open_name[i], &one, NULL);
    }
}

void file_out_abandon(void)
{
    if (atomic_load(&owner) != (long)getpid())
        return;
    for (size_t i = 0; i < ARRAY_COUNT(open_name); i++) {
        const char *name = atomic_load(&open_name[i]);
        if (name && name != taken)
            unlinkat(atomic_load(&open_folder[i]), name, 0);
    }
}

/* The write function of a stream: writes all bytes, also after partial and interrupted writes. */
static ssize_t put_all(void *cookie, const char *bytes, size_t size)
{
    const int file = (int)(intptr_t)cookie;
    size_t done = 0;
    while (done < size) {
        ssize_t wrote = write(file, bytes + done, size - done);
        if (wrote < 0 && errno == EINTR)
            continue;
        if (wrote <= 0)
            return 0;
        done += (size_t)wrote;
    }
    return (ssize_t)size;
}

/* Closes `file` and sets errno to `why`. */
static void close_for(int file, int why)
{
    close(file);
    errno = why;
}

/* EINTR is no error: Linux has then closed the file. */
static int put_close(void *cookie)
{
    return close((int)(intptr_t)cookie) == 0 || errno == EINTR ? 0 : -1;
}

/* Makes a stream that owns the descriptor. On error the descriptor is closed. */
static FILE *stream_of(int file)
{
    const cookie_io_functions_t how = {.write = put_all, .close = put_close};
    FILE *stream = file < 0 ? NULL : fopencookie((void *)(intptr_t)file, "wb", how);
    if (!stream && file >= 0)
        close_for(file, ENOMEM);
    return stream;
}

/* Opens the file that will become `name`: nameless if possible, else under a temporary name. */
static void open_temporary(int folder, const char *name, struct file_out *out)
{
    temporary_sweep(folder, name);
    out->file = temporary_nameless(folder, name);
    out->nameless = out->file >= 0;
    if (!out->nameless)
        out->file = temporary_named(folder, name, &out->temporary);
    int second = out->file < 0 ? -1 : fcntl(out->file, F_DUPFD_CLOEXEC, 3);
    if (out->file >= 0 && second < 0)
        close_for(out->file, errno);
    out->stream = second < 0 ? NULL : stream_of(out->file);
    out->held = second + 1;
    if (out->stream && out->temporary)
        name_know(folder, out->temporary);
}

static enum status cannot_write(const char *path, int why, struct reason *reason)
{
    return fail(reason, why == ENOMEM ? STATUS_MEMORY : STATUS_INPUT, "%s: cannot write: %s",
                file_label(path), why ? strerror(why) : "an earlier write failed");
}

enum status file_out_open(const char *path, struct file_out *out, struct reason *reason)
{
    *out = (struct file_out){0};
    struct stat about;
    bool exists = stat(path, &about) == 0;
    if (exists && S_ISDIR(about.st_mode))
        return fail(reason, STATUS_INPUT, "%s: cannot write: is a directory", file_label(path));
    bool replace = !exists || S_ISREG(about.st_mode);
    out->path = exists && replace ? realpath(path, NULL) : strdup(path);
    if (out->path && replace) {
        open_temporary(AT_FDCWD, out->path, out);
    } else if (out->path) {
        out->file = file_open_again(AT_FDCWD, path, O_WRONLY | O_CREAT | O_TRUNC);
        out->stream = stream_of(out->file);
    }
    if (out->stream)
        return STATUS_OK;
    int why = errno;
    file_out_discard(out);
    return cannot_write(path, why, reason);
}

enum status file_out_within(int folder, const char *path, const char *name, struct file_out *out,
                            struct reason *reason)
{
    *out = (struct file_out){0};
    if (asprintf(&out->path, "%s/%s", path, name) < 0)
        out->path = NULL;
    out->folder = out->path ? fcntl(folder, F_DUPFD_CLOEXEC, 3) : -1;
    out->within = out->folder >= 0;
    if (out->within)
        open_temporary(out->folder, name, out);
    if (out->stream)
        return STATUS_OK;
    int why = out->path ? errno : ENOMEM;
    file_out_discard(out);
    return cannot_write(path, why, reason);
}

int file_sync(int file)
{
    int code;
    do
        code = fsync(file);
    while (code != 0 && errno == EINTR);
    return code;
}

static void forget_temporary(struct file_out *out)
{
    if (out->temporary)
        name_forget(out->temporary);
    free(out->temporary);
    out->temporary = NULL;
}

/* The goal's name, relative to the folder. */
static const char *goal_of(const struct file_out *out)
{
    return out->within ? strrchr(out->path, '/') + 1 : out->path;
}

/* Renames or links the file to its goal. If it was opened in a folder, syncs the folder, too. */
static bool take_goal(struct file_out *out)
{
    int folder = out->within ? out->folder : AT_FDCWD;
    if (out->nameless && !temporary_link(out->held - 1, folder, goal_of(out), &out->temporary))
        return false;
    if (out->nameless && out->temporary)
        name_know(folder, out->temporary);
    if (out->temporary && renameat(folder, out->temporary, folder, goal_of(out)) != 0)
        return false;
    forget_temporary(out);
    return !out->within || out->unsynced || file_sync(out->folder) == 0;
}

enum status file_out_commit(struct file_out *out, struct reason *reason)
{
    errno = 0;
    bool good = fflush(out->stream) == 0 && !ferror(out->stream);
    /* Sync first, so that after a crash of the machine the goal is never an empty file. */
    if (good && out->held && !out->unsynced)
        good = file_sync(out->file) == 0;
    int why = errno;
    if (fclose(out->stream) != 0 && good) {
        good = false;
        why = errno;
    }
    out->stream = NULL;
    if (good && out->held && !take_goal(out)) {
        good = false;
        why = errno;
    }
    enum status status = good ? STATUS_OK : cannot_write(out->path, why, reason);
    file_out_discard(out);
    return status;
}

void file_out_discard(struct file_out *out)
{
    if (out->stream)
        fclose(out->stream);
    if (out->temporary)
        unlinkat(out->within ? out->folder : AT_FDCWD, out->temporary, 0);
    forget_temporary(out);
    if (out->held)
        close(out->held - 1);
    if (out->within)
        close(out->folder);
    free(out->path);
    *out = (struct file_out){0};
}
