/* Shared by the actions of raydiff scene. For commands only. */
#ifndef CMD_SCENE_H
#define CMD_SCENE_H

#include "scenes/worlds.h"

#include <jansson.h>

struct scene_options {
    uint64_t seed;
    bool json;
    unsigned bits; /* of a grid; 0: coordinates stay */
    char **argument;
    int argument_count;
};

/* Reads a scene or world and writes it; prints what was written, and what is not kept. Returns the
 * exit code. */
int scene_convert(const struct scene_options *options);

/* What a world is, that is no scene: printed, or as a JSON object. */
void world_print(const char *spec, const struct world *world);
json_t *world_json(const char *spec, const struct world *world);

#endif
