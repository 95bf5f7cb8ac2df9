/* PLY, ascii and binary. */
#include "tests/readers/reader_entry.h"
#include "scenes/read/formats.h"

static bool play(const char *bytes, size_t size)
{
    return reader_play_mesh(read_ply, bytes, size);
}

const struct reader_entry reader_entry = {"ply", 1 << 18, play};
