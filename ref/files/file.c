#define _GNU_SOURCE /* O_CLOEXEC */
#include "ref/files/file.h"

#include <errno.h>
#include <fcntl.h>
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

/* A growing array of bytes, with room for a 0 after the last. */
struct buffer {
    char *bytes;
    size_t size, capacity;
};

/* A file being read: its name for reasons, and its largest size in bytes. */
struct source {
    const char *label;
    size_t most;
    bool stored; /* never zipped, and a regular file */
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

/* Makes room for `more` bytes and the 0 after them. */
static enum status buffer_reserve(struct buffer *buffer, size_t more, struct reason *reason)
{
    enum status status =
        array_reserve(&buffer->bytes, &buffer->capacity, buffer->size + more + 1, 1);
    if (status)
        return fail(reason, status, "no memory for a file of %zu bytes", buffer->size + more);
    return STATUS_OK;
}

/* Reads to the end of the file. `expected` is an estimate of its size. */
static enum status read_all(const struct source *source, int file, size_t expected,
                            struct buffer *buffer, struct reason *reason)
{
    size_t room = expected > 0 && expected <= source->most ? expected + 1 : 1 << 16;
    for (;;) {
        enum status status = buffer_reserve(buffer, room - buffer->size, reason);
        if (status)
            return status;
        ssize_t got = read(file, buffer->bytes + buffer->size, room - buffer->size);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return fail(reason, STATUS_INPUT, "%s: %s", source->label, strerror(errno));
        if (got == 0)
            return STATUS_OK;
        buffer->size += (size_t)got;
        if (buffer->size > source->most)
            return too_large(source, source->most, reason);
        if (buffer->size == room)
            room += room < 1 << 24 ? 1 << 16 : 1 << 24;
    }
}

static enum status read_raw(const struct source *source, int file, struct buffer *buffer,
                            struct reason *reason)
{
    struct stat about;
    if (fstat(file, &about) != 0)
        return fail(reason, STATUS_INPUT, "%s: %s", source->label, strerror(errno));
    if (S_ISDIR(about.st_mode))
        return fail(reason, STATUS_INPUT, "%s: is a directory", source->label);
    if (source->stored && !S_ISREG(about.st_mode))
        return fail(reason, STATUS_INPUT, "%s: is no regular file", source->label);
    return read_all(source, file, about.st_size > 0 ? (size_t)about.st_size : 0, buffer, reason);
}

int file_open_again(int folder, const char *name, int flags)
{
    int file;
    do
        file = openat(folder, name, flags | O_CLOEXEC, 0666);
    while (file < 0 && errno == EINTR);
    return file;
}

static bool is_gzip(const char *bytes, size_t size)
{
    return size >= 2 && (unsigned char)bytes[0] == 0x1F && (unsigned char)bytes[1] == 0x8B;
}

/* The largest size that a gzip file of `packed` bytes may unzip to. Real meshes unzip to 2 to 25
 * times their size, zeros to 1000 times. */
static size_t unzipped_most(size_t packed)
{
    return FILE_UNZIPPED_TIMES * packed + FILE_UNZIPPED_FIXED;
}

/* Makes room for at least one byte and the 0, and for at most `most` + 2 bytes. Beyond half of
 * `most` all of it is allocated at once, so that the old and the new array together never exceed
 * one and a half times that. */
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

/* Unzips one gzip member, which begins at packed->bytes[*at], and moves *at behind it. */
static enum status gunzip_member(const struct source *source, const struct buffer *packed,
                                 size_t *at, struct buffer *out, struct reason *reason)
{
    z_stream zip = {.next_in = (Bytef *)packed->bytes + *at,
                    .avail_in = (uInt)(packed->size - *at)};
    if (inflateInit2(&zip, 15 + 16) != Z_OK) /* largest window, gzip header only */
        return fail(reason, STATUS_MEMORY, "%s: no memory to unzip", source->label);
    size_t most = unzipped_most(packed->size);
    most = most < source->most ? most : source->most;
    enum status status = STATUS_OK;
    int code = Z_OK;
    while (!status && code == Z_OK) {
        status = unzip_reserve(out, most, reason);
        if (status)
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
    if (!status && code == Z_MEM_ERROR)
        status = fail(reason, STATUS_MEMORY, "%s: no memory to unzip", source->label);
    else if (!status && code == Z_BUF_ERROR)
        status = fail(reason, STATUS_INPUT, "%s: byte %zu: the gzip data are cut short",
                      source->label, done);
    else if (!status && code != Z_STREAM_END)
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
        if (status)
            return status;
    }
    return STATUS_OK;
}

/* Reads an open file, and closes it. */
static enum status read_source(const struct source *source, int file, char **bytes, size_t *size,
                               struct reason *reason)
{
    *bytes = NULL;
    *size = 0;
    struct buffer raw = {0}, text = {0};
    enum status status = read_raw(source, file, &raw, reason);
    close(file);
    if (!status && !source->stored && is_gzip(raw.bytes, raw.size)) {
        status = gunzip(source, &raw, &text, reason);
        free(raw.bytes);
        raw = text;
    }
    if (!status && raw.size == 0)
        status = fail(reason, STATUS_INPUT, "%s: is empty", source->label);
    if (status) {
        free(raw.bytes);
        return status;
    }
    raw.bytes[raw.size] = '\0';
    *bytes = raw.bytes;
    *size = raw.size;
    return STATUS_OK;
}

enum status file_read_from(int file, const char *path, size_t most, char **bytes, size_t *size,
                           struct reason *reason)
{
    const struct source source = {.label = file_label(path), .most = most};
    return read_source(&source, file, bytes, size, reason);
}

/* A pipe without a writer would be waited for, but for O_NONBLOCK, which regular files ignore. */
static enum status open_source(const char *path, const struct source *source, char **bytes,
                               size_t *size, struct reason *reason)
{
    int file = file_open_again(AT_FDCWD, path, source->stored ? O_RDONLY | O_NONBLOCK : O_RDONLY);
    *bytes = NULL;
    *size = 0;
    if (file < 0)
        return fail(reason, STATUS_INPUT, "%s: %s", source->label, strerror(errno));
    return read_source(source, file, bytes, size, reason);
}

enum status file_read_most(const char *path, size_t most, char **bytes, size_t *size,
                           struct reason *reason)
{
    const struct source source = {.label = file_label(path), .most = most};
    return open_source(path, &source, bytes, size, reason);
}

enum status file_read_stored(const char *path, char **bytes, size_t *size, struct reason *reason)
{
    const struct source source = {.label = file_label(path), .most = FILE_LARGEST, .stored = true};
    return open_source(path, &source, bytes, size, reason);
}

enum status file_read(const char *path, char **bytes, size_t *size, struct reason *reason)
{
    return file_read_most(path, FILE_LARGEST, bytes, size, reason);
}
