#define _GNU_SOURCE /* realpath, O_CLOEXEC */
#include "scenes/file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#define LABEL_LENGTH 160

const char *file_label(const char *path)
{
    size_t length = strlen(path);
    return length > LABEL_LENGTH ? path + length - LABEL_LENGTH : path;
}

/* A growing array of bytes, always with room for the 0 after the last. */
struct buffer {
    char *bytes;
    size_t size, capacity;
};

/* A file being read: its name, for reasons, and how many bytes it may have. */
struct source {
    const char *label;
    size_t most;
};

static enum status too_large(const struct source *source, size_t most, struct reason *reason)
{
    if (most < source->most)
        return fail(reason, STATUS_INPUT,
                    "%s: unzips to more than %u times its size, as no mesh does; unzip it first",
                    source->label, FILE_UNZIPPED_TIMES);
    return fail(reason, STATUS_INPUT, "%s: larger than %zu bytes, the most that is read",
                source->label, source->most);
}

/* Makes room for `more` bytes and the 0. */
static enum status buffer_reserve(struct buffer *buffer, size_t more, struct reason *reason)
{
    void *bytes = buffer->bytes;
    enum status status = array_reserve(&bytes, &buffer->capacity, buffer->size + more + 1, 1);
    buffer->bytes = bytes;
    if (status != STATUS_OK)
        return fail(reason, status, "no memory for a file of %zu bytes", buffer->size + more);
    return STATUS_OK;
}

static enum status read_stream(const struct source *source, FILE *stream, size_t expected,
                               struct buffer *buffer, struct reason *reason)
{
    size_t step = expected > 0 && expected <= source->most ? expected + 1 : 1 << 16;
    for (;;) {
        enum status status = buffer_reserve(buffer, step, reason);
        if (status != STATUS_OK)
            return status;
        errno = 0;
        size_t got = fread(buffer->bytes + buffer->size, 1, step, stream);
        buffer->size += got;
        if (ferror(stream))
            return fail(reason, STATUS_INPUT, "%s: %s", source->label, strerror(errno));
        if (buffer->size > source->most)
            return too_large(source, source->most, reason);
        if (got < step)
            return STATUS_OK;
        step = buffer->size < 1 << 24 ? 1 << 16 : 1 << 24;
    }
}

static enum status read_raw(const struct source *source, const char *path, struct buffer *buffer,
                            struct reason *reason)
{
    FILE *stream = fopen(path, "rb");
    struct stat about;
    if (!stream || fstat(fileno(stream), &about) != 0) {
        enum status status = fail(reason, STATUS_INPUT, "%s: %s", source->label, strerror(errno));
        if (stream)
            fclose(stream);
        return status;
    }
    enum status status;
    if (S_ISDIR(about.st_mode))
        status = fail(reason, STATUS_INPUT, "%s: is a directory", source->label);
    else
        status = read_stream(source, stream, about.st_size > 0 ? (size_t)about.st_size : 0, buffer,
                             reason);
    fclose(stream);
    return status;
}

static bool is_gzip(const char *bytes, size_t size)
{
    return size >= 2 && (unsigned char)bytes[0] == 0x1F && (unsigned char)bytes[1] == 0x8B;
}

/* Unzipped bytes that a file may have. Real meshes are unzipped to 2 to 25 times their size, zeros
 * to 1000 times. */
static size_t unzipped_most(size_t packed)
{
    return FILE_UNZIPPED_TIMES * packed + FILE_UNZIPPED_FIXED;
}

/* Makes room for at least one byte and the 0; never for more than `most` + 2. What is beyond half
 * of that is taken at once: old and new array together are then at most one and a half times it. */
static enum status unzip_reserve(struct buffer *out, size_t most, struct reason *reason)
{
    if (out->capacity >= out->size + 2)
        return STATUS_OK;
    size_t grown = out->capacity ? 2 * out->capacity : 1 << 16;
    grown = grown <= most / 2 ? grown : most + 2;
    char *bytes = realloc(out->bytes, grown);
    if (!bytes)
        return fail(reason, STATUS_MEMORY, "no memory for a file of %zu bytes", out->size);
    out->bytes = bytes;
    out->capacity = grown;
    return STATUS_OK;
}

/* Unzips one member, the gzip data that begin at packed[*at], and moves *at behind it. */
static enum status gunzip_member(const struct source *source, const struct buffer *packed,
                                 size_t *at, struct buffer *out, struct reason *reason)
{
    z_stream zip = {.next_in = (Bytef *)packed->bytes + *at,
                    .avail_in = (uInt)(packed->size - *at)};
    if (inflateInit2(&zip, 15 + 16) != Z_OK) /* the largest window, gzip header only */
        return fail(reason, STATUS_MEMORY, "%s: no memory to unzip", source->label);
    size_t most = unzipped_most(packed->size);
    most = most < source->most ? most : source->most;
    enum status status = STATUS_OK;
    int code = Z_OK;
    while (status == STATUS_OK && code == Z_OK) {
        status = unzip_reserve(out, most, reason);
        if (status != STATUS_OK)
            break;
        const size_t room = out->capacity - out->size - 1;
        zip.next_out = (Bytef *)out->bytes + out->size;
        zip.avail_out = (uInt)room;
        code = inflate(&zip, Z_NO_FLUSH);
        out->size += room - zip.avail_out;
        if (out->size > most)
            status = too_large(source, most, reason);
    }
    size_t done = packed->size - zip.avail_in;
    if (status == STATUS_OK && code == Z_MEM_ERROR)
        status = fail(reason, STATUS_MEMORY, "%s: no memory to unzip", source->label);
    else if (status == STATUS_OK && code == Z_BUF_ERROR)
        status = fail(reason, STATUS_INPUT, "%s: byte %zu: the gzip data are cut short",
                      source->label, done);
    else if (status == STATUS_OK && code != Z_STREAM_END)
        status = fail(reason, STATUS_INPUT, "%s: byte %zu: the gzip data are damaged (%s)",
                      source->label, done, zip.msg ? zip.msg : "needs a dictionary");
    inflateEnd(&zip);
    *at = done;
    return status;
}

static enum status gunzip(const struct source *source, const struct buffer *packed,
                          struct buffer *out, struct reason *reason)
{
    size_t at = 0;
    while (at < packed->size) {
        if (!is_gzip(packed->bytes + at, packed->size - at))
            return fail(reason, STATUS_INPUT, "%s: byte %zu: something follows the gzip data",
                        source->label, at);
        enum status status = gunzip_member(source, packed, &at, out, reason);
        if (status != STATUS_OK)
            return status;
    }
    return STATUS_OK;
}

enum status file_read_most(const char *path, size_t most, char **bytes, size_t *size,
                           struct reason *reason)
{
    const struct source source = {file_label(path), most};
    *bytes = NULL;
    *size = 0;
    struct buffer raw = {0}, text = {0};
    enum status status = read_raw(&source, path, &raw, reason);
    if (status == STATUS_OK && is_gzip(raw.bytes, raw.size)) {
        status = gunzip(&source, &raw, &text, reason);
        free(raw.bytes);
        raw = text;
    }
    if (status == STATUS_OK && raw.size == 0)
        status = fail(reason, STATUS_INPUT, "%s: is empty", source.label);
    if (status != STATUS_OK) {
        free(raw.bytes);
        return status;
    }
    raw.bytes[raw.size] = '\0';
    *bytes = raw.bytes;
    *size = raw.size;
    return STATUS_OK;
}

enum status file_read(const char *path, char **bytes, size_t *size, struct reason *reason)
{
    return file_read_most(path, FILE_LARGEST, bytes, size, reason);
}

/* Names of the temporary files that process `owner` has open, for file_out_abandon. More than there
 * are slots for are not known to it. */
static _Atomic(const char *) open_name[16];
static atomic_long owner;

static void name_know(const char *name)
{
    bool mine = atomic_exchange(&owner, (long)getpid()) == (long)getpid();
    for (size_t i = 0; i < ARRAY_COUNT(open_name) && !mine; i++)
        atomic_store(&open_name[i], NULL); /* of the process that this one was forked from */
    for (size_t i = 0; i < ARRAY_COUNT(open_name); i++) {
        const char *none = NULL;
        if (atomic_compare_exchange_strong(&open_name[i], &none, name))
            return;
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
        if (name)
            unlink(name);
    }
}

/* Opens PATH.PID.N.tmp for the first N that is free. */
static FILE *open_temporary(const char *path, char **name)
{
    size_t length = strlen(path) + 48;
    *name = malloc(length);
    if (!*name)
        return NULL;
    int file = -1;
    for (unsigned attempt = 0; file < 0 && attempt < 1000; attempt++) {
        snprintf(*name, length, "%s.%ld.%u.tmp", path, (long)getpid(), attempt);
        file = open(*name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file < 0 && errno != EEXIST)
            break;
    }
    FILE *stream = file < 0 ? NULL : fdopen(file, "wb");
    if (stream) {
        name_know(*name);
    } else {
        if (file >= 0) {
            close(file);
            unlink(*name);
        }
        free(*name);
        *name = NULL;
    }
    return stream;
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
    if (out->path)
        out->stream = replace ? open_temporary(out->path, &out->temporary) : fopen(path, "wb");
    if (out->stream)
        return STATUS_OK;
    int why = errno;
    file_out_discard(out);
    return fail(reason, why == ENOMEM ? STATUS_MEMORY : STATUS_INPUT, "%s: cannot write: %s",
                file_label(path), strerror(why));
}

enum status file_out_commit(struct file_out *out, struct reason *reason)
{
    errno = 0;
    bool good = fflush(out->stream) == 0 && !ferror(out->stream);
    /* So that after a crash of the machine the new name never stands for an empty file. */
    if (good && out->temporary)
        good = fsync(fileno(out->stream)) == 0;
    int why = errno;
    if (fclose(out->stream) != 0 && good) {
        good = false;
        why = errno;
    }
    out->stream = NULL;
    if (good && out->temporary && rename(out->temporary, out->path) != 0) {
        good = false;
        why = errno;
    }
    enum status status = STATUS_OK;
    if (!good)
        status = fail(reason, STATUS_INPUT, "%s: cannot write: %s", file_label(out->path),
                      why ? strerror(why) : "an earlier write failed");
    if (good) {
        if (out->temporary)
            name_forget(out->temporary);
        free(out->temporary);
        out->temporary = NULL;
    }
    file_out_discard(out);
    return status;
}

void file_out_discard(struct file_out *out)
{
    if (out->stream)
        fclose(out->stream);
    if (out->temporary) {
        unlink(out->temporary);
        name_forget(out->temporary);
    }
    free(out->temporary);
    free(out->path);
    *out = (struct file_out){0};
}

void file_out_clean(const char *folder)
{
    char path[4096];
    DIR *listing = opendir(folder);
    struct dirent *one;
    while (listing && (one = readdir(listing)) != NULL) {
        const char *end = strrchr(one->d_name, '.');
        int length = snprintf(path, sizeof path, "%s/%s", folder, one->d_name);
        if (end && end > one->d_name && strcmp(end, ".tmp") == 0 && length < (int)sizeof path)
            unlink(path);
    }
    if (listing)
        closedir(listing);
}
