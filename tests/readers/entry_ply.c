/* PLY, ascii and binary. */
#include "tests/readers/fire.h"
#include "scenes/read/formats.h"

static bool play(const char *bytes, size_t size)
{
    return fire_play_mesh(read_ply, bytes, size);
}

const struct fire_entry fire_entry = {"ply", 1 << 18, play};
