/* Names of engines in processes of their own. */
#include "ref/outside/pipe.h"
#include "ref/outside/shared_object.h"

#include <stdio.h>
#include <string.h>

const char *pipe_engines_behind(const char *name)
{
    char rest[PIPE_NAME_MOST + 1];
    const char *first = NULL;
    snprintf(rest, sizeof rest, "%s", name);
    for (char *comma; (comma = strrchr(rest, ',')) && engine_find(comma + 1); *comma = '\0')
        first = name + (comma - rest);
    return first;
}

bool pipe_is_peer(const char *name)
{
    return strncmp(name, PIPE_PREFIX, strlen(PIPE_PREFIX)) == 0 || object_of_engine(name) == name;
}
