/* World JSON of our own. Every scene that it names is a triangle, but none of a name that begins
 * with "n" exists. */
#include "tests/readers/reader_entry.h"
#include "scenes/read/world_formats.h"

static enum status open_scene(void *user, const char *spec, struct scene *out,
                              struct reason *reason)
{
    (void)user;
    *out = (struct scene){0};
    if (spec[0] == 'n')
        return fail(reason, STATUS_INPUT, "%.100s: No such file", spec);
    READER_MUST(scene_make(3, 1, out) == STATUS_OK);
    return STATUS_OK;
}

static bool play(const char *bytes, size_t size)
{
    const struct world_files files = {open_scene, NULL, NULL};
    struct world world;
    struct reason reason = {""};
    enum status status = read_world("fuzz", bytes, size, &files, &world, &reason);
    READER_MUST(status == STATUS_OK || status == STATUS_INPUT);
    READER_MUST(status == STATUS_INPUT || is_world(bytes, size));
    reader_must_be_world(status, &world, &reason);
    world_free(&world);
    return status == STATUS_OK;
}

const struct reader_entry reader_entry = {"world", 1 << 18, play};
