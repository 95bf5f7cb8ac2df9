/* RTRS scene JSON. */
#include "fuzz/fire/fire.h"
#include "scenes/formats.h"

static bool play(const char *bytes, size_t size)
{
    struct scene scene;
    struct reason reason = {""};
    enum status status = read_rtrs("fuzz", bytes, size, &scene, &reason);
    FIRE_MUST(status == STATUS_OK || status == STATUS_INPUT);
    if (status)
        fire_must_be_reason(&reason);
    else
        fire_must_be_scene(&scene);
    scene_free(&scene);
    return status == STATUS_OK;
}

const struct fire_entry fire_entry = {"rtrs", 1 << 18, play};
