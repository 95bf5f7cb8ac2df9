#include "gpu/shaders.h"

#include <stddef.h>
#include <string.h>

const struct shader *shader_find(const char *name)
{
    for (const struct shader *shader = shaders; shader->name; shader++)
        if (strcmp(shader->name, name) == 0)
            return shader;
    return NULL;
}
