/* PLY, ascii and binary. */
#include "fuzz/fire/fire.h"
#include "scenes/formats.h"

static bool play(const char *bytes, size_t size)
{
    return fire_play_mesh(read_ply, bytes, size);
}

const struct fire_entry fire_entry = {"ply", 1 << 18, play};
