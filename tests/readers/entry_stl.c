/* STL, binary and ASCII. */
#include "tests/readers/reader_entry.h"
#include "scenes/read/formats.h"

static bool play(const char *bytes, size_t size)
{
    return reader_play_mesh(read_stl, bytes, size);
}

const struct reader_entry reader_entry = {"stl", 1 << 18, play};
