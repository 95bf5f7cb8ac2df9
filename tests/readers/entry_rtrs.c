/* RTRS scene JSON. */
#include "tests/readers/reader_entry.h"
#include "scenes/read/formats.h"

static bool play(const char *bytes, size_t size)
{
    return reader_play_mesh(read_rtrs, bytes, size);
}

const struct reader_entry reader_entry = {"rtrs", 1 << 18, play};
