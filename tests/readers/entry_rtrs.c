/* RTRS scene JSON. */
#include "tests/readers/fire.h"
#include "scenes/read/formats.h"

static bool play(const char *bytes, size_t size)
{
    return fire_play_mesh(read_rtrs, bytes, size);
}

const struct fire_entry fire_entry = {"rtrs", 1 << 18, play};
