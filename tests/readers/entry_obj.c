/* Wavefront OBJ. */
#include "tests/readers/fire.h"
#include "scenes/read/formats.h"

static bool play(const char *bytes, size_t size)
{
    return fire_play_mesh(read_obj, bytes, size);
}

const struct fire_entry fire_entry = {"obj", 1 << 18, play};
