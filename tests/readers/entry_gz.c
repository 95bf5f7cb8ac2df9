/* Whole files, unzipped if they begin as gzip does. */
#include "tests/readers/reader_entry.h"
#include "ref/files/file.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static bool play(const char *bytes, size_t size)
{
    char path[READER_PATH_MOST], *read;
    size_t read_size;
    struct reason reason = {""};
    int file = reader_file(bytes, size, path);
    enum status status = file_read(path, &read, &read_size, &reason);
    close(file);
    bool zipped = size >= 2 && memcmp(bytes, "\x1F\x8B", 2) == 0;
    READER_MUST(status == STATUS_OK || status == STATUS_INPUT);
    if (status)
        reader_must_be_reason(&reason);
    else
        READER_MUST(read[read_size] == '\0' &&
                    (zipped || (read_size == size && memcmp(read, bytes, size) == 0)));
    free(read);
    return status == STATUS_OK;
}

/* Small files may be unzipped to a megabyte, in an array that is copied from one half as large;
 * zlib itself needs 48 kB. */
const struct reader_entry reader_entry = {"gz", FILE_UNZIPPED_FIXED / 2 * 3 + (1 << 16), play};
