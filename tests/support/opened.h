/* A scene that opens, or the test fails. Include after cmocka.h. */
#ifndef TESTS_OPENED_H
#define TESTS_OPENED_H

#include "scenes/scenes.h"

static inline struct scene opened(const char *spec, uint64_t seed)
{
    struct scene scene;
    struct reason reason = {""};
    if (scene_open(spec, seed, &scene, &reason))
        fail_msg("%s: %s", spec, reason.text);
    return scene;
}

#endif
