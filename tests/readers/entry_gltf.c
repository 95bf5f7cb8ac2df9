/* glTF and GLB. Of the files that it names only "b" exists, 64 bytes. */
#include "tests/readers/reader_entry.h"
#include "scenes/read/world_formats.h"

#include <stdlib.h>
#include <string.h>

#define FILE_BYTES 64u

static enum status open_bytes(void *user, const char *path, char **bytes, size_t *size,
                              struct reason *reason)
{
    (void)user;
    *bytes = NULL;
    *size = 0;
    if (strcmp(path, "b") != 0)
        return fail(reason, STATUS_INPUT, "%.100s: No such file", path);
    *bytes = alloc_zeroed(FILE_BYTES + 1, 1);
    READER_MUST(*bytes);
    for (unsigned i = 0; i < FILE_BYTES; i++)
        (*bytes)[i] = (char)(i % 4 == 3 ? 0x3F : i % 4 == 2 ? 0x80 : 0);
    *size = FILE_BYTES;
    return STATUS_OK;
}

static bool play(const char *bytes, size_t size)
{
    const struct world_files files = {NULL, open_bytes, NULL};
    struct world world;
    struct world_notes notes;
    struct reason reason = {""};
    enum status status = read_gltf("fuzz", bytes, size, &files, &world, &notes, &reason);
    READER_MUST(status == STATUS_OK || status == STATUS_INPUT);
    READER_MUST(status == STATUS_OK || notes.points_and_lines + notes.skins + notes.morphs == 0);
    reader_must_be_world(status, &world, &reason);
    world_free(&world);
    return status == STATUS_OK;
}

const struct reader_entry reader_entry = {"gltf", 1 << 18, play};
